//! Do sixteen strokes find a star of four?
//!
//! The union of 16 capsules against a star that is drawn with `raw` coverage, 200 steps. The article
//! does not give ε for this experiment; its losses come out at 1e-4, and are run at 1e-3 as well.

use super::descent::{Method, Trajectory, descend};
use super::matching::{Matching, Samples};
use super::shapes::Capsule;
use super::table::{self, STEPS};
use super::{COVERAGES, ResultFolder, SIZE, show};
use crate::report::picture::{self, gray};
use crate::report::plot::Panel;
use strokefit::Result;
use strokefit::coverage::Coverage;
use strokefit::math::Real;

/// The star: `[a.x, a.y, b.x, b.y, radius]`, px.
pub const STAR: [[f64; 5]; 4] = [
    [16.0, 16.0, 48.0, 48.0, 2.0],
    [16.0, 48.0, 48.0, 16.0, 2.0],
    [32.0, 16.0, 32.0, 48.0, 2.0],
    [16.0, 32.0, 48.0, 32.0, 2.0],
];

/// The article's sixteen capsules, in the same order.
pub const START: [[f64; 5]; 16] = [
    [50.89, 23.34, 48.27, 21.45, 1.5154],
    [44.91, 39.6, 42.89, 41.65, 1.1777],
    [59.01, 6.8, 57.23, 10.7, 0.6993],
    [28.55, 54.38, 27.78, 65.48, 0.8052],
    [42.0, 27.78, 44.05, 34.26, 1.0716],
    [5.16, 37.02, 2.07, 35.97, 0.6328],
    [4.78, 31.15, 1.67, 33.31, 0.6741],
    [48.51, 27.39, 46.59, 28.99, 0.3321],
    [36.28, 38.34, 32.15, 47.97, 0.3307],
    [3.47, 60.99, -2.64, 57.56, 0.6558],
    [5.04, 23.43, 11.03, 20.25, 1.3163],
    [4.98, 14.56, 9.8, 14.4, 1.522],
    [38.42, 61.63, 44.39, 61.34, 1.5364],
    [61.46, 45.84, 58.65, 44.1, 1.9526],
    [20.01, 21.14, 20.69, 25.45, 0.9107],
    [30.59, 48.86, 21.08, 46.08, 0.9901],
];

const EPSILONS: [f64; 2] = [1e-4, 1e-3];

const METHODS: [Method; 3] = [Method::adam(0.5), Method::adamw(0.5), Method::rmsprop(0.1)];

/// Radii are free in this experiment; a negative one is a capsule that nowhere reaches half.
const RADII: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// The steepnesses of `atan` that the article compares.
const STEEPNESSES: [f32; 5] = [1.0, 1.5, 2.0, 3.0, 4.0];

/// One descent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// ε of the signed distance, px².
    pub eps: f64,
    /// Coverage function of the strokes that move.
    pub coverage: Coverage,
    /// Optimiser.
    pub method: Method,
}

impl Setup {
    fn grid<T: Real>(&self) -> Samples<T> {
        Samples {
            size: SIZE,
            origin: T::zero(),
            eps: T::of(self.eps),
        }
    }
}

/// The numbers are five per stroke, as in [`START`].
impl table::EitherPrecision for Setup {
    fn descend<T: Real>(&self) -> Trajectory<T> {
        let grid = self.grid();
        let target = grid.draw::<Capsule<T>>(&flat(&STAR), Coverage::Raw);
        let problem = Matching::<T, Capsule<T>>::new(grid, self.coverage, target, RADII);
        descend(&problem, &flat(&START), self.method, STEPS)
    }

    fn labels(&self) -> table::Labels {
        [
            "star".into(),
            format!("eps {:e}", self.eps),
            self.coverage.to_string(),
            self.method.to_string(),
            "random".into(),
        ]
    }
}

fn flat<T: Real>(rows: &[[f64; 5]]) -> Vec<T> {
    rows.as_flattened().iter().map(|&x| T::of(x)).collect()
}

/// Writes `star.csv`, and per ε and optimiser a chart of the losses and a sheet of the drawings; for
/// Adam an animation too, and the steepnesses of `atan`.
///
/// # Errors
/// When a file cannot be written.
pub fn run(output: &mut ResultFolder<'_>) -> Result<()> {
    let mut table = table::convergence();
    let atans = STEEPNESSES.map(|k| Coverage::Atan { k });
    let groups = METHODS.map(|method| (method.to_string(), method, COVERAGES));
    let groups = groups
        .into_iter()
        .chain([("atan".to_owned(), METHODS[0], atans)]);
    let groups: Vec<_> = groups.collect();
    for (i, eps) in EPSILONS.into_iter().enumerate() {
        for (j, (group, method, coverages)) in groups.iter().enumerate() {
            let name = format!("star-eps{eps:e}-{group}");
            let done = (i * groups.len() + j) as f64 / (EPSILONS.len() * groups.len()) as f64;
            output.doing(done, &name);
            let setups = coverages.map(|coverage| Setup {
                eps,
                coverage,
                method: *method,
            });
            let ends = table::tabulated(&mut table, &setups);
            let ends: Vec<_> = coverages.iter().copied().zip(ends).collect();
            let target = panel(setups[0], Coverage::Raw, &flat(&STAR))?;
            let draw = |coverage, descent: &Trajectory<f64>, step| {
                panel(setups[0], coverage, descent.params_at(step))
            };
            show(
                output,
                &name,
                &ends,
                Some(&target),
                *method == METHODS[0],
                draw,
            )?;
        }
    }
    output.text("star.csv", &table.csv())
}

fn panel(setup: Setup, coverage: Coverage, params: &[f64]) -> Result<Panel> {
    let canvas = setup.grid().draw::<Capsule<f64>>(params, coverage);
    Ok(Panel::new("target", picture::map(SIZE, &canvas, gray)?))
}
