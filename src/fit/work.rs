//! A fit under way: all there is to know of it between two tasks, kept where that is asked for.
//!
//! What each task does is in a file of its own kind: [`stages`] adds strokes, [`joint`] fits them together
//! and against the file, [`correct`] adds and removes some until the budgets are met, [`finish`] hands the
//! best of the files over.

mod budget;
mod correct;
mod finish;
mod joint;
mod stages;

use std::time::Instant;

use fearless_simd::Level;
use serde::{Deserialize, Serialize};

use super::anneal::Anneal;
use super::base::Base;
use super::checkpoint::{self, Checkpoint};
use super::config::Config;
use super::control::{Control, Spent};
use super::drawing::{self, Drawing};
use super::forecast::Forecast;
use super::ground::Setting;
use super::observer::Observer;
use super::plan::{Before, Plan};
use super::polish::{Polish, Terms};
use super::price::Price;
use super::recipe::Recipe;
use super::settle::{Page, Written};
use super::stage::Stage;
use super::{StageRecord, Stop};
use crate::error::Result;
use crate::image::Image;
use correct::Corrections;

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

impl Standing {
    fn at_start(
        config: &Config,
        recipe: &Recipe,
        base: Option<&Base>,
        records: Vec<StageRecord>,
    ) -> Self {
        Self {
            agenda: agenda(config, recipe, base),
            records,
            pays: None,
            stop: Stop::Strokes,
            corrections: Corrections::default(),
            best: None,
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
        started: Instant,
    ) -> Result<Self> {
        let recipe = config.recipe.unwrap_or(Recipe::of(config.preset));
        let limit = budget::strokes(config, base, picture);
        let before = Before::of(base);
        let pixels = picture.width() * picture.height();
        let plan = Plan::new(config, &recipe, limit, before, pixels);
        let coarsest = coarsest(&plan, before, config, base);
        let mut setting = Setting::new(picture, config.background, base, coarsest)?;
        let mut drawing = Drawing::new(&mut setting, config, level);
        let records = base.map_or_else(Vec::new, |base| stages::load(&mut drawing, base));
        let is_clear = drawing.grounds().len() > 1;
        let needs_file = budget::needs_file(&config.budget, &recipe);
        let forecast = |limit| Forecast::new(limit, pixels, is_clear, needs_file, &recipe);
        let forecast = config.budget.time.map(forecast);
        let planned = (plan.strokes() * recipe.iterations(config.polish)) as f64;
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
                limit: budget::max_strokes(limit, base),
                price: Price::new(config.effective_quality(), config.file),
            },
            control: Control::new(observer, forecast, started, planned, plan.len()),
            plan,
            target: setting.target,
            drawing,
            standing: Standing::at_start(config, &recipe, base, records),
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
}

/// The scale of the first stage, px: the drawing begins at the resolution for it; 0 for that of the picture.
fn coarsest(plan: &Plan, before: Before, config: &Config, base: Option<&Base>) -> f32 {
    // A reduced picture flatters a base: whether a fidelity is reached is told at full resolution.
    if base.is_some() && config.budget.psnr_db.is_some() {
        return 0.0;
    }
    let first = plan.stage(before.layers, before.strokes);
    first.map_or(0.0, |stage| stage.scale)
}

/// All that a fit does, the last first.
fn agenda(config: &Config, recipe: &Recipe, base: Option<&Base>) -> Vec<Task> {
    let mut agenda = vec![Task::MeetBytes, Task::MeetFidelity, Task::Settle];
    if config.polish && !config.progressive {
        agenda.push(Task::Polish(recipe.polish_iterations));
    }
    agenda.push(Task::Grow);
    if base.is_some_and(|base| config.colors.allow(&base.scene)) {
        agenda.push(Task::TryBase);
    }
    agenda
}
