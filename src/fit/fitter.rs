//! A fit as its caller sees it: the options of a run, and the fit itself.

use std::time::Duration;

use super::base::Base;
use super::budget::paleness::paleness;
use super::config::{Background, Config, Execution};
use super::drawing::focus::Focus;
use super::multi_start;
use super::result::Fit;
use super::run::checkpoint::Checkpoint;
use super::run::progress::{CancelToken, Observer, Watch};
use super::task::Task;
use crate::clock::Instant;
use crate::error::Result;
use crate::image::Image;
use crate::restore;

/// Draws pictures with strokes.
///
/// ```
/// use std::ops::ControlFlow;
/// use strokefit::fit::{Budget, Config, Fitter, Progress};
/// use strokefit::image::Image;
///
/// let picture = Image::filled(32, 32, [0.8, 0.2, 0.1])?;
/// let config = Config { budget: Budget { strokes: Some(8), ..Budget::default() }, ..Config::default() };
/// let mut watch = |progress: &Progress<'_>| {
///     println!("{} strokes, {:.1} dB", progress.scene().len(), progress.psnr_db);
///     ControlFlow::Continue(())
/// };
/// let drawing = Fitter::new(config).observer(&mut watch).fit(&picture)?;
/// assert!(drawing.scene.is_empty(), "a picture of one colour needs no stroke");
/// # Ok::<(), strokefit::Error>(())
/// ```
pub struct Fitter<'a> {
    task: Task,
    execution: Execution,
    observer: Option<&'a mut (dyn Observer + Send)>,
    token: CancelToken,
    checkpoint: Option<&'a mut Checkpoint>,
    since: Option<Instant>,
    grace: Duration,
}

impl<'a> Fitter<'a> {
    /// A fitter with this configuration.
    pub fn new(config: Config) -> Self {
        Self {
            task: Task::new(config),
            execution: Execution::default(),
            observer: None,
            token: CancelToken::default(),
            checkpoint: None,
            since: None,
            grace: Duration::ZERO,
        }
    }

    /// Sets how to run.
    #[must_use]
    pub fn execution(mut self, execution: Execution) -> Self {
        self.execution = execution;
        self
    }

    /// Sets the drawing to go on from. Budgets include its strokes and all its bytes, and a base that already meets a
    /// budget stays as it is. The background is that of the base.
    #[must_use]
    pub fn on(mut self, base: Base) -> Self {
        self.task.base = Some(base);
        self
    }

    /// Sets how much an error counts at each pixel. Strokes go where it counts; budgets of dB still count all pixels alike.
    #[must_use]
    pub fn focus(mut self, focus: Focus) -> Self {
        self.task.focus = Some(focus);
        self
    }

    /// Sets the observer, which is told of progress and may stop the fit. It sees drawings that compete with each other, too:
    /// [`Progress::is_trial`](super::Progress::is_trial) tells them apart.
    #[must_use]
    pub fn observer(mut self, observer: &'a mut (dyn Observer + Send)) -> Self {
        self.observer = Some(observer);
        self
    }

    /// Sets the token that stops the fit from another thread.
    #[must_use]
    pub fn cancelled_by(mut self, token: CancelToken) -> Self {
        self.token = token;
        self
    }

    /// Sets the checkpoint that keeps the state. If it already holds a state of the same fit, the fit goes on from
    /// there. The drawing does not depend on it.
    #[must_use]
    pub fn checkpoint(mut self, checkpoint: &'a mut Checkpoint) -> Self {
        self.checkpoint = Some(checkpoint);
        self
    }

    /// Sets the start of the time budget, which otherwise starts with the fit.
    #[must_use]
    pub fn since(mut self, start: Instant) -> Self {
        self.since = Some(start);
        self
    }

    /// Sets how long a fit that is asked to stop may take to finish its drawing, as if the time were up then. By default it
    /// stops at once, and its latest strokes are as they were seeded. The observer is still told of progress.
    #[must_use]
    pub fn grace(mut self, span: Duration) -> Self {
        self.grace = span;
        self
    }

    /// Draws `picture`.
    ///
    /// A picture with alpha gives a transparent drawing, unless a background colour is set.
    ///
    /// # Errors
    /// - [`ErrorKind::Config`](crate::ErrorKind::Config) when an option is outside its domain, the size of the base
    ///   differs from that of the picture, the palette lacks the background of the base, or the checkpoint belongs to
    ///   another fit.
    /// - [`ErrorKind::Svg`](crate::ErrorKind::Svg) when the base cannot be rendered.
    /// - [`ErrorKind::Io`](crate::ErrorKind::Io) when the checkpoint is damaged or cannot be written.
    pub fn fit(self, picture: &Image) -> Result<Fit> {
        let mut task = self.task;
        let since = self.since.unwrap_or_else(Instant::now);
        task.prepare(picture)?;
        let level = self.execution.simd.require()?;
        let pool = self.execution.pool()?;
        // 1. Restore the picture if it is damaged and damage is not to be drawn. A given fidelity covers everything in the picture.
        let is_literal = task.config.literal || task.config.budget.psnr_db.is_some();
        let restored = match is_literal {
            true => None,
            false => pool.install(|| restore::restored(picture, task.config.paper))?,
        };
        // Paper of a sheet that is not drawn is as good as white.
        let is_sheet = restored.as_ref().is_some_and(|r| r.damage.uneven_light);
        let restored = match task.config.background {
            Background::None if is_sheet => {
                pool.install(|| restore::whitened(picture, restored))?
            }
            _ => restored,
        };
        task.doubt = restored
            .as_ref()
            .map(|r| r.damage.doubt())
            .unwrap_or_default();
        let target = restored.as_ref().map_or(picture, |r| &r.picture);
        if task.config.is_open() {
            task.paleness_db = paleness(target, task.doubt.most());
        }
        // 2. Reduce it to the pixels that its drawing needs.
        let reduced = pool.install(|| task.reduce(target));
        let target = reduced.as_ref().unwrap_or(target);
        // 3. Draw it.
        let mut nobody = ();
        let watch = Watch {
            observer: self.observer.unwrap_or(&mut nobody),
            token: self.token,
            grace: self.grace,
        };
        let mut fit = pool
            .install(|| multi_start::draw(&task, target, level, (watch, since), self.checkpoint))?;
        // The drawing is judged by the picture that was given.
        if let Some(restored) = restored {
            let given = picture.reduced(fit.target.width(), fit.target.height());
            fit.meant = Some(std::mem::replace(&mut fit.target, given));
            fit.damage = Some(restored.damage);
        }
        Ok(fit)
    }
}
