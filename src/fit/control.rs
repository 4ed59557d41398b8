//! Deadline, cancellation and progress of one fit.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::Stop;
use super::drawing::Drawing;
use super::forecast::Forecast;
use super::observer::{Observer, Progress};
use crate::metrics::psnr_db;

/// A search for less than this part of the strokes wanted is not worth a stage.
const MIN_PART: usize = 8;

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
    /// Where the time is limited.
    forecast: Option<Forecast>,
    /// The share of the time for descent after which it is the turn of others.
    until: f32,
    /// Work planned, in strokes × iterations.
    planned: f64,
    stages: usize,
    /// Its time is that before this run.
    spent: Spent,
    /// Strokes of the drawing, when it was last seen.
    strokes: usize,
    /// When the last step ended.
    stepped: Option<Duration>,
    /// Whether the limit made anything shorter than it was planned.
    is_hurried: bool,
    /// Set once, by whatever stopped the fit first.
    stopped: Option<Stop>,
}

impl<'a> Control<'a> {
    pub(super) fn new(
        observer: &'a mut (dyn Observer + Send),
        forecast: Option<Forecast>,
        started: Instant,
        planned: f64,
        stages: usize,
    ) -> Self {
        Self {
            observer,
            started,
            forecast,
            until: 1.0,
            planned,
            stages,
            spent: Spent::default(),
            strokes: 0,
            stepped: None,
            is_hurried: false,
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
        self.spent = spent;
    }

    /// Why the fit has to end now, if it has to.
    pub(super) fn stopped(&self) -> Option<Stop> {
        self.stopped
    }

    /// What the fit ended by, if it was not by its plan.
    pub(super) fn cut_by(&self) -> Option<Stop> {
        self.stopped.or(self.is_hurried.then_some(Stop::Time))
    }

    /// Whether a writing of the drawing is to be tried, so that it is known how long that takes.
    pub(super) fn wants_writing(&self) -> bool {
        let now = self.elapsed().as_secs_f64();
        self.forecast.as_ref().is_some_and(|f| f.is_due(now))
    }

    /// Does `work`, which writes a drawing of so many strokes, and takes down how long that takes.
    pub(super) fn writing<T>(&mut self, strokes: usize, work: impl FnOnce() -> T) -> T {
        self.strokes = strokes;
        let (done, span) = timed(work);
        let now = self.elapsed().as_secs_f64();
        if let Some(forecast) = &mut self.forecast {
            forecast.has_written(strokes, span, now);
        }
        done
    }

    /// The same of `work` that searches places for so many strokes.
    pub(super) fn searching<T>(&mut self, wanted: usize, work: impl FnOnce() -> T) -> T {
        let (done, span) = timed(work);
        if let Some(forecast) = &mut self.forecast {
            forecast.has_searched(wanted, span);
        }
        // A search is no part of a step.
        self.stepped = None;
        done
    }

    /// How many of the strokes wanted there is time to search places for, if not too few; the first ones in any
    /// case.
    pub(super) fn affordable(&mut self, wanted: usize) -> usize {
        let now = self.elapsed().as_secs_f64();
        let Some(forecast) = self.forecast.as_ref().filter(|_| self.strokes > 0) else {
            return wanted;
        };
        let affordable = forecast.affordable(self.strokes, now).min(wanted);
        self.is_hurried |= affordable < wanted;
        if affordable >= wanted / MIN_PART {
            affordable
        } else {
            0
        }
    }

    /// Whether there is time for a joint fit that is not too short to be of use.
    pub(super) fn allows_polish(&mut self) -> bool {
        let now = self.elapsed().as_secs_f64();
        let forecast = self.forecast.as_ref();
        let allows = forecast.is_none_or(|f| f.allows_polish(self.strokes, now));
        self.is_hurried |= !allows;
        allows
    }

    /// Whether to settle for another round after so many, where `planned` are: as many as planned or, where the
    /// limit made the descent shorter, as there is time for.
    pub(super) fn allows_round(&self, done: usize, planned: usize) -> bool {
        let now = self.elapsed().as_secs_f64();
        let forecast = self.forecast.as_ref();
        let is_wanted = done < planned || (planned > 0 && self.cut_by() == Some(Stop::Time));
        is_wanted && forecast.is_none_or(|f| f.allows_round(self.strokes, now))
    }

    /// Whether there is time for another step of a round.
    pub(super) fn allows_step(&self) -> bool {
        let now = self.elapsed().as_secs_f64();
        let forecast = self.forecast.as_ref();
        forecast.is_none_or(|f| f.allows_step(self.strokes, now))
    }

    /// Gives what follows the time for descent up to a share `until` of all there is.
    pub(super) fn give_until(&mut self, until: f32) {
        self.until = until;
    }

    /// The share that is used up of the time given; 0 without a limit.
    pub(super) fn time_used(&self) -> f32 {
        let now = self.elapsed().as_secs_f64();
        let end = self
            .forecast
            .as_ref()
            .map(|f| f.end_of_descent(self.strokes));
        end.map_or(0.0, |end| (now / end) as f32 / self.until)
    }

    /// Says that the limit makes something shorter than it was planned.
    pub(super) fn hurry(&mut self) {
        self.is_hurried = true;
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
        self.take_step(drawing.len());
        let done = (self.spent.done / self.planned).max(f64::from(self.time_used()));
        self.spent.fraction = done.clamp(self.spent.fraction, 1.0);
        if self.stopped.is_none() && self.time_used() * self.until >= 1.0 {
            self.stopped = Some(Stop::Time);
        }
        self.goes_on(drawing, mse) && self.stopped.is_none()
    }

    /// Takes down how long the last step took, of a drawing of so many strokes.
    fn take_step(&mut self, strokes: usize) {
        let now = self.elapsed();
        if let (Some(forecast), Some(before)) = (&mut self.forecast, self.stepped) {
            forecast.has_stepped((now - before).as_secs_f64());
        }
        (self.strokes, self.stepped) = (strokes, Some(now));
    }
}

/// What `work` makes, and how many seconds that takes.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = work();
    (made, start.elapsed().as_secs_f64())
}
