//! The measurements: `pareto`, `inverse`, `robust`, `scaling` and `compare`.

mod compare;
mod drawings;

use std::path::PathBuf;

use crate::bench::programs::installed;
use crate::bench::{pareto, scaling};
use crate::lab::ResultFolder;
use anyhow::Result;
use clap::Subcommand;
use strokefit::report::json;

use strokefit::cli::{Status, Verbosity, output};

use compare::Compare;
use drawings::{Inverse, Robust};

#[derive(Debug, Subcommand)]
pub(super) enum Benchmark {
    Pareto(Pareto),
    Inverse(Inverse),
    Robust(Robust),
    Scaling(Scaling),
    Compare(Compare),
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

/// Measure time, memory and bytes against error, for fits, for the article's recipe, and for other
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
    /// Options of strokefit fit, in quotes; once for each fit [default: 10 to 10,000 strokes at all presets]
    #[arg(long, value_name = "OPTIONS", allow_hyphen_values = true)]
    settings: Vec<String>,
}

/// Measure how time and memory grow with strokes, pixels and threads
#[derive(Debug, clap::Args)]
pub(super) struct Scaling {
    /// Picture, resampled to every size [default: a generated one]
    picture: Option<PathBuf>,
    #[command(flatten)]
    extents: Extents,
}

impl Benchmark {
    /// Runs it; how many cases failed.
    fn run(&self, files: &mut ResultFolder, verbosity: Verbosity) -> Result<usize> {
        match self {
            Self::Pareto(pareto) => pareto.run(files, verbosity),
            Self::Inverse(inverse) => inverse.run(files, verbosity),
            Self::Robust(robust) => robust.run(files, verbosity),
            Self::Scaling(scaling) => scaling.run(files),
            Self::Compare(compare) => compare.run(files, verbosity),
        }
    }
}

impl Pareto {
    fn run(&self, files: &mut ResultFolder, verbosity: Verbosity) -> Result<usize> {
        let is_short = self.extents.short;
        let settings = match self.settings.as_slice() {
            [] => pareto::settings(is_short),
            given => given.to_vec(),
        };
        let (peers, missing) = installed();
        let report = pareto::run(files, &self.pictures, &settings, is_short, &peers, &mut say)?;
        say_missing(&missing, verbosity);
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
    fn run(&self, files: &mut ResultFolder) -> Result<usize> {
        let report = scaling::run(self.extents.short, self.picture.as_deref(), &mut say)?;
        files.text("scaling.csv", &report.table().csv())?;
        files.text("scaling.md", &report.markdown())?;
        files.text("scaling.json", &json(&report)?)?;
        Ok(report.failures())
    }
}

/// A line on standard output, which may be closed.
fn say(line: &str) {
    let _ = output::Output::Stdout.write(format!("{line}\n").as_bytes());
}

pub(super) fn run(benchmark: &Benchmark, verbosity: Verbosity) -> Result<Status> {
    let (Benchmark::Pareto(Pareto { extents, .. })
    | Benchmark::Inverse(Inverse { extents, .. })
    | Benchmark::Robust(Robust { extents, .. })
    | Benchmark::Scaling(Scaling { extents, .. })
    | Benchmark::Compare(Compare { extents, .. })) = benchmark;
    let folder = extents.output.as_path();
    let mut files = ResultFolder::new(folder, true)?;
    let failures = benchmark.run(&mut files, verbosity)?;
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
