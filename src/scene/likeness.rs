//! Likeness: the shape that a closed path nearly is, or the part of it that is seen.

use kurbo::Rect;

use super::path::{Path, bounds};
use super::shape::Shape;
use crate::math::{self, Normal, Point, Vec2};

/// Farthest that chords are from the path, and that places along it are from each other, px.
const FLATNESS: f64 = 0.02;
const STEP: f64 = 0.5;

/// By how much a shape has to be nearer for each number more than another one, px: noise makes an ellipse or a rectangle with
/// round corners of every circle.
const PER_NUMBER: f64 = 0.1;

/// Narrower shapes have to be nearer by more, in inverse proportion, px: few pixels tell of a dot that it has no corners.
const SMALL: f64 = 6.0;

/// Narrowest that a shape is, in tolerances: a smaller path is near to shapes of any kind.
const LEAST_SIDE: f64 = 4.0;

/// Least share of a shape's outline that is seen where the rest may be anything. A guess.
const LEAST_SEEN: f64 = 0.4;

impl Shape {
    /// The nearest shape, if no place of this closed path is farther from it than `tolerance` px.
    pub(crate) fn like(path: &Path, tolerance: f64) -> Option<Self> {
        let chords = path.flattened(FLATNESS);
        let moments = Moments::of(&chords)?;
        let places = places(&chords);
        let shapes = moments.shapes(&chords).into_iter();
        let near = shapes.filter_map(|(shape, more)| {
            let away = |&p: &Point| shape.distance(p).abs();
            let away = places.iter().map(away).fold(0.0, f64::max);
            // A path that goes along a part of the shape, and back, encloses less.
            let is_whole = (shape.area() - moments.area).abs() <= tolerance * moments.length;
            let side = shape.least_side();
            let is_near = away <= tolerance && is_whole && side >= LEAST_SIDE * tolerance;
            let per_number = PER_NUMBER * (SMALL / side).max(1.0);
            is_near.then_some((away + more * per_number, shape))
        });
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, shape)| shape)
    }

    /// The shape that the seen part of a closed path nearly is, if the path has another part and no place of the seen one is
    /// farther from it than `tolerance` px. It has no round corners unless it is round.
    pub(crate) fn like_seen(
        path: &Path,
        tolerance: f64,
        is_seen: impl Fn(Point) -> bool,
    ) -> Option<Self> {
        let all = places(&path.flattened(FLATNESS));
        let seen: Vec<Point> = all.iter().copied().filter(|&p| is_seen(p)).collect();
        if seen.len() == all.len() {
            return None;
        }
        let seen_px = STEP * seen.len() as f64;
        let is_near = |shape: &Self| {
            let mut away = seen.iter().map(|&p| shape.distance(p).abs());
            let is_large = shape.least_side() >= LEAST_SIDE * tolerance;
            is_large && seen_px >= LEAST_SEEN * shape.length() && away.all(|px| px <= tolerance)
        };
        let shapes = [
            circle_through(&seen),
            box_around(&seen),
            ellipse_through(&seen),
        ];
        shapes.into_iter().flatten().find(is_near)
    }

    /// The lesser of width and height, px.
    fn least_side(&self) -> f64 {
        match *self {
            Self::Circle { radius, .. } => 2.0 * radius,
            Self::Ellipse { radii, .. } => 2.0 * radii[0].min(radii[1]),
            Self::Rect { low, high, .. } => (high - low).x.min((high - low).y),
        }
    }

    /// About how long the outline is, px.
    fn length(&self) -> f64 {
        use std::f64::consts::PI;
        match *self {
            Self::Circle { radius, .. } => 2.0 * PI * radius,
            Self::Ellipse { radii, .. } => PI * (radii[0] + radii[1]),
            Self::Rect { low, high, .. } => 2.0 * ((high - low).x + (high - low).y),
        }
    }

    /// About how far a point is from the outline, px, positive outside.
    fn distance(&self, p: Point) -> f64 {
        let (center, half, round) = match *self {
            Self::Circle { center, radius } => (center, [radius; 2], radius),
            Self::Rect { low, high, radius } => {
                let half = (high - low) * 0.5;
                (low + half, [half.x, half.y], radius)
            }
            Self::Ellipse { center, radii } => {
                // To first order: a level of the quadratic form, over its slope.
                let away = p - center;
                let level = Vec2::new(away.x / radii[0], away.y / radii[1]);
                let slope = Vec2::new(level.x / radii[0], level.y / radii[1]);
                return 0.5 * (level.hypot2() - 1.0) / slope.hypot().max(f64::MIN_POSITIVE);
            }
        };
        let away = p - center;
        let beyond = Vec2::new(
            away.x.abs() - half[0] + round,
            away.y.abs() - half[1] + round,
        );
        let outside = Vec2::new(beyond.x.max(0.0), beyond.y.max(0.0));
        // Distance to the box of the centres of the corners, less their radius; inside that box, to its nearest side.
        outside.hypot() + beyond.x.max(beyond.y).min(0.0) - round
    }

    /// The area inside, px².
    fn area(&self) -> f64 {
        use std::f64::consts::PI;
        match *self {
            Self::Circle { radius, .. } => PI * radius * radius,
            Self::Ellipse { radii, .. } => PI * radii[0] * radii[1],
            Self::Rect { low, high, radius } => {
                (high - low).x * (high - low).y - (4.0 - PI) * radius * radius
            }
        }
    }
}

/// The circle through places, by least squares of `x² + y² − 2 a x − 2 b y − c`.
fn circle_through(places: &[Point]) -> Option<Shape> {
    let (origin, [a, b, c]) = fitted(places, |x, y| ([2.0 * x, 2.0 * y, 1.0], x * x + y * y))?;
    let radius = (c + a * a + b * b).sqrt();
    let center = origin + Vec2::new(a, b);
    (radius > 0.0).then_some(Shape::Circle { center, radius })
}

/// The ellipse through places, by least squares of `x² + d y² − 2 a x − 2 b y − c`.
fn ellipse_through(places: &[Point]) -> Option<Shape> {
    let row = |x: f64, y: f64| ([2.0 * x, 2.0 * y, 1.0, -y * y], x * x);
    let (origin, [a, b, c, d]) = fitted(places, row)?;
    let square = c + a * a + b * b / d;
    let radii = [square, square / d].map(|square| square.sqrt());
    let center = origin + Vec2::new(a, b / d);
    let is_solid = radii.iter().all(|&radius| radius > 0.0);
    is_solid.then_some(Shape::Ellipse { center, radii })
}

/// The rectangle around places.
fn box_around(places: &[Point]) -> Option<Shape> {
    let Rect { x0, y0, x1, y1 } = bounds(places.iter().copied());
    let corners = [Point::new(x0, y0), Point::new(x1, y1)];
    (x1 > x0 && y1 > y0).then(|| Shape::rect(corners, 0.0))
}

/// The factors of the terms of `row` that meet its value best at all places, which are given from the origin, their mean.
fn fitted<const N: usize>(
    places: &[Point],
    row: impl Fn(f64, f64) -> ([f64; N], f64),
) -> Option<(Point, [f64; N])> {
    let count = places.len().max(1) as f64;
    let sum = places.iter().fold(Vec2::ZERO, |sum, p| sum + p.to_vec2());
    let origin = (sum / count).to_point();
    let mut equations = Normal::of(N);
    for p in places {
        let (terms, value) = row(p.x - origin.x, p.y - origin.y);
        let terms: [(usize, f64); N] = std::array::from_fn(|k| (k, terms[k]));
        equations.add(&terms, [value], 1.0);
    }
    let factors = equations.solve()?.into_flattened();
    Some((origin, factors.try_into().ok()?))
}

/// Integrals over the inside of a polygon.
struct Moments {
    /// Area, px², and length of the outline, px.
    area: f64,
    length: f64,
    center: Point,
    /// Standard deviations of x and y, px.
    spread: [f64; 2],
}

impl Moments {
    /// Those of the polygon with these corners; `None` if it has no inside.
    fn of(corners: &[Point]) -> Option<Self> {
        let origin = corners.first()?;
        let (mut area, mut length, mut first, mut second) = (0.0_f64, 0.0, [0.0; 2], [0.0; 2]);
        for pair in corners.windows(2) {
            let [a, b] = [0, 1].map(|i| pair[i] - *origin).map(|p| [p.x, p.y]);
            // Green's theorem: sums over triangles with the first corner, which keeps numbers small far from the page's origin.
            let cross = a[0] * b[1] - a[1] * b[0];
            area += cross / 2.0;
            length += math::hypot(b[0] - a[0], b[1] - a[1]);
            first = [0, 1].map(|k| first[k] + cross * (a[k] + b[k]) / 6.0);
            let square = |k: usize| a[k] * a[k] + a[k] * b[k] + b[k] * b[k];
            second = [0, 1].map(|k| second[k] + cross * square(k) / 12.0);
        }
        let mean = first.map(|sum| sum / area);
        // σ² = E[x²] − E[x]² over the inside.
        let spread = [0, 1].map(|k| (second[k] / area - mean[k] * mean[k]).sqrt());
        let center = Point::new(origin.x + mean[0], origin.y + mean[1]);
        let area = area.abs();
        let is_solid = area > 0.0 && spread.iter().all(|&px| px > 0.0);
        is_solid.then_some(Self {
            area,
            length,
            center,
            spread,
        })
    }

    /// The shapes of these moments, each with its numbers beyond the three of a circle.
    fn shapes(&self, corners: &[Point]) -> [(Shape, f64); 4] {
        use std::f64::consts::PI;
        let center = self.center;
        let radius = (self.area / PI).sqrt();
        // Inside an ellipse the standard deviation along an axis is half the radius; inside a rectangle, half the side over √3.
        let radii = self.spread.map(|px| 2.0 * px);
        let [dx, dy] = self.spread.map(|px| px * 3.0_f64.sqrt());
        let away = Vec2::new(dx, dy);
        let sharp = Shape::rect([center - away, center + away], 0.0);
        // Round corners take (4 − π)r² from the box.
        let around = bounds(corners.iter().copied());
        let missing = (around.area() - self.area).max(0.0);
        let most = 0.5 * around.width().min(around.height());
        let radius_of_corners = (missing / (4.0 - PI)).sqrt().min(most);
        let corners = [around.origin(), Point::new(around.x1, around.y1)];
        let round = Shape::rect(corners, radius_of_corners);
        [
            (Shape::Circle { center, radius }, 0.0),
            (sharp, 1.0),
            (Shape::Ellipse { center, radii }, 1.0),
            (round, 2.0),
        ]
    }
}

/// Places along the polyline through these corners.
fn places(corners: &[Point]) -> Vec<Point> {
    let along = |pair: &[Point]| {
        let (from, step) = (pair[0], pair[1] - pair[0]);
        let count = (step.hypot() / STEP).ceil().max(1.0) as u16;
        (0..count).map(move |i| from + step * (f64::from(i) / f64::from(count)))
    };
    corners.windows(2).flat_map(along).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::PathPoint;

    fn shapes() -> [Shape; 4] {
        let (low, high) = (Point::new(10.5, 20.25), Point::new(44.0, 41.5));
        let center = Point::new(30.2, 31.7);
        [
            Shape::Circle {
                center,
                radius: 14.3,
            },
            Shape::Ellipse {
                center,
                radii: [8.5, 15.0],
            },
            Shape::Rect {
                low,
                high,
                radius: 0.0,
            },
            Shape::Rect {
                low,
                high,
                radius: 6.2,
            },
        ]
    }

    /// The path, begun elsewhere, with each point somewhat beside its place.
    fn beside(path: &Path, by: f64) -> Path {
        let mut points: Vec<PathPoint> = path.points().to_vec();
        points.rotate_left(1);
        for (i, point) in points.iter_mut().enumerate() {
            let (sin, cos) = math::sin_cos(2.0 * i as f64);
            point.at += Vec2::new(by * sin, by * cos);
        }
        Path::new(points, true).unwrap()
    }

    #[test]
    fn a_path_beside_a_shape_is_like_it() {
        for shape in shapes() {
            let found = Shape::like(&beside(&shape.path(), 0.1), 0.3).unwrap();
            let kind = std::mem::discriminant(&shape);
            assert_eq!(std::mem::discriminant(&found), kind, "{found:?}");
            let outline = places(&shape.path().flattened(FLATNESS));
            assert!(
                outline.iter().all(|&p| found.distance(p).abs() < 0.3),
                "{found:?}"
            );
        }
    }

    #[test]
    fn the_seen_part_of_a_path_tells_its_shape() {
        for shape in &shapes()[..3] {
            // What lies to the left of x = 26 is hidden, and runs anyhow.
            let points = beside(&shape.path(), 0.03);
            let free = |p: Point| {
                if p.x < 26.0 {
                    Point::new(26.0 - 0.5 * (26.0 - p.x), p.y)
                } else {
                    p
                }
            };
            let path = points.map(free);
            let found = Shape::like_seen(&path, 0.3, |p| p.x > 27.0).unwrap();
            assert_eq!(
                std::mem::discriminant(&found),
                std::mem::discriminant(shape)
            );
            assert_eq!(Shape::like_seen(&path, 0.3, |_| true), None);
        }
    }

    #[test]
    fn what_is_no_shape_is_like_none() {
        let drop = [(0.0, 0.0), (20.0, 4.0), (24.0, 20.0), (3.0, 18.0)];
        let drop = drop.map(|(x, y)| PathPoint::off(Point::new(x, y)));
        let drop = Path::new(drop.to_vec(), true).unwrap();
        assert_eq!(Shape::like(&drop, 0.3), None);
        let line = Path::line(Point::new(1.0, 2.0), Point::new(9.0, 2.0));
        assert_eq!(Shape::like(&line, 0.3), None);
    }
}
