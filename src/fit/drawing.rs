//! The state of a fit: the strokes so far and the canvas that they make.

use fearless_simd::Level;

use super::anneal::final_softness;
use super::config::Config;
use super::descent::Limits;
use super::objective::Objective;
use crate::image::Image;
use crate::loss::Loss;
use crate::render::{Base, Canvas, Gradients, Params, Renderer, Softness, pack, unpack};
use crate::scene::{Rgb, Scene, Stage};
use crate::seed::Pyramid;

/// Least opacity of a stroke: the 8-bit compositing of renderers drifts by levels under many layers
/// fainter than this.
const LEAST_OPACITY: f32 = 0.1;

/// A drawing under work.
pub(super) struct Drawing {
    pub(super) level: Level,
    /// The picture, on its ground.
    pub(super) target: Canvas,
    pub(super) pyramid: Pyramid,
    pub(super) renderer: Renderer,
    pub(super) background: Rgb,
    /// Whether the background is not to be fitted.
    pub(super) background_fixed: bool,
    /// Back to front.
    pub(super) strokes: Vec<Params>,
    /// The stage of each stroke, counted from 0, never decreasing.
    pub(super) stage_of: Vec<usize>,
    /// What all of it looks like with the edge of the finished drawing.
    pub(super) canvas: Canvas,
    pub(super) limits: Limits,
    edge: Softness,
    seed: u64,
    /// How often strokes were sought.
    searches: u64,
}

impl Drawing {
    pub(super) fn new(target: &Image, config: &Config, level: Level) -> Self {
        let canvas = Canvas::from_image(target);
        let grid = canvas.grid();
        let (background, background_fixed) = config.background.choose(target);
        let least_opacity = if config.opaque { 1.0 } else { LEAST_OPACITY };
        Self {
            level,
            target: canvas,
            pyramid: Pyramid::new(target.clone()),
            renderer: Renderer::new(grid, level),
            background,
            background_fixed,
            strokes: Vec::new(),
            stage_of: Vec::new(),
            canvas: Canvas::flat(grid, background),
            limits: Limits::new(grid.width, grid.height, least_opacity),
            edge: final_softness(config.coverage.late),
            seed: config.seed,
            searches: 0,
        }
    }

    /// The picture's number of pixels.
    pub(super) fn pixels(&self) -> usize {
        self.target.grid().width * self.target.grid().height
    }

    /// Side of the square that each of `count` strokes would have to itself, px.
    pub(super) fn spacing(&self, count: usize) -> f32 {
        (self.pixels() as f32 / count.max(1) as f32).sqrt()
    }

    /// The random key of the next search for strokes.
    pub(super) fn next_key(&mut self) -> [u64; 2] {
        self.searches += 1;
        [self.seed, self.searches]
    }

    /// The number of the stage on top, from 0.
    pub(super) fn last_stage(&self) -> usize {
        self.stage_of.last().copied().unwrap_or(0)
    }

    /// Puts `strokes` on top, as part of stage `stage`; `self.canvas` shows them from then on.
    pub(super) fn extend(&mut self, strokes: Vec<Params>, stage: usize) {
        let below = self.canvas.clone();
        self.renderer
            .forward(&strokes, self.edge, Base::Canvas(&below), &mut self.canvas);
        self.stage_of
            .resize(self.stage_of.len() + strokes.len(), stage);
        self.strokes.extend(strokes);
    }

    /// Keeps the strokes for which `keep` is true. The canvas is not rendered again.
    pub(super) fn retain(&mut self, keep: &[bool]) {
        let kept = |i: usize| keep.get(i).copied().unwrap_or(false);
        let mut i = 0..;
        self.strokes.retain(|_| i.next().is_some_and(kept));
        let mut i = 0..;
        self.stage_of.retain(|_| i.next().is_some_and(kept));
    }

    /// Renders everything.
    pub(super) fn render(&mut self) {
        let base = Base::Flat(self.background);
        self.renderer
            .forward(&self.strokes, self.edge, base, &mut self.canvas);
    }

    /// Loss, gradients and worth of all strokes at the final edge.
    pub(super) fn judge(&mut self) -> Gradients {
        let mut gradients = Gradients::default();
        let objective = Objective::new(Loss::L2, &self.target);
        let base = Base::Flat(self.background);
        self.renderer.backward_with_worth(
            &self.strokes,
            self.edge,
            base,
            &objective,
            &mut gradients,
        );
        gradients
    }

    /// The mean squared error of the drawing.
    pub(super) fn mse(&mut self) -> f64 {
        self.judge().loss
    }

    /// Our render of `scene`, with the background of this drawing where it has none.
    pub(super) fn soft(&mut self, scene: &Scene) -> Image {
        let strokes: Vec<Params> = scene.strokes().map(pack).collect();
        let base = Base::Flat(scene.background.unwrap_or(self.background));
        self.renderer
            .forward(&strokes, self.edge, base, &mut self.canvas);
        self.canvas.to_image()
    }

    /// The drawing as a scene, unrounded, with the background if it `has_ground`.
    pub(super) fn scene(&self, has_ground: bool) -> Scene {
        let grid = self.target.grid();
        let background = has_ground.then_some(self.background);
        let mut scene = Scene::empty(grid.width as u32, grid.height as u32, background);
        for (stroke, &stage) in self.strokes.iter().zip(&self.stage_of) {
            if scene.stages.len() <= stage {
                scene.stages.resize(stage + 1, Stage::default());
            }
            scene.stages[stage].strokes.push(unpack(stroke));
        }
        scene
    }
}
