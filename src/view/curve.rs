//! The error over time, in a bounded number of points however long the fit.

use serde::Serialize;

/// Points that are kept at most.
const CAPACITY: usize = 1000;

/// One moment of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Point {
    /// Since the start, s.
    pub(super) time_s: f64,
    pub(super) strokes: usize,
    /// As the observer was told; `null` in JSON when there is no error.
    pub(super) psnr_db: f64,
}

/// Evenly spaced points; the spacing doubles when there are too many.
#[derive(Debug, Clone, Default)]
pub(super) struct Curve {
    points: Vec<Point>,
    /// Every so many points one is kept, less one.
    skipped: usize,
    /// Number of points that were offered.
    seen: usize,
}

impl Curve {
    pub(super) fn push(&mut self, point: Point) {
        if self.seen.is_multiple_of(self.skipped + 1) {
            self.points.push(point);
        }
        self.seen += 1;
        if self.points.len() > CAPACITY {
            let mut even = [true, false].into_iter().cycle();
            self.points.retain(|_| even.next().unwrap_or(true));
            self.skipped = 2 * self.skipped + 1;
        }
    }

    pub(super) fn points(&self) -> &[Point] {
        &self.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_fit_leaves_evenly_spaced_points() {
        let mut curve = Curve::default();
        for strokes in 0..100_000 {
            curve.push(Point {
                time_s: 0.0,
                strokes,
                psnr_db: 0.0,
            });
        }
        let strokes: Vec<usize> = curve.points().iter().map(|p| p.strokes).collect();
        assert!((CAPACITY / 2..=CAPACITY).contains(&strokes.len()));
        let step = strokes[1] - strokes[0];
        assert!(strokes.windows(2).all(|w| w[1] - w[0] == step));
        assert!(strokes[0] == 0 && 100_000 - strokes[strokes.len() - 1] <= step);
    }
}
