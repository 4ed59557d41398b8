//! The builder of a fit.

use std::time::Duration;

use super::base::Base;
use super::config::{Config, Execution};
use super::drawing::background;
use super::drawing::focus::Focus;
use super::run::checkpoint::Checkpoint;
use super::run::progress::{CancelToken, Observer};
use crate::clock::Instant;
use crate::error::{Error, ErrorKind, Result};
use crate::image::Image;
use crate::scene::Scene;

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
    pub(super) config: Config,
    pub(super) execution: Execution,
    pub(super) base: Option<Base>,
    pub(super) focus: Option<Focus>,
    pub(super) observer: Option<&'a mut (dyn Observer + Send)>,
    pub(super) token: CancelToken,
    pub(super) checkpoint: Option<&'a mut Checkpoint>,
    pub(super) since: Option<Instant>,
    pub(super) grace: Duration,
    /// Size of the picture, px, if a reduced one is drawn.
    pub(super) page: Option<[u32; 2]>,
    /// Estimated RMS distance of the picture from the restored one, in 8-bit levels.
    pub(super) doubt: f32,
    /// Most marks of a drawing that areas are split in, if few are wanted.
    pub(super) most_marks: Option<usize>,
}

impl<'a> Fitter<'a> {
    /// A fitter with this configuration.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            execution: Execution::default(),
            base: None,
            focus: None,
            observer: None,
            token: CancelToken::default(),
            checkpoint: None,
            since: None,
            grace: Duration::ZERO,
            page: None,
            doubt: 0.0,
            most_marks: None,
        }
    }

    /// Sets how to run.
    #[must_use]
    pub fn execution(self, execution: Execution) -> Self {
        Self { execution, ..self }
    }

    /// Sets the drawing to go on from. Budgets include its strokes and all its bytes, and a base that already meets a
    /// budget stays as it is. The background is that of the base.
    #[must_use]
    pub fn on(self, base: Base) -> Self {
        Self {
            base: Some(base),
            ..self
        }
    }

    /// Sets how much an error counts at each pixel. Strokes go where it counts; budgets of dB still count all pixels alike.
    #[must_use]
    pub fn focus(self, focus: Focus) -> Self {
        Self {
            focus: Some(focus),
            ..self
        }
    }

    /// Sets the observer, which is told of progress and may stop the fit. It sees drawings that compete with each other, too:
    /// [`Progress::is_trial`](super::Progress::is_trial) tells them apart.
    #[must_use]
    pub fn observer(self, observer: &'a mut (dyn Observer + Send)) -> Self {
        Self {
            observer: Some(observer),
            ..self
        }
    }

    /// Sets the token that stops the fit from another thread.
    #[must_use]
    pub fn cancelled_by(self, token: CancelToken) -> Self {
        Self { token, ..self }
    }

    /// Sets the checkpoint that keeps the state. If it already holds a state of the same fit, the fit goes on from
    /// there. The drawing does not depend on it.
    #[must_use]
    pub fn checkpoint(self, checkpoint: &'a mut Checkpoint) -> Self {
        Self {
            checkpoint: Some(checkpoint),
            ..self
        }
    }

    /// Sets the start of the time budget, which otherwise starts with the fit.
    #[must_use]
    pub fn since(self, start: Instant) -> Self {
        Self {
            since: Some(start),
            ..self
        }
    }

    /// Sets how long a fit that is asked to stop may take to finish its drawing, as if the time were up then. By default it
    /// stops at once, and its latest strokes are as they were seeded. The observer is still told of progress.
    #[must_use]
    pub fn grace(self, span: Duration) -> Self {
        Self {
            grace: span,
            ..self
        }
    }

    /// Checks the configuration and the base against `picture`, and decides on the background for opaque strokes.
    pub(super) fn prepare(&mut self, picture: &Image) -> Result<()> {
        let config = &mut self.config;
        config.check()?;
        config.background = background::for_strokes(config.background, config.opaque, picture);
        if let Some(focus) = &self.focus {
            focus.check_size(picture)?;
        }
        if let Some(base) = &self.base {
            check_size(&base.scene, picture)?;
            // The palette does not apply to a document, whose background is its own.
            if let (None, Some(color)) = (&base.document, base.scene.background) {
                config.check_background(color, ", since the base stays on it")?;
            }
        }
        Ok(())
    }
}

fn check_size(scene: &Scene, picture: &Image) -> Result<()> {
    let (width, height) = (picture.width(), picture.height());
    let is_of_size = |[w, h]: [u32; 2]| (w as usize, h as usize) == (width, height);
    if is_of_size([scene.width, scene.height]) || scene.page.is_some_and(is_of_size) {
        return Ok(());
    }
    let message = format!(
        "the drawing of {}×{} px is no base for a picture of {width}×{height} px: scale the picture",
        scene.width, scene.height
    );
    Err(Error::new(ErrorKind::Config, message))
}
