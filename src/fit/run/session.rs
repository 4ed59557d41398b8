//! A fit under way: the state that its phases share, and how a checkpoint keeps it.

use std::time::Duration;

use fearless_simd::Level;

use crate::clock::Instant;
use crate::error::Result;
use crate::fit::base::Base;
use crate::fit::budget;
use crate::fit::budget::plan::{Before, Plan};
use crate::fit::budget::price::Price;
use crate::fit::config::{Background, Colors, Config, ErrorWeighting};
use crate::fit::descent::anneal::Annealing;
use crate::fit::descent::{Course, Descent};
use crate::fit::drawing::bounds::Bounds;
use crate::fit::drawing::focus::Focus;
use crate::fit::drawing::masking;
use crate::fit::drawing::shadows::Terms;
use crate::fit::drawing::surface::{Prepared, Surface};
use crate::fit::drawing::{Drawing, Snapshot, background};
use crate::fit::file::{RenderedFile, Writer};
use crate::fit::order::{Phase, Purpose};
use crate::fit::recipe::{Rates, Recipe};
use crate::fit::result::Stop;
use crate::fit::run::checkpoint::{self, Checkpoint};
use crate::fit::run::history::{self, History};
use crate::fit::run::progress::{Position, Tracker, Watch};
use crate::fit::task::Task;
use crate::fit::time::{Forecast, Timer};
use crate::image::Image;
use crate::metrics::psnr_db;
use crate::scene::{Area, Mark, Marks};
use crate::svg::Form;

/// Weight of errors near lost details. 5, 8, 16: a label of a map correlates by 0.957, 0.970, 0.980 with the picture; borders of 1 px
/// take 8.8, 10.9, 13.2 kB, 75, 82, 84 % of them kept (1, 49 % in 5.6 kB).
const LOST_WEIGHT: f32 = 8.0;
/// Time that shadows may take to be found: 0.1 to 2 s, of 108 pictures.
const SHADOWS: Duration = Duration::from_secs(2);
/// Layers are joined that would take more than this share of the bytes. A guess.
const LAYERS_SHARE: f64 = 0.03;
/// Iterations of the polish that follows the recovery of details, in units of the first polish's. A guess.
pub(in crate::fit) const RECOVERY_SHARE: f64 = 0.2;

/// A fit under way: first the fields that are fixed, then those that change.
pub(in crate::fit) struct Session<'a> {
    pub(in crate::fit) config: &'a Config,
    pub(in crate::fit) task: &'a Task,
    pub(in crate::fit) recipe: Recipe,
    /// Weight of an error at each pixel while strokes are fitted: as `focus` says, and as it is seen.
    pub(in crate::fit) weights: Option<Focus>,
    /// The radii of the pens, px, the thinnest first; none if strokes may have any.
    pub(in crate::fit) radii: Vec<f32>,
    /// The picture to reproduce.
    pub(in crate::fit) target: Image,
    pub(in crate::fit) annealing: Annealing,
    pub(in crate::fit) plan: Plan,
    /// Most strokes of the drawing.
    pub(in crate::fit) limit: usize,
    /// Price of strokes and points.
    pub(in crate::fit) price: Price,
    pub(in crate::fit) writer: Writer<'a>,

    pub(in crate::fit) drawing: Drawing,
    pub(in crate::fit) history: History,
    /// The best file so far.
    pub(in crate::fit) best: Option<RenderedFile>,
    pub(in crate::fit) progress: Tracker<'a>,
    pub(in crate::fit) timer: Timer,

    /// The current phase.
    pub(in crate::fit) phase: Phase,
    /// The descent in which a resumed fit was cut off, until its phase takes it up again.
    pub(in crate::fit) resumed: Option<Descent>,
    keeper: Option<Keeper<'a>>,
}

/// The checkpoint that the state is written to.
struct Keeper<'a> {
    checkpoint: &'a mut Checkpoint,
    /// Identifies the fit.
    fingerprint: u64,
    /// True if the last state has been kept.
    is_final: bool,
}

/// The state of a fit as a checkpoint holds it.
type State = (
    Phase,
    History,
    Snapshot,
    Position,
    Duration,
    Option<Descent>,
);

impl<'a> Session<'a> {
    pub(in crate::fit) fn new(
        picture: &Image,
        task: &'a Task,
        level: Level,
        watch: Watch<'a>,
        started: Instant,
    ) -> Result<Self> {
        let (config, base, page) = (&task.config, task.base.as_ref(), task.page);
        // Limit on strokes, their stages and their widths.
        let pixels = picture.width() * picture.height();
        let price = task.price(pixels);
        let recipe = budget::recipe(config, base, picture);
        let limit = budget::strokes(config, base, picture);
        let before = Before::of(base);
        let plan = Plan::new(config, limit, before, pixels);
        let page_width = Base::page_width(base, &config.file);
        let pens = config.pens.as_ref();
        let radii = pens.map_or(Ok(Vec::new()), |pens| pens.radii(page_width, picture))?;
        let widest = radii.last().copied().unwrap_or(f32::INFINITY);
        // The picture at the resolution of the first stage, and the backdrop of all strokes.
        let coarsest = coarsest(&plan, before, config, base).min(widest);
        let Prepared {
            target,
            mut surfaces,
            background_fixed,
            ground,
        } = Prepared::new(
            picture,
            choose_background(picture, task, price),
            base,
            coarsest,
        )?;
        let weights = weights(config, &target, task.focus.as_ref());
        let focus_on = |surface: &mut Surface| surface.focus_on(weights.as_ref());
        surfaces.iter_mut().for_each(focus_on);
        // The drawing, with the strokes of the base.
        let annealing = Annealing {
            coverage: config.coverage,
        };
        let resolution = (surfaces[0].grid(), surfaces[0].halvings());
        let min_opacity = if config.opaque {
            1.0
        } else {
            recipe.min_opacity
        };
        let bounds = Bounds::new(resolution, config.is_confined(), min_opacity, &radii);
        let edge = annealing.last();
        let mut drawing = Drawing::new(surfaces, (background_fixed, ground), bounds, edge, level);
        let records = base.map_or_else(Vec::new, |base| history::load(&mut drawing, base));
        // Limit on time, and amount of work.
        let limit_s = config.budget.time;
        let forecast = limit_s.map(|limit| forecast(limit, config, &recipe, &drawing));
        // Iterations that a stroke takes part in: those of its stage, and those of the polish.
        let polish = if config.polish {
            recipe.polish.iterations
        } else {
            0
        };
        let planned = (plan.strokes() * (recipe.stages.iterations + polish)) as f64;
        Ok(Self {
            config,
            task,
            recipe,
            weights,
            radii,
            target,
            annealing,
            limit: budget::max_strokes(config, limit, base, pixels),
            price,
            writer: Writer::of(config, base, page),
            drawing,
            history: History::new(records, budget::planned_stop(&config.budget)),
            best: None,
            progress: Tracker::new(watch, planned, plan.len()),
            plan,
            timer: Timer::new(started, forecast),
            phase: Phase::first(base.is_some()),
            resumed: None,
            keeper: None,
        })
    }

    /// True if lost details are traced again. A base has been through that.
    pub(in crate::fit) fn recovers(&self) -> bool {
        self.task.base.is_none() && self.config.recovers()
    }

    /// Lets errors near lost details count more, for all that follows.
    pub(in crate::fit) fn weigh_lost(&mut self) {
        let size = [self.target.width(), self.target.height()];
        let mut weights = vec![1.0; size[0] * size[1]];
        for &place in &self.history.lost {
            if let Some(weight) = weights.get_mut(place as usize) {
                *weight = LOST_WEIGHT;
            }
        }
        // On top of the weights so far, by multiplication.
        let near = Focus::of_weights(size, weights);
        self.weights = Some(match &self.weights {
            Some(weights) => weights.times(&near),
            None => near,
        });
        self.drawing.thaw();
        self.drawing.focus_on(self.weights.as_ref());
    }

    /// Lowers the price by `db`, for all that follows.
    pub(in crate::fit) fn ease(&mut self, db: f64) {
        self.history.eased_db = db;
        self.price = self.price.eased(db);
    }

    /// Plans the stages for the strokes that are missing.
    pub(in crate::fit) fn plan_rest(&mut self) {
        let [layers, strokes] = self.history.traced;
        let before = Before::of(self.task.base.as_ref());
        let before = Before {
            layers: before.layers + layers,
            strokes: before.strokes + strokes,
        };
        let limit = budget::strokes(self.config, self.task.base.as_ref(), &self.target);
        let pixels = self.drawing.pixels();
        self.plan = Plan::new(self.config, limit, before, pixels);
    }

    /// The descent in which the fit was cut off, or else a new one that follows `course`.
    pub(in crate::fit) fn descent(&mut self, course: Course) -> Descent {
        let (drawing, used) = (&self.drawing, self.timer.used());
        match self.resumed.take() {
            Some(resumed) => resumed.holding_forms(drawing),
            None => Descent::new(drawing, course, used),
        }
    }

    /// Counts an iteration of the free strokes, after which the mean squared error is `mse` and the descent has `left`
    /// more of them. Returns whether to go on.
    pub(in crate::fit) fn advance(&mut self, left: usize, mse: f64) -> bool {
        self.timer.step(self.drawing.len());
        let strokes = self.drawing.free().len();
        // Work is counted in iterations of one stroke: what is left of this descent, and the polishes still to come.
        let all = (self.drawing.len() * self.recipe.polish.iterations) as f64;
        let recovery = match self.recovers() {
            true => RECOVERY_SHARE,
            false => 0.0,
        };
        let polishes = match self.phase {
            Phase::Polish(Purpose::Plan) => recovery,
            phase if phase.precedes_polish(self.config) => 1.0 + recovery,
            _ => 0.0,
        };
        let rest = strokes * left + (polishes * all) as usize;
        // Of a drawing that was traced hardly more is to come.
        let is_known = self.drawing.counters.traced_until > 0;
        self.progress
            .advance(strokes, rest, is_known, self.timer.used());
        self.tell(mse)
    }

    /// Shows the observer the drawing, and looks at the time. Returns whether the fit goes on.
    fn tell(&mut self, mse: f64) -> bool {
        if self.timer.is_over() {
            self.progress.stop(Stop::Time);
        }
        self.progress.tell(&self.drawing, mse) && self.progress.stopped().is_none()
    }

    /// Shows the observer a drawing without descent, and looks at the time.
    pub(in crate::fit) fn show(&mut self) {
        self.check_for_stop();
        let mse = self.drawing.mse();
        self.tell(mse);
    }

    /// True if the fit was asked to stop, and is finishing its drawing.
    pub(in crate::fit) fn is_leaving(&self) -> bool {
        self.progress.is_interrupted()
    }

    /// Checks for a stop: sets a time limit when the fit has been asked to stop. Returns whether that happened just now.
    pub(in crate::fit) fn check_for_stop(&mut self) -> bool {
        let Some(grace) = self.progress.leave() else {
            return false;
        };
        let elapsed = self.timer.elapsed();
        let budget = self.config.budget;
        // A stop doesn't extend a time limit: whichever ends first counts.
        let left = budget.time.map(|limit| limit.saturating_sub(elapsed));
        let limit = left.map_or(grace, |left| left.min(grace));
        let forecast = forecast(limit, self.config, &self.recipe, &self.drawing);
        self.timer.restart(forecast);
        true
    }

    /// Measures from time to time, if the time is limited, how long it takes to write and render the drawing.
    pub(in crate::fit) fn time_a_write(&mut self) -> Result<()> {
        if self.timer.wants_trial_write() {
            self.render_file()?;
        }
        Ok(())
    }

    /// Rounds, writes and renders the drawing.
    pub(in crate::fit) fn render_file(&mut self) -> Result<RenderedFile> {
        let (writer, drawing) = (self.writer, &self.drawing);
        self.timer.writing(drawing.len(), || writer.render(drawing))
    }

    /// The step sizes of the polish, for what strokes may still change once the drawing is restricted.
    pub(in crate::fit) fn restricted_rates(&self) -> Rates {
        let mut rates = self.recipe.polish.rates;
        if self.config.colors != Colors::Free {
            rates = rates.without_color();
        }
        if !self.radii.is_empty() {
            rates = rates.without_radius();
        }
        if self.hands_out_pens() {
            rates = rates.without_color().without_radius();
        }
        rates
    }

    /// True if the strokes come to share pens of which there are few. A drawing of lines has few pens anyway.
    pub(in crate::fit) fn hands_out_pens(&self) -> bool {
        self.config.file.form == Form::Smallest && !self.drawing.is_of_lines()
    }

    /// Bytes of the drawing as a file; about, if its strokes will come to share pens, which makes them shorter.
    pub(in crate::fit) fn bytes(&self) -> usize {
        if !self.hands_out_pens() {
            return self.writer.bytes(&self.drawing);
        }
        let strokes = self.drawing.free().iter();
        let strokes: usize = strokes.map(|stroke| self.price.bytes_of(stroke)).sum();
        let layers = self.drawing.stage_sizes().len();
        let empty = self
            .task
            .base
            .as_ref()
            .map_or(budget::FILE_BYTES, Base::bytes);
        empty + layers * budget::LAYER_BYTES + strokes
    }

    /// Number of layers of the drawing that are joined with the one below because they would take much of a budget of bytes.
    pub(in crate::fit) fn layers_to_join(&self) -> usize {
        let Some(most) = self
            .config
            .budget
            .bytes
            .filter(|_| !self.config.progressive)
        else {
            return 0;
        };
        let kept = Before::of(self.task.base.as_ref()).layers.max(1);
        let more = self.drawing.stage_sizes().len().saturating_sub(kept);
        // Layers show how the drawing came about. They stay as long as they take a small part of the bytes.
        let bytes = (more * budget::LAYER_BYTES) as f64;
        if bytes > LAYERS_SHARE * most as f64 {
            more
        } else {
            0
        }
    }

    /// Makes `file`, of the settled drawing, the best one if it serves the budget better than the best one so far.
    pub(in crate::fit) fn offer(&mut self, file: RenderedFile) {
        self.history.corrections.last_db = psnr_db(file.mse());
        let best = self.best.as_ref();
        if best.is_none_or(|best| budget::is_better(&self.config.budget, &file, best)) {
            self.set_best(file);
        }
    }

    /// Makes `file`, rendered from the current drawing, the best file so far.
    pub(in crate::fit) fn set_best(&mut self, file: RenderedFile) {
        self.history.best = Some(self.drawing.snapshot());
        self.best = Some(file);
    }

    /// Takes down why a fit ends that aims at a fidelity of `wanted_db`.
    pub(in crate::fit) fn stop_at(&mut self, wanted_db: f64) {
        let best_db = self.best.as_ref().map_or(0.0, |best| psnr_db(best.mse()));
        self.history.stop = match self.history.stop {
            _ if best_db >= wanted_db => Stop::Psnr,
            // The stages ended at a fidelity that the best file doesn't have.
            Stop::Psnr => Stop::Converged,
            other => other,
        };
    }

    /// Reason that cut the fit short, if anything did.
    pub(in crate::fit) fn cut_by(&self) -> Option<Stop> {
        if self.is_leaving() {
            return Some(Stop::Interrupted);
        }
        let hurried = self.timer.is_hurried.then_some(Stop::Time);
        self.progress.stopped().or(hurried)
    }

    /// Identifies a fit of `task` to the same picture in a checkpoint.
    fn fingerprint(&self, task: &Task) -> u64 {
        checkpoint::fingerprint(
            &self.target,
            &task.config,
            task.base.as_ref(),
            task.focus.as_ref(),
        )
    }

    /// True if `checkpoint` holds a state of a fit of `task` to the same picture.
    pub(in crate::fit) fn is_kept_as(&self, task: &Task, checkpoint: &Checkpoint) -> bool {
        checkpoint.is_of(self.fingerprint(task))
    }

    /// Goes on in the place of `other`, a fit to the same picture: with its observer and its checkpoint.
    pub(in crate::fit) fn in_place_of(mut self, mut other: Self) -> Self {
        self.progress.take_over(&mut other.progress);
        self.keeper = other.keeper.map(|keeper| Keeper {
            fingerprint: self.fingerprint(self.task),
            ..keeper
        });
        self
    }

    /// Goes on from the state in `checkpoint`, if it holds one, and keeps the state there from now on.
    pub(in crate::fit) fn resume(&mut self, checkpoint: &'a mut Checkpoint) -> Result<()> {
        let fingerprint = self.fingerprint(self.task);
        match checkpoint.load::<State>(fingerprint)? {
            Some((phase, history, drawing, position, elapsed, descent)) => {
                // The best file isn't in the checkpoint: it is rendered again from its drawing.
                if let Some(best) = history.best.clone() {
                    self.drawing.restore(best);
                    self.best = Some(self.writer.render(&self.drawing)?);
                }
                (self.phase, self.history, self.resumed) = (phase, history, descent);
                // Weights change with nothing frozen, so they come before the drawing, which may have frozen strokes.
                if !self.history.lost.is_empty() {
                    self.weigh_lost();
                }
                self.ease(self.history.eased_db);
                self.drawing.restore(drawing);
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
            self.drawing.snapshot(),
            self.progress.position,
            self.timer.elapsed(),
            descent,
        )
    }

    /// Keeps the state, with the `descent` under way, if that is due: at intervals, before a phase that cannot be
    /// divided, at the end, and when the fit is interrupted. What an interrupted fit does after that, to finish its
    /// drawing quickly, is not kept.
    pub(in crate::fit) fn keep(&mut self, descent: Option<&Descent>) {
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
        self.mark_as_final();
    }

    /// Stops keeping the state if the fit was interrupted: a phase that was cut short is nothing to go on from.
    pub(in crate::fit) fn mark_as_final(&mut self) {
        let is_interrupted = self.progress.is_interrupted();
        if let Some(keeper) = &mut self.keeper {
            keeper.is_final |= is_interrupted;
        }
    }
}

/// The background and the ground of a new drawing. A ground, with `auto`, has any colours and opacities. So a drawing of few
/// colours or of given pens has none, nor has a transparent drawing of opaque strokes.
fn choose_background(picture: &Image, task: &Task, price: Price) -> (Background, Vec<Area>) {
    let config = &task.config;
    let may_be = task.base.is_none()
        && config.background == Background::Auto
        && config.colors == Colors::Free
        && config.pens.is_none()
        && !(config.opaque && picture.alpha().is_some());
    match may_be {
        true => {
            let by_bytes = price.of_bytes_alone();
            let terms = Terms {
                doubt: task.doubt,
                blurs: config.blurs,
                per_byte: price.per_byte(),
                is_short: config.budget.time.is_some_and(|time| time < SHADOWS),
                has_things: config.marks() != Marks::Strokes,
                price: &|mark: &Mark| by_bytes.least_gain(mark),
            };
            // A rival by strokes lies on the ground of the drawing that it rivals.
            let find = || background::with_ground(picture, &terms);
            task.ground.get_or_init(find).clone()
        }
        false => (config.background, Vec::new()),
    }
}

/// Weight of an error at each pixel while strokes are fitted: as `focus` says, and as it is seen.
fn weights(config: &Config, target: &Image, focus: Option<&Focus>) -> Option<Focus> {
    match config.look() {
        ErrorWeighting::Exact => focus.cloned(),
        ErrorWeighting::Eye => {
            let seen = masking::weights(target);
            Some(
                focus
                    .into_iter()
                    .fold(seen, |seen, focus| seen.times(focus)),
            )
        }
    }
}

/// The forecast of a fit that has a time `limit`.
fn forecast(limit: Duration, config: &Config, recipe: &Recipe, drawing: &Drawing) -> Forecast {
    let is_transparent = drawing.surfaces.len() > 1;
    let needs_file = budget::needs_file(&config.budget, recipe);
    let rounds = recipe.settling_rounds;
    Forecast::new(limit, drawing.pixels(), is_transparent, needs_file, rounds)
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
