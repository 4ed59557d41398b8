//! Vertices along circular arcs.
//!
//! With the points of the plane as complex numbers, the circle through `a`, `m` and `b` is what a Möbius transformation makes of
//! the real line:
//!
//! ```text
//! z(u, v) = (u·w₀·a + v·w₁·b) / (u·w₀ + v·w₁)        w₀ = b − m        w₁ = m − a
//! ```
//!
//! so `z(1, 0) = a`, `z(1, 1) = m` and `z(0, 1) = b`. The weights `u` and `v` of the vertices are chosen so that these are at about
//! equal angles, and are then held fixed, as those of the vertices of a Bézier curve are. So the derivatives by the three points
//! are complex numbers, too, and the one of the loss by a point is their conjugate times that by the vertex.
//!
//! Degenerate cases: an arc without a [bulge](Arc::bulge) is the line between its ends.

use std::f64::consts::PI;

use super::strokes::{MAX_STEPS, steps_at_most};
use crate::math::{self, Vec2};
use crate::scene::Arc;

/// Angles in half a turn that the angle of the weights is one of, and ratios in an octave that theirs is one of. In between the
/// weights don't change, so the derivatives are exact there.
const ANGLES: f64 = 32.0;
const RATIOS: f64 = 8.0;

/// How vertices are spread along an arc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    /// Number of segments.
    pub(super) steps: usize,
    /// Half the sweep, radians, 0..π.
    angle: f64,
    /// Of the distances of the ends from the point between them, that of the end to that of the start.
    ratio: f64,
}

impl Spread {
    /// That of an arc drawn within `flatness` in `least` segments or more; `None` for a line.
    pub(super) fn of(arc: &Arc, flatness: f64, least: usize) -> Option<Self> {
        let bulge = arc.bulge();
        if bulge == 0.0 {
            return None;
        }
        let sweep = 4.0 * math::atan(bulge.abs());
        // A chord over θ is r·θ²/8 from its arc, and a quarter of the bend over the number of steps squared from its parabola.
        let bend = 0.5 * arc.radius() * sweep * sweep;
        let steps = steps_at_most(4 * MAX_STEPS, bend, flatness).max(least);
        let nearest = |value: f64, per: f64| (value * per).round() / per;
        let angle = nearest(0.5 * sweep / PI, ANGLES).min(1.0 - 1.0 / ANGLES);
        let [start, end] = [arc.through - arc.from, arc.to - arc.through].map(|leg| leg.hypot2());
        let octaves = nearest(0.5 * math::log2(end / start), RATIOS);
        Some(Self {
            steps,
            angle: PI * angle,
            ratio: math::exp2(octaves),
        })
    }

    /// The weights `u` and `v` of the vertex after each step.
    pub(super) fn weights(self) -> impl Iterator<Item = [f64; 2]> {
        (1..=self.steps).map(move |step| {
            let t = step as f64 / self.steps as f64;
            let [u, v] = match self.angle {
                0.0 => [1.0 - t, t],
                // sin((1−t)α) + sin(tα)·exp(iα) = sin α · exp(itα): equal steps of the angle.
                angle => [1.0 - t, t].map(|share| math::sin(share * angle)),
            };
            // The end itself, and not what rounding leaves of it.
            if step == self.steps {
                [0.0, 1.0]
            } else {
                [u, v * self.ratio]
            }
        })
    }
}

/// The vertex of these weights.
pub(super) fn vertex(arc: &Arc, [u, v]: [f64; 2]) -> Vec2 {
    let (first, second) = (arc.through - arc.from, arc.to - arc.through);
    let turned = over(v * first, u * second + v * first);
    arc.from.to_vec2() + times(turned, arc.to - arc.from)
}

/// The derivatives, complex numbers, of the vertex of these weights by the start of the arc, the point between and the end.
pub(super) fn slopes(arc: &Arc, [u, v]: [f64; 2]) -> [Vec2; 3] {
    let (first, second) = (arc.through - arc.from, arc.to - arc.through);
    let divisor = u * second + v * first;
    let chord = arc.to - arc.from;
    let away = over(times(v * first, chord), divisor);
    let by_through = over(v * chord - (v - u) * away, divisor);
    let by_end = over(v * first - u * away, divisor);
    // All three points moved alike move the vertex like that.
    [ONE - by_through - by_end, by_through, by_end]
}

/// The derivatives of a loss by the three points of an arc, from those by its vertices behind the start.
pub(super) fn hand_back(arc: &Arc, spread: Spread, by_vertices: &[[f32; 2]]) -> [[f32; 2]; 3] {
    let mut sums = [Vec2::ZERO; 3];
    for (weights, by) in spread.weights().zip(by_vertices) {
        let by = Vec2::new(by[0].into(), by[1].into());
        for (sum, slope) in sums.iter_mut().zip(slopes(arc, weights)) {
            *sum += times(Vec2::new(slope.x, -slope.y), by);
        }
    }
    sums.map(|sum| [sum.x as f32, sum.y as f32])
}

const ONE: Vec2 = Vec2::new(1.0, 0.0);

/// The product of complex numbers.
fn times(a: Vec2, b: Vec2) -> Vec2 {
    Vec2::new(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x)
}

/// The quotient of complex numbers.
fn over(a: Vec2, b: Vec2) -> Vec2 {
    times(a, Vec2::new(b.x, -b.y)) / b.hypot2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Point;
    use crate::rng;

    fn random(i: u64) -> Arc {
        let point = |k: u64| {
            let [x, y] = [0, 1].map(|axis| 90.0 * f64::from(rng::draw(axis, i, k, 0)));
            Point::new(x, y)
        };
        Arc {
            from: point(0),
            through: point(1),
            to: point(2),
        }
    }

    #[test]
    fn vertices_are_on_the_circle_at_about_equal_angles() {
        for arc in (0..500).map(random) {
            let (center, radius) = (arc.center(), arc.radius());
            let spread = Spread::of(&arc, 0.1, 1).unwrap();
            let vertices: Vec<Vec2> = spread.weights().map(|w| vertex(&arc, w)).collect();
            assert_eq!(vertices.len(), spread.steps);
            assert!((vertices[vertices.len() - 1] - arc.to.to_vec2()).hypot() < 1e-9);
            let mut before = arc.from.to_vec2();
            for at in vertices {
                let away = (at - center.to_vec2()).hypot() - radius;
                assert!(away.abs() < 1e-8 * radius, "{arc:?}: {away}");
                let share =
                    (at - before).hypot() * spread.steps as f64 / (radius * arc.sweep().abs());
                let is_even = share < 1.6 || arc.bulge().abs() > 8.0;
                assert!(is_even, "{arc:?}: {share}");
                before = at;
            }
        }
    }

    #[test]
    fn slopes_are_those_of_differences() {
        for i in 0..200 {
            let arc = random(i);
            let spread = Spread::of(&arc, 0.1, 3).unwrap();
            let moved = |k: usize, by: Vec2| {
                let mut points = [arc.from, arc.through, arc.to];
                points[k] += by;
                let [from, through, to] = points;
                Arc { from, through, to }
            };
            for weights in spread.weights() {
                for (k, slope) in slopes(&arc, weights).into_iter().enumerate() {
                    for (by, expected) in [
                        (ONE, slope),
                        (Vec2::new(0.0, 1.0), Vec2::new(-slope.y, slope.x)),
                    ] {
                        let step = 1e-5 * by;
                        let [there, back] = [step, -step].map(|by| vertex(&moved(k, by), weights));
                        let difference = (there - back) / 2e-5;
                        let away = (difference - expected).hypot();
                        assert!(
                            away < 1e-5 * (1.0 + expected.hypot2()),
                            "{arc:?} {k}: {difference} {expected}"
                        );
                    }
                }
            }
        }
    }
}
