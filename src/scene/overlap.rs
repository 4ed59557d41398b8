//! Finds pairs of strokes that may share a pixel, so that their order matters.

use super::quantize::{UNITS_PER_PX, Written};
use crate::math;

impl Written {
    /// Whether the order of the two strokes can change the picture.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        let (a, b) = (self, other);
        let reach = (a.width + b.width) / 2 + APART;
        let near = |axis: usize| {
            let ends = |s: &Written| {
                let along = || s.points.iter().map(|p| p[axis]);
                (along().min().unwrap_or(0), along().max().unwrap_or(0))
            };
            let ((a_near, a_far), (b_near, b_far)) = (ends(a), ends(b));
            a_near - b_far < reach && b_near - a_far < reach
        };
        near(0) && near(1) && distance(a, b) < reach as f64
    }
}

/// Strokes farther apart than the diagonal of a pixel have no pixel in common.
const APART: i64 = UNITS_PER_PX * 3 / 2;

/// Distance of the centre lines, in units.
fn distance(a: &Written, b: &Written) -> f64 {
    let (a, b) = (ends(a), ends(b));
    if cross(a, b) {
        return 0.0;
    }
    let gaps = [gap(a[0], b), gap(a[1], b), gap(b[0], a), gap(b[1], a)];
    gaps.into_iter().fold(f64::INFINITY, f64::min)
}

type Segment = [[f64; 2]; 2];

fn ends(stroke: &Written) -> Segment {
    let place = |p: Option<&[i64; 2]>| p.map_or([0.0; 2], |p| p.map(|units| units as f64));
    [place(stroke.points.first()), place(stroke.points.last())]
}

/// From a point to a segment.
fn gap([x, y]: [f64; 2], [a, b]: Segment) -> f64 {
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

    const PX: i64 = UNITS_PER_PX;

    fn stroke(x: i64, width: i64) -> Written {
        Written {
            points: vec![[x * PX, 10 * PX], [x * PX, 90 * PX]],
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
            points: vec![[10 * PX, 96 * PX]],
            ..base.clone()
        };
        assert!(!base.meets(&beyond));
    }

    #[test]
    fn crossing_strokes_touch() {
        let across = Written {
            points: vec![[-500 * PX, 50 * PX], [500 * PX, 51 * PX]],
            ..stroke(0, 1)
        };
        assert!(stroke(10, 1).meets(&across));
    }
}
