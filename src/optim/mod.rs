//! First-order optimisers over slices: [`Adam`], [`AdamW`] and [`RmsProp`], with `PyTorch`'s update
//! formulas, and learning-rate [`Schedule`]s.
//!
//! An optimiser sees only slices. The caller decides how strokes are laid out in them, which values are
//! positions or colours, and how they are clamped. State is allocated once; a step allocates nothing. Every
//! value keeps its own bias correction, so a relocated stroke can start afresh ([`Optimizer::reset`])
//! among others that continue.
//!
//! ```
//! use strokefit::optim::{Adam, Optimizer};
//!
//! let mut x = [3.0_f64, -2.0];
//! let mut adam = Adam::new(x.len(), Default::default());
//! for _ in 0..500 {
//!     let gradient = x.map(|x| 2.0 * x); // of |x|²
//!     adam.step(&mut x, &gradient, 0.05);
//! }
//! assert!(x.iter().all(|x| x.abs() < 1e-3));
//! ```

mod adam;
mod adamw;
mod rmsprop;
mod schedule;

use std::ops::Range;

pub use adam::{Adam, AdamParams};
pub use adamw::{AdamW, AdamWParams};
pub use rmsprop::{RmsProp, RmsPropParams};
pub use schedule::Schedule;

use crate::math::Real;

/// The interface of all optimisers.
///
/// The slices given to a step are as long as the `len` of the optimiser. Values beyond the shortest of them
/// do not change.
pub trait Optimizer<T: Real> {
    /// Moves `params` down `gradients` with one learning `rate` for all.
    fn step(&mut self, params: &mut [T], gradients: &[T], rate: T);

    /// Moves `params` with the learning rate `rate · scales[i]` for value `i`, since positions, radii, colours and
    /// opacities need different rates. `scales` are filled once; `rate` follows a [`Schedule`].
    fn step_scaled(&mut self, params: &mut [T], gradients: &[T], rate: T, scales: &[T]);

    /// Resets the state of the values in `range`, as if they had never made a step. Indices beyond the end
    /// are ignored.
    fn reset(&mut self, range: Range<usize>);
}

/// The part of `range` that lies in `0..len`.
fn clip(range: Range<usize>, len: usize) -> Range<usize> {
    let end = range.end.min(len);
    range.start.min(end)..end
}
