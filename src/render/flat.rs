//! Flattening: paths to polylines, and derivatives by the vertices of polylines to derivatives by points of paths.
//!
//! The renderer knows polylines alone. Each line of a path is one segment or more, and each quadratic Bézier curve as
//! many as [`sdf`](crate::sdf) says, at equal steps of its parameter. So every vertex is a mean of at most three
//! points with fixed weights: flattening is linear, and the derivative by a point is the same weights times the
//! derivatives by the vertices.

use crate::math::Vector;
use crate::sdf;

use super::strokes::{LOOK, StrokeRef, Strokes};

/// Strokes as polylines.
#[derive(Debug, Default)]
pub(super) struct Flat {
    /// The vertices of all polylines, px.
    pub(super) vertices: Vec<[f32; 2]>,
    /// The first vertex of each stroke, and behind the last stroke the number of all vertices. A polyline has at least
    /// one segment; that of a dot has no length.
    pub(super) firsts: Vec<u32>,
    /// Radius, red, green, blue and opacity of each stroke.
    pub(super) looks: Vec<[f32; LOOK]>,
}

/// A vertex as a mean of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Vertex {
    /// Indices of three points of the path.
    pub(super) of: [usize; 3],
    pub(super) weights: [f32; 3],
}

impl Vertex {
    fn at(point: usize) -> Self {
        Self {
            of: [point; 3],
            weights: [1.0, 0.0, 0.0],
        }
    }

    /// The place of the vertex.
    pub(super) fn place(&self, points: &[[f32; 2]]) -> [f32; 2] {
        let mut place = points[self.of[0]].map(|v| self.weights[0] * v);
        for k in 1..3 {
            for (sum, v) in place.iter_mut().zip(points[self.of[k]]) {
                *sum += self.weights[k] * v;
            }
        }
        place
    }
}

impl Flat {
    /// Flattens `strokes`. Each line and each curve becomes `least` segments or more.
    pub(super) fn fill(&mut self, strokes: &Strokes, least: usize) {
        self.vertices.clear();
        self.firsts.clear();
        self.looks.clear();
        for stroke in strokes.iter() {
            self.firsts.push(self.vertices.len() as u32);
            self.looks.push(*stroke.look);
            if least == 1 && stroke.is_straight() {
                self.vertices.extend(stroke.points);
                if stroke.closed || stroke.points.len() == 1 {
                    self.vertices.push(stroke.points[0]);
                }
            } else {
                walk(stroke, least, |vertex| {
                    self.vertices.push(vertex.place(stroke.points))
                });
            }
        }
        self.firsts.push(self.vertices.len() as u32);
    }
}

/// Calls `visit` with the vertices of a path, in order.
pub(super) fn walk(stroke: StrokeRef<'_>, least: usize, mut visit: impl FnMut(Vertex)) {
    let (points, count) = (stroke.points, stroke.points.len());
    let is_off = |i: usize| stroke.off[i % count];
    let first = stroke.off.iter().position(|off| !off);
    // All points of a closed path may be off: it starts halfway between the last one and the first.
    let start = first.map_or(Knot::Between(count - 1, 0), Knot::Point);
    visit(start.vertex());
    if count == 1 {
        visit(start.vertex());
        return;
    }
    let mut next = first.map_or(0, |first| first + 1);
    let end = if stroke.closed { next + count } else { count };
    let mut from = start;
    while next < end {
        let control = next % count;
        next += 1;
        if !is_off(control) {
            let to = Knot::Point(control);
            line(from.index(), control, least, &mut visit);
            from = to;
            continue;
        }
        let after = next % count;
        let to = if is_off(after) {
            Knot::Between(control, after)
        } else {
            next += 1;
            Knot::Point(after)
        };
        curve(points, [from, to], control, least, &mut visit);
        from = to;
    }
}

/// A point that a path goes through.
#[derive(Debug, Clone, Copy)]
enum Knot {
    Point(usize),
    /// Halfway between two points off the path.
    Between(usize, usize),
}

impl Knot {
    fn vertex(self) -> Vertex {
        match self {
            Self::Point(i) => Vertex::at(i),
            Self::Between(i, k) => Vertex {
                of: [i, k, k],
                weights: [0.5, 0.5, 0.0],
            },
        }
    }

    /// The point, where a line begins.
    fn index(self) -> usize {
        match self {
            Self::Point(i) | Self::Between(i, _) => i,
        }
    }

    /// The point other than `control` that the knot depends on, and the shares of both.
    fn shares(self, control: usize) -> (usize, [f32; 2]) {
        match self {
            Self::Point(i) => (i, [1.0, 0.0]),
            Self::Between(i, k) => (if i == control { k } else { i }, [0.5, 0.5]),
        }
    }

    fn place(self, points: &[[f32; 2]]) -> [f32; 2] {
        self.vertex().place(points)
    }
}

fn line(from: usize, to: usize, least: usize, visit: &mut impl FnMut(Vertex)) {
    for k in 1..least {
        let t = k as f32 / least as f32;
        visit(Vertex {
            of: [from, to, to],
            weights: [1.0 - t, t, 0.0],
        });
    }
    visit(Vertex::at(to));
}

fn curve(
    points: &[[f32; 2]],
    [from, to]: [Knot; 2],
    control: usize,
    least: usize,
    visit: &mut impl FnMut(Vertex),
) {
    let (a, b, c) = (from.place(points), points[control], to.place(points));
    let steps = sdf::steps(Vector::from([0, 1].map(|k| a[k] - 2.0 * b[k] + c[k]))).max(least);
    let (start, [of_start, start_of_control]) = from.shares(control);
    let (end, [of_end, end_of_control]) = to.shares(control);
    for k in 1..steps {
        let t = k as f32 / steps as f32;
        let (a, b, c) = ((1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t), t * t);
        visit(Vertex {
            of: [start, control, end],
            weights: [
                a * of_start,
                b + a * start_of_control + c * end_of_control,
                c * of_end,
            ],
        });
    }
    visit(to.vertex());
}
