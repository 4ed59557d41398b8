//! *What* to fit ([`Config`]) and *how* to run ([`Execution`]); *how* never changes a byte.

use std::time::Duration;

use super::recipe::Recipe;
use crate::coverage::CoverageSchedule;
use crate::error::{Error, ErrorKind, Result};
use crate::scene::Rgb;

/// What to fit. Equal configurations of equal pictures give equal bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// When to stop adding strokes.
    pub budget: Budget,
    /// How much work to spend.
    pub preset: Preset,
    /// Only strokes of opacity 1.
    pub opaque: bool,
    /// The coverage function, or the two between which a fit passes.
    pub coverage: CoverageSchedule,
    /// How many stages to add the strokes in; chosen from the budget when `None`.
    pub stages: Option<usize>,
    /// Whether all strokes are fitted jointly after the stages.
    pub polish: bool,
    /// Decimals of coordinates and widths in the SVG, 0..=6.
    pub precision: u8,
    /// The colour behind all strokes.
    pub background: Background,
    /// Key of every random draw.
    pub seed: u64,
    /// The numbers behind the preset, when they are to be others than [`Recipe::of`] gives.
    pub recipe: Option<Recipe>,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            budget: Budget::default(),
            preset: Preset::default(),
            opaque: false,
            coverage: CoverageSchedule::default(),
            stages: None,
            polish: true,
            precision: 2,
            background: Background::Auto,
            seed: 0,
            recipe: None,
        }
    }
}

/// Limits on the drawing; the first one reached stops.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Budget {
    /// At most this many strokes.
    pub strokes: Option<usize>,
    /// Until this fidelity in dB.
    pub psnr_db: Option<f64>,
    /// At most this many bytes of SVG.
    pub bytes: Option<usize>,
    /// At most this long.
    pub time: Option<Duration>,
}

/// How much work to spend on a drawing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Preset {
    /// Quick look.
    Draft,
    /// The default.
    #[default]
    Balanced,
    /// The last tenths of a dB.
    Best,
}

/// The colour behind all strokes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Background {
    /// Chosen from the picture.
    #[default]
    Auto,
    /// No background; pictures are laid on white.
    None,
    /// This colour.
    Color(Rgb),
}

/// How to run. Never changes the result.
#[derive(Debug, Clone, Default)]
pub struct Execution {
    /// Worker threads; all cores when `None`.
    pub threads: Option<usize>,
}

impl Execution {
    /// The worker threads.
    pub(super) fn pool(&self) -> Result<rayon::ThreadPool> {
        let threads = self.threads.unwrap_or(0);
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|cause| {
                let message =
                    format!("cannot start {threads} worker threads: ask for fewer with --threads");
                Error::new(ErrorKind::Config, message).caused_by(cause)
            })
    }
}
