//! A fit under way: the state that its phases share, and how a checkpoint keeps it.

use std::time::Duration;

use fearless_simd::Level;

use super::anneal::Annealing;
use super::base::Base;
use super::bounds::Bounds;
use super::budget;
use super::checkpoint::{self, Checkpoint};
use super::config::{Background, Colors, Config, Look};
use super::deadline::{Deadline, Timer, Unlimited};
use super::descent::{Course, Descent};
use super::drawing::{Drawing, Memento};
use super::file::{RenderedFile, Writer};
use super::focus::Focus;
use super::forecast::Forecast;
use super::history::{self, History};
use super::masking;
use super::order::Phase;
use super::plan::{Before, Plan};
use super::price::Price;
use super::progress::{CancelToken, Observer, Position, Tracker};
use super::recipe::Recipe;
use super::result::Stop;
use super::shading;
use super::surface::{Prepared, Surface};
use crate::clock::Instant;
use crate::error::Result;
use crate::image::Image;
use crate::metrics::psnr_db;
use crate::scene::{Scene, Shade};
use crate::svg::Form;

/// A fit under way: first the fields that are fixed, then those that change.
pub(super) struct Session<'a> {
    pub(super) config: &'a Config,
    pub(super) recipe: Recipe,
    pub(super) base: Option<&'a Base>,
    pub(super) focus: Option<Focus>,
    /// How much an error counts at each pixel while strokes are fitted: as `focus` says, and as it is seen.
    pub(super) weights: Option<Focus>,
    /// The radii of the pens, px, the thinnest first; none if strokes may have any.
    pub(super) radii: Vec<f32>,
    /// The picture to reproduce.
    pub(super) target: Image,
    pub(super) annealing: Annealing,
    pub(super) plan: Plan,
    /// Most strokes of the drawing.
    pub(super) limit: usize,
    /// What each stroke has to be worth.
    pub(super) price: Price,
    pub(super) writer: Writer<'a>,

    pub(super) drawing: Drawing,
    pub(super) history: History,
    /// The best file so far.
    pub(super) best: Option<RenderedFile>,
    pub(super) progress: Tracker<'a>,
    pub(super) timer: Timer,

    /// The current phase.
    pub(super) phase: Phase,
    /// The descent in which a resumed fit was cut off, until its phase takes it up again.
    pub(super) resumed: Option<Descent>,
    /// How long the fit may go on once it is asked to stop; `None` since it was.
    grace: Option<Duration>,
    keeper: Option<Keeper<'a>>,
}

/// Task of a fit: the configuration, the base, where errors count, and the size of the picture, px, if a reduced one is drawn.
pub(super) type Wishes<'a> = (
    &'a Config,
    Option<&'a Base>,
    Option<Focus>,
    Option<[u32; 2]>,
);

/// Who is told of a fit and may stop it, and how long the fit may then go on.
pub(super) struct Watch<'a> {
    pub(super) observer: &'a mut (dyn Observer + Send),
    pub(super) token: CancelToken,
    pub(super) grace: Duration,
}

/// The checkpoint that the state is written to.
struct Keeper<'a> {
    checkpoint: &'a mut Checkpoint,
    /// Identifies the fit.
    fingerprint: u64,
    /// Whether the last state has been kept.
    is_final: bool,
}

/// The state of a fit as a checkpoint holds it.
type State = (Phase, History, Memento, Position, Duration, Option<Descent>);

impl<'a> Session<'a> {
    pub(super) fn new(
        picture: &Image,
        (config, base, focus, page): Wishes<'a>,
        level: Level,
        watch: Watch<'a>,
        started: Instant,
    ) -> Result<Self> {
        let pixels = picture.width() * picture.height();
        let recipe = budget::recipe(config, base, picture);
        let limit = budget::strokes(config, &recipe, base, picture);
        let before = Before::of(base);
        let plan = Plan::new(config, &recipe, limit, before, pixels);
        let page_width = Base::page_width(base, &config.file);
        let pens = config.pens.as_ref();
        let radii = pens.map_or(Ok(Vec::new()), |pens| pens.radii(page_width, picture))?;
        let widest = radii.last().copied().unwrap_or(f32::INFINITY);
        let coarsest = coarsest(&plan, before, config, base).min(widest);
        let Prepared {
            target,
            mut surfaces,
            background_fixed,
            shade,
        } = Prepared::new(
            picture,
            choose_background(picture, config, base, &recipe),
            base,
            &recipe,
            coarsest,
        )?;
        let weights = match config.look() {
            Look::Exact => focus.clone(),
            Look::Eye => {
                let seen = masking::weights(&target, recipe.masking);
                Some(focus.iter().fold(seen, |seen, focus| seen.times(focus)))
            }
        };
        for surface in &mut surfaces {
            surface.focus_on(weights.as_ref());
        }
        let annealing = Annealing {
            coverage: config.coverage,
            edge: recipe.edge,
        };
        let resolution = (surfaces[0].grid(), surfaces[0].halvings());
        let bounds = Bounds::new(resolution, recipe.domain, config.opaque, &radii);
        let edge = annealing.last();
        let mut drawing = Drawing::new(surfaces, (background_fixed, shade), bounds, edge, level);
        let records = base.map_or_else(Vec::new, |base| history::load(&mut drawing, base));
        let deadline: Box<dyn Deadline> = match config.budget.time {
            Some(limit) => Box::new(forecast(limit, config, &recipe, &drawing)),
            None => Box::new(Unlimited),
        };
        let planned = (plan.strokes() * recipe.iterations(config.polish)) as f64;
        Ok(Self {
            config,
            recipe,
            base,
            focus,
            weights,
            radii,
            target,
            annealing,
            limit: budget::max_strokes(config, limit, base, pixels),
            price: Price::of(config, recipe.points.beyond_db, pixels),
            writer: Writer::of(config, base, page),
            drawing,
            history: History::new(
                records,
                recipe.correction.db_per_doubling,
                budget::planned_stop(&config.budget),
            ),
            best: None,
            progress: Tracker::new(
                watch.observer,
                watch.token,
                planned,
                plan.len(),
                !watch.grace.is_zero(),
            ),
            plan,
            timer: Timer::new(started, deadline),
            phase: Phase::first(config, base),
            resumed: None,
            grace: Some(watch.grace).filter(|grace| !grace.is_zero()),
            keeper: None,
        })
    }

    /// Plans the stages for the strokes that are missing.
    pub(super) fn plan_rest(&mut self) {
        let [layers, strokes] = self.history.traced;
        let before = Before::of(self.base);
        let before = Before {
            layers: before.layers + layers,
            strokes: before.strokes + strokes,
        };
        let limit = budget::strokes(self.config, &self.recipe, self.base, &self.target);
        let pixels = self.drawing.pixels();
        self.plan = Plan::new(self.config, &self.recipe, limit, before, pixels);
    }

    /// The descent in which the fit was cut off, or else a new one that follows `course`.
    pub(super) fn descent(&mut self, course: Course) -> Descent {
        let (drawing, recipe, used) = (&self.drawing, &self.recipe, self.timer.used());
        self.resumed
            .take()
            .unwrap_or_else(|| Descent::new(drawing, recipe, course, used))
    }

    /// Counts an iteration of the free strokes, after which the mean squared error is `mse` and the descent has `left`
    /// more of them. Returns whether to go on.
    pub(super) fn advance(&mut self, left: usize, mse: f64) -> bool {
        self.timer.step(self.drawing.len());
        let strokes = self.drawing.free().len();
        let polish = match self.phase.precedes_polish(self.config) {
            true => self.drawing.len() * self.recipe.polish.iterations,
            false => 0,
        };
        let rest = strokes * left + polish;
        self.progress.advance(strokes, rest, self.timer.used());
        if self.timer.is_over() {
            self.progress.stop(Stop::Time);
        }
        self.progress.tell(&self.drawing, mse) && self.progress.stopped().is_none()
    }

    /// Whether the fit was asked to stop, and is finishing its drawing.
    pub(super) fn is_leaving(&self) -> bool {
        self.progress.is_interrupted()
    }

    /// Sets a deadline when the fit has been asked to stop. Returns whether that happened just now.
    pub(super) fn heed(&mut self) -> bool {
        if !self.is_leaving() {
            return false;
        }
        let Some(grace) = self.grace.take() else {
            return false;
        };
        let elapsed = self.timer.elapsed();
        let left = self
            .config
            .budget
            .time
            .map(|limit| limit.saturating_sub(elapsed));
        let limit = left.map_or(grace, |left| left.min(grace));
        let deadline = forecast(limit, self.config, &self.recipe, &self.drawing);
        self.timer.restart(Box::new(deadline));
        true
    }

    /// Measures from time to time, if the time is limited, how long it takes to write and render the drawing.
    pub(super) fn rehearse(&mut self) -> Result<()> {
        if self.timer.wants_rehearsal() {
            self.render_file()?;
        }
        Ok(())
    }

    /// Rounds, writes and renders the drawing.
    pub(super) fn render_file(&mut self) -> Result<RenderedFile> {
        let (writer, drawing) = (self.writer, &self.drawing);
        self.timer.writing(drawing.len(), || writer.render(drawing))
    }

    /// The same, while `other` work goes on with the drawing as it is written.
    pub(super) fn render_file_beside<T: Send>(
        &mut self,
        other: impl FnOnce(&Scene, &[Surface]) -> T + Send,
    ) -> Result<(RenderedFile, T)> {
        let (writer, drawing) = (self.writer, &self.drawing);
        let render = || writer.render_beside(drawing, other);
        self.timer.writing(drawing.len(), render)
    }

    /// The price of strokes and points in the current drawing.
    pub(super) fn price_now(&mut self) -> Price {
        // What is free is so in every drawing, which need not be rendered to say so.
        if self.price.per_byte() == 0.0 {
            return self.price;
        }
        self.price.at(self.drawing.mse(), self.drawing.pixels())
    }

    /// Bytes of the drawing as a file; about, if its strokes will come to share pens, which makes them shorter.
    pub(super) fn bytes(&self) -> usize {
        if self.config.file.form != Form::Smallest {
            return self.writer.bytes(&self.drawing);
        }
        let strokes = self.drawing.free().iter();
        let strokes: usize = strokes.map(|stroke| self.price.bytes_of(stroke)).sum();
        let layers = self.drawing.stage_sizes().len();
        let empty = self.base.map_or(budget::FILE_BYTES, Base::bytes);
        empty + layers * budget::LAYER_BYTES + strokes
    }

    /// Number of layers of the drawing that are joined with the one below because they would take much of a budget of bytes.
    pub(super) fn layers_to_join(&self) -> usize {
        let Some(most) = self
            .config
            .budget
            .bytes
            .filter(|_| !self.config.progressive)
        else {
            return 0;
        };
        let kept = Before::of(self.base).layers.max(1);
        let more = self.drawing.stage_sizes().len().saturating_sub(kept);
        let bytes = (more * budget::LAYER_BYTES) as f64;
        if bytes > LAYERS_SHARE * most as f64 {
            more
        } else {
            0
        }
    }

    /// Makes `file`, rendered from the current drawing, the best file so far.
    pub(super) fn set_best(&mut self, file: RenderedFile) {
        self.history.best = Some(self.drawing.memento());
        self.best = Some(file);
    }

    /// Takes down why a fit ends that aims at a fidelity of `wanted_db`.
    pub(super) fn stop_at(&mut self, wanted_db: f64) {
        let best_db = self.best.as_ref().map_or(0.0, |best| psnr_db(best.mse));
        self.history.stop_at(wanted_db, best_db);
    }

    /// What cut the fit short, if anything did.
    pub(super) fn cut_by(&self) -> Option<Stop> {
        if self.is_leaving() {
            return Some(Stop::Interrupted);
        }
        let hurried = self.timer.is_hurried().then_some(Stop::Time);
        self.progress.stopped().or(hurried)
    }

    /// Goes on from the state in `checkpoint`, if it holds one, and keeps the state there from now on.
    pub(super) fn resume(&mut self, checkpoint: &'a mut Checkpoint) -> Result<()> {
        let fingerprint = checkpoint::fingerprint(
            &self.target,
            self.config,
            &self.recipe,
            self.base,
            self.focus.as_ref(),
        );
        match checkpoint.load::<State>(fingerprint)? {
            Some((phase, history, drawing, position, elapsed, descent)) => {
                if let Some(best) = history.best.clone() {
                    self.drawing.restore(best);
                    self.best = Some(self.writer.render(&self.drawing)?);
                }
                self.drawing.restore(drawing);
                (self.phase, self.history, self.resumed) = (phase, history, descent);
                self.progress.position = position;
                self.plan_rest();
                self.timer.resume(elapsed);
            }
            // A checkpoint that cannot be written is refused before any work is done.
            None => checkpoint.write(fingerprint, &self.state(None))?,
        }
        self.keeper = Some(Keeper {
            checkpoint,
            fingerprint,
            is_final: false,
        });
        Ok(())
    }

    /// The current [`State`], to be written.
    fn state<'s>(&'s self, descent: Option<&'s Descent>) -> impl serde::Serialize + 's {
        (
            self.phase,
            &self.history,
            self.drawing.memento(),
            self.progress.position,
            self.timer.elapsed(),
            descent,
        )
    }

    /// Keeps the state, with the `descent` under way, if that is due: at intervals, before a phase that cannot be
    /// divided, at the end, and when the fit is interrupted. What an interrupted fit does after that, to finish its
    /// drawing quickly, is not kept.
    pub(super) fn keep(&mut self, descent: Option<&Descent>) {
        let Some(keeper) = self.keeper.take() else {
            return;
        };
        let is_resumable = descent.is_none() || self.phase.is_divisible();
        let is_interrupted = self.progress.is_interrupted();
        let is_due = keeper.checkpoint.is_due() || is_interrupted || self.phase.is_milestone();
        if is_resumable && is_due && !keeper.is_final {
            keeper
                .checkpoint
                .keep(keeper.fingerprint, &self.state(descent));
        }
        self.keeper = Some(keeper);
        self.seal();
    }

    /// Stops keeping the state if the fit was interrupted: a phase that was cut short is nothing to go on from.
    pub(super) fn seal(&mut self) {
        let is_interrupted = self.progress.is_interrupted();
        if let Some(keeper) = &mut self.keeper {
            keeper.is_final |= is_interrupted;
        }
    }
}

/// Most of a budget of bytes, as a share, that is for layers.
const LAYERS_SHARE: f64 = 0.03;

/// The background and the shade of a new drawing. A shade, with `auto`, replaces the background. It has any colours and
/// opacities, so that a drawing of few colours or of given pens has none, and neither has one of opaque strokes that is
/// transparent.
fn choose_background(
    picture: &Image,
    config: &Config,
    base: Option<&Base>,
    recipe: &Recipe,
) -> (Background, Option<Shade>) {
    let may_be = base.is_none()
        && config.background == Background::Auto
        && config.colors == Colors::Free
        && config.pens.is_none()
        && !(config.opaque && picture.alpha().is_some());
    let pixels = picture.width() * picture.height();
    let price = Price::of(config, recipe.points.beyond_db, pixels);
    let choose = || shading::choose(picture, &recipe.background.shade, price.per_byte());
    let shade = may_be.then(choose).flatten();
    let background = match shade {
        Some(_) => Background::None,
        None => config.background,
    };
    (background, shade)
}

/// The forecast of a fit that has a time `limit`.
fn forecast(limit: Duration, config: &Config, recipe: &Recipe, drawing: &Drawing) -> Forecast {
    let is_transparent = drawing.surfaces.len() > 1;
    let needs_file = budget::needs_file(&config.budget, recipe);
    Forecast::new(limit, drawing.pixels(), is_transparent, needs_file, recipe)
}

/// The scale of the first stage, px, which sets the resolution that the drawing begins at; 0 for full resolution.
fn coarsest(plan: &Plan, before: Before, config: &Config, base: Option<&Base>) -> f32 {
    // A reduced picture flatters a base, so that its fidelity has to be measured at full resolution.
    if base.is_some() && config.budget.psnr_db.is_some() {
        return 0.0;
    }
    let first = plan.stage(before.layers, before.strokes);
    first.map_or(0.0, |stage| stage.scale)
}
