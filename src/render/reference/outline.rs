//! The outline that the points of a stroke draw, and its signed distance: **positive inside**, in px.
//!
//! ```text
//! segment   d = r − √(|q|² + ε)
//!           q = (p−a) − h(b−a),   h = clamp((p−a)·(b−a) / (|b−a|² + ε), 0, 1)
//! path      d of its nearest segment
//! area      d = +min |p − s| over the segments s where the winding number of p is not 0,  −min |p − s| elsewhere
//! ```
//!
//! **Vertices.** The points of a path are of the kinds that [`scene::Path`](crate::scene::Path) has. Each of its
//! Bézier curves becomes segments at equal steps of the curve's parameter, as many as [`steps`] says. A vertex is a
//! weighted mean of points, so the derivative by a point is the sum of the derivatives by the vertices times their weights. For
//! the vertices of arcs see [`arcs`].
//!
//! **Derivatives.** With `u = q / √(|q|² + ε)`, by the chain rule through `h`:
//!
//! ```text
//! ∂d/∂a = (1−h)u + (u·(b−a)) ∂h/∂a      ∂h/∂a = (2h(b−a) − (b−a) − (p−a)) / (|b−a|² + ε)
//! ∂d/∂b =     hu + (u·(b−a)) ∂h/∂b      ∂h/∂b = ((p−a) − 2h(b−a)) / (|b−a|² + ε)
//! ```
//!
//! where `∂h = 0` if the clamp is active; at the limits themselves it is not, as in `PyTorch`'s `clamp`. An area has those of its
//! nearest segment, with the sign of the side. It needs no derivative of the winding number: that changes on the segments
//! alone, where `d` is 0 from both sides.
//!
//! **Ties.** Where several segments are equally near, all of the derivative goes to the first of them in drawing order. At
//! a joint that makes no difference: both segments have their end there. On the medial axis of a path, and where it
//! crosses itself, the distance has a kink, and this is the slope on one side.
//!
//! **Degenerate cases.** A segment of no length is a disc: `h = 0`, and the gradient of both ends goes to `a`. On the centre line
//! `u = 0` if ε > 0; at ε = 0, where no derivative exists, 0 is used as well. A contour of one point or of points in one line has no
//! inside; its distance is to the line. Contours that cross have a distance of 0 on their segments even where area lies on
//! both sides.
//!
//! Source: Inigo Quilez, "2D distance functions" (the segment), with the sign reversed and ε added as in the golden data.

use kurbo::{Point, Vec2};

use super::super::arcs::{self, Spread};
use super::super::strokes::steps;
use crate::scene::{Arc, PointKind};

/// A vertex as a weighted mean of points: their indices and weights, which sum to 1.
///
/// For a vertex of an arc, these are the derivatives of its place by points, complex numbers: a turn and a factor. Their real
/// parts sum to 1, and their imaginary parts to 0.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::render) struct Mean(pub(in crate::render) Vec<(usize, Vec2)>);

/// Vertices joined by line segments: a path swept by a disc, or an area within contours.
#[derive(Debug, Clone, Default)]
pub(in crate::render) struct Outline {
    /// px.
    vertices: Vec<Point>,
    /// Each of the vertices as a mean of points.
    pub(in crate::render) means: Vec<Mean>,
    /// The vertices at both ends of each segment, in drawing order.
    segments: Vec<[usize; 2]>,
    /// Radius of the disc, px; 0 for an area.
    radius: f64,
    /// True for an area.
    pub(super) is_area: bool,
}

impl Outline {
    /// A path swept by a disc.
    pub(super) fn path(knots: Knots<'_>, radius: f64, flatness: f64) -> Self {
        let mut path = Self {
            radius,
            ..Self::default()
        };
        path.add(knots, 0, flatness);
        path
    }

    /// The area within closed paths, each the points up to an index in `ends`.
    pub(super) fn area(knots: Knots<'_>, ends: &[usize], flatness: f64) -> Self {
        let mut area = Self {
            is_area: true,
            ..Self::default()
        };
        let mut start = 0;
        for &end in ends {
            let contour = Knots {
                points: &knots.points[start..end],
                kinds: &knots.kinds[start..end],
                closed: true,
            };
            area.add(contour, start, flatness);
            start = end;
        }
        area
    }

    /// Adds a flattened path whose points are those from `first` on.
    fn add(&mut self, knots: Knots<'_>, first: usize, flatness: f64) {
        let start = self.vertices.len();
        for (place, mean) in knots.flattened(flatness) {
            self.vertices.push(place);
            let parts = mean.0.into_iter().map(|(i, weight)| (first + i, weight));
            self.means.push(Mean(parts.collect()));
        }
        let end = self.vertices.len();
        self.segments.extend((start + 1..end).map(|i| [i - 1, i]));
        if end == start + 1 {
            self.segments.push([start, start]);
        }
    }

    /// Signed distance from `p` to the edge.
    pub(super) fn distance(&self, p: Point, eps: f64) -> f64 {
        let Some(foot) = self.nearest(p).map(|segment| self.foot(segment, p, eps)) else {
            return f64::NEG_INFINITY;
        };
        self.side(p) * (self.radius - length(foot.q, eps))
    }

    /// The two vertices that move the edge near `p`, and the derivatives of the distance by them. If they are the same vertex, its
    /// derivative is the sum.
    pub(super) fn by_vertices(&self, p: Point, eps: f64) -> [(usize, Vec2); 2] {
        let Some([a, b]) = self.nearest(p) else {
            return [(0, Vec2::ZERO); 2];
        };
        let Foot { h, pa, ba, q, free } = self.foot([a, b], p, eps);
        let length = length(q, eps);
        let u = if length > 0.0 { q / length } else { Vec2::ZERO };
        let (mut by_a, mut by_b) = (u * (1.0 - h), u * h);
        let m = ba.dot(ba) + eps;
        if free && m > 0.0 {
            let along = u.dot(ba) / m;
            let twice = ba * (h + h);
            by_a += (twice - ba - pa) * along;
            by_b += (pa - twice) * along;
        }
        // `by_a` and `by_b` are the derivatives of −|q|. Inside an area d = |q|, hence the sign.
        let side = self.side(p);
        [(a, by_a * side), (b, by_b * side)]
    }

    /// The first of the segments that are nearest to `p`. Without ε, since it moves the distances of short segments more
    /// than those of long ones.
    fn nearest(&self, p: Point) -> Option<[usize; 2]> {
        let away2 = |&segment: &[usize; 2]| self.foot(segment, p, 0.0).q.hypot2();
        let by_distance = |a: &[usize; 2], b: &[usize; 2]| away2(a).total_cmp(&away2(b));
        self.segments.iter().copied().min_by(by_distance)
    }

    /// −1 inside an area, whose radius of 0 makes all distances negative; 1 elsewhere.
    fn side(&self, p: Point) -> f64 {
        if self.is_area && self.winding(p) != 0 {
            -1.0
        } else {
            1.0
        }
    }

    /// The number of times that the contours run around `p`, counted with their sense: the sum over the segments that cross the ray
    /// from p to the left. A vertex belongs to the segment above it alone, so that a ray through it counts it once.
    fn winding(&self, p: Point) -> i32 {
        let crossings = self.segments.iter().map(|ends| {
            let [a, b] = ends.map(|end| self.vertices[end]);
            let sense = i32::from(b.y <= p.y) - i32::from(a.y <= p.y);
            if sense == 0 {
                return 0;
            }
            let x = a.x + (p.y - a.y) * (b.x - a.x) / (b.y - a.y);
            if x < p.x { sense } else { 0 }
        });
        crossings.sum()
    }

    fn foot(&self, ends: [usize; 2], p: Point, eps: f64) -> Foot {
        let [a, b] = ends.map(|end| self.vertices[end]);
        let (pa, ba) = (p - a, b - a);
        let m = ba.dot(ba) + eps;
        let along = if m > 0.0 { pa.dot(ba) / m } else { 0.0 };
        let h = along.clamp(0.0, 1.0);
        Foot {
            h,
            pa,
            ba,
            q: pa - ba * h,
            free: along == h,
        }
    }
}

/// The nearest point of a segment, 0 at its start and 1 at its end, and vectors to `p` from the start, along the segment, and to
/// `p` from there; `free` if no clamp is active.
struct Foot {
    h: f64,
    pa: Vec2,
    ba: Vec2,
    q: Vec2,
    free: bool,
}

fn length(q: Vec2, eps: f64) -> f64 {
    (q.dot(q) + eps).sqrt()
}

/// The points of a path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Knots<'a> {
    /// px, at least one.
    pub(super) points: &'a [[f64; 2]],
    /// The ends of an open path are on it.
    pub(super) kinds: &'a [PointKind],
    /// True if the last point is joined to the first.
    pub(super) closed: bool,
}

impl Knots<'_> {
    /// The vertices of segments that keep within `flatness` of the path, px. The vertices of a closed path end where they start.
    fn flattened(self, flatness: f64) -> Vec<(Point, Mean)> {
        let knots = self.with_implied();
        let mut vertices = vec![self.placed(knots[0].0.clone())];
        let mut from = 0;
        while from + 1 < knots.len() {
            let kind = knots[from + 1].1;
            // Each piece has the points of its kind between two points on the path.
            let to = from
                + match kind {
                    PointKind::On => 1,
                    PointKind::Quad | PointKind::Arc => 2,
                    PointKind::Cubic => 3,
                };
            let own: Vec<&Mean> = knots[from..=to].iter().map(|(mean, _)| mean).collect();
            vertices.extend(self.piece(kind, &own, flatness));
            from = to;
        }
        vertices
    }

    /// The vertices of the piece of these knots behind its start.
    fn piece(self, kind: PointKind, knots: &[&Mean], flatness: f64) -> Vec<(Point, Mean)> {
        let places = knots.iter().map(|mean| mean.place(self.points));
        let at: Vec<Vec2> = places.map(Point::to_vec2).collect();
        let bend = |i: usize| (at[i] - at[i + 1] * 2.0 + at[i + 2]).hypot();
        let line = || vec![self.placed(knots[knots.len() - 1].clone())];
        match kind {
            PointKind::On => line(),
            PointKind::Quad => self.curve(knots, steps(bend(0), flatness)),
            PointKind::Cubic => self.curve(knots, steps(3.0 * bend(0).max(bend(1)), flatness)),
            PointKind::Arc => {
                let [from, through, to] = [0, 1, 2].map(|i| at[i].to_point());
                let arc = Arc { from, through, to };
                let spread = Spread::of(&arc, flatness, 1);
                spread.map_or_else(line, |spread| along(&arc, spread, knots))
            }
        }
    }

    /// The vertices of a Bézier curve at so many steps of its parameter.
    fn curve(self, knots: &[&Mean], steps: usize) -> Vec<(Point, Mean)> {
        let vertex = |k: usize| self.placed(bernstein(knots, k as f64 / steps as f64));
        (1..=steps).map(vertex).collect()
    }

    fn placed(self, mean: Mean) -> (Point, Mean) {
        (mean.place(self.points), mean)
    }

    /// The points with all implied ones, each with its kind. The first and the last are on the path.
    fn with_implied(self) -> Vec<(Mean, PointKind)> {
        let count = self.points.len();
        let weight = |weight: f64| Vec2::new(weight, 0.0);
        let mut knots = Vec::new();
        for i in 0..count {
            let before = (i + count - 1) % count;
            // Two control points of quadratic curves in a row imply a point on the path, halfway between.
            if [self.kinds[i], self.kinds[before]] == [PointKind::Quad; 2] {
                let both = vec![(before, weight(0.5)), (i, weight(0.5))];
                knots.push((Mean(both), PointKind::On));
            }
            knots.push((Mean(vec![(i, weight(1.0))]), self.kinds[i]));
        }
        if self.closed && count > 1 {
            let is_point =
                |knot: &(Mean, PointKind)| knot.1 == PointKind::On && knot.0.0.len() == 1;
            // Start at the first point that is on the path, and end there, as the fast renderer does, since ties go to the first
            // segment.
            let start = knots.iter().position(is_point).unwrap_or(0);
            knots.rotate_left(start);
            knots.push(knots[0].clone());
        }
        knots
    }
}

impl Mean {
    /// The point of a vertex that is a mean.
    fn place(&self, points: &[[f64; 2]]) -> Point {
        let sum = |sum: Vec2, &(i, weight): &(usize, Vec2)| sum + vector(points[i]) * weight.x;
        self.0.iter().fold(Vec2::ZERO, sum).to_point()
    }

    /// Adds the share of each point in the derivative `by` this vertex.
    pub(super) fn hand_back(&self, by: Vec2, by_points: &mut [Vec2]) {
        for &(i, weight) in &self.0 {
            // The transpose of a turn turns the other way; without a turn this is the product with the weight.
            by_points[i] += by * weight.x - by.turn_90() * weight.y;
        }
    }
}

fn vector([x, y]: [f64; 2]) -> Vec2 {
    Vec2::new(x, y)
}

/// The vertices along an arc, whose knots are points.
fn along(arc: &Arc, spread: Spread, knots: &[&Mean]) -> Vec<(Point, Mean)> {
    let vertex = |weights: [f64; 2]| {
        let parts = knots.iter().zip(arcs::slopes(arc, weights));
        let parts = parts.map(|(mean, slope)| (mean.0[0].0, slope));
        let place = arcs::vertex(arc, weights).to_point();
        (place, Mean(parts.collect()))
    };
    spread.weights().map(vertex).collect()
}

/// The vertex at the parameter `t` of a quadratic or cubic Bézier curve.
fn bernstein(knots: &[&Mean], t: f64) -> Mean {
    let s = 1.0 - t;
    let shares = match knots.len() {
        3 => vec![s * s, 2.0 * s * t, t * t],
        _ => vec![s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
    };
    let parts = knots.iter().zip(shares);
    let weighted =
        parts.flat_map(|(mean, share)| mean.0.iter().map(move |&(i, weight)| (i, weight * share)));
    Mean(weighted.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng;

    const FLATNESS: f64 = 0.08;

    fn random(i: u64, count: u64) -> Vec<[f64; 2]> {
        let place = |k: u64| [0, 1].map(|axis| f64::from(rng::draw(axis, i, k, 0)) * 16.0 - 4.0);
        (0..count).map(place).collect()
    }

    fn path(points: &[[f64; 2]], off: &[bool], closed: bool) -> Outline {
        let knots = Knots {
            points,
            kinds: &off
                .iter()
                .map(|off| PointKind::on_if(!off))
                .collect::<Vec<_>>(),
            closed,
        };
        Outline::path(knots, 1.5, FLATNESS)
    }

    fn area(contours: &[Vec<[f64; 2]>]) -> Outline {
        let ends = contours.iter().scan(0, |end, contour| {
            *end += contour.len();
            Some(*end)
        });
        let points = contours.concat();
        let knots = Knots {
            points: &points,
            kinds: &vec![PointKind::On; points.len()],
            closed: true,
        };
        Outline::area(knots, &ends.collect::<Vec<_>>(), FLATNESS)
    }

    fn square(low: f64, high: f64) -> Vec<[f64; 2]> {
        vec![[low, low], [high, low], [high, high], [low, high]]
    }

    fn reversed(mut contour: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        contour.reverse();
        contour
    }

    #[test]
    fn distances_are_positive_inside() {
        let capsule = path(&[[0.0, 0.0], [10.0, 0.0]], &[false; 2], false);
        for (p, d) in [((5.0, 0.0), 1.5), ((5.0, 3.0), -1.5), ((-3.0, 4.0), -3.5)] {
            assert_eq!(capsule.distance(p.into(), 0.0), d);
        }
        let dot = path(&[[1.0, 2.0]], &[false], false);
        assert_eq!(dot.distance((4.0, 6.0).into(), 0.0), -3.5);
        let area = area(&[square(0.0, 10.0)]);
        for (p, d) in [((5.0, 5.0), 5.0), ((2.0, 7.0), 2.0), ((13.0, 14.0), -5.0)] {
            assert_eq!(area.distance(p.into(), 0.0), d);
        }
    }

    #[test]
    fn a_contour_of_the_other_sense_is_a_hole() {
        let holed = area(&[square(0.0, 20.0), reversed(square(5.0, 15.0))]);
        let filled = area(&[square(0.0, 20.0), square(5.0, 15.0)]);
        let center = Point::new(10.0, 9.0);
        assert_eq!(holed.distance(center, 0.0), -4.0);
        assert_eq!(filled.distance(center, 0.0), 4.0);
    }

    /// The winding number by its definition: the sum of the angles that the segments are seen under.
    #[test]
    #[allow(clippy::disallowed_methods)]
    fn windings_are_sums_of_angles() {
        for i in 0..500 {
            let area = area(&[random(i, 7), random(i + 1000, 3)]);
            let p = vector(random(i + 5000, 1)[0]).to_point();
            let turns = area.segments.iter().map(|ends| {
                let [a, b] = ends.map(|k| area.vertices[k] - p);
                a.cross(b).atan2(a.dot(b)) / std::f64::consts::TAU
            });
            assert_eq!(area.winding(p), turns.sum::<f64>().round() as i32, "{i}");
        }
    }

    #[test]
    fn contours_without_an_inside_have_distances() {
        let line = [[3.0, 4.0], [9.0, 4.0], [6.0, 4.0]];
        for points in [vec![[3.0, 4.0]], vec![[3.0, 4.0]; 2], line.to_vec()] {
            for (p, d) in [((3.0, 8.0), -4.0), ((0.0, 4.0), -3.0), ((3.0, 4.0), 0.0)] {
                let area = area(std::slice::from_ref(&points));
                assert_eq!(area.distance(p.into(), 0.0), d, "{points:?}");
            }
        }
    }

    #[test]
    fn the_first_of_equally_near_segments_has_the_derivative() {
        let there_and_back = [[0.0, 0.0], [10.0, 0.0], [0.0, 0.0], [0.0, 0.0]];
        let there_and_back = path(&there_and_back, &[false; 4], false);
        let by = there_and_back.by_vertices((4.0, 3.0).into(), 0.0);
        assert_eq!(by.map(|(vertex, _)| vertex), [0, 1]);
    }

    /// Every off-point is the control point of one quadratic curve, from knot to knot.
    #[test]
    fn curves_are_within_the_tolerance() {
        let points = [[0.0, 0.0], [40.0, 3.0], [25.0, 30.0], [0.0, 22.0]];
        let spline = path(&points, &[false, true, true, false], false);
        let middle = [32.5, 16.5];
        let curves = [
            [points[0], points[1], middle],
            [middle, points[2], points[3]],
        ];
        let mut farthest = 0.0_f64;
        for [a, b, c] in curves.map(|curve| curve.map(|p| vector(p).to_point())) {
            for k in 0..=100 {
                let t = f64::from(k) / 100.0;
                let on = a.lerp(b, t).lerp(b.lerp(c, t), t);
                farthest = farthest.max(1.5 - spline.distance(on, 0.0));
            }
        }
        assert!(
            farthest < FLATNESS && farthest > FLATNESS / 4.0,
            "{farthest}"
        );
        assert!(spline.vertices.len() <= 24);
    }

    #[test]
    fn a_vertex_is_a_mean_of_points() {
        for (kinds, closed) in (0..32_u64).flat_map(|kinds| [(kinds, false), (kinds, true)]) {
            let is_off = |k: u64| (closed || (k > 0 && k < 4)) && kinds >> k & 1 == 1;
            let points = random(kinds, 5);
            let off: Vec<bool> = (0..5).map(is_off).collect();
            let path = path(&points, &off, closed);
            for Mean(parts) in &path.means {
                let sum: f64 = parts.iter().map(|(_, weight)| weight.x).sum();
                assert!(
                    (sum - 1.0).abs() < 1e-12
                        && parts.iter().all(|(_, w)| w.x >= 0.0 && w.y == 0.0)
                );
            }
            let (first, last) = (path.vertices[0], path.vertices[path.vertices.len() - 1]);
            let [start, end] = if closed {
                [first, first]
            } else {
                [points[0], points[4]].map(|p| vector(p).to_point())
            };
            assert!((first - start).hypot() + (last - end).hypot() < 1e-12);
        }
    }
}
