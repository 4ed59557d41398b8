//! The drawing: a [`Scene`] of [`Stroke`]s, back to front, grouped in [`Stage`]s.
//!
//! Coordinates are in px, with pixel centres at +0.5. Colours are sRGB-encoded, 0..1, and are composited in
//! that encoding, as SVG renderers do.

mod overlap;
mod quantize;

use crate::math::Point;

pub use quantize::{Dropped, MAX_PRECISION, MIN_WIDTH, Quantized};
pub(crate) use quantize::{UNITS_PER_PX, Written, color, quantum};

/// An sRGB-encoded colour, 0..1 per channel.
pub type Rgb = [f32; 3];

/// The centre line of a stroke: a polyline of one point (a dot) or two (a capsule).
///
/// Code outside the renderer uses [`points`](Self::points) and makes no assumption about their number, so
/// longer polylines need changes only here and in the renderer.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A disc: one point.
    Dot([Point; 1]),
    /// A line segment with round caps: two points.
    Capsule([Point; 2]),
}

impl Shape {
    /// A disc centred on `p`.
    pub fn dot(p: Point) -> Self {
        Self::Dot([p])
    }

    /// A capsule from `a` to `b`.
    pub fn capsule(a: Point, b: Point) -> Self {
        Self::Capsule([a, b])
    }

    /// The points of the centre line, in drawing order; never empty.
    pub fn points(&self) -> &[Point] {
        match self {
            Self::Dot(p) => p,
            Self::Capsule(p) => p,
        }
    }

    /// First and last point; the same for a dot.
    pub fn ends(&self) -> (Point, Point) {
        match *self {
            Self::Dot([p]) => (p, p),
            Self::Capsule([a, b]) => (a, b),
        }
    }

    /// The same shape with `f` applied to every point.
    #[must_use]
    pub fn map(self, f: impl Fn(Point) -> Point) -> Self {
        match self {
            Self::Dot(p) => Self::Dot(p.map(f)),
            Self::Capsule(p) => Self::Capsule(p.map(f)),
        }
    }
}

/// One stroke: a shape swept by a disc, in one colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// The centre line, px.
    pub shape: Shape,
    /// Half the stroke width, px.
    pub radius: f32,
    /// sRGB-encoded colour, 0..1.
    pub color: Rgb,
    /// 0 (invisible) to 1 (opaque).
    pub opacity: f32,
}

impl Stroke {
    /// Whether every number of the stroke is finite.
    pub fn is_finite(&self) -> bool {
        self.shape
            .points()
            .iter()
            .all(|p| p.x.is_finite() && p.y.is_finite())
            && self.radius.is_finite()
            && self.color.iter().all(|c| c.is_finite())
            && self.opacity.is_finite()
    }
}

/// Strokes that were added together: a layer of the SVG.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stage {
    /// Back to front.
    pub strokes: Vec<Stroke>,
}

/// A drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Width in px, at least 1.
    pub width: u32,
    /// Height in px, at least 1.
    pub height: u32,
    /// The colour behind all strokes; `None` if the drawing is transparent.
    pub background: Option<Rgb>,
    /// Back to front.
    pub stages: Vec<Stage>,
}

impl Scene {
    /// A scene without strokes.
    pub fn empty(width: u32, height: u32, background: Option<Rgb>) -> Self {
        Self {
            width,
            height,
            background,
            stages: Vec::new(),
        }
    }

    /// All strokes, back to front.
    pub fn strokes(&self) -> impl Iterator<Item = &Stroke> {
        self.stages.iter().flat_map(|stage| &stage.strokes)
    }

    /// Number of strokes.
    pub fn len(&self) -> usize {
        self.stages.iter().map(|stage| stage.strokes.len()).sum()
    }

    /// Whether the scene has no stroke.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
