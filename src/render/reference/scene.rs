//! Drawings for the reference: strokes and scenes in `f64`.

use std::ops::Range;

use crate::math::{Point2, Vector2};
use crate::scene;
use crate::sdf::{Area, Flattened, Mean, Path, Polyline};

use super::super::paint::Paint;
use super::super::strokes::{PARAMS, STYLE, StrokeRef, Strokes, flatness};

/// A colour: three values, 0..1 in any sensible scene.
pub type Rgb = [f64; 3];

/// A path swept by a disc, in one colour.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stroke {
    /// The points of the centre line, px: x, y.
    pub points: Vec<[f64; 2]>,
    /// For each point, true if it is off the path, the control point of a curve.
    pub off: Vec<bool>,
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
            off: vec![false; 2],
            closed: false,
            rings: Vec::new(),
            radius,
            color: [red, green, blue],
            opacity,
            paint: None,
        }
    }

    /// The colour at `p`, and the opacity of the gradient there.
    pub(super) fn ink(&self, p: Point2<f64>) -> (Rgb, f64) {
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

    /// The path of some of the points as a polyline.
    fn flattened(&self, points: Range<usize>, closed: bool, radius: f64) -> Flattened<f64> {
        let path = Path {
            points: self.points[points.clone()]
                .iter()
                .map(|&p| p.into())
                .collect(),
            off: self.off[points].to_vec(),
            closed,
            radius,
            flatness: f64::from(flatness(self.opacity as f32)),
        };
        path.flattened()
    }

    /// The outline that the points draw.
    pub(super) fn shape(&self) -> Shape {
        if self.rings.is_empty() {
            let whole = self.flattened(0..self.points.len(), self.closed, self.radius);
            return Shape {
                outline: Outline::Path(whole.polyline),
                means: whole.means,
            };
        }
        let (mut polylines, mut means) = (Vec::new(), Vec::new());
        let mut start = 0;
        for &end in &self.rings {
            let ring = self.flattened(start..end, true, 0.0);
            polylines.push(ring.polyline);
            means.extend(ring.means.into_iter().map(|Mean(parts)| {
                let parts = parts.into_iter();
                Mean(parts.map(|(i, weight)| (start + i, weight)).collect())
            }));
            start = end;
        }
        Shape {
            outline: Outline::Area(Area { rings: polylines }),
            means,
        }
    }

    /// A stroke of the same kinds of points, all of whose numbers are 0.
    pub(super) fn zero(&self) -> Self {
        self.with_params(&vec![0.0; 2 * self.points.len() + STYLE])
    }
}

/// The outline that the points of a stroke draw, flattened.
pub(super) struct Shape {
    outline: Outline,
    /// The mean of points that each vertex is: of the path, or of all rings one after another.
    pub(super) means: Vec<Mean<f64>>,
}

enum Outline {
    Path(Polyline<f64>),
    Area(Area<f64>),
}

impl Shape {
    /// Signed distance from `p` to the edge in px, positive inside.
    pub(super) fn distance(&self, p: Point2<f64>, eps: f64) -> f64 {
        match &self.outline {
            Outline::Path(path) => path.distance(p, eps),
            Outline::Area(area) => area.distance(p, eps),
        }
    }

    /// The two vertices that move the edge near `p`, and the derivatives of the distance by them.
    pub(super) fn by_vertices(&self, p: Point2<f64>, eps: f64) -> [(usize, Vector2<f64>); 2] {
        let (first, ends, by_ends) = match &self.outline {
            Outline::Path(path) => {
                let jet = path.jet(p, eps);
                (0, jet.ends, jet.by_ends)
            }
            Outline::Area(area) => {
                let jet = area.jet(p, eps);
                let before = area.rings[..jet.ring].iter();
                (
                    before.map(|ring| ring.points.len()).sum(),
                    jet.ends,
                    jet.by_ends,
                )
            }
        };
        [0, 1].map(|i| (first + ends[i], by_ends[i]))
    }

    /// True for an area: coverage then is 1 where the distance is large enough, whatever its function has there.
    pub(super) fn is_area(&self) -> bool {
        matches!(self.outline, Outline::Area(_))
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
            off: stroke.off.to_vec(),
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
            off: vec![true, false, true, true, false],
            closed: true,
            ..Stroke::default()
        };
        let params: Vec<f64> = (0..15).map(f64::from).collect();
        let moved = spline.with_params(&params);
        assert_eq!(moved.to_params(), params);
        assert_eq!((&moved.off, moved.closed), (&spline.off, true));
    }
}
