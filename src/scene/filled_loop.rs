//! Closed paths that their pen fills.
//!
//! A stroker outlines a closed path by two rings, one on each side. Where the pen is wider than the loop, the inner ring
//! turns inside out, and the nonzero rule leaves a hole in resvg, Skia and Cairo alike, though every point of it is within
//! the pen. An open path that ends where it starts has one ring and no hole, and with round caps it is the same union of
//! discs. So such paths are written open.

use kurbo::{Line, ParamCurveNearest, PathEl};

use super::path::{bounds, is_inside};
use super::{MAX_POINTS, Path, PathPoint};
use crate::math::Point;

/// Rows and columns of places, within the bounds of a loop, where a gap is looked for. A gap that is missed costs the
/// bytes of a point, as the loop is then written open without need.
const PLACES: u32 = 12;

/// Farthest that chords are from the curves of a loop, px.
const TOLERANCE: f64 = 0.05;

impl Path {
    /// The path, opened at its start if a pen of this `width`, px, fills the whole loop.
    pub(super) fn opened_if_filled(self, width: f64) -> Self {
        let has_room = self.points().len() + 2 <= MAX_POINTS;
        if !self.is_closed() || !has_room || leaves_gap(&self, width) {
            return self;
        }
        let Some(PathEl::MoveTo(start)) = self.bezier().elements().first().copied() else {
            return self;
        };
        let mut points: Vec<PathPoint> = self.points().to_vec();
        // An open path begins with an on-point, which here was implied.
        if !points.first().is_some_and(PathPoint::is_on) {
            points.insert(0, PathPoint::on(start));
        }
        points.push(PathPoint::on(start));
        Self::canonical(points, false)
    }
}

/// True if a place inside the loop is out of the pen's reach.
fn leaves_gap(path: &Path, width: f64) -> bool {
    let lines = path.lines(TOLERANCE);
    let around = bounds(lines.iter().map(|line| line.p0));
    // A gap is a disc inside the bounds, and the pen has to go round it.
    if around.width() <= width || around.height() <= width {
        return false;
    }
    let reach2 = 0.25 * width * width;
    let share = |step: u32| (f64::from(step) + 0.5) / f64::from(PLACES);
    let places = (0..PLACES).flat_map(|row| (0..PLACES).map(move |column| [column, row]));
    places
        .map(|[column, row]| {
            let [x, y] = [share(column) * around.width(), share(row) * around.height()];
            Point::new(around.x0 + x, around.y0 + y)
        })
        .any(|p| {
            // The pen covers all places within half of its width of the path.
            let is_clear = |line: &Line| line.nearest(p, 0.0).distance_sq > reach2;
            is_inside(&lines, p) && lines.iter().all(is_clear)
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A closed path through the corners of a square of `side` px.
    fn square(side: f64) -> Path {
        let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)];
        let points = corners.map(|p| PathPoint::on(p.into()));
        Path::canonical(points.into(), true)
    }

    #[test]
    fn a_loop_as_wide_as_its_pen_is_opened_where_it_starts() {
        let opened = square(10.0).opened_if_filled(11.0);
        let ends = [opened.points()[0], opened.points()[4]];
        assert!(!opened.is_closed());
        assert_eq!(ends[0], ends[1]);
        assert_eq!(opened.segments().count(), square(10.0).segments().count());
    }

    #[test]
    fn a_ring_stays_closed() {
        assert!(square(10.0).opened_if_filled(9.0).is_closed());
    }

    #[test]
    fn a_loop_of_control_points_starts_at_an_implied_point() {
        let corners = [(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)];
        let points = corners.map(|p| PathPoint::off(p.into()));
        let opened = Path::canonical(points.into(), true).opened_if_filled(9.0);
        let start = PathPoint::on(Point::new(0.0, 4.0));
        assert_eq!([opened.points()[0], opened.points()[5]], [start; 2]);
        assert_eq!(opened.segments().count(), 4);
    }

    #[test]
    fn bounds_wider_than_the_pen_do_not_make_a_gap() {
        // A triangle: its inner radius is 0.29 of its side, its height 0.87.
        let corners = [(0.0, 0.0), (100.0, 0.0), (50.0, 87.0)];
        let points = corners.map(|p| PathPoint::on(p.into()));
        let triangle = Path::canonical(points.into(), true);
        assert!(!triangle.clone().opened_if_filled(60.0).is_closed());
        assert!(triangle.opened_if_filled(50.0).is_closed());
    }
}
