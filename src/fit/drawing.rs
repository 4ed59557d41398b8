//! The state of a fit: the strokes so far, how many of them are frozen, and the canvas they make.

mod colors;
mod scene;
mod state;

use fearless_simd::Level;

use super::anneal::final_softness;
use super::config::Config;
use super::descent::{Descent, Limits};
use super::ground::{Ground, Setting};
use super::objective::{View, differentiate};
use crate::render::{Canvas, Gradients, Params, Renderer, Softness};
use crate::scene::Rgb;
use crate::seed::{Candidate, Wanted, propose};
pub(super) use colors::Wish;
use scene::enlarged;
pub(super) use state::State;

/// Least opacity of a stroke: the 8-bit compositing of renderers drifts by levels under many layers
/// fainter than this.
const MIN_OPACITY: f32 = 0.1;

/// A drawing under work. What is fitted, judged and relocated are its *free* strokes; the frozen ones
/// below them are a picture. Large strokes are fitted to a reduced picture: the numbers of strokes are
/// in px of the current level of the pyramid, what goes in and out of the methods in px of the picture.
pub(super) struct Drawing {
    /// What it is fitted on: one ground, or two for a transparent drawing.
    grounds: Vec<Ground>,
    renderer: Renderer,
    level: Level,
    /// Whether the colour of the ground is not to be fitted.
    pub(super) background_fixed: bool,
    /// Back to front.
    strokes: Vec<Params>,
    /// The stage of each stroke, counted from 0, never decreasing.
    stage_of: Vec<usize>,
    /// How many strokes, from the back, are frozen.
    frozen: usize,
    pub(super) limits: Limits,
    edge: Softness,
    seed: u64,
    /// How often strokes were sought.
    searches: u64,
    /// How many strokes became non-finite and were taken out.
    lost: usize,
}

impl Drawing {
    /// An empty drawing on the grounds of `setting`, which is left without any.
    pub(super) fn new(setting: &mut Setting, config: &Config, level: Level) -> Self {
        let grounds = std::mem::take(&mut setting.grounds);
        let grid = grounds[0].grid();
        let min_opacity = if config.opaque { 1.0 } else { MIN_OPACITY };
        Self {
            grounds,
            renderer: Renderer::new(grid, level),
            level,
            background_fixed: setting.is_fixed,
            strokes: Vec::new(),
            stage_of: Vec::new(),
            frozen: 0,
            limits: Limits::new(grid.width, grid.height, min_opacity),
            edge: final_softness(config.coverage.late),
            seed: config.seed,
            searches: 0,
            lost: 0,
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
        let grounds = self.grounds.iter_mut();
        let doublings = grounds
            .map(|ground| ground.refine(scale))
            .max()
            .unwrap_or(0);
        if doublings == 0 {
            return false;
        }
        for stroke in &mut self.strokes {
            *stroke = enlarged(*stroke, doublings);
        }
        self.cut_anew();
        true
    }

    /// Follows the grounds to another resolution, where all strokes are free; their numbers are left.
    fn cut_anew(&mut self) {
        let grid = self.ground().grid();
        self.renderer = Renderer::new(grid, self.level);
        self.limits = Limits::new(grid.width, grid.height, self.limits.min_opacity);
        self.frozen = 0;
    }

    /// The first ground; all agree in size and resolution.
    fn ground(&self) -> &Ground {
        &self.grounds[0]
    }

    /// All grounds.
    pub(super) fn grounds(&self) -> &[Ground] {
        &self.grounds
    }

    /// The colour behind all strokes, if there is one ground and it is flat.
    pub(super) fn background(&self) -> Option<Rgb> {
        match self.grounds.as_slice() {
            [ground] => ground.color(),
            _ => None,
        }
    }

    /// Changes the colour of the ground, if it is flat, and brings it into its domain.
    pub(super) fn change_background(&mut self, change: impl FnOnce(&mut Rgb)) {
        if let Some(color) = self.grounds[0].color_mut() {
            let mut moved = *color;
            change(&mut moved);
            // A step to nowhere is not taken: no stroke could make up for a page without a colour.
            if moved.iter().all(|c| c.is_finite()) {
                *color = moved.map(|c| c.clamp(0.0, 1.0));
            }
        }
    }

    /// Pixels of the picture in one of the current level.
    fn pixel_area(&self) -> f32 {
        (1 << (2 * self.ground().halvings())) as f32
    }

    /// Whether there are no frozen strokes, so that the background shows through to the fit.
    pub(super) fn is_thawed(&self) -> bool {
        self.frozen == 0
    }

    /// The picture's number of pixels.
    pub(super) fn pixels(&self) -> usize {
        self.ground().picture().width() * self.ground().picture().height()
    }

    /// Side of the square that each of `count` strokes would have to itself, px.
    pub(super) fn spacing(&self, count: usize) -> f32 {
        (self.pixels() as f32 / count.max(1) as f32).sqrt()
    }

    /// Freezes all strokes that there are. Their picture is made from nothing but them: made from that of
    /// earlier frozen ones it would differ in the last bits, and could not be made again from a
    /// [`State`].
    pub(super) fn freeze(&mut self) {
        self.thaw();
        self.render();
        self.grounds.iter_mut().for_each(Ground::freeze);
        self.frozen = self.strokes.len();
    }

    /// Frees all strokes.
    pub(super) fn thaw(&mut self) {
        self.grounds.iter_mut().for_each(Ground::thaw);
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
        let gone = self.free().iter().zip(keep).filter(|(_, keep)| !**keep);
        self.lost += gone
            .filter(|(p, _)| !p.iter().all(|v| v.is_finite()))
            .count();
        let kept = |i: usize| i < frozen || keep.get(i - frozen).copied().unwrap_or(false);
        let mut i = 0..;
        self.strokes.retain(|_| i.next().is_some_and(kept));
        let mut i = 0..;
        self.stage_of.retain(|_| i.next().is_some_and(kept));
    }

    /// How many strokes became non-finite and were taken out.
    pub(super) fn lost(&self) -> usize {
        self.lost
    }

    /// Replaces the numbers of the free strokes.
    pub(super) fn set_free(&mut self, strokes: &[Params]) {
        self.strokes[self.frozen..].copy_from_slice(strokes);
    }

    /// How many strokes each stage has, back to front; a stage without any may be missing.
    pub(super) fn stage_sizes(&self) -> Vec<usize> {
        let stages = self.stage_of.chunk_by(|a, b| a == b);
        stages.map(<[usize]>::len).collect()
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
            min_opacity: self.limits.min_opacity,
            level: self.ground().halvings(),
            key: [self.seed, self.searches],
        };
        let views: Vec<_> = self.grounds.iter().map(Ground::residual).collect();
        let mut candidates = propose(self.level, &views, wanted);
        candidates.iter_mut().for_each(|c| c.gain *= area);
        candidates
    }

    /// One step of the free strokes towards the target.
    pub(super) fn step(&mut self, descent: &mut Descent, softness: Softness, rate: f32) {
        let views = views(&self.grounds, self.frozen);
        let free = &mut self.strokes[self.frozen..];
        descent.step(&mut self.renderer, free, softness, &views, rate);
    }

    /// One step of the free strokes towards other targets, one per ground, with the final edge.
    pub(super) fn step_towards(&mut self, targets: &[Canvas], descent: &mut Descent, rate: f32) {
        let grounds = self.grounds.iter().zip(targets);
        let views: Vec<_> = grounds
            .map(|(ground, target)| ground.view(self.frozen, Some(target)))
            .collect();
        let free = &mut self.strokes[self.frozen..];
        descent.step(&mut self.renderer, free, self.edge, &views, rate);
    }

    /// Renders everything.
    pub(super) fn render(&mut self) {
        let free = &self.strokes[self.frozen..];
        for ground in &mut self.grounds {
            ground.render(&mut self.renderer, free, self.edge, self.frozen);
        }
    }

    /// Loss, gradients and worth of the free strokes at the final edge.
    pub(super) fn judge(&mut self) -> Gradients {
        let mut gradients = Gradients::default();
        let views = views(&self.grounds, self.frozen);
        let free = &self.strokes[self.frozen..];
        differentiate::<true>(&mut self.renderer, free, self.edge, &views, &mut gradients);
        let area = self.pixel_area();
        gradients.worth.iter_mut().for_each(|worth| *worth *= area);
        gradients
    }

    /// The mean squared error of the drawing; at a reduced resolution, of what can be seen there.
    pub(super) fn mse(&mut self) -> f64 {
        self.render();
        self.mse_of(self.grounds.iter().map(|ground| &ground.canvas))
    }
}

/// The grounds as the free strokes see them, on `frozen` others.
fn views(grounds: &[Ground], frozen: usize) -> Vec<View<'_>> {
    let view = |ground| Ground::view(ground, frozen, None);
    grounds.iter().map(view).collect()
}
