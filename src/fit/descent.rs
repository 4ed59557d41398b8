//! Gradient descent on the numbers of strokes: one step, its rates and its limits.

use serde::{Deserialize, Serialize};

use super::objective::{View, differentiate};
use super::recipe::Rates;
use crate::optim::{Adam, AdamParams, Optimizer};
use crate::render::{AX, BY, Gradients, OPACITY, PARAMS, Params, RADIUS, RED, Renderer, Softness};

/// Least radius of a stroke, px: widths of 1 px and less are drawn as hairlines, with other ink.
pub(super) const MIN_RADIUS: f32 = 0.51;

/// The domain of each parameter; a step that leaves it is brought back.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Limits {
    /// Ends stay within this many px around the picture.
    pub(super) margin: f32,
    pub(super) width: f32,
    pub(super) height: f32,
    pub(super) min_opacity: f32,
}

impl Limits {
    pub(super) fn new(width: usize, height: usize, min_opacity: f32) -> Self {
        Self {
            margin: 8.0,
            width: width as f32,
            height: height as f32,
            min_opacity,
        }
    }

    fn largest_radius(&self) -> f32 {
        self.width.max(self.height)
    }

    /// Brings `p` into the domain. Numbers that are not finite are left; the stroke is dropped later.
    pub(super) fn apply(&self, p: &mut Params) {
        let far = [self.width + self.margin, self.height + self.margin];
        for k in AX..=BY {
            p[k] = p[k].clamp(-self.margin, far[k % 2]);
        }
        p[RADIUS] = p[RADIUS].clamp(MIN_RADIUS, self.largest_radius());
        for color in &mut p[RED..OPACITY] {
            *color = color.clamp(0.0, 1.0);
        }
        p[OPACITY] = p[OPACITY].clamp(self.min_opacity, 1.0);
    }
}

/// The optimiser of a set of strokes, with its memory.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Descent {
    adam: Adam<f32>,
    rates: Params,
    scales: Vec<f32>,
    limits: Limits,
    /// Those of the last step.
    #[serde(skip)]
    pub(super) gradients: Gradients,
}

impl Descent {
    pub(super) fn new(strokes: &[Params], rates: Rates, limits: Limits) -> Self {
        let Rates {
            position,
            radius,
            color,
            opacity,
            ..
        } = rates;
        let rates = [
            position, position, position, position, radius, color, color, color, opacity,
        ];
        Self {
            adam: Adam::new(strokes.len() * PARAMS, ADAM),
            rates,
            scales: scales(&rates, strokes),
            limits,
            gradients: Gradients::default(),
        }
    }

    /// One step of all `strokes` down the gradient of the mean loss over `views`, at `rate` times the
    /// rates.
    pub(super) fn step(
        &mut self,
        renderer: &mut Renderer,
        strokes: &mut [Params],
        softness: Softness,
        views: &[View<'_>],
        rate: f32,
    ) {
        differentiate::<false>(renderer, strokes, softness, views, &mut self.gradients);
        let flat = self.gradients.strokes.as_flattened();
        self.adam
            .step_scaled(strokes.as_flattened_mut(), flat, rate, &self.scales);
        for p in strokes {
            self.limits.apply(p);
        }
    }

    /// Follows a rearrangement into `strokes`: the i-th was the `sources[i]`-th, or is new.
    pub(super) fn rearrange(&mut self, strokes: &[Params], sources: &[Option<usize>]) {
        self.adam.rearrange(PARAMS, sources);
        self.scales = scales(&self.rates, strokes);
    }
}

/// Radius, px, of a stroke whose geometry moves at the rates as they are. Others move with the root of
/// their radius: at one rate for all, large strokes are slow and small ones jitter, for 0.04 dB less.
const USUAL_RADIUS: f32 = 2.0;

/// The step sizes of all numbers of `strokes`.
fn scales(rates: &Params, strokes: &[Params]) -> Vec<f32> {
    let mut scales = rates.repeat(strokes.len());
    for (rates, stroke) in scales.chunks_exact_mut(PARAMS).zip(strokes) {
        let factor = (stroke[RADIUS] / USUAL_RADIUS).sqrt().clamp(0.25, 4.0);
        rates[AX..=RADIUS]
            .iter_mut()
            .for_each(|rate| *rate *= factor);
    }
    scales
}

/// Short memory for the squares: gradients shrink fast, and change whenever neighbours are relocated. With
/// 0.99 drafts have 0.15 dB less, and fits of thousands of steps 0.06.
const ADAM: AdamParams = AdamParams {
    betas: [0.9, 0.9],
    eps: 1e-10,
};
