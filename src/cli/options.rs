//! Options for what to draw and how to run, shared by the commands that draw.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Result;
use clap::value_parser;
use strokefit::fit::{
    self, Checkpoint, Colors, Config, Execution, Fit, Fitter, Focus, Observer, Preset,
};
use strokefit::image::Limits;
use strokefit::report::Judged;
use strokefit::svg::WriteOptions;

use super::drawing::Drawing;
use super::interrupt::GRACE;
use super::pictures::FilmOptions;
use super::product::Product;
use super::{complain, input};

/// The options of a command that draws.
#[derive(Debug, clap::Args)]
pub(super) struct Options {
    /// Stream events as JSON, one object per line: each stage as it ends, then the report. - means
    /// standard output
    #[arg(long, value_name = "E.jsonl")]
    pub(super) events: Option<PathBuf>,
    #[command(flatten)]
    drawing: Drawing,
    #[command(flatten)]
    pub(super) film: FilmOptions,
    /// Serve a live page that shows the drawing as it grows, and print its address. After the fit the
    /// program waits for the page's button Done, for Ctrl-C, or until no page has been open for two minutes
    #[arg(long, help_heading = "Watching")]
    pub(super) view: bool,
    #[command(flatten)]
    pub(super) how: How,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Execution (never changes the result)")]
pub(super) struct How {
    #[command(flatten)]
    execution: Execution,
    /// Refuse pictures with more than N pixels
    #[arg(long, value_name = "N", value_parser = value_parser!(u64).range(1..))]
    max_pixels: Option<u64>,
    /// Save the state of the fit to FILE at intervals. If the fit is cut off, the same command resumes from
    /// FILE. The file is removed when the drawing is done
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Seconds between two checkpoints [default: 10]
    #[arg(long, value_name = "SECONDS", value_parser = fit::seconds, requires = "checkpoint")]
    checkpoint_every: Option<Duration>,
}

impl Options {
    /// The configuration of a drawing that begins from nothing.
    pub(super) fn config(&self) -> Config {
        self.drawing.config()
    }

    /// Refuses an option that is out of its range.
    pub(super) fn check(&self) -> strokefit::Result<()> {
        self.config().check_ranges()?;
        self.how.execution.check()
    }

    /// The configuration of a drawing whose base brings `before` strokes.
    pub(super) fn config_beyond(&self, before: usize) -> Config {
        self.drawing.config_beyond(before)
    }

    /// The options that keep a drawing from being more faithful.
    pub(super) fn limiting_looks(&self) -> Vec<&'static str> {
        let config = self.config();
        let options = [
            ("--colors or --palette", config.colors != Colors::Free),
            ("--pens", config.pens.is_some()),
            ("--opaque", config.opaque),
            ("--quality", config.quality.is_some()),
            ("--progressive", config.progressive),
            ("--no-polish", !config.polish),
            ("--points 2", config.points == Some(2)),
            ("--preset draft", config.preset == Preset::Draft),
            (
                "--precision",
                config.file.precision < WriteOptions::default().precision,
            ),
        ];
        let given = options.into_iter().filter(|(_, given)| *given);
        given.map(|(name, _)| name).collect()
    }

    /// The drawing as its files hold it: cut out, hatched or outlined if that was asked for.
    pub(super) fn product<'a>(&self, judged: &'a Judged) -> Result<Product<'a>> {
        Product::of(judged, &self.drawing.made, self.config().pens.as_ref())
    }

    pub(super) fn limits(&self) -> Limits {
        let limits = Limits::default();
        Limits {
            max_pixels: self.how.max_pixels.unwrap_or(limits.max_pixels),
            ..limits
        }
    }

    pub(super) fn checkpoint(&self) -> Option<Checkpoint> {
        let How {
            checkpoint,
            checkpoint_every,
            ..
        } = &self.how;
        let kept = Checkpoint::new(checkpoint.as_ref()?);
        Some(match checkpoint_every {
            Some(span) => kept.every(*span),
            None => kept,
        })
    }

    /// Configures a fitter for a drawing whose base brings `before` strokes, with a checkpoint if one was asked for, and
    /// draws with it.
    pub(super) fn fit(
        &self,
        before: usize,
        observer: &mut (dyn Observer + Send),
        draw: impl FnOnce(Fitter<'_>) -> strokefit::Result<Fit>,
    ) -> Result<Fit> {
        let fitter = Fitter::new(self.config_beyond(before))
            .execution(self.execution())
            .grace(GRACE)
            .observer(observer);
        let fitter = match &self.drawing.focus {
            Some(mask) => fitter.focus(self.focus(mask)?),
            None => fitter,
        };
        let Some(mut checkpoint) = self.checkpoint() else {
            return Ok(draw(fitter)?);
        };
        let fit = draw(fitter.checkpoint(&mut checkpoint));
        if let Some(trouble) = checkpoint.trouble() {
            complain(format_args!("warning: {trouble}"));
        }
        Ok(fit?)
    }

    /// Reads the mask.
    fn focus(&self, path: &Path) -> Result<Focus> {
        let (mask, _) = input::picture_within(path, self.limits())?;
        Ok(Focus::lifted(&mask).map_err(|error| error.within(input::name(path)))?)
    }

    pub(super) fn execution(&self) -> Execution {
        self.how.execution
    }
}
