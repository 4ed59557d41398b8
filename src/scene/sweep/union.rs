//! The border of what overlapping rings cover, for who measures distances from an outline: edges within it are none.

use kurbo::Line;

use crate::math::Point;
use crate::scene::path::{bounds, is_inside};
use crate::scene::{Path, PathPoint};

/// Farthest that the polygon is from curves, px.
const TOLERANCE: f64 = 0.02;
/// Distance from an edge at which its sides are told, px.
const BESIDE: f64 = 1e-3;
/// Most edges that are compared with each other, 0.1 s: a line of 3,000 px along curves has fewer.
const MOST: usize = 3000;

/// The rings themselves if none of their edges has the area on both sides, or else polygons around it by the nonzero rule.
pub(super) fn united(rings: Vec<Path>) -> Vec<Path> {
    let around = bounds(rings.iter().flat_map(Path::hull));
    let size = around.width().max(around.height());
    if !size.is_finite() {
        return rings;
    }
    // Curves far larger than a page would have lines without end.
    let tolerance = TOLERANCE.max(1e-6 * size);
    let lines: Vec<Line> = rings
        .iter()
        .flat_map(|ring| ring.lines(tolerance))
        .collect();
    if lines.len() > MOST {
        return rings;
    }
    let parts: Vec<Line> = (0..lines.len()).flat_map(|i| cut(&lines, i)).collect();
    let is_border = |part: &&Line| {
        let way = part.p1 - part.p0;
        let away = BESIDE / way.hypot2().sqrt() * way.turn_90();
        let middle = part.p0.midpoint(part.p1);
        is_inside(&lines, middle + away) != is_inside(&lines, middle - away)
    };
    let border: Vec<Line> = parts.iter().filter(is_border).copied().collect();
    match border.len() == parts.len() {
        true => rings,
        false => chained(border),
    }
}

/// A line in parts, cut where others cross it.
fn cut(lines: &[Line], i: usize) -> Vec<Line> {
    let own = lines[i];
    let mut cuts = vec![(0.0, own.p0), (1.0, own.p1)];
    for k in (0..lines.len()).filter(|&k| k != i) {
        // The same numbers for both lines, so that the place is the same to the bit.
        let [first, second] = [lines[i.min(k)], lines[i.max(k)]];
        if let Some((shares, at)) = crossing(first, second) {
            let share = if i < k { shares[0] } else { shares[1] };
            cuts.push((share, at));
        }
    }
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ends = cuts.windows(2).map(|pair| Line::new(pair[0].1, pair[1].1));
    ends.filter(|line| (line.p1 - line.p0).hypot2() > 1e-18)
        .collect()
}

/// Where two lines cross or touch, and the shares of both up to there; `None` at their own ends.
fn crossing(a: Line, b: Line) -> Option<([f64; 2], Point)> {
    let (u, v, apart) = (a.p1 - a.p0, b.p1 - b.p0, b.p0 - a.p0);
    let whole = u.cross(v);
    let shares = [apart.cross(v) / whole, apart.cross(u) / whole];
    let is_on = shares.iter().all(|share| (0.0..=1.0).contains(share));
    let ends = [a.p0, a.p1].into_iter().find(|p| [b.p0, b.p1].contains(p));
    (is_on && ends.is_none()).then(|| (shares, a.p0 + shares[0] * u))
}

/// Polygons of lines that follow each other.
fn chained(mut lines: Vec<Line>) -> Vec<Path> {
    let mut rings = Vec::new();
    while let Some(Line {
        p0: start,
        p1: mut at,
    }) = lines.pop()
    {
        let mut points = vec![PathPoint::on(start)];
        loop {
            let away2 = |line: &Line| (line.p0 - at).hypot2();
            let near =
                (0..lines.len()).min_by(|&a, &b| away2(&lines[a]).total_cmp(&away2(&lines[b])));
            // Back at the start, or nearer to it than to all that is left.
            let Some(next) = near.filter(|&i| away2(&lines[i]) < (start - at).hypot2()) else {
                break;
            };
            points.push(PathPoint::on(at));
            at = lines.swap_remove(next).p1;
        }
        if points.len() > 2 {
            rings.push(Path::of_points(points, true));
        }
    }
    rings
}
