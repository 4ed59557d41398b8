//! The shade: a gradient over the whole background, behind all marks, or over an area.
//!
//! A shade holds exactly what its SVG elements hold: hundredths of a px, thousandths of its axis, 8-bit colours
//! and opacities. So it is rounded once, where it is made, and reading gives back what was written.

use serde::{Deserialize, Serialize};

use super::{Rgb, UNITS_PER_PX, quantum};
use crate::error::{Error, ErrorKind, Result};
use crate::math::{self, Point};

/// Most stops of a shade.
pub const MAX_STOPS: usize = 16;

/// Units of what is written per hundredth of a px.
const HUNDREDTH: i64 = UNITS_PER_PX / 100;
/// Shortest axis, hundredths of a px.
const MIN_LENGTH: f64 = 100.0;
/// Largest absolute value of a coordinate, px.
const MAX_COORDINATE: f32 = 1e6;

/// A gradient over the whole page or an area. Colour and opacity change linearly from stop to stop; before the first stop
/// and beyond the last they stay.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shade {
    pub(crate) axis: WrittenAxis,
    pub(crate) stops: Vec<WrittenStop>,
}

/// Axis of a gradient, px. Offsets of stops are shares of it.
#[derive(Debug, Clone, Copy, PartialEq)]
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
        radius: f32,
    },
}

/// A place of the axis with its colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadeStop {
    /// Share of the axis, 0..1.
    pub offset: f32,
    /// sRGB-encoded colour, 0..1.
    pub color: Rgb,
    /// 0 (invisible) to 1 (opaque).
    pub opacity: f32,
}

/// An [`Axis`] in units of 1/[`UNITS_PER_PX`] px: x1, y1, x2, y2 or the centre and the radius.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum WrittenAxis {
    Linear([i64; 4]),
    Radial([i64; 3]),
}

/// A [`ShadeStop`]: thousandths of the axis, 8-bit channels and opacity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct WrittenStop {
    pub(crate) offset: u16,
    pub(crate) color: [u8; 3],
    pub(crate) opacity: u8,
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
        let numbers = match axis {
            Axis::Linear { from, to } => [from.x, from.y, to.x, to.y],
            Axis::Radial { center, radius } => [center.x, center.y, radius, 0.0],
        };
        if !numbers.iter().all(|v| v.abs() <= MAX_COORDINATE) {
            return refuse("a coordinate that is not finite or beyond a million px");
        }
        let offsets = || stops.iter().map(|stop| stop.offset);
        if !(2..=MAX_STOPS).contains(&stops.len()) {
            return refuse(&format!("{} stops: give 2 to {MAX_STOPS}", stops.len()));
        }
        if !offsets().all(|offset| (0.0..=1.0).contains(&offset)) || !offsets().is_sorted() {
            return refuse("offsets that are not between 0 and 1, or that fall");
        }
        let units = numbers.map(|v| (f64::from(v) * 100.0).round() as i64 * HUNDREDTH);
        let written = |stop: &ShadeStop| WrittenStop {
            offset: (stop.offset * 1000.0).round() as u16,
            color: stop.color.map(quantum),
            opacity: quantum(stop.opacity),
        };
        let axis = match axis {
            Axis::Linear { .. } => WrittenAxis::Linear(units),
            Axis::Radial { .. } => WrittenAxis::Radial([units[0], units[1], units[2]]),
        };
        let shade = Self::written(axis, stops.iter().map(written).collect());
        shade.map_or_else(|| refuse("an axis shorter than a px"), Ok)
    }

    /// The shade of these numbers of a file, unless its axis is too short, its stops are too few, too many or not in order.
    pub(crate) fn written(axis: WrittenAxis, stops: Vec<WrittenStop>) -> Option<Self> {
        let length = match axis {
            WrittenAxis::Linear([ax, ay, bx, by]) => {
                math::hypot((bx - ax) as f64, (by - ay) as f64)
            }
            WrittenAxis::Radial([.., radius]) => radius as f64,
        };
        let whole = length >= MIN_LENGTH * HUNDREDTH as f64
            && (2..=MAX_STOPS).contains(&stops.len())
            && stops.is_sorted_by_key(|stop| stop.offset);
        whole.then_some(Self { axis, stops })
    }

    /// Axis of the gradient. Offsets are shares of it.
    pub fn axis(&self) -> Axis {
        let px = |units: i64| (units as f64 / UNITS_PER_PX as f64) as f32;
        match self.axis {
            WrittenAxis::Linear(numbers) => {
                let [ax, ay, bx, by] = numbers.map(px);
                Axis::Linear {
                    from: Point::new(ax, ay),
                    to: Point::new(bx, by),
                }
            }
            WrittenAxis::Radial(numbers) => {
                let [x, y, radius] = numbers.map(px);
                Axis::Radial {
                    center: Point::new(x, y),
                    radius,
                }
            }
        }
    }

    /// The stops, by rising offset.
    pub fn stops(&self) -> impl ExactSizeIterator<Item = ShadeStop> {
        self.stops.iter().map(|stop| ShadeStop {
            offset: f32::from(stop.offset) / 1000.0,
            color: stop.color.map(|level| f32::from(level) / 255.0),
            opacity: f32::from(stop.opacity) / 255.0,
        })
    }

    /// The mean colour over the axis, of 8-bit channels.
    pub(crate) fn mean(&self) -> [u8; 3] {
        let mut sums = [0; 3];
        let mut add = |thousandths: u64, stop: &WrittenStop| {
            let channels = sums.iter_mut().zip(stop.color);
            channels.for_each(|(sum, level)| *sum += thousandths * u64::from(level));
        };
        let ends = [self.stops.first(), self.stops.last()];
        if let [Some(first), Some(last)] = ends {
            add(2 * u64::from(first.offset), first);
            add(2000 - 2 * u64::from(last.offset), last);
        }
        for pair in self.stops.windows(2) {
            let width = u64::from(pair[1].offset - pair[0].offset);
            pair.iter().for_each(|stop| add(width, stop));
        }
        sums.map(|sum: u64| ((sum + 1000) / 2000) as u8)
    }

    /// True if all of it is opaque.
    pub fn is_opaque(&self) -> bool {
        self.stops.iter().all(|stop| stop.opacity == u8::MAX)
    }

    /// Colour and opacity at `point`.
    pub fn at(&self, point: Point) -> (Rgb, f32) {
        self.at_offset(self.axis().offset(point))
    }

    /// Page of `width`×`height` px on `behind`: three planes, row by row.
    pub fn planes(&self, width: usize, height: usize, behind: Rgb) -> [Vec<f32>; 3] {
        let axis = self.axis();
        let mut planes: [Vec<f32>; 3] = Default::default();
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let center = Point::new(x as f32 + 0.5, y as f32 + 0.5);
            let (color, opacity) = self.at_offset(axis.offset(center));
            for (c, plane) in planes.iter_mut().enumerate() {
                plane.push(behind[c] + opacity * (color[c] - behind[c]));
            }
        }
        planes
    }

    /// Colour and opacity at `offset`: straight, not premultiplied, as SVG interpolates them. Of stops with one offset the
    /// last holds from there on.
    fn at_offset(&self, offset: f32) -> (Rgb, f32) {
        let thousandths = offset * 1000.0;
        let after = self
            .stops
            .partition_point(|stop| f32::from(stop.offset) <= thousandths);
        // There are at least two stops.
        let last = self.stops.len() - 1;
        let [left, right] = [after.saturating_sub(1), after.min(last)].map(|i| self.stops[i]);
        let width = f32::from(right.offset) - f32::from(left.offset);
        let part = if width > 0.0 {
            ((thousandths - f32::from(left.offset)) / width).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let mix = |a: u8, b: u8| (f32::from(a) + part * (f32::from(b) - f32::from(a))) / 255.0;
        let color = [0, 1, 2].map(|c| mix(left.color[c], right.color[c]));
        (color, mix(left.opacity, right.opacity))
    }
}

impl Axis {
    /// The offset at `point`, not clamped.
    pub fn offset(&self, point: Point) -> f32 {
        match *self {
            Self::Linear { from, to } => {
                let along = to - from;
                (point - from).dot(&along) / along.norm_squared()
            }
            Self::Radial { center, radius } => {
                let away = point - center;
                math::hypot(away.x, away.y) / radius
            }
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

    fn across(width: f32) -> Axis {
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
        let [red, ..] = shade.planes(8, 1, [0.0; 3]);
        let expected = [0.0, 0.0, 0.25, 0.75, 0.875, 0.625, 0.375, 0.125];
        assert!(
            red.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6),
            "{red:?}"
        );
    }

    #[test]
    fn what_is_translucent_shows_what_is_behind() {
        let stops = [stop(0.0, 0.0, 0.0), stop(1.0, 0.0, 1.0)];
        let shade = Shade::new(across(4.0), &stops).unwrap();
        let [red, ..] = shade.planes(4, 1, [1.0; 3]);
        let expected = [0.875, 0.625, 0.375, 0.125];
        assert!(
            red.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6),
            "{red:?}"
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
        let [red, ..] = shade.planes(10, 10, [0.0; 3]);
        assert_eq!(red[4 * 10 + 1], red[10 + 4]);
        assert_eq!(red[0], 0.0);
        assert!((red[5 * 10 + 7] - (1.0 - 6.5_f32.sqrt() / 5.0)).abs() < 1e-5);
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
        assert!(Shade::new(across(f32::NAN), &two).is_err());
        assert!(Shade::new(across(10.0), &two[..1]).is_err());
        assert!(Shade::new(across(10.0), &[two[1], two[0]]).is_err());
        assert!(Shade::new(across(10.0), &[stop(0.0, 0.0, 1.0); MAX_STOPS + 1]).is_err());
    }
}
