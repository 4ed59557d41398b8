//! The fit: picture in, drawing out.
//!
//! A [`Fitter`] adds strokes in stages, on a background or on a [`Base`]. Each stage seeds new strokes where
//! the residual is largest, fits them briefly with all earlier strokes frozen, and keeps those that pay. The polish
//! then fits all strokes jointly, and relocates those of least contribution to where more is to be gained; small things that got lost
//! on the way are traced again. If the file may have
//! only a few colours or pens, the strokes are restricted to those. Settling takes the last steps against what the
//! written file really looks like. Finally the fit adds or removes strokes, and fits them again, until the file is as faithful and as short as the budgets ask for.
//!
//! [`Fitter::fit`] restores and reduces the picture. `multi_start` draws it, once or several times, and runs the phases: `order` says
//! which follows which, and `phase` has a file for each. The session holds the whole state of a fit. Between two phases, and between
//! two iterations of most phases, a [`Checkpoint`] can keep that state, and another process can go on from it.
//!
//! | module | about |
//! | --- | --- |
//! | `order`, `phase` | the phases: which follows which, and a file for each |
//! | `multi_start` | several fits that compete, and the rule that says which drawing is better |
//! | `task`, `config`, `recipe` | what is drawn and how: picture, base, options, presets |
//! | `budget` | limits, the price of a stroke, the plan of stages, the pixels that a drawing needs |
//! | `drawing` | strokes in progress, on surfaces of target, backdrop and canvas; the objective; the background |
//! | `descent` | gradient descent and its annealing |
//! | `edits` | marks and points in the place of others, which stay if they pay |
//! | `points` | points of strokes that come and go at their price |
//! | `file` | the written file, as resvg renders it |
//! | `run`, `time` | a fit under way: session, history, checkpoint, progress, finish; its clock and its forecast |

mod base;
mod budget;
mod config;
mod descent;
mod domain;
mod drawing;
mod edits;
mod file;
mod fitter;
mod multi_start;
mod options;
mod order;
mod phase;
mod points;
mod recipe;
mod result;
mod run;
mod simd;
mod task;
mod time;
mod widths;
mod words;

pub use base::Base;
pub use budget::memory::predicted_rss_bytes;
pub(crate) use budget::memory::rss_bytes_of;
pub use config::{
    Background, Budget, Colors, Config, DEFAULT_QUALITY, DEFAULT_STROKES, ErrorWeighting,
    Execution, MAX_STROKES, MAX_THREADS, PIXELS_PER_STROKE, SCREEN_PIXELS,
};
pub use descent::anneal::final_softness;
pub use domain::seconds;
pub use drawing::focus::Focus;
pub use drawing::objective::Objective;
pub use fitter::Fitter;
pub use options::{OPTIONS, Options};
pub use recipe::Preset;
#[doc(hidden)]
pub use recipe::{Rates, Recipe};
pub use result::{Fit, StageRecord, Stop};
pub use run::checkpoint::Checkpoint;
pub use run::progress::{CancelToken, Observer, Progress};
pub use simd::Simd;
pub use widths::Widths;
