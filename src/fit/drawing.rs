//! The state of a fit: the strokes so far and the canvas that they make.

use fearless_simd::Level;

use super::anneal::Anneal;
use super::config::Config;
use super::descent::Limits;
use super::objective::Objective;
use crate::image::Image;
use crate::loss::Loss;
use crate::render::{Base, Canvas, Gradients, Params, Renderer};
use crate::seed::Pyramid;

pub(super) struct Drawing {
    pub(super) level: Level,
    pub(super) target: Canvas,
    pub(super) pyramid: Pyramid,
    pub(super) renderer: Renderer,
    pub(super) background: [f32; 3],
    /// Back to front.
    pub(super) strokes: Vec<Params>,
    /// Strokes of each stage, in order; they add up to `strokes.len()`.
    pub(super) stages: Vec<usize>,
    /// What all of it looks like at the final softness.
    pub(super) canvas: Canvas,
    pub(super) limits: Limits,
}

impl Drawing {
    pub(super) fn new(target: &Image, background: [f32; 3], config: &Config, level: Level) -> Self {
        let canvas = Canvas::from_image(target);
        let grid = canvas.grid();
        let least_opacity = if config.opaque { 1.0 } else { LEAST_OPACITY };
        Self {
            level,
            target: canvas,
            pyramid: Pyramid::new(target.clone()),
            renderer: Renderer::new(grid, level),
            background,
            strokes: Vec::new(),
            stages: Vec::new(),
            canvas: Canvas::flat(grid, background),
            limits: Limits::new(grid.width, grid.height, least_opacity),
        }
    }

    pub(super) fn pixels(&self) -> usize {
        self.canvas.grid().width * self.canvas.grid().height
    }

    /// Renders everything at the final softness.
    pub(super) fn render(&mut self, anneal: &Anneal) {
        let base = Base::Flat(self.background);
        self.renderer
            .forward(&self.strokes, anneal.last(), base, &mut self.canvas);
    }

    /// Mean squared error of the canvas.
    pub(super) fn mse(&mut self) -> f64 {
        let mut gradients = Gradients::default();
        let objective = Objective::new(Loss::L2, &self.target);
        let softness = crate::render::Softness {
            coverage: crate::coverage::Coverage::Smoothstep,
            width: 1.0,
        };
        self.renderer.backward(
            &[],
            softness,
            Base::Canvas(&self.canvas),
            &objective,
            &mut gradients,
        );
        gradients.loss
    }
}

/// Least opacity of a stroke: below about 0.15 the 8-bit compositing of renderers drifts.
pub(super) const LEAST_OPACITY: f32 = 0.1;
