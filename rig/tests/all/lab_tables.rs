//! The article's experiments, as they ran in `PyTorch`, against ours.
//!
//! The tables have six digits of each loss. `convergence_tables.csv` has the problems as printed,
//! `convergence_tables_alt.csv` the circle's target at (16, 16) and the star's ε at 1e-3.

use rig::lab::convergence::{Experiment, SHOWN, STEPS, Setup};
use rig::lab::descent::Method;
use strokefit::coverage::Coverage;

/// Largest relative difference of the losses at [`EARLY`] steps in double precision, besides half
/// of the table's last digit.
const EXACT: f64 = 1e-6;

/// Steps before which no rounding error has grown.
const EARLY: [usize; 3] = [0, 1, 10];

/// Largest relative difference of other losses; of a trajectory that a rounding error can turn
/// only the verdict is compared.
const CLOSE: f64 = 0.01;

/// A descent that ends below this loss has found its target: what the soft edges leave is at most
/// 0.011 (sigmoid), what a missed stroke or circle costs at least 0.02.
const CONVERGED: f64 = 0.015;

struct Row {
    experiment: String,
    coverage: Coverage,
    optimizer: String,
    init: String,
    single: bool,
    /// At the steps of [`SHOWN`], then after all steps.
    losses: Vec<f64>,
    alternative: bool,
}

impl Row {
    fn parse(line: &str, alternative: bool) -> Self {
        let cells: Vec<&str> = line.split(',').collect();
        let coverage = cells[1].replace("atanx", "atan:");
        Self {
            experiment: cells[0].into(),
            coverage: coverage.parse().unwrap(),
            optimizer: cells[2].into(),
            init: cells[3].into(),
            single: cells[4] == "float32",
            losses: cells[5..=11]
                .iter()
                .map(|cell| cell.parse().unwrap())
                .collect(),
            alternative,
        }
    }

    fn name(&self) -> String {
        let (precision, table) = (
            if self.single { "f32" } else { "f64" },
            if self.alternative {
                ", alternative"
            } else {
                ""
            },
        );
        format!("{}, {}, {precision}{table}", self.experiment, self.coverage)
    }

    /// Our losses at the same steps, from a start `nudge` px off in x and y if it is a circle.
    fn ours(&self, nudge: f64) -> Vec<f64> {
        let (setup, steps) = (self.setup(nudge), SHOWN.iter().chain(&[STEPS]));
        if self.single {
            let descent = setup.descend::<f32>();
            steps.map(|&step| descent.loss_at(step)).collect()
        } else {
            let descent = setup.descend::<f64>();
            steps.map(|&step| descent.loss_at(step)).collect()
        }
    }

    fn setup(&self, nudge: f64) -> Setup {
        let is_circle = self.experiment.starts_with("circle");
        let rate = if is_circle { 2.0 } else { 0.5 };
        let experiment = if is_circle {
            Experiment::Circle {
                target: if self.alternative { 16.0 } else { 48.0 },
                start: nudge + if self.init == "offset" { 48.0 } else { 30.0 },
            }
        } else {
            Experiment::Star {
                eps: if self.alternative { 1e-3 } else { 1e-4 },
            }
        };
        let method = match self.optimizer.as_str() {
            "adam" => Method::Adam(rate),
            "adamw" => Method::AdamW(rate),
            "rmsprop" => Method::RmsProp(0.1),
            other => panic!("no optimiser is called {other}"),
        };
        Setup {
            experiment,
            coverage: self.coverage,
            method,
        }
    }

    /// True if a start off by a rounding error of single precision, some 1e-6 px, makes our run end as this one.
    fn ends_so_after_a_nudge(&self) -> bool {
        let nudges = (-4..=4).map(|k| f64::from(k) * 4e-6);
        let mut runs = nudges.map(|nudge| self.ours(nudge));
        runs.any(|losses| verdict(&losses) == verdict(&self.losses))
    }

    /// True if this is the same run as `other`, whatever its precision.
    fn is_run_of(&self, other: &Self) -> bool {
        let key = |row: &Self| {
            let name = (row.experiment.clone(), row.init.clone(), row.alternative);
            (name, row.coverage.to_string())
        };
        key(self) == key(other)
    }
}

/// True if a run found its target.
fn verdict(losses: &[f64]) -> bool {
    losses.last().is_some_and(|&loss| loss < CONVERGED)
}

fn tables() -> Vec<Row> {
    let printed = include_str!("convergence_tables.csv").lines().skip(1);
    let alternative = include_str!("convergence_tables_alt.csv").lines().skip(1);
    let printed = printed.map(|line| Row::parse(line, false));
    printed
        .chain(alternative.map(|line| Row::parse(line, true)))
        .collect()
}

/// Half a unit of the sixth digit of `x`.
fn half_digit(x: f64) -> f64 {
    0.5 * 10_f64.powf(x.abs().log10().floor() - 5.0)
}

/// Faults of our run of `row`.
fn judge(row: &Row, chaotic: bool) -> Vec<String> {
    let ours = row.ours(0.0);
    let mut complaints = Vec::new();
    let mut same_course = true;
    let steps = SHOWN.iter().chain(&[STEPS]);
    for ((step, theirs), ours) in steps.zip(&row.losses).zip(&ours) {
        let gap = (ours - theirs).abs();
        if !row.single && EARLY.contains(step) && gap > EXACT * theirs + half_digit(*theirs) {
            complaints.push(format!(
                "{} at step {step}: {ours} against {theirs}",
                row.name()
            ));
        }
        same_course &= gap <= CLOSE * theirs;
    }
    let same_verdict = || verdict(&ours) == verdict(&row.losses);
    if !(same_course || chaotic || same_verdict() || row.ends_so_after_a_nudge()) {
        complaints.push(format!("{}: {ours:?} against {:?}", row.name(), row.losses));
    }
    complaints
}

#[test]
fn our_losses_are_those_of_the_tables() {
    let rows = tables();
    assert_eq!(rows.len(), 60 + 30);
    let mut complaints = Vec::new();
    for row in &rows {
        let runs = rows.iter().filter(|other| other.is_run_of(row));
        let chaotic = runs
            .clone()
            .any(|run| verdict(&run.losses) != verdict(&row.losses));
        complaints.extend(judge(row, chaotic));
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
