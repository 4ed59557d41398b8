//! Random strokes of one size, and timing, for measurements of the renderer.

use std::env;
use std::f32::consts::{PI, TAU};
use std::io;
use std::time::Instant;

use strokefit::coverage::Coverage;
use strokefit::math;
use strokefit::render::{Grid, Params, Softness, Strokes};
use strokefit::rng;

/// The soft edge of a finished drawing.
pub const EDGE: Softness = Softness {
    coverage: Coverage::Smoothstep,
    width: 1.25,
};

/// Mean number of strokes that cover a pixel of a random drawing.
pub const DEPTH: f32 = 10.0;

/// Strokes of one size.
#[derive(Debug, Clone, Copy)]
pub struct StrokeSize {
    /// Half the width, px.
    pub radius_px: f32,
    /// From end to end of the centre line.
    pub length_px: f32,
    /// 0..1.
    pub opacity: f32,
}

impl StrokeSize {
    /// Pixels that a stroke covers, its soft edge included.
    pub fn area_px(self) -> f32 {
        let outer = self.radius_px + EDGE.width / 2.0;
        2.0 * outer * self.length_px + PI * outer * outer
    }

    /// The size at which `count` strokes cover each of `pixels` [`DEPTH`] times on average; four radii long
    /// and half opaque.
    pub fn covering(pixels: f32, count: usize) -> Self {
        let of_radius = |radius_px: f32| Self {
            radius_px,
            length_px: 4.0 * radius_px,
            opacity: 0.5,
        };
        let wanted = DEPTH * pixels / count.max(1) as f32;
        // The area grows with the radius, so bisection finds it.
        let (mut low, mut high) = (0.0, pixels.sqrt());
        for _ in 0..40 {
            let middle = f32::midpoint(low, high);
            if of_radius(middle).area_px() < wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        of_radius(high)
    }

    /// `count` strokes of random place, direction and colour, the same in every run.
    pub fn strokes(self, grid: Grid, count: usize) -> Strokes {
        (0..count as u64).map(|i| self.stroke(grid, i)).collect()
    }

    fn stroke(self, grid: Grid, i: u64) -> Params {
        let draw = |k| rng::draw(0, 0, i, k);
        let (x, y) = (draw(0) * grid.width as f32, draw(1) * grid.height as f32);
        let (sin, cos) = math::sin_cos(draw(2) * TAU);
        let half = self.length_px / 2.0;
        let (dx, dy) = (cos * half, sin * half);
        let [red, green, blue] = [3, 4, 5].map(draw);
        let [ax, ay, bx, by] = [x - dx, y - dy, x + dx, y + dy];
        [
            ax,
            ay,
            bx,
            by,
            self.radius_px,
            red,
            green,
            blue,
            self.opacity,
        ]
    }
}

/// Makes the root of the repository the current folder, from which benchmarks name pictures. Cargo starts them in that of
/// their package.
///
/// # Errors
/// When the folder is gone.
pub fn go_to_root() -> io::Result<()> {
    env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// The shortest time of each of `jobs`, s. The jobs take turns for `rounds` rounds, so that other load on the
/// machine slows all of them alike.
pub fn fastest<const N: usize>(rounds: usize, mut jobs: [&mut dyn FnMut(); N]) -> [f64; N] {
    let mut best = [f64::INFINITY; N];
    for _ in 0..rounds {
        for (job, best) in jobs.iter_mut().zip(&mut best) {
            let start = Instant::now();
            job();
            *best = best.min(start.elapsed().as_secs_f64());
        }
    }
    best
}

/// 1, 2, 4, … and all of the machine's threads.
pub fn thread_counts() -> Vec<usize> {
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    let doubling = std::iter::successors(Some(1), |n| Some(2 * n));
    let mut counts: Vec<usize> = doubling.take_while(|&n| n < all).collect();
    counts.push(all);
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_cover_the_picture_as_often_as_is_said() {
        for count in [10, 1000, 100_000] {
            let pixels = 1e6;
            let depth = StrokeSize::covering(pixels, count).area_px() * count as f32 / pixels;
            assert!((depth - DEPTH).abs() < 0.1, "{count}: {depth}");
        }
    }

    #[test]
    fn threads_double_up_to_all() {
        let counts = thread_counts();
        assert_eq!(counts[0], 1);
        assert!(counts.is_sorted_by(|a, b| a < b), "{counts:?}");
    }
}
