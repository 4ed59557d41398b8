//! The colours that strokes would like to have, and those that they are given.

use crate::fit::drawing::Drawing;
use crate::render::{CanvasLoss, Gradients, Lanes, OPACITY, Params, RED, TileRgb};
use crate::scene::Rgb;

/// The colour that a stroke, or the background, would like to have if the others stayed as they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wish {
    pub(super) color: Rgb,
    /// By how much the squared error grows with the squared distance from it.
    pub(super) weight: f32,
}

/// Sums each stroke's share of the pixels that it shows in, as the derivative by its red.
struct Shown;

impl CanvasLoss for Shown {
    fn tile(&self, _: usize, _: &TileRgb, _: &mut TileRgb, gradient: &mut TileRgb) -> f64 {
        for [red, ..] in gradient.iter_mut() {
            *red = Lanes::splat(1.0);
        }
        0.0
    }
}

/// The colours that the strokes of `drawing`, and at last the background if there is one, would like to have after a
/// share `damping` of their Newton steps; a stroke that shows in fewer than `min_shown` px wishes for what it has. All strokes must be free.
pub(super) fn wishes(drawing: &mut Drawing, damping: f32, min_shown: f32) -> Vec<Wish> {
    let slopes = drawing.judge();
    // What a stroke shows of itself is the same on every matte.
    let mut shown = Gradients::default();
    drawing.backward(&Shown, &mut shown);
    // The loss is a mean over pixels and channels.
    let values = (3 * drawing.pixels()) as f32 / drawing.pixel_area();
    let wish = |color: Rgb, slope: Rgb, weight: f32| {
        let step = if weight > min_shown {
            damping * values / (2.0 * weight)
        } else {
            0.0
        };
        let moved = |c: usize| color[c] - (step * slope[c]).clamp(-1.0, 1.0);
        let color = [0, 1, 2].map(|c| moved(c).clamp(0.0, 1.0));
        Wish { color, weight }
    };
    let rgb = |p: &Params| [p[RED], p[RED + 1], p[RED + 2]];
    let strokes = drawing.free().iter().zip(&slopes.strokes);
    let wishes = strokes.zip(&shown.strokes).map(|((stroke, slope), shown)| {
        // The square of a share is at most the share times the opacity.
        wish(rgb(stroke), rgb(slope), shown[RED] * stroke[OPACITY])
    });
    let background = drawing.background();
    let background = background.map(|color| wish(color, slopes.backdrop, shown.backdrop[0]));
    wishes.chain(background).collect()
}

/// Gives the strokes of `drawing`, and at last the background unless it is fixed, these colours. All strokes must be
/// free.
pub(super) fn set_colors(drawing: &mut Drawing, colors: &[Rgb]) {
    let mut colors = colors.iter();
    for (stroke, color) in drawing.free_mut().iter_mut().zip(colors.by_ref()) {
        stroke[RED..OPACITY].copy_from_slice(color);
    }
    if let Some(&background) = colors.next().filter(|_| !drawing.background_fixed) {
        drawing.change_background(|color| *color = background);
    }
}
