//! Distances of areas: closed rings of segments, filled by the nonzero rule.
//!
//! ```text
//! winding    w(p) = Σ over the segments that cross the ray from p to the left: +1 upwards, −1 downwards
//! area       d = +min |p − s| over the segments s where w(p) ≠ 0,   −min |p − s| elsewhere
//! ```
//!
//! The nearest segment has the derivatives of a capsule without radius, with the sign of the side. They need no
//! derivative of the winding number: that changes on the rings alone, where `d` is 0 from both sides.
//!
//! **Overlaps.** Rings that wind alike may cross, touch or lie in each other, and so may parts of one ring. The distance
//! then is to the nearest segment even where area lies on both sides of it, so that the soft edge shows as a faint line
//! inside: 0 on the segment instead of the depth. Crossing rings of a fit are a fault to be mended, not a shape to be kept.
//!
//! **Degenerate cases.** A ring of one point or of points in one line has no inside; its distance is that of the line.
//! A segment whose ends have the same y crosses no ray. A vertex belongs to the segment above it alone, so that a ray
//! through it counts it once.

use super::{Polyline, PolylineJet};
use crate::math::{Point2, Real, Vector2};

/// Closed rings, filled where they wind around a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Area<T: Real> {
    /// The rings, px, of radius 0, at least one. Each is closed, or ends where it starts.
    pub rings: Vec<Polyline<T>>,
}

/// An area's distance at a point, with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaJet<T: Real> {
    /// Signed distance, px, positive inside.
    pub d: T,
    /// The ring that is nearest.
    pub ring: usize,
    /// The vertices of that ring at both ends of the nearest segment; the derivatives by all others are 0.
    pub ends: [usize; 2],
    /// `∂d/∂` these two. If they are the same vertex, its derivative is the sum.
    pub by_ends: [Vector2<T>; 2],
}

impl<T: Real> Area<T> {
    /// The number of times that the rings run around `p`, counted with their sense.
    pub fn winding(&self, p: Point2<T>) -> i32 {
        self.rings.iter().map(|ring| winding(ring, p)).sum()
    }

    /// Signed distance from `p` to the edge in px, positive inside.
    pub fn distance(&self, p: Point2<T>, eps: T) -> T {
        self.jet(p, eps).d
    }

    /// The distance at `p` with its derivatives. The first ring counts as the nearest where several are.
    pub fn jet(&self, p: Point2<T>, eps: T) -> AreaJet<T> {
        let mut nearest: Option<(T, usize)> = None;
        for (ring, polyline) in self.rings.iter().enumerate() {
            // Without ε, which moves the distances of short segments more than those of long ones.
            let d = polyline.distance(p, T::zero());
            if nearest.is_none_or(|(best, _)| d > best) {
                nearest = Some((d, ring));
            }
        }
        let ring = nearest.map_or(0, |(_, ring)| ring);
        let PolylineJet { d, ends, by_ends } = self.rings[ring].jet(p, eps);
        // Of a radius of 0, the polyline's distance is −|p − s|.
        let side = if self.winding(p) == 0 {
            T::one()
        } else {
            -T::one()
        };
        AreaJet {
            d: side * d,
            ring,
            ends,
            by_ends: by_ends.map(|by| by * side),
        }
    }
}

/// The number of times that a closed polyline runs around `p`.
fn winding<T: Real>(ring: &Polyline<T>, p: Point2<T>) -> i32 {
    let crossings = ring.segments().map(|[a, b]| {
        let [a, b] = [ring.points[a], ring.points[b]];
        let sense = i32::from(b.y <= p.y) - i32::from(a.y <= p.y);
        if sense == 0 {
            return 0;
        }
        let x = a.x + (p.y - a.y) * (b.x - a.x) / (b.y - a.y);
        if x < p.x { sense } else { 0 }
    });
    crossings.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng;

    const EPS: f64 = 1e-3;

    fn ring(points: &[[f64; 2]]) -> Polyline<f64> {
        Polyline {
            points: points.iter().map(|&p| p.into()).collect(),
            closed: true,
            radius: 0.0,
        }
    }

    fn square(low: f64, high: f64) -> Polyline<f64> {
        ring(&[[low, low], [high, low], [high, high], [low, high]])
    }

    fn reversed(mut ring: Polyline<f64>) -> Polyline<f64> {
        ring.points.reverse();
        ring
    }

    fn random(i: u64, count: u64) -> Polyline<f64> {
        let place = |k: u64| [0, 1].map(|axis| f64::from(rng::draw(axis, i, k, 0)) * 16.0 - 4.0);
        ring(&(0..count).map(place).collect::<Vec<_>>())
    }

    fn point(i: u64) -> Point2<f64> {
        Point2::from([0, 1].map(|axis| f64::from(rng::draw(axis, 77, i, 1)) * 16.0 - 4.0))
    }

    #[test]
    fn distances_are_positive_inside() {
        let area = Area {
            rings: vec![square(0.0, 10.0)],
        };
        let d = |x, y| area.distance(Point2::new(x, y), 0.0);
        assert_eq!([d(5.0, 5.0), d(2.0, 7.0), d(-3.0, 5.0)], [5.0, 2.0, -3.0]);
        assert_eq!(d(13.0, 14.0), -5.0);
        assert_eq!(d(10.0, 5.0), 0.0);
    }

    #[test]
    fn a_ring_of_the_other_sense_is_a_hole() {
        let holed = Area {
            rings: vec![square(0.0, 20.0), reversed(square(5.0, 15.0))],
        };
        let filled = Area {
            rings: vec![square(0.0, 20.0), square(5.0, 15.0)],
        };
        let center = Point2::new(10.0, 9.0);
        assert_eq!(
            (holed.winding(center), holed.distance(center, 0.0)),
            (0, -4.0)
        );
        assert_eq!(
            (filled.winding(center), filled.distance(center, 0.0)),
            (2, 4.0)
        );
    }

    #[test]
    fn the_sense_of_the_whole_changes_nothing() {
        for i in 0..200 {
            let [there, back] = [random(i, 6), reversed(random(i, 6))];
            let [there, back] = [there, back].map(|ring| Area { rings: vec![ring] });
            let p = point(i);
            assert_eq!(there.winding(p), -back.winding(p));
            assert!((there.distance(p, 0.0) - back.distance(p, 0.0)).abs() < 1e-12);
        }
    }

    /// The winding number by its definition: the sum of the angles that the segments are seen under.
    #[test]
    #[allow(clippy::disallowed_methods)]
    fn windings_are_sums_of_angles() {
        for i in 0..500 {
            let area = Area {
                rings: vec![random(i, 7), random(i + 1000, 3)],
            };
            let p = point(i);
            let mut turns = 0.0;
            for ring in &area.rings {
                for [a, b] in ring.segments() {
                    let [a, b] = [a, b].map(|k| ring.points[k] - p);
                    turns += (a.x * b.y - a.y * b.x).atan2(a.dot(&b)) / std::f64::consts::TAU;
                }
            }
            assert_eq!(area.winding(p), turns.round() as i32, "{i}");
        }
    }

    #[test]
    fn rings_without_an_inside_have_distances() {
        let rings = [
            vec![[3.0, 4.0]],
            vec![[3.0, 4.0], [3.0, 4.0]],
            vec![[3.0, 4.0], [9.0, 4.0]],
            vec![[3.0, 4.0], [9.0, 4.0], [6.0, 4.0]],
        ];
        for points in rings {
            let area = Area {
                rings: vec![ring(&points)],
            };
            for (p, d) in [([3.0, 8.0], -4.0), ([0.0, 4.0], -3.0), ([3.0, 4.0], 0.0)] {
                assert_eq!(area.distance(p.into(), 0.0), d, "{points:?}");
            }
        }
    }

    #[test]
    fn derivatives_are_central_differences() {
        let step = 1e-6;
        let mut failures = Vec::new();
        for i in 0..40 {
            let area = Area {
                rings: vec![random(i, 5), random(i + 500, 4)],
            };
            for j in 0..20 {
                let p = point(j);
                let jet = area.jet(p, EPS);
                for (ring, polyline) in area.rings.iter().enumerate() {
                    for k in 0..polyline.points.len() {
                        for axis in 0..2 {
                            let at = |by: f64| {
                                let mut moved = area.clone();
                                moved.rings[ring].points[k][axis] += by;
                                moved.distance(p, EPS)
                            };
                            let numeric = (at(step) - at(-step)) / (2.0 * step);
                            let mut analytic = 0.0;
                            for (end, by) in jet.ends.into_iter().zip(jet.by_ends) {
                                if (jet.ring, end) == (ring, k) {
                                    analytic += by[axis];
                                }
                            }
                            if (analytic - numeric).abs() > 1e-6 {
                                failures.push(format!("{i} {j}: {analytic} against {numeric}"));
                            }
                        }
                    }
                }
            }
        }
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }
}
