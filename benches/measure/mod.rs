//! What the benchmarks of speed and of scale have in common: strokes of one size, and the clock.

use std::f32::consts::{PI, TAU};
use std::time::Instant;

use strokefit::coverage::Coverage;
use strokefit::render::{Grid, Params, Softness};
use strokefit::rng;

/// The soft edge of a finished drawing.
pub(crate) const EDGE: Softness = Softness {
    coverage: Coverage::Smoothstep,
    width: 1.25,
};

/// Pairs per pixel of random drawings.
pub(crate) const DEPTH: f32 = 10.0;

/// Strokes of one size.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Size {
    pub(crate) radius_px: f32,
    /// From end to end of the centre line.
    pub(crate) length_px: f32,
    pub(crate) opacity: f32,
}

impl Size {
    /// Pixels that a stroke covers, its soft edge included.
    pub(crate) fn area_px(self) -> f32 {
        let outer = self.radius_px + EDGE.width / 2.0;
        2.0 * outer * self.length_px + PI * outer * outer
    }

    /// `count` strokes of random place, direction and colour, the same in every run.
    pub(crate) fn strokes(self, grid: Grid, count: usize) -> Vec<Params> {
        (0..count as u64).map(|i| self.stroke(grid, i)).collect()
    }

    fn stroke(self, grid: Grid, i: u64) -> Params {
        let draw = |k| rng::draw(0, 0, i, k);
        let (x, y) = (draw(0) * grid.width as f32, draw(1) * grid.height as f32);
        let (sin, cos) = (draw(2) * TAU).sin_cos();
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

/// The shortest time of each of `jobs`, s, over `rounds` in which they take turns: what disturbs the
/// machine disturbs all of them.
pub(crate) fn fastest<const N: usize>(rounds: usize, mut jobs: [&mut dyn FnMut(); N]) -> [f64; N] {
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

/// A pool of `threads` workers.
pub(crate) fn pool(threads: usize) -> rayon::ThreadPool {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
    builder.build().expect("so few threads can be started")
}

/// 1, 2, 4, … and all of the machine's threads.
pub(crate) fn thread_counts() -> Vec<usize> {
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    let doubling = std::iter::successors(Some(1), |n| Some(2 * n));
    let mut counts: Vec<usize> = doubling.take_while(|&n| n < all).collect();
    counts.push(all);
    counts
}
