//! The shadow: a filled shape, blurred, behind all marks.
//!
//! A shadow holds exactly what its SVG elements hold: tenths of a px of its outline, hundredths of its blur, 8-bit colour and
//! opacity. So it is rounded once, where it is made, and reading gives back what was written.

use super::{Area, Mark, quantize};
use crate::error::{Error, ErrorKind, Result};

/// Decimals of the outline of a shadow.
const PRECISION: u8 = 1;
/// Least and most blur, px. Programs draw less than half a pixel in ways of their own.
const BLURS: [f32; 2] = [0.5, 1000.0];
/// Standard deviations beyond which nothing is seen of a shadow.
const REACH: f64 = 3.0;

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
        match quantize::quantized_anywhere(&Mark::Area(area), PRECISION) {
            Some(Mark::Area(area)) => Ok(Self { area, blur }),
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

    /// The corners, px, of least and most x and y of all that is seen of it.
    pub(crate) fn extent(&self) -> [[i64; 2]; 2] {
        let reach = REACH * f64::from(self.blur());
        let around = Mark::Area(self.area.clone())
            .bounds()
            .inflate(reach, reach)
            .expand();
        [[around.x0, around.y0], [around.x1, around.y1]].map(|p| p.map(|px| px as i64))
    }
}
