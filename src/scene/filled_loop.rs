//! Closed paths that their pen fills.
//!
//! A stroker outlines a closed path by two rings, one on each side. Where the pen is wider than the loop, the inner ring
//! turns inside out, and the nonzero rule leaves a hole in resvg, Skia and Cairo alike, though every point of it is within
//! the pen. An open path that ends where it starts has one ring and no hole, and with round caps it is the same union of
//! discs. So such paths are written open.

use super::overlap::{Segment, gap, is_inside};
use super::written_path::{WrittenPath, WrittenPoint};
use super::{MAX_POINTS, PathPoint};

/// Rows and columns of places, within the bounds of a loop, where a gap is looked for. A gap that is missed costs the
/// bytes of a point, as the loop is then written open without need.
const PLACES: i64 = 12;

/// Farthest that chords are from the curves of a loop, px.
const TOLERANCE: f64 = 0.05;

impl WrittenPath {
    /// The path, opened at its start if a pen of `width` units fills the whole loop.
    pub(super) fn opened_if_filled(self, width: i64) -> Self {
        let has_room = self.points().len() + 2 <= MAX_POINTS;
        if !self.is_closed() || !has_room || leaves_gap(&self, width) {
            return self;
        }
        let Some(start) = self.pieces().next().map(|piece| piece.start()) else {
            return self;
        };
        let mut points: Vec<WrittenPoint> = self.points().to_vec();
        if !points.first().is_some_and(|p| p.is_on) {
            points.insert(0, PathPoint::on(start));
        }
        points.push(PathPoint::on(start));
        Self::new(points, false)
    }
}

/// True if a place inside the loop is out of the pen's reach.
fn leaves_gap(path: &WrittenPath, width: i64) -> bool {
    let segments = path.segments(TOLERANCE);
    let float = |p: [i64; 2]| p.map(|units| units as f64);
    let segments: Vec<Segment> = segments.iter().map(|ends| ends.map(float)).collect();
    let ends = || segments.iter().flatten();
    let low = ends().fold([f64::INFINITY; 2], |low, p| {
        [low[0].min(p[0]), low[1].min(p[1])]
    });
    let high = ends().fold([f64::NEG_INFINITY; 2], |high, p| {
        [high[0].max(p[0]), high[1].max(p[1])]
    });
    // A gap is a disc inside the bounds, and the pen has to go round it.
    if (0..2).any(|axis| high[axis] - low[axis] <= width as f64) {
        return false;
    }
    let reach = width as f64 / 2.0;
    let at = |axis: usize, step: i64| {
        let share = (step as f64 + 0.5) / PLACES as f64;
        low[axis] + share * (high[axis] - low[axis])
    };
    let places = (0..PLACES).flat_map(|row| (0..PLACES).map(move |column| [column, row]));
    places
        .map(|[column, row]| [at(0, column), at(1, row)])
        .any(|p| is_inside(p, &segments) && segments.iter().all(|&s| gap(p, s) > reach))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::UNITS_PER_PX;

    const UNIT: i64 = UNITS_PER_PX;

    /// A closed path through the corners of a square of `side` px.
    fn square(side: i64) -> WrittenPath {
        let corners = [[0, 0], [side, 0], [side, side], [0, side]];
        let points = corners.map(|p| PathPoint::on(p.map(|px| px * UNIT)));
        WrittenPath::new(points.into(), true)
    }

    #[test]
    fn a_loop_as_wide_as_its_pen_is_opened_where_it_starts() {
        let opened = square(10).opened_if_filled(11 * UNIT);
        let ends = [opened.points()[0], opened.points()[4]];
        assert!(!opened.is_closed());
        assert_eq!(ends[0], ends[1]);
        assert_eq!(opened.pieces().count(), square(10).pieces().count());
    }

    #[test]
    fn a_ring_stays_closed() {
        assert!(square(10).opened_if_filled(9 * UNIT).is_closed());
    }

    #[test]
    fn a_loop_of_control_points_starts_at_an_implied_point() {
        let corners = [[0, 0], [8, 0], [8, 8], [0, 8]];
        let points = corners.map(|p| PathPoint::off(p.map(|px| px * UNIT)));
        let opened = WrittenPath::new(points.into(), true).opened_if_filled(9 * UNIT);
        let start = PathPoint::on([0, 4 * UNIT]);
        assert_eq!([opened.points()[0], opened.points()[5]], [start; 2]);
        assert_eq!(opened.pieces().count(), 4);
    }

    #[test]
    fn bounds_wider_than_the_pen_do_not_make_a_gap() {
        // A triangle: its inner radius is 0.29 of its side, its height 0.87.
        let corners = [[0, 0], [100, 0], [50, 87]];
        let points = corners.map(|p| PathPoint::on(p.map(|px| px * UNIT)));
        let triangle = WrittenPath::new(points.into(), true);
        assert!(!triangle.clone().opened_if_filled(60 * UNIT).is_closed());
        assert!(triangle.opened_if_filled(50 * UNIT).is_closed());
    }
}
