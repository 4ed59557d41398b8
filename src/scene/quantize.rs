//! What an SVG can say of a stroke: decimals of a fixed number of places, 8-bit colour and opacity.
//!
//! [`Written`] is a stroke in exactly those integers. Scenes are quantised, SVG is written and SVG
//! is read through it alone, so that reading back what was written gives the quantised scene to
//! the bit.

use super::{Rgb, Scene, Shape, Stage, Stroke};
use crate::math::Point;

/// Most decimals of a coordinate or width.
pub const MAX_PRECISION: u8 = 6;

/// Narrowest stroke, px. Rasterisers of the Skia family draw a width of 1 px or less as a
/// modulated hairline, with the wrong ink on diagonals; wider by too little, and rounding would
/// fall back to it.
pub const MIN_WIDTH: f64 = 1.02;

/// Farthest that a coordinate may lie from the origin, px; all decimals up to here are exact.
const MAX_COORDINATE: f32 = 1e9;

/// Parts of a px in which [`Written`] counts.
pub(crate) const UNITS_PER_PX: i64 = 10_i64.pow(MAX_PRECISION as u32);

impl Scene {
    /// The scene as its SVG of `precision` decimals (at most [`MAX_PRECISION`]) says it, and how
    /// many strokes were dropped.
    ///
    /// Coordinates and widths are rounded, widths kept at [`MIN_WIDTH`] or more; colours and
    /// opacities become multiples of 1/255; a shape shorter than the precision becomes a dot.
    /// Dropped are strokes that are not finite, absurdly far away, of no width, of an opacity that
    /// rounds to 0, or wholly off the page (judged by their bounding box).
    pub fn quantized(&self, precision: u8) -> (Self, usize) {
        let stages: Vec<_> = self
            .stages
            .iter()
            .map(|stage| self.quantized_stage(stage, precision))
            .collect();
        let scene = Self {
            background: self.background.map(quantized_color),
            stages,
            ..*self
        };
        let dropped = self.len() - scene.len();
        (scene, dropped)
    }

    fn quantized_stage(&self, stage: &Stage, precision: u8) -> Stage {
        let written = stage
            .strokes
            .iter()
            .filter_map(|stroke| Written::new(stroke, self, precision));
        Stage {
            strokes: written.map(|w| w.stroke()).collect(),
        }
    }
}

/// A stroke in the integers that its SVG element is made of.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Written {
    /// Corners of the centre line in units of 1/[`UNITS_PER_PX`] px; neighbours differ; one makes
    /// a dot.
    pub(crate) points: Vec<[i64; 2]>,
    /// Width in the same units.
    pub(crate) width: i64,
    /// 8-bit red, green and blue.
    pub(crate) color: [u8; 3],
    /// Opacity in 1/255, never 0.
    pub(crate) opacity: u8,
}

impl Written {
    /// The stroke rounded to `precision` decimals, or `None` where nothing of it would be seen on
    /// the page of `scene`.
    pub(crate) fn new(stroke: &Stroke, scene: &Scene, precision: u8) -> Option<Self> {
        let written = Self::anywhere(stroke, precision)?;
        written
            .touches(scene.width, scene.height)
            .then_some(written)
    }

    /// The stroke rounded to `precision` decimals, wherever it lies.
    pub(crate) fn anywhere(stroke: &Stroke, precision: u8) -> Option<Self> {
        let far = |p: &Point| p.x.abs() > MAX_COORDINATE || p.y.abs() > MAX_COORDINATE;
        let absurd = stroke.radius > MAX_COORDINATE || stroke.shape.points().iter().any(far);
        if !stroke.is_finite() || absurd || stroke.radius <= 0.0 {
            return None;
        }
        let grid = Grid::new(precision);
        let mut points: Vec<_> = stroke
            .shape
            .points()
            .iter()
            .map(|p| [p.x, p.y].map(|v| grid.units(v.into())))
            .collect();
        points.dedup();
        let width = grid
            .units(2.0 * f64::from(stroke.radius))
            .max(grid.min_width());
        let opacity = quantum(stroke.opacity);
        (opacity > 0).then(|| Self {
            points,
            width,
            color: stroke.color.map(quantum),
            opacity,
        })
    }

    /// Whether the bounding box reaches into a page of this size.
    fn touches(&self, width: u32, height: u32) -> bool {
        let reach = self.width / 2;
        [width, height].iter().enumerate().all(|(axis, &side)| {
            let along = || self.points.iter().map(|p| p[axis]);
            let far_end = along().max().unwrap_or(0) + reach;
            let near_end = along().min().unwrap_or(0) - reach;
            far_end > 0 && near_end < i64::from(side) * UNITS_PER_PX
        })
    }

    /// The stroke that is written.
    pub(crate) fn stroke(&self) -> Stroke {
        let point = |p: &[i64; 2]| Point::new(px(p[0]), px(p[1]));
        let shape = match self.points.as_slice() {
            [a, .., b] => Shape::capsule(point(a), point(b)),
            [a] => Shape::dot(point(a)),
            [] => Shape::dot(Point::origin()),
        };
        Stroke {
            shape,
            radius: (self.width as f64 / (2 * UNITS_PER_PX) as f64) as f32,
            color: color(self.color),
            opacity: f32::from(self.opacity) / 255.0,
        }
    }
}

/// The multiples of 10^−precision px.
struct Grid {
    /// 10^precision, at most 10^6.
    per_px: i64,
}

impl Grid {
    fn new(precision: u8) -> Self {
        Self {
            per_px: 10_i64.pow(precision.min(MAX_PRECISION).into()),
        }
    }

    /// The nearest multiple to `px`, in units.
    fn units(&self, px: f64) -> i64 {
        (px * self.per_px as f64).round() as i64 * (UNITS_PER_PX / self.per_px)
    }

    /// The least multiple that is no less than [`MIN_WIDTH`], in units.
    fn min_width(&self) -> i64 {
        (MIN_WIDTH * self.per_px as f64).ceil() as i64 * (UNITS_PER_PX / self.per_px)
    }
}

/// Units as px. One division and one rounding: the nearest `f32` to the decimal that is written.
fn px(units: i64) -> f32 {
    (units as f64 / UNITS_PER_PX as f64) as f32
}

/// The nearest of 0..=255 to a value of 0..1.
pub(crate) fn quantum(value: f32) -> u8 {
    (value * 255.0 + 0.5) as u8
}

/// The colour that 8-bit channels stand for.
pub(crate) fn color(channels: [u8; 3]) -> Rgb {
    channels.map(|c| f32::from(c) / 255.0)
}

fn quantized_color(rgb: Rgb) -> Rgb {
    color(rgb.map(quantum))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stroke(shape: Shape) -> Stroke {
        Stroke {
            shape,
            radius: 2.0,
            color: [0.2, 0.5, 1.0],
            opacity: 1.0,
        }
    }

    fn capsule(a: [f32; 2], b: [f32; 2]) -> Stroke {
        stroke(Shape::capsule(a.into(), b.into()))
    }

    fn scene(strokes: Vec<Stroke>) -> Scene {
        Scene {
            stages: vec![Stage { strokes }],
            ..Scene::empty(20, 10, None)
        }
    }

    fn quantized(stroke: Stroke, precision: u8) -> Option<Stroke> {
        scene(vec![stroke])
            .quantized(precision)
            .0
            .strokes()
            .next()
            .copied()
    }

    #[test]
    fn coordinates_and_widths_are_rounded() {
        let mut s = capsule([1.2345, 2.0], [-0.004, 3.999]);
        s.radius = 1.114;
        let q = quantized(s, 2).unwrap();
        assert_eq!(q.shape, capsule([1.23, 2.0], [0.0, 4.0]).shape);
        assert_eq!(q.radius, 1.115, "the width 2.228 becomes 2.23");
    }

    #[test]
    fn no_width_is_rounded_to_a_hairline() {
        let thin = Stroke {
            radius: 0.1,
            ..capsule([1.0, 1.0], [5.0, 5.0])
        };
        let radii = [0, 1, 2, 3, 9].map(|precision| quantized(thin, precision).unwrap().radius);
        assert_eq!(radii, [1.0, 0.55, 0.51, 0.51, 0.51]);
    }

    #[test]
    fn a_shape_shorter_than_the_precision_becomes_a_dot() {
        let q = quantized(capsule([1.001, 2.0], [1.004, 2.003]), 2).unwrap();
        assert_eq!(q.shape, Shape::dot(Point::new(1.0, 2.0)));
    }

    #[test]
    fn colours_and_opacity_become_multiples_of_1_in_255() {
        let mut s = capsule([1.0, 1.0], [5.0, 5.0]);
        s.color = [0.5, -3.0, 9.0];
        s.opacity = 0.3;
        let q = quantized(s, 2).unwrap();
        assert_eq!(
            (q.color, q.opacity),
            ([128.0 / 255.0, 0.0, 1.0], 77.0 / 255.0)
        );
        let ground = Scene::empty(1, 1, Some([0.5; 3])).quantized(2).0.background;
        assert_eq!(ground, Some([128.0 / 255.0; 3]));
    }

    #[test]
    fn what_cannot_be_seen_is_dropped_and_counted() {
        let seen = capsule([1.0, 1.0], [5.0, 5.0]);
        let strokes = vec![
            seen,
            Stroke {
                opacity: 0.001,
                ..seen
            },
            Stroke {
                opacity: f32::NAN,
                ..seen
            },
            Stroke {
                radius: 0.0,
                ..seen
            },
            Stroke {
                color: [f32::INFINITY; 3],
                ..seen
            },
            capsule([-9.0, 5.0], [-2.5, 5.0]),
            capsule([5.0, 12.5], [9.0, 12.5]),
            capsule([5.0, 1.0], [5.0, 3e9]),
            capsule([f32::NAN, 1.0], [5.0, 3.0]),
        ];
        let (kept, dropped) = scene(strokes).quantized(2);
        assert_eq!((kept.len(), dropped), (1, 8));
    }

    #[test]
    fn what_reaches_into_the_page_is_kept() {
        assert!(quantized(capsule([-9.0, 5.0], [-1.9, 5.0]), 2).is_some());
        assert!(quantized(capsule([-100.0, 5.0], [100.0, 5.0]), 2).is_some());
    }
}
