//! The choices of a drawing ([`Config`]) and of its run ([`Execution`]). A run never changes a byte of the drawing.

use std::collections::BTreeSet;
use std::time::Duration;

use serde::Deserialize;

use super::domain::{self, SECONDS, allowed, within};
use super::recipe::{Preset, Recipe};
use super::simd::Simd;
use super::widths::Widths;
use crate::coverage::CoverageSchedule;
use crate::error::{Error, Result};
use crate::math;
use crate::restore::Paper;
use crate::scene::{Blurs, MAX_POINTS, MAX_PRECISION, Mark, Marks, Rgb, Scene, Shade, quantum};
use crate::svg::{Form, Order, WriteOptions};
use crate::threads::Workers;

/// Configuration of a fit. Equal configurations of equal pictures give equal bytes.
///
/// The documentation of a field is also the help of the program's option.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default)]
#[cfg_attr(
    feature = "cli",
    derive(clap::Args),
    command(next_help_heading = "Look")
)]
pub struct Config {
    /// When to stop adding strokes. The program's help has it under a heading of its own.
    #[serde(flatten)]
    #[cfg_attr(feature = "cli", arg(skip))]
    pub budget: Budget,
    /// Quality, 0 to 60; higher keeps more. A stroke is kept while every byte it costs removes at least the squared error
    /// that one pixel has at Q dB (default: 30, less for pictures over 768×512, and more where the drawing looks too little like the picture, unless --strokes, --psnr or --bytes is given)
    #[cfg_attr(feature = "cli", arg(long, value_name = "Q"))]
    pub quality: Option<f64>,
    /// How much time to spend for a better drawing
    #[cfg_attr(feature = "cli", arg(long, default_value_t))]
    pub preset: Preset,
    /// What the drawing is made of
    #[cfg_attr(feature = "cli", arg(long, default_value_t))]
    pub marks: Marks,
    /// Fit each layer for the layers below it only. The drawing is good after every layer, and some dB worse in the end
    #[cfg_attr(feature = "cli", arg(long, conflicts_with = "no-polish"))]
    pub progressive: bool,
    /// Draw noise, traces of JPEG and other damage of the picture as they are
    #[cfg_attr(feature = "cli", arg(long))]
    pub literal: bool,
    /// What becomes of the paper of a page that was scanned or photographed
    #[cfg_attr(feature = "cli", arg(long, default_value_t))]
    pub paper: Paper,
    /// What soft shadows are drawn with
    #[cfg_attr(feature = "cli", arg(long, default_value_t))]
    pub blurs: Blurs,
    /// Which errors count (default: eye, but exact with --psnr)
    #[cfg_attr(feature = "cli", arg(long))]
    pub look: Option<ErrorWeighting>,
    /// Use opaque strokes only. They are easier to edit and cost some dB
    #[cfg_attr(feature = "cli", arg(long))]
    pub opaque: bool,
    /// Coverage function of soft edges: smoothstep, sigmoid, tanh, atan or atan:K; A>B changes from A to B during the fit. Here
    /// tanh draws the same as sigmoid, and atan:K the same as atan for any K, because a fit gives all edges the same slope
    #[cfg_attr(feature = "cli", arg(long, value_name = "EDGE", default_value_t))]
    pub coverage: CoverageSchedule,
    /// Most points of a stroke, 2 or more. 2 draws line segments alone (default: as many as pay)
    #[cfg_attr(feature = "cli", arg(long, value_name = "N"))]
    pub points: Option<usize>,
    /// Number of stages, each a layer of the SVG (default: chosen from the budget)
    #[cfg_attr(feature = "cli", arg(long, value_name = "N"))]
    pub stages: Option<usize>,
    /// True if all strokes are fitted jointly after the stages.
    #[cfg_attr(feature = "cli", arg(id = "no-polish", long, action = clap::ArgAction::SetFalse, help =
        "Skip the joint fit of all strokes after the stages. The fit is faster and some dB worse"))]
    pub polish: bool,
    /// The colours that the drawing may have. On the command line two options choose them.
    #[serde(alias = "palette")]
    #[cfg_attr(feature = "cli", arg(skip))]
    pub colors: Colors,
    /// Only these widths of strokes: lengths such as 0.3mm,0.8mm on a page of a --width, or numbers in px of the picture
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "WIDTHS", allow_hyphen_values = true)
    )]
    pub pens: Option<Widths>,
    /// True if a plotter or a cutter reads the file, and no path may run off the page. So it is, too, if there are
    /// pens or a length of the page, or the file is of outlines or in an order of little travel.
    #[serde(skip)]
    #[cfg_attr(feature = "cli", arg(skip))]
    pub confined: bool,
    /// True if pens fill areas by hatching, so that a drawing for pens may have areas.
    #[serde(skip)]
    #[cfg_attr(feature = "cli", arg(skip))]
    pub hatched: bool,
    /// Background colour: auto, none, #rrggbb or a name such as white. auto keeps transparency; with --opaque it flattens a
    /// picture with translucent areas onto white. A colour is what the picture is flattened onto
    #[cfg_attr(feature = "cli", arg(long, value_name = "COLOR", default_value_t))]
    pub background: Background,
    /// Seed of all random choices. Another seed gives a slightly different drawing
    #[cfg_attr(feature = "cli", arg(long, value_name = "S", default_value_t))]
    pub seed: u64,
    /// Options of the file. The fit takes its bytes and its render into account.
    #[serde(flatten)]
    #[cfg_attr(feature = "cli", command(flatten))]
    pub file: WriteOptions,
    /// Numbers other than those of the preset, for tests.
    #[doc(hidden)]
    #[serde(skip)]
    #[cfg_attr(feature = "cli", arg(skip))]
    pub recipe: Option<Recipe>,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            budget: Budget::default(),
            quality: None,
            preset: Preset::default(),
            progressive: false,
            marks: Marks::default(),
            literal: false,
            paper: Paper::default(),
            blurs: Blurs::default(),
            look: None,
            opaque: false,
            coverage: CoverageSchedule::default(),
            points: None,
            stages: None,
            polish: true,
            colors: Colors::default(),
            pens: None,
            confined: false,
            hatched: false,
            file: WriteOptions::default(),
            background: Background::Auto,
            seed: 0,
            recipe: None,
        }
    }
}

/// Which errors count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum ErrorWeighting {
    /// Those that people see, so that smooth places have fewer seams
    Eye,
    /// All alike, for a tenth of a dB more
    Exact,
}

/// Bounds on the drawing; the first one reached stops.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[cfg_attr(
    feature = "cli",
    command(next_help_heading = "Budget (the first one reached stops)")
)]
pub struct Budget {
    /// At most N strokes. With refine, +N counts those beyond the strokes that BASE brings
    #[cfg_attr(feature = "cli", arg(long, value_name = "N"))]
    pub strokes: Option<usize>,
    /// Stop when the file reaches DB decibels of PSNR: 25 is rough, 30 fair, 35 good
    #[serde(rename = "psnr")]
    #[cfg_attr(feature = "cli", arg(long = "psnr", value_name = "DB"))]
    pub psnr_db: Option<f64>,
    /// At most N bytes of SVG; 20kB, 1.5MB and 64KiB are understood
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", value_parser = domain::bytes))]
    pub bytes: Option<usize>,
    /// At most this many seconds, from reading the picture to writing the SVG
    #[serde(deserialize_with = "domain::time")]
    #[cfg_attr(feature = "cli", arg(long, value_name = "SECONDS", value_parser = domain::seconds))]
    pub time: Option<Duration>,
}

impl Budget {
    /// True if it bounds neither strokes nor fidelity nor bytes.
    pub(super) fn is_open(&self) -> bool {
        self.strokes.is_none() && self.psnr_db.is_none() && self.bytes.is_none()
    }
}

/// The colours that a drawing may have, its background included.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Colors {
    /// Any colours.
    #[default]
    Free,
    /// At most this many colours, chosen from the picture.
    AtMost(usize),
    /// These 8-bit colours.
    Palette(Vec<[u8; 3]>),
}

impl Colors {
    /// True if all colours of `scene` are allowed.
    pub(super) fn allow(&self, scene: &Scene) -> bool {
        let colors = scene.marks().map(Mark::color);
        let used: BTreeSet<_> = colors
            .chain(scene.background)
            .map(|c| c.map(quantum))
            .collect();
        // A gradient has many colours.
        let is_plain = scene.marks().all(|mark| mark.shade().is_none());
        match self {
            Self::Free => true,
            _ if !is_plain => false,
            Self::AtMost(most) => used.len() <= *most,
            Self::Palette(palette) => used.iter().all(|color| palette.contains(color)),
        }
    }
}

/// The colour behind all strokes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Background {
    /// Chosen from the picture; a picture with alpha gets none.
    #[default]
    Auto,
    /// No background. The paper of a picture without alpha is not drawn, whatever its colour; one without paper is fitted on white.
    None,
    /// This colour.
    Color(Rgb),
}

/// Settings of a run. They never change the drawing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Execution {
    /// Worker threads (default: all cores)
    #[cfg_attr(feature = "cli", arg(long, value_name = "N"))]
    pub threads: Option<usize>,
    /// Instruction set: auto, avx512, avx2, sse4.2, sse2 or neon
    #[cfg_attr(feature = "cli", arg(long, value_name = "LEVEL", default_value_t))]
    pub simd: Simd,
}

/// Pixels of a picture that a screen shows well at once, 768×512: the default quality is for so many.
pub const SCREEN_PIXELS: usize = 768 * 512;

/// The quality of a drawing without a budget, dB, unless the picture is large.
pub const DEFAULT_QUALITY: f64 = 30.0;

/// Most strokes of a drawing for which neither a quality nor a budget is set: nobody edits more.
pub const DEFAULT_STROKES: usize = 5000;

/// Most strokes of a drawing: resvg reads at most a million elements.
pub const MAX_STROKES: usize = 900_000;

/// Fewest pixels for each stroke, unless a number of strokes is asked for: more strokes draw noise.
pub const PIXELS_PER_STROKE: usize = 16;

/// Strokes that any picture may have, however small it is.
const MIN_STROKES: usize = 100;

/// Most worker threads: more than any machine has cores only waste memory.
pub const MAX_THREADS: usize = 1024;

/// Beyond this quality, dB, a stroke may cost less than one 8-bit level of one pixel.
const MAX_QUALITY: f64 = 60.0;

impl Config {
    /// The recipe to fit by.
    pub(super) fn recipe(&self) -> Recipe {
        self.recipe.unwrap_or(Recipe::of(self.preset))
    }

    /// Which errors count.
    pub(super) fn look(&self) -> ErrorWeighting {
        let usual = match self.budget.psnr_db {
            Some(_) => ErrorWeighting::Exact,
            None => ErrorWeighting::Eye,
        };
        self.look.unwrap_or(usual)
    }

    /// The kinds of marks that the drawing may have. Pens draw no areas, and a limit on bytes is met by strokes alone: areas
    /// are hard to shorten.
    pub(super) fn marks(&self) -> Marks {
        match self.marks {
            Marks::Auto if self.pens_draw_lines() || self.budget.bytes.is_some() => Marks::Strokes,
            marks => marks,
        }
    }

    /// True if there are pens, and nothing is filled with them.
    pub(super) fn pens_draw_lines(&self) -> bool {
        self.pens.is_some() && !self.hatched
    }

    /// True if no path may run off the page.
    pub(super) fn is_confined(&self) -> bool {
        let WriteOptions {
            form, order, width, ..
        } = self.file;
        self.confined
            || self.pens.is_some()
            || width.is_some()
            || form == Form::Outlines
            || order == Order::Travel
    }

    /// True if small things that get lost are traced again. A limit leaves room for what gains most, a fidelity asks for all alike, and
    /// a palette draws what it can.
    pub(super) fn recovers(&self) -> bool {
        let is_polished = self.polish && !self.progressive;
        self.budget.is_open() && is_polished && !matches!(self.colors, Colors::Palette(_))
    }

    /// True if strokes may have more than two points.
    pub(super) fn allows_points(&self) -> bool {
        self.points.is_none_or(|most| most > 2)
    }

    /// True if a mark is as opaque, and a stroke has as few points, as all have to be.
    pub(super) fn allows(&self, mark: &Mark) -> bool {
        let points = mark
            .as_stroke()
            .map_or(0, |stroke| stroke.path.points().len());
        let is_opaque = mark.opacity() >= 1.0 && mark.shade().is_none_or(Shade::is_opaque);
        self.points.is_none_or(|most| points <= most) && (!self.opaque || is_opaque)
    }

    /// The quality that sets the price of a stroke in a drawing of `pixels` pixels, unless strokes are free.
    ///
    /// The default one is for a picture as it is seen on a screen: of a picture with more than [`SCREEN_PIXELS`], those
    /// that a screen would show as one count as one, so that a picture of twice the size gets about as many strokes.
    pub fn quality_for(&self, pixels: usize) -> Option<f64> {
        let shrinks_by = (pixels as f64 / SCREEN_PIXELS as f64).max(1.0);
        let seen = DEFAULT_QUALITY - 10.0 * math::ln(shrinks_by) / std::f64::consts::LN_10;
        self.quality.or(self.is_open().then_some(seen.max(0.0)))
    }

    /// True if neither a quality nor a budget says how many strokes a drawing may have. It then has at most
    /// [`DEFAULT_STROKES`].
    pub fn is_open(&self) -> bool {
        self.quality.is_none() && self.budget.is_open()
    }

    /// Most strokes that a drawing of `pixels` pixels may have, whatever its budget.
    pub(super) fn most_strokes(&self, pixels: usize) -> usize {
        let most = if self.is_open() {
            DEFAULT_STROKES
        } else {
            MAX_STROKES
        };
        // Whoever names a number of strokes shall have it.
        match self.budget.strokes {
            Some(_) => most,
            None => most.min((pixels / PIXELS_PER_STROKE).max(MIN_STROKES)),
        }
    }

    /// Refuses options that are out of their ranges, or do not go together.
    pub(super) fn check(&self) -> Result<()> {
        self.check_ranges()?;
        if self.marks == Marks::Areas && self.pens_draw_lines() {
            let message =
                "pens draw strokes, not areas: leave out pens, or ask for marks of strokes";
            return Err(Error::config(message));
        }
        self.check_colors()
    }

    /// Refuses an option that is out of its range. The message begins with its name.
    #[doc(hidden)]
    pub fn check_ranges(&self) -> Result<()> {
        let Budget {
            strokes,
            psnr_db,
            bytes,
            time,
        } = self.budget;
        within("strokes", strokes, 1..=MAX_STROKES)?;
        let decibels = "decibels from above 0 to 100, such as 32";
        allowed("psnr", psnr_db, decibels, |&db| db > 0.0 && db <= 100.0)?;
        allowed("bytes", bytes, "1 or more", |&bytes| bytes > 0)?;
        allowed("time", time.map(|t| t.as_secs_f64()), SECONDS, |&s| s > 0.0)?;
        let right = format!("a number from 0 to {MAX_QUALITY}");
        let quality = 0.0..=MAX_QUALITY;
        allowed("quality", self.quality, &right, |q| quality.contains(q))?;
        within("points", self.points, 2..=MAX_POINTS)?;
        within("stages", self.stages, 1..=MAX_STROKES)?;
        let most = match self.colors {
            Colors::AtMost(most) => Some(most),
            Colors::Free | Colors::Palette(_) => None,
        };
        within("colors", most, 1..=Colors::MAX)?;
        within("precision", Some(self.file.precision), 0..=MAX_PRECISION)
    }

    fn check_colors(&self) -> Result<()> {
        let refuse = |message: String| Err(Error::config(message));
        let Colors::Palette(palette) = &self.colors else {
            return Ok(());
        };
        if palette.is_empty() {
            return refuse("the palette has no colour: give one or more".into());
        }
        match self.background {
            Background::Color(color) => self.check_background(color, ", or have it chosen by auto"),
            _ => Ok(()),
        }
    }

    /// Refuses a background that the palette lacks. The message suggests to add it, and ends with `other_remedy`.
    pub(super) fn check_background(&self, color: Rgb, other_remedy: &str) -> Result<()> {
        let [r, g, b] = color.map(quantum);
        match &self.colors {
            Colors::Palette(palette) if !palette.contains(&[r, g, b]) => {
                let message = format!(
                    "the background #{r:02x}{g:02x}{b:02x} is not in the palette: add it{other_remedy}"
                );
                Err(Error::config(message))
            }
            _ => Ok(()),
        }
    }
}

impl Execution {
    /// Refuses a number of threads that is out of its range. The message begins with the option's name.
    #[doc(hidden)]
    pub fn check(&self) -> Result<()> {
        within("threads", self.threads, 1..=MAX_THREADS)
    }

    /// The worker threads.
    #[doc(hidden)]
    pub fn pool(&self) -> Result<Workers> {
        Workers::new(self.threads.unwrap_or(0))
    }

    /// Runs `work`, such as the judging of a drawing, with these worker threads. Without this, it takes the threads
    /// of the whole process, which a process that was forked does not have.
    ///
    /// # Errors
    /// [`ErrorKind::Config`](crate::ErrorKind::Config) when the system does not start so many threads.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> Result<R> {
        Ok(self.pool()?.install(work))
    }
}
