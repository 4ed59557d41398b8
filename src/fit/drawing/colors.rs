//! The colours of a drawing: those it would like to have, and those it is given.

use super::{Drawing, views};
use crate::fit::objective::View;
use crate::render::{CanvasLoss, Gradients, Lanes, OPACITY, Params, RED, TileRgb};
use crate::scene::Rgb;

/// The colour that a stroke, or the background, would like to have if the others stayed as they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::fit) struct Wish {
    pub(in crate::fit) color: Rgb,
    /// By how much the squared error grows with the squared distance from it.
    pub(in crate::fit) weight: f32,
}

/// Pixels that a stroke has to show in for its colour to matter.
const MIN_SHOWN: f32 = 1e-3;

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

impl Drawing {
    /// The colours that the strokes, and at last the background if there is one, would like to have after a share
    /// `damping` of their Newton steps. All strokes must be free.
    pub(in crate::fit) fn wishes(&mut self, damping: f32) -> Vec<Wish> {
        let slopes = self.judge();
        let mut shown = Gradients::default();
        // What a stroke shows of itself is the same on every ground.
        for View { base, .. } in views(&self.grounds, 0).iter().take(1) {
            self.renderer
                .backward(&self.strokes, self.edge, *base, &Shown, &mut shown);
        }
        // The loss is a mean over channels, too.
        let values = (3 * self.pixels()) as f32 / self.pixel_area();
        let wish = |color: Rgb, slope: Rgb, weight: f32| {
            // A hidden stroke has no wish.
            let step = if weight > MIN_SHOWN {
                damping * values / (2.0 * weight)
            } else {
                0.0
            };
            let moved = |c: usize| color[c] - (step * slope[c]).clamp(-1.0, 1.0);
            let color = [0, 1, 2].map(|c| moved(c).clamp(0.0, 1.0));
            Wish { color, weight }
        };
        let rgb = |p: &Params| [p[RED], p[RED + 1], p[RED + 2]];
        let strokes = self.strokes.iter().zip(&slopes.strokes).zip(&shown.strokes);
        let wishes = strokes.map(|((stroke, slope), shown)| {
            // The square of a share is at most the share times the opacity.
            wish(rgb(stroke), rgb(slope), shown[RED] * stroke[OPACITY])
        });
        let ground = self.background();
        let ground = ground.map(|color| wish(color, slopes.backdrop, shown.backdrop[0]));
        wishes.chain(ground).collect()
    }

    /// Gives the strokes, and at last the background unless it is fixed, these colours. All strokes must be free.
    pub(in crate::fit) fn set_colors(&mut self, colors: &[Rgb]) {
        let mut colors = colors.iter();
        for (stroke, color) in self.strokes.iter_mut().zip(colors.by_ref()) {
            stroke[RED..OPACITY].copy_from_slice(color);
        }
        if let Some(&ground) = colors.next().filter(|_| !self.background_fixed) {
            self.change_background(|color| *color = ground);
        }
    }
}
