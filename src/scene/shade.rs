//! The shade: a gradient over the whole background, behind all marks, or over an area.
//!
//! A shade holds exactly what its SVG elements hold: hundredths of a px, thousandths of its axis, 8-bit colours
//! and opacities. So it is rounded once, where it is made, and reading gives back what was written.

use serde::{Deserialize, Serialize};

use super::Rgb;
use super::grid::{Grid, color, quantum};
use crate::error::{Error, ErrorKind, Result};
use crate::math::Point;

/// Most stops of a shade.
pub const MAX_STOPS: usize = 16;

/// Decimals of its coordinates.
const PRECISION: u8 = 2;
/// Shortest axis, px.
const MIN_LENGTH: f64 = 1.0;
/// Largest absolute value of a coordinate, px.
const MAX_COORDINATE: f64 = 1e6;

/// A gradient over the whole page or an area. Colour and opacity change linearly from stop to stop; before the first stop
/// and beyond the last they stay.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shade {
    axis: Axis,
    stops: Vec<ShadeStop>,
}

/// Axis of a gradient, px. Offsets of stops are shares of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Axis {
    /// From one point to another; colours are constant across it.
    Linear {
        /// Offset 0.
        from: Point,
        /// Offset 1.
        to: Point,
    },
    /// From a centre outwards.
    Radial {
        /// Offset 0.
        center: Point,
        /// The distance that has offset 1.
        radius: f64,
    },
}

/// A place of the axis with its colour.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShadeStop {
    /// Share of the axis, 0..1.
    pub offset: f32,
    /// sRGB-encoded colour, 0..1.
    pub color: Rgb,
    /// 0 (invisible) to 1 (opaque).
    pub opacity: f32,
}

impl ShadeStop {
    /// The offset in thousandths of the axis, rounded.
    pub(crate) fn thousandths(&self) -> u16 {
        (self.offset * 1000.0).round() as u16
    }

    /// The stop as a file has it.
    fn rounded(&self) -> Self {
        Self {
            offset: f32::from(self.thousandths()) / 1000.0,
            color: color(self.color.map(quantum)),
            opacity: f32::from(quantum(self.opacity)) / 255.0,
        }
    }
}

impl Shade {
    /// The shade with these stops, rounded to what its file holds.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when the axis is shorter than a px or not finite, there are less than two stops or more than
    /// [`MAX_STOPS`], or their offsets are not between 0 and 1 or fall.
    pub fn new(axis: Axis, stops: &[ShadeStop]) -> Result<Self> {
        let refuse = |what: &str| {
            let message = format!("a gradient has {what}");
            Err(Error::new(ErrorKind::Config, message))
        };
        if !axis.numbers().iter().all(|v| v.abs() <= MAX_COORDINATE) {
            return refuse("a coordinate that is not finite or beyond a million px");
        }
        let offsets = || stops.iter().map(|stop| stop.offset);
        if !(2..=MAX_STOPS).contains(&stops.len()) {
            return refuse(&format!("{} stops: give 2 to {MAX_STOPS}", stops.len()));
        }
        if !offsets().all(|offset| (0.0..=1.0).contains(&offset)) || !offsets().is_sorted() {
            return refuse("offsets that are not between 0 and 1, or that fall");
        }
        // Round the axis before its length is checked: rounding may shorten it.
        let grid = Grid::new(PRECISION);
        let axis = match axis {
            Axis::Linear { from, to } => Axis::Linear {
                from: grid.point(from),
                to: grid.point(to),
            },
            Axis::Radial { center, radius } => Axis::Radial {
                center: grid.point(center),
                radius: grid.round(radius),
            },
        };
        if axis.length() < MIN_LENGTH {
            return refuse("an axis shorter than a px");
        }
        let stops = stops.iter().map(ShadeStop::rounded).collect();
        Ok(Self { axis, stops })
    }

    /// Axis of the gradient. Offsets are shares of it.
    pub fn axis(&self) -> Axis {
        self.axis
    }

    /// The stops, by rising offset.
    pub fn stops(&self) -> &[ShadeStop] {
        &self.stops
    }

    /// The mean colour over the axis, of 8-bit channels.
    pub(crate) fn mean(&self) -> [u8; 3] {
        let mut sums = [0; 3];
        let mut add = |thousandths: u64, stop: &ShadeStop| {
            let channels = sums.iter_mut().zip(stop.color.map(quantum));
            channels.for_each(|(sum, level)| *sum += thousandths * u64::from(level));
        };
        let offset = |stop: &ShadeStop| u64::from(stop.thousandths());
        // Twice the mean, in thousandths: a piece of constant colour counts twice its width, and a linear piece its width for each
        // of its two ends. Whole numbers, so that reader and writer agree.
        if let [first, .., last] = &self.stops[..] {
            add(2 * offset(first), first);
            add(2000 - 2 * offset(last), last);
        }
        for pair in self.stops.windows(2) {
            let width = offset(&pair[1]) - offset(&pair[0]);
            pair.iter().for_each(|stop| add(width, stop));
        }
        // Half of the divisor is added, which rounds to the nearest level.
        sums.map(|sum: u64| ((sum + 1000) / 2000) as u8)
    }

    /// True if all of it is opaque.
    pub fn is_opaque(&self) -> bool {
        self.stops.iter().all(|stop| stop.opacity == 1.0)
    }

    /// Colour and opacity at `point`: straight, not premultiplied, as SVG interpolates them. Of stops with one offset the
    /// last holds from there on.
    pub fn at(&self, point: Point) -> (Rgb, f32) {
        let offset = self.axis.offset(point) as f32;
        let after = self.stops.partition_point(|stop| stop.offset <= offset);
        // There are at least two stops.
        let last = self.stops.len() - 1;
        // Before the first stop and beyond the last one both are the same stop, so that the colour is constant there.
        let [left, right] = [after.saturating_sub(1), after.min(last)].map(|i| self.stops[i]);
        let width = right.offset - left.offset;
        let part = if width > 0.0 {
            ((offset - left.offset) / width).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let mix = |a: f32, b: f32| a + part * (b - a);
        let color = [0, 1, 2].map(|c| mix(left.color[c], right.color[c]));
        (color, mix(left.opacity, right.opacity))
    }
}

impl Axis {
    /// The offset at `point`, not clamped.
    pub fn offset(&self, point: Point) -> f64 {
        match *self {
            Self::Linear { from, to } => {
                let along = to - from;
                (point - from).dot(along) / along.hypot2()
            }
            Self::Radial { center, radius } => (point - center).hypot() / radius,
        }
    }

    /// The distance that has offset 1.
    pub(crate) fn length(&self) -> f64 {
        match *self {
            Self::Linear { from, to } => (to - from).hypot(),
            Self::Radial { radius, .. } => radius,
        }
    }

    /// Its numbers as a file has them: both points, or the centre and the radius.
    pub(crate) fn numbers(&self) -> Vec<f64> {
        match *self {
            Self::Linear { from, to } => vec![from.x, from.y, to.x, to.y],
            Self::Radial { center, radius } => vec![center.x, center.y, radius],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stop(offset: f32, grey: f32, opacity: f32) -> ShadeStop {
        ShadeStop {
            offset,
            color: [grey; 3],
            opacity,
        }
    }

    fn across(width: f64) -> Axis {
        Axis::Linear {
            from: Point::new(0.0, 0.0),
            to: Point::new(width, 0.0),
        }
    }

    #[test]
    fn colours_change_from_stop_to_stop() {
        let stops = [
            stop(0.25, 0.0, 1.0),
            stop(0.5, 1.0, 1.0),
            stop(1.0, 0.0, 1.0),
        ];
        let shade = Shade::new(across(8.0), &stops).unwrap();
        let expected = [0.0, 0.0, 0.25, 0.75, 0.875, 0.625, 0.375, 0.125];
        for (x, grey) in expected.into_iter().enumerate() {
            let (color, opacity) = shade.at(Point::new(x as f64 + 0.5, 0.5));
            assert!(
                (color[0] - grey).abs() < 1e-6 && opacity == 1.0,
                "{x}: {color:?}"
            );
        }
    }

    #[test]
    fn opacities_change_from_stop_to_stop() {
        let stops = [stop(0.0, 0.0, 0.0), stop(1.0, 0.0, 1.0)];
        let shade = Shade::new(across(4.0), &stops).unwrap();
        let opacity = |x| shade.at(Point::new(x, 0.5)).1;
        assert_eq!(
            [0.5, 1.5, 2.5, 3.5].map(opacity),
            [0.125, 0.375, 0.625, 0.875]
        );
        assert!(!shade.is_opaque());
    }

    #[test]
    fn a_radial_shade_is_round() {
        let axis = Axis::Radial {
            center: Point::new(5.0, 5.0),
            radius: 5.0,
        };
        let shade = Shade::new(axis, &[stop(0.0, 1.0, 1.0), stop(1.0, 0.0, 1.0)]).unwrap();
        let grey = |x, y| shade.at(Point::new(x, y)).0[0];
        assert_eq!(grey(1.5, 4.5), grey(4.5, 1.5));
        assert_eq!(grey(0.5, 0.5), 0.0);
        assert!((grey(7.5, 5.5) - (1.0 - 6.5_f32.sqrt() / 5.0)).abs() < 1e-5);
    }

    #[test]
    fn the_mean_is_that_of_the_colours_over_the_axis() {
        let mean = |stops: &[ShadeStop]| Shade::new(across(8.0), stops).unwrap().mean();
        let (black, white) = (stop(0.0, 0.0, 1.0), stop(1.0, 1.0, 1.0));
        assert_eq!(mean(&[black, white]), [128; 3]);
        assert_eq!(mean(&[stop(0.5, 0.0, 1.0), white]), [64; 3]);
        assert_eq!(mean(&[black, stop(0.25, 1.0, 1.0)]), [223; 3]);
    }

    #[test]
    fn what_no_file_holds_is_refused() {
        let two = [stop(0.0, 0.0, 1.0), stop(1.0, 1.0, 1.0)];
        assert!(Shade::new(across(10.0), &two).is_ok());
        assert!(Shade::new(across(0.5), &two).is_err());
        assert!(Shade::new(across(f64::NAN), &two).is_err());
        assert!(Shade::new(across(10.0), &two[..1]).is_err());
        assert!(Shade::new(across(10.0), &[two[1], two[0]]).is_err());
        assert!(Shade::new(across(10.0), &[stop(0.0, 0.0, 1.0); MAX_STOPS + 1]).is_err());
    }
}
