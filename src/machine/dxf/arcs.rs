//! Arcs along a quadratic curve.
//!
//! The circle through the incentre of a curve's three points that has the curve's direction at its start, and the one that has
//! it at its end, meet in the incentre without a corner (a biarc). Where they are too far from the curve, its halves get
//! two each.

use crate::math;

/// A place, mm.
type Place = [f64; 2];

/// A corner of a polyline, and the way to the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Vertex {
    pub(super) at: Place,
    /// Tangent of a quarter of the arc's angle, positive to the left; 0 for a line.
    pub(super) bulge: f64,
}

/// Most times that a curve is halved.
const DEEPEST: u32 = 8;

/// Appends arcs at most `tolerance` away from a curve, without its end.
pub(super) fn push(out: &mut Vec<Vertex>, curve: [Place; 3], tolerance: f64) {
    halve(out, curve, tolerance, DEEPEST);
}

fn halve(out: &mut Vec<Vertex>, curve: [Place; 3], tolerance: f64, depth: u32) {
    let [a, c, b] = curve;
    let middle = along(curve, 0.5);
    if is_flat(curve, tolerance) {
        out.push(Vertex { at: a, bulge: 0.0 });
        return;
    }
    let center = incenter(curve);
    // The first arc starts in the curve's direction, from a to c, and ends in the incentre.
    let first = bulge(from(a, c), from(a, center));
    // The second arc, seen from its end, turns the other way.
    let second = -bulge(from(b, c), from(b, center));
    let is_near = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875]
        .iter()
        .all(|&t| {
            let p = along(curve, t);
            let gap = gap(p, a, center, first).min(gap(p, center, b, second));
            gap <= tolerance
        });
    if is_near || depth == 0 {
        out.push(Vertex {
            at: a,
            bulge: first,
        });
        out.push(Vertex {
            at: center,
            bulge: second,
        });
        return;
    }
    let half = |p: Place, q: Place| [0, 1].map(|k| f64::midpoint(p[k], q[k]));
    // De Casteljau at ½: both halves are quadratic curves again.
    halve(out, [a, half(a, c), middle], tolerance, depth - 1);
    halve(out, [middle, half(c, b), b], tolerance, depth - 1);
}

/// The place at `t` of a curve.
fn along([a, c, b]: [Place; 3], t: f64) -> Place {
    let u = 1.0 - t;
    [0, 1].map(|k| u * u * a[k] + 2.0 * u * t * c[k] + t * t * b[k])
}

fn from(a: Place, b: Place) -> Place {
    [b[0] - a[0], b[1] - a[1]]
}

fn length([x, y]: Place) -> f64 {
    math::hypot(x, y)
}

/// True if a line is as near to the curve, whose control point lies between its ends.
fn is_flat([a, c, b]: [Place; 3], tolerance: f64) -> bool {
    let (chord, knee) = (from(a, b), from(a, c));
    let side = length(chord);
    let (across, ahead) = (
        chord[0] * knee[1] - chord[1] * knee[0],
        chord[0] * knee[0] + chord[1] * knee[1],
    );
    // The curve is half as far away as its control point. A tenth of the tolerance keeps curves from becoming lines.
    across.abs() <= 0.2 * tolerance * side && (0.0..=side * side).contains(&ahead)
}

/// The centre of the circle that touches the three sides.
fn incenter([a, c, b]: [Place; 3]) -> Place {
    let sides = [length(from(c, b)), length(from(a, b)), length(from(a, c))];
    let sum: f64 = sides.iter().sum();
    [0, 1]
        .map(|k| (sides[0] * a[k] + sides[1] * c[k] + sides[2] * b[k]) / sum.max(f64::MIN_POSITIVE))
}

/// The bulge of an arc that starts in a direction and whose chord has another: the tangent of half the angle between.
fn bulge(direction: Place, chord: Place) -> f64 {
    let cross = direction[0] * chord[1] - direction[1] * chord[0];
    let dot = direction[0] * chord[0] + direction[1] * chord[1];
    let whole = length(direction) * length(chord) + dot;
    if whole > 0.0 { cross / whole } else { 0.0 }
}

/// Distance of a place from the circle of an arc.
fn gap(p: Place, a: Place, b: Place, bulge: f64) -> f64 {
    let chord = from(a, b);
    let side = length(chord).max(f64::MIN_POSITIVE);
    let away = from(a, p);
    let along = (away[0] * chord[0] + away[1] * chord[1]) / side;
    if !(-0.01 * side..=1.01 * side).contains(&along) {
        return f64::INFINITY;
    }
    // Positive to the right of the chord, where an arc with a positive bulge lies.
    let right = (away[0] * chord[1] - away[1] * chord[0]) / side;
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
    fn arcs(curve: [Place; 3]) -> Vec<Vertex> {
        let mut out = Vec::new();
        push(&mut out, curve, 0.01);
        out.push(Vertex {
            at: curve[2],
            bulge: 0.0,
        });
        out
    }

    #[test]
    fn arcs_are_near_their_curve_and_meet_without_a_corner() {
        for curve in [
            [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]],
            [[0.0, 0.0], [3.0, 9.0], [12.0, 2.0]],
            [[5.0, 5.0], [-4.0, 6.0], [5.5, 6.5]],
        ] {
            let arcs = arcs(curve);
            assert!(arcs.len() > 2 && arcs.len() < 40, "{}", arcs.len());
            for i in 0..=100 {
                let p = along(curve, f64::from(i) / 100.0);
                let gaps = arcs
                    .windows(2)
                    .map(|w| gap(p, w[0].at, w[1].at, w[0].bulge));
                assert!(gaps.fold(f64::INFINITY, f64::min) < 0.012);
            }
            for w in arcs.windows(3) {
                // The direction at the end of an arc is its chord turned on by half its angle.
                let turned = |v: Place, bulge: f64, on: f64| {
                    let (sin, cos) = math::sin_cos(on * 2.0 * math::atan(bulge));
                    [v[0] * cos - v[1] * sin, v[0] * sin + v[1] * cos]
                };
                let end = turned(from(w[0].at, w[1].at), w[0].bulge, 1.0);
                let start = turned(from(w[1].at, w[2].at), w[1].bulge, -1.0);
                let sin = (end[0] * start[1] - end[1] * start[0]) / length(end) / length(start);
                assert!(sin.abs() < 1e-6, "{sin}");
            }
        }
    }

    #[test]
    fn a_straight_curve_is_a_line() {
        let arcs = arcs([[0.0, 0.0], [4.0, 0.0], [10.0, 0.0]]);
        assert_eq!(arcs.len(), 2);
        assert_eq!(arcs[0].bulge, 0.0);
    }
}
