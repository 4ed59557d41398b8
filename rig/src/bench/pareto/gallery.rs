//! The drawings that the page shows, each with its difference from the picture.

use std::fs;
use std::path::Path;

use crate::bench::gallery::errors;
use crate::report::pareto::{ARTICLE, Exhibit, OWN, ParetoEntry, front};
use strokefit::image::Image;
use strokefit::verify;
use strokefit::{Error, ErrorKind, Result};

/// Most drawings of ours on the page.
const OURS: usize = 6;

/// Widest picture on the page, px; wider ones are halved until they fit.
const WIDEST: usize = 480;

/// Longest SVG that the page embeds, bytes; longer ones are only in the folder.
const LONGEST: usize = 200_000;

/// The picture, our front by bytes, what the article's recipe made, and the best of each peer.
pub(super) fn exhibits(
    folder: &Path,
    target: &Image,
    name: &str,
    entries: &[ParetoEntry],
) -> Result<Vec<Exhibit>> {
    let here: Vec<&ParetoEntry> = entries
        .iter()
        .filter(|e| e.picture == name && e.fidelity.is_some())
        .collect();
    let gzip = |e: &ParetoEntry| Some(e.gzip_bytes as f64);
    let ours = front(
        here.iter().copied().filter(|e| e.family == OWN),
        gzip,
        ParetoEntry::psnr_db,
    );
    let step = ours.len().div_ceil(OURS).max(1);
    let mut chosen: Vec<&ParetoEntry> = ours.into_iter().step_by(step).collect();
    chosen.extend(here.iter().copied().filter(|e| e.family == ARTICLE));
    chosen.extend(best_of_others(&here));
    let drawings = chosen
        .into_iter()
        .map(|entry| exhibit(folder, target, entry));
    std::iter::once(itself(target, name))
        .chain(drawings)
        .collect()
}

fn itself(target: &Image, name: &str) -> Result<Exhibit> {
    Ok(Exhibit {
        picture: name.to_owned(),
        caption: format!("the picture, {}×{} px", target.width(), target.height()),
        drawn: thumbnail(target.clone()).encode_png()?,
        difference: Vec::new(),
        svg: String::new(),
    })
}

fn best_of_others<'a>(here: &[&'a ParetoEntry]) -> Vec<&'a ParetoEntry> {
    let mut best: Vec<&ParetoEntry> = Vec::new();
    for &entry in here
        .iter()
        .filter(|e| e.family != OWN && e.family != ARTICLE)
    {
        match best.iter_mut().find(|other| other.family == entry.family) {
            Some(other) if entry.psnr_db() > other.psnr_db() => *other = entry,
            Some(_) => {}
            None => best.push(entry),
        }
    }
    best
}

fn exhibit(folder: &Path, target: &Image, entry: &ParetoEntry) -> Result<Exhibit> {
    let path = folder.join("svg").join(entry.svg_name());
    let svg = fs::read_to_string(&path).map_err(|e| {
        let message = format!(
            "{}: cannot be read ({e}): measure again in another folder",
            path.display()
        );
        Error::new(ErrorKind::Io, message)
    })?;
    let drawn = verify::render_like(&svg, target, [1.0; 3])?;
    let difference = errors(target, &drawn)?;
    Ok(Exhibit {
        picture: entry.picture.clone(),
        caption: format!(
            "{} {}: {:.2} dB, {:.1} kB after gzip",
            entry.family,
            entry.label,
            entry.psnr_db().unwrap_or(f64::NAN),
            entry.gzip_bytes as f64 / 1000.0
        ),
        drawn: thumbnail(drawn).encode_png()?,
        difference: thumbnail(difference).encode_png()?,
        svg: if svg.len() > LONGEST {
            String::new()
        } else {
            svg
        },
    })
}

fn thumbnail(mut image: Image) -> Image {
    while image.width() > WIDEST {
        image = image.halved();
    }
    image
}
