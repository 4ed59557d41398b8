//! A limited time, or none: what a fit asks of it, and the clock that it is held against.

use std::time::Duration;

use crate::clock::Instant;

/// What a fit is told of the time that it has. Times are in seconds since the fit began. The answers are those of a
/// fit that may take as long as it likes; `Forecast` gives those of one that may not.
pub(super) trait Deadline: Send {
    /// Takes down that to write and render so many strokes took `span`, and was done at `now`.
    fn wrote(&mut self, _strokes: usize, _span: f64, _now: f64) {}

    /// Takes down that a step of descent took `span`.
    fn stepped(&mut self, _span: f64) {}

    /// Takes down that the search for so many strokes took `span`.
    fn searched(&mut self, _strokes: usize, _span: f64) {}

    /// Whether the drawing is to be written once, so that it is known how long that takes.
    fn wants_rehearsal(&self, _now: f64) -> bool {
        false
    }

    /// The share of the time for descent that is used, of a drawing of so many strokes.
    fn used(&self, _strokes: usize, _now: f64) -> f32 {
        0.0
    }

    /// For how many of `wanted` strokes there is time to search on a drawing of so many; 0 if for too few.
    fn affordable(&self, wanted: usize, _strokes: usize, _now: f64) -> usize {
        wanted
    }

    /// Whether there is time for a joint fit that is not too short to be of use.
    fn allows_polish(&self, _strokes: usize, _now: f64) -> bool {
        true
    }

    /// Whether another round of settling, if only of a few steps, ends in time.
    fn allows_round(&self, _strokes: usize, _now: f64) -> bool {
        true
    }

    /// Whether another step of a round of settling ends in time.
    fn allows_step(&self, _strokes: usize, _now: f64) -> bool {
        true
    }
}

/// A fit that may take as long as it likes.
pub(super) struct Unlimited;

impl Deadline for Unlimited {}

/// The clock of a fit, and the deadline that it is held against.
pub(super) struct Timer {
    started: Instant,
    /// What the fit took before it was resumed.
    before: Duration,
    deadline: Box<dyn Deadline>,
    /// The share of the time for descent after which it is the turn of others.
    until: f32,
    /// Strokes of the drawing, when it was last seen.
    strokes: usize,
    /// When the last step ended.
    stepped: Option<Duration>,
    /// Whether the limit made anything shorter than it was planned.
    is_hurried: bool,
}

impl Timer {
    pub(super) fn new(started: Instant, deadline: Box<dyn Deadline>) -> Self {
        Self {
            started,
            before: Duration::ZERO,
            deadline,
            until: 1.0,
            strokes: 0,
            stepped: None,
            is_hurried: false,
        }
    }

    /// Time since the fit began, what it took before it was resumed included.
    pub(super) fn elapsed(&self) -> Duration {
        self.before + self.started.elapsed()
    }

    /// Goes on from a fit that took `before`.
    pub(super) fn resume(&mut self, before: Duration) {
        self.before = before;
    }

    fn now(&self) -> f64 {
        self.elapsed().as_secs_f64()
    }

    /// Whether the limit made anything shorter than it was planned.
    pub(super) fn is_hurried(&self) -> bool {
        self.is_hurried
    }

    /// Takes down that the limit makes something shorter than it was planned.
    pub(super) fn hurry(&mut self) {
        self.is_hurried = true;
    }

    /// Does `work`, which writes and renders a drawing of so many strokes, and takes down how long that takes.
    pub(super) fn writing<T>(&mut self, strokes: usize, work: impl FnOnce() -> T) -> T {
        self.strokes = strokes;
        let (done, span) = timed(work);
        let now = self.now();
        self.deadline.wrote(strokes, span, now);
        done
    }

    /// The same of `work` that searches places for so many strokes.
    pub(super) fn searching<T>(&mut self, wanted: usize, work: impl FnOnce() -> T) -> T {
        let (done, span) = timed(work);
        self.deadline.searched(wanted, span);
        // A search is no part of a step.
        self.stepped = None;
        done
    }

    /// Takes down that a step of a drawing of so many strokes has ended.
    pub(super) fn step(&mut self, strokes: usize) {
        let now = self.elapsed();
        if let Some(before) = self.stepped {
            self.deadline.stepped((now - before).as_secs_f64());
        }
        (self.strokes, self.stepped) = (strokes, Some(now));
    }

    /// Whether the drawing is to be written once, so that it is known how long that takes.
    pub(super) fn wants_rehearsal(&self) -> bool {
        self.deadline.wants_rehearsal(self.now())
    }

    /// How many of the strokes wanted there is time to search places for, if not too few; the first ones in any
    /// case.
    pub(super) fn affordable(&mut self, wanted: usize) -> usize {
        if self.strokes == 0 {
            return wanted;
        }
        let affordable = self.deadline.affordable(wanted, self.strokes, self.now());
        self.is_hurried |= affordable < wanted;
        affordable
    }

    /// Whether there is time for a joint fit that is not too short to be of use.
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

    /// Gives what follows the time for descent up to a share `until` of all there is.
    pub(super) fn give_until(&mut self, until: f32) {
        self.until = until;
    }

    /// The share that is used up of the time given; 0 without a limit.
    pub(super) fn used(&self) -> f32 {
        self.deadline.used(self.strokes, self.now()) / self.until
    }

    /// Whether all the time for descent is used up.
    pub(super) fn is_over(&self) -> bool {
        self.used() * self.until >= 1.0
    }
}

/// What `work` makes, and how many seconds that takes.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = work();
    (made, start.elapsed().as_secs_f64())
}
