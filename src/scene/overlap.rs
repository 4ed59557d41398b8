//! Precedence: which marks may share a pixel, so that their order matters, and what follows for reordering them.

use kurbo::{Line, ParamCurveNearest, Rect};

use super::Mark;
use super::path::is_inside;
use crate::math::Point;

/// Precedence of marks: which ones have to be drawn before which.
#[derive(Debug, Clone)]
pub(crate) struct Precedence {
    /// The later marks that have to stay above each mark, in order.
    above: Vec<Vec<usize>>,
    /// The earlier marks that have to stay below each mark, in order.
    below: Vec<Vec<usize>>,
}

impl Precedence {
    /// Precedence of marks of given colours: two that may share a pixel keep their order if they differ in colour or if one has a
    /// gradient. Layers of one colour give the same result in either order.
    pub(crate) fn of<'a>(marks: impl IntoIterator<Item = &'a Mark>) -> Self {
        let matters = |a: &Mark, b: &Mark| {
            a.color() != b.color() || a.shade().is_some() || b.shade().is_some()
        };
        Self::where_matters(marks.into_iter().map(Some), matters)
    }

    /// Precedence of marks of any colours: all that may share a pixel keep their order. `None` is a mark that leaves no ink.
    pub(crate) fn of_shapes<'a>(marks: impl IntoIterator<Item = Option<&'a Mark>>) -> Self {
        Self::where_matters(marks, |_, _| true)
    }

    fn where_matters<'a>(
        marks: impl IntoIterator<Item = Option<&'a Mark>>,
        matters: impl Fn(&Mark, &Mark) -> bool,
    ) -> Self {
        let marks: Vec<Option<&Mark>> = marks.into_iter().collect();
        let none = vec![Vec::new(); marks.len()];
        let (mut above, mut below) = (none.clone(), none);
        let inked = marks.into_iter().enumerate();
        let inked = inked.filter_map(|(i, mark)| mark.map(|mark| (i, mark, Swept::new(mark))));
        // A sweep from left to right compares a mark with those alone that reach as far right as its left end.
        let mut from_left: Vec<_> = inked.collect();
        from_left.sort_by(|(_, _, a), (_, _, b)| {
            a.near
                .x0
                .total_cmp(&b.near.x0)
                .then(a.near.x1.total_cmp(&b.near.x1))
        });
        let mut open: Vec<&(usize, &Mark, Swept)> = Vec::new();
        for next in &from_left {
            let (i, mark, swept) = next;
            // Marks that end left of this one end left of all later ones, too, and are done with.
            open.retain(|(_, _, other)| other.near.x1 >= swept.near.x0);
            for (k, other, other_swept) in &open {
                // The cheap test first; the smaller index is the lower mark.
                if matters(mark, other) && swept.meets(other_swept) {
                    above[*i.min(k)].push(*i.max(k));
                    below[*i.max(k)].push(*i.min(k));
                }
            }
            open.push(next);
        }
        let lists = above.iter_mut().chain(&mut below);
        lists.for_each(|list| list.sort_unstable());
        Self { above, below }
    }

    /// The marks that have to come after this one and meet it, in order.
    pub(crate) fn above(&self, mark: usize) -> &[usize] {
        &self.above[mark]
    }

    /// The marks that have to come before this one and meet it, in order.
    pub(crate) fn below(&self, mark: usize) -> &[usize] {
        &self.below[mark]
    }

    /// The order in which marks become free to be drawn.
    pub(crate) fn waiting(&self) -> Waiting<'_> {
        Waiting {
            precedence: self,
            below: self.below.iter().map(Vec::len).collect(),
        }
    }
}

/// Marks that wait until all below them are drawn.
#[derive(Debug)]
pub(crate) struct Waiting<'a> {
    precedence: &'a Precedence,
    /// For each mark, the number of marks below it that are not drawn yet.
    below: Vec<usize>,
}

impl Waiting<'_> {
    /// The marks that may be drawn first.
    pub(crate) fn free(&self) -> Vec<usize> {
        let marks = 0..self.below.len();
        marks.filter(|&mark| self.below[mark] == 0).collect()
    }

    /// Draws a mark, and returns those that become free by it.
    pub(crate) fn draw(&mut self, mark: usize) -> Vec<usize> {
        let above = self.precedence.above(mark).iter().copied();
        let freed = above.filter(|&above| {
            self.below[above] -= 1;
            self.below[above] == 0
        });
        freed.collect()
    }
}

/// Precedence among bundles of marks, each drawn one directly after the other. A bundle goes by the number of one of its marks.
#[derive(Debug, Clone)]
pub(crate) struct Bundles {
    /// For each bundle, those that have to come later at some time: row by row, closed under transitivity.
    later: Vec<Vec<bool>>,
}

impl Bundles {
    /// A bundle for each mark.
    pub(crate) fn new(precedence: &Precedence) -> Self {
        let count = precedence.above.len();
        let mut later = vec![vec![false; count]; count];
        // From the top down, all that comes after an upper mark is known when the lower one is reached.
        for lower in (0..count).rev() {
            let mut row = vec![false; count];
            for &upper in precedence.above(lower) {
                unite(&mut row, &later[upper]);
                row[upper] = true;
            }
            later[lower] = row;
        }
        Self { later }
    }

    /// Merges bundle `k` into `i` unless a third one has to be drawn between the two; true if they are one now.
    pub(crate) fn try_join(&mut self, i: usize, k: usize) -> bool {
        let is_parted = |from: usize, to: usize| {
            let mut between = self.later[from].iter().zip(&self.later);
            between.any(|(&is_after, row)| is_after && row[to])
        };
        // A third bundle between the two would have to come both after and before the joined one.
        if is_parted(i, k) || is_parted(k, i) {
            return false;
        }
        let mut joined = std::mem::take(&mut self.later[k]);
        unite(&mut joined, &self.later[i]);
        // One of the two may have had to precede the other, which their order inside the bundle now says.
        (joined[i], joined[k]) = (false, false);
        // Whatever precedes one of the two precedes all that follows either; so the relation stays transitive. The row of `k` is
        // empty from here on.
        for row in self.later.iter_mut().filter(|row| !row.is_empty()) {
            if row[i] || row[k] {
                unite(row, &joined);
                (row[i], row[k]) = (true, false);
            }
        }
        self.later[i] = joined;
        true
    }
}

fn unite(row: &mut [bool], other: &[bool]) {
    row.iter_mut().zip(other).for_each(|(a, b)| *a |= b);
}

/// Where a mark may leave ink, prepared for comparisons with many others.
#[derive(Debug, Clone)]
struct Swept {
    /// Farthest that it reaches beyond its paths, px.
    reach: f64,
    /// A box around all that other marks can meet it in, px.
    near: Rect,
    /// Lines at most [`TOLERANCE`] away from its paths. A dot is a line without length.
    lines: Vec<Line>,
    is_area: bool,
    /// A point of each path.
    starts: Vec<Point>,
}

impl Swept {
    fn new(mark: &Mark) -> Self {
        let starts = mark.paths().iter().flat_map(|path| path.points().first());
        Self {
            reach: mark.reach(),
            near: mark.extent().inflate(0.5 * APART, 0.5 * APART),
            lines: mark.lines(TOLERANCE),
            is_area: mark.is_area(),
            starts: starts.map(|p| p.at).collect(),
        }
    }

    /// True if the order of the two marks can change the picture.
    fn meets(&self, other: &Self) -> bool {
        // Boxes, then outlines, then one mark wholly inside an area, where no outlines come near: in order of cost.
        let reach = self.reach + other.reach + APART;
        overlap(self.near, other.near)
            && (are_nearer(&self.lines, &other.lines, reach)
                || self.covers(other)
                || other.covers(self))
    }

    /// True if it is an area that a path of `other` starts in.
    fn covers(&self, other: &Self) -> bool {
        // One point of each path is enough: outlines don't come near each other, so a path is inside as a whole or not at all.
        self.is_area && other.starts.iter().any(|&p| is_inside(&self.lines, p))
    }
}

impl Mark {
    /// True if the order of the two marks can change the picture.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|mark| mark.extent().inflate(0.5 * APART, 0.5 * APART));
        overlap(a, b) && Swept::new(self).meets(&Swept::new(other))
    }

    /// True if it is an area that nearly all of `other` lies in.
    pub(crate) fn encloses(&self, other: &Self) -> bool {
        if !self.is_area() {
            return false;
        }
        let [rings, lines] = [self, other].map(|mark| mark.lines(TOLERANCE));
        let is_within = |line: &&Line| is_inside(&rings, line.p0);
        10 * lines.iter().filter(is_within).count() >= 9 * lines.len()
    }
}

/// True if two boxes have an inside in common.
fn overlap(a: Rect, b: Rect) -> bool {
    a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1
}

/// Marks farther apart than the diagonal of a pixel, px, have no pixel in common. The rest covers the distance of chords from
/// their curve.
const APART: f64 = 1.5;

/// Largest distance between lines and their curve, px: less than half of the excess of [`APART`] over the diagonal
/// of a pixel.
const TOLERANCE: f64 = 0.04;

/// True if some of these lines come nearer to each other than this.
fn are_nearer(a: &[Line], b: &[Line], reach: f64) -> bool {
    let around = |line: &Line| Rect::from_points(line.p0, line.p1);
    let is_near = |a: &Line, b: &Line| {
        // Boxes are compared first; the distance takes four projections.
        overlap(around(a).inflate(reach, reach), around(b)) && distance2(*a, *b) < reach * reach
    };
    a.iter().any(|a| b.iter().any(|b| is_near(a, b)))
}

/// The square of the distance of two lines.
fn distance2(a: Line, b: Line) -> f64 {
    if cross(a, b) {
        return 0.0;
    }
    // Two segments that don't cross are nearest at an end of one of them.
    let gap = |p: Point, line: Line| line.nearest(p, 0.0).distance_sq;
    let gaps = [gap(a.p0, b), gap(a.p1, b), gap(b.p0, a), gap(b.p1, a)];
    gaps.into_iter().fold(f64::INFINITY, f64::min)
}

fn cross(a: Line, b: Line) -> bool {
    let side = |line: Line, p: Point| (line.p1 - line.p0).cross(p - line.p0);
    // The ends of each lie strictly on both sides of the other. Segments that touch are at distance 0 by their ends.
    side(a, b.p0) * side(a, b.p1) < 0.0 && side(b, a.p0) * side(b, a.p1) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Area, Cap, Path, PathPoint, PointKind, Stroke};

    fn stroke_along(path: Path, width: f64) -> Mark {
        let stroke = Stroke {
            path,
            radius: 0.5 * width,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [0.0; 3],
            opacity: 1.0,
        };
        stroke.into()
    }

    fn line(a: (f64, f64), b: (f64, f64), width: f64) -> Mark {
        stroke_along(Path::line(a.into(), b.into()), width)
    }

    fn dot(x: f64, y: f64) -> Mark {
        stroke_along(Path::dot(Point::new(x, y)), 2.0)
    }

    fn stroke(x: f64, width: f64) -> Mark {
        line((x, 10.0), (x, 90.0), width)
    }

    #[test]
    fn strokes_touch_where_they_may_share_a_pixel() {
        let base = stroke(10.0, 4.0);
        let touches = [13.0, 14.0, 15.0].map(|x| base.meets(&stroke(x, 2.0)));
        assert_eq!(touches, [true, true, false]);
        assert!(!base.meets(&stroke_along(Path::dot(Point::new(10.0, 96.0)), 4.0)));
    }

    #[test]
    fn crossing_strokes_touch() {
        let across = line((-500.0, 50.0), (500.0, 51.0), 1.0);
        assert!(stroke(10.0, 1.0).meets(&across));
    }

    #[test]
    fn a_path_touches_where_it_goes_and_nowhere_else() {
        let points = [(10.0, true), (50.0, false), (90.0, true)].map(|(x, is_on)| PathPoint {
            at: Point::new(x, if is_on { 10.0 } else { 90.0 }),
            kind: PointKind::on_if(is_on),
        });
        let arch = stroke_along(Path::of_points(points.into(), false), 2.0);
        // The top of the curve is at (50, 50).
        let dots = [
            (50.0, 53.0),
            (50.0, 54.0),
            (50.0, 70.0),
            (50.0, 10.0),
            (20.0, 26.0),
        ];
        let found = dots.map(|(x, y)| arch.meets(&dot(x, y)));
        assert_eq!(found, [true, false, false, false, true]);
    }

    #[test]
    fn an_area_touches_what_lies_in_it_and_not_what_lies_in_its_hole() {
        let square = |low: f64, high: f64| {
            let corners = [(low, low), (high, low), (high, high), (low, high)];
            let mut points = corners.map(|p| PathPoint::on(p.into()));
            if low > 0.0 {
                points.reverse();
            }
            Path::of_points(points.into(), true)
        };
        let area = |rings| Mark::from(Area::plain(rings, [0.0; 3], 1.0));
        let (outer, hole) = (square(0.0, 100.0), square(20.0, 80.0));
        let [whole, holed] = [vec![outer.clone()], vec![outer, hole]].map(area);
        let dot = dot(50.0, 50.0);
        assert_eq!([&whole, &holed].map(|a| a.meets(&dot)), [true, false]);
        assert!(dot.meets(&whole) && whole.meets(&holed));
    }
}
