//! Little travel: the order in which a pen draws the strokes of a layer with short ways between them.
//!
//! Two strokes keep their order if the picture depends on it: they meet, and they differ in colour or one is
//! translucent. All others may change places. An open path may be drawn from either end, and a closed one from any of
//! its points. At first the nearest end comes next, unless a stroke below it is still to be drawn; then [`steps`] improve
//! the tour by reversing parts of it and moving strokes.
//!
//! Antialiased edges of one opaque colour that lie over each other may come out one 8-bit level different, because
//! renderers round after every stroke; and resvg, which bends curves within 1/4 px, does so in another way from their
//! other end.

mod nearby;
mod steps;

use crate::scene::{Precedence, UNITS_PER_PX, Written, WrittenPath, WrittenPoint};
use nearby::Nearby;
use steps::Tour;

/// The strokes in an order of little travel, for a pen that comes `from` a place. The picture does not change.
pub(super) fn shortened(strokes: &[Written], from: Option<Spot>) -> Vec<Written> {
    let precedence = Precedence::of(strokes);
    let mut tour = Tour::new(nearest_first(strokes, &precedence, from), &precedence, from);
    tour.improve(strokes);
    let visits = tour.visits().iter();
    visits
        .map(|visit| visit.drawn(&strokes[visit.stroke]))
        .collect()
}

/// Where a pen is when it has drawn these strokes.
pub(super) fn end(strokes: &[Written]) -> Option<Spot> {
    strokes.last().map(|stroke| ends_of(stroke)[1])
}

/// Travel between strokes in this order, px.
pub(super) fn between(strokes: &[Written]) -> f64 {
    let ends: Vec<_> = strokes.iter().map(ends_of).collect();
    ends.windows(2).map(|w| dist(w[0][1], w[1][0])).sum()
}

/// A place on the page, px.
pub(super) type Spot = [f64; 2];

pub(super) fn spot(units: [i64; 2]) -> Spot {
    units.map(|units| units as f64 / UNITS_PER_PX as f64)
}

pub(super) fn dist([ax, ay]: Spot, [bx, by]: Spot) -> f64 {
    let (dx, dy) = (bx - ax, by - ay);
    (dx * dx + dy * dy).sqrt()
}

/// Where a pen is set down and lifted to draw the first path of a mark, which all others follow.
fn ends_of(mark: &Written) -> [Spot; 2] {
    mark.paths.first().map_or([[0.0; 2]; 2], ends)
}

/// Where a pen is set down and lifted to draw the path as it is written.
fn ends(path: &WrittenPath) -> [Spot; 2] {
    let start = start(path);
    let last = path.points().last().map_or(start, |point| spot(point.at));
    [start, if path.is_closed() { start } else { last }]
}

/// Where the path begins: at its first point or, if all are off the path, between the last and the first.
fn start(path: &WrittenPath) -> Spot {
    match path.points() {
        [] => [0.0; 2],
        [first, .., last] if !first.is_on => {
            let ([ax, ay], [bx, by]) = (spot(last.at), spot(first.at));
            [f64::midpoint(ax, bx), f64::midpoint(ay, by)]
        }
        [first, ..] => spot(first.at),
    }
}

/// The closed path, beginning at its point `index`.
fn beginning_at(path: &WrittenPath, index: usize) -> WrittenPath {
    let mut points = path.points().to_vec();
    points.rotate_left(index);
    WrittenPath::new(points, true)
}

/// A way to draw a stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Visit {
    /// The index of the stroke.
    stroke: usize,
    /// The point of a closed path that it begins at.
    start: usize,
    /// True if an open path is drawn from its last point.
    is_reversed: bool,
    /// Where the pen is set down and lifted.
    ends: [Spot; 2],
}

impl Visit {
    /// All ways to draw a mark: an area begins with its first ring, a shape where its element says.
    fn all(stroke: usize, mark: &Written) -> Vec<Self> {
        let Some(path) = mark.paths.first() else {
            return Vec::new();
        };
        let forward = Self {
            stroke,
            start: 0,
            is_reversed: false,
            ends: ends(path),
        };
        let is_start = |point: &WrittenPoint| point.is_on || path.points().iter().all(|p| !p.is_on);
        if mark.shape.is_some() {
            return vec![forward];
        }
        if path.is_closed() {
            let points = path.points().iter().enumerate();
            let starts = points.filter(|(_, point)| is_start(point));
            return starts
                .map(|(start, _)| Self {
                    start,
                    ends: ends(&beginning_at(path, start)),
                    ..forward
                })
                .collect();
        }
        if path.points().len() == 1 {
            return vec![forward];
        }
        vec![forward, forward.flipped()]
    }

    /// This stroke, drawn the other way.
    fn flipped(self) -> Self {
        let [from, to] = self.ends;
        Self {
            is_reversed: !self.is_reversed,
            ends: [to, from],
            ..self
        }
    }

    /// The stroke, drawn in this way.
    fn drawn(&self, stroke: &Written) -> Written {
        let mut drawn = stroke.clone();
        if let Some(path) = drawn.paths.first_mut() {
            *path = match self {
                Self { start: 0, .. } if path.is_closed() => path.clone(),
                Self { start, .. } if path.is_closed() => beginning_at(path, *start),
                Self { is_reversed, .. } if *is_reversed => path.reversed(),
                _ => path.clone(),
            };
        }
        drawn
    }
}

/// Draws next what begins nearest, among the strokes that may be drawn.
fn nearest_first(strokes: &[Written], precedence: &Precedence, from: Option<Spot>) -> Vec<Visit> {
    let of_strokes = strokes.iter().enumerate();
    let ways: Vec<Vec<Visit>> = of_strokes.map(|(i, s)| Visit::all(i, s)).collect();
    let begins: Vec<Spot> = ways.iter().flatten().map(|visit| visit.ends[0]).collect();
    let mut ready = Nearby::over(&begins);
    let mut waiting = precedence.waiting();
    let put = |ready: &mut Nearby<Visit>, stroke: usize| {
        ways[stroke]
            .iter()
            .for_each(|&way| ready.put(way.ends[0], way));
    };
    waiting.free().into_iter().for_each(|i| put(&mut ready, i));
    let mut visits = Vec::with_capacity(strokes.len());
    let mut at = from.unwrap_or_default();
    while let Some(&(_, next)) = ready.nearest(at, 1, |_| true).first() {
        for way in &ways[next.stroke] {
            ready.take(way.ends[0], |other| other.stroke == next.stroke);
        }
        let freed = waiting.draw(next.stroke);
        freed.into_iter().for_each(|i| put(&mut ready, i));
        visits.push(next);
        at = next.ends[1];
    }
    visits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng;
    use crate::scene::PathPoint;

    const PX: i64 = UNITS_PER_PX;

    fn path(points: &[[i64; 2]], closed: bool) -> WrittenPath {
        let on = |p: &[i64; 2]| PathPoint::on(p.map(|px| px * PX));
        WrittenPath::new(points.iter().map(on).collect(), closed)
    }

    fn stroke(path: WrittenPath, color: u8) -> Written {
        Written {
            paths: vec![path],
            shape: None,
            is_band: false,
            width: 2 * PX,
            color: [color; 3],
            opacity: 255,
            shade: None,
        }
    }

    /// Lines of 5 px at random places of a square, of so many colours.
    fn lines(count: usize, side: i64, colors: u64) -> Vec<Written> {
        let draw = |i: usize, k: u64| i64::from(rng::bits(5, 0, i as u64, k) as u32 >> 8);
        let line = |i: usize| {
            let at = [draw(i, 0) % side, draw(i, 1) % side];
            let to = [at[0] + draw(i, 2) % 11 - 5, at[1] + draw(i, 3) % 11 - 5];
            stroke(
                path(&[at, to], false),
                (rng::bits(5, 1, i as u64, 0) % colors) as u8,
            )
        };
        (0..count).map(line).collect()
    }

    #[test]
    fn the_pen_goes_on_at_the_nearest_end() {
        let strokes = [
            stroke(path(&[[10, 0], [0, 0]], false), 0),
            stroke(path(&[[40, 0], [50, 0]], false), 0),
            stroke(path(&[[39, 0], [11, 0]], false), 0),
        ];
        let drawn = shortened(&strokes, Some([0.0, 0.0]));
        assert_eq!(between(&drawn), 2.0);
        let starts: Vec<_> = drawn.iter().map(|s| ends_of(s)[0][0]).collect();
        assert_eq!(starts, [0.0, 11.0, 40.0]);
    }

    #[test]
    fn a_closed_path_begins_where_the_pen_comes_from() {
        let square = path(&[[50, 50], [50, 20], [20, 20], [20, 50]], true);
        let line = path(&[[0, 20], [19, 20]], false);
        let drawn = shortened(&[stroke(square, 0), stroke(line, 0)], None);
        assert_eq!(between(&drawn), 1.0);
        let closed = drawn
            .iter()
            .flat_map(|s| &s.paths)
            .find(|path| path.is_closed());
        assert_eq!(closed.map(|path| path.points().len()), Some(4));
    }

    #[test]
    fn a_tour_of_many_lines_is_near_the_shortest() {
        let strokes = lines(1000, 1000, 1);
        let before = between(&strokes);
        let after = between(&shortened(&strokes, None));
        // The shortest tour of n points in a square of side a has about 0.7124·√n·a.
        assert!(after < 0.044 * before, "{after} of {before}");
    }

    #[test]
    fn strokes_that_meet_keep_their_order_unless_they_are_opaque_and_alike() {
        let mut strokes = lines(400, 100, 3);
        strokes.iter_mut().step_by(7).for_each(|s| s.opacity = 100);
        // Widths tell strokes apart.
        strokes.iter_mut().zip(0..).for_each(|(s, i)| s.width += i);
        let drawn = shortened(&strokes, None);
        assert!(between(&drawn) < 0.7 * between(&strokes));
        let place = |stroke: &Written| drawn.iter().position(|s| s.width == stroke.width);
        let mut pairs = 0;
        for (i, below) in strokes.iter().enumerate() {
            for above in &strokes[i + 1..] {
                let is_alike =
                    below.color == above.color && below.opacity == 255 && above.opacity == 255;
                if below.meets(above) && !is_alike {
                    assert!(place(below) < place(above), "{below:?} {above:?}");
                    pairs += 1;
                }
            }
        }
        assert!(pairs > 500, "{pairs}");
    }
}
