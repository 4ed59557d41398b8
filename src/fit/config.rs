//! The choices of a drawing ([`Config`]) and of its run ([`Execution`]). A run never changes a byte of the drawing.

use std::collections::BTreeSet;
use std::time::Duration;

use super::recipe::{Preset, Recipe, SCREEN_PIXELS};
use super::simd::Simd;
use super::widths::Widths;
use crate::coverage::CoverageSchedule;
use crate::error::{Error, ErrorKind, Result};
use crate::math;
use crate::scene::{MAX_POINTS, MAX_PRECISION, Mark, Marks, Rgb, Scene, Shade, quantum};
use crate::svg::{Form, Order, WriteOptions};
use crate::threads::Workers;

/// Configuration of a fit. Equal configurations of equal pictures give equal bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// When to stop adding strokes.
    pub budget: Budget,
    /// Sets the price of a stroke: each of its bytes has to remove as much squared error as one pixel has at this many
    /// dB. If it is `None`, a budget of strokes, fidelity or bytes makes strokes free, so that every stroke that
    /// removes error stays; without such a budget [`quality_for`](Self::quality_for) the picture's size applies.
    pub quality: Option<f64>,
    /// Work to spend.
    pub preset: Preset,
    /// True if each layer is polished on its own, so that the drawing looks finished after each.
    pub progressive: bool,
    /// The kinds of marks of the drawing.
    pub marks: Marks,
    /// True if damage of the picture, such as noise, is drawn as it is.
    pub literal: bool,
    /// Which errors count; `None` for [`ErrorWeighting::Exact`] where a fidelity is asked for, which is about exact errors, and for
    /// [`ErrorWeighting::Eye`] elsewhere.
    pub look: Option<ErrorWeighting>,
    /// True if all strokes have opacity 1.
    pub opaque: bool,
    /// The coverage function, or two: one while the edge is soft, and one for the final edge.
    pub coverage: CoverageSchedule,
    /// Most points of a stroke, at least 2, which makes all strokes capsules; `None` for as many as pay.
    pub points: Option<usize>,
    /// The number of stages; `None` lets the preset and the budget decide.
    pub stages: Option<usize>,
    /// True if strokes are polished after the stages.
    pub polish: bool,
    /// The colours that the drawing may have.
    pub colors: Colors,
    /// The widths that strokes may have; any if `None`.
    pub pens: Option<Widths>,
    /// True if a plotter or a cutter reads the file, and no path may run off the page. So it is, too, if there are
    /// pens or a length of the page, or the file is of outlines or in an order of little travel.
    pub confined: bool,
    /// True if pens fill areas by hatching, so that a drawing for pens may have areas.
    pub hatched: bool,
    /// Options of the file. The fit takes its bytes and its render into account.
    pub file: WriteOptions,
    /// The colour behind all strokes.
    pub background: Background,
    /// Key of all random draws.
    pub seed: u64,
    /// The tuned numbers; [`Recipe::of`] the preset if `None`.
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
pub enum ErrorWeighting {
    /// Errors that people see: fewer seams where the picture is smooth, for a tenth of a dB.
    Eye,
    /// All errors alike, which gives the most dB.
    Exact,
}

/// Bounds on the drawing; the first one reached stops.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Budget {
    /// At most this many strokes.
    pub strokes: Option<usize>,
    /// Stop at this fidelity, dB.
    pub psnr_db: Option<f64>,
    /// At most this many bytes of SVG.
    pub bytes: Option<usize>,
    /// At most this much wall time.
    pub time: Option<Duration>,
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
    /// No background. A drawing of a picture without alpha is fitted on white.
    None,
    /// This colour.
    Color(Rgb),
}

/// Settings of a run. They never change the drawing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Execution {
    /// Worker threads; one per core if `None`.
    pub threads: Option<usize>,
    /// The instruction set of the renderer.
    pub simd: Simd,
}

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
        let Budget {
            strokes,
            psnr_db,
            bytes,
            ..
        } = self.budget;
        let is_free = strokes.is_none() && psnr_db.is_none() && bytes.is_none();
        let is_polished = self.polish && !self.progressive;
        is_free && is_polished && !matches!(self.colors, Colors::Palette(_))
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
        let Budget {
            strokes,
            psnr_db,
            bytes,
            ..
        } = self.budget;
        let bounded = strokes.is_some() || psnr_db.is_some() || bytes.is_some();
        self.quality.is_none() && !bounded
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

    /// Refuses options that are outside their domains.
    pub(super) fn check(&self) -> Result<()> {
        let refuse = |message: String| Err(Error::new(ErrorKind::Config, message));
        let Budget { psnr_db, time, .. } = self.budget;
        if psnr_db.is_some_and(|db| !db.is_finite() || db <= 0.0) {
            return refuse(format!(
                "a fidelity of {} dB cannot be asked for: give one above 0",
                psnr_db.unwrap_or(0.0)
            ));
        }
        if let Some(quality) = self.quality.filter(|q| !(0.0..=MAX_QUALITY).contains(q)) {
            return refuse(format!(
                "a quality of {quality} is out of range: give 0 to {MAX_QUALITY}"
            ));
        }
        if time.is_some_and(|time| time.is_zero()) {
            return refuse("a time of 0 s leaves none to fit in: give more".into());
        }
        if self.marks == Marks::Areas && self.pens_draw_lines() {
            return refuse(
                "pens draw strokes, not areas: leave out pens, or ask for marks of strokes".into(),
            );
        }
        self.check_colors()?;
        self.recipe().check()?;
        if self.stages == Some(0) {
            return refuse("0 stages add no stroke: give 1 or more".into());
        }
        if let Some(points) = self.points.filter(|n| !(2..=MAX_POINTS).contains(n)) {
            return refuse(format!(
                "{points} points of a stroke are out of range: give 2 to {MAX_POINTS}"
            ));
        }
        if self.file.precision > MAX_PRECISION {
            return refuse(format!(
                "a precision of {} decimals is out of range: give 0 to {MAX_PRECISION}",
                self.file.precision
            ));
        }
        Ok(())
    }

    fn check_colors(&self) -> Result<()> {
        let refuse = |message: String| Err(Error::new(ErrorKind::Config, message));
        let Colors::Palette(palette) = &self.colors else {
            return match self.colors {
                Colors::AtMost(0) => refuse("0 colours draw nothing: give 1 or more".into()),
                _ => Ok(()),
            };
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
                Err(Error::new(ErrorKind::Config, message))
            }
            _ => Ok(()),
        }
    }
}

impl Execution {
    /// The worker threads.
    #[doc(hidden)]
    pub fn pool(&self) -> Result<Workers> {
        Workers::new(self.threads.unwrap_or(0))
    }

    /// Runs `work`, such as the judging of a drawing, with these worker threads. Without this, it takes the threads
    /// of the whole process, which a process that was forked does not have.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when the system does not start so many threads.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> Result<R> {
        Ok(self.pool()?.install(work))
    }
}
