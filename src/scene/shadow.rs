//! The shadow: a filled shape, blurred, behind all marks.
//!
//! A shadow holds exactly what its SVG elements hold: tenths of a px of its outline, hundredths of its blur, 8-bit colour and
//! opacity. So it is rounded once, where it is made, and reading gives back what was written.

use super::quantize::Written;
use super::{Area, Mark, Path, UNITS_PER_PX};
use crate::error::{Error, ErrorKind, Result};

/// Decimals of the outline of a shadow.
const PRECISION: u8 = 1;
/// Units of what is written per hundredth of a px.
const HUNDREDTH: i64 = UNITS_PER_PX / 100;
/// Least and most blur, px. Programs draw less than half a pixel in ways of their own.
const BLURS: [f32; 2] = [0.5, 1000.0];
/// Standard deviations beyond which nothing is seen of a shadow.
const REACH: f32 = 3.0;

/// A shape of one colour, blurred: a soft shadow or a glow, behind all marks.
#[derive(Debug, Clone, PartialEq)]
pub struct Shadow {
    area: Area,
    /// Hundredths of a px.
    blur: u32,
}

impl Shadow {
    /// The shadow of the shape of `area`, in its colour and opacity, with a Gaussian `blur` of this standard deviation, px,
    /// rounded to what its file holds.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when the blur is less than half a px or more than a thousand, the area has a gradient, or nothing
    /// of it is left once it is rounded.
    pub fn new(area: Area, blur: f32) -> Result<Self> {
        let refuse = |what: String| Err(Error::new(ErrorKind::Config, what));
        let [least, most] = BLURS;
        if !(least..=most).contains(&blur) {
            let range = format!("give {least} to {most}");
            return refuse(format!("a shadow has a blur of {blur} px: {range}"));
        }
        if area.shade.is_some() {
            return refuse("a shadow has a gradient: give one colour".into());
        }
        let blur = (blur * 100.0).round() as u32;
        match Written::round_or_filled(&area.into(), PRECISION).map(|written| written.mark()) {
            Ok(Mark::Area(area)) => Ok(Self { area, blur }),
            _ => refuse("a shadow has nothing to be seen".into()),
        }
    }

    /// The shape before it is blurred, in the colour and opacity of the shadow.
    pub fn area(&self) -> &Area {
        &self.area
    }

    /// Standard deviation of the blur, px.
    pub fn blur(&self) -> f32 {
        self.blur as f32 / 100.0
    }

    /// The integers of the shadow's element, and of its blur in 1/[`UNITS_PER_PX`] px.
    pub(crate) fn written(&self) -> Option<(Written, i64)> {
        let area = Mark::Area(self.area.clone());
        let written = Written::round_or_filled(&area, PRECISION).ok()?;
        Some((written, i64::from(self.blur) * HUNDREDTH))
    }

    /// The corners, px, of least and most x and y of all that is seen of it.
    pub(crate) fn extent(&self) -> [[i64; 2]; 2] {
        let points = || self.area.rings.iter().flat_map(Path::points);
        let reach = REACH * self.blur();
        let low = |axis: usize| points().map(|p| p.at[axis]).fold(f32::INFINITY, f32::min);
        let high = |axis: usize| {
            points()
                .map(|p| p.at[axis])
                .fold(f32::NEG_INFINITY, f32::max)
        };
        let corner = |axis| [(low(axis) - reach).floor(), (high(axis) + reach).ceil()];
        let [x, y] = [corner(0), corner(1)].map(|ends| ends.map(|px| px as i64));
        [[x[0], y[0]], [x[1], y[1]]]
    }
}
