//! Deadline, cancellation and progress of one fit.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::Stop;
use super::config::Config;
use super::drawing::Drawing;
use super::observer::{Observer, Progress};
use crate::metrics::psnr_db;

/// What follows the descent in any case, in units of the time that writing and rendering the drawing takes:
/// that itself, the records of the layers, and the judging of the file, which renders it once more.
const ENDING: u32 = 6;
/// Share of a time limit that is for the descent however long the rest takes.
const LEAST_SHARE: u32 = 4;

/// What a fit has done and taken so far.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Spent {
    elapsed: Duration,
    /// Work done, in strokes × iterations.
    done: f64,
    /// The fraction that the observer was told.
    fraction: f64,
    /// The stage under way, and whether it is polished.
    stage: usize,
    polishing: bool,
}

/// Asked after every iteration whether to go on.
pub(super) struct Control<'a> {
    observer: &'a mut (dyn Observer + Send),
    started: Instant,
    limit: Option<Duration>,
    /// Work planned, in strokes × iterations.
    planned: f64,
    stages: usize,
    /// Its time is that before this run.
    spent: Spent,
    /// How long it takes to write and render the drawing, as far as that is known.
    writing: Duration,
    /// Set once, by whatever stopped the fit first.
    stopped: Option<Stop>,
}

impl<'a> Control<'a> {
    pub(super) fn new(
        observer: &'a mut (dyn Observer + Send),
        config: &Config,
        started: Instant,
        planned: f64,
        stages: usize,
    ) -> Self {
        Self {
            observer,
            started,
            limit: config.budget.time,
            planned,
            stages,
            spent: Spent::default(),
            writing: Duration::ZERO,
            stopped: None,
        }
    }

    /// Time since the fit began, what it took before it was resumed included.
    pub(super) fn elapsed(&self) -> Duration {
        self.spent.elapsed + self.started.elapsed()
    }

    /// What was done and taken so far.
    pub(super) fn spent(&self) -> Spent {
        Spent {
            elapsed: self.elapsed(),
            ..self.spent
        }
    }

    /// Goes on from `spent`.
    pub(super) fn restore(&mut self, spent: Spent) {
        (self.spent, self.started) = (spent, Instant::now());
    }

    /// Why the fit has to end now, if it has to.
    pub(super) fn stopped(&self) -> Option<Stop> {
        self.stopped
    }

    /// Says how long it takes to write and render the drawing: the descent ends in time for it.
    pub(super) fn expect_writing(&mut self, span: Duration) {
        self.writing = span;
    }

    /// Whether it pays to try how long writing takes: where there is a limit, and the last time took
    /// little of it.
    pub(super) fn may_rehearse(&self) -> bool {
        self.limit.is_some_and(|limit| 50 * self.writing < limit)
    }

    /// The share that is used up of the time for descending; 0 without a limit.
    pub(super) fn time_used(&self) -> f32 {
        self.limit.map_or(0.0, |limit| {
            let ending = ENDING * self.writing;
            let descent = limit.saturating_sub(ending).max(limit / LEAST_SHARE);
            self.elapsed().as_secs_f32() / descent.as_secs_f32()
        })
    }

    /// Whether something that takes about `span`, and the ending after it, ends within the limit.
    pub(super) fn allows(&self, span: Duration) -> bool {
        let ending = ENDING * self.writing;
        self.limit
            .is_none_or(|limit| self.elapsed() + span + ending < limit)
    }

    /// Asks the observer alone whether to go on, without a word of progress.
    pub(super) fn goes_on(&mut self, drawing: &Drawing, mse: f64) -> bool {
        let progress = Progress {
            done: self.spent.fraction,
            stage: self.spent.stage,
            stages: self.stages,
            polishing: self.spent.polishing,
            strokes: drawing.len(),
            psnr_db: psnr_db(mse),
            drawing,
        };
        if self.stopped != Some(Stop::Observer)
            && self.observer.observe(&progress) == ControlFlow::Break(())
        {
            self.stopped = Some(Stop::Observer);
        }
        self.stopped != Some(Stop::Observer)
    }

    /// Announces stage `stage`, from 0.
    pub(super) fn enter(&mut self, stage: usize) {
        self.spent.stage = stage + 1;
        self.spent.polishing = false;
    }

    /// Announces polish.
    pub(super) fn polish(&mut self) {
        self.spent.polishing = true;
    }

    /// Adds an iteration of the free strokes of `drawing` to what is done, tells the observer, with the
    /// mean squared error `mse`, and says whether to go on.
    pub(super) fn advance(&mut self, drawing: &Drawing, mse: f64) -> bool {
        self.spent.done += drawing.free().len() as f64;
        let done = (self.spent.done / self.planned).max(f64::from(self.time_used()));
        self.spent.fraction = done.clamp(self.spent.fraction, 1.0);
        if self.stopped.is_none() && self.time_used() >= 1.0 {
            self.stopped = Some(Stop::Time);
        }
        self.goes_on(drawing, mse) && self.stopped.is_none()
    }
}
