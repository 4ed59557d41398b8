//! The first-order optimiser [`Adam`] over slices, with `PyTorch`'s update formula, and learning-rate [`Schedule`]s.
//!
//! It sees only slices. The caller decides how strokes are laid out in them, which values are positions or colours, and how they are
//! clamped. State is allocated once; a step allocates nothing. Every value keeps its own bias correction, so a relocated stroke
//! can start afresh ([`Adam::reset`]) among others that continue.
//!
//! ```
//! use strokefit::optim::Adam;
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
mod schedule;

pub use adam::{Adam, AdamParams};
pub use schedule::Schedule;
