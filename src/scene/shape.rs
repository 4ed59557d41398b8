//! Shapes: closed paths that SVG has elements for, circles, ellipses and rectangles, parallel to the axes.
//!
//! A path *is* a shape if its points are those of [`Shape::ring`]. So nothing has to say that it is one: a descent that
//! moves its points makes it a path like any other, unless it puts them back with [`Shape::restore`].
//!
//! Along each axis, a point of a ring lies at a *side* of the shape plus its radius times a number that depends on the kind
//! of ring alone. So the nearest shape to moved points is a linear regression.

use std::f64::consts::FRAC_PI_2;

use super::path::{Path, PathPoint};
use super::written_path::spacing;
use crate::math::{self, Point};

/// A closed path with an element of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// `<circle>`: centre and radius, px.
    Circle {
        /// Its centre, px.
        center: Point,
        /// Its radius, px.
        radius: f32,
    },
    /// `<ellipse>`.
    Ellipse {
        /// Its centre, px.
        center: Point,
        /// Its radii along x and y, px.
        radii: [f32; 2],
    },
    /// `<rect>`.
    Rect {
        /// The corner of least x and y, px.
        low: Point,
        /// The opposite corner, px.
        high: Point,
        /// The radius of round corners, px; 0 for sharp ones.
        radius: f32,
    },
}

/// Control points of a quarter turn; the fewest that suffice are taken.
const QUARTERS: [usize; 4] = [2, 4, 8, 16];

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
    is_on: bool,
}

impl Shape {
    /// The closed path of the shape's element; its curves bulge by 0.02 px at most.
    pub fn ring(&self) -> Path {
        let radius = match *self {
            Self::Circle { radius, .. } | Self::Rect { radius, .. } => f64::from(radius),
            Self::Ellipse { radii: [x, y], .. } => f64::from(x.max(y)),
        };
        let bulge = |quarter: usize| radius * math::powi(half_angle(quarter), 4) / 8.0;
        let quarter = QUARTERS.into_iter().find(|&n| bulge(n) <= BULGE);
        let places = self.places(quarter.unwrap_or(16));
        let points = places.iter().map(|place| PathPoint {
            at: self.at(place),
            is_on: place.is_on,
        });
        Path::of_valid(points.collect(), true)
    }

    /// The shape that this path is the ring of.
    pub fn of(path: &Path) -> Option<Self> {
        if !path.is_closed() {
            return None;
        }
        let at: Vec<Point> = path.points().iter().map(|p| p.at).collect();
        let (zero, count) = (Point::origin(), at.len());
        let round = [Self::circle(zero, 0.0), Self::ellipse(zero, [0.0; 2])];
        let round = round.map(|kind| (kind, count / 4));
        let rect = (Self::rect([zero; 2], 1.0), count.saturating_sub(8) / 4);
        let kinds = round.into_iter().chain([rect]);
        let mut kinds = kinds.filter(|(_, quarter)| QUARTERS.contains(quarter));
        let shape = kinds.find_map(|(kind, quarter)| {
            let places = kind.places(quarter);
            let kept = path.points().iter().map(|p| p.is_on);
            if !kept.eq(places.iter().map(|place| place.is_on)) {
                return None;
            }
            let shape = kind.nearest(&at, &places)?;
            let away = |(p, place): (&Point, &Place)| (shape.at(place) - *p).abs().max();
            let is_exact = at
                .iter()
                .zip(&places)
                .all(|pair| away(pair) <= 2.0 * spacing(path));
            is_exact.then_some(shape)
        });
        shape.or_else(|| sharp(path))
    }

    /// Moves the points of this shape's ring, each a little beside its place, to those of the nearest shape of its kind.
    pub(crate) fn restore(&self, points: &mut [[f32; 2]]) {
        let places = self.places_of(points.len());
        if let Some(shape) = self.nearest(&of_arrays(points), &places) {
            put(points, shape.frame(), &places);
        }
    }

    /// Leaves of a change of this shape's points the part that keeps the shape: the change of its sides and radii.
    pub(crate) fn project(&self, change: &mut [[f32; 2]]) {
        let places = self.places_of(change.len());
        // Points depend on sides and radii linearly.
        let frame = self.nearest_frame(&of_arrays(change), &places);
        put(change, frame, &places);
    }

    /// The places of a ring of so many points.
    fn places_of(&self, count: usize) -> Vec<Place> {
        let corners = match self {
            Self::Rect { radius, .. } if *radius > 0.0 => 8,
            _ => 0,
        };
        self.places((count - corners) / 4)
    }

    pub(super) fn circle(center: Point, radius: f32) -> Self {
        Self::Circle { center, radius }
    }

    pub(super) fn ellipse(center: Point, radii: [f32; 2]) -> Self {
        Self::Ellipse { center, radii }
    }

    pub(super) fn rect([low, high]: [Point; 2], radius: f32) -> Self {
        Self::Rect { low, high, radius }
    }

    /// The places of all points of a ring with this many control points for each quarter turn.
    fn places(&self, quarter: usize) -> Vec<Place> {
        match self {
            Self::Rect { radius, .. } => {
                let is_round = *radius > 0.0;
                let corner = |turn: usize| {
                    let is_high = [turn == 3 || turn == 0, turn < 2];
                    let sign = is_high.map(|is_high| if is_high { 1.0 } else { -1.0 });
                    let place = move |(direction, is_on): ([f64; 2], bool)| Place {
                        is_high,
                        factors: [0, 1].map(|axis| direction[axis] - sign[axis]),
                        is_on,
                    };
                    let ends = [0.0, 1.0].map(|share| (turned(turn, share, 1.0), true));
                    let [start, end] = ends.map(|end| vec![end]);
                    let arc = arc(turn, quarter).map(|direction| (direction, false));
                    let points = match is_round {
                        true => [start, arc.collect(), end].concat(),
                        false => vec![(sign, true)],
                    };
                    points.into_iter().map(place)
                };
                let mut places: Vec<Place> = CORNERS.into_iter().flat_map(corner).collect();
                // A `<rect>` begins behind its first corner.
                places.rotate_right(1);
                places
            }
            _ => {
                let arcs = TURNS.into_iter().flat_map(|turn| arc(turn, quarter));
                let place = |factors| Place {
                    is_high: [false; 2],
                    factors,
                    is_on: false,
                };
                arcs.map(place).collect()
            }
        }
    }

    /// Where a place is, px.
    fn at(&self, place: &Place) -> Point {
        self.frame().at(place)
    }

    fn frame(&self) -> Frame {
        let (sides, radii) = match *self {
            Self::Circle { center, radius } => ([center; 2], [radius; 2]),
            Self::Ellipse { center, radii } => ([center; 2], radii),
            Self::Rect { low, high, radius } => ([low, high], [radius; 2]),
        };
        Frame { sides, radii }
    }

    /// The sides and radii of the shape of this kind that is nearest to points at these places, by least squares.
    fn nearest_frame(&self, at: &[Point], places: &[Place]) -> Frame {
        let group = |axis: usize, is_high: bool| -> Vec<[f64; 2]> {
            let points = at.iter().zip(places);
            points
                .filter(|(_, place)| place.is_high[axis] == is_high)
                .map(|(p, place)| [place.factors[axis], p[axis].into()])
                .collect()
        };
        let [low_x, low_y, high_x, high_y] =
            [(0, false), (1, false), (0, true), (1, true)].map(|(axis, high)| group(axis, high));
        let point = |x: f32, y: f32| Point::new(x, y);
        let (sides, radii) = match self {
            Self::Circle { .. } => {
                let (center, radius) = regression(&[low_x, low_y]);
                ([point(center[0], center[1]); 2], [radius; 2])
            }
            Self::Ellipse { .. } => {
                let [(x, x_radius), (y, y_radius)] =
                    [low_x, low_y].map(|group| regression(&[group]));
                ([point(x[0], y[0]); 2], [x_radius, y_radius])
            }
            Self::Rect { .. } => {
                let (sides, radius) = regression(&[low_x, low_y, high_x, high_y]);
                let corners = [point(sides[0], sides[1]), point(sides[2], sides[3])];
                (corners, [radius; 2])
            }
        };
        Frame { sides, radii }
    }

    /// The shape of this kind with these sides and radii; `None` if it would be empty.
    fn framed(&self, frame: Frame) -> Option<Self> {
        let ([low, high], radii) = (frame.sides, frame.radii);
        match *self {
            Self::Circle { .. } => (radii[0] > 0.0).then(|| Self::circle(low, radii[0])),
            Self::Ellipse { .. } => {
                let is_solid = radii.iter().all(|&radius| radius > 0.0);
                is_solid.then(|| Self::ellipse(low, radii))
            }
            Self::Rect { radius: round, .. } => {
                let side = (high - low).min();
                let radius = match round > 0.0 {
                    true => radii[0].clamp(0.0, (0.5 * side).max(0.0)),
                    false => 0.0,
                };
                let is_solid = side > 0.0 && (radius > 0.0) == (round > 0.0);
                is_solid.then(|| Self::rect([low, high], radius))
            }
        }
    }

    /// The shape of this kind that is nearest to points at these places, by least squares; `None` if it would be empty.
    fn nearest(&self, at: &[Point], places: &[Place]) -> Option<Self> {
        self.framed(self.nearest_frame(at, places))
    }
}

/// The numbers that the points of a ring follow from.
#[derive(Debug, Clone, Copy)]
struct Frame {
    /// The sides of least and of most x and y; twice the centre of a round shape.
    sides: [Point; 2],
    /// The radii along x and y.
    radii: [f32; 2],
}

impl Frame {
    fn at(&self, place: &Place) -> Point {
        let at = |axis: usize| {
            let side = self.sides[usize::from(place.is_high[axis])][axis];
            (f64::from(side) + f64::from(self.radii[axis]) * place.factors[axis]) as f32
        };
        Point::new(at(0), at(1))
    }
}

fn of_arrays(points: &[[f32; 2]]) -> Vec<Point> {
    points.iter().map(|&p| p.into()).collect()
}

/// Puts points where these places of a frame are.
fn put(points: &mut [[f32; 2]], frame: Frame, places: &[Place]) {
    for (point, place) in points.iter_mut().zip(places) {
        *point = frame.at(place).into();
    }
}

/// The rectangle with these corners, in either sense.
fn sharp(path: &Path) -> Option<Shape> {
    let [a, b, c, d] = path.points() else {
        return None;
    };
    let is_level = |p: &PathPoint, q: &PathPoint, axis: usize| p.at[axis] == q.at[axis];
    let is_along = |axis: usize| {
        let other = 1 - axis;
        is_level(a, b, axis)
            && is_level(c, d, axis)
            && is_level(b, c, other)
            && is_level(d, a, other)
    };
    let corners = [a.at.inf(&c.at), a.at.sup(&c.at)];
    let is_solid = (corners[1] - corners[0]).min() > 0.0;
    let is_rect = path.points().iter().all(|p| p.is_on) && (is_along(0) || is_along(1));
    (is_rect && is_solid).then_some(Shape::rect(corners, 0.0))
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
    let length = 1.0 / math::sin_cos(half_angle(quarter)).1;
    (0..quarter).map(move |i| turned(turn, (i as f64 + 0.5) / quarter as f64, length))
}

/// The sides, one for each group of pairs of a factor and a coordinate, and the one slope of all groups.
fn regression(groups: &[Vec<[f64; 2]>]) -> (Vec<f32>, f32) {
    let mean = |group: &[[f64; 2]], k: usize| {
        group.iter().map(|pair| pair[k]).sum::<f64>() / group.len().max(1) as f64
    };
    let (mut along, mut square) = (0.0, 0.0);
    for group in groups {
        let (factor, at) = (mean(group, 0), mean(group, 1));
        for pair in group {
            along += (pair[0] - factor) * (pair[1] - at);
            square += (pair[0] - factor) * (pair[0] - factor);
        }
    }
    let slope = if square > 0.0 { along / square } else { 0.0 };
    let side = |group: &Vec<[f64; 2]>| (mean(group, 1) - slope * mean(group, 0)) as f32;
    (groups.iter().map(side).collect(), slope as f32)
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

    #[test]
    fn a_ring_is_its_shape_and_a_moved_one_is_none() {
        for shape in shapes() {
            let ring = shape.ring();
            let found = Shape::of(&ring).unwrap();
            assert_eq!(
                std::mem::discriminant(&found),
                std::mem::discriminant(&shape)
            );
            let away = |(a, b): (&PathPoint, &PathPoint)| (a.at - b.at).abs().max();
            let found = found.ring();
            let pairs = found.points().iter().zip(ring.points());
            assert!(pairs.map(away).all(|px| px < 1e-4), "{found:?}");
            let mut points = ring.points().to_vec();
            points[1].at.x += 0.01;
            assert_eq!(Shape::of(&Path::new(points, true).unwrap()), None);
        }
    }

    #[test]
    fn a_ring_of_moved_points_is_restored_to_the_nearest_one() {
        for shape in &shapes()[..3] {
            let ring = shape.ring();
            let mut points: Vec<[f32; 2]> = ring.points().iter().map(|p| p.at.into()).collect();
            for (i, point) in points.iter_mut().enumerate() {
                let (sin, cos) = math::sin_cos(2.0 * i as f32);
                *point = [point[0] + 0.1 * sin, point[1] + 0.1 * cos];
            }
            shape.restore(&mut points);
            let restored = ring.points().iter().zip(&points);
            let restored = restored.map(|(p, &at)| PathPoint {
                at: at.into(),
                ..*p
            });
            let restored = Path::new(restored.collect(), true).unwrap();
            let found = Shape::of(&restored).unwrap();
            assert_eq!(
                std::mem::discriminant(&found),
                std::mem::discriminant(shape)
            );
            let pairs = restored.points().iter().zip(ring.points());
            assert!(
                pairs
                    .into_iter()
                    .all(|(a, b)| (a.at - b.at).abs().max() < 0.06)
            );
        }
    }

    #[test]
    fn what_keeps_a_shape_is_left_of_a_change() {
        for shape in &shapes()[..3] {
            let ring = shape.ring();
            let points: Vec<[f32; 2]> = ring.points().iter().map(|p| p.at.into()).collect();
            let change = |i: usize| <[f32; 2]>::from(math::sin_cos(5.0 * i as f32));
            let mut left: Vec<[f32; 2]> = (0..points.len()).map(change).collect();
            shape.project(&mut left);
            // Once more changes nothing, and the rest is at a right angle to it.
            let mut again = left.clone();
            shape.project(&mut again);
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
            shape.restore(&mut restored);
            let pairs = moved.iter().flatten().zip(restored.iter().flatten());
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-3));
        }
    }

    #[test]
    fn corners_make_a_rectangle_in_either_sense() {
        let corners = [[1.0, 2.0], [9.0, 2.0], [9.0, 7.5], [1.0, 7.5]];
        let rect = Shape::rect([corners[0].into(), corners[2].into()], 0.0);
        for turn in 0..4 {
            let mut points = corners.map(|p| PathPoint::on(p.into())).to_vec();
            points.rotate_left(turn);
            assert_eq!(Shape::of(&Path::of_valid(points.clone(), true)), Some(rect));
            points.reverse();
            assert_eq!(Shape::of(&Path::of_valid(points.clone(), true)), Some(rect));
            assert_eq!(Shape::of(&Path::of_valid(points.clone(), false)), None);
            points[0].at.x += 0.1;
            assert_eq!(Shape::of(&Path::of_valid(points, true)), None);
        }
    }
}
