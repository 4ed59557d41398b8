//! Progress and cancellation: the observer is called after every iteration, and may stop the fit.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::fit::drawing::Drawing;
use crate::fit::result::Stop;
use crate::metrics::psnr_db;
use crate::scene::Scene;

/// The state of a fit after an iteration.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct Progress<'a> {
    /// Fraction of the planned work that is done, 0..1, never decreasing.
    pub done: f64,
    /// Index of the stage under way, from 1; one past the last during polish.
    pub stage: usize,
    /// Number of planned stages; 0 if that depends on how much each of them gains.
    pub stages: usize,
    /// True if strokes are being polished: all strokes or, in a progressive drawing, the strokes of this stage.
    pub polishing: bool,
    /// True if the drawing takes its last steps, against renders of its file.
    pub settling: bool,
    /// Strokes in the drawing.
    pub strokes: usize,
    /// Fidelity of the soft render to the target, dB.
    pub psnr_db: f64,
    /// True if the drawing is a trial: the fit makes several, one after the other, and keeps the best one.
    pub is_trial: bool,
    pub(in crate::fit) drawing: &'a Drawing,
}

impl Progress<'_> {
    /// The drawing so far: unrounded, in px of the picture, on its background. Each call builds a new scene.
    pub fn scene(&self) -> Scene {
        self.drawing.scene(true)
    }
}

/// Gets progress, and may stop the fit. A stopped fit is no error: it returns the drawing as far as it has come.
pub trait Observer {
    /// Called after every iteration, always on the same thread; it should return soon.
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()>;
}

/// An observer that never stops the fit.
impl Observer for () {
    fn observe(&mut self, _: &Progress<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<F: FnMut(&Progress<'_>) -> ControlFlow<()>> Observer for F {
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        self(progress)
    }
}

/// Stops a fit from another thread. A stopped fit is no error: it returns the drawing as far as it has come.
///
/// ```
/// use strokefit::fit::{CancelToken, Config, Fitter, Stop};
/// use strokefit::image::Image;
///
/// let token = CancelToken::default();
/// let elsewhere = token.clone();
/// std::thread::spawn(move || elsewhere.cancel()).join().map_err(|_| "panicked")?;
///
/// let plane: Vec<f32> = (0..32 * 32).map(|i| (i % 7) as f32 / 6.0).collect();
/// let picture = Image::new(32, 32, [plane.clone(), plane.clone(), plane])?;
/// let fit = Fitter::new(Config::default()).cancelled_by(token).fit(&picture)?;
/// assert_eq!(fit.stop, Stop::Interrupted);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Stops every fit that has this token or a clone of it, after its current iteration.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// True if [`cancel`](Self::cancel) was called.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// The observer and the token of a fit, and how long the fit may go on once it is stopped.
pub(in crate::fit) struct Watch<'a> {
    pub(in crate::fit) observer: &'a mut (dyn Observer + Send),
    pub(in crate::fit) token: CancelToken,
    pub(in crate::fit) grace: Duration,
}

/// Position of a fit on its way.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(in crate::fit) struct Position {
    /// Work done, in strokes × iterations.
    done: f64,
    /// The fraction last reported to the observer.
    fraction: f64,
    /// The current stage, from 1.
    stage: usize,
    /// True if strokes are being polished.
    polishing: bool,
}

/// Counts progress, reports it to the observer, and knows whether the fit has to stop.
pub(in crate::fit) struct Tracker<'a> {
    watch: Watch<'a>,
    /// Work planned, in strokes × iterations.
    planned: f64,
    stages: usize,
    pub(in crate::fit) position: Position,
    /// True if the drawing is being settled.
    settling: bool,
    /// True if an observer or a token has asked the fit to stop.
    asked: bool,
    /// True once a fit that was asked to stop finishes its drawing.
    is_leaving: bool,
    /// Set once, by whatever stopped the fit first.
    stopped: Option<Stop>,
}

impl<'a> Tracker<'a> {
    pub(in crate::fit) fn new(watch: Watch<'a>, planned: f64, stages: usize) -> Self {
        Self {
            watch,
            planned,
            stages,
            position: Position::default(),
            settling: false,
            asked: false,
            is_leaving: false,
            stopped: None,
        }
    }

    /// Reports to the observer of `other` from now on, and `other` to its own. What is done never decreases.
    pub(in crate::fit) fn take_over(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.watch, &mut other.watch);
        self.asked |= other.asked;
        let fraction = &mut self.position.fraction;
        *fraction = fraction.max(other.position.fraction);
    }

    /// Why the fit has to stop now, if it has to.
    pub(in crate::fit) fn stopped(&self) -> Option<Stop> {
        self.stopped
    }

    /// True if an observer or a token has asked the fit to stop.
    pub(in crate::fit) fn is_interrupted(&self) -> bool {
        self.asked
    }

    /// The time that a fit may take to finish its drawing, if it was asked to stop just now.
    pub(in crate::fit) fn leave(&mut self) -> Option<Duration> {
        let may_finish = self.asked && !self.watch.grace.is_zero();
        let is_first = may_finish && !std::mem::replace(&mut self.is_leaving, true);
        is_first.then_some(self.watch.grace)
    }

    /// True if they stopped it at once.
    pub(in crate::fit) fn is_halted(&self) -> bool {
        self.stopped == Some(Stop::Interrupted)
    }

    /// Stops the fit, unless something else already did.
    pub(in crate::fit) fn stop(&mut self, stop: Stop) {
        self.stopped.get_or_insert(stop);
    }

    /// Begins stage `stage`, from 0.
    pub(in crate::fit) fn enter(&mut self, stage: usize) {
        self.position.stage = stage + 1;
        self.position.polishing = false;
        self.settling = false;
    }

    /// Begins a polish.
    pub(in crate::fit) fn polish(&mut self) {
        self.position.polishing = true;
        self.settling = false;
    }

    /// Begins to settle.
    pub(in crate::fit) fn settle(&mut self) {
        self.settling = true;
    }

    /// Counts an iteration of `strokes` strokes, when a share `time_used` of a limited time is used. At least `rest`
    /// strokes × iterations are to come, or about that if it `is_known`: where gains decide how many strokes there are, the plan
    /// was a guess.
    pub(in crate::fit) fn advance(
        &mut self,
        strokes: usize,
        rest: usize,
        is_known: bool,
        time_used: f32,
    ) {
        let position = &mut self.position;
        position.done += strokes as f64;
        // The plan grows if more work turns out to come; it shrinks only if the rest is known.
        let least = position.done + rest as f64;
        self.planned = match is_known {
            true => least,
            false => self.planned.max(least),
        };
        let done = (position.done / self.planned).max(f64::from(time_used));
        // A plan that grows would move the fraction back; it stays instead.
        position.fraction = done.clamp(position.fraction, 1.0);
    }

    /// Reports `drawing`, whose mean squared error is `mse`, to the observer. Returns whether to go on.
    pub(in crate::fit) fn tell(&mut self, drawing: &Drawing, mse: f64) -> bool {
        if self.is_halted() {
            return false;
        }
        let progress = Progress {
            done: self.position.fraction,
            stage: self.position.stage,
            stages: self.stages,
            polishing: self.position.polishing,
            settling: self.settling,
            strokes: drawing.len(),
            psnr_db: psnr_db(mse),
            is_trial: false,
            drawing,
        };
        let Watch {
            observer, token, ..
        } = &mut self.watch;
        self.asked |= observer.observe(&progress).is_break() || token.is_cancelled();
        if self.asked && self.watch.grace.is_zero() {
            self.stopped = Some(Stop::Interrupted);
        }
        !self.is_halted()
    }
}
