//! The tasks of a fit, and the budgets that bind them.

use std::time::{Duration, Instant};

use fearless_simd::Level;
use serde::{Deserialize, Serialize};

use super::anneal::Anneal;
use super::base::Base;
use super::checkpoint::{self, Checkpoint};
use super::config::{Budget, Config};
use super::control::{Control, Spent};
use super::drawing::{self, Drawing};
use super::ground::{self, Setting};
use super::observer::Observer;
use super::palette::{self, Colors, Palette};
use super::pens;
use super::plan::{Before, MOST_STROKES, Plan, PlannedStage};
use super::polish::{Polish, Terms};
use super::price::Price;
use super::recipe::Recipe;
use super::settle::{self, Page, Written};
use super::stage::{self, Stage};
use super::{Fit, StageRecord, Stop};
use crate::error::Result;
use crate::image::Image;
use crate::math::Point;
use crate::metrics::psnr_db;
use crate::scene::{Shape, Stroke};
use crate::svg::{self, Form};

/// What polish adds to the fidelity of a staged drawing at least, dB.
const POLISH_DB: f64 = 2.0;
/// An open plan ends when less than this share of a stage's strokes is worth its price.
const PAYING_SHARE: f64 = 0.3;
/// Fidelity gained by doubling the strokes, dB.
const DB_PER_DOUBLING: f64 = 2.8;
/// How often strokes are added or removed to meet a fidelity.
const CORRECTIONS: usize = 6;
/// A fidelity is met well enough when exceeded by no more than this, dB.
const EXCESS_DB: f64 = 0.1;
/// Share of the polish's iterations that follow a correction.
const REPOLISH: f64 = 0.4;

/// Bytes of a typical stroke, for the first guess at what a budget of bytes holds.
fn typical_bytes(config: &Config, target: &Image) -> usize {
    // Two thirds of the way, so that no decimal is 0, and as short as most strokes are.
    let place = |share: f32, step: f32| {
        let [x, y] = [target.width(), target.height()].map(|side| side as f32 * share);
        Point::new(x + step, y - step)
    };
    let stroke = Stroke {
        shape: Shape::capsule(place(2.0 / 3.0, 0.0), place(2.0 / 3.0, 10.0 / 3.0)),
        radius: 5.0 / 3.0,
        color: [1.0 / 3.0; 3].map(|c: f32| c + 0.01),
        opacity: if config.opaque { 1.0 } else { 2.0 / 3.0 },
    };
    svg::stroke_bytes(&stroke, &config.file).max(1)
}

/// A piece of work that a fit does at a time.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Task {
    /// Leave the base as it is, if it meets a budget already.
    TryBase,
    /// Seed the next stage, if another is planned and pays.
    Grow,
    /// Fit the strokes of a stage alone, by one iteration; keep what pays after the last.
    Stage(Stage),
    /// Take down how a stage went.
    Record(Stage),
    /// Begin to fit all strokes jointly, in so many iterations.
    Polish(usize),
    /// Fit the free strokes jointly, by one iteration.
    Polishing(Polish),
    /// Settle the drawing against its file.
    Settle,
    /// Add or remove strokes until the fidelity asked for is met.
    MeetFidelity,
    /// Remove strokes until the file has no more bytes than asked for.
    MeetBytes,
}

/// How far a fit has come, apart from the drawing.
#[derive(Debug, Serialize, Deserialize)]
struct Standing {
    /// What is left to do, the next last.
    agenda: Vec<Task>,
    records: Vec<StageRecord>,
    /// Whether enough strokes of the last stage were worth their price, if there was one.
    pays: Option<bool>,
    /// What ended the stages.
    stop: Stop,
    corrections: Corrections,
    /// What the best of the files was written from.
    best: Option<drawing::State>,
}

/// How a fidelity is approached by adding and removing strokes.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Corrections {
    /// How often that was done.
    count: usize,
    /// Strokes before the last time, and their fidelity, dB.
    before: Option<(usize, f64)>,
    /// Fidelity of the last file, dB.
    last_db: f64,
    db_per_doubling: f64,
}

impl Default for Corrections {
    fn default() -> Self {
        Self {
            count: 0,
            before: None,
            last_db: 0.0,
            db_per_doubling: DB_PER_DOUBLING,
        }
    }
}

/// A fit under way.
pub(super) struct Work<'a> {
    config: &'a Config,
    recipe: Recipe,
    anneal: Anneal,
    base: Option<&'a Base>,
    page: Page<'a>,
    plan: Plan,
    terms: Terms,
    target: Image,
    drawing: Drawing,
    control: Control<'a>,
    standing: Standing,
    /// The best of the files.
    best: Option<Written>,
    /// Where the state is kept, and what it is the state of.
    checkpoint: Option<(&'a mut Checkpoint, u64)>,
    /// Whether the state is not to be kept any more.
    is_final: bool,
}

impl<'a> Work<'a> {
    pub(super) fn new(
        picture: &Image,
        config: &'a Config,
        base: Option<&'a Base>,
        level: Level,
        observer: &'a mut (dyn Observer + Send),
    ) -> Result<Self> {
        let start = Instant::now();
        let recipe = config.recipe.unwrap_or(Recipe::of(config.preset));
        let kept_bytes = base.map_or(0, Base::bytes);
        let by_bytes = config
            .budget
            .bytes
            .map(|bytes| bytes.saturating_sub(kept_bytes) / typical_bytes(config, picture))
            .map(|strokes| strokes.max(1));
        let limit = [config.budget.strokes, by_bytes]
            .into_iter()
            .flatten()
            .min();
        let most = MOST_STROKES.saturating_sub(base.map_or(0, Base::elements));
        let before = Before {
            layers: base.map_or(0, |base| base.scene.stages.len()),
            strokes: base.map_or(0, |base| base.scene.len()),
        };
        let pixels = picture.width() * picture.height();
        let plan = Plan::new(config, &recipe, limit, before, pixels);
        let first = plan.stage(before.layers, before.strokes);
        // A reduced picture flatters a base: whether a fidelity is reached is told at full resolution.
        let whole = base.is_some() && config.budget.psnr_db.is_some();
        let first = first.filter(|_| !whole);
        let coarsest = first.map_or(0.0, |stage| stage.scale);
        let mut setting = Setting::new(picture, config.background, base, coarsest)?;
        let mut drawing = Drawing::new(&mut setting, config, level);
        let mut records = Vec::new();
        if let Some(Base { scene, .. }) = base {
            drawing.load(scene);
            records = drawing
                .layer_mses(scene)
                .into_iter()
                .enumerate()
                .map(kept_layer)
                .collect();
        }
        let iterations = recipe.stage_iterations
            + if config.polish {
                recipe.polish_iterations
            } else {
                0
            };
        let planned = (plan.strokes() * iterations) as f64;
        Ok(Self {
            config,
            recipe,
            base,
            anneal: Anneal {
                coverage: config.coverage,
                from: 1.0,
            },
            page: Page::of(config, base),
            terms: Terms {
                limit: limit.unwrap_or(most).min(most),
                price: Price::new(config.effective_quality(), config.file),
            },
            control: Control::new(observer, config, start, planned, plan.len()),
            plan,
            target: setting.target,
            drawing,
            standing: Standing {
                agenda: agenda(config, &recipe, base),
                records,
                pays: None,
                stop: Stop::Strokes,
                corrections: Corrections::default(),
                best: None,
            },
            best: None,
            checkpoint: None,
            is_final: false,
        })
    }

    /// Keeps the state in `checkpoint` from now on, and goes on from the state that it has, if it has one.
    pub(super) fn resume(&mut self, checkpoint: &'a mut Checkpoint) -> Result<()> {
        let fingerprint = checkpoint::fingerprint(&self.target, self.config, self.base);
        match checkpoint.load::<(Standing, drawing::State, Spent)>(fingerprint)? {
            Some((standing, drawing, spent)) => {
                self.restore_best(standing.best.as_ref())?;
                self.standing = standing;
                self.drawing.resume(drawing);
                self.control.restore(spent);
            }
            // What cannot be kept is said before any work is done.
            None => checkpoint.write(fingerprint, &self.state())?,
        }
        self.checkpoint = Some((checkpoint, fingerprint));
        Ok(())
    }

    /// Writes again what was written from `state`.
    fn restore_best(&mut self, state: Option<&drawing::State>) -> Result<()> {
        if let Some(state) = state {
            self.drawing.resume(state.clone());
            self.best = Some(settle::write(&self.drawing, self.page)?);
        }
        Ok(())
    }

    fn state(&self) -> impl Serialize + '_ {
        (&self.standing, self.drawing.state(), self.control.spent())
    }

    /// Keeps the state, where that is due: every so often, before a task that is not divided, at the end,
    /// and when the observer stops the fit, before the drawing is finished in haste.
    pub(super) fn keep(&mut self) {
        let Some((checkpoint, fingerprint)) = self.checkpoint.take() else {
            return;
        };
        let is_stopped = self.control.stopped() == Some(Stop::Observer);
        let is_due = checkpoint.is_due() || is_stopped;
        let is_point = matches!(self.standing.agenda.last(), None | Some(Task::Settle));
        if (is_due || is_point) && !self.is_final {
            checkpoint.keep(fingerprint, &self.state());
        }
        self.is_final |= is_stopped;
        self.checkpoint = Some((checkpoint, fingerprint));
    }

    /// The next task, if any is left.
    pub(super) fn next(&mut self) -> Option<Task> {
        self.standing.agenda.pop()
    }

    fn then(&mut self, task: Task) {
        self.standing.agenda.push(task);
    }

    fn is_stopped(&self) -> bool {
        self.control.stopped().is_some()
    }

    /// Ends the fit where the base as it is meets a budget already.
    pub(super) fn try_base(&mut self) -> Result<()> {
        let written = settle::write(&self.drawing, self.page)?;
        let Budget {
            strokes,
            psnr_db: wanted_db,
            bytes,
            ..
        } = self.config.budget;
        let met = [
            (
                Stop::Strokes,
                strokes.is_some_and(|n| self.drawing.len() >= n),
            ),
            (
                Stop::Psnr,
                wanted_db.is_some_and(|db| psnr_db(written.mse) >= db),
            ),
            (Stop::Bytes, bytes.is_some_and(|n| written.bytes >= n)),
        ];
        if let Some(&(stop, _)) = met.iter().find(|(_, met)| *met) {
            self.standing.stop = stop;
            self.standing.agenda.clear();
            self.drawing.refine(0.0);
            self.standing.best = Some(self.drawing.state());
            self.best = Some(written);
        }
        Ok(())
    }

    /// Tries how long it takes to write the drawing, where the time is limited.
    fn rehearse(&mut self) -> Result<()> {
        if self.control.may_rehearse() {
            let start = Instant::now();
            settle::write(&self.drawing, self.page)?;
            self.control.expect_writing(start.elapsed());
        }
        Ok(())
    }

    /// Plans and seeds a stage, as long as the plan or a budget does not end.
    pub(super) fn grow(&mut self) -> Result<()> {
        if self.is_stopped() {
            return Ok(());
        }
        if let Some(enough) = self.enough() {
            self.standing.stop = enough;
            return Ok(());
        }
        self.rehearse()?;
        let index = self.standing.records.len();
        match self.plan.stage(index, self.drawing.len()) {
            Some(planned) => {
                self.then(Task::Grow);
                self.seed(planned);
            }
            None => self.top_up(),
        }
        Ok(())
    }

    /// What makes further stages superfluous, if anything does.
    fn enough(&self) -> Option<Stop> {
        let pays = self.standing.pays?;
        let staged = self.standing.records.last()?.psnr_db;
        // A base has been finished before, and gains less from polish than stages do.
        let gains = self.config.polish && self.base.is_none();
        let later = if gains { POLISH_DB } else { 0.0 };
        let wanted = self.config.budget.psnr_db;
        if !pays {
            Some(Stop::Converged)
        } else if wanted.is_some_and(|wanted| staged + later >= wanted) {
            Some(Stop::Psnr)
        } else {
            None
        }
    }

    /// Where nothing is polished, adds to the last stage the strokes that were promised but not accepted.
    fn top_up(&mut self) {
        let count = self.terms.limit.saturating_sub(self.drawing.len());
        let promised = self.config.budget.strokes.is_some() && !self.config.polish;
        let Some(last) = self
            .standing
            .records
            .last()
            .filter(|_| promised && count > 0)
        else {
            return;
        };
        let scale = self.recipe.scale * self.drawing.spacing(self.terms.limit);
        self.seed(PlannedStage {
            index: last.index - 1,
            count,
            scale,
        });
    }

    fn seed(&mut self, planned: PlannedStage) {
        let began = self.control.elapsed();
        self.control.enter(planned.index);
        let stage = Stage::seed(&mut self.drawing, &self.recipe, planned, began);
        self.then(Task::Stage(stage));
    }

    /// An iteration of the fit of a stage, or its end.
    pub(super) fn stage(&mut self, mut stage: Stage) {
        let (drawing, control) = (&mut self.drawing, &mut self.control);
        if control.stopped().is_none() && stage.step(drawing, &self.recipe, self.anneal, control) {
            return self.then(Task::Stage(stage));
        }
        let count = stage.planned.count;
        let accepted = stage::accept(drawing, self.terms.price);
        self.standing.pays = Some(accepted as f64 >= PAYING_SHARE * count as f64);
        if accepted == 0 && self.standing.corrections.count > 0 {
            // No stroke is left that helps.
            self.standing.agenda = vec![Task::MeetBytes];
            let wanted = self.config.budget.psnr_db;
            self.standing.stop = wanted.map_or(self.standing.stop, |db| self.stop_at(db));
        }
        self.then(Task::Record(stage));
        if self.config.progressive {
            let limit = self.drawing.len() + count - accepted;
            self.begin_polish(limit, self.recipe.polish_iterations);
        }
    }

    /// Takes down how a stage went.
    pub(super) fn record(&mut self, stage: &Stage) {
        let mut iterations = self.recipe.stage_iterations;
        if self.config.progressive {
            iterations += self.recipe.polish_iterations;
        }
        let psnr_db = psnr_db(self.drawing.mse());
        match self.standing.records.get_mut(stage.planned.index) {
            Some(topped_up) => {
                topped_up.iterations += iterations;
                topped_up.psnr_db = psnr_db;
            }
            None => self.standing.records.push(StageRecord {
                index: stage.planned.index + 1,
                strokes: 0,
                iterations,
                wall: self.control.elapsed().saturating_sub(stage.began),
                psnr_db,
                layer_psnr_db: 0.0,
            }),
        }
    }

    /// Begins to fit all strokes jointly.
    pub(super) fn polish(&mut self, steps: usize) {
        if self.is_stopped() {
            return;
        }
        self.drawing.thaw();
        // A fidelity is met by as few strokes as may be: their number is corrected afterwards.
        let limit = match self.config.budget.psnr_db {
            Some(_) => self.drawing.len(),
            None => self.terms.limit,
        };
        self.control.enter(self.standing.records.len());
        self.begin_polish(limit, steps);
    }

    fn begin_polish(&mut self, limit: usize, steps: usize) {
        self.control.polish();
        let (drawing, control) = (&self.drawing, &self.control);
        let polish = Polish::new(drawing, &self.recipe, limit, steps, control);
        self.then(Task::Polishing(polish));
    }

    /// An iteration of a joint fit, unless it is at its end.
    pub(super) fn polishing(&mut self, mut polish: Polish) {
        let (drawing, control) = (&mut self.drawing, &mut self.control);
        let (anneal, price) = (self.anneal, self.terms.price);
        if control.stopped().is_none() && polish.step(drawing, &self.recipe, anneal, price, control)
        {
            self.then(Task::Polishing(polish));
        }
    }

    /// Settles the drawing against its file.
    pub(super) fn settle(&mut self) -> Result<()> {
        self.drawing.thaw();
        self.drawing.refine(0.0);
        let recipe = self.restricted();
        let (drawing, control) = (&mut self.drawing, &mut self.control);
        let written = settle::run(drawing, self.page, &recipe, control)?;
        // What was settled in haste is nothing to go on from.
        self.is_final |= control.stopped() == Some(Stop::Observer);
        self.standing.corrections.last_db = psnr_db(written.mse);
        let best = self.best.as_ref();
        if best.is_none_or(|best| self.is_better(&written, best)) {
            self.standing.best = Some(self.drawing.state());
            self.best = Some(written);
        }
        Ok(())
    }

    /// The palette of the drawing, if it has to have one.
    fn palette(&mut self) -> Option<Palette> {
        let colors = &self.config.colors;
        if *colors == Colors::Free {
            return None;
        }
        let strokes = self.drawing.len();
        let mut wishes = self.drawing.wishes(0.0);
        if !self.page.has_ground {
            // No background is drawn.
            wishes.truncate(strokes);
        }
        let is_given = self.page.has_ground && self.drawing.background_fixed;
        let ground = self.drawing.background().filter(|_| is_given);
        Palette::new(colors, &wishes, ground)
    }

    /// Brings the drawing to the colours and pens that it may have, and returns the recipe that leaves them as they are.
    fn restricted(&mut self) -> Recipe {
        let mut recipe = self.recipe;
        if let Some(mut palette) = self.palette() {
            let (anneal, control) = (self.anneal, &mut self.control);
            let terms = Terms {
                limit: self.drawing.len(),
                ..self.terms
            };
            palette::run(
                &mut self.drawing,
                &mut palette,
                &recipe,
                anneal,
                terms,
                control,
            );
            recipe.polish_rates = palette::without_color(recipe.polish_rates);
        }
        if self.config.file.form == Form::Smallest {
            let (anneal, control) = (self.anneal, &mut self.control);
            let keep_colors = self.config.colors != Colors::Free;
            pens::run(&mut self.drawing, keep_colors, &recipe, anneal, control);
            recipe.polish_rates = pens::without_pen(recipe.polish_rates);
        }
        recipe
    }

    /// Whether a file serves the budgets better than another.
    fn is_better(&self, new: &Written, old: &Written) -> bool {
        let fits = |w: &Written| self.config.budget.bytes.is_none_or(|most| w.bytes <= most);
        let wanted = self.config.budget.psnr_db;
        let reached = |w: &Written| wanted.is_some_and(|wanted| psnr_db(w.mse) >= wanted);
        match (fits(new), fits(old)) {
            (true, true) => match (reached(new), reached(old)) {
                (true, true) => new.scene.len() < old.scene.len(),
                (false, false) => new.mse < old.mse,
                (reaches, _) => reaches,
            },
            (false, false) => new.bytes < old.bytes,
            (fits, _) => fits,
        }
    }

    /// Adds or removes strokes where the last file is not as faithful as wanted, or more.
    pub(super) fn meet_fidelity(&mut self) {
        let Some(wanted) = self.config.budget.psnr_db else {
            return;
        };
        let now = (self.drawing.len(), self.standing.corrections.last_db);
        let corrections = &mut self.standing.corrections;
        if let Some(before) = corrections.before.filter(|_| self.base.is_some()) {
            corrections.db_per_doubling = slope(before, now);
        }
        corrections.before = Some(now);
        let missing_db = wanted - corrections.last_db;
        let doublings = missing_db / corrections.db_per_doubling;
        let is_met = (0.0..=EXCESS_DB).contains(&-missing_db);
        let ends = is_met || self.is_stopped() || self.standing.corrections.count >= CORRECTIONS;
        if ends || !self.resize(doublings) {
            self.standing.stop = self.stop_at(wanted);
        }
    }

    /// Why a fit ended that was to be as faithful as `wanted`, dB.
    fn stop_at(&self, wanted: f64) -> Stop {
        let best_db = self.best.as_ref().map_or(0.0, |best| psnr_db(best.mse));
        match self.standing.stop {
            _ if best_db >= wanted => Stop::Psnr,
            Stop::Psnr => Stop::Converged,
            other => other,
        }
    }

    /// Doubles or halves the strokes `doublings` times, at most once, and sees to it that they are fitted;
    /// false where there is none to add or to remove.
    fn resize(&mut self, doublings: f64) -> bool {
        let (strokes, most) = (self.drawing.len(), self.terms.limit);
        let factor = doublings.clamp(-1.0, 1.0).exp2();
        let wanted = ((strokes as f64 * factor) as usize).clamp(1, most);
        let added = match doublings > 0.0 {
            true => wanted.max(strokes + 1).min(most).saturating_sub(strokes),
            false => 0,
        };
        let removed = match doublings > 0.0 {
            true => 0,
            false => strokes.saturating_sub(wanted),
        };
        if added + removed == 0 {
            return false;
        }
        self.standing.corrections.count += 1;
        self.then(Task::MeetFidelity);
        self.then(Task::Settle);
        let steps = self.recipe.polish_iterations as f64 * REPOLISH;
        self.then(Task::Polish(steps as usize));
        if added > 0 {
            self.seed(PlannedStage {
                index: self.standing.records.len(),
                count: added,
                scale: self.recipe.scale * self.drawing.spacing(wanted),
            });
        } else {
            self.remove(removed);
        }
        true
    }

    /// Removes the `count` strokes worth least.
    fn remove(&mut self, count: usize) {
        let worth = self.drawing.judge().worth;
        let mut order: Vec<usize> = (0..worth.len()).collect();
        order.sort_by(|&i, &j| worth[i].total_cmp(&worth[j]).then(i.cmp(&j)));
        let mut keep = vec![true; worth.len()];
        order.into_iter().take(count).for_each(|i| keep[i] = false);
        self.drawing.retain_free(&keep);
    }

    /// Removes the strokes worth least where the best file has more bytes than allowed.
    pub(super) fn meet_bytes(&mut self) {
        let bytes = self.best.as_ref().map_or(0, |best| best.bytes);
        let most = self.config.budget.bytes.unwrap_or(usize::MAX);
        if bytes <= most || self.drawing.len() == 0 {
            return;
        }
        if self.standing.stop != Stop::Bytes
            && let Some(best) = self.standing.best.clone()
        {
            self.drawing.resume(best);
        }
        self.standing.stop = Stop::Bytes;
        let share = (bytes - most) as f64 / bytes as f64;
        self.remove(((self.drawing.len() as f64 * share).ceil() as usize).max(1));
        self.then(Task::MeetBytes);
        self.then(Task::Settle);
    }

    /// The finished fit.
    pub(super) fn finish(mut self) -> Result<Fit> {
        let written = match self.best {
            Some(best) => best,
            None => settle::write(&self.drawing, self.page)?,
        };
        let layers = self.drawing.layer_mses(&written.scene);
        let layers = written.scene.stages.iter().zip(layers);
        for (record, (stage, mse)) in self.standing.records.iter_mut().zip(layers) {
            record.strokes = stage.strokes.len();
            record.layer_psnr_db = psnr_db(mse);
        }
        let mut softs = self.drawing.soft(&written.scene);
        let soft = match softs.as_slice() {
            [black, white] => ground::transparent(black, white)?,
            _ => softs.remove(0),
        };
        Ok(Fit {
            soft,
            scene: written.scene,
            base: self.base.cloned(),
            target: self.target,
            stages: self.standing.records,
            stop: self.control.stopped().unwrap_or(self.standing.stop),
            dropped: written.dropped + self.drawing.lost(),
        })
    }
}

/// Fidelity gained by doubling the strokes, dB, told from two drawings of so many strokes and dB each: what
/// the new strokes of a refined drawing bring depends on its base.
fn slope((few, few_db): (usize, f64), (many, many_db): (usize, f64)) -> f64 {
    let doublings = (many.max(1) as f64 / few.max(1) as f64).log2();
    let slope = (many_db - few_db) / doublings;
    if slope.is_finite() {
        slope.clamp(DB_PER_DOUBLING / 8.0, DB_PER_DOUBLING)
    } else {
        DB_PER_DOUBLING
    }
}

/// The record of a layer that was there before, from its index and the mean squared error after it.
fn kept_layer((index, mse): (usize, f64)) -> StageRecord {
    StageRecord {
        index: index + 1,
        strokes: 0,
        iterations: 0,
        wall: Duration::ZERO,
        psnr_db: psnr_db(mse),
        layer_psnr_db: 0.0,
    }
}

/// All that a fit does, the last first.
fn agenda(config: &Config, recipe: &Recipe, base: Option<&Base>) -> Vec<Task> {
    let mut agenda = vec![Task::MeetBytes, Task::MeetFidelity, Task::Settle];
    if config.polish && !config.progressive {
        agenda.push(Task::Polish(recipe.polish_iterations));
    }
    agenda.push(Task::Grow);
    if base.is_some() {
        agenda.push(Task::TryBase);
    }
    agenda
}
