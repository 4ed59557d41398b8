//! Finds pairs of strokes that may share a pixel, so that their order matters.

use super::grid::UNITS_PER_PX;
use super::quantize::Written;
use crate::math;

/// The pairs of strokes that may share a pixel and whose order `matters` where they do, the lower stroke of each first. The
/// pairs come in no useful order, but always in the same one.
pub(crate) fn overlaps<'a>(
    strokes: impl IntoIterator<Item = &'a Written>,
    matters: impl Fn(&Written, &Written) -> bool,
) -> Vec<[usize; 2]> {
    let strokes: Vec<&Written> = strokes.into_iter().collect();
    let swept: Vec<Swept> = strokes.iter().copied().map(Swept::new).collect();
    // A sweep from left to right compares a stroke with those alone that reach as far right as its left end.
    let mut from_left: Vec<usize> = (0..strokes.len()).collect();
    from_left.sort_by_key(|&i| swept[i].span());
    let (mut open, mut pairs): (Vec<usize>, Vec<_>) = (Vec::new(), Vec::new());
    for i in from_left {
        open.retain(|&k| swept[k].span()[1] >= swept[i].span()[0]);
        let partners = open
            .iter()
            .filter(|&&k| matters(strokes[i], strokes[k]) && swept[i].meets(&swept[k]));
        pairs.extend(partners.map(|&k| [i.min(k), i.max(k)]));
        open.push(i);
    }
    pairs
}

/// Where a stroke may leave ink: what is needed to compare it with many others.
#[derive(Debug, Clone)]
struct Swept {
    /// In units.
    width: i64,
    /// From where to where the points lie along each axis, in units.
    bounds: [[i64; 2]; 2],
    /// The centre line, by segments at most [`TOLERANCE`] away from it; that of a dot has no length.
    segments: Vec<Segment>,
}

impl Swept {
    fn new(stroke: &Written) -> Self {
        Self {
            width: stroke.width,
            bounds: bounds(stroke),
            segments: segments(stroke),
        }
    }

    /// True if the order of the two strokes can change the picture.
    fn meets(&self, other: &Self) -> bool {
        let reach = reach(self.width, other.width);
        are_near(&self.bounds, &other.bounds, reach)
            && is_nearer(&self.segments, &other.segments, reach as f64)
    }

    /// From where to where, along the x axis, the stroke can meet others, in units.
    fn span(&self) -> [i64; 2] {
        let [near, far] = self.bounds[0];
        let margin = (self.width + APART + 1) / 2;
        [near - margin, far + margin]
    }
}

impl Written {
    /// True if the order of the two strokes can change the picture.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        let reach = reach(self.width, other.width);
        are_near(&bounds(self), &bounds(other), reach)
            && is_nearer(&segments(self), &segments(other), reach as f64)
    }
}

/// Distance between centre lines of these widths up to which the strokes may share a pixel, in units.
fn reach(a: i64, b: i64) -> i64 {
    (a + b) / 2 + APART
}

/// True if these boxes come nearer to each other than `reach`.
fn are_near(a: &[[i64; 2]; 2], b: &[[i64; 2]; 2], reach: i64) -> bool {
    a.iter()
        .zip(b)
        .all(|([a_near, a_far], [b_near, b_far])| a_near - b_far < reach && b_near - a_far < reach)
}

/// From where to where the points of a stroke lie along each axis, in units.
fn bounds(stroke: &Written) -> [[i64; 2]; 2] {
    [0, 1].map(|axis| {
        let along = || stroke.path.points().iter().map(|p| p.at[axis]);
        [along().min().unwrap_or(0), along().max().unwrap_or(0)]
    })
}

/// The centre line of a stroke as segments that are at most [`TOLERANCE`] away from it; that of a dot has no length.
fn segments(stroke: &Written) -> Vec<Segment> {
    let mut segments = stroke.path.segments(TOLERANCE);
    if let ([dot], []) = (stroke.path.points(), segments.as_slice()) {
        segments.push([dot.at; 2]);
    }
    let float = |p: [i64; 2]| p.map(|units| units as f64);
    segments.into_iter().map(|ends| ends.map(float)).collect()
}

/// Strokes farther apart than the diagonal of a pixel have no pixel in common. What chords are away from their curve is
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{PathPoint, WrittenPath};

    const PX: i64 = UNITS_PER_PX;

    fn stroke(x: i64, width: i64) -> Written {
        Written {
            path: WrittenPath::line([x * PX, 10 * PX], [x * PX, 90 * PX]),
            width: width * PX,
            color: [0; 3],
            opacity: 255,
        }
    }

    #[test]
    fn strokes_touch_where_they_may_share_a_pixel() {
        let base = stroke(10, 4);
        let touches = [13, 14, 15].map(|x| base.meets(&stroke(x, 2)));
        assert_eq!(touches, [true, true, false]);
        let beyond = Written {
            path: WrittenPath::line([10 * PX, 96 * PX], [10 * PX, 96 * PX]),
            ..base.clone()
        };
        assert!(!base.meets(&beyond));
    }

    #[test]
    fn crossing_strokes_touch() {
        let across = Written {
            path: WrittenPath::line([-500 * PX, 50 * PX], [500 * PX, 51 * PX]),
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
            path: WrittenPath::new(points.into(), false),
            ..stroke(0, 2)
        };
        let dot = |x: i64, y: i64| Written {
            path: WrittenPath::line([x * PX, y * PX], [x * PX, y * PX]),
            ..stroke(0, 2)
        };
        // The top of the curve is at (50, 50).
        let found =
            [(50, 53), (50, 54), (50, 70), (50, 10), (20, 26)].map(|(x, y)| arch.meets(&dot(x, y)));
        assert_eq!(found, [true, false, false, false, true]);
    }
}
