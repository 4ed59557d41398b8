//! One drawing, from the picture to the report.

use std::time::Instant;

use strokefit::fit::{self, Base, CancelToken, Fitter, Observer, Options};
use strokefit::report::{self, FitReport, Judged, Run, Usage};

use crate::failure::{Failure, expect_memory};
use crate::picture::Picture;

/// Picture to draw, and the options of the drawing.
pub(crate) struct Job {
    /// Start of the time budget.
    pub(crate) start: Instant,
    pub(crate) picture: Picture,
    pub(crate) base: Option<BaseText>,
    pub(crate) options: Options,
    pub(crate) token: CancelToken,
}

/// The SVG to go on from.
pub(crate) struct BaseText {
    pub(crate) text: String,
    pub(crate) name: String,
    /// True if its strokes stay as they are.
    pub(crate) kept: bool,
}

impl Job {
    /// The drawing, and its report as JSON.
    pub(crate) fn draw(
        self,
        observer: &mut (dyn Observer + Send),
    ) -> Result<(Judged, String), Failure> {
        let Options { config, execution } = self.options;
        let name = self.picture.name();
        let (picture, remarks) = self.picture.read()?;
        let bytes = fit::predicted_rss_bytes(&picture, &config);
        expect_memory(bytes, picture.width(), picture.height())?;
        let mut fitter = Fitter::new(config.clone())
            .execution(execution)
            .observer(observer)
            .cancelled_by(self.token)
            .since(self.start);
        let base_name = self.base.as_ref().map(|base| base.name.clone());
        if let Some(BaseText { text, name, kept }) = self.base {
            let base = Base::read(text, &picture, kept);
            fitter = fitter.on(base.map_err(|error| error.within(name))?);
        }
        let fit = fitter.fit(&picture)?;
        let judged = execution.install(|| Judged::new(fit))??;
        let run = Run {
            input: &name,
            base: base_name.as_deref(),
            config: &config,
            wall: self.start.elapsed(),
            // Usage of the process says little of one fit among others.
            usage: Usage::default(),
        };
        let mut report = FitReport::of(&judged, &run);
        report.input = report.input.remarking(&remarks);
        Ok((judged, report::json(&report)?))
    }
}
