//! Colours of numbers.

pub use strokefit::report::{heat, map};

/// 0 is black, 1 white.
pub fn gray(value: f64) -> [f64; 3] {
    [value; 3]
}
