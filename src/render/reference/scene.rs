//! Drawings for the reference: strokes and scenes in `f64`.

use kurbo::Point;

use super::outline::{Knots, Outline};
use crate::scene::{self, PointKind};

use super::super::paint::Paint;
use super::super::strokes::{PARAMS, STYLE, StrokeRef, Strokes, flatness};

/// A colour: three values, 0..1 in any sensible scene.
pub type Rgb = [f64; 3];

/// A path swept by a disc, in one colour.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stroke {
    /// The points of the centre line, px: x, y.
    pub points: Vec<[f64; 2]>,
    /// The kind of each point.
    pub kinds: Vec<PointKind>,
    /// True if the last point is joined to the first.
    pub closed: bool,
    /// For an area, the index behind the last point of each of its rings; none for a stroke.
    pub rings: Vec<usize>,
    /// Half the stroke width, px; without a meaning for an area.
    pub radius: f64,
    /// sRGB-encoded.
    pub color: Rgb,
    /// 0..1.
    pub opacity: f64,
    /// The gradient that an area is filled with instead of its colour, by which nothing is derived.
    pub paint: Option<Paint>,
}

impl Stroke {
    /// The capsule of `[a.x, a.y, b.x, b.y, radius, red, green, blue, opacity]`.
    pub fn capsule([ax, ay, bx, by, radius, red, green, blue, opacity]: [f64; PARAMS]) -> Self {
        Self {
            points: vec![[ax, ay], [bx, by]],
            kinds: vec![PointKind::On; 2],
            closed: false,
            rings: Vec::new(),
            radius,
            color: [red, green, blue],
            opacity,
            paint: None,
        }
    }

    /// The colour at `p`, and the opacity of the gradient there.
    pub(super) fn ink(&self, p: Point) -> (Rgb, f64) {
        let Some(paint) = &self.paint else {
            return (self.color, 1.0);
        };
        let (color, opacity) = paint.at([p.x as f32, p.y as f32]);
        (color.map(f64::from), f64::from(opacity))
    }

    /// The numbers of the stroke, in the order of [`Strokes`]: x and y of its points, then radius, red, green, blue, opacity.
    pub fn to_params(&self) -> Vec<f64> {
        let [red, green, blue] = self.color;
        let style = [self.radius, red, green, blue, self.opacity];
        [self.points.as_flattened(), &style].concat()
    }

    /// A stroke of the same kinds of points with these numbers, as many as [`to_params`](Self::to_params) gives.
    #[must_use]
    pub fn with_params(&self, params: &[f64]) -> Self {
        let (points, style) = params.split_at(2 * self.points.len());
        let &[radius, red, green, blue, opacity] =
            style.first_chunk().unwrap_or(&[f64::NAN; STYLE]);
        Self {
            points: points.as_chunks().0.to_vec(),
            radius,
            color: [red, green, blue],
            opacity,
            ..self.clone()
        }
    }

    /// The outline that the points draw.
    pub(in crate::render) fn outline(&self) -> Outline {
        let knots = Knots {
            points: &self.points,
            kinds: &self.kinds,
            closed: self.closed,
        };
        let flatness = f64::from(flatness(self.opacity as f32));
        if self.rings.is_empty() {
            Outline::path(knots, self.radius, flatness)
        } else {
            Outline::area(knots, &self.rings, flatness)
        }
    }

    /// A stroke of the same kinds of points, all of whose numbers are 0.
    pub(super) fn zero(&self) -> Self {
        self.with_params(&vec![0.0; 2 * self.points.len() + STYLE])
    }
}

/// A drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Columns of pixels.
    pub width: usize,
    /// Rows of pixels.
    pub height: usize,
    /// The colour behind all strokes.
    pub background: Rgb,
    /// Back to front.
    pub strokes: Vec<Stroke>,
}

/// A missing background becomes white.
impl From<&scene::Scene> for Scene {
    fn from(scene: &scene::Scene) -> Self {
        let strokes: Strokes = scene.marks().collect();
        Self {
            width: scene.width as usize,
            height: scene.height as usize,
            background: scene.background.unwrap_or([1.0; 3]).map(f64::from),
            strokes: strokes.iter().map(Stroke::from).collect(),
        }
    }
}

impl From<StrokeRef<'_>> for Stroke {
    fn from(stroke: StrokeRef<'_>) -> Self {
        Self {
            points: stroke.points.iter().map(|p| p.map(f64::from)).collect(),
            kinds: stroke.kinds.to_vec(),
            closed: stroke.closed,
            rings: stroke.rings.iter().map(|&end| end as usize).collect(),
            radius: f64::from(stroke.radius()),
            color: stroke.color().map(f64::from),
            opacity: f64::from(stroke.opacity()),
            paint: stroke.paint.cloned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn params_are_a_strokes_numbers() {
        let params = std::array::from_fn(|k| k as f64);
        assert_eq!(Stroke::capsule(params).to_params(), params);
        let spline = Stroke {
            points: vec![[0.0; 2]; 5],
            kinds: [false, true, false, false, true]
                .map(PointKind::on_if)
                .to_vec(),
            closed: true,
            ..Stroke::default()
        };
        let params: Vec<f64> = (0..15).map(f64::from).collect();
        let moved = spline.with_params(&params);
        assert_eq!(moved.to_params(), params);
        assert_eq!((&moved.kinds, moved.closed), (&spline.kinds, true));
    }
}
