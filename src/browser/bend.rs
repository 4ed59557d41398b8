//! The outline of a stroke of several pieces.

use super::outline::{Curve, Outline};
use crate::math::{Point, Vector};
use crate::scene::{Path, Piece};

/// Adds the outlines of all parts of a stroke: its pieces, the outside of each bend, and its caps. They turn the same
/// way, so that the rule `nonzero` fills what any of them covers.
pub(super) fn trace(path: &Path, radius: f32, outline: &mut Outline) {
    let pieces: Vec<_> = path.pieces().flat_map(straightened).collect();
    for piece in &pieces {
        match *piece {
            Piece::Line([a, b]) => outline.add_line(a, b, directions(piece)[0] * radius),
            Piece::Curve(points) => outline.add_curve(Curve(points), radius),
        }
    }
    let mut join = |before: &Piece, after: &Piece| {
        let along = [directions(before)[1], directions(after)[0]].map(|d| d * radius);
        outline.add_join(after.start(), along[0], along[1]);
    };
    pieces.windows(2).for_each(|pair| join(&pair[0], &pair[1]));
    let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else {
        let right = Vector::new(radius, 0.0);
        path.points()
            .iter()
            .take(1)
            .for_each(|p| add_disc(outline, p.at, right));
        return;
    };
    if path.is_closed() {
        join(last, first);
    } else {
        outline.add_cap(first.start(), -directions(first)[0] * radius);
        outline.add_cap(last.end(), directions(last)[1] * radius);
    }
}

fn add_disc(outline: &mut Outline, center: Point, right: Vector) {
    outline.add_cap(center, right);
    outline.add_cap(center, -right);
}

/// The piece; as two lines where it is a curve that turns back on itself, and nothing if it has no length.
fn straightened(piece: Piece) -> Vec<Piece> {
    let (a, b) = (piece.start(), piece.end());
    let corners = match piece {
        Piece::Line(_) => vec![a, b],
        Piece::Curve([_, c, _]) if c == a || c == b => vec![a, b],
        Piece::Curve(points) => match Curve(points).turning_point() {
            Some(turn) => vec![a, turn, b],
            None => return vec![piece],
        },
    };
    let ends = corners.iter().zip(corners.iter().skip(1));
    let lines = ends.filter(|(a, b)| a != b);
    lines.map(|(a, b)| Piece::Line([*a, *b])).collect()
}

/// The directions at start and end.
fn directions(piece: &Piece) -> [Vector; 2] {
    match *piece {
        Piece::Line([a, b]) => {
            let along = (b - a).try_normalize(0.0);
            [along.unwrap_or(Vector::new(1.0, 0.0)); 2]
        }
        Piece::Curve(points) => [0.0, 1.0].map(|t| Curve(points).direction(t)),
    }
}
