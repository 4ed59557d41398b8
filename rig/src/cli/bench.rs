//! The measurements: `pareto`, `stability`, `inverse`, `robust`, `scaling` and `compare`.

mod compare;
mod drawings;

use std::path::{Path, PathBuf};

use crate::bench::child::{Runner, perform};
use crate::bench::pareto::{self, Effort, Sweep, Work};
use crate::bench::peers::{installed, known, missing};
use crate::bench::quality;
use crate::bench::scaling;
use crate::bench::stability::{self, Extent};
use crate::lab::ResultFolder;
use anyhow::Result;
use clap::Subcommand;
use clap::builder::TypedValueParser;
use strokefit::coverage::CoverageSchedule;
use strokefit::report::json;

use strokefit::cli::{Status, Verbosity, input, output};

use super::domain;
use compare::Compare;
use drawings::{Inverse, Robust};

#[derive(Debug, Subcommand)]
pub(super) enum Benchmark {
    Pareto(Pareto),
    Stability(Stability),
    Inverse(Inverse),
    Robust(Robust),
    Scaling(Scaling),
    Compare(Compare),
}

/// One case of a benchmark that another process of this program runs.
#[derive(Debug, clap::Args)]
pub(super) struct Measurement {
    /// Case as JSON
    task: String,
}

#[derive(Debug, clap::Args)]
struct Extents {
    /// Folder to write to; created if it does not exist
    #[arg(short, long = "output", value_name = "DIR")]
    output: PathBuf,
    /// Measure fewer and smaller cases, in a minute or less
    #[arg(long)]
    short: bool,
}

/// Measure time, memory, bytes and strokes against error, for fits, for the article's recipe, and for other
/// programs that are installed (vtracer, primitive, potrace, Inkscape)
///
/// Each result is saved at once. A case whose result is already in the folder is not measured again.
#[derive(Debug, clap::Args)]
pub(super) struct Pareto {
    /// Pictures to draw
    #[arg(required = true)]
    pictures: Vec<PathBuf>,
    #[command(flatten)]
    extents: Extents,
    /// Draw nothing; instead score the SVGs in this folder that have the names of the pictures
    #[arg(long, value_name = "DIR")]
    svgs: Vec<PathBuf>,
    /// Numbers of strokes [default: 10 to 10,000]
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = domain::count)]
    strokes: Vec<usize>,
    /// Presets [default: all]
    #[arg(long, value_name = "PRESET", value_delimiter = ',', value_parser = effort())]
    preset: Vec<Effort>,
    /// Coverage functions: the first for all fits, each other one for one draft
    #[arg(long, value_name = "EDGE", value_delimiter = ',')]
    coverage: Vec<CoverageSchedule>,
    /// Number of seeds that show the spread of balanced fits
    #[arg(long, value_name = "N")]
    seeds: Option<u64>,
}

/// The presets, and what comes before them.
fn effort() -> impl TypedValueParser<Value = Effort> {
    domain::one_of([
        (Effort::Stages, "A draft without polish"),
        (Effort::Draft, "As --preset draft"),
        (Effort::Balanced, "As --preset balanced"),
        (Effort::Best, "As --preset best"),
    ])
}

/// Try hard cases: degenerate strokes and pictures, precision, extreme learning rates, thin strokes
#[derive(Debug, clap::Args)]
pub(super) struct Stability {
    /// Pictures to fit in addition to the hard ones
    pictures: Vec<PathBuf>,
    #[command(flatten)]
    extents: Extents,
}

/// Measure how time and memory grow with strokes, pixels and threads
#[derive(Debug, clap::Args)]
pub(super) struct Scaling {
    /// Picture, resampled to every size [default: a generated one]
    picture: Option<PathBuf>,
    /// Measure instead how faithful drawings of these pictures are that may take 0.1 to 5 s, and those of other programs
    #[arg(long, value_name = "PICTURE", num_args = 1.., conflicts_with_all = ["picture", "short"])]
    quality: Vec<PathBuf>,
    #[command(flatten)]
    extents: Extents,
}

impl Benchmark {
    /// Runs it; how many cases failed.
    fn run(&self, folder: &Path, files: &mut ResultFolder, verbosity: Verbosity) -> Result<usize> {
        match self {
            Self::Pareto(pareto) => pareto.run(folder, files, verbosity),
            Self::Stability(stability) => stability.run(files),
            Self::Inverse(inverse) => inverse.run(files, verbosity),
            Self::Robust(robust) => robust.run(files, verbosity),
            Self::Scaling(scaling) => scaling.run(files, verbosity),
            Self::Compare(compare) => compare.run(folder, files, verbosity),
        }
    }
}

/// Arguments that tell a child of this program that it is one.
const CHILD: [&str; 1] = ["case"];

impl Pareto {
    fn work(&self) -> Work {
        if !self.svgs.is_empty() {
            return Work::Files(self.svgs.clone());
        }
        let mut sweep = if self.extents.short {
            Sweep::short()
        } else {
            Sweep::full()
        };
        if !self.strokes.is_empty() {
            sweep.strokes.clone_from(&self.strokes);
        }
        if !self.preset.is_empty() {
            sweep.efforts.clone_from(&self.preset);
        }
        if !self.coverage.is_empty() {
            sweep.coverages.clone_from(&self.coverage);
        }
        sweep.seeds = self.seeds.unwrap_or(sweep.seeds);
        Work::Sweep(sweep)
    }

    fn run(&self, folder: &Path, files: &mut ResultFolder, verbosity: Verbosity) -> Result<usize> {
        let runner = Runner::new(CHILD)?;
        let measure = |case: &_, svg: &_| runner.case(case, svg);
        let pictures = &self.pictures;
        let (work, peers) = (self.work(), installed());
        let report = pareto::run(folder, pictures, &work, &peers, &measure, &mut say)?;
        pareto::publish(files, folder, pictures, &report)?;
        if self.svgs.is_empty() {
            say_missing(&missing(), verbosity);
        }
        Ok(report.failures())
    }
}

impl Stability {
    fn run(&self, files: &mut ResultFolder) -> Result<usize> {
        let extent = if self.extents.short {
            Extent::Short
        } else {
            Extent::Full
        };
        let named = |path: &PathBuf| Ok((input::name(path), input::picture(path)?));
        let pictures: Vec<_> = self.pictures.iter().map(named).collect::<Result<_>>()?;
        let (report, map) = stability::run(extent, &pictures, &mut |entry| say(&entry.line()))?;
        let table = report.table();
        files.text("stability.csv", &table.csv())?;
        files.text("stability.md", &report.markdown())?;
        files.text("stability.json", &json(&report)?)?;
        files.text("agreement.csv", &map.table().csv())?;
        files.picture("agreement.png", &map.picture()?)?;
        Ok(report.failures())
    }
}

fn say_missing(names: &[&str], verbosity: Verbosity) {
    for name in names {
        verbosity.say(format_args!(
            "{name}: not measured: it is not installed, is too old, or lacks a display"
        ));
    }
}

impl Scaling {
    /// Writes how faithful drawings are that may take so long.
    fn quality(&self, files: &mut ResultFolder, verbosity: Verbosity) -> Result<usize> {
        let report = quality::run(&self.quality, &installed(), &mut say)?;
        files.text("quality.csv", &report.table().csv())?;
        files.text("quality.md", &report.table().markdown())?;
        files.text("quality.json", &json(&report)?)?;
        say_missing(&missing(), verbosity);
        Ok(0)
    }

    fn run(&self, files: &mut ResultFolder, verbosity: Verbosity) -> Result<usize> {
        if !self.quality.is_empty() {
            return self.quality(files, verbosity);
        }
        let runner = Runner::new(CHILD)?;
        let measure = |point: &_| runner.point(point);
        let report = scaling::run(self.extents.short, self.picture.clone(), &measure, &mut say)?;
        files.text("scaling.csv", &report.table().csv())?;
        files.text("scaling.md", &report.markdown())?;
        files.text("scaling.json", &json(&report)?)?;
        for (axis, chart) in report.charts()? {
            files.text(&format!("scaling-{axis}.svg"), &chart)?;
        }
        Ok(report.failures())
    }
}

/// A line on standard output, which may be closed.
fn say(line: &str) {
    let _ = output::Output::Stdout.write(format!("{line}\n").as_bytes());
}

pub(super) fn measure(measurement: &Measurement) -> Result<Status> {
    say(&perform(&measurement.task, &known())?);
    Ok(Status::Done)
}

pub(super) fn run(benchmark: &Benchmark, verbosity: Verbosity) -> Result<Status> {
    let (Benchmark::Pareto(Pareto { extents, .. })
    | Benchmark::Stability(Stability { extents, .. })
    | Benchmark::Inverse(Inverse { extents, .. })
    | Benchmark::Robust(Robust { extents, .. })
    | Benchmark::Scaling(Scaling { extents, .. })
    | Benchmark::Compare(Compare { extents, .. })) = benchmark;
    let folder = extents.output.as_path();
    let mut files = ResultFolder::new(folder, true)?;
    let failures = benchmark.run(folder, &mut files, verbosity)?;
    for path in files.finish() {
        verbosity.detail(format_args!("wrote {}", path.display()));
    }
    verbosity.say(format_args!("{}: {failures} failed", folder.display()));
    Ok(if failures == 0 {
        Status::Done
    } else {
        Status::Failed
    })
}
