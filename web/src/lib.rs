//! The library for web pages and Node: what `web/js` calls. Options, reports and drawings cross as JSON.
//!
//! A fit runs on the thread that asks for it, and holds that thread until it is over.

mod observed;
mod options;
mod renderer;
mod target;

use std::cell::RefCell;
use std::panic;

use strokefit::animation::{Film, Legend};
use strokefit::clock::Instant;
use strokefit::fit::{Base, Fitter, Focus};
use strokefit::machine::{self, Sheet};
use strokefit::report::{self, FitReport, Judged, Run, Usage};
use strokefit::scene::Scene;
use strokefit::svg;
use wasm_bindgen::prelude::*;

use observed::{Observed, scene_json};

pub use observed::Watcher;
pub use options::Options;
pub use renderer::Renderer;
pub use target::Target;

/// A finished drawing.
#[wasm_bindgen(getter_with_clone)]
pub struct Drawing {
    /// Text of the file.
    #[wasm_bindgen(readonly)]
    pub svg: String,
    /// The report, as JSON.
    #[wasm_bindgen(readonly)]
    pub report: String,
    /// The drawing for canvases, as JSON; of a foreign base, only what lies on it.
    #[wasm_bindgen(readonly)]
    pub scene: String,
}

thread_local! {
    static PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Takes note of panics: they end in a trap, which does not say why.
#[wasm_bindgen(start)]
pub fn start() {
    panic::set_hook(Box::new(|panic| PANIC.set(Some(panic.to_string()))));
}

/// Why the last call trapped, if it panicked.
#[wasm_bindgen(js_name = lastPanic)]
pub fn last_panic() -> Option<String> {
    PANIC.take()
}

/// Draws `target`. `options` is read by [`Options::read`]; `watcher` is told of every iteration. Errors count most where the
/// mask `focus` is white.
///
/// # Errors
/// An `Error` where the library has one; what the watcher threw, as it is.
#[wasm_bindgen]
pub fn fit(
    target: Target,
    focus: Option<Target>,
    options: &str,
    watcher: Option<Watcher>,
) -> Result<Drawing, JsValue> {
    let start = Instant::now();
    let mut observed = Observed::new(watcher);
    let drawn = draw(&target, focus.as_ref(), options, start, &mut observed);
    match observed.thrown() {
        Some(thrown) => Err(thrown),
        None => drawn.map_err(|e| JsError::from(e).into()),
    }
}

fn draw(
    target: &Target,
    focus: Option<&Target>,
    options: &str,
    start: Instant,
    observed: &mut Observed,
) -> strokefit::Result<Drawing> {
    let Options {
        config,
        base,
        freeze_base,
    } = Options::read(options)?;
    let picture = target.image();
    let named_base = base.as_ref().map(|_| "base");
    let base = base
        .map(|text| Base::read(text, picture, freeze_base))
        .transpose()?;
    let fitter = Fitter::new(config.clone()).since(start).observer(observed);
    let fitter = match base {
        Some(base) => fitter.on(base),
        None => fitter,
    };
    let fitter = match focus {
        Some(mask) => fitter.focus(Focus::lifted(mask.image())?),
        None => fitter,
    };
    let judged = Judged::new(fitter.fit(picture)?)?;
    let run = Run {
        input: "",
        base: named_base,
        config: &config,
        wall: start.elapsed(),
        usage: Usage::default(),
    };
    Ok(Drawing {
        report: report::json(&FitReport::of(&judged, &run))?,
        scene: scene_json(&judged.fit.scene),
        svg: judged.svg,
    })
}

/// An SVG that draws itself, from the text of a drawing by strokefit.
///
/// # Errors
/// When the text is not such a drawing.
#[wasm_bindgen]
pub fn animate(text: &str) -> Result<String, JsError> {
    let film = Film {
        step: None,
        legend: Legend::None,
        scale: 1.0,
    };
    Ok(film.svg(&svg::read(text)?))
}

/// A PDF of the text of a drawing by strokefit, on a page as large as the text says.
///
/// # Errors
/// When the text is not such a drawing.
#[wasm_bindgen]
pub fn pdf(text: &str) -> Result<Vec<u8>, JsError> {
    let scene = svg::read(text)?;
    Ok(machine::pdf(&sheet(text, &scene)))
}

/// A DXF of the text of a drawing by strokefit, on a page as large as the text says.
///
/// # Errors
/// When the text is not such a drawing.
#[wasm_bindgen]
pub fn dxf(text: &str) -> Result<String, JsError> {
    let scene = svg::read(text)?;
    Ok(machine::dxf(&sheet(text, &scene)))
}

fn sheet<'a>(text: &str, scene: &'a Scene) -> Sheet<'a> {
    Sheet {
        scene,
        width: svg::page_width(text),
    }
}
