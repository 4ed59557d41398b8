//! Deadline, cancellation and progress of one fit.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use super::Stop;
use super::config::Config;
use super::drawing::Drawing;
use super::observer::{Observer, Progress};
use crate::metrics::psnr_db;

/// Share of a time limit after which the descent ends; the rest is for settling, writing and verifying.
const DESCENT_SHARE: f32 = 0.9;

/// Asked after every iteration whether to go on.
pub(super) struct Control<'a> {
    observer: &'a mut (dyn Observer + Send),
    started: Instant,
    limit: Option<Duration>,
    /// Work planned and done, in strokes × iterations.
    planned: f64,
    done: f64,
    /// What the observer is told next time: the fraction done, and the stage under way of how many.
    fraction: f64,
    stage: usize,
    stages: usize,
    polishing: bool,
    /// Set once, by whatever stopped the fit first.
    stopped: Option<Stop>,
}

impl<'a> Control<'a> {
    pub(super) fn new(
        observer: &'a mut (dyn Observer + Send),
        config: &Config,
        planned: f64,
        stages: usize,
    ) -> Self {
        Self {
            observer,
            started: Instant::now(),
            limit: config.budget.time,
            planned,
            done: 0.0,
            fraction: 0.0,
            stage: 0,
            stages,
            polishing: false,
            stopped: None,
        }
    }

    /// Why the fit has to end now, if it has to.
    pub(super) fn stopped(&self) -> Option<Stop> {
        self.stopped
    }

    /// The share that is used up of the time for descending; 0 without a limit.
    pub(super) fn time_used(&self) -> f32 {
        self.limit.map_or(0.0, |limit| {
            self.started.elapsed().as_secs_f32() / (limit.as_secs_f32() * DESCENT_SHARE)
        })
    }

    /// Whether something that takes about `span`, and writing the result after it, ends within the limit.
    pub(super) fn allows(&self, span: Duration) -> bool {
        self.limit
            .is_none_or(|limit| self.started.elapsed() + 2 * span < limit)
    }

    /// Announces stage `stage`, from 0.
    pub(super) fn enter(&mut self, stage: usize) {
        self.stage = stage + 1;
        self.polishing = false;
    }

    /// Announces polish.
    pub(super) fn polish(&mut self) {
        self.polishing = true;
    }

    /// Adds an iteration of the free strokes of `drawing` to what is done, tells the observer, with the
    /// mean squared error `mse`, and says whether to go on.
    pub(super) fn advance(&mut self, drawing: &Drawing, mse: f64) -> bool {
        self.done += drawing.free().len() as f64;
        let done = (self.done / self.planned).max(f64::from(self.time_used()));
        self.fraction = done.clamp(self.fraction, 1.0);
        if self.stopped.is_none() && self.time_used() >= 1.0 {
            self.stopped = Some(Stop::Time);
        }
        let progress = Progress {
            done: self.fraction,
            stage: self.stage,
            stages: self.stages,
            polishing: self.polishing,
            strokes: drawing.len(),
            psnr_db: psnr_db(mse),
            drawing,
        };
        if self.stopped.is_none() && self.observer.observe(&progress) == ControlFlow::Break(()) {
            self.stopped = Some(Stop::Observer);
        }
        self.stopped.is_none()
    }
}
