//! The report of `strokefit check`.

use serde::{Deserialize, Serialize};

use super::Input;
use crate::metrics::Quality;
use crate::svg::Finding;
use crate::verify::OnMattes;

/// Findings of `strokefit check`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckReport {
    /// [`SCHEMA`](super::SCHEMA).
    pub schema: u32,
    /// The picture; `null` when the file was compared with nothing.
    pub input: Option<Input>,
    /// The SVG file, as it was named.
    pub svg: String,
    /// Length of the SVG text in bytes.
    pub svg_bytes: usize,
    /// A picture with alpha on black, white and magenta, as resvg renders the file; `null` for others.
    pub alpha: Option<OnMattes>,
    /// One per renderer that drew the file: resvg, then the others in the order asked for.
    pub renderers: Vec<RendererEntry>,
    /// One per renderer that did not.
    pub not_drawn: Vec<NotDrawn>,
    /// Findings in the text of the file alone that programs disagree on; the worst first.
    pub lint: Vec<Finding>,
}

/// Render of an SVG by one program, compared with the picture and with resvg.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RendererEntry {
    /// `resvg`, `inkscape`, `rsvg`, `chromium` or `cairosvg`.
    pub renderer: String,
    /// Its version.
    pub version: String,
    /// The SVG as rendered against the picture; `null` without a picture.
    pub fidelity: Option<Quality>,
    /// Its render against that of resvg; `null` for resvg.
    pub against_resvg: Option<AgainstResvg>,
    /// Wall time of the render, the start of the program included, s.
    pub wall_s: f64,
    /// True if it draws the file as resvg does.
    pub passed: bool,
}

/// A render compared with that of resvg.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AgainstResvg {
    /// dB; `null` when equal.
    pub psnr_db: Option<f64>,
    /// Largest difference of a channel of a pixel, 0..=255.
    pub max_abs: u8,
    /// Column of the first pixel that has it.
    pub x: usize,
    /// Row of that pixel.
    pub y: usize,
}

/// A renderer that drew nothing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NotDrawn {
    /// Its name.
    pub renderer: String,
    /// True if it is there.
    pub installed: bool,
    /// Why not, and what to do about it.
    pub reason: String,
}
