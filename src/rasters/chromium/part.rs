//! The parts of contours: lines and parabolas.

use crate::math::{Point, Vector};

/// A part of a contour, in the direction in which it is traced, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    Line([Point; 2]),
    /// Start, control point and end.
    Parabola([Point; 3]),
}

impl Part {
    /// Its ends and its control point.
    pub(super) fn points(&self) -> &[Point] {
        match self {
            Self::Line(points) => points,
            Self::Parabola(points) => points,
        }
    }

    pub(super) fn reversed(self) -> Self {
        match self {
            Self::Line([a, b]) => Self::Line([b, a]),
            Self::Parabola([a, c, b]) => Self::Parabola([b, c, a]),
        }
    }

    /// The part in px of a window with its corner at `origin`.
    pub(super) fn seen_from(self, origin: Vector) -> Self {
        match self {
            Self::Line(points) => Self::Line(points.map(|p| p - origin)),
            Self::Parabola(points) => Self::Parabola(points.map(|p| p - origin)),
        }
    }
}
