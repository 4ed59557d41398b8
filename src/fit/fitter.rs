//! A fit, set up step by step.

use std::time::Instant;

use super::work::Work;
use super::{Base, Checkpoint, Config, Execution, Fit, Observer, draw};
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
    config: Config,
    execution: Execution,
    base: Option<Base>,
    observer: Option<&'a mut (dyn Observer + Send)>,
    checkpoint: Option<&'a mut Checkpoint>,
    since: Option<Instant>,
}

impl<'a> Fitter<'a> {
    /// A fitter of drawings as `config` wants them.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            execution: Execution::default(),
            base: None,
            observer: None,
            checkpoint: None,
            since: None,
        }
    }

    /// How to run.
    #[must_use]
    pub fn execution(self, execution: Execution) -> Self {
        Self { execution, ..self }
    }

    /// What to go on from. Budgets count the strokes that it brings and all its bytes; a base that meets
    /// one already stays as it is. It decides on the background.
    #[must_use]
    pub fn on(self, base: Base) -> Self {
        Self {
            base: Some(base),
            ..self
        }
    }

    /// Who is told of progress, and may stop the fit.
    #[must_use]
    pub fn observer(self, observer: &'a mut (dyn Observer + Send)) -> Self {
        Self {
            observer: Some(observer),
            ..self
        }
    }

    /// Where the state is kept, and found again when the same fit was cut off before. It changes nothing of
    /// the drawing.
    #[must_use]
    pub fn checkpoint(self, checkpoint: &'a mut Checkpoint) -> Self {
        Self {
            checkpoint: Some(checkpoint),
            ..self
        }
    }

    /// When the time began that the budget allows; when the fit begins unless set.
    #[must_use]
    pub fn since(self, start: Instant) -> Self {
        Self {
            since: Some(start),
            ..self
        }
    }

    /// Draws `picture`.
    ///
    /// Where the picture has alpha the drawing is transparent, unless there is a background colour for it
    /// to lie on.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when an option is outside its domain, the base is of another size than the
    /// picture or on a background that the palette lacks, or the checkpoint of another fit;
    /// [`ErrorKind::Svg`] when the base cannot be rendered; [`ErrorKind::Io`] when the checkpoint is damaged
    /// or its place cannot be written.
    pub fn fit(self, picture: &Image) -> Result<Fit> {
        let Self {
            mut config,
            execution,
            base,
            observer,
            checkpoint,
            since,
        } = self;
        let since = since.unwrap_or_else(Instant::now);
        config.check()?;
        config.background = config.background.for_strokes(config.opaque, picture);
        if let Some(base) = &base {
            check_size(&base.scene, picture)?;
            // That of a document stays with it.
            if let (None, Some(ground)) = (&base.document, base.scene.background) {
                config.check_ground(ground, ", since the base stays on it")?;
            }
        }
        let level = execution.simd.require()?;
        let mut nobody = ();
        let observer = observer.unwrap_or(&mut nobody);
        execution.pool()?.install(|| {
            let mut work = Work::new(picture, &config, base.as_ref(), level, observer, since)?;
            if let Some(checkpoint) = checkpoint {
                work.resume(checkpoint)?;
            }
            draw(work)
        })
    }
}

fn check_size(scene: &Scene, picture: &Image) -> Result<()> {
    let (width, height) = (picture.width(), picture.height());
    if (scene.width as usize, scene.height as usize) == (width, height) {
        return Ok(());
    }
    let message = format!(
        "the drawing of {}×{} px is no base for a picture of {width}×{height} px: scale the picture",
        scene.width, scene.height
    );
    Err(Error::new(ErrorKind::Config, message))
}
