//! Options for what to draw and how to run, shared by the commands that draw.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Result;
use clap::builder::TypedValueParser;
use strokefit::coverage::CoverageSchedule;
use strokefit::fit::{
    self, Background, Checkpoint, Colors, Config, Execution, Fit, Fitter, Focus, Observer, Preset,
    Simd, Widths,
};
use strokefit::image::{Image, Limits};
use strokefit::svg::WriteOptions;

use super::domain::StrokeLimit;
use super::interrupt::GRACE;
use super::pictures::FilmOptions;
use super::{colors, complain, domain, form, input, words};

/// Weight of an error where the mask of `--focus` is black. Without any, ends of strokes are left there as they come: a cat
/// of 400 strokes has 32.7 dB inside and 15.3 outside, with this weight 32.8 and 25.2, with 0.02 32.2 and 28.0.
const FLOOR: f32 = 0.002;

/// The options of a command that draws.
#[derive(Debug, clap::Args)]
pub(super) struct Options {
    /// Stream events as JSON, one object per line: each stage as it ends, then the report. - means
    /// standard output
    #[arg(long, value_name = "E.jsonl")]
    pub(super) events: Option<PathBuf>,
    #[command(flatten)]
    pub(super) budget: Budget,
    #[command(flatten)]
    pub(super) look: StyleArgs,
    #[command(flatten)]
    pub(super) colors: colors::Args,
    #[command(flatten)]
    pub(super) form: form::Args,
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
#[command(next_help_heading = "Budget (the first one reached stops)")]
pub(super) struct Budget {
    /// At most N strokes. With refine, +N counts those beyond the strokes that BASE brings
    #[arg(long, value_name = "N", value_parser = domain::stroke_limit, allow_negative_numbers = true)]
    pub(super) strokes: Option<StrokeLimit>,
    /// Stop when the file reaches DB decibels of PSNR: 25 is rough, 30 fair, 35 good
    #[arg(long, value_name = "DB", value_parser = domain::psnr, allow_negative_numbers = true)]
    pub(super) psnr: Option<f64>,
    /// At most N bytes of SVG; 20kB, 1.5MB and 64KiB are understood
    #[arg(long, value_name = "N", value_parser = domain::bytes, allow_negative_numbers = true)]
    pub(super) bytes: Option<usize>,
    /// At most this many seconds, from reading the picture to writing the SVG
    #[arg(long, value_name = "SECONDS", value_parser = domain::seconds, allow_negative_numbers = true)]
    pub(super) time: Option<Duration>,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Look")]
pub(super) struct StyleArgs {
    /// Price of a byte, 0 to 60: a stroke stays if each of its bytes removes at least as much squared error
    /// as one pixel has at Q dB [default: 30, less for pictures over 768×512, unless --strokes, --psnr or
    /// --bytes is given]
    #[arg(long, value_name = "Q", allow_negative_numbers = true)]
    quality: Option<f64>,
    /// How much time to spend for a better drawing
    #[arg(long, default_value_t, value_parser = preset())]
    preset: Preset,
    /// Fit each layer for the layers below it only. The drawing is good after every layer, and some dB worse
    /// in the end
    #[arg(long, conflicts_with = "no_polish")]
    progressive: bool,
    /// Use opaque strokes only. They are easier to edit and cost some dB
    #[arg(long)]
    opaque: bool,
    /// Which errors count: eye (those that people see, so that smooth places have fewer seams) or exact (all alike, for a
    /// tenth of a dB more) [default: eye, but exact with --psnr]
    #[arg(long, value_name = "LOOK")]
    look: Option<fit::ErrorWeighting>,
    /// Only these widths of strokes: lengths such as 0.3mm,0.8mm on a page of a --width, or numbers in px of the picture
    #[arg(long, value_name = "WIDTHS", allow_hyphen_values = true)]
    pens: Option<Widths>,
    /// Coverage function of soft edges: smoothstep, sigmoid, tanh or atan[:K]; A>B changes from A to B during
    /// the fit. Here tanh draws the same as sigmoid, and atan:K the same as atan for any K, because a fit
    /// gives all edges the same slope
    #[arg(long, value_name = "EDGE", default_value = "smoothstep")]
    coverage: CoverageSchedule,
    /// Most points of a stroke, 2 or more. 2 draws line segments alone [default: as many as pay]
    #[arg(long, value_name = "N", value_parser = domain::points, allow_negative_numbers = true)]
    points: Option<usize>,
    /// Number of stages, each a layer of the SVG [default: chosen from the budget]
    #[arg(long, value_name = "N", value_parser = domain::stages, allow_negative_numbers = true)]
    stages: Option<usize>,
    /// Skip the joint fit of all strokes after the stages. The fit is faster and some dB worse
    #[arg(long)]
    no_polish: bool,
    /// Background colour: auto, none, #rrggbb or a name such as white. auto keeps transparency; with --opaque it flattens a picture
    /// with translucent areas onto white. A colour is what the picture is flattened onto
    #[arg(long, value_name = "COLOR", default_value_t)]
    background: Background,
    /// Grey picture of the input's size that says how much an error counts where: white 1, black 0.002. Strokes go where
    /// people look, a face before a wall
    #[arg(long, value_name = "MASK.png")]
    focus: Option<PathBuf>,
    /// Seed of all random choices. Another seed gives a slightly different drawing
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
    /// Refuse pictures with more than N pixels
    #[arg(long, value_name = "N", value_parser = domain::pixels, allow_negative_numbers = true)]
    max_pixels: Option<u64>,
    /// Save the state of the fit to FILE at intervals. If the fit is cut off, the same command resumes from
    /// FILE. The file is removed when the drawing is done
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Seconds between two checkpoints [default: 10]
    #[arg(long, value_name = "SECONDS", value_parser = domain::seconds, requires = "checkpoint", allow_negative_numbers = true)]
    checkpoint_every: Option<Duration>,
}

/// The presets, with their help.
fn preset() -> impl TypedValueParser<Value = Preset> {
    words::one_of([
        (Preset::Draft, "An eighth of the time, 2 to 3 dB worse"),
        (Preset::Balanced, "The default"),
        (
            Preset::Best,
            "Three to five times the time, 0.7 to 0.9 dB better",
        ),
    ])
}

impl Options {
    /// The configuration of a drawing that begins from nothing.
    pub(super) fn config(&self) -> Config {
        self.config_beyond(0)
    }

    /// The configuration of a drawing whose base brings `before` strokes.
    pub(super) fn config_beyond(&self, before: usize) -> Config {
        let look = &self.look;
        Config {
            budget: self.budget.limits(before),
            preset: look.preset,
            quality: look.quality,
            progressive: look.progressive,
            look: look.look,
            opaque: look.opaque,
            coverage: look.coverage,
            points: look.points,
            stages: look.stages,
            polish: !look.no_polish,
            colors: self.colors.colors(),
            pens: look.pens.clone(),
            file: self.form.options(),
            background: look.background,
            seed: look.seed,
            ..Config::default()
        }
    }

    /// The options that keep a drawing from being more faithful.
    pub(super) fn limiting_looks(&self) -> Vec<&'static str> {
        let (look, config) = (&self.look, self.config());
        let options = [
            ("--colors or --palette", config.colors != Colors::Free),
            ("--pens", look.pens.is_some()),
            ("--opaque", look.opaque),
            ("--quality", look.quality.is_some()),
            ("--progressive", look.progressive),
            ("--no-polish", look.no_polish),
            ("--points 2", look.points == Some(2)),
            ("--preset draft", look.preset == Preset::Draft),
            (
                "--precision",
                config.file.precision < WriteOptions::default().precision,
            ),
        ];
        let given = options.into_iter().filter(|(_, given)| *given);
        given.map(|(name, _)| name).collect()
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
        let fitter = match &self.look.focus {
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
        let within = |error: strokefit::Error| error.within(input::name(path));
        // Refuses a mask that is black everywhere.
        Focus::new(&mask).map_err(within)?;
        Ok(Focus::new(&lifted(mask)?).map_err(within)?)
    }

    pub(super) fn execution(&self) -> Execution {
        Execution {
            threads: self.how.threads,
            simd: self.how.simd,
        }
    }
}

/// The mask with its black lifted to the floor.
fn lifted(mask: Image) -> Result<Image> {
    let mask = mask.flattened([0.0; 3]);
    let (width, height) = (mask.width(), mask.height());
    let lift = |plane: Vec<f32>| {
        plane
            .into_iter()
            .map(|v| FLOOR + (1.0 - FLOOR) * v)
            .collect()
    };
    Ok(Image::new(width, height, mask.into_planes().map(lift))?)
}

impl Budget {
    fn limits(&self, before: usize) -> fit::Budget {
        fit::Budget {
            strokes: self.strokes.map(|limit| limit.total(before)),
            psnr_db: self.psnr,
            bytes: self.bytes,
            time: self.time,
        }
    }
}
