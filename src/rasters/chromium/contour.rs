//! The contour of a mark: its rings, or the outline of a stroke, as Skia's stroker draws it: lines and parabolas.
//!
//! tiny-skia's port of that stroker, by which resvg strokes, does not give this contour: it makes two parabolas or more of
//! each arc, where Skia is content with one up to a radius of 4 px. With it the model agrees with Chromium to 1.5 to 9 dB
//! less.

use super::curve::{Curve, left_of};
use super::part::Part;
use super::pieces::{directions, pieces};
use super::side::Side;
use crate::math::{Point, Vector};
use crate::scene::{Mark, Path, Piece, Stroke};

/// A closed contour, traced with its inside on the right, or several.
#[derive(Debug)]
pub(super) struct Contour {
    pub(super) parts: Vec<Part>,
    /// The smallest and the largest coordinates of its ends and control points.
    pub(super) bounds: [Point; 2],
    /// True for a capsule. Any other may turn anywhere and cross itself.
    pub(super) is_convex: bool,
}

impl Contour {
    /// The contour of a mark.
    pub(super) fn of(mark: &Mark) -> Self {
        match mark {
            Mark::Stroke(stroke) => Self::of_stroke(stroke),
            Mark::Area(area) => Self::of_rings(&area.rings),
        }
    }

    fn of_rings(rings: &[Path]) -> Self {
        let part = |piece| match piece {
            Piece::Line(points) => Part::Line(points),
            Piece::Curve(points) => Part::Parabola(points),
        };
        let pieces = rings.iter().flat_map(Path::pieces);
        let parts: Vec<Part> = pieces.map(part).collect();
        Self {
            bounds: bounds(&parts),
            parts,
            is_convex: false,
        }
    }

    fn of_stroke(stroke: &Stroke) -> Self {
        let (pieces, is_closed) = (pieces(&stroke.path), stroke.path.is_closed());
        let parts = match (pieces.first(), stroke.path.points().first()) {
            (Some(first), _) => {
                let mut sides = Sides::new(first, stroke.radius);
                sides.follow(&pieces, is_closed);
                sides.contour(&pieces, is_closed)
            }
            (None, Some(only)) => disc(only.at, stroke.radius),
            (None, None) => Vec::new(),
        };
        let is_capsule = match *pieces {
            [] => true,
            [Piece::Line(_)] => !is_closed,
            _ => false,
        };
        Self {
            bounds: bounds(&parts),
            parts,
            is_convex: is_capsule,
        }
    }
}

fn bounds(parts: &[Part]) -> [Point; 2] {
    let points = parts.iter().flat_map(Part::points);
    let empty = [f32::INFINITY, f32::NEG_INFINITY].map(|v| Point::new(v, v));
    points.fold(empty, |[low, high], p| [low.inf(p), high.sup(p)])
}

/// Both sides of a stroke, each traced from its start to its end.
struct Sides {
    radius: f32,
    left: Side,
    right: Side,
}

impl Sides {
    /// The sides of a stroke that begins with the piece `first`.
    fn new(first: &Piece, radius: f32) -> Self {
        let across = left_of(directions(first)[0]) * radius;
        let [left, right] = [across, -across].map(|away| Side::from(first.start() + away));
        Self {
            radius,
            left,
            right,
        }
    }

    fn follow(&mut self, pieces: &[Piece], is_closed: bool) {
        for (i, piece) in pieces.iter().enumerate() {
            if i > 0 {
                self.join(&pieces[i - 1], piece);
            }
            match *piece {
                Piece::Line([_, b]) => {
                    let across = left_of(directions(piece)[1]) * self.radius;
                    self.left.line_to(b + across);
                    self.right.line_to(b - across);
                }
                Piece::Curve(points) => {
                    self.left.beside(Curve(points), self.radius);
                    self.right.beside(Curve(points), -self.radius);
                }
            }
        }
        if let ([first, ..], [.., last], true) = (pieces, pieces, is_closed) {
            self.join(last, first);
        }
    }

    /// Rounds the outside of the bend between two pieces, unless it is slight, and leads the inside through the bend itself.
    fn join(&mut self, before: &Piece, after: &Piece) {
        let (pivot, [_, before], [after, _]) =
            (after.start(), directions(before), directions(after));
        let cosine = before.dot(&after);
        if 1.0 - cosine <= SLIGHT_BEND {
            return;
        }
        let [mut from, mut to] = [before, after].map(|direction| left_of(direction) * self.radius);
        let (mut outer, mut inner) = (&mut self.left, &mut self.right);
        let turns_left = before.perp(&after) <= 0.0;
        if turns_left {
            (from, to) = (-from, -to);
            std::mem::swap(&mut outer, &mut inner);
        }
        // Skia builds an arc of quarters and a rest.
        if cosine > 0.0 {
            outer.turn(pivot, from, to);
        } else {
            let along = before * self.radius;
            outer.turn(pivot, from, along);
            outer.turn(pivot, along, to);
        }
        // Where the stroke is wider than its pieces are long, a direct line would cut off a corner.
        inner.line_to(pivot);
        inner.line_to(pivot - to);
    }

    /// The contour, with a cap at each end, or of two parts if the stroke is closed.
    fn contour(self, pieces: &[Piece], is_closed: bool) -> Vec<Part> {
        let Self {
            radius,
            mut left,
            right,
        } = self;
        let back = right.parts.iter().rev().map(|part| part.reversed());
        let [left_start, right_start] = [&left, &right].map(|side| side.start);
        if is_closed {
            // Two rings, the right one traced backwards, so that the nonzero rule leaves a hole within.
            left.line_to(left_start);
            left.parts.push(Part::Line([right_start, right.end]));
            left.parts.extend(back);
        } else if let ([first, ..], [.., last]) = (pieces, pieces) {
            left.cap(last.end(), directions(last)[1] * radius);
            left.parts.extend(back);
            // The way back along the right side has led here.
            left.end = right_start;
            left.cap(first.start(), -directions(first)[0] * radius);
        }
        left.parts
    }
}

/// The contour of a dot.
fn disc(center: Point, radius: f32) -> Vec<Part> {
    let right = Vector::new(radius, 0.0);
    let mut side = Side::from(center + left_of(right));
    side.cap(center, right);
    side.cap(center, -right);
    side.parts
}

/// One less the cosine of an angle between two pieces that gets no join.
const SLIGHT_BEND: f32 = 1.0 / 4096.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::PathPoint;

    fn contour(points: &[([f32; 2], bool)], is_closed: bool) -> Contour {
        let point = |&(at, is_on): &([f32; 2], bool)| PathPoint {
            at: at.into(),
            is_on,
        };
        Contour::of_stroke(&Stroke {
            path: Path::new(points.iter().map(point).collect(), is_closed).unwrap(),
            radius: 2.0,
            color: [0.0; 3],
            opacity: 1.0,
        })
    }

    fn ends(part: &Part) -> [Point; 2] {
        let points = part.points();
        [points[0], points[points.len() - 1]]
    }

    #[test]
    fn an_open_stroke_has_one_contour_without_a_gap() {
        let bent = [
            ([5.0, 5.0], true),
            ([30.0, 6.0], true),
            ([20.0, 25.0], false),
            ([9.0, 20.0], true),
        ];
        for points in [&bent[..1], &bent[..2], &bent] {
            let Contour { parts, .. } = contour(points, false);
            let next = parts.iter().cycle().skip(1);
            for (part, next) in parts.iter().zip(next) {
                let gap = ends(next)[0] - ends(part)[1];
                assert!(gap.norm() < 1e-4, "{part:?} {next:?}");
            }
        }
    }

    #[test]
    fn a_slight_bend_has_no_join_and_a_sharp_one_has_an_arc() {
        let parts = |end: [f32; 2]| {
            let points = [([0.0, 9.0], true), ([20.0, 9.0], true), (end, true)];
            contour(&points, false).parts.len()
        };
        let [slight, sharp] = [[40.0, 9.3], [40.0, 29.0]].map(parts);
        // Two lines on each side and four quarters of a circle; then an arc outside, and two lines inside.
        assert_eq!([slight, sharp], [8, 11]);
    }

    #[test]
    fn only_capsules_are_convex() {
        let points = [
            ([5.0, 5.0], true),
            ([30.0, 25.0], false),
            ([9.0, 20.0], true),
        ];
        assert!(contour(&points[..1], false).is_convex);
        assert!(contour(&[points[0], points[2]], false).is_convex);
        assert!(!contour(&points, false).is_convex);
    }
}
