//! Precedence: which marks may share a pixel, so that their order matters, and what follows for reordering them.

use super::grid::UNITS_PER_PX;
use super::quantize::Written;
use crate::math;

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
    pub(crate) fn of<'a>(marks: impl IntoIterator<Item = &'a Written>) -> Self {
        let matters =
            |a: &Written, b: &Written| a.color != b.color || a.shade.is_some() || b.shade.is_some();
        Self::where_matters(marks.into_iter().map(Some), matters)
    }

    /// Precedence of marks of any colours: all that may share a pixel keep their order. `None` is a mark that leaves no ink.
    pub(crate) fn of_shapes<'a>(marks: impl IntoIterator<Item = Option<&'a Written>>) -> Self {
        Self::where_matters(marks, |_, _| true)
    }

    fn where_matters<'a>(
        marks: impl IntoIterator<Item = Option<&'a Written>>,
        matters: impl Fn(&Written, &Written) -> bool,
    ) -> Self {
        let marks: Vec<Option<&Written>> = marks.into_iter().collect();
        let none = vec![Vec::new(); marks.len()];
        let (mut above, mut below) = (none.clone(), none);
        let inked = marks.into_iter().enumerate();
        let inked = inked.filter_map(|(i, mark)| mark.map(|mark| (i, mark, Swept::new(mark))));
        // A sweep from left to right compares a mark with those alone that reach as far right as its left end.
        let mut from_left: Vec<_> = inked.collect();
        from_left.sort_by_key(|(_, _, swept)| swept.span());
        let mut open: Vec<&(usize, &Written, Swept)> = Vec::new();
        for next in &from_left {
            let (i, mark, swept) = next;
            open.retain(|(_, _, other)| other.span()[1] >= swept.span()[0]);
            for (k, other, other_swept) in &open {
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
        if is_parted(i, k) || is_parted(k, i) {
            return false;
        }
        let mut joined = std::mem::take(&mut self.later[k]);
        unite(&mut joined, &self.later[i]);
        (joined[i], joined[k]) = (false, false);
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

/// Where a mark may leave ink: what is needed to compare it with many others.
#[derive(Debug, Clone)]
struct Swept {
    /// Farthest that it reaches beyond its paths, in units; 0 for an area.
    reach: i64,
    /// From where to where the points lie along each axis, in units.
    bounds: [[i64; 2]; 2],
    /// The paths, by segments at most [`TOLERANCE`] away from them; that of a dot has no length.
    segments: Vec<Segment>,
    /// A point of each path.
    starts: Vec<[f64; 2]>,
}

impl Swept {
    fn new(mark: &Written) -> Self {
        let starts = mark.paths.iter().flat_map(|path| path.points().first());
        Self {
            reach: mark.reach(),
            bounds: bounds(mark),
            segments: segments(mark),
            starts: starts.map(|p| p.at.map(|units| units as f64)).collect(),
        }
    }

    /// True if the order of the two marks can change the picture.
    fn meets(&self, other: &Self) -> bool {
        let reach = self.reach + other.reach + APART;
        are_near(&self.bounds, &other.bounds, reach)
            && (is_nearer(&self.segments, &other.segments, reach as f64)
                || self.covers(other)
                || other.covers(self))
    }

    /// True if it is an area that a path of `other` starts in.
    fn covers(&self, other: &Self) -> bool {
        self.reach == 0 && other.starts.iter().any(|&p| is_inside(p, &self.segments))
    }

    /// From where to where, along the x axis, the mark can meet others, in units.
    fn span(&self) -> [i64; 2] {
        let [near, far] = self.bounds[0];
        let margin = self.reach + (APART + 1) / 2;
        [near - margin, far + margin]
    }
}

impl Written {
    /// True if the order of the two marks can change the picture.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        let reach = self.reach() + other.reach() + APART;
        are_near(&bounds(self), &bounds(other), reach) && Swept::new(self).meets(&Swept::new(other))
    }
}

impl Written {
    /// True if it is an area that nearly all of `other` lies in.
    pub(crate) fn encloses(&self, other: &Self) -> bool {
        if !self.is_area() {
            return false;
        }
        let own = segments(self);
        let places: Vec<[f64; 2]> = segments(other).iter().map(|[a, _]| *a).collect();
        let inside = places.iter().filter(|&&p| is_inside(p, &own)).count();
        10 * inside >= 9 * places.len()
    }

    /// From where to where the points lie along each axis, in units.
    pub(crate) fn bounds(&self) -> [[i64; 2]; 2] {
        bounds(self)
    }
}

/// True if these boxes come nearer to each other than `reach`.
fn are_near(a: &[[i64; 2]; 2], b: &[[i64; 2]; 2], reach: i64) -> bool {
    a.iter()
        .zip(b)
        .all(|([a_near, a_far], [b_near, b_far])| a_near - b_far < reach && b_near - a_far < reach)
}

/// From where to where the points of a mark lie along each axis, in units.
fn bounds(mark: &Written) -> [[i64; 2]; 2] {
    [0, 1].map(|axis| {
        let along = || mark.points().map(|p| p.at[axis]);
        [along().min().unwrap_or(0), along().max().unwrap_or(0)]
    })
}

/// The paths of a mark as segments that are at most [`TOLERANCE`] away from them; that of a dot has no length.
fn segments(mark: &Written) -> Vec<Segment> {
    let mut segments = mark.segments(TOLERANCE);
    if let (Some(dot), []) = (mark.points().next(), segments.as_slice()) {
        segments.push([dot.at; 2]);
    }
    let float = |p: [i64; 2]| p.map(|units| units as f64);
    segments.into_iter().map(|ends| ends.map(float)).collect()
}

/// Marks farther apart than the diagonal of a pixel have no pixel in common. What chords are away from their curve is
/// within the rest.
const APART: i64 = UNITS_PER_PX * 3 / 2;

/// Largest distance between segments and their curve, px: less than half of the excess of [`APART`] over the diagonal
/// of a pixel.
const TOLERANCE: f64 = 0.04;

/// A segment from one place to another, in units.
pub(super) type Segment = [[f64; 2]; 2];

/// True if some of these segments come nearer to each other than this.
fn is_nearer(a: &[Segment], b: &[Segment], reach: f64) -> bool {
    let is_near = |&a: &Segment, &b: &Segment| {
        (0..2).all(|axis| {
            let far = |s: Segment| s[0][axis].max(s[1][axis]);
            let near = |s: Segment| s[0][axis].min(s[1][axis]);
            near(a) - far(b) < reach && near(b) - far(a) < reach
        })
    };
    a.iter()
        .any(|a| b.iter().any(|b| is_near(a, b) && distance(*a, *b) < reach))
}

/// Distance of two segments, in units.
fn distance(a: Segment, b: Segment) -> f64 {
    if cross(a, b) {
        return 0.0;
    }
    let gaps = [gap(a[0], b), gap(a[1], b), gap(b[0], a), gap(b[1], a)];
    gaps.into_iter().fold(f64::INFINITY, f64::min)
}

/// Distance of a point from a segment, in units.
pub(super) fn gap([x, y]: [f64; 2], [a, b]: Segment) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length2 = dx * dx + dy * dy;
    let along = ((x - a[0]) * dx + (y - a[1]) * dy) / length2.max(f64::MIN_POSITIVE);
    let h = along.clamp(0.0, 1.0);
    math::hypot(x - a[0] - h * dx, y - a[1] - h * dy)
}

fn cross(a: Segment, b: Segment) -> bool {
    let side = |[from, to]: Segment, p: [f64; 2]| {
        (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0])
    };
    side(a, b[0]) * side(a, b[1]) < 0.0 && side(b, a[0]) * side(b, a[1]) < 0.0
}

/// True if closed paths of these segments wind around `p`.
pub(super) fn is_inside(p: [f64; 2], segments: &[Segment]) -> bool {
    let crossing = |&[a, b]: &Segment| {
        let side = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
        match (a[1] <= p[1], b[1] <= p[1]) {
            (true, false) if side > 0.0 => 1,
            (false, true) if side < 0.0 => -1,
            _ => 0,
        }
    };
    segments.iter().map(crossing).sum::<i32>() != 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{PathPoint, WrittenPath};

    const PX: i64 = UNITS_PER_PX;

    fn stroke(x: i64, width: i64) -> Written {
        Written {
            paths: vec![WrittenPath::line([x * PX, 10 * PX], [x * PX, 90 * PX])],
            shape: None,
            is_band: false,
            width: width * PX,
            color: [0; 3],
            opacity: 255,
            shade: None,
        }
    }

    #[test]
    fn strokes_touch_where_they_may_share_a_pixel() {
        let base = stroke(10, 4);
        let touches = [13, 14, 15].map(|x| base.meets(&stroke(x, 2)));
        assert_eq!(touches, [true, true, false]);
        let beyond = Written {
            paths: vec![WrittenPath::line([10 * PX, 96 * PX], [10 * PX, 96 * PX])],
            shape: None,
            is_band: false,
            ..base.clone()
        };
        assert!(!base.meets(&beyond));
    }

    #[test]
    fn crossing_strokes_touch() {
        let across = Written {
            paths: vec![WrittenPath::line([-500 * PX, 50 * PX], [500 * PX, 51 * PX])],
            shape: None,
            is_band: false,
            ..stroke(0, 1)
        };
        assert!(stroke(10, 1).meets(&across));
    }

    #[test]
    fn a_path_touches_where_it_goes_and_nowhere_else() {
        let points = [(10, true), (50, false), (90, true)].map(|(x, is_on)| PathPoint {
            at: [x * PX, if is_on { 10 } else { 90 } * PX],
            is_on,
        });
        let arch = Written {
            paths: vec![WrittenPath::new(points.into(), false)],
            shape: None,
            is_band: false,
            ..stroke(0, 2)
        };
        let dot = |x: i64, y: i64| Written {
            paths: vec![WrittenPath::line([x * PX, y * PX], [x * PX, y * PX])],
            shape: None,
            is_band: false,
            ..stroke(0, 2)
        };
        // The top of the curve is at (50, 50).
        let found =
            [(50, 53), (50, 54), (50, 70), (50, 10), (20, 26)].map(|(x, y)| arch.meets(&dot(x, y)));
        assert_eq!(found, [true, false, false, false, true]);
    }

    #[test]
    fn an_area_touches_what_lies_in_it_and_not_what_lies_in_its_hole() {
        let square = |low: i64, high: i64| {
            let corners = [[low, low], [high, low], [high, high], [low, high]];
            let mut points = corners.map(|p| PathPoint::on(p.map(|px| px * PX)));
            if low > 0 {
                points.reverse();
            }
            WrittenPath::new(points.into(), true)
        };
        let area = |paths| Written {
            paths,
            shape: None,
            is_band: false,
            width: 0,
            ..stroke(0, 2)
        };
        let dot = Written {
            paths: vec![WrittenPath::line([50 * PX; 2], [50 * PX; 2])],
            shape: None,
            is_band: false,
            ..stroke(0, 2)
        };
        let [whole, holed] = [vec![square(0, 100)], vec![square(0, 100), square(20, 80)]].map(area);
        assert_eq!([&whole, &holed].map(|a| a.meets(&dot)), [true, false]);
        assert!(dot.meets(&whole) && whole.meets(&holed));
    }
}
