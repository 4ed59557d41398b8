//! Jitter: towards the end of a polish, strokes are differentiated a little beside their places.
//!
//! An SVG renderer antialiases each edge in its own way, so that a file differs from our own render as if every stroke
//! were somewhere else by up to a tenth of a px. Where strokes are dense, the fit would otherwise cancel edges with
//! edges, exactly in our own render and in no other. With noise in the places of strokes, an edge costs in proportion to its
//! contrast (Bishop, "Training with noise is equivalent to Tikhonov regularization", Neural Computation 7, 1995), and
//! drawings have fewer such edges.

use serde::{Deserialize, Serialize};

use crate::render::Strokes;
use crate::rng;

/// Share of the polish after which strokes are jittered. 0.7, 0.92 instead of 0.85, where points are dense: −0.2, −0.1 dB.
const FROM: f32 = 0.85;

/// Strokes that are differentiated beside their places, which makes a drawing robust against antialiasing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(in crate::fit) struct Jitter {
    /// Farthest that a stroke moves along each axis, px; 0 for no jitter.
    pub(in crate::fit) px: f32,
}

impl Jitter {
    /// True if strokes are jittered when a share `done` of the polish is over.
    pub(in crate::fit) fn begins_by(&self, done: f32) -> bool {
        self.px > 0.0 && done >= FROM
    }

    /// Moves every stroke as a whole, each to its own place, which depends on the iteration `step` alone. Returns all
    /// numbers as they were.
    pub(in crate::fit) fn apply(&self, strokes: &mut Strokes, step: usize) -> Vec<f32> {
        let still = strokes.numbers().to_vec();
        strokes.change(|i, stroke| {
            let shift = [0, 1].map(|axis| {
                let draw = rng::draw(0, step as u64, i as u64, axis);
                self.px * (2.0 * draw - 1.0)
            });
            for [x, y] in stroke.points.iter_mut() {
                *x += shift[0];
                *y += shift[1];
            }
        });
        still
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Point;
    use crate::scene::{Cap, Path, Stroke};

    const JITTER: Jitter = Jitter { px: 0.1 };

    fn strokes() -> Strokes {
        let mut strokes = Strokes::new();
        for i in 0..200 {
            let at = |dx: f64| Point::new(i as f64 + dx, 5.0);
            strokes.push_stroke(&Stroke {
                path: Path::line(at(0.0), at(4.0)),
                radius: 1.0,
                radii: Vec::new(),
                cap: Cap::Round,
                color: [0.5; 3],
                opacity: 0.5,
            });
        }
        strokes
    }

    #[test]
    fn strokes_move_as_a_whole_and_each_to_its_own_place() {
        let mut moved = strokes();
        let still = JITTER.apply(&mut moved, 3);
        assert_eq!(still, strokes().numbers());
        let shifts: Vec<[f32; 2]> = (moved.iter().zip(strokes().iter()))
            .map(|(new, old)| {
                let shift = |k: usize| [0, 1].map(|axis| new.points[k][axis] - old.points[k][axis]);
                let [start, end] = [shift(0), shift(1)];
                for (a, b) in start.into_iter().zip(end) {
                    assert!((a - b).abs() < 1e-4 && a.abs() <= 0.1001, "{a} {b}");
                }
                assert_eq!(new.style, old.style);
                start
            })
            .collect();
        let mean = shifts.iter().flatten().sum::<f32>() / 400.0;
        let square = shifts.iter().flatten().map(|v| v * v).sum::<f32>() / 400.0;
        // A uniform number within ±0.1 has a variance of 0.01 / 3.
        assert!(
            mean.abs() < 0.01 && (0.0027..0.004).contains(&square),
            "{mean} {square}"
        );
    }

    #[test]
    fn every_iteration_has_shifts_of_its_own() {
        let places = |step| {
            let mut moved = strokes();
            JITTER.apply(&mut moved, step);
            moved.numbers().to_vec()
        };
        assert_eq!(places(3), places(3));
        assert_ne!(places(3), places(4));
    }

    #[test]
    fn it_begins_late_and_without_a_distance_never() {
        assert!(!JITTER.begins_by(0.84) && JITTER.begins_by(0.85));
        assert!(!Jitter { px: 0.0 }.begins_by(1.0));
    }
}
