//! Tables of the losses of descents.

use rayon::prelude::*;

use super::descent::Trajectory;
use crate::report::Table;
use strokefit::math::Real;

/// The steps whose losses are in the tables; the loss after all of [`STEPS`] is there too.
pub const SHOWN: [usize; 6] = [0, 1, 10, 50, 100, 199];

/// Number of steps that the small experiments make.
pub const STEPS: usize = 200;

/// Labels of a descent: `[experiment, variant, coverage, optimizer, start]`.
pub type Labels = [String; 5];

/// A table of descents: the losses at [`SHOWN`], after all steps, the least, and where it ended.
pub fn convergence() -> Table {
    let labels = [
        "experiment",
        "variant",
        "coverage",
        "optimizer",
        "start",
        "precision",
    ];
    let losses = SHOWN.map(|step| format!("loss_{step}"));
    let mut head: Vec<String> = labels.map(str::to_owned).to_vec();
    head.extend(losses);
    head.extend(["loss_after_200_updates", "min_loss", "final_params"].map(str::to_owned));
    Table::new(&head)
}

/// A descent that can be made in either precision.
pub trait EitherPrecision: Sync {
    /// The descent, all of it in the precision `T`.
    fn descend<T: Real>(&self) -> Trajectory<T>;

    /// Labels of the descent.
    fn labels(&self) -> Labels;
}

/// Makes all descents in both precisions and appends them to a [`convergence`] table; those in
/// `f64` are given back.
pub fn tabulated(table: &mut Table, setups: &[impl EitherPrecision]) -> Vec<Trajectory<f64>> {
    let both = |setup: &_| {
        (
            EitherPrecision::descend::<f64>(setup),
            EitherPrecision::descend::<f32>(setup),
        )
    };
    let descents: Vec<_> = setups.par_iter().map(both).collect();
    for (setup, (double, single)) in setups.iter().zip(&descents) {
        push_descent(table, &setup.labels(), double);
        push_descent(table, &setup.labels(), single);
    }
    descents.into_iter().map(|(double, _)| double).collect()
}

/// Appends a descent to a [`convergence`] table. The precision is `f64` or `f32`.
pub fn push_descent<T: Real>(table: &mut Table, labels: &Labels, descent: &Trajectory<T>) {
    let mut cells = labels.to_vec();
    cells.push(std::any::type_name::<T>().to_owned());
    let shown = SHOWN.iter().chain(&[STEPS]);
    cells.extend(shown.map(|&step| descent.loss_at(step).to_string()));
    cells.push(descent.least().to_string());
    let last = descent.last().iter().map(|x| format!("{:.6}", x.to_f64()));
    cells.push(last.collect::<Vec<_>>().join(" "));
    table.row(cells);
}
