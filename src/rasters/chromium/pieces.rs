//! The pieces of a path as Skia's stroker takes them.

use super::curve::Curve;
use crate::math::Vector;
use crate::scene::{Path, Piece};

/// The pieces of a path, those that have a length.
pub(super) fn pieces(path: &Path) -> Vec<Piece> {
    path.pieces().flat_map(straightened).collect()
}

/// The piece; as lines where it is a curve that is nearly straight, and nothing if it has no length.
fn straightened(piece: Piece) -> Vec<Piece> {
    let (a, b) = (piece.start(), piece.end());
    let corners = match piece {
        Piece::Line(_) => vec![a, b],
        Piece::Curve([_, c, _]) if c == a || c == b => vec![a, b],
        Piece::Curve(points) => match Curve(points).as_lines() {
            Some(corners) => corners,
            None => return vec![piece],
        },
    };
    // Skia leaves out what has no length, since it has no direction.
    let lines = corners.windows(2).map(|ends| [ends[0], ends[1]]);
    let lines = lines.filter(|[a, b]| a != b);
    lines.map(Piece::Line).collect()
}

/// The directions at start and end.
pub(super) fn directions(piece: &Piece) -> [Vector; 2] {
    match *piece {
        Piece::Line([a, b]) => {
            let along = (b - a).try_normalize(0.0);
            [along.unwrap_or(Vector::new(1.0, 0.0)); 2]
        }
        Piece::Curve(points) => [0.0, 1.0].map(|t| Curve(points).direction(t)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::PathPoint;

    #[test]
    fn a_curve_that_hardly_bends_is_taken_as_lines() {
        let taken = |knee: [f32; 2]| {
            let [on, off] = [PathPoint::on, PathPoint::off];
            let points = vec![
                on([0.0, 0.0].into()),
                off(knee.into()),
                on([40.0, 0.0].into()),
            ];
            pieces(&Path::new(points, false).unwrap())
        };
        let is_curve = |knee| matches!(*taken(knee), [Piece::Curve(_)]);
        assert!(is_curve([20.0, 0.1]) && !is_curve([20.0, 0.05]));
        assert_eq!(taken([50.0, 0.0]).len(), 2, "it turns back");
        assert_eq!(taken([0.0, 0.0]).len(), 1);
    }
}
