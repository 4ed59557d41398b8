//! A fit, set up step by step.

use super::{Config, Execution, Fit, Observer, draw};
use crate::error::Result;
use crate::image::Image;

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
    observer: Option<&'a mut (dyn Observer + Send)>,
}

impl<'a> Fitter<'a> {
    /// A fitter of drawings as `config` wants them.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            execution: Execution::default(),
            observer: None,
        }
    }

    /// How to run.
    #[must_use]
    pub fn execution(self, execution: Execution) -> Self {
        Self { execution, ..self }
    }

    /// Who is told of progress, and may stop the fit.
    #[must_use]
    pub fn observer(self, observer: &'a mut (dyn Observer + Send)) -> Self {
        Self {
            observer: Some(observer),
            ..self
        }
    }

    /// Draws `picture`.
    ///
    /// Where the picture has alpha it is laid on the background colour of the configuration, or on white.
    ///
    /// # Errors
    /// [`ErrorKind::Config`](crate::ErrorKind::Config) when an option is outside its domain.
    pub fn fit(self, picture: &Image) -> Result<Fit> {
        let Self {
            config,
            execution,
            observer,
        } = self;
        config.check()?;
        let level = execution.simd.require()?;
        let target = picture.flattened(config.background.ground());
        let mut nobody = ();
        let observer = observer.unwrap_or(&mut nobody);
        execution
            .pool()?
            .install(|| draw(target, &config, level, observer))
    }
}
