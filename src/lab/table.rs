//! Tables of results as CSV.

use std::fmt::{Display, Write};

use rayon::prelude::*;

use super::descent::Descent;
use crate::math::Real;

/// The steps whose losses are in the tables; the loss after all of [`STEPS`] is there too.
pub const SHOWN: [usize; 6] = [0, 1, 10, 50, 100, 199];

/// How many steps the small experiments make.
pub const STEPS: usize = 200;

/// Rows of comma-separated values under a head. Cells with a comma, a quote or a line break are
/// quoted.
#[derive(Debug, Clone)]
pub struct Table {
    text: String,
    columns: usize,
}

impl Table {
    /// A table of the columns `head`.
    pub fn new<S: AsRef<str>>(head: &[S]) -> Self {
        let mut table = Self {
            text: String::new(),
            columns: head.len(),
        };
        table.row(head.iter().map(AsRef::as_ref));
        table
    }

    /// Appends a row, of as many cells as the head has.
    pub fn row<D: Display>(&mut self, cells: impl IntoIterator<Item = D>) {
        let cells: Vec<String> = cells
            .into_iter()
            .map(|cell| quoted(&cell.to_string()))
            .collect();
        debug_assert_eq!(cells.len(), self.columns);
        // Writing to a `String` cannot fail.
        let _ = writeln!(self.text, "{}", cells.join(","));
    }

    /// The table as CSV text.
    pub fn text(&self) -> &str {
        &self.text
    }
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

/// What a descent was of: `[experiment, variant, coverage, optimizer, start]`.
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
pub trait Setup: Sync {
    /// The descent, all of it in the precision `T`.
    fn descend<T: Real>(&self) -> Descent<T>;

    /// What it is of.
    fn labels(&self) -> Labels;
}

/// Makes all descents in both precisions and appends them to a [`convergence`] table; those in
/// `f64` are given back.
pub fn tabulated(table: &mut Table, setups: &[impl Setup]) -> Vec<Descent<f64>> {
    let both = |setup: &_| (Setup::descend::<f64>(setup), Setup::descend::<f32>(setup));
    let descents: Vec<_> = setups.par_iter().map(both).collect();
    for (setup, (double, single)) in setups.iter().zip(&descents) {
        push_descent(table, &setup.labels(), double);
        push_descent(table, &setup.labels(), single);
    }
    descents.into_iter().map(|(double, _)| double).collect()
}

/// Appends a descent to a [`convergence`] table. The precision is `f64` or `f32`.
pub fn push_descent<T: Real>(table: &mut Table, labels: &Labels, descent: &Descent<T>) {
    let mut cells = labels.to_vec();
    cells.push(std::any::type_name::<T>().to_owned());
    let shown = SHOWN.iter().chain(&[STEPS]);
    cells.extend(shown.map(|&step| descent.loss_at(step).to_string()));
    cells.push(descent.least().to_string());
    let last = descent.last().iter().map(|x| format!("{x:.6}"));
    cells.push(last.collect::<Vec<_>>().join(" "));
    table.row(cells);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_that_need_quotes_get_them() {
        let mut table = Table::new(&["a", "b"]);
        table.row(["1,2", "say \"x\""]);
        table.row([1.5, 2.0]);
        assert_eq!(table.text(), "a,b\n\"1,2\",\"say \"\"x\"\"\"\n1.5,2\n");
    }
}
