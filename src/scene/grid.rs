//! The numbers that a file can hold: decimals of a px, and channels of 8 bits.
//!
//! A rounded coordinate is the `f64` nearest to its decimal. [`units`] gives the decimal back exactly.

use super::Rgb;
use crate::math::Point;

/// Most decimals of a coordinate or width.
pub const MAX_PRECISION: u8 = 6;

/// Units of written numbers per px.
pub(crate) const UNITS_PER_PX: i64 = 10_i64.pow(MAX_PRECISION as u32);

/// Narrowest stroke, px. Rasterisers of the Skia family draw a width of 1 px or less as a hairline of lower
/// opacity, with the wrong ink on diagonals. The excess over 1 px keeps rounding from reaching 1 px.
pub const MIN_WIDTH: f64 = 1.02;

/// Largest absolute value of a coordinate, and radius of an arc, px. All decimals up to here are exact.
pub(super) const MAX_COORDINATE: f64 = 1e9;

/// The decimal of a rounded coordinate or length, in units of 1/[`UNITS_PER_PX`] px.
pub(crate) fn units(px: f64) -> i64 {
    (px * UNITS_PER_PX as f64).round() as i64
}

/// The coordinate or length of so many units, px.
pub(crate) fn px(units: i64) -> f64 {
    units as f64 / UNITS_PER_PX as f64
}

/// The multiples of 10^−precision px.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// 10^precision, at most 10^6.
    per_px: f64,
}

impl Grid {
    pub(super) fn new(precision: u8) -> Self {
        let per_px = 10_i64.pow(precision.min(MAX_PRECISION).into());
        Self {
            per_px: per_px as f64,
        }
    }

    /// The distance of neighbouring multiples, px.
    pub(super) fn step(&self) -> f64 {
        1.0 / self.per_px
    }

    /// The nearest multiple.
    pub(super) fn round(&self, px: f64) -> f64 {
        (px * self.per_px).round() / self.per_px
    }

    /// The nearest point of the grid.
    pub(super) fn point(&self, p: Point) -> Point {
        Point::new(self.round(p.x), self.round(p.y))
    }

    /// The largest multiple of at most `px`, which is a multiple of half a step.
    pub(super) fn below(&self, px: f64) -> f64 {
        // Half steps are rounded first, so that an error in the last bit can't take a whole step away.
        ((2.0 * px * self.per_px).round() / 2.0).floor() / self.per_px
    }

    /// The smallest multiple of at least `px`.
    pub(super) fn above(&self, px: f64) -> f64 {
        (px * self.per_px).ceil() / self.per_px
    }
}

/// The nearest of 0..=255 to a value of 0..1.
pub(crate) fn quantum(value: f32) -> u8 {
    (value * 255.0 + 0.5) as u8
}

/// The colour of 8-bit channels.
pub(crate) fn color(channels: [u8; 3]) -> Rgb {
    channels.map(|c| f32::from(c) / 255.0)
}
