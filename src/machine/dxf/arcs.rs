//! Arcs along a quadratic curve.
//!
//! The circle through the incentre of a curve's three points that has the curve's direction at its start, and the one that has
//! it at its end, meet in the incentre without a corner (a biarc). Where they are too far from the curve, its halves get
//! two each.

use kurbo::{ParamCurve, Point, QuadBez, Vec2};

use crate::math;

/// A corner of a polyline, and the way to the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Vertex {
    /// In mm.
    pub(super) at: Point,
    /// Tangent of a quarter of the arc's angle, positive to the left; 0 for a line.
    pub(super) bulge: f64,
}

/// Most times that a curve is halved.
pub(super) const DEEPEST: u32 = 8;

/// Appends arcs at most `tolerance` away from a curve, without its end. The curve is halved `depth` times at most.
pub(super) fn push(out: &mut Vec<Vertex>, curve: QuadBez, tolerance: f64, depth: u32) {
    let QuadBez {
        p0: a,
        p1: c,
        p2: b,
    } = curve;
    if is_flat(curve, tolerance) {
        out.push(Vertex { at: a, bulge: 0.0 });
        return;
    }
    let center = incenter(curve);
    // The first arc starts in the curve's direction, from a to c, and ends in the incentre.
    let first = bulge(c - a, center - a);
    // The second arc, seen from its end, turns the other way.
    let second = -bulge(c - b, center - b);
    let is_near = (1..8).all(|eighths| {
        let p = curve.eval(f64::from(eighths) / 8.0);
        gap(p, a, center, first).min(gap(p, center, b, second)) <= tolerance
    });
    if is_near || depth == 0 {
        out.extend([(a, first), (center, second)].map(|(at, bulge)| Vertex { at, bulge }));
        return;
    }
    let (start, end) = curve.subdivide();
    push(out, start, tolerance, depth - 1);
    push(out, end, tolerance, depth - 1);
}

/// Kurbo's length depends on the platform.
fn length(v: Vec2) -> f64 {
    math::hypot(v.x, v.y)
}

/// True if a line is as near to the curve, whose control point lies between its ends.
fn is_flat(curve: QuadBez, tolerance: f64) -> bool {
    let (chord, knee) = (curve.p2 - curve.p0, curve.p1 - curve.p0);
    let side = length(chord);
    // The curve is half as far away as its control point. A tenth of the tolerance keeps curves from becoming lines.
    chord.cross(knee).abs() <= 0.2 * tolerance * side
        && (0.0..=side * side).contains(&chord.dot(knee))
}

/// The centre of the circle that touches the three sides of a curve's points.
fn incenter(QuadBez { p0, p1, p2 }: QuadBez) -> Point {
    let sides = [length(p2 - p1), length(p2 - p0), length(p1 - p0)];
    let sum: f64 = sides.iter().sum();
    let corners = [p0, p1, p2].map(Point::to_vec2).into_iter().zip(sides);
    let weighted = corners.fold(Vec2::ZERO, |sum, (corner, side)| sum + corner * side);
    (weighted / sum.max(f64::MIN_POSITIVE)).to_point()
}

/// The bulge of an arc that starts in a direction and whose chord has another: the tangent of half the angle between.
fn bulge(direction: Vec2, chord: Vec2) -> f64 {
    let whole = length(direction) * length(chord) + direction.dot(chord);
    if whole > 0.0 {
        direction.cross(chord) / whole
    } else {
        0.0
    }
}

/// Distance of a place from the circle of an arc.
fn gap(p: Point, a: Point, b: Point, bulge: f64) -> f64 {
    let chord = b - a;
    let side = length(chord).max(f64::MIN_POSITIVE);
    let along = (p - a).dot(chord) / side;
    if !(-0.01 * side..=1.01 * side).contains(&along) {
        return f64::INFINITY;
    }
    // Positive to the right of the chord, where an arc with a positive bulge lies.
    let right = (p - a).cross(chord) / side;
    if bulge.abs() < 1e-9 {
        return right.abs();
    }
    // The height of the arc is bulge × side / 2, and its radius side (1 + bulge²) / (4 bulge).
    let radius = side * (1.0 + bulge * bulge) / (4.0 * bulge);
    let height = bulge * side / 2.0;
    let center = height - radius;
    (math::hypot(along - side / 2.0, right - center) - radius.abs()).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The arcs of a curve, with its end.
    fn arcs(points: [[f64; 2]; 3]) -> (QuadBez, Vec<Vertex>) {
        let [a, b, c] = points.map(|[x, y]| Point::new(x, y));
        let curve = QuadBez::new(a, b, c);
        let mut out = Vec::new();
        push(&mut out, curve, 0.01, DEEPEST);
        out.push(Vertex {
            at: curve.p2,
            bulge: 0.0,
        });
        (curve, out)
    }

    #[test]
    fn arcs_are_near_their_curve_and_meet_without_a_corner() {
        for curve in [
            [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]],
            [[0.0, 0.0], [3.0, 9.0], [12.0, 2.0]],
            [[5.0, 5.0], [-4.0, 6.0], [5.5, 6.5]],
        ] {
            let (curve, arcs) = arcs(curve);
            assert!(arcs.len() > 2 && arcs.len() < 40, "{}", arcs.len());
            for i in 0..=100 {
                let p = curve.eval(f64::from(i) / 100.0);
                let gaps = arcs
                    .windows(2)
                    .map(|w| gap(p, w[0].at, w[1].at, w[0].bulge));
                assert!(gaps.fold(f64::INFINITY, f64::min) < 0.012);
            }
            for w in arcs.windows(3) {
                // The direction at the end of an arc is its chord turned on by half its angle.
                let turned = |v: Vec2, bulge: f64, on: f64| {
                    let (sin, cos) = math::sin_cos(on * 2.0 * math::atan(bulge));
                    Vec2::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos)
                };
                let end = turned(w[1].at - w[0].at, w[0].bulge, 1.0);
                let start = turned(w[2].at - w[1].at, w[1].bulge, -1.0);
                let sin = end.cross(start) / length(end) / length(start);
                assert!(sin.abs() < 1e-6, "{sin}");
            }
        }
    }

    #[test]
    fn a_straight_curve_is_a_line() {
        let (_, arcs) = arcs([[0.0, 0.0], [4.0, 0.0], [10.0, 0.0]]);
        assert_eq!(arcs.len(), 2);
        assert_eq!(arcs[0].bulge, 0.0);
    }
}
