//! The state of a fit: the strokes so far, how many of them are frozen, and the canvas they make.

use fearless_simd::Level;

use super::anneal::final_softness;
use super::config::Config;
use super::descent::{Descent, Limits};
use super::objective::Objective;
use crate::image::Image;
use crate::loss::Loss;
use crate::render::{
    AX, Base, Canvas, Gradients, Params, RADIUS, Renderer, Softness, pack, unpack,
};
use crate::scene::{Rgb, Scene, Stage};
use crate::seed::{Candidate, Pyramid, Wanted, propose};

/// Least opacity of a stroke: the 8-bit compositing of renderers drifts by levels under many layers
/// fainter than this.
const LEAST_OPACITY: f32 = 0.1;

/// Strokes are fitted at the coarsest resolution at which they still have this typical radius, px. Less,
/// and their edges are fitted to pixels that are not there; more, and time is spent on pixels that say
/// nothing about them.
const LEAST_SCALE: f32 = 2.5;

/// A drawing under work. What is fitted, judged and relocated are its *free* strokes; the frozen ones
/// below them are a picture. Large strokes are fitted to a reduced picture: the numbers of strokes are
/// in px of the current level of the pyramid, what goes in and out of the methods in px of the picture.
pub(super) struct Drawing {
    /// How many times the picture is halved.
    halvings: usize,
    /// The picture, at the current level.
    target: Canvas,
    pyramid: Pyramid,
    renderer: Renderer,
    level: Level,
    pub(super) background: Rgb,
    /// Whether the background is not to be fitted.
    pub(super) background_fixed: bool,
    /// Back to front.
    strokes: Vec<Params>,
    /// The stage of each stroke, counted from 0, never decreasing.
    stage_of: Vec<usize>,
    /// How many strokes, from the back, are frozen.
    frozen: usize,
    /// The picture of the frozen strokes on the background; unused when there is none.
    below: Canvas,
    /// The picture of all strokes as of the last [`render`](Self::render), with the final edge.
    canvas: Canvas,
    pub(super) limits: Limits,
    edge: Softness,
    seed: u64,
    /// How often strokes were sought.
    searches: u64,
}

impl Drawing {
    /// An empty drawing at the resolution for strokes of `scale` px.
    pub(super) fn new(target: &Image, scale: f32, config: &Config, level: Level) -> Self {
        let pyramid = Pyramid::new(target.clone());
        let halvings = resolution(&pyramid, scale);
        let canvas = Canvas::from_image(pyramid.level(halvings));
        let grid = canvas.grid();
        let (background, background_fixed) = config.background.choose(target);
        let least_opacity = if config.opaque { 1.0 } else { LEAST_OPACITY };
        Self {
            halvings,
            target: canvas,
            pyramid,
            renderer: Renderer::new(grid, level),
            level,
            background,
            background_fixed,
            strokes: Vec::new(),
            stage_of: Vec::new(),
            frozen: 0,
            below: Canvas::flat(grid, background),
            canvas: Canvas::flat(grid, background),
            limits: Limits::new(grid.width, grid.height, least_opacity),
            edge: final_softness(config.coverage.late),
            seed: config.seed,
            searches: 0,
        }
    }

    /// How many strokes there are, frozen ones included.
    pub(super) fn len(&self) -> usize {
        self.strokes.len()
    }

    /// The strokes that are not frozen, back to front.
    pub(super) fn free(&self) -> &[Params] {
        &self.strokes[self.frozen..]
    }

    /// Goes to the resolution for strokes of `scale` px, if that is finer than the current one; says
    /// whether it did. All strokes are free then.
    pub(super) fn refine(&mut self, scale: f32) -> bool {
        let halvings = resolution(&self.pyramid, scale);
        if halvings >= self.halvings {
            return false;
        }
        for stroke in &mut self.strokes {
            *stroke = enlarged(*stroke, self.halvings - halvings);
        }
        self.halvings = halvings;
        self.target = Canvas::from_image(self.pyramid.level(halvings));
        let grid = self.target.grid();
        self.renderer = Renderer::new(grid, self.level);
        self.below = Canvas::flat(grid, self.background);
        self.canvas = Canvas::flat(grid, self.background);
        self.limits = Limits::new(grid.width, grid.height, self.limits.least_opacity);
        self.frozen = 0;
        true
    }

    /// Pixels of the picture in one of the current level.
    fn pixel_area(&self) -> f32 {
        (1 << (2 * self.halvings)) as f32
    }

    /// Whether there are no frozen strokes, so that the background shows through to the fit.
    pub(super) fn is_thawed(&self) -> bool {
        self.frozen == 0
    }

    /// The picture's number of pixels.
    pub(super) fn pixels(&self) -> usize {
        self.pyramid.level(0).width() * self.pyramid.level(0).height()
    }

    /// Side of the square that each of `count` strokes would have to itself, px.
    pub(super) fn spacing(&self, count: usize) -> f32 {
        (self.pixels() as f32 / count.max(1) as f32).sqrt()
    }

    /// Freezes all strokes that there are.
    pub(super) fn freeze(&mut self) {
        self.render();
        self.below.clone_from(&self.canvas);
        self.frozen = self.strokes.len();
    }

    /// Frees all strokes.
    pub(super) fn thaw(&mut self) {
        self.frozen = 0;
    }

    /// Puts `strokes` on top, as part of stage `stage`.
    pub(super) fn extend(&mut self, strokes: impl IntoIterator<Item = Params>, stage: usize) {
        self.strokes.extend(strokes);
        self.stage_of.resize(self.strokes.len(), stage);
    }

    /// Keeps the free strokes for which `keep` is true.
    pub(super) fn retain_free(&mut self, keep: &[bool]) {
        let frozen = self.frozen;
        let kept = |i: usize| i < frozen || keep.get(i - frozen).copied().unwrap_or(false);
        let mut i = 0..;
        self.strokes.retain(|_| i.next().is_some_and(kept));
        let mut i = 0..;
        self.stage_of.retain(|_| i.next().is_some_and(kept));
    }

    /// Replaces the numbers of the free strokes.
    pub(super) fn set_free(&mut self, strokes: &[Params]) {
        self.strokes[self.frozen..].copy_from_slice(strokes);
    }

    /// The number of the stage on top, from 0.
    pub(super) fn last_stage(&self) -> usize {
        self.stage_of.last().copied().unwrap_or(0)
    }

    /// Candidates for strokes on top of all there are, best first.
    pub(super) fn propose(
        &mut self,
        count: usize,
        scale: f32,
        oversampling: f32,
    ) -> Vec<Candidate> {
        self.searches += 1;
        self.render();
        let area = self.pixel_area();
        let wanted = Wanted {
            count,
            scale: scale / area.sqrt(),
            oversampling,
            least_opacity: self.limits.least_opacity,
            level: self.halvings,
            key: [self.seed, self.searches],
        };
        let mut candidates = propose(self.level, &self.pyramid, &self.canvas, wanted);
        candidates.iter_mut().for_each(|c| c.gain *= area);
        candidates
    }

    /// One step of the free strokes towards the target.
    pub(super) fn step(&mut self, descent: &mut Descent, softness: Softness, rate: f32) {
        let base = base(self.frozen, &self.below, self.background);
        let objective = Objective::new(Loss::L2, &self.target);
        let free = &mut self.strokes[self.frozen..];
        descent.step(&mut self.renderer, free, softness, base, &objective, rate);
    }

    /// One step of the free strokes towards another target, with the final edge.
    pub(super) fn step_towards(&mut self, target: &Canvas, descent: &mut Descent, rate: f32) {
        let base = base(self.frozen, &self.below, self.background);
        let objective = Objective::new(Loss::L2, target);
        let free = &mut self.strokes[self.frozen..];
        descent.step(&mut self.renderer, free, self.edge, base, &objective, rate);
    }

    /// Renders everything.
    pub(super) fn render(&mut self) {
        let base = base(self.frozen, &self.below, self.background);
        self.renderer.forward(
            &self.strokes[self.frozen..],
            self.edge,
            base,
            &mut self.canvas,
        );
    }

    /// Loss, gradients and worth of the free strokes at the final edge.
    pub(super) fn judge(&mut self) -> Gradients {
        let mut gradients = Gradients::default();
        let objective = Objective::new(Loss::L2, &self.target);
        let base = base(self.frozen, &self.below, self.background);
        let free = &self.strokes[self.frozen..];
        self.renderer
            .backward_with_worth(free, self.edge, base, &objective, &mut gradients);
        let area = self.pixel_area();
        gradients.worth.iter_mut().for_each(|worth| *worth *= area);
        gradients
    }

    /// The mean squared error of the drawing; at a reduced resolution, of what can be seen there.
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

    /// The mean squared error after each layer of `scene`.
    pub(super) fn layer_mses(&mut self, scene: &Scene) -> Vec<f64> {
        let objective = Objective::new(Loss::L2, &self.target);
        let mut canvas = Canvas::flat(
            self.target.grid(),
            scene.background.unwrap_or(self.background),
        );
        let mut gradients = Gradients::default();
        let mut mses = Vec::new();
        for stage in &scene.stages {
            let strokes: Vec<Params> = stage.strokes.iter().map(pack).collect();
            let below = canvas.clone();
            self.renderer
                .forward(&strokes, self.edge, Base::Canvas(&below), &mut canvas);
            self.renderer.backward(
                &[],
                self.edge,
                Base::Canvas(&canvas),
                &objective,
                &mut gradients,
            );
            mses.push(gradients.loss);
        }
        mses
    }

    /// The drawing as a scene in px of the picture, unrounded, with the background if it `has_ground`.
    pub(super) fn scene(&self, has_ground: bool) -> Scene {
        let picture = self.pyramid.level(0);
        let background = has_ground.then_some(self.background);
        let mut scene = Scene::empty(picture.width() as u32, picture.height() as u32, background);
        for (&stroke, &stage) in self.strokes.iter().zip(&self.stage_of) {
            if scene.stages.len() <= stage {
                scene.stages.resize(stage + 1, Stage::default());
            }
            scene.stages[stage]
                .strokes
                .push(unpack(&enlarged(stroke, self.halvings)));
        }
        scene
    }
}

/// The stroke at a resolution that is twice as fine `doublings` times.
fn enlarged(mut stroke: Params, doublings: usize) -> Params {
    let factor = (1_u32 << doublings) as f32;
    for length in &mut stroke[AX..=RADIUS] {
        *length *= factor;
    }
    stroke
}

/// What lies behind the free strokes.
fn base(frozen: usize, below: &Canvas, background: Rgb) -> Base<'_> {
    if frozen == 0 {
        Base::Flat(background)
    } else {
        Base::Canvas(below)
    }
}

/// How many halvings leave strokes of `scale` px their least scale.
fn resolution(pyramid: &Pyramid, scale: f32) -> usize {
    // Rounded down: `halvings` alone would bring the scale below the least.
    pyramid.halvings(0, scale / 2.0, LEAST_SCALE)
}
