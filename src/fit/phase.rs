//! The phases of a fit; [`order`](super::order) says which follows which.
//!
//! | file | what happens there |
//! | --- | --- |
//! | `trace` | strokes are laid along the lines that are seen |
//! | `grow` | stages are seeded, fitted on frozen strokes, and keep what pays |
//! | `polish` | all strokes are fitted jointly, with relocation |
//! | `palette`, `stack` | the drawing is restricted to few colours, one layer each if asked for |
//! | `widths`, `pens` | strokes get the widths of given pens, and share few pens in the smallest form |
//! | `sharing` | strokes of a drawing of lines come to share widths and colours |
//! | `settle` | the last steps are taken against renders of the written file |
//! | `nudge` | points move by a tenth of a px at most, to where rasterisers draw the strokes better |
//! | `count` | strokes are added and removed until budgets are met |

pub(super) mod count;
pub(super) mod grow;
mod nudge;
mod palette;
mod pens;
pub(super) mod polish;
mod preferences;
mod rounds;
pub(super) mod settle;
mod sharing;
mod stack;
pub(super) mod trace;
mod widths;
