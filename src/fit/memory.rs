//! How much memory a fit will take, before it takes any.

use super::config::{Config, MAX_STROKES};
use super::plan::{Before, Plan};
use crate::image::Image;

/// The program and its libraries.
const BASE: u64 = 12 << 20;
/// The picture, its reductions, canvases, renders, and the judging of them; measured: 143 at 6 Mpx, 145 at
/// 1.6 Mpx, 148 at 0.4 Mpx beside the base.
const PER_PIXEL: u64 = 143;
/// Parameters, the optimiser's memory, text and its tree; measured: 1,200 to 2,600, less in large pictures,
/// whose own memory is largest when that of strokes is not.
const PER_STROKE: u64 = 2000;

/// The most memory that a process which draws `picture` and judges the drawing will hold, bytes: within a
/// third of what it is, for pictures of more than 100×100 px. A fit without a budget of strokes is taken to
/// be an ordinary one.
pub fn predicted_rss_bytes(picture: &Image, config: &Config) -> u64 {
    let pixels = picture.width() * picture.height();
    let recipe = config.recipe();
    let limit = config.budget.strokes.map(|n| n.min(MAX_STROKES));
    let strokes = Plan::new(config, &recipe, limit, Before::default(), pixels).strokes();
    BASE + PER_PIXEL * pixels as u64 + PER_STROKE * strokes as u64
}
