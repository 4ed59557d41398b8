//! Joins: one stroke for two nearly equal ones that meet end to end.

use std::collections::BTreeMap;

use super::{Change, Edit, written_points};
use crate::math::distance;
use crate::render::{STYLE, StrokeRef, Strokes};
use crate::scene::PointKind;

/// Farthest that two ends may be apart, px.
const REACH: f32 = 8.0;
/// Farthest that two ends may be apart, in units of the mean width of both strokes.
const GAP: f32 = 0.6;
/// Largest difference of channels, of opacities, and of radii in units of the larger one.
const ALIKE: f32 = 0.3;
/// Most pairs at a time, as a share of the strokes.
const SHARE: f32 = 0.1;

/// Joins of free strokes, the most alike first. A stroke has at most `most` points; without the lower stroke of a pair, as
/// much is spared as `price` says.
pub(in crate::fit) fn joins(
    strokes: &Strokes,
    most: usize,
    price: impl Fn(StrokeRef<'_>) -> f32,
) -> Vec<Edit> {
    let join = |pair: Pair| Edit {
        changes: vec![
            (pair.lower, Change::Marks(Vec::new())),
            (pair.upper, joined(strokes, pair)),
        ],
        gain: 0.0,
        price: price(strokes.get(pair.lower)),
        growth: -1,
        is_tried: true,
    };
    let mut pairs = pairs(strokes, most);
    pairs.truncate((SHARE * strokes.len() as f32).ceil() as usize);
    pairs.into_iter().map(join).collect()
}

/// Two strokes that meet.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pair {
    lower: usize,
    upper: usize,
    /// True if the end of each is the one that meets; otherwise it is the start.
    ends: [bool; 2],
    /// Difference of their styles.
    unlike: f32,
}

/// The pairs of strokes that may be joined, the most alike first, each stroke in one pair at most.
fn pairs(strokes: &Strokes, most: usize) -> Vec<Pair> {
    // Ends meet only within `reach`, so that those in the cells around are all that could.
    let mut cells: BTreeMap<[i32; 2], Vec<(usize, bool)>> = BTreeMap::new();
    let cell = |p: [f32; 2]| p.map(|v| (v / REACH).floor() as i32);
    let may_join = |stroke: StrokeRef<'_>| {
        !stroke.closed
            && stroke.points.len() > 1
            && stroke.points.len() < most
            && stroke.is_finite()
    };
    let mut pairs = Vec::new();
    for (i, stroke) in strokes.iter().enumerate().filter(|(_, s)| may_join(*s)) {
        for is_end in [false, true] {
            let at = end(stroke, is_end);
            let [column, row] = cell(at);
            let near = (-1..=1).flat_map(|y| (-1..=1).map(move |x| [column + x, row + y]));
            for &(k, other_is_end) in near.filter_map(|place| cells.get(&place)).flatten() {
                let other = strokes.get(k);
                // Of the two ends that meet one point is left.
                let count = written_points(stroke) + written_points(other) - 1;
                let gap = distance(at, end(other, other_is_end));
                let width = stroke.radius() + other.radius();
                if k != i && count <= most && gap <= REACH.min(width * GAP) {
                    // A gap as wide as both radii together counts as much as the largest difference of styles that is allowed.
                    let unlike = unlike(stroke, other) + gap / width * ALIKE;
                    pairs.push(Pair {
                        lower: k,
                        upper: i,
                        ends: [other_is_end, is_end],
                        unlike,
                    });
                }
            }
        }
        // Only now, so that a stroke meets those below it and not itself.
        for is_end in [false, true] {
            let place = cell(end(stroke, is_end));
            cells.entry(place).or_default().push((i, is_end));
        }
    }
    // The most alike first, each stroke once.
    pairs.retain(|pair| pair.unlike < ALIKE);
    pairs.sort_by(|a, b| a.unlike.total_cmp(&b.unlike).then(a.upper.cmp(&b.upper)));
    let mut taken = vec![false; strokes.len()];
    pairs.retain(|pair| {
        let is_free = !taken[pair.lower] && !taken[pair.upper];
        if is_free {
            (taken[pair.lower], taken[pair.upper]) = (true, true);
        }
        is_free
    });
    pairs
}

/// Difference of two styles: the largest difference of their channels and opacities, and of their radii in units
/// of the larger one.
fn unlike(a: StrokeRef<'_>, b: StrokeRef<'_>) -> f32 {
    let colors = a.color().into_iter().zip(b.color());
    let colors = colors.map(|(a, b)| (a - b).abs());
    let opacities = (a.opacity() - b.opacity()).abs();
    let radii = (a.radius() - b.radius()).abs() / a.radius().max(b.radius());
    colors.chain([opacities, radii]).fold(0.0, f32::max)
}

fn end(stroke: StrokeRef<'_>, is_end: bool) -> [f32; 2] {
    let end = if is_end {
        stroke.points.last()
    } else {
        stroke.points.first()
    };
    end.copied().unwrap_or_default()
}

/// The joined stroke: the lower one up to where they meet, a point there, and the upper one from there on.
fn joined(strokes: &Strokes, pair: Pair) -> Change {
    let points = |i: usize, is_reversed: bool| {
        let stroke = strokes.get(i);
        let mut points: Vec<([f32; 2], PointKind)> = stroke
            .points
            .iter()
            .copied()
            .zip(stroke.kinds.iter().copied())
            .collect();
        if is_reversed {
            points.reverse();
        }
        points
    };
    // The lower stroke runs towards the meeting point, the upper one away from it.
    let mut all = points(pair.lower, !pair.ends[0]);
    let rest = points(pair.upper, pair.ends[1]);
    // The path meets halfway between the two ends.
    if let (Some(last), Some((first, _))) = (all.last_mut(), rest.first()) {
        last.0 = [0, 1].map(|axis| 0.5 * (last.0[axis] + first[axis]));
    }
    // One point in the middle stands for both ends that meet.
    all.extend(&rest[1..]);
    // The style is the mean by length, so that a short piece does not change a long one.
    let (a, b) = (strokes.get(pair.lower), strokes.get(pair.upper));
    // If neither has a length, the bound of the divisor leaves the style of the lower one.
    let (weight, other) = (a.length(), b.length());
    let share = other / (weight + other).max(f32::MIN_POSITIVE);
    let style: [f32; STYLE] =
        std::array::from_fn(|k| a.style[k] + share * (b.style[k] - a.style[k]));
    let (points, kinds): (Vec<_>, Vec<_>) = all.into_iter().unzip();
    let stroke = StrokeRef {
        points: &points,
        kinds: &kinds,
        closed: false,
        rings: &[],
        form: None,
        paint: None,
        sweep: None,
        style: &style,
    };
    Change::Marks(vec![stroke.to_mark()])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strokes(capsules: &[[f32; 9]]) -> Strokes {
        capsules.iter().collect()
    }

    fn found(capsules: &[[f32; 9]]) -> Vec<(usize, usize)> {
        let pairs = pairs(&strokes(capsules), usize::MAX);
        pairs.iter().map(|pair| (pair.lower, pair.upper)).collect()
    }

    const A: [f32; 9] = [1.0, 1.0, 9.0, 1.0, 2.0, 0.5, 0.5, 0.5, 1.0];

    fn from(x: f32, level: f32) -> [f32; 9] {
        [x, 1.5, 20.0, 9.0, 2.0, level, level, level, 1.0]
    }

    #[test]
    fn strokes_of_one_look_that_meet_are_a_pair() {
        assert_eq!(found(&[A, from(9.5, 0.52)]), [(0, 1)]);
        assert_eq!(found(&[A, from(9.5, 0.9)]), []);
        assert_eq!(found(&[A, from(14.0, 0.5)]), []);
    }

    #[test]
    fn a_stroke_is_in_one_pair() {
        let far = |x: f32, level: f32| [x, 1.5, 20.0 + 9.0 * x, 9.0, 2.0, level, level, level, 1.0];
        let apart = [A, far(11.0, 0.56), far(8.5, 0.5)];
        assert_eq!(found(&apart), [(0, 2)]);
    }

    #[test]
    fn a_joined_stroke_goes_from_end_to_end() {
        let (lower, upper) = (A, [20.0, 9.0, 9.0, 2.0, 2.0, 0.6, 0.6, 0.6, 1.0]);
        let strokes = strokes(&[lower, upper]);
        let pair = Pair {
            lower: 0,
            upper: 1,
            ends: [true, true],
            unlike: 0.0,
        };
        let Change::Marks(marks) = joined(&strokes, pair) else {
            panic!("a mark");
        };
        let strokes = Strokes::from_iter(&marks);
        assert_eq!(strokes.get(0).points, [[1.0, 1.0], [9.0, 1.5], [20.0, 9.0]]);
    }
}
