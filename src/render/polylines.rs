//! Flattening: paths to polylines, and derivatives by the vertices of polylines to derivatives by points of paths.
//!
//! The renderer knows polylines alone. Each line of a path is one segment or more, and each Bézier curve as
//! many as [`steps`] says, at equal steps of its parameter. So every vertex is a mean, with fixed weights, of the
//! ends of its piece and the control points between them: flattening is linear, and the derivative by a point is the same
//! weights times the derivatives by the vertices. For circular arcs see [`arcs`].

use rayon::prelude::*;

use super::arcs::{self, Spread};
use super::crossings::Crossings;
use super::gradients::add;
use super::paint::Ink;
use super::strokes::{STYLE, StrokeRef, Strokes, steps};
use crate::math;
use crate::rng;
use crate::scene::{Arc, PointKind};

/// The vertex between the rings of an area: no segment that has it is drawn.
const BETWEEN_RINGS: [f32; 2] = [f32::NAN; 2];

/// Strokes that are flattened at a time.
pub(super) const CHUNK: usize = 32;

/// Strokes as polylines.
#[derive(Debug, Default)]
pub(super) struct Polylines {
    /// The vertices of all polylines, px.
    pub(super) vertices: Vec<[f32; 2]>,
    /// The first vertex of each stroke, and behind the last stroke the number of all vertices. A polyline has at least
    /// one segment; the segment of a dot has no length.
    pub(super) firsts: Vec<u32>,
    /// Radius, red, green, blue and opacity of each stroke.
    pub(super) styles: Vec<[f32; STYLE]>,
    /// For each stroke, true if it is an area.
    pub(super) areas: Vec<bool>,
    /// The gradients of some strokes, each with the index of its stroke.
    inks: Vec<(usize, Ink)>,
    /// The smallest and the largest x and y of the vertices of each stroke, px.
    pub(super) boxes: Vec<[[f32; 2]; 2]>,
    /// Number of segments of each curve, curve by curve.
    curves: Vec<u32>,
    /// The first curve of each stroke in that list.
    first_curves: Vec<u32>,
    /// The segments of areas, by rows of tiles.
    pub(super) crossings: Crossings,
    /// Memory for the polylines of [`CHUNK`] strokes each.
    parts: Vec<Self>,
}

impl Polylines {
    /// Flattens `strokes`, on a page of so many `rows` of tiles. Each line and each curve becomes `least` segments or more.
    pub(super) fn fill(&mut self, strokes: &Strokes, least: usize, rows: usize) {
        // Flatten chunks of strokes in parallel, each into memory that it keeps from call to call.
        let count = strokes.len().div_ceil(CHUNK);
        self.parts.resize_with(count, Self::default);
        let parts = self.parts.par_iter_mut().enumerate();
        parts.for_each(|(chunk, part)| {
            part.clear();
            for i in chunk * CHUNK..strokes.len().min((chunk + 1) * CHUNK) {
                part.push(strokes.get(i), least);
            }
        });
        // Join the chunks in their order, so that threads change nothing.
        let parts = std::mem::take(&mut self.parts);
        self.clear();
        for part in &parts {
            // Indices of a chunk count from its own start.
            let after = |count: usize| move |first: &u32| count as u32 + first;
            let firsts = part.firsts.iter().map(after(self.vertices.len()));
            self.firsts.extend(firsts);
            let firsts = part.first_curves.iter().map(after(self.curves.len()));
            self.first_curves.extend(firsts);
            self.curves.extend(&part.curves);
            let before = self.styles.len();
            let inks = part.inks.iter();
            self.inks
                .extend(inks.map(|(i, ink)| (before + i, ink.clone())));
            self.vertices.extend(&part.vertices);
            self.styles.extend(&part.styles);
            self.areas.extend(&part.areas);
            self.boxes.extend(&part.boxes);
        }
        // One more entry, so that `firsts[i]..firsts[i + 1]` holds for the last stroke, too.
        self.firsts.push(self.vertices.len() as u32);
        self.parts = parts;
        // Areas wind around pixels far from their contours, so each row of tiles lists the segments that cross it.
        self.crossings.clear(rows);
        for (area, _) in self
            .areas
            .iter()
            .enumerate()
            .filter(|(_, is_area)| **is_area)
        {
            let [first, end] = [area, area + 1].map(|i| self.firsts[i] as usize);
            self.crossings.add(area as u32, &self.vertices[first..end]);
        }
    }

    fn clear(&mut self) {
        self.vertices.clear();
        self.firsts.clear();
        self.styles.clear();
        self.areas.clear();
        self.inks.clear();
        self.boxes.clear();
        self.curves.clear();
        self.first_curves.clear();
    }

    fn push(&mut self, stroke: StrokeRef<'_>, least: usize) {
        let first = self.vertices.len();
        self.firsts.push(first as u32);
        // A radius that is no number touches no tile: such a stroke draws nothing, and its derivatives are 0.
        let is_finite = stroke.is_finite();
        self.styles.push(if is_finite {
            *stroke.style
        } else {
            [f32::NAN; STYLE]
        });
        if let Some(paint) = stroke.paint {
            self.inks.push((self.areas.len(), Ink::of(paint)));
        }
        self.areas.push(stroke.is_area());
        self.first_curves.push(self.curves.len() as u32);
        // A path of lines is its own polyline.
        if least == 1 && stroke.is_straight() && !stroke.is_area() {
            self.vertices.extend(stroke.points);
            if stroke.closed || stroke.points.len() == 1 {
                self.vertices.push(stroke.points[0]);
            }
        } else {
            flatten(stroke, least, &mut self.vertices, &mut self.curves);
        }
        // `min` and `max` of floats skip NaN, so the vertex between rings doesn't count.
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for vertex in &self.vertices[first..] {
            for axis in 0..2 {
                low[axis] = low[axis].min(vertex[axis]);
                high[axis] = high[axis].max(vertex[axis]);
            }
        }
        self.boxes.push([low, high]);
    }

    /// For each stroke a hash of all that its picture depends on.
    pub(super) fn fingerprints(&self) -> Vec<u64> {
        let of = |i: usize| {
            let vertices = &self.vertices[self.firsts[i] as usize..self.firsts[i + 1] as usize];
            let style = self.styles[i].map(|v| u64::from(v.to_bits()));
            let ink = self.ink(i).into_iter().flat_map(Ink::bits);
            let places = vertices.iter().map(|v| {
                let [x, y] = v.map(|v| u64::from(v.to_bits()));
                x << 32 | y
            });
            let words = style.into_iter().chain(ink).chain(places);
            words.fold(u64::from(self.areas[i]), rng::with)
        };
        (0..self.styles.len()).into_par_iter().map(of).collect()
    }

    /// The gradient of stroke `i`, if it has one.
    #[inline(always)]
    pub(super) fn ink(&self, i: usize) -> Option<&Ink> {
        if self.inks.is_empty() {
            return None;
        }
        // Inks are added stroke by stroke, so they are sorted.
        let at = self.inks.binary_search_by_key(&i, |(stroke, _)| *stroke);
        at.ok().map(|at| &self.inks[at].1)
    }

    /// Adds the derivatives by the vertices of stroke `i` to those by its points.
    pub(super) fn hand_back(
        &self,
        i: usize,
        stroke: StrokeRef<'_>,
        least: usize,
        slopes: &[[f32; 2]],
        points: &mut [[f32; 2]],
    ) {
        // Points and vertices are the same: nothing to weigh.
        if slopes.len() == points.len() && stroke.is_straight() {
            add(points.as_flattened_mut(), slopes.as_flattened());
            return;
        }
        // The number of segments of each curve is the one that `flatten` has used, so that slopes and vertices match.
        let mut curves = self.curves[self.first_curves[i] as usize..].iter();
        let mut rest = slopes;
        for (first, path) in stroke.paths() {
            let points = &mut points[first..][..path.points.len()];
            let count = hand_back(path, least, &mut curves, rest, points);
            // Behind a ring is the vertex that no segment has.
            rest = rest.get(count + 1..).unwrap_or_default();
        }
    }
}

/// Adds the derivatives by the vertices of a path to those by its points, and returns the number of its vertices. `curves`
/// has the numbers of segments of its curves.
fn hand_back<'a>(
    path: StrokeRef<'_>,
    least: usize,
    curves: &mut impl Iterator<Item = &'a u32>,
    slopes: &[[f32; 2]],
    points: &mut [[f32; 2]],
) -> usize {
    let mut pieces = Pieces::of(path).peekable();
    let Some(first) = pieces.peek() else {
        // A dot: both ends of its segment are its only point.
        let dot = &slopes[..2];
        dot.iter().for_each(|slope| add(&mut points[0], slope));
        return dot.len();
    };
    // The first vertex stands for a knot alone; every other one belongs to the piece that it ends.
    first.from.hand_back(slopes[0], points);
    let mut at = 1;
    for piece in pieces {
        let steps = match piece.between {
            Between::Line => least,
            _ => curves.next().map_or(0, |&steps| steps as usize),
        };
        piece.hand_back(path, &slopes[at..at + steps], points);
        at += steps;
    }
    at
}

/// Appends the vertices of the polylines that replace a stroke, and the number of segments of each curve. Between two rings
/// of an area there is a vertex that is no number.
pub(super) fn flatten(
    stroke: StrokeRef<'_>,
    least: usize,
    vertices: &mut Vec<[f32; 2]>,
    curves: &mut Vec<u32>,
) {
    for (first, path) in stroke.paths() {
        if first > 0 {
            vertices.push(BETWEEN_RINGS);
        }
        let mut pieces = Pieces::of(path).peekable();
        // Every piece adds the vertices behind its start, so the first knot comes before all. A dot has no piece: its point twice
        // is a segment of no length.
        match pieces.peek() {
            Some(first) => vertices.push(first.from.place(path.points)),
            None => vertices.extend([path.points[0]; 2]),
        }
        for piece in pieces {
            let steps = piece.steps(path, least);
            if piece.between != Between::Line {
                curves.push(steps as u32);
            }
            piece.flatten(path, steps, vertices);
        }
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
    /// The point of the knot, px.
    pub(crate) fn place(self, points: &[[f32; 2]]) -> [f32; 2] {
        match self {
            Self::Point(i) => points[i],
            Self::Between(i, k) => [0, 1].map(|axis| 0.5 * points[i][axis] + 0.5 * points[k][axis]),
        }
    }

    /// Adds the derivative by the knot to those by the points that it depends on.
    fn hand_back(self, slope: [f32; 2], points: &mut [[f32; 2]]) {
        match self {
            Self::Point(i) => add(&mut points[i], &slope),
            Self::Between(i, k) => {
                let half = slope.map(|v| 0.5 * v);
                add(&mut points[i], &half);
                add(&mut points[k], &half);
            }
        }
    }
}

/// What lies between the knots of a piece, as indices of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Between {
    Line,
    /// The control point of a quadratic curve.
    Quad(usize),
    /// The control points of a cubic curve.
    Cubic([usize; 2]),
    /// The point of an arc between its ends.
    Arc(usize),
}

/// A line, a curve or an arc, as indices of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Piece {
    pub(crate) from: Knot,
    pub(crate) between: Between,
    pub(crate) to: Knot,
}

impl Piece {
    /// The control point of a quadratic curve.
    pub(crate) fn control(&self) -> Option<usize> {
        match self.between {
            Between::Quad(control) => Some(control),
            _ => None,
        }
    }

    /// Number of segments that the piece becomes.
    pub(crate) fn steps(&self, stroke: StrokeRef<'_>, least: usize) -> usize {
        let points = stroke.points;
        let (a, b) = (self.from.place(points), self.to.place(points));
        let within = |bend: f32| steps(f64::from(bend), f64::from(stroke.flatness())).max(least);
        match self.between {
            Between::Line => least,
            // The second difference: how far chords are from the curve depends on it and the number of steps alone.
            Between::Quad(control) => within(bend([a, points[control], b])),
            // The second derivative is 2 times the second difference for a quadratic curve. For a cubic one it is at most 6 times
            // the larger one of both.
            Between::Cubic([c, d]) => {
                let [c, d] = [points[c], points[d]];
                within(3.0 * bend([a, c, d]).max(bend([c, d, b])))
            }
            Between::Arc(through) => self
                .spread(stroke, &self.arc(points, through), least)
                .map_or(least, |spread| spread.steps),
        }
    }

    /// The arc with the point `through`.
    fn arc(&self, points: &[[f32; 2]], through: usize) -> Arc {
        let [from, through, to] = [
            self.from.place(points),
            points[through],
            self.to.place(points),
        ]
        .map(math::point);
        Arc { from, through, to }
    }

    fn spread(&self, stroke: StrokeRef<'_>, arc: &Arc, least: usize) -> Option<Spread> {
        Spread::of(arc, stroke.flatness().into(), least)
    }

    /// Appends the vertices of the piece behind its start, as one of so many segments.
    fn flatten(&self, stroke: StrokeRef<'_>, steps: usize, vertices: &mut Vec<[f32; 2]>) {
        let points = stroke.points;
        let (a, b) = (self.from.place(points), self.to.place(points));
        match self.between {
            Between::Line | Between::Quad(_) => {
                // The control point of a line has weight 0, so any number does in its place.
                let c = self.control().map_or(a, |control| points[control]);
                vertices.extend((1..=steps).map(|step| {
                    let [of_a, of_c, of_b] = self.weights(step, steps);
                    [0, 1].map(|axis| of_a * a[axis] + of_c * c[axis] + of_b * b[axis])
                }));
            }
            Between::Cubic([c, d]) => {
                let corners = [a, points[c], points[d], b];
                vertices.extend((1..=steps).map(|step| {
                    let weights = cubic_weights(step, steps);
                    [0, 1].map(|axis| (0..4).map(|k| weights[k] * corners[k][axis]).sum())
                }));
            }
            Between::Arc(through) => self.flatten_arc(stroke, through, steps, vertices),
        }
    }

    /// As [`flatten`](Self::flatten), of an arc with the point `through`.
    fn flatten_arc(
        &self,
        stroke: StrokeRef<'_>,
        through: usize,
        steps: usize,
        vertices: &mut Vec<[f32; 2]>,
    ) {
        let arc = self.arc(stroke.points, through);
        let Some(spread) = self.spread(stroke, &arc, steps) else {
            let between = Between::Line;
            return Self { between, ..*self }.flatten(stroke, steps, vertices);
        };
        let places = spread.weights().map(|weights| arcs::vertex(&arc, weights));
        vertices.extend(places.map(|at| math::xy(at.to_point())));
    }

    /// The weights of the start, the control point and the end in the vertex after `step` of so many segments of a line or a
    /// quadratic curve.
    fn weights(&self, step: usize, steps: usize) -> [f32; 3] {
        // A line is (1−t)a + tb; a quadratic Bézier curve is (1−t)²a + 2t(1−t)c + t²b.
        let t = step as f32 / steps as f32;
        let s = 1.0 - t;
        match self.between {
            Between::Quad(_) => [s * s, 2.0 * t * s, t * t],
            _ => [s, 0.0, t],
        }
    }

    /// Adds the derivatives by the vertices behind the start to those by the points that they depend on.
    fn hand_back(&self, stroke: StrokeRef<'_>, slopes: &[[f32; 2]], points: &mut [[f32; 2]]) {
        // The transpose of `flatten`: each vertex gives its derivative to the points, by the same weights.
        let steps = slopes.len();
        let of_line = || sums(slopes, |step| self.weights(step, steps));
        let ([by_start, by_end], between) = match self.between {
            Between::Line => {
                let [by_start, _, by_end] = of_line();
                ([by_start, by_end], [None; 2])
            }
            Between::Quad(c) => {
                let [by_start, by_control, by_end] = of_line();
                ([by_start, by_end], [Some((c, by_control)), None])
            }
            Between::Cubic([c, d]) => {
                let [by_start, by_c, by_d, by_end] =
                    sums(slopes, |step| cubic_weights(step, steps));
                ([by_start, by_end], [Some((c, by_c)), Some((d, by_d))])
            }
            Between::Arc(through) => {
                let arc = self.arc(stroke.points, through);
                let spread = self.spread(stroke, &arc, steps);
                let handed_back = spread.map(|spread| arcs::hand_back(&arc, spread, slopes));
                let [by_start, by_through, by_end] = handed_back.unwrap_or_else(of_line);
                ([by_start, by_end], [Some((through, by_through)), None])
            }
        };
        self.from.hand_back(by_start, points);
        self.to.hand_back(by_end, points);
        for (k, by) in between.into_iter().flatten() {
            add(&mut points[k], &by);
        }
    }

    /// True if the piece changes with point `k`.
    pub(crate) fn depends_on(&self, k: usize) -> bool {
        let of = |knot: Knot| match knot {
            Knot::Point(i) => i == k,
            Knot::Between(i, j) => i == k || j == k,
        };
        let is_between = match self.between {
            Between::Line => false,
            Between::Quad(i) | Between::Arc(i) => i == k,
            Between::Cubic(controls) => controls.contains(&k),
        };
        is_between || of(self.from) || of(self.to)
    }
}

/// The length of the second difference of three points, px.
fn bend([a, c, b]: [[f32; 2]; 3]) -> f32 {
    let bend = [0, 1].map(|k| a[k] - 2.0 * c[k] + b[k]);
    (bend[0] * bend[0] + bend[1] * bend[1]).sqrt()
}

/// The weights of the four points of a cubic curve in the vertex after `step` of so many segments.
fn cubic_weights(step: usize, steps: usize) -> [f32; 4] {
    let t = step as f32 / steps as f32;
    let s = 1.0 - t;
    [s * s * s, 3.0 * t * s * s, 3.0 * t * t * s, t * t * t]
}

/// The derivatives by vertices, times the weights of each of `N` points in the vertex after each step.
fn sums<const N: usize>(slopes: &[[f32; 2]], weights: impl Fn(usize) -> [f32; N]) -> [[f32; 2]; N] {
    let mut sums = [[0.0; 2]; N];
    for (step, slope) in (1..).zip(slopes) {
        for (sum, weight) in sums.iter_mut().zip(weights(step)) {
            add(sum, &slope.map(|v| weight * v));
        }
    }
    sums
}

/// The pieces of a path, in drawing order; none for a dot.
#[derive(Debug, Clone)]
pub(crate) struct Pieces<'a> {
    kinds: &'a [PointKind],
    from: Knot,
    /// The index of the next point; a closed path goes on from 0 beyond its last point.
    next: usize,
    end: usize,
}

impl<'a> Pieces<'a> {
    /// The pieces of `stroke`.
    pub(crate) fn of(stroke: StrokeRef<'a>) -> Self {
        let (kinds, count) = (stroke.kinds, stroke.kinds.len());
        // A closed path may start anywhere: it starts at its first point that is on it.
        let first = kinds.iter().position(|kind| *kind == PointKind::On);
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
            kinds,
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
        let from = self.from;
        let point = self.pass();
        // A point on the path ends a line. The control point of a quadratic curve is followed by another one, and then the curve
        // ends halfway between them, or by the point that the curve ends at; the points of cubic curves and arcs by their ends.
        let between = match self.kinds[point] {
            PointKind::On => Between::Line,
            PointKind::Quad => Between::Quad(point),
            PointKind::Cubic => Between::Cubic([point, self.pass()]),
            PointKind::Arc => Between::Arc(point),
        };
        let next = self.next % self.kinds.len();
        self.from = match between {
            Between::Line => Knot::Point(point),
            Between::Quad(_) if self.kinds[next] == PointKind::Quad => Knot::Between(point, next),
            _ => Knot::Point(self.pass()),
        };
        Some(Piece {
            from,
            between,
            to: self.from,
        })
    }
}

impl Pieces<'_> {
    /// The index of the next point, which is passed. Ends of an open path are on it, so only a closed path wraps around.
    fn pass(&mut self) -> usize {
        self.next += 1;
        (self.next - 1) % self.kinds.len()
    }
}

#[cfg(test)]
mod tests {
    use super::super::reference;
    use super::*;
    use crate::math::Vec2;
    use crate::rng;

    /// Strokes of one to six points of lines and quadratic curves, open and closed, and some with all kinds of pieces.
    fn strokes() -> Strokes {
        use PointKind::{Arc, Cubic, On, Quad};
        let mut strokes = Strokes::new();
        let mut push = |kinds: &[PointKind], closed: bool| {
            let seed = strokes.len() as u64;
            let place = |k: u64| [0, 1].map(|axis| 90.0 * rng::draw(axis, seed, k, 0));
            let points: Vec<[f32; 2]> = (0..kinds.len() as u64).map(place).collect();
            strokes.push(StrokeRef {
                points: &points,
                kinds,
                closed,
                rings: &[],
                form: None,
                paint: None,
                sweep: None,
                style: &[1.0, 1.0, 1.0, 1.0, [0.2, 0.6, 1.0][strokes.len() % 3]],
            });
        };
        for count in 1..7_u32 {
            for (kinds, closed) in (0..1_u32 << count).flat_map(|k| [(k, false), (k, true)]) {
                let is_end = |k: u32| (!closed || count == 1) && (k == 0 || k == count - 1);
                let is_on = |k: u32| kinds >> k & 1 == 0 || is_end(k);
                let kinds: Vec<PointKind> =
                    (0..count).map(|k| PointKind::on_if(is_on(k))).collect();
                push(&kinds, closed);
            }
        }
        for _ in 0..20 {
            push(&[On, Arc, On], false);
            push(&[On, Cubic, Cubic, On], false);
            push(&[On, Arc, On, Quad, On, Cubic, Cubic, On, On], false);
            push(&[On, Arc, On, Arc], true);
            push(&[On, Cubic, Cubic], true);
            push(&[Arc, On, Quad, Quad, On, Cubic, Cubic, On], true);
            push(&[Cubic, On, On, Arc, On, Cubic], true);
        }
        strokes
    }

    /// Derivatives that each vertex hands back to each point, complex numbers; of curves the weight of the point in the vertex.
    fn weights(polylines: &Polylines, i: usize, stroke: StrokeRef<'_>) -> Vec<Vec<Vec2>> {
        let count = (polylines.firsts[i + 1] - polylines.firsts[i]) as usize;
        let weights = |vertex: usize| {
            let by = |slope: [f32; 2]| {
                let mut slopes = vec![[0.0; 2]; count];
                slopes[vertex] = slope;
                let mut points = vec![[0.0; 2]; stroke.points.len()];
                polylines.hand_back(i, stroke, 1, &slopes, &mut points);
                points
            };
            let (by_x, by_y) = (by([1.0, 0.0]), by([0.0, 1.0]));
            let weight = |(x, y): (&[f32; 2], &[f32; 2])| {
                assert_eq!((x[0], -x[1]), (y[1], y[0]), "{stroke:?}");
                Vec2::new(x[0].into(), (-x[1]).into())
            };
            by_x.iter().zip(&by_y).map(weight).collect()
        };
        (0..count).map(weights).collect()
    }

    #[test]
    fn vertices_hand_back_to_points_by_the_weights_of_the_distance_field() {
        let (strokes, mut polylines) = (strokes(), Polylines::default());
        polylines.fill(&strokes, 1, 1);
        for (i, stroke) in strokes.iter().enumerate() {
            let count = stroke.points.len();
            let mut weights = weights(&polylines, i, stroke);
            if count == 1 {
                // The renderer's dot is a segment of no length.
                weights.pop();
            }
            let means = reference::Stroke::from(stroke).outline().means;
            assert_eq!(weights.len(), means.len(), "{stroke:?}");
            for (got, mean) in weights.iter().zip(means) {
                let mut expected = vec![Vec2::ZERO; count];
                for (k, weight) in mean.0 {
                    expected[k] += weight;
                }
                let apart = got
                    .iter()
                    .zip(&expected)
                    .map(|(g, e)| (*g - *e).hypot() / (1.0 + e.hypot()));
                assert!(
                    apart.fold(0.0, f64::max) < 1e-6,
                    "{stroke:?}: {got:?} {expected:?}"
                );
            }
        }
    }

    #[test]
    fn vertices_are_the_weighted_means_of_points() {
        let (strokes, mut polylines) = (strokes(), Polylines::default());
        polylines.fill(&strokes, 1, 1);
        for (i, stroke) in strokes.iter().enumerate() {
            let vertices = &polylines.vertices[polylines.firsts[i] as usize..];
            for (vertex, weights) in vertices.iter().zip(weights(&polylines, i, stroke)) {
                // Where weights turn, they are products of complex numbers; arcs that grow with their points have this sum, too.
                let terms = weights.iter().zip(stroke.points);
                let mean = terms.fold(Vec2::ZERO, |sum, (w, p)| {
                    let p = math::point(*p).to_vec2();
                    sum + p * w.x + p.turn_90() * w.y
                });
                let size = weights.iter().map(|w| w.hypot()).sum::<f64>();
                let away = (math::point(*vertex).to_vec2() - mean).hypot();
                assert!(away < 1e-4 * size, "{stroke:?}");
            }
        }
    }

    #[test]
    fn translucent_strokes_have_fewer_segments() {
        let segments = |opacity: f32| {
            let hook = StrokeRef {
                points: &[[0.0, 0.0], [40.0, 0.0], [40.0, 40.0]],
                kinds: &[PointKind::On, PointKind::Quad, PointKind::On],
                closed: false,
                rings: &[],
                form: None,
                paint: None,
                sweep: None,
                style: &[1.0, 1.0, 1.0, 1.0, opacity],
            };
            let mut curves = Vec::new();
            flatten(hook, 1, &mut Vec::new(), &mut curves);
            curves[0]
        };
        // The square root of the bend, 57 px, over four times 0.08, 0.32 and 0.5 px.
        assert_eq!([1.0, 0.5, 0.1, 0.0].map(segments), [14, 7, 6, 6]);
    }

    #[test]
    fn a_flattened_scene_has_the_vertices_of_its_paths() {
        let (strokes, mut polylines) = (strokes(), Polylines::default());
        for least in [1, 3] {
            polylines.fill(&strokes, least, 1);
            for (i, stroke) in strokes.iter().enumerate() {
                let mut expected = Vec::new();
                flatten(stroke, least, &mut expected, &mut Vec::new());
                let range = polylines.firsts[i] as usize..polylines.firsts[i + 1] as usize;
                assert_eq!(polylines.vertices[range], expected, "{stroke:?}");
                assert!(expected.len() > least || stroke.points.len() == 1);
            }
        }
    }
}
