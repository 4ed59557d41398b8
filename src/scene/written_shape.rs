//! Shapes with the numbers of their elements.

use super::grid::{Grid, MAX_PRECISION, UNITS_PER_PX};
use super::path::Path;
use super::shape::Shape;
use super::written_path::{WrittenPath, spacing, step};
use crate::math::Point;

/// A shape in units of 1/[`UNITS_PER_PX`] px, as its element has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum WrittenShape {
    /// Centre and radius.
    Circle([i64; 2], i64),
    /// Centre and radii.
    Ellipse([i64; 2], [i64; 2]),
    /// Corners of least and most x and y, and the radius of round corners.
    Rect([[i64; 2]; 2], i64),
}

impl WrittenShape {
    /// The shape of this path, rounded; `None` if it has none, or if nothing is left of it.
    pub(super) fn rounded(path: &Path, grid: &Grid) -> Option<Self> {
        let shape = Shape::of(path)?;
        // Points in `f32` tell a shape by a few units in their last place.
        let grid = grid.coarser(step(8.0 * spacing(path), grid));
        let units = |px: f32| grid.units(px.into());
        let place = |p: Point| [units(p.x), units(p.y)];
        let rounded = match shape {
            Shape::Circle { center, radius } => Self::Circle(place(center), units(radius)),
            Shape::Ellipse { center, radii } => match radii.map(units) {
                [x, y] if x == y => Self::Circle(place(center), x),
                radii => Self::Ellipse(place(center), radii),
            },
            Shape::Rect { low, high, radius } => {
                let (low, high) = (place(low), place(high));
                let side = [0, 1].map(|axis| high[axis] - low[axis]);
                let most = grid.below(side[0].min(side[1]) / 2);
                Self::Rect([low, high], units(radius).min(most))
            }
        };
        rounded.is_solid().then_some(rounded)
    }

    /// True if it has an inside, and its corners have room.
    pub(crate) fn is_solid(self) -> bool {
        match self {
            Self::Circle(_, radius) => radius > 0,
            Self::Ellipse(_, [x, y]) => x > 0 && y > 0 && x != y,
            Self::Rect([low, high], radius) => {
                radius >= 0 && (0..2).all(|axis| high[axis] - low[axis] >= (2 * radius).max(1))
            }
        }
    }

    /// The ring, as finely as a file could hold it.
    pub(crate) fn path(self) -> WrittenPath {
        WrittenPath::rounded(&self.ring(), &Grid::new(MAX_PRECISION))
    }

    /// The ring in px.
    pub(super) fn ring(self) -> Path {
        let px = |units: i64| (units as f64 / UNITS_PER_PX as f64) as f32;
        let point = |[x, y]: [i64; 2]| Point::new(px(x), px(y));
        match self {
            Self::Circle(center, radius) => Shape::circle(point(center), px(radius)),
            Self::Ellipse(center, radii) => Shape::ellipse(point(center), radii.map(px)),
            Self::Rect(corners, radius) => Shape::rect(corners.map(point), px(radius)),
        }
        .ring()
    }
}
