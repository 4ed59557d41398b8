//! The radii that strokes may have.

use crate::fit::drawing::bounds::MIN_RADIUS;
use crate::math;

/// Ratio between neighbouring widths that a pen may have. Twice: −2.58 dB and −10.6 % of the bytes.
const LADDER: f32 = 1.2;

/// The radii that strokes may have.
#[derive(Debug, Clone, Copy)]
pub(super) enum WidthGrid<'a> {
    /// Any radius.
    Any,
    /// A geometric series.
    Series {
        /// The least radius, px.
        least: f32,
        /// The ratio of neighbouring radii.
        step: f32,
    },
    /// These, px.
    Given(&'a [f32]),
}

impl<'a> WidthGrid<'a> {
    /// The radii of the given pens or, if there are none, a series.
    pub(super) fn of(given: &'a [f32]) -> Self {
        if !given.is_empty() {
            return Self::Given(given);
        }
        Self::Series {
            least: MIN_RADIUS,
            step: LADDER,
        }
    }

    /// The nearest of the radii.
    pub(super) fn nearest(self, radius: f32) -> f32 {
        match self {
            Self::Any => radius,
            Self::Series { least, step } => {
                let steps = math::ln((radius / least).max(1.0)) / math::ln(step);
                least * math::powf(step, steps.round())
            }
            Self::Given(radii) => {
                let away = |given: &f32| (given - radius).abs();
                let radii = radii.iter().copied();
                let nearest = radii.min_by(|a, b| away(a).total_cmp(&away(b)));
                nearest.unwrap_or(radius)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_of_given_radii_is_taken() {
        let pens = WidthGrid::Given(&[0.6, 1.5, 4.0]);
        let nearest = [0.1, 1.0, 1.1, 9.0].map(|radius| pens.nearest(radius));
        assert_eq!(nearest, [0.6, 0.6, 1.5, 4.0]);
    }

    #[test]
    fn radii_are_in_a_series() {
        let series = WidthGrid::Series {
            least: 0.51,
            step: 1.2,
        };
        let near_three = series.nearest(3.0);
        assert_eq!(series.nearest(0.51), 0.51);
        assert!((near_three / 3.0 - 1.0).abs() < 0.06);
        assert!((series.nearest(near_three) - near_three).abs() < 1e-6);
    }
}
