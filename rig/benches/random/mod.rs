//! Random strokes, the same in every run: inputs that no tuning of the fit changes.

use std::ops::Range;

use strokefit::render::{Grid, Params, Strokes};
use strokefit::rng;

/// Distribution of random strokes.
#[derive(Debug, Clone)]
pub(crate) struct Look {
    /// Standard deviation of `b − a` along each axis, px.
    pub(crate) spread_px: f32,
    /// Radius, px.
    pub(crate) radius_px: Range<f32>,
    /// Opacity.
    pub(crate) opacity: Range<f32>,
}

/// `count` strokes of random colours, the first ends uniform over the picture of `grid`.
pub(crate) fn strokes(grid: Grid, count: usize, look: &Look) -> Strokes {
    (0..count as u64).map(|i| stroke(grid, i, look)).collect()
}

fn stroke(grid: Grid, i: u64, look: &Look) -> Params {
    // A normal number uses up the draws 2k and 2k + 1.
    let normal = |k| rng::normal(0, 0, i, k) * look.spread_px;
    let draw = |k| rng::draw(0, 0, i, k);
    let within = |range: &Range<f32>, k| range.start + (range.end - range.start) * draw(k);
    let (x, y) = (draw(0) * grid.width as f32, draw(1) * grid.height as f32);
    let radius = within(&look.radius_px, 6);
    let opacity = within(&look.opacity, 7);
    let [red, green, blue] = [8, 9, 10].map(draw);
    [
        x,
        y,
        x + normal(1),
        y + normal(2),
        radius,
        red,
        green,
        blue,
        opacity,
    ]
}
