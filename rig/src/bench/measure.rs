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
