//! The observer of drawings that compete: it sees all of them, one after the other, as one piece of work.

use std::ops::{ControlFlow, Range};

use super::progress::{CancelToken, Observer, Progress};

/// Passes the progress of the drawings of a fit on to its observer, and remembers whether that has stopped them.
pub(in crate::fit) struct Trials<'a> {
    observer: &'a mut (dyn Observer + Send),
    token: CancelToken,
    /// True if the last drawing may be finished after a stop, and reports its progress.
    has_grace: bool,
    /// Drawings before the last one that are still to come, at most.
    left: usize,
    /// The part of all work that the current drawing is, 0..1.
    part: Range<f64>,
    is_trial: bool,
    /// True if the observer has stopped a drawing.
    stopped: bool,
}

impl<'a> Trials<'a> {
    /// At most `trials` drawings are tried before the last one.
    pub(in crate::fit) fn new(
        observer: &'a mut (dyn Observer + Send),
        token: CancelToken,
        has_grace: bool,
        trials: usize,
    ) -> Self {
        Self {
            observer,
            token,
            has_grace,
            left: trials,
            part: 0.0..0.0,
            is_trial: false,
            stopped: false,
        }
    }

    /// The observer of the next drawing that is tried.
    pub(in crate::fit) fn next(&mut self) -> &mut Self {
        let from = self.part.end;
        // Each drawing gets an equal part of the work that is left. There may be fewer drawings than planned, so that the last one
        // takes all of the rest.
        self.part = from..from + (1.0 - from) / (self.left + 1) as f64;
        self.left = self.left.saturating_sub(1);
        self.is_trial = true;
        self
    }

    /// The observer of the drawing with which all work is done.
    pub(in crate::fit) fn last(&mut self) -> &mut Self {
        self.part = self.part.end..1.0;
        self.left = 0;
        self.is_trial = false;
        self
    }

    /// True if the observer or the token has stopped a drawing: no further one is to be tried.
    pub(in crate::fit) fn are_stopped(&self) -> bool {
        self.stopped || self.token.is_cancelled()
    }

    /// True if the last drawing is not to be begun either.
    pub(in crate::fit) fn are_halted(&self) -> bool {
        self.are_stopped() && !self.has_grace
    }
}

impl Observer for Trials<'_> {
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        // Don't poll an observer that has stopped the fit.
        if self.stopped && !self.has_grace {
            return ControlFlow::Break(());
        }
        let Range { start, end } = self.part;
        let answer = self.observer.observe(&Progress {
            done: start + (end - start) * progress.done,
            is_trial: self.is_trial,
            ..*progress
        });
        self.stopped |= answer.is_break();
        match self.stopped {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}
