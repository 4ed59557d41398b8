//! A prediction of the memory that a fit takes.

use crate::fit::budget::plan::{Before, Plan};
use crate::fit::budget::reduction;
use crate::fit::config::{Config, MAX_STROKES};
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
    match reduction::size(picture, config) {
        Some([width, height]) => of_pixels(width * height, Some(all), config),
        None => of_pixels(all, None, config),
    }
}

/// The predicted peak memory, bytes, of a process that has drawn `target`, the reduced picture of a page of `page` px if there is one.
pub(crate) fn rss_bytes_of(target: &Image, page: Option<[u32; 2]>, config: &Config) -> u64 {
    let read = page.map(|[width, height]| width as usize * height as usize);
    of_pixels(target.width() * target.height(), read, config)
}

/// Predicted peak memory for a drawing of `pixels` pixels, bytes. If the picture was reduced, `read` is its pixels as
/// it was read.
fn of_pixels(pixels: usize, read: Option<usize>, config: &Config) -> u64 {
    let recipe = config.recipe();
    let limit = config.budget.strokes.map(|n| n.min(MAX_STROKES));
    let strokes = Plan::new(config, &recipe, limit, Before::default(), pixels).strokes();
    let read = PER_PIXEL_READ * read.unwrap_or(0) as u64;
    BASE + read + PER_PIXEL * pixels as u64 + PER_STROKE * strokes as u64
}
