//! The ground: areas on the background, behind all marks.
//!
//! They hold exactly what their SVG elements hold: tenths of a px of the outline of a shadow, hundredths of others and of a blur, 8-bit
//! colour and opacity. So they are rounded once, where they are made, and reading gives back what was written.

use kurbo::Rect;

use super::grid::color;
use super::path::bounds;
use super::{Area, Mark, Path, Scene, Shade, Shape, Stage, quantize};
use crate::error::{Error, ErrorKind, Result};
use crate::math::Point;
use crate::words::words;

/// Decimals of the outline of a shadow.
const PRECISION: u8 = 1;
/// Least and most blur, px. Programs draw less than half a pixel in ways of their own.
const BLURS: [f32; 2] = [0.5, 1000.0];
/// Standard deviations beyond which nothing is seen of a blur.
const REACH: f64 = 3.0;

/// What soft shadows are drawn with.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Blurs {
    /// A filter that blurs a shape
    #[default]
    Filter,
    /// Some shapes on each other, for programs that ignore filters, such as apps and cutters
    Steps,
}

words!(Blurs, "a kind of blurs": Filter = "filter", Steps = "steps");

impl Area {
    /// A page of this width and height, px, filled with a gradient.
    pub fn page(shade: Shade, [width, height]: [u32; 2]) -> Self {
        let page = Shape::Rect {
            low: Point::ORIGIN,
            high: Point::new(width.into(), height.into()),
            radius: 0.0,
        };
        Self {
            shade: Some(shade.clone()),
            ..Self::plain(vec![page.path()], color(shade.mean()), 1.0)
        }
    }

    /// True if it is a gradient that fills a page of this width and height, px.
    pub(crate) fn is_page(&self, size: [u32; 2]) -> bool {
        let page = |shade: &Shade| Self::page(shade.clone(), size).rings;
        self.shade
            .as_ref()
            .is_some_and(|shade| page(shade) == self.rings)
    }

    /// This area with a Gaussian `blur` of this standard deviation, px, as a soft shadow or a glow; rounded to what its file
    /// holds.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when the blur is less than half a px or more than a thousand, the area has a gradient, or nothing
    /// of it is left once it is rounded.
    pub fn blurred(self, blur: f32) -> Result<Self> {
        let refuse = |what: String| Err(Error::new(ErrorKind::Config, what));
        let [least, most] = BLURS;
        if !(least..=most).contains(&blur) {
            let range = format!("give {least} to {most}");
            return refuse(format!("a shadow has a blur of {blur} px: {range}"));
        }
        if self.shade.is_some() {
            return refuse("a shadow has a gradient: give one colour".into());
        }
        let blur = (blur * 100.0).round() / 100.0;
        match quantize::quantized_anywhere(&Mark::Area(self), PRECISION) {
            Some(Mark::Area(area)) => Ok(Self { blur, ..area }),
            _ => refuse("a shadow has nothing to be seen".into()),
        }
    }

    /// A box of whole px around all that is seen of it.
    pub(crate) fn extent(&self) -> Rect {
        let reach = REACH * f64::from(self.blur);
        let points = self.rings.iter().flat_map(Path::points);
        bounds(points.map(|p| p.at)).inflate(reach, reach).expand()
    }
}

impl Scene {
    /// The scene without a gradient of its page and without blurs: the things that shadows fall on are marks of a first stage.
    #[must_use]
    pub(crate) fn without_shadows(&self) -> Self {
        let size = [self.width, self.height];
        let is_thing = |area: &&Area| area.blur <= 0.0 && !area.is_page(size);
        let things: Stage = self.ground.iter().filter(is_thing).cloned().collect();
        let things = Some(things).filter(|stage| !stage.marks.is_empty());
        Self {
            ground: Vec::new(),
            stages: things
                .into_iter()
                .chain(self.stages.iter().cloned())
                .collect(),
            ..*self
        }
    }
}
