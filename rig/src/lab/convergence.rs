//! Do shapes find their target? The descents of a circle and of a star, 200 steps each.
//!
//! **Circle.** A circle of radius 8 starts in the middle of the picture (30, 30) or off it (48, 48), and its target is drawn with
//! `raw` coverage. As printed, the article puts the target at 1.5 × the centre, (48, 48), where the second start lies already; its
//! verdicts on that start come out with the target at (16, 16). Both are run. The article adds ε to both components of `p − c`
//! instead of to the square of the distance, which amounts to points that are sampled ε further on; that is how it is done here.
//! It shows: a circle that has shrunk to the least radius rests at 30.0001, on a point of the lattice.
//!
//! **Star.** The union of 16 capsules against a star of four, drawn with `raw` coverage. The article does not give ε for this
//! experiment; its losses come out at 1e-4, and are run at 1e-3 as well.

use rayon::prelude::*;

use super::descent::{Method, Trajectory, descend};
use super::matching::{Form, Matching, Samples};
use super::{COVERAGES, ResultFolder, SIZE};
use crate::report::Table;
use crate::report::picture::{self, gray};
use crate::report::plot::{Chart, Panel, Path, Sheet};
use strokefit::Result;
use strokefit::coverage::Coverage;
use strokefit::math::{self, Real};

/// The steps whose losses are in the tables; the loss after all of [`STEPS`] is there too.
pub const SHOWN: [usize; 6] = [0, 1, 10, 50, 100, 199];

/// Number of steps that the small experiments make.
pub const STEPS: usize = 200;

/// The circles' radius, and the article's bounds of it, px.
const RADIUS: f64 = 8.0;
const RADII: [f64; 2] = [1.0, 64.0];

/// ε that the circle's points are sampled further on, px.
const OFFSET: f64 = 1e-4;

/// Starts and their names, px; and where the target is: as printed, and as the verdicts have it.
const STARTS: [(&str, f64); 2] = [("centered", 30.0), ("offset", 48.0)];
const TARGETS: [f64; 2] = [48.0, 16.0];

const OF_CIRCLE: [Method; 3] = [Method::RmsProp(0.1), Method::Adam(2.0), Method::AdamW(2.0)];

/// Number of nudged starts, and the px by which each is moved further: a rounding error of single precision.
const NUDGES: usize = 17;
const NUDGE: f64 = 4e-6;

/// A circle that ends below this loss has found its target: the softest edge leaves 0.0025, a missed target 0.045.
const CONVERGED: f64 = 0.01;

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

const OF_STAR: [Method; 3] = [Method::Adam(0.5), Method::AdamW(0.5), Method::RmsProp(0.1)];

/// The steepnesses of `atan` that the article compares.
const STEEPNESSES: [f32; 5] = [1.0, 1.5, 2.0, 3.0, 4.0];

/// What moves, from where to where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Experiment {
    /// A circle; both coordinates of its target and of its start, px.
    Circle {
        /// Of the target.
        target: f64,
        /// Of the start.
        start: f64,
    },
    /// Sixteen capsules.
    Star {
        /// ε of the signed distance, px².
        eps: f64,
    },
}

/// One descent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// What moves.
    pub experiment: Experiment,
    /// Coverage function of what moves.
    pub coverage: Coverage,
    /// Optimiser.
    pub method: Method,
}

impl Setup {
    /// The descent, all of it in the precision `T`.
    pub fn descend<T: Real>(&self) -> Trajectory<T> {
        let samples = self.experiment.samples();
        let [target, start] = self.experiment.params();
        let form = self.experiment.form();
        let problem = Matching {
            samples,
            form,
            coverage: self.coverage,
            target: samples.draw(form, &target, Coverage::Raw),
            radii: match form {
                Form::Circle => RADII,
                // Radii are free; a negative one is a capsule that nowhere reaches half.
                Form::Capsule => [f64::NEG_INFINITY, f64::INFINITY],
            },
        };
        descend(&problem, &start, self.method, STEPS)
    }

    fn labels(&self) -> Labels {
        let [experiment, variant, start] = match self.experiment {
            Experiment::Circle { target, start } => {
                let name = STARTS.iter().find(|(_, at)| *at == start);
                let name = name.map_or("other", |(name, _)| name);
                ["circle".into(), format!("target {target}"), name.into()]
            }
            Experiment::Star { eps } => ["star".into(), format!("eps {eps:e}"), "random".into()],
        };
        let (coverage, method) = (self.coverage.to_string(), self.method.to_string());
        [experiment, variant, coverage, method, start]
    }
}

impl Experiment {
    fn form(self) -> Form {
        match self {
            Self::Circle { .. } => Form::Circle,
            Self::Star { .. } => Form::Capsule,
        }
    }

    fn samples<T: Real>(self) -> Samples<T> {
        let (origin, eps) = match self {
            Self::Circle { .. } => (OFFSET, 0.0),
            Self::Star { eps } => (0.0, eps),
        };
        Samples {
            size: SIZE,
            origin: T::of(origin),
            eps: T::of(eps),
        }
    }

    /// The numbers of the target and of the start.
    fn params<T: Real>(self) -> [Vec<T>; 2] {
        let flat = |rows: &[[f64; 5]]| rows.as_flattened().iter().map(|&x| T::of(x)).collect();
        match self {
            Self::Circle { target, start } => {
                [target, start].map(|at| [at, at, RADIUS].map(T::of).to_vec())
            }
            Self::Star { .. } => [flat(&STAR), flat(&START)],
        }
    }

    /// Shapes by a coverage function.
    fn panel(self, coverage: Coverage, params: &[f64]) -> Result<Panel> {
        let canvas = self.samples().draw(self.form(), params, coverage);
        Ok(Panel::new("target", picture::map(SIZE, &canvas, gray)?))
    }

    /// Where a descent ended; of a circle its way there, and the target's outline.
    fn end(self, coverage: Coverage, descent: &Trajectory<f64>) -> Result<Panel> {
        let mut panel = self.panel(coverage, descent.last())?;
        if let Self::Circle { target, .. } = self {
            let way = descent.params.iter();
            let way = way.map(|p| on_picture([p[0], p[1]])).collect();
            panel.paths = vec![line(way, [0, 114, 178], true), outline(target)];
        }
        Ok(panel)
    }
}

fn line(points: Vec<[f64; 2]>, color: [u8; 3], arrow: bool) -> Path {
    Path {
        points,
        color,
        arrow,
    }
}

fn outline(place: f64) -> Path {
    let point = |i: i32| {
        let (sin, cos) = math::sin_cos(f64::from(i) * std::f64::consts::TAU / 48.0);
        on_picture([place + RADIUS * cos, place + RADIUS * sin])
    };
    line((0..=48).map(point).collect(), [213, 94, 0], false)
}

/// Pixels are sampled at integers, and drawn with their centres at halves. What has left the
/// picture is shown on its border.
fn on_picture(p: [f64; 2]) -> [f64; 2] {
    p.map(|x| (x + 0.5).clamp(0.0, SIZE as f64))
}

/// Descents that are shown together: a name, what moves, how, and by which coverage functions.
type Group = (String, Experiment, Method, Vec<Coverage>);

/// Writes `circle.csv`, a chart of the losses and a sheet of where the circles went per target, start and optimiser, and
/// `circle-nudged.csv`.
///
/// # Errors
/// When a file cannot be written.
pub fn circle(output: &mut ResultFolder) -> Result<()> {
    let mut groups: Vec<Group> = Vec::new();
    for target in TARGETS {
        for (name, start) in STARTS {
            for method in OF_CIRCLE {
                let name = format!("circle-target{target}-{name}-{method}");
                let experiment = Experiment::Circle { target, start };
                groups.push((name, experiment, method, of_circle()));
            }
        }
    }
    run(output, "circle.csv", &groups)?;
    output.doing(
        0.9,
        "the same from starts that are nudged by rounding errors",
    );
    output.text("circle-nudged.csv", &nudged().csv())
}

fn of_circle() -> Vec<Coverage> {
    COVERAGES.into_iter().chain([Coverage::Raw]).collect()
}

/// Writes `star.csv`, and per ε and optimiser, and for the steepnesses of `atan`, a chart of the losses and a sheet of the drawings.
///
/// # Errors
/// When a file cannot be written.
pub fn star(output: &mut ResultFolder) -> Result<()> {
    let mut groups: Vec<Group> = Vec::new();
    for eps in EPSILONS {
        let experiment = Experiment::Star { eps };
        for method in OF_STAR {
            let name = format!("star-eps{eps:e}-{method}");
            groups.push((name, experiment, method, COVERAGES.to_vec()));
        }
        let atans = STEEPNESSES.map(|k| Coverage::Atan { k }).to_vec();
        let name = format!("star-eps{eps:e}-atan");
        groups.push((name, experiment, OF_STAR[0], atans));
    }
    run(output, "star.csv", &groups)
}

/// Makes all descents in both precisions, and writes their table `file`; those in `f64` are shown.
fn run(output: &mut ResultFolder, file: &str, groups: &[Group]) -> Result<()> {
    let mut table = convergence();
    for (i, (name, experiment, method, coverages)) in groups.iter().enumerate() {
        output.doing(i as f64 / groups.len() as f64, name);
        let setup = |&coverage: &Coverage| Setup {
            experiment: *experiment,
            coverage,
            method: *method,
        };
        let setups: Vec<Setup> = coverages.iter().map(setup).collect();
        let both = |setup: &Setup| (setup.descend::<f64>(), setup.descend::<f32>());
        let descents: Vec<_> = setups.par_iter().map(both).collect();
        for (setup, (double, single)) in setups.iter().zip(&descents) {
            push_descent(&mut table, &setup.labels(), double);
            push_descent(&mut table, &setup.labels(), single);
        }
        let double = descents.into_iter().map(|(double, _)| double);
        let descents: Vec<_> = coverages.iter().copied().zip(double).collect();
        // A circle's target is an outline over each panel.
        let target = match experiment {
            Experiment::Circle { .. } => None,
            Experiment::Star { .. } => {
                Some(experiment.panel(Coverage::Raw, &experiment.params()[0])?)
            }
        };
        show(output, name, &descents, target, |coverage, descent| {
            experiment.end(coverage, descent)
        })?;
    }
    output.text(file, &table.csv())
}

/// Counts how often each centred start finds its target when it is moved by rounding errors: a verdict that a millionth
/// of a px turns is luck.
fn nudged() -> Table {
    let head = [
        "target",
        "coverage",
        "optimizer",
        "precision",
        "nudged_starts",
        "converged",
    ];
    let mut table = Table::new(&head);
    for target in TARGETS {
        for method in OF_CIRCLE {
            for coverage in of_circle() {
                let setup = |start| Setup {
                    experiment: Experiment::Circle { target, start },
                    coverage,
                    method,
                };
                for (precision, converged) in [
                    ("f64", converged_of_nudged::<f64>(setup)),
                    ("f32", converged_of_nudged::<f32>(setup)),
                ] {
                    let labels = [target.to_string(), coverage.to_string()];
                    let how = [method.to_string(), precision.to_owned()];
                    let counts = [NUDGES.to_string(), converged.to_string()];
                    table.row(labels.into_iter().chain(how).chain(counts));
                }
            }
        }
    }
    table
}

fn converged_of_nudged<T: Real>(setup: impl Fn(f64) -> Setup + Sync) -> usize {
    let converged = |k: &usize| {
        let start = STARTS[0].1 + (*k as f64 - (NUDGES / 2) as f64) * NUDGE;
        setup(start).descend::<T>().loss_at(STEPS) < CONVERGED
    };
    (0..NUDGES).into_par_iter().filter(converged).count()
}

/// Labels of a descent: `[experiment, variant, coverage, optimizer, start]`.
pub(super) type Labels = [String; 5];

/// A table of descents: the losses at [`SHOWN`], after all steps, the least, and where it ended.
pub(super) fn convergence() -> Table {
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

/// Appends a descent to a [`convergence`] table. The precision is `f64` or `f32`.
pub(super) fn push_descent<T: Real>(table: &mut Table, labels: &Labels, descent: &Trajectory<T>) {
    let mut cells = labels.to_vec();
    cells.push(std::any::type_name::<T>().to_owned());
    let shown = SHOWN.iter().chain(&[STEPS]);
    cells.extend(shown.map(|&step| descent.loss_at(step).to_string()));
    cells.push(descent.least().to_string());
    let last = descent.last().iter().map(|x| format!("{:.6}", x.to_f64()));
    cells.push(last.collect::<Vec<_>>().join(" "));
    table.row(cells);
}

/// Writes `NAME-loss.svg`, the losses of descents, and `NAME-end.png`, where they ended, after their target if that is given.
pub(super) fn show(
    output: &mut ResultFolder,
    name: &str,
    descents: &[(Coverage, Trajectory<f64>)],
    target: Option<Panel>,
    draw: impl Fn(Coverage, &Trajectory<f64>) -> Result<Panel>,
) -> Result<()> {
    let course = |(coverage, descent): &(Coverage, Trajectory<f64>)| {
        let losses = descent.losses.iter().enumerate();
        let points = losses.map(|(step, &loss)| [step as f64, loss]).collect();
        (coverage.to_string(), points)
    };
    let chart = Chart {
        title: name.into(),
        axes: ["step".into(), "loss".into()],
        logarithmic: true,
        series: descents.iter().map(course).collect(),
        ..Chart::default()
    };
    output.text(&format!("{name}-loss.svg"), &chart.svg()?)?;
    let mut panels = Vec::from_iter(target);
    for (coverage, descent) in descents {
        panels.push(Panel {
            title: format!("{coverage} {:.5}", descent.loss_at(STEPS)),
            ..draw(*coverage, descent)?
        });
    }
    let sheet = Sheet {
        title: name.into(),
        columns: 3,
        zoom: 4,
        panels,
    };
    output.picture(&format!("{name}-end.png"), &sheet.draw()?)
}
