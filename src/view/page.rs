//! The files of the page, and the JSON that its script reads.

use serde::Serialize;

use super::http::Response;
use super::shared::{Numbers, Point, Shared, Shown, State};
use crate::report::SceneRecord;

/// A file of the page. All but `index.html` and `page.js` are also those of the page of `web/`, which fits by itself.
pub(super) fn file(name: &str) -> Option<Response> {
    let (kind, text) = match name {
        "" => return Some(Response::of("text/html", index().into_bytes())),
        "page.css" => ("text/css", include_str!("page/page.css")),
        "page.js" => ("text/javascript", include_str!("page/page.js")),
        "viewer.js" => ("text/javascript", include_str!("page/viewer.js")),
        "chart.js" => ("text/javascript", include_str!("page/chart.js")),
        "choice.js" => ("text/javascript", include_str!("page/choice.js")),
        "describe.js" => ("text/javascript", include_str!("page/describe.js")),
        "edits.js" => ("text/javascript", include_str!("page/edits.js")),
        "lens.js" => ("text/javascript", include_str!("page/lens.js")),
        "palette.js" => ("text/javascript", include_str!("page/palette.js")),
        "picture.js" => ("text/javascript", include_str!("page/picture.js")),
        "swatches.js" => ("text/javascript", include_str!("page/swatches.js")),
        _ => return None,
    };
    Some(Response::of(kind, text.as_bytes()))
}

/// The page, with the part that it shares put in its place.
fn index() -> String {
    let page = include_str!("page/index.html");
    page.replace("<!-- viewer.html -->\n", include_str!("page/viewer.html"))
}

/// The state as JSON; the drawing only if it is not the one with the number `seen`.
pub(super) fn state(shared: &Shared, seen: Option<u64>) -> Option<Vec<u8>> {
    let State {
        picture,
        numbers,
        curve,
        shown,
        file,
        grows,
        more,
    } = shared.asked();
    let record = StateRecord {
        picture: picture.number,
        title: &picture.title,
        has_target: picture.target.is_some(),
        finished: file.is_some(),
        grows,
        more,
        svg_bytes: file.map(|file| file.len()),
        numbers,
        curve: curve.points(),
        version: shown.as_ref().map_or(0, |shown| shown.version),
        scene: shown
            .as_ref()
            .filter(|shown| seen != Some(shown.version))
            .map(|Shown { scene, .. }| SceneRecord::from(&**scene)),
    };
    serde_json::to_vec(&record).ok()
}

#[derive(Serialize)]
struct StateRecord<'a> {
    /// Another number, another picture.
    picture: u64,
    title: &'a str,
    has_target: bool,
    finished: bool,
    /// True if more strokes can be had; `more` is the number that was asked for.
    grows: bool,
    more: Option<usize>,
    svg_bytes: Option<usize>,
    /// Left out when nothing was fitted.
    #[serde(flatten)]
    numbers: Option<Numbers>,
    curve: &'a [Point],
    version: u64,
    scene: Option<SceneRecord>,
}
