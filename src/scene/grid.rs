//! The numbers that a file can hold: decimals of a px, as whole units, and channels of 8 bits.

use super::Rgb;

/// Most decimals of a coordinate or width.
pub const MAX_PRECISION: u8 = 6;

/// Units of what is written per px.
pub(crate) const UNITS_PER_PX: i64 = 10_i64.pow(MAX_PRECISION as u32);

/// Narrowest stroke, px. Rasterisers of the Skia family draw a width of 1 px or less as a hairline of lower
/// opacity, with the wrong ink on diagonals. The excess over 1 px keeps rounding from reaching 1 px.
pub const MIN_WIDTH: f64 = 1.02;

/// The multiples of 10^−precision px, or of some steps of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// 10^precision, at most 10^6.
    per_px: i64,
    /// Distance between its points, in multiples.
    step: i64,
}

impl Grid {
    pub(super) fn new(precision: u8) -> Self {
        Self {
            per_px: 10_i64.pow(precision.min(MAX_PRECISION).into()),
            step: 1,
        }
    }

    /// The grid with only each `step`th point.
    pub(super) fn coarser(self, step: i64) -> Self {
        Self { step, ..self }
    }

    /// Multiples of 10^−precision in a px.
    pub(super) fn per_px(&self) -> f64 {
        self.per_px as f64
    }

    /// The nearest point of the grid to `px`, in units.
    pub(super) fn units(&self, px: f64) -> i64 {
        let steps = (px * self.per_px as f64 / self.step as f64).round();
        steps as i64 * self.step * (UNITS_PER_PX / self.per_px)
    }

    /// The largest multiple of at most so many units.
    pub(super) fn below(&self, units: i64) -> i64 {
        let unit = self.step * (UNITS_PER_PX / self.per_px);
        units / unit * unit
    }

    /// The smallest multiple of at least `px`, in units.
    pub(super) fn units_above(&self, px: f64) -> i64 {
        (px * self.per_px as f64).ceil() as i64 * (UNITS_PER_PX / self.per_px)
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
