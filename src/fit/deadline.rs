//! The deadline of a fit, if it has one, and the clock that measures it.

use std::time::Duration;

use crate::clock::Instant;

/// Answers what a fit still has time for. Times are in seconds since it was
/// set, usually when the fit began. The methods provided here are
/// those of a fit without a limit; `Forecast` implements a limit.
pub(super) trait Deadline: Send {
    /// Records that writing and rendering `strokes` strokes took `span` and ended at `now`.
    fn wrote(&mut self, _strokes: usize, _span: f64, _now: f64) {}

    /// Records that a step of descent took `span`.
    fn stepped(&mut self, _span: f64) {}

    /// Records that the search for `strokes` candidates took `span`.
    fn searched(&mut self, _strokes: usize, _span: f64) {}

    /// Whether to write the drawing once, to measure how long that takes.
    fn wants_rehearsal(&self, _now: f64) -> bool {
        false
    }

    /// The share of the time for descent that is used, for a drawing of `strokes` strokes.
    fn used(&self, _strokes: usize, _now: f64) -> f32 {
        0.0
    }

    /// How many of `wanted` candidates there is time to search for, on a drawing of `strokes` strokes; 0 if too few.
    fn affordable(&self, wanted: usize, _strokes: usize, _now: f64) -> usize {
        wanted
    }

    /// Whether there is time for a polish that is long enough to be of use.
    fn allows_polish(&self, _strokes: usize, _now: f64) -> bool {
        true
    }

    /// Whether another round of settling, of a few steps at least, ends in time.
    fn allows_round(&self, _strokes: usize, _now: f64) -> bool {
        true
    }

    /// Whether another step of a round of settling ends in time.
    fn allows_step(&self, _strokes: usize, _now: f64) -> bool {
        true
    }
}

/// No deadline.
pub(super) struct Unlimited;

impl Deadline for Unlimited {}

/// The clock of a fit, and its deadline.
pub(super) struct Timer {
    started: Instant,
    /// Time that the fit took before it was resumed.
    before: Duration,
    deadline: Box<dyn Deadline>,
    /// When the deadline was set: its times begin there.
    set: Duration,
    /// The share of the time for descent by which the current phase has to end.
    until: f32,
    /// Strokes of the drawing, when they were last counted.
    strokes: usize,
    /// When the last step ended.
    stepped: Option<Duration>,
    /// Whether the limit made anything shorter than planned.
    is_hurried: bool,
}

impl Timer {
    pub(super) fn new(started: Instant, deadline: Box<dyn Deadline>) -> Self {
        Self {
            started,
            before: Duration::ZERO,
            deadline,
            set: Duration::ZERO,
            until: 1.0,
            strokes: 0,
            stepped: None,
            is_hurried: false,
        }
    }

    /// Time that the fit has taken, before and after it was resumed.
    pub(super) fn elapsed(&self) -> Duration {
        self.before + self.started.elapsed()
    }

    /// Adds the time that the fit took before it was resumed.
    pub(super) fn resume(&mut self, before: Duration) {
        self.before = before;
    }

    /// Replaces the deadline by one whose time begins now.
    pub(super) fn restart(&mut self, deadline: Box<dyn Deadline>) {
        (self.deadline, self.set) = (deadline, self.elapsed());
        self.stepped = None;
    }

    /// Time since the deadline was set, s.
    fn now(&self) -> f64 {
        self.elapsed().saturating_sub(self.set).as_secs_f64()
    }

    /// Whether the limit made anything shorter than planned.
    pub(super) fn is_hurried(&self) -> bool {
        self.is_hurried
    }

    /// Records that the limit makes something shorter than planned.
    pub(super) fn hurry(&mut self) {
        self.is_hurried = true;
    }

    /// Runs and times `work`, which writes and renders a drawing of `strokes` strokes.
    pub(super) fn writing<T>(&mut self, strokes: usize, work: impl FnOnce() -> T) -> T {
        self.strokes = strokes;
        let (done, span) = timed(work);
        let now = self.now();
        self.deadline.wrote(strokes, span, now);
        done
    }

    /// Runs and times `work`, which searches for `wanted` candidates.
    pub(super) fn searching<T>(&mut self, wanted: usize, work: impl FnOnce() -> T) -> T {
        let (done, span) = timed(work);
        self.deadline.searched(wanted, span);
        // A search is no part of a step.
        self.stepped = None;
        done
    }

    /// Records the end of a step of a drawing of `strokes` strokes.
    pub(super) fn step(&mut self, strokes: usize) {
        let now = self.elapsed();
        if let Some(before) = self.stepped {
            self.deadline.stepped((now - before).as_secs_f64());
        }
        (self.strokes, self.stepped) = (strokes, Some(now));
    }

    /// Whether to write the drawing once, to measure how long that takes.
    pub(super) fn wants_rehearsal(&self) -> bool {
        self.deadline.wants_rehearsal(self.now())
    }

    /// How many of `wanted` candidates there is time to search for; 0 if too few. The first search is never limited.
    pub(super) fn affordable(&mut self, wanted: usize) -> usize {
        if self.strokes == 0 {
            return wanted;
        }
        let affordable = self.deadline.affordable(wanted, self.strokes, self.now());
        self.is_hurried |= affordable < wanted;
        affordable
    }

    /// Whether there is time for a polish that is long enough to be of use.
    pub(super) fn allows_polish(&mut self) -> bool {
        let allows = self.deadline.allows_polish(self.strokes, self.now());
        self.is_hurried |= !allows;
        allows
    }

    /// Whether another round of settling ends in time.
    pub(super) fn allows_round(&self) -> bool {
        self.deadline.allows_round(self.strokes, self.now())
    }

    /// Whether another step of a round of settling ends in time.
    pub(super) fn allows_step(&self) -> bool {
        self.deadline.allows_step(self.strokes, self.now())
    }

    /// Ends the time of what follows at a share `until` of the whole time for descent.
    pub(super) fn give_until(&mut self, until: f32) {
        self.until = until;
    }

    /// The share of that time that is used; 0 without a limit.
    pub(super) fn used(&self) -> f32 {
        self.deadline.used(self.strokes, self.now()) / self.until
    }

    /// Whether the whole time for descent is used.
    pub(super) fn is_over(&self) -> bool {
        self.used() * self.until >= 1.0
    }
}

/// The result of `work`, and the seconds that it took.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = work();
    (made, start.elapsed().as_secs_f64())
}
