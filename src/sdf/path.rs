//! Distances of polylines and of paths with curves.
//!
//! ```text
//! polyline   d = max dₛ over its segments, each a capsule
//! path       the polyline through Σ w Pⱼ, with weights w fixed by the kinds of its points Pⱼ
//! ```
//!
//! The points of a path are **on** it or **off** it, as [`scene::Path`](crate::scene::Path) says. Each of its quadratic
//! curves becomes segments at equal steps of the curve's parameter, as many as keep within [`Path::flatness`] of it. Flattening
//! is linear in the points, so the derivative by a point is the sum of the derivatives by the vertices times their weights.
//!
//! **Ties.** Where several segments are equally near, all of the derivative goes to the first of them in drawing order. At
//! a joint that makes no difference: both segments have their end there. On the medial axis of a path, and where it
//! crosses itself, the distance has a kink, and this is the slope on one side.
//!
//! **Degenerate cases.** A path of one point is a disc. Segments of no length are discs, too, and lose ties to an earlier
//! neighbour. As many as [`MAX_STEPS`] segments replace a curve, so one of more than some 1,300 px may be off by more.

use super::{Capsule, CapsuleJet};
use crate::math::{Point2, Real, Vector2};

/// Most segments of one curve.
pub(crate) const MAX_STEPS: usize = 64;

/// Points joined by line segments, swept by a disc: the union of the segments' capsules.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline<T: Real> {
    /// The vertices of the centre line, px, at least one.
    pub points: Vec<Point2<T>>,
    /// True if the last vertex is joined to the first.
    pub closed: bool,
    /// Radius, px.
    pub radius: T,
}

/// A polyline's distance at a point, with its derivatives. The one by the radius is always 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolylineJet<T: Real> {
    /// Signed distance, px, positive inside.
    pub d: T,
    /// The vertices at both ends of the nearest segment; the derivatives by all others are 0.
    pub ends: [usize; 2],
    /// `∂d/∂` these two. If they are the same vertex, its derivative is the sum.
    pub by_ends: [Vector2<T>; 2],
}

impl<T: Real> Polyline<T> {
    /// Signed distance from `p` to the edge in px, positive inside.
    pub fn distance(&self, p: Point2<T>, eps: T) -> T {
        let (_, capsule) = self.nearest(p);
        capsule.distance(p, eps)
    }

    /// The distance at `p` with its derivatives.
    pub fn jet(&self, p: Point2<T>, eps: T) -> PolylineJet<T> {
        let (ends, capsule) = self.nearest(p);
        let CapsuleJet { d, by_a, by_b } = capsule.jet(p, eps);
        PolylineJet {
            d,
            ends,
            by_ends: [by_a, by_b],
        }
    }

    /// The vertices of each segment, in drawing order: at least one segment, if there is a vertex.
    pub fn segments(&self) -> impl Iterator<Item = [usize; 2]> + use<T> {
        let count = self.points.len();
        let open = (1..count).map(|i| [i - 1, i]);
        let is_joined = count == 1 || self.closed && count > 0;
        open.chain(is_joined.then(|| [count - 1, 0]))
    }

    /// The first of the segments that are nearest to `p`. Without ε, since it moves the distances of short segments more
    /// than those of long ones.
    fn nearest(&self, p: Point2<T>) -> ([usize; 2], Capsule<T>) {
        let capsule = |[a, b]: [usize; 2]| Capsule {
            a: self.points[a],
            b: self.points[b],
            radius: self.radius,
        };
        let measured = |ends| (capsule(ends).distance(p, T::zero()), ends);
        let nearer = |best: (T, [usize; 2]), other: (T, [usize; 2])| {
            if other.0 > best.0 { other } else { best }
        };
        let nearest = self.segments().map(measured).reduce(nearer);
        let ends = nearest.map_or([0, 0], |(_, ends)| ends);
        (ends, capsule(ends))
    }
}

/// A path swept by a disc.
#[derive(Debug, Clone, PartialEq)]
pub struct Path<T: Real> {
    /// The points, px, at least one.
    pub points: Vec<Point2<T>>,
    /// True for a point off the path: the control point of a curve. The ends of an open path are on it.
    pub off: Vec<bool>,
    /// True if the last point is joined to the first.
    pub closed: bool,
    /// Radius, px.
    pub radius: T,
    /// Largest distance between a curve and its segments, px.
    pub flatness: T,
}

/// A path's distance at a point, with its derivatives. The one by the radius is always 1.
#[derive(Debug, Clone, PartialEq)]
pub struct PathJet<T: Real> {
    /// Signed distance, px, positive inside.
    pub d: T,
    /// `∂d/∂` every point.
    pub by_points: Vec<Vector2<T>>,
}

/// A vertex as a weighted mean of points of a path: their indices and weights, which sum to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Mean<T>(pub Vec<(usize, T)>);

/// A path as a polyline.
#[derive(Debug, Clone, PartialEq)]
pub struct Flattened<T: Real> {
    /// The polyline. It is open; that of a closed path ends where it starts.
    pub polyline: Polyline<T>,
    /// Each of its vertices as a mean of points of the path.
    pub means: Vec<Mean<T>>,
}

impl<T: Real> Path<T> {
    /// Signed distance from `p` to the edge in px, positive inside.
    pub fn distance(&self, p: Point2<T>, eps: T) -> T {
        self.flattened().polyline.distance(p, eps)
    }

    /// The distance at `p` with its derivatives.
    pub fn jet(&self, p: Point2<T>, eps: T) -> PathJet<T> {
        let flattened = self.flattened();
        let jet = flattened.polyline.jet(p, eps);
        let mut by_points = vec![Vector2::zeros(); self.points.len()];
        for (end, by) in jet.ends.into_iter().zip(jet.by_ends) {
            flattened.means[end].hand_back(by, &mut by_points);
        }
        PathJet {
            d: jet.d,
            by_points,
        }
    }

    /// The path as a polyline.
    pub fn flattened(&self) -> Flattened<T> {
        let knots = self.knots();
        let mut means = vec![knots[0].0.clone()];
        let mut at = 1;
        while at < knots.len() {
            let from = &knots[at - 1].0;
            if knots[at].1 {
                let (control, to) = (&knots[at].0, &knots[at + 1].0);
                let [a, b, c] = [from, control, to].map(|mean| mean.place(&self.points));
                let bend = a.coords() - b.coords() * T::of(2.0) + c.coords();
                let steps = steps(bend, self.flatness.to_f64());
                for k in 1..=steps {
                    let t = T::of(k as f64) / T::of(steps as f64);
                    means.push(bernstein([from, control, to], t));
                }
                at += 2;
            } else {
                means.push(knots[at].0.clone());
                at += 1;
            }
        }
        let places = means.iter().map(|mean| mean.place(&self.points));
        Flattened {
            polyline: Polyline {
                points: places.collect(),
                closed: false,
                radius: self.radius,
            },
            means,
        }
    }

    /// The points with all implied ones, each with whether it is off the path. The first and the last are on it.
    fn knots(&self) -> Vec<(Mean<T>, bool)> {
        let count = self.points.len();
        let mut knots = Vec::new();
        for i in 0..count {
            let before = (i + count - 1) % count;
            if self.off[i] && self.off[before] {
                let half = T::of(0.5);
                knots.push((Mean(vec![(before, half), (i, half)]), false));
            }
            knots.push((Mean(vec![(i, T::one())]), self.off[i]));
        }
        if self.closed && count > 1 {
            let is_point = |knot: &(Mean<T>, bool)| !knot.1 && knot.0.0.len() == 1;
            let start = knots.iter().position(is_point).unwrap_or(0);
            knots.rotate_left(start);
            knots.push(knots[0].clone());
        }
        knots
    }
}

impl<T: Real> Mean<T> {
    /// The place of the vertex.
    pub fn place(&self, points: &[Point2<T>]) -> Point2<T> {
        let sum = |sum: Vector2<T>, &(i, weight): &(usize, T)| sum + points[i].coords() * weight;
        Point2::from(self.0.iter().fold(Vector2::zeros(), sum))
    }

    /// Adds the share of each point in the derivative `by` this vertex.
    pub fn hand_back(&self, by: Vector2<T>, by_points: &mut [Vector2<T>]) {
        for &(i, weight) in &self.0 {
            by_points[i] += by * weight;
        }
    }
}

/// The vertex at the parameter `t` of a curve.
fn bernstein<T: Real>([from, control, to]: [&Mean<T>; 3], t: T) -> Mean<T> {
    let s = T::one() - t;
    let parts = [(from, s * s), (control, T::of(2.0) * s * t), (to, t * t)];
    let weighted =
        parts.map(|(mean, share)| mean.0.iter().map(move |&(i, weight)| (i, weight * share)));
    Mean(weighted.into_iter().flatten().collect())
}

/// Number of segments that keep within `flatness` of a curve, px, from its second difference `a − 2b + c`.
///
/// A curve is at most a quarter of that from its chord, and each halving of the step quarters the distance. The hair that
/// is taken off keeps curves in round numbers, whose ratio is a whole number, from hanging on rounding.
pub(crate) fn steps<T: Real>(bend: Vector2<T>, flatness: f64) -> usize {
    let ratio = bend.dot(&bend).sqrt().to_f64() / (4.0 * flatness);
    let steps = ratio.sqrt() - 1e-3;
    // `ceil` is a call where the target has no instruction for it.
    let whole = steps as usize;
    (whole + usize::from(steps > whole as f64)).clamp(1, MAX_STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng;
    use crate::sdf::Combination;

    const EPS: f64 = 1e-3;
    const FLATNESS: f64 = 0.08;

    fn coordinate(i: u64, k: u64) -> f64 {
        f64::from(rng::draw(2, 0, i, k)) * 16.0 - 4.0
    }

    fn point(i: u64, k: u64) -> Point2<f64> {
        Point2::new(coordinate(i, k), coordinate(i, k + 1))
    }

    /// Five points of the kinds that the bits of `kinds` say, 1 for off; open paths have their ends on.
    fn path(i: u64, kinds: u64, closed: bool) -> Path<f64> {
        let is_off = |k: u64| (closed || (k > 0 && k < 4)) && kinds >> k & 1 == 1;
        Path {
            points: (0..5).map(|k| point(i, 2 * k)).collect(),
            off: (0..5).map(is_off).collect(),
            closed,
            radius: 1.5,
            flatness: FLATNESS,
        }
    }

    fn paths() -> impl Iterator<Item = Path<f64>> {
        let kinds = (0..32).flat_map(|kinds| [false, true].map(|closed| (kinds, closed)));
        kinds.map(|(kinds, closed)| path(kinds, kinds, closed))
    }

    #[test]
    fn a_polyline_is_the_union_of_its_capsules() {
        let bent = Polyline {
            points: (0..4).map(|k| point(7, 2 * k)).collect(),
            closed: true,
            radius: 1.5,
        };
        let capsule = |a: usize, b: usize| Capsule {
            a: bent.points[a],
            b: bent.points[b],
            radius: 1.5,
        };
        for i in 0..100 {
            let p = point(i, 20);
            let distances =
                [(0, 1), (1, 2), (2, 3), (3, 0)].map(|(a, b)| capsule(a, b).distance(p, 0.0));
            let union = |x, y| Combination::Union.distance(x, y);
            let expected = distances.into_iter().reduce(union).unwrap();
            assert_eq!(bent.distance(p, 0.0), expected);
            assert_eq!(bent.jet(p, EPS).d, bent.distance(p, EPS));
        }
    }

    #[test]
    fn one_point_is_a_disc() {
        for closed in [false, true] {
            let dot = Polyline {
                points: vec![point(1, 0)],
                closed,
                radius: 2.0,
            };
            let circle = crate::sdf::Circle {
                center: point(1, 0),
                radius: 2.0,
            };
            let jet = dot.jet(point(2, 0), EPS);
            let expected = circle.jet(point(2, 0), EPS);
            assert_eq!(jet.d, expected.d);
            assert_eq!(jet.ends, [0, 0]);
            assert!((jet.by_ends[0] + jet.by_ends[1] - expected.by_center).norm() < 1e-12);
        }
    }

    #[test]
    fn the_first_of_equally_near_segments_has_the_derivative() {
        let there_and_back = Polyline {
            points: [[0.0, 0.0], [10.0, 0.0], [0.0, 0.0], [0.0, 0.0]]
                .map(Point2::from)
                .to_vec(),
            closed: false,
            radius: 1.0,
        };
        assert_eq!(there_and_back.jet(Point2::new(4.0, 3.0), 0.0).ends, [0, 1]);
    }

    /// Every off-point is the control point of one quadratic curve, from knot to knot.
    #[test]
    fn curves_are_within_the_tolerance() {
        let spline = Path {
            points: [[0.0, 0.0], [40.0, 3.0], [25.0, 30.0], [0.0, 22.0]]
                .map(Point2::from)
                .to_vec(),
            off: vec![false, true, true, false],
            closed: false,
            radius: 1.0,
            flatness: FLATNESS,
        };
        let middle = Point2::new(32.5, 16.5);
        let curves = [
            [spline.points[0], spline.points[1], middle],
            [middle, spline.points[2], spline.points[3]],
        ];
        let mut farthest = 0.0_f64;
        for [a, b, c] in curves {
            for k in 0..=100 {
                let t = f64::from(k) / 100.0;
                let [ab, bc] = [a + (b - a) * t, b + (c - b) * t];
                farthest = farthest.max(1.0 - spline.distance(ab + (bc - ab) * t, 0.0));
            }
        }
        assert!(
            farthest < FLATNESS && farthest > FLATNESS / 4.0,
            "{farthest}"
        );
        assert!(spline.flattened().means.len() <= 24);
    }

    #[test]
    fn a_vertex_is_a_mean_of_points() {
        for path in paths() {
            let Flattened { polyline, means } = path.flattened();
            assert_eq!(polyline.points.len(), means.len());
            for mean in &means {
                let sum: f64 = mean.0.iter().map(|(_, weight)| weight).sum();
                assert!((sum - 1.0).abs() < 1e-12 && mean.0.iter().all(|(_, w)| *w >= 0.0));
            }
            let (first, last) = (polyline.points[0], polyline.points[means.len() - 1]);
            let (start, end) = if path.closed {
                (first, first)
            } else {
                (path.points[0], path.points[4])
            };
            assert!((first - start).norm() + (last - end).norm() < 1e-12);
        }
    }

    #[test]
    fn derivatives_are_central_differences() {
        let step = 1e-6;
        let mut failures = Vec::new();
        for (i, path) in paths().enumerate() {
            for j in 0..20 {
                let p = point(j, 30);
                let jet = path.jet(p, EPS);
                assert_eq!(jet.d, path.distance(p, EPS));
                for k in 0..path.points.len() {
                    for axis in 0..2 {
                        let at = |by: f64| {
                            let mut moved = path.clone();
                            moved.points[k][axis] += by;
                            moved.distance(p, EPS)
                        };
                        let numeric = (at(step) - at(-step)) / (2.0 * step);
                        let analytic = jet.by_points[k][axis];
                        if (analytic - numeric).abs() > 1e-7 {
                            failures
                                .push(format!("path {i}, point {k}: {analytic} against {numeric}"));
                        }
                    }
                }
            }
        }
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }
}
