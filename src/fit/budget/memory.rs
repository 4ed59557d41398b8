//! A prediction of the memory that a fit takes.

use crate::fit::budget::plan::{Before, Plan};
use crate::fit::budget::reduction;
use crate::fit::config::{Background, Config, MAX_STROKES};
use crate::image::Image;
use crate::render::TILE;

/// Bytes for the program and its libraries.
const BASE: u64 = 16 << 20;
/// Bytes per pixel for the picture, its reductions, canvases and renders, and for judging them: of a photograph. Measured: 215 to
/// 315.
const PER_PIXEL: u64 = 245;
/// Bytes per pixel of flat art and drawings of lines. Measured for dashboard-900 and line-cat-1000: 370 and 210.
const PER_FLAT_PIXEL: u64 = 300;
/// Bytes per pixel of a picture that is drawn on two mattes. Measured: 460 to 790.
const PER_TRANSPARENT_PIXEL: u64 = 550;
/// Bytes per pixel of the padding of tiles, which only canvases have. Measured for 65000×2, 30000×3 and 3×20000 px: 95
/// to 145.
const PER_PADDED_PIXEL: u64 = 135;
/// Bytes per pixel of a picture that is reduced before it is drawn. Measured: 14 for 16 megapixels.
const PER_PIXEL_READ: u64 = 15;
/// Bytes per stroke for its points, the optimiser's state, the tiles that it touches, the SVG text and its tree. Measured:
/// 7,000 to 13,000, more where strokes cover each other many times.
const PER_STROKE: u64 = 8000;

/// The predicted peak memory, bytes, of a process that draws `picture` and judges the drawing. Of 15 pictures of 0.06 to 1
/// megapixels, it is within a fifth of the true peak for 11, and within a half for all. Without a budget of strokes it assumes an ordinary
/// drawing. A picture that is reduced counts as such, which is found out by reducing it.
pub fn predicted_rss_bytes(picture: &Image, config: &Config) -> u64 {
    let (all, per_pixel) = (size(picture), per_pixel(picture, config));
    match reduction::size(picture, config) {
        Some(reduced) => of_pixels((reduced, per_pixel), Some(all), config),
        None => of_pixels((all, per_pixel), None, config),
    }
}

/// The predicted peak memory, bytes, of a process that has drawn `target`, the reduced picture of a page of `page` px if there is one.
pub(crate) fn rss_bytes_of(target: &Image, page: Option<[u32; 2]>, config: &Config) -> u64 {
    let read = page.map(|page| page.map(|side| side as usize));
    of_pixels((size(target), per_pixel(target, config)), read, config)
}

fn size(picture: &Image) -> [usize; 2] {
    [picture.width(), picture.height()]
}

/// Bytes for each pixel of `picture`.
fn per_pixel(picture: &Image, config: &Config) -> u64 {
    if picture.alpha().is_some() && !matches!(config.background, Background::Color(_)) {
        PER_TRANSPARENT_PIXEL
    } else if reduction::is_flat(picture) {
        PER_FLAT_PIXEL
    } else {
        PER_PIXEL
    }
}

/// Predicted peak memory for a drawing of this size, px, of so many bytes for each pixel. If the picture was reduced, `read` is
/// its size as it was read.
fn of_pixels(
    (size, per_pixel): ([usize; 2], u64),
    read: Option<[usize; 2]>,
    config: &Config,
) -> u64 {
    let limit = config.budget.strokes.map(|n| n.min(MAX_STROKES));
    let pixels = |[width, height]: [usize; 2]| width * height;
    let strokes = Plan::new(config, limit, Before::default(), pixels(size)).strokes();
    // Most of the canvases of two rows of pixels is padding.
    let padding = pixels(size.map(|side| side.next_multiple_of(TILE))) - pixels(size);
    BASE + PER_PIXEL_READ * read.map_or(0, pixels) as u64
        + per_pixel * pixels(size) as u64
        + PER_PADDED_PIXEL * padding as u64
        + PER_STROKE * strokes as u64
}
