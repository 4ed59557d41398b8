//! Preferred colours: the colour that would suit each stroke best.

use crate::fit::drawing::Drawing;
use crate::render::{CanvasLoss, Gradients, Lanes, STYLE, TileRgb};
use crate::scene::Rgb;

/// Share of its Newton step that a colour takes. It is below 1 because the strokes under and over it move as well. Half, twice:
/// −0.03, −0.05 dB.
pub(super) const DAMPING: f32 = 0.7;
/// A stroke keeps its colour if it shows in fewer pixels than this. Half, twice: 0.00 dB.
const MIN_SHOWN: f32 = 1e-3;

/// The colour of a stroke, or of the background, that minimises the squared error if all others stay as they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PreferredColor {
    pub(super) color: Rgb,
    /// Growth of the squared error with the squared distance from that colour.
    pub(super) weight: f32,
}

/// A loss whose derivative with respect to a stroke's red is the stroke's share of all pixels, summed.
struct Shown;

impl CanvasLoss for Shown {
    fn tile(&self, _: usize, _: &TileRgb, _: Option<&mut TileRgb>, gradient: &mut TileRgb) -> f64 {
        for [red, ..] in gradient.iter_mut() {
            *red = Lanes::splat(1.0);
        }
        0.0
    }
}

/// The preferences of the strokes of `drawing`, followed by the background's if there is one, each after a share
/// `damping` of its Newton step. All strokes must be free.
pub(super) fn preferences(drawing: &mut Drawing, damping: f32) -> Vec<PreferredColor> {
    let slopes = drawing.judge();
    // The part of a stroke that shows does not depend on the matte.
    let mut shown = Gradients::default();
    drawing.backward(&Shown, &mut shown);
    // The loss is a mean over pixels and channels.
    let values = (3 * drawing.pixels()) as f32 / drawing.pixel_area();
    let preference = |color: Rgb, slope: Rgb, weight: f32| {
        // In the colour c the squared error is w·|c − c*|² and a constant, w the sum of squared shares. Its slope is 2w(c − c*),
        // so Newton's step is slope / 2w. The loss is a mean; its slope times `values` is the slope of the sum.
        let step = if weight > MIN_SHOWN {
            damping * values / (2.0 * weight)
        } else {
            0.0
        };
        let moved = |c: usize| color[c] - (step * slope[c]).clamp(-1.0, 1.0);
        let color = [0, 1, 2].map(|c| moved(c).clamp(0.0, 1.0));
        PreferredColor { color, weight }
    };
    let strokes = drawing.free();
    let preferences = strokes.iter().enumerate().map(|(i, stroke)| {
        // A style is radius, red, green, blue, opacity; it comes last among a stroke's numbers.
        let red = strokes.range(i).end - STYLE + 1;
        let slope = [0, 1, 2].map(|k| slopes.strokes[red + k]);
        // The square of a share is at most the share times the opacity.
        preference(stroke.color(), slope, shown.strokes[red] * stroke.opacity())
    });
    // The background's shares aren't squared at all, which overestimates its weight.
    let background = drawing.background();
    let background = background.map(|color| preference(color, slopes.backdrop, shown.backdrop[0]));
    preferences.chain(background).collect()
}

/// Sets the colours of the strokes of `drawing` and, if one more colour follows, of the background unless that is
/// fixed. All strokes must be free.
pub(super) fn set_colors(drawing: &mut Drawing, colors: &[Rgb]) {
    let mut colors = colors.iter();
    drawing.free_mut().change(|_, mut stroke| {
        if let Some(color) = colors.next() {
            stroke.color_mut().copy_from_slice(color);
        }
    });
    if let Some(&background) = colors.next().filter(|_| !drawing.background_fixed) {
        drawing.change_background(|color| *color = background);
    }
}
