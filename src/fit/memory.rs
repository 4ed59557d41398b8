//! A prediction of the memory that a fit takes.

use super::config::{Config, MAX_STROKES};
use super::plan::{Before, Plan};
use super::reduction;
use crate::image::Image;

/// Bytes for the program and its libraries.
const BASE: u64 = 16 << 20;
/// Bytes per pixel for the picture, its reductions, canvases and renders, and for judging them.
const PER_PIXEL: u64 = 195;
/// Bytes per pixel of a picture that is reduced before it is drawn. Measured: 14 for 16 megapixels.
const PER_PIXEL_READ: u64 = 15;
/// Bytes per stroke for its points, the optimiser's state, the tiles that it touches, the SVG text and its tree. Measured:
/// 7,000 to 13,000, more where strokes cover each other many times.
const PER_STROKE: u64 = 8000;

/// The predicted peak memory, bytes, of a process that draws `picture` and judges the drawing. It is within a fifth of
/// the true peak for pictures of more than 100×100 px. Without a budget of strokes it assumes an ordinary drawing. It does
/// not foresee whether strokes will be nudged, which takes 160 bytes per pixel more. A picture that is reduced counts as
/// such, which is found out by reducing it.
pub fn predicted_rss_bytes(picture: &Image, config: &Config) -> u64 {
    let all = picture.width() * picture.height();
    let reduced = reduction::size(picture, config);
    let pixels = reduced.map_or(all, |[width, height]| width * height);
    let side = |px: usize| u32::try_from(px).unwrap_or(u32::MAX);
    let page = [side(picture.width()), side(picture.height())];
    let read = reduced.map_or(0, |_| read_bytes(page));
    let recipe = config.recipe();
    let limit = config.budget.strokes.map(|n| n.min(MAX_STROKES));
    let strokes = Plan::new(config, &recipe, limit, Before::default(), pixels).strokes();
    BASE + read + PER_PIXEL * pixels as u64 + PER_STROKE * strokes as u64
}

/// Bytes for a picture of this size, px, that is reduced before it is drawn.
pub(crate) fn read_bytes([width, height]: [u32; 2]) -> u64 {
    PER_PIXEL_READ * u64::from(width) * u64::from(height)
}
