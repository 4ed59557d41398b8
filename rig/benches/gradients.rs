//! One forward and one backward pass, as those who bring a loss of their own pay for them.
//!
//! ```text
//! cargo bench -p rig --bench gradients [-- FOLDER]
//! ```
//!
//! The strokes are those of the article's large demo: thin, short, opaque, anywhere. `python/gradient_figures.py FOLDER`
//! measures the same strokes through NumPy, PyTorch and the article's program; for that, each drawing is saved in the folder
//! with its times. *fused* is one call of `Renderer::backward`, whose loss sees the canvas on the way: what the fit does.
//!
//! With `--test` everything is done once.
#![allow(clippy::print_stdout, reason = "its output is a table")]

use std::path::PathBuf;

use rig::bench::measure::fastest;
use rig::lab::article::Capsules;
use strokefit::Result;
use strokefit::coverage::Coverage;
use strokefit::fit::{Objective, Simd};
use strokefit::loss::Loss;
use strokefit::render::{Backdrop, Canvas, Gradients, Grid, Renderer, Softness};

/// Strokes, width and height, px.
const CASES: [(usize, usize, usize); 7] = [
    (100, 64, 64),
    (500, 256, 256),
    (5000, 256, 256),
    (500, 550, 220),
    (5000, 550, 220),
    (500, 1024, 1024),
    (5000, 1024, 1024),
];

const SOFTNESS: Softness = Softness {
    coverage: Coverage::Smoothstep,
    width: 1.0,
};

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let rounds = if args.iter().any(|arg| arg == "--test") {
        1
    } else {
        40
    };
    let folder = args
        .iter()
        .find(|arg| !arg.starts_with("--"))
        .map(PathBuf::from);
    println!("strokes  width × height  forward and backward, ms   fused, ms");
    for (count, width, height) in CASES {
        let drawing = Capsules::random(width, height, count, 0);
        let [both_ms, fused_ms] = times_ms(&drawing, rounds)?;
        println!("{count:7}  {width:5} × {height:<6}  {both_ms:24.3}  {fused_ms:10.3}");
        if let Some(folder) = &folder {
            std::fs::create_dir_all(folder)?;
            let name = format!("{count}-{width}x{height}");
            std::fs::write(folder.join(format!("{name}.json")), drawing.to_json()?)?;
            std::fs::write(
                folder.join(format!("{name}.ms")),
                format!("{both_ms} {fused_ms}"),
            )?;
        }
    }
    Ok(())
}

/// Shortest times of both passes, and of the backward pass alone.
fn times_ms(drawing: &Capsules, rounds: usize) -> Result<[f64; 2]> {
    let grid = Grid::new(drawing.width, drawing.height);
    let target = Canvas::flat(grid, [0.25; 3]);
    let objective = Objective::new(Loss::L2, &target);
    let backdrop = Backdrop::Color(drawing.background);
    let strokes = &drawing.strokes;
    let level = Simd::Auto.require()?;
    let [mut first, mut second] = [0, 1].map(|_| Renderer::new(grid, level));
    let mut canvas = Canvas::flat(grid, [0.0; 3]);
    let [mut by_both, mut by_fused] = [0, 1].map(|_| Gradients::default());
    let mut both = || {
        first.forward(strokes, SOFTNESS, backdrop, &mut canvas);
        first.backward(strokes, SOFTNESS, backdrop, &objective, &mut by_both);
    };
    let mut fused = || second.backward(strokes, SOFTNESS, backdrop, &objective, &mut by_fused);
    let seconds = fastest(rounds, [&mut both, &mut fused]);
    Ok(seconds.map(|s| 1e3 * s))
}
