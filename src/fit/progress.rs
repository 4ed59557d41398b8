//! Progress and cancellation, one path: whoever watches a fit is told after every iteration, and may end it.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Deserialize, Serialize};

use super::drawing::Drawing;
use super::result::Stop;
use crate::metrics::psnr_db;
use crate::scene::Scene;

/// What has just happened in a fit.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct Progress<'a> {
    /// Fraction of the planned work that is done, 0..1, never decreasing.
    pub done: f64,
    /// Index of the stage under way, from 1; one past the last during polish.
    pub stage: usize,
    /// How many stages are planned; 0 where the picture decides as it goes.
    pub stages: usize,
    /// Whether strokes of several stages are fitted jointly, or those of this stage once more.
    pub polishing: bool,
    /// Strokes in the drawing.
    pub strokes: usize,
    /// Fidelity of the soft render to the target, dB.
    pub psnr_db: f64,
    drawing: &'a Drawing,
}

impl Progress<'_> {
    /// The drawing so far: unrounded, in px of the picture, on its background. Made anew at every call.
    pub fn scene(&self) -> Scene {
        self.drawing.scene(true)
    }
}

/// Told of progress; may stop the fit. Stopping is no error: what is finished is a valid scene.
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

/// Ends a fit from another thread, as an observer does that stops it: what is finished is a valid scene.
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
/// assert_eq!(fit.stop, Stop::Observer);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Ends every fit that has this token or a clone of it, after the iteration that is under way.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether [`cancel`](Self::cancel) was called.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// How far a fit has come.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Position {
    /// Work done, in strokes × iterations.
    done: f64,
    /// The fraction that the observer was told.
    fraction: f64,
    /// The stage under way, and whether it is polished.
    stage: usize,
    polishing: bool,
}

/// Keeps account of progress, tells the observer of it, and knows whether the fit has to end.
pub(super) struct Tracker<'a> {
    observer: &'a mut (dyn Observer + Send),
    token: CancelToken,
    /// Work planned, in strokes × iterations.
    planned: f64,
    stages: usize,
    pub(super) position: Position,
    /// Set once, by whatever stopped the fit first.
    stopped: Option<Stop>,
}

impl<'a> Tracker<'a> {
    pub(super) fn new(
        observer: &'a mut (dyn Observer + Send),
        token: CancelToken,
        planned: f64,
        stages: usize,
    ) -> Self {
        Self {
            observer,
            token,
            planned,
            stages,
            position: Position::default(),
            stopped: None,
        }
    }

    /// Why the fit has to end now, if it has to.
    pub(super) fn stopped(&self) -> Option<Stop> {
        self.stopped
    }

    /// Whether an observer or a token ended the fit.
    pub(super) fn is_interrupted(&self) -> bool {
        self.stopped == Some(Stop::Observer)
    }

    /// Ends the fit, unless something else did before.
    pub(super) fn stop(&mut self, stop: Stop) {
        self.stopped.get_or_insert(stop);
    }

    /// Announces stage `stage`, from 0.
    pub(super) fn enter(&mut self, stage: usize) {
        self.position.stage = stage + 1;
        self.position.polishing = false;
    }

    /// Announces a joint fit.
    pub(super) fn polish(&mut self) {
        self.position.polishing = true;
    }

    /// Adds an iteration of so many strokes to what is done, when a share `time_used` of a limited time is used.
    pub(super) fn advance(&mut self, strokes: usize, time_used: f32) {
        let position = &mut self.position;
        position.done += strokes as f64;
        let done = (position.done / self.planned).max(f64::from(time_used));
        position.fraction = done.clamp(position.fraction, 1.0);
    }

    /// Tells the observer of `drawing`, whose mean squared error is `mse`, and says whether it lets the fit go on.
    pub(super) fn tell(&mut self, drawing: &Drawing, mse: f64) -> bool {
        if self.is_interrupted() {
            return false;
        }
        let progress = Progress {
            done: self.position.fraction,
            stage: self.position.stage,
            stages: self.stages,
            polishing: self.position.polishing,
            strokes: drawing.len(),
            psnr_db: psnr_db(mse),
            drawing,
        };
        if self.observer.observe(&progress).is_break() || self.token.is_cancelled() {
            self.stopped = Some(Stop::Observer);
        }
        !self.is_interrupted()
    }
}
