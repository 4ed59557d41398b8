//! The clock of a fit, which measures it against a time limit if there is one.

use std::time::Duration;

use crate::clock::Instant;
use crate::fit::time::Forecast;

/// The clock of a fit, and the forecast of what a time limit leaves room for. Without a limit there is time for everything.
pub(in crate::fit) struct Timer {
    started: Instant,
    /// Time that the fit took before it was resumed.
    before: Duration,
    /// The forecast, if the time is limited.
    forecast: Option<Forecast>,
    /// When the limit was set: the times of the forecast begin there.
    set: Duration,
    /// The share of the time for descent by which the current phase has to end.
    until: f32,
    /// Strokes of the drawing, when they were last counted.
    strokes: usize,
    /// When the last step ended.
    stepped: Option<Duration>,
    /// True if the limit made anything shorter than planned.
    is_hurried: bool,
}

impl Timer {
    pub(in crate::fit) fn new(started: Instant, forecast: Option<Forecast>) -> Self {
        Self {
            started,
            before: Duration::ZERO,
            forecast,
            set: Duration::ZERO,
            until: 1.0,
            strokes: 0,
            stepped: None,
            is_hurried: false,
        }
    }

    /// Time that the fit has taken, before and after it was resumed.
    pub(in crate::fit) fn elapsed(&self) -> Duration {
        self.before + self.started.elapsed()
    }

    /// Adds the time that the fit took before it was resumed.
    pub(in crate::fit) fn resume(&mut self, before: Duration) {
        self.before = before;
    }

    /// Sets a limit whose time begins now.
    pub(in crate::fit) fn restart(&mut self, forecast: Forecast) {
        (self.forecast, self.set) = (Some(forecast), self.elapsed());
        self.stepped = None;
    }

    /// Time since the limit was set, s.
    fn now(&self) -> f64 {
        self.elapsed().saturating_sub(self.set).as_secs_f64()
    }

    /// True if the limit made anything shorter than planned.
    pub(in crate::fit) fn is_hurried(&self) -> bool {
        self.is_hurried
    }

    /// Records that the limit makes something shorter than planned.
    pub(in crate::fit) fn hurry(&mut self) {
        self.is_hurried = true;
    }

    /// Runs and times `work`, which writes and renders a drawing of `strokes` strokes.
    pub(in crate::fit) fn writing<T>(&mut self, strokes: usize, work: impl FnOnce() -> T) -> T {
        self.strokes = strokes;
        let (done, span) = timed(work);
        let now = self.now();
        if let Some(forecast) = &mut self.forecast {
            forecast.wrote(strokes, span, now);
        }
        done
    }

    /// Runs and times `work`, which searches for `wanted` candidates.
    pub(in crate::fit) fn searching<T>(&mut self, wanted: usize, work: impl FnOnce() -> T) -> T {
        let (done, span) = timed(work);
        if let Some(forecast) = &mut self.forecast {
            forecast.searched(wanted, span);
        }
        // A search is no part of a step.
        self.stepped = None;
        done
    }

    /// Records the end of a step of a drawing of `strokes` strokes.
    pub(in crate::fit) fn step(&mut self, strokes: usize) {
        let now = self.elapsed();
        if let (Some(forecast), Some(before)) = (&mut self.forecast, self.stepped) {
            forecast.stepped((now - before).as_secs_f64());
        }
        (self.strokes, self.stepped) = (strokes, Some(now));
    }

    /// True if it is time to write the drawing once, to measure how long that takes.
    pub(in crate::fit) fn wants_trial_write(&self) -> bool {
        let forecast = self.forecast.as_ref();
        forecast.is_some_and(|forecast| forecast.wants_trial_write(self.now()))
    }

    /// Number of `wanted` candidates that there is time to search for; 0 if too few. The first search is never limited.
    pub(in crate::fit) fn affordable(&mut self, wanted: usize) -> usize {
        let Some(forecast) = self.forecast.as_ref().filter(|_| self.strokes > 0) else {
            return wanted;
        };
        let affordable = forecast.affordable(wanted, self.strokes, self.now());
        self.is_hurried |= affordable < wanted;
        affordable
    }

    /// True if there is time for a polish that is long enough to be of use.
    pub(in crate::fit) fn allows_polish(&mut self) -> bool {
        let allows = self.allows(Forecast::allows_polish);
        self.is_hurried |= !allows;
        allows
    }

    /// True if another round of settling ends in time.
    pub(in crate::fit) fn allows_round(&self) -> bool {
        self.allows(Forecast::allows_round)
    }

    /// True if another step of a round of settling ends in time.
    pub(in crate::fit) fn allows_step(&self) -> bool {
        self.allows(Forecast::allows_step)
    }

    /// The answer of the forecast; yes if there is none.
    fn allows(&self, question: impl Fn(&Forecast, usize, f64) -> bool) -> bool {
        let forecast = self.forecast.as_ref();
        forecast.is_none_or(|forecast| question(forecast, self.strokes, self.now()))
    }

    /// Ends the time of what follows at a share `until` of the whole time for descent.
    pub(in crate::fit) fn give_until(&mut self, until: f32) {
        self.until = until;
    }

    /// The share of that time that is used; 0 without a limit.
    pub(in crate::fit) fn used(&self) -> f32 {
        let forecast = self.forecast.as_ref();
        forecast.map_or(0.0, |forecast| forecast.used(self.strokes, self.now())) / self.until
    }

    /// True if the whole time for descent is used.
    pub(in crate::fit) fn is_over(&self) -> bool {
        self.used() * self.until >= 1.0
    }
}

/// The result of `work`, and the seconds that it took.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = work();
    (made, start.elapsed().as_secs_f64())
}
