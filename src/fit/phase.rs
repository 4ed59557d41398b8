//! The phases of a fit; [`order`](super::order) says which follows which.
//!
//! | file | what happens there |
//! | --- | --- |
//! | `trace` | strokes are laid along the lines that are seen |
//! | `grow` | stages are seeded, fitted on frozen strokes, and keep what pays |
//! | `polish` | all strokes are fitted jointly, with relocation |
//! | `recover` | small things that were lost on the way are traced again |
//! | `restrict` | strokes get the colours and widths that the file may have |
//! | `settle` | the last steps are taken against renders of the written file |
//! | `count` | files are compared, and strokes added and removed until budgets are met |

pub(super) mod count;
pub(super) mod descend;
pub(super) mod grow;
pub(super) mod polish;
pub(super) mod recover;
pub(super) mod relocation;
pub(super) mod restrict;
mod search;
pub(super) mod settle;
pub(super) mod trace;
