//! Flattening: paths to polylines, and derivatives by the vertices of polylines to derivatives by points of paths.
//!
//! The renderer knows polylines alone. Each line of a path is one segment or more, and each quadratic Bézier curve as
//! many as [`sdf`](crate::sdf) says, at equal steps of its parameter. So every vertex is a mean of at most three
//! points with fixed weights: flattening is linear, and the derivative by a point is the same weights times the
//! derivatives by the vertices.

use rayon::prelude::*;

use crate::math::Vector;
use crate::sdf;

use super::strokes::{LOOK, StrokeRef, Strokes};

/// Strokes that are flattened at a time.
pub(super) const CHUNK: usize = 32;

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
    /// The smallest and the largest x and y of the vertices of each stroke, px.
    pub(super) boxes: Vec<[[f32; 2]; 2]>,
    /// Memory for the polylines of [`CHUNK`] strokes each.
    parts: Vec<Self>,
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
        let count = strokes.len().div_ceil(CHUNK);
        self.parts.resize_with(count, Self::default);
        let parts = self.parts.par_iter_mut().enumerate();
        parts.for_each(|(chunk, part)| {
            part.clear();
            for i in chunk * CHUNK..strokes.len().min((chunk + 1) * CHUNK) {
                part.push(strokes.get(i), least);
            }
        });
        let parts = std::mem::take(&mut self.parts);
        self.clear();
        for part in &parts {
            let before = self.vertices.len() as u32;
            self.firsts
                .extend(part.firsts.iter().map(|first| before + first));
            self.vertices.extend(&part.vertices);
            self.looks.extend(&part.looks);
            self.boxes.extend(&part.boxes);
        }
        self.firsts.push(self.vertices.len() as u32);
        self.parts = parts;
    }

    fn clear(&mut self) {
        self.vertices.clear();
        self.firsts.clear();
        self.looks.clear();
        self.boxes.clear();
    }

    fn push(&mut self, stroke: StrokeRef<'_>, least: usize) {
        let first = self.vertices.len();
        self.firsts.push(first as u32);
        // A radius that is no number touches no tile: such a stroke draws nothing, and its derivatives are 0.
        let is_finite = stroke.is_finite();
        self.looks.push(if is_finite {
            *stroke.look
        } else {
            [f32::NAN; LOOK]
        });
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
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for vertex in &self.vertices[first..] {
            for axis in 0..2 {
                low[axis] = low[axis].min(vertex[axis]);
                high[axis] = high[axis].max(vertex[axis]);
            }
        }
        self.boxes.push([low, high]);
    }
}

/// Calls `visit` with the vertices of a path, in order.
pub(super) fn walk(stroke: StrokeRef<'_>, least: usize, mut visit: impl FnMut(Vertex)) {
    let mut pieces = Pieces::of(stroke).peekable();
    let Some(first) = pieces.peek() else {
        visit(Vertex::at(0));
        visit(Vertex::at(0));
        return;
    };
    visit(first.from.vertex());
    for piece in pieces {
        piece.vertices(stroke, least).for_each(&mut visit);
    }
}

/// A point that a path goes through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Knot {
    /// A point on the path.
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

    /// The point other than `control` that the knot depends on, and the shares of both.
    fn shares(self, control: usize) -> (usize, [f32; 2]) {
        match self {
            Self::Point(i) => (i, [1.0, 0.0]),
            Self::Between(i, k) => (if i == control { k } else { i }, [0.5, 0.5]),
        }
    }

    /// The place of the knot.
    pub(crate) fn place(self, points: &[[f32; 2]]) -> [f32; 2] {
        self.vertex().place(points)
    }
}

/// A line, or a curve with one control point, as indices of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Piece {
    pub(crate) from: Knot,
    /// The point off the path between the two knots.
    pub(crate) control: Option<usize>,
    pub(crate) to: Knot,
}

impl Piece {
    /// How many segments the piece becomes.
    pub(crate) fn steps(&self, stroke: StrokeRef<'_>, least: usize) -> usize {
        let Some(control) = self.control else {
            return least;
        };
        let points = stroke.points;
        let (a, c, b) = (
            self.from.place(points),
            points[control],
            self.to.place(points),
        );
        let bend = [0, 1].map(|k| a[k] - 2.0 * c[k] + b[k]);
        sdf::steps(Vector::from(bend), f64::from(stroke.flatness())).max(least)
    }

    /// The vertices of the piece behind its start.
    fn vertices(self, stroke: StrokeRef<'_>, least: usize) -> impl Iterator<Item = Vertex> {
        let steps = self.steps(stroke, least);
        let within = (1..steps).map(move |step| self.vertex(step as f32 / steps as f32));
        within.chain([self.to.vertex()])
    }

    /// Whether the piece changes with point `k`.
    pub(crate) fn depends_on(&self, k: usize) -> bool {
        let of = |knot: Knot| match knot {
            Knot::Point(i) => i == k,
            Knot::Between(i, j) => i == k || j == k,
        };
        self.control == Some(k) || of(self.from) || of(self.to)
    }

    /// The vertex at parameter `t` between the knots.
    fn vertex(&self, t: f32) -> Vertex {
        let Some(control) = self.control else {
            let index = |knot: Knot| knot.shares(usize::MAX).0;
            return Vertex {
                of: [index(self.from), index(self.to), index(self.to)],
                weights: [1.0 - t, t, 0.0],
            };
        };
        let (a, b, c) = ((1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t), t * t);
        let (start, [of_start, start_of_control]) = self.from.shares(control);
        let (end, [of_end, end_of_control]) = self.to.shares(control);
        Vertex {
            of: [start, control, end],
            weights: [
                a * of_start,
                b + a * start_of_control + c * end_of_control,
                c * of_end,
            ],
        }
    }
}

/// The pieces of a path, in drawing order; none for a dot.
#[derive(Debug, Clone)]
pub(crate) struct Pieces<'a> {
    off: &'a [bool],
    from: Knot,
    /// The index of the next point; a closed path goes on from 0 beyond its last point.
    next: usize,
    end: usize,
}

impl<'a> Pieces<'a> {
    /// The pieces of `stroke`.
    pub(crate) fn of(stroke: StrokeRef<'a>) -> Self {
        let (off, count) = (stroke.off, stroke.off.len());
        let first = off.iter().position(|off| !off);
        // All points of a closed path may be off: it starts halfway between the last one and the first.
        let (from, next) = match first {
            Some(first) => (Knot::Point(first), first + 1),
            None => (Knot::Between(count.saturating_sub(1), 0), 0),
        };
        let end = match (count, stroke.closed) {
            (0 | 1, _) => 0,
            (_, true) => next + count,
            (_, false) => count,
        };
        Self {
            off,
            from,
            next,
            end,
        }
    }
}

impl Iterator for Pieces<'_> {
    type Item = Piece;

    fn next(&mut self) -> Option<Piece> {
        if self.next >= self.end {
            return None;
        }
        let (count, from) = (self.off.len(), self.from);
        let point = self.next % count;
        self.next += 1;
        let control = self.off[point].then_some(point);
        self.from = match control {
            None => Knot::Point(point),
            Some(_) if self.off[self.next % count] => Knot::Between(point, self.next % count),
            Some(_) => {
                self.next += 1;
                Knot::Point((self.next - 1) % count)
            }
        };
        Some(Piece {
            from,
            control,
            to: self.from,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Point;
    use crate::rng;

    /// Strokes of one to six points of all kinds, open and closed.
    fn strokes() -> Strokes {
        let mut strokes = Strokes::new();
        for count in 1..7_u32 {
            for (kinds, closed) in (0..1_u32 << count).flat_map(|k| [(k, false), (k, true)]) {
                let is_end = |k: u32| (!closed || count == 1) && (k == 0 || k == count - 1);
                let off: Vec<bool> = (0..count)
                    .map(|k| kinds >> k & 1 == 1 && !is_end(k))
                    .collect();
                let place = |k: u32| {
                    [0, 1].map(|axis| 90.0 * rng::draw(axis, u64::from(kinds), u64::from(k), 0))
                };
                let points: Vec<[f32; 2]> = (0..count).map(place).collect();
                strokes.push(StrokeRef {
                    points: &points,
                    off: &off,
                    closed,
                    look: &[1.0, 1.0, 1.0, 1.0, [0.2, 0.6, 1.0][kinds as usize % 3]],
                });
            }
        }
        strokes
    }

    fn for_reference(stroke: StrokeRef<'_>) -> sdf::Path<f32> {
        sdf::Path {
            points: stroke.points.iter().map(|&p| Point::from(p)).collect(),
            off: stroke.off.to_vec(),
            closed: stroke.closed,
            radius: 1.0,
            flatness: stroke.flatness(),
        }
    }

    /// The shares of the points in a vertex.
    fn shares(count: usize, of: impl Iterator<Item = (usize, f32)>) -> Vec<f32> {
        let mut shares = vec![0.0; count];
        of.for_each(|(i, weight)| shares[i] += weight);
        shares
    }

    #[test]
    fn vertices_and_weights_are_those_of_the_distance_field() {
        for stroke in strokes().iter() {
            let count = stroke.points.len();
            let mut weights = Vec::new();
            walk(stroke, 1, |vertex| {
                weights.push(shares(count, vertex.of.into_iter().zip(vertex.weights)));
            });
            if count == 1 {
                // The renderer's dot is a segment of no length.
                weights.pop();
            }
            let means = for_reference(stroke).flattened().means;
            assert_eq!(weights.len(), means.len(), "{stroke:?}");
            for (got, mean) in weights.iter().zip(means) {
                let expected = shares(count, mean.0.into_iter());
                let apart = got.iter().zip(&expected).map(|(g, e)| (g - e).abs());
                assert!(
                    apart.fold(0.0, f32::max) < 1e-6,
                    "{stroke:?}: {got:?} {expected:?}"
                );
            }
        }
    }

    #[test]
    fn translucent_strokes_have_fewer_segments() {
        let segments = |opacity: f32| {
            let hook = StrokeRef {
                points: &[[0.0, 0.0], [40.0, 0.0], [40.0, 40.0]],
                off: &[false, true, false],
                closed: false,
                look: &[1.0, 1.0, 1.0, 1.0, opacity],
            };
            let mut count = 0;
            walk(hook, 1, |_| count += 1);
            count - 1
        };
        // The square root of the bend, 57 px, over four times 0.08, 0.32 and 0.5 px.
        assert_eq!([1.0, 0.5, 0.1, 0.0].map(segments), [14, 7, 6, 6]);
    }

    #[test]
    fn a_flat_scene_has_the_vertices_of_its_paths() {
        let (strokes, mut flat) = (strokes(), Flat::default());
        for least in [1, 3] {
            flat.fill(&strokes, least);
            for (i, stroke) in strokes.iter().enumerate() {
                let mut expected = Vec::new();
                walk(stroke, least, |vertex| {
                    expected.push(vertex.place(stroke.points))
                });
                let range = flat.firsts[i] as usize..flat.firsts[i + 1] as usize;
                assert_eq!(flat.vertices[range], expected, "{stroke:?}");
                assert!(expected.len() > least || stroke.points.len() == 1);
            }
        }
    }
}
