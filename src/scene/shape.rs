//! Shapes: closed paths that SVG has elements for, circles, ellipses and rectangles, parallel to the axes.
//!
//! A path says that it is a shape if it was made by [`Shape::path`]; see [`Path::shape`].
//!
//! Along each axis, a point of that path lies at a *side* of the shape plus its radius times a number that depends on the
//! kind of shape and the number of points alone. So the nearest shape to moved points is a linear regression.

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use super::grid::{Grid, units};
use super::piece::PointKind;
use crate::math::{self, Point, Vec2};

/// A closed path with an element of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// `<circle>`: centre and radius, px.
    Circle {
        /// Its centre, px.
        center: Point,
        /// Its radius, px.
        radius: f64,
    },
    /// `<ellipse>`.
    Ellipse {
        /// Its centre, px.
        center: Point,
        /// Its radii along x and y, px.
        radii: [f64; 2],
    },
    /// `<rect>`.
    Rect {
        /// The corner of least x and y, px.
        low: Point,
        /// The opposite corner, px.
        high: Point,
        /// The radius of round corners, px; 0 for sharp ones.
        radius: f64,
    },
}

/// Control points of a quarter turn; the fewest that suffice are taken.
const QUARTERS: [usize; 4] = [2, 4, 8, 16];

/// Farthest that the points of a shape are from their places, px: more than single precision takes from a page of 8,192 px, and less
/// than half of what a file's second decimal tells.
pub(super) const EXACT: f64 = 1e-3;

/// Farthest that a ring bulges from its shape, px.
const BULGE: f64 = 0.02;

/// The quarter turns in the order of a ring: of a circle from its rightmost point, and of a rectangle's corners, clockwise
/// as SVG draws both.
const TURNS: [usize; 4] = [0, 1, 2, 3];
const CORNERS: [usize; 4] = [3, 0, 1, 2];

/// Where a point of a ring lies: at these sides, of less or more x and y, plus the radii times these factors.
#[derive(Debug, Clone, Copy)]
struct Place {
    is_high: [bool; 2],
    factors: [f64; 2],
    kind: PointKind,
}

impl Shape {
    /// The points of the shape's path, px, and their kinds; the curves bulge by 0.02 px at most.
    pub(super) fn points(self) -> impl Iterator<Item = (Point, PointKind)> {
        let radius = match self {
            Self::Circle { radius, .. } | Self::Rect { radius, .. } => radius,
            Self::Ellipse { radii: [x, y], .. } => x.max(y),
        };
        // The fewest control points whose curves stay within the tolerance; their error falls with the fourth power of the angle.
        let bulge = |quarter: usize| radius * math::powi(half_angle(quarter), 4) / 8.0;
        let quarter = QUARTERS.into_iter().find(|&n| bulge(n) <= BULGE);
        let places = self.kind().places(quarter.unwrap_or(16));
        let frame = self.frame();
        places
            .into_iter()
            .map(move |place| (frame.at(&place), place.kind))
    }

    /// The shape with its numbers on the `grid`; `None` if nothing is left of it.
    pub(super) fn rounded(self, grid: &Grid) -> Option<Self> {
        let rounded = match self {
            Self::Circle { center, radius } => Self::circle(grid.point(center), grid.round(radius)),
            Self::Ellipse { center, radii } => match radii.map(|px| grid.round(px)) {
                // Rounding may make the radii equal; the file has one element for that.
                [x, y] if x == y => Self::circle(grid.point(center), x),
                radii => Self::ellipse(grid.point(center), radii),
            },
            Self::Rect { low, high, radius } => {
                let (low, high) = (grid.point(low), grid.point(high));
                let side = high - low;
                // Rounded corners may not be larger than half of the rounded sides.
                let most = grid.below(0.5 * side.x.min(side.y));
                Self::rect([low, high], grid.round(radius).min(most))
            }
        };
        rounded.is_solid().then_some(rounded)
    }

    /// True if it has an inside, and its corners have room.
    pub(crate) fn is_solid(&self) -> bool {
        match *self {
            Self::Circle { radius, .. } => radius > 0.0,
            Self::Ellipse { radii: [x, y], .. } => x > 0.0 && y > 0.0 && x != y,
            Self::Rect { low, high, radius } => {
                let side = high - low;
                let least = units(2.0 * radius).max(1);
                radius >= 0.0 && units(side.x.min(side.y)) >= least
            }
        }
    }

    pub(crate) fn circle(center: Point, radius: f64) -> Self {
        Self::Circle { center, radius }
    }

    pub(crate) fn ellipse(center: Point, radii: [f64; 2]) -> Self {
        Self::Ellipse { center, radii }
    }

    pub(crate) fn rect([low, high]: [Point; 2], radius: f64) -> Self {
        Self::Rect { low, high, radius }
    }

    /// This shape, moved.
    pub(super) fn moved(self, by: Vec2) -> Self {
        match self {
            Self::Circle { center, radius } => Self::circle(center + by, radius),
            Self::Ellipse { center, radii } => Self::ellipse(center + by, radii),
            Self::Rect { low, high, radius } => Self::rect([low + by, high + by], radius),
        }
    }

    /// Its kind.
    pub(crate) fn kind(&self) -> ShapeKind {
        match self {
            Self::Circle { .. } => ShapeKind::Circle,
            Self::Ellipse { .. } => ShapeKind::Ellipse,
            Self::Rect { radius: 0.0, .. } => ShapeKind::Rect,
            Self::Rect { .. } => ShapeKind::RoundRect,
        }
    }

    fn frame(&self) -> Frame {
        let (sides, radii) = match *self {
            Self::Circle { center, radius } => ([center; 2], [radius; 2]),
            Self::Ellipse { center, radii } => ([center; 2], radii),
            Self::Rect { low, high, radius } => ([low, high], [radius; 2]),
        };
        Frame { sides, radii }
    }
}

/// A kind of shape: the linear map from its sides and radii to the points of its path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ShapeKind {
    /// `<circle>`.
    Circle,
    /// `<ellipse>`.
    Ellipse,
    /// `<rect>` with sharp corners.
    Rect,
    /// `<rect>` with round corners.
    RoundRect,
}

impl ShapeKind {
    /// The shape of this kind that is nearest to the points of its path, each a little beside its place, by least squares;
    /// `None` if it would be empty.
    pub(crate) fn nearest(self, points: &[[f32; 2]]) -> Option<Shape> {
        let Frame { sides, radii } = self.nearest_frame(points, &self.places_of(points.len()));
        let [low, high] = sides;
        let side = high - low;
        let shape = match self {
            Self::Circle => Shape::circle(low, radii[0]),
            Self::Ellipse => Shape::ellipse(low, radii),
            Self::Rect => Shape::rect(sides, 0.0),
            Self::RoundRect => Shape::rect(sides, radii[0].min(0.5 * side.x.min(side.y))),
        };
        let is_solid = match self {
            Self::Circle | Self::Ellipse => radii[0] > 0.0 && radii[1] > 0.0,
            Self::Rect => side.x > 0.0 && side.y > 0.0,
            Self::RoundRect => radii[0] > 0.0 && side.x > 0.0 && side.y > 0.0,
        };
        is_solid.then_some(shape)
    }

    /// Moves points to the points of the nearest shape of this kind.
    pub(crate) fn restore(self, points: &mut [[f32; 2]]) {
        if let Some(shape) = self.nearest(points) {
            put(points, shape.frame(), &self.places_of(points.len()));
        }
    }

    /// Projects a change of a shape's points onto the changes that keep the shape: of its sides and radii.
    pub(crate) fn project(self, change: &mut [[f32; 2]]) {
        let places = self.places_of(change.len());
        // Points depend on sides and radii linearly.
        let frame = self.nearest_frame(change, &places);
        put(change, frame, &places);
    }

    /// The shape whose path has these points, each with its kind, as exactly as single precision gives them.
    pub(super) fn shape_of(points: &[(Point, PointKind)]) -> Option<Shape> {
        let at: Vec<[f32; 2]> = points.iter().map(|(p, _)| math::xy(*p)).collect();
        let exactly = |kind: Self| {
            let quarter = points.len().checked_sub(kind.ends())? / 4;
            let places = QUARTERS.contains(&quarter).then(|| kind.places(quarter))?;
            let shape = kind.nearest(&at).filter(|_| places.len() == at.len())?;
            let is_exact = |((p, kind), place): (&(Point, PointKind), &Place)| {
                let away = shape.frame().at(place) - *p;
                *kind == place.kind && away.x.abs().max(away.y.abs()) < EXACT
            };
            points.iter().zip(&places).all(is_exact).then_some(shape)
        };
        [Self::Circle, Self::Ellipse, Self::RoundRect]
            .into_iter()
            .find_map(exactly)
    }

    /// The places of a path of so many points.
    fn places_of(self, count: usize) -> Vec<Place> {
        self.places((count - self.ends()) / 4)
    }

    /// Number of points where the sides of a round rectangle end.
    fn ends(self) -> usize {
        if self == Self::RoundRect { 8 } else { 0 }
    }

    /// The places of all points of a path with this many control points for each quarter turn.
    fn places(self, quarter: usize) -> Vec<Place> {
        match self {
            Self::Circle | Self::Ellipse => {
                let arcs = TURNS.into_iter().flat_map(|turn| arc(turn, quarter));
                let place = |factors| Place {
                    is_high: [false; 2],
                    factors,
                    kind: PointKind::Quad,
                };
                arcs.map(place).collect()
            }
            Self::Rect | Self::RoundRect => {
                let corner = |turn: usize| {
                    let is_high = [turn == 3 || turn == 0, turn < 2];
                    let sign = is_high.map(|is_high| if is_high { 1.0 } else { -1.0 });
                    let place = move |(direction, kind): ([f64; 2], PointKind)| Place {
                        is_high,
                        factors: [0, 1].map(|axis| direction[axis] - sign[axis]),
                        kind,
                    };
                    let ends = [0.0, 1.0].map(|share| (turned(turn, share, 1.0), PointKind::On));
                    let [start, end] = ends.map(|end| vec![end]);
                    let arc = arc(turn, quarter).map(|direction| (direction, PointKind::Quad));
                    let points = match self {
                        Self::RoundRect => [start, arc.collect(), end].concat(),
                        _ => vec![(sign, PointKind::On)],
                    };
                    points.into_iter().map(place)
                };
                let mut places: Vec<Place> = CORNERS.into_iter().flat_map(corner).collect();
                // A `<rect>` begins behind its first corner.
                places.rotate_right(1);
                places
            }
        }
    }

    /// The sides and radii of the shape of this kind that is nearest to points at these places, by least squares.
    fn nearest_frame(self, at: &[[f32; 2]], places: &[Place]) -> Frame {
        let group = |axis: usize, is_high: bool| -> Vec<[f64; 2]> {
            let points = at.iter().zip(places);
            points
                .filter(|(_, place)| place.is_high[axis] == is_high)
                .map(|(p, place)| [place.factors[axis], p[axis].into()])
                .collect()
        };
        let [low_x, low_y, high_x, high_y] =
            [(0, false), (1, false), (0, true), (1, true)].map(|(axis, high)| group(axis, high));
        let (sides, radii) = match self {
            Self::Circle => {
                let (center, radius) = regression(&[low_x, low_y]);
                ([Point::new(center[0], center[1]); 2], [radius; 2])
            }
            Self::Ellipse => {
                let [(x, x_radius), (y, y_radius)] =
                    [low_x, low_y].map(|group| regression(&[group]));
                ([Point::new(x[0], y[0]); 2], [x_radius, y_radius])
            }
            Self::Rect | Self::RoundRect => {
                let (sides, radius) = regression(&[low_x, low_y, high_x, high_y]);
                let low = Point::new(sides[0], sides[1]);
                ([low, Point::new(sides[2], sides[3])], [radius; 2])
            }
        };
        Frame { sides, radii }
    }
}

/// The numbers that the points of a ring follow from.
#[derive(Debug, Clone, Copy)]
struct Frame {
    /// The sides of least and of most x and y; twice the centre of a round shape.
    sides: [Point; 2],
    /// The radii along x and y.
    radii: [f64; 2],
}

impl Frame {
    fn at(&self, place: &Place) -> Point {
        let [x, y] = place
            .is_high
            .map(|is_high| self.sides[usize::from(is_high)]);
        let [dx, dy] = [0, 1].map(|axis| self.radii[axis] * place.factors[axis]);
        Point::new(x.x + dx, y.y + dy)
    }
}

/// Puts points where these places of a frame are.
fn put(points: &mut [[f32; 2]], frame: Frame, places: &[Place]) {
    for (point, place) in points.iter_mut().zip(places) {
        *point = math::xy(frame.at(place));
    }
}

/// Half the angle that one control point of a quarter turn stands for.
fn half_angle(quarter: usize) -> f64 {
    0.5 * FRAC_PI_2 / quarter as f64
}

/// The direction at this share of quarter turn `turn`, with a length.
fn turned(turn: usize, share: f64, length: f64) -> [f64; 2] {
    let (sin, cos) = match share {
        0.0 => (0.0, 1.0),
        1.0 => (1.0, 0.0),
        share => math::sin_cos(share * FRAC_PI_2),
    };
    let [x, y] = [length * cos, length * sin];
    match turn {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    }
}

/// The control points of a quarter turn around the origin, of radius 1.
fn arc(turn: usize, quarter: usize) -> impl Iterator<Item = [f64; 2]> {
    // Midpoints of neighbouring control points, where the curves meet, then lie on the unit circle.
    let length = 1.0 / math::sin_cos(half_angle(quarter)).1;
    (0..quarter).map(move |i| turned(turn, (i as f64 + 0.5) / quarter as f64, length))
}

/// The sides, one for each group of pairs of a factor and a coordinate, and the one slope of all groups.
fn regression(groups: &[Vec<[f64; 2]>]) -> (Vec<f64>, f64) {
    let mean = |group: &[[f64; 2]], k: usize| {
        group.iter().map(|pair| pair[k]).sum::<f64>() / group.len().max(1) as f64
    };
    // Each group has its own intercept, a side, and all have one slope, the radius: centred by group, it is the pooled slope.
    let (mut along, mut square) = (0.0, 0.0);
    for group in groups {
        let (factor, at) = (mean(group, 0), mean(group, 1));
        for pair in group {
            along += (pair[0] - factor) * (pair[1] - at);
            square += (pair[0] - factor) * (pair[0] - factor);
        }
    }
    let slope = if square > 0.0 { along / square } else { 0.0 };
    let side = |group: &Vec<[f64; 2]>| mean(group, 1) - slope * mean(group, 0);
    (groups.iter().map(side).collect(), slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> [Shape; 4] {
        let (low, high) = (Point::new(10.5, 20.25), Point::new(94.0, 61.5));
        let center = Point::new(30.25, 31.5);
        [
            Shape::circle(center, 14.25),
            Shape::ellipse(center, [68.5, 150.0]),
            Shape::rect([low, high], 6.5),
            Shape::rect([low, high], 0.0),
        ]
    }

    /// The points of a shape's path, as a descent has them.
    fn points(shape: Shape) -> Vec<[f32; 2]> {
        let path = shape.path();
        path.points().iter().map(|p| math::xy(p.at)).collect()
    }

    #[test]
    fn the_nearest_shape_to_the_points_of_a_shape_is_that_shape() {
        for shape in shapes() {
            let found = shape.kind().nearest(&points(shape)).unwrap();
            let pairs = points(found)
                .into_iter()
                .flatten()
                .zip(points(shape).into_iter().flatten());
            assert!(
                pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-4),
                "{found:?}"
            );
        }
    }

    #[test]
    fn moved_points_are_restored_to_the_nearest_shape() {
        for shape in &shapes()[..3] {
            let mut moved = points(*shape);
            for (i, point) in moved.iter_mut().enumerate() {
                let (sin, cos) = math::sin_cos(2.0 * i as f32);
                *point = [point[0] + 0.1 * sin, point[1] + 0.1 * cos];
            }
            shape.kind().restore(&mut moved);
            let restored = points(shape.kind().nearest(&moved).unwrap());
            let pairs = moved.iter().flatten().zip(restored.iter().flatten());
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-4));
            let own = points(*shape);
            let pairs = moved.iter().flatten().zip(own.iter().flatten());
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 0.06));
        }
    }

    #[test]
    fn what_keeps_a_shape_is_left_of_a_change() {
        for shape in &shapes()[..3] {
            let (kind, points) = (shape.kind(), points(*shape));
            let change = |i: usize| <[f32; 2]>::from(math::sin_cos(5.0 * i as f32));
            let mut left: Vec<[f32; 2]> = (0..points.len()).map(change).collect();
            kind.project(&mut left);
            // Once more changes nothing, and the rest is at a right angle to it.
            let mut again = left.clone();
            kind.project(&mut again);
            let pairs = || left.iter().flatten().zip(again.iter().flatten());
            assert!(pairs().all(|(a, b)| (a - b).abs() < 1e-5));
            let rest = (0..points.len())
                .flat_map(change)
                .zip(left.iter().flatten());
            let dot: f32 = rest.map(|(all, left)| (all - left) * left).sum();
            assert!(dot.abs() < 1e-4, "{dot}");
            let moved = points.iter().zip(&left);
            let moved: Vec<[f32; 2]> = moved
                .map(|(p, by)| [0, 1].map(|k| p[k] + 0.1 * by[k]))
                .collect();
            let mut restored = moved.clone();
            kind.restore(&mut restored);
            let pairs = moved.iter().flatten().zip(restored.iter().flatten());
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-3));
        }
    }
}
