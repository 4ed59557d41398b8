//! What to draw and how to run, as the commands that draw share it.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::Result;
use clap::ValueEnum;
use strokefit::coverage::CoverageSchedule;
use strokefit::fit::{
    self, Background, Checkpoint, Config, Execution, Fit, Fitter, Observer, Simd,
};
use strokefit::image::Limits;

use super::pictures::FilmOptions;
use super::{colors, complain, domain, form};

/// The options of a command that draws.
#[derive(Debug, clap::Args)]
pub(super) struct Options {
    /// Write what happens as it happens, one JSON object a line: each stage, then the report; - for
    /// standard output
    #[arg(long, value_name = "E.jsonl")]
    pub(super) events: Option<PathBuf>,
    #[command(flatten)]
    pub(super) budget: Budget,
    #[command(flatten)]
    pub(super) look: Look,
    #[command(flatten)]
    pub(super) colors: colors::Args,
    #[command(flatten)]
    pub(super) form: form::Args,
    #[command(flatten)]
    pub(super) film: FilmOptions,
    /// Serve a page that shows the drawing as it grows, at an address that is printed. Afterwards the
    /// program ends with the page's button Done, with Ctrl-C, or when no page has been open for two minutes
    #[arg(long, help_heading = "Watching")]
    pub(super) view: bool,
    #[command(flatten)]
    pub(super) how: How,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Budget (the first one reached stops)")]
pub(super) struct Budget {
    /// At most N strokes
    #[arg(long, value_name = "N", value_parser = domain::strokes, allow_negative_numbers = true)]
    pub(super) strokes: Option<usize>,
    /// Until the file is this faithful, in dB of PSNR; 25 is rough, 30 fair, 35 good
    #[arg(long, value_name = "DB", value_parser = domain::psnr, allow_negative_numbers = true)]
    pub(super) psnr: Option<f64>,
    /// At most N bytes of SVG
    #[arg(long, value_name = "N", value_parser = domain::bytes, allow_negative_numbers = true)]
    pub(super) bytes: Option<usize>,
    /// At most this long
    #[arg(long, value_name = "SECONDS", value_parser = domain::seconds, allow_negative_numbers = true)]
    pub(super) time: Option<Duration>,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Look")]
pub(super) struct Look {
    /// What a byte is worth, 0 to 60: a stroke stays while each of its bytes removes as much error as
    /// one pixel has at Q dB [default: 30 without a budget of strokes, dB or bytes]
    #[arg(long, value_name = "Q", allow_negative_numbers = true)]
    quality: Option<f64>,
    /// How much work to spend
    #[arg(long, value_enum, default_value_t = Preset::Balanced)]
    preset: Preset,
    /// Polish each layer on those below alone: a good drawing after every layer, some dB less in the end
    #[arg(long, conflicts_with = "no_polish")]
    progressive: bool,
    /// Only opaque strokes: fewer dB, but flat colours that are easy to edit
    #[arg(long)]
    opaque: bool,
    /// Soft edge while fitting: smoothstep, sigmoid, tanh or atan[:K]; A>B passes from one to another
    #[arg(long, value_name = "EDGE", default_value = "smoothstep")]
    coverage: CoverageSchedule,
    /// Add the strokes in N stages, each a layer of the SVG [default: from the budget]
    #[arg(long, value_name = "N", value_parser = domain::stages, allow_negative_numbers = true)]
    stages: Option<usize>,
    /// Leave out the joint fit of all strokes after the stages: faster, some dB less
    #[arg(long)]
    no_polish: bool,
    /// Colour behind the strokes: auto, none or #rrggbb, on which transparency is laid. With auto a drawing is
    /// transparent where the picture is, but opaque strokes for translucent areas are laid on white
    #[arg(long, value_name = "COLOR", default_value = "auto", value_parser = domain::background)]
    background: Background,
    /// Key of every random draw: another seed, another drawing
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub(super) seed: u64,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Execution (never changes the result)")]
pub(super) struct How {
    /// Worker threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = domain::threads, allow_negative_numbers = true)]
    threads: Option<usize>,
    /// Instruction set: auto, avx512, avx2, sse4.2, sse2, neon or scalar
    #[arg(long, value_name = "LEVEL", default_value = "auto")]
    simd: Simd,
    /// Refuse pictures of more than N pixels
    #[arg(long, value_name = "N", value_parser = domain::pixels, allow_negative_numbers = true)]
    max_pixels: Option<u64>,
    /// Keep the state of the fit in FILE now and then: if the fit is cut off, the same command goes on from
    /// there; removed when the drawing is done
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// How often to keep it [default: 10]
    #[arg(long, value_name = "SECONDS", value_parser = domain::seconds, requires = "checkpoint", allow_negative_numbers = true)]
    checkpoint_every: Option<Duration>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Preset {
    /// Quick look
    Draft,
    /// The default
    Balanced,
    /// The last tenths of a dB
    Best,
}

impl Options {
    pub(super) fn config(&self) -> Config {
        let look = &self.look;
        Config {
            budget: self.budget.limits(),
            preset: look.preset.into(),
            quality: look.quality,
            progressive: look.progressive,
            opaque: look.opaque,
            coverage: look.coverage,
            stages: look.stages,
            polish: !look.no_polish,
            colors: self.colors.colors(),
            file: self.form.options(),
            background: look.background,
            seed: look.seed,
            ..Config::default()
        }
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

    /// Draws with a fitter that is set up, keeping its state where that is asked for.
    pub(super) fn fit(
        &self,
        observer: &mut (dyn Observer + Send),
        draw: impl FnOnce(Fitter<'_>) -> strokefit::Result<Fit>,
    ) -> Result<Fit> {
        let fitter = Fitter::new(self.config())
            .execution(self.execution())
            .observer(observer);
        let Some(mut checkpoint) = self.checkpoint() else {
            return Ok(draw(fitter)?);
        };
        let fit = draw(fitter.checkpoint(&mut checkpoint));
        if let Some(trouble) = checkpoint.trouble() {
            complain(format_args!("warning: {trouble}"));
        }
        Ok(fit?)
    }

    pub(super) fn execution(&self) -> Execution {
        Execution {
            threads: self.how.threads,
            simd: self.how.simd,
        }
    }
}

impl Budget {
    fn limits(&self) -> fit::Budget {
        fit::Budget {
            strokes: self.strokes,
            psnr_db: self.psnr,
            bytes: self.bytes,
            time: self.time,
        }
    }
}

impl From<Preset> for fit::Preset {
    fn from(preset: Preset) -> Self {
        match preset {
            Preset::Draft => Self::Draft,
            Preset::Balanced => Self::Balanced,
            Preset::Best => Self::Best,
        }
    }
}
