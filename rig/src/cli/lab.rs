//! `strokefit-rig lab`: the experiments.

use std::path::{Path, PathBuf};

use crate::lab::{self, ResultFolder, article};
use anyhow::Result;
use clap::Subcommand;
use strokefit::coverage::CoverageSchedule;
use strokefit::fit::{Execution, Simd};
use strokefit::image::Image;

use strokefit::cli::{Status, Verbosity, input};

use super::domain;

/// Repeat the article's experiments, with tables and plots
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  strokefit-rig lab circle -o out
  strokefit-rig lab article photo.png -o out --strokes 1000 --coverage 'sigmoid>smoothstep'
  strokefit-rig lab compare photo.png logo.png -o out --strokes 1000 --iterations 500")]
pub(super) struct Args {
    #[command(subcommand)]
    experiment: Experiment,
}

#[derive(Debug, Subcommand)]
enum Experiment {
    /// Plot where the loss pulls a circle, from every start
    Field(Folder),
    /// Move a circle to its target, with each coverage function and optimiser
    Circle(Folder),
    /// Fit sixteen strokes to a star of four
    Star(Folder),
    /// Fit coloured strokes to coloured strokes
    Colors(Folder),
    Article(Article),
    Compare(Compare),
}

#[derive(Debug, clap::Args)]
struct Folder {
    /// Folder to write to; created if it does not exist
    #[arg(short, long = "output", value_name = "DIR")]
    output: PathBuf,
}

/// Run the article's demo: all strokes at once, from a random start
#[derive(Debug, clap::Args)]
struct Article {
    /// Picture to draw. - means standard input
    picture: PathBuf,
    #[command(flatten)]
    folder: Folder,
    #[command(flatten)]
    recipe: RunArgs,
    /// Coverage function: smoothstep, sigmoid, tanh, atan[:K] or raw; A>B changes from A to B during the fit
    #[arg(long, value_name = "EDGE", default_value = "smoothstep")]
    coverage: CoverageSchedule,
    /// Iterations between two rows of the table
    #[arg(long, value_name = "N", default_value = "30", value_parser = domain::count, allow_negative_numbers = true)]
    every: usize,
}

/// Compare coverage functions, mixes of two, and the staged fit on pictures
#[derive(Debug, clap::Args)]
struct Compare {
    /// Pictures to draw
    #[arg(required = true)]
    pictures: Vec<PathBuf>,
    #[command(flatten)]
    folder: Folder,
    #[command(flatten)]
    recipe: RunArgs,
}

#[derive(Debug, clap::Args)]
struct RunArgs {
    /// Number of strokes
    #[arg(long, value_name = "N", default_value = "5000", value_parser = domain::count, allow_negative_numbers = true)]
    strokes: usize,
    /// Number of iterations
    #[arg(long, value_name = "N", default_value = "1500", value_parser = domain::count, allow_negative_numbers = true)]
    iterations: usize,
    /// Seed of the random start
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Worker threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = domain::threads, allow_negative_numbers = true)]
    threads: Option<usize>,
}

impl RunArgs {
    fn config(&self) -> article::ArticleRun {
        article::ArticleRun {
            strokes: self.strokes,
            iterations: self.iterations,
            seed: self.seed,
            ..article::ArticleRun::default()
        }
    }

    fn execution(&self) -> Execution {
        Execution {
            threads: self.threads,
            simd: Simd::Auto,
        }
    }
}

impl Experiment {
    fn folder(&self) -> &Path {
        match self {
            Self::Field(folder)
            | Self::Circle(folder)
            | Self::Star(folder)
            | Self::Colors(folder) => &folder.output,
            Self::Article(article) => &article.folder.output,
            Self::Compare(compare) => &compare.folder.output,
        }
    }

    fn run(&self, output: &mut ResultFolder) -> Result<()> {
        match self {
            Self::Field(_) => lab::field::run(output)?,
            Self::Circle(_) => lab::convergence::circle(output)?,
            Self::Star(_) => lab::convergence::star(output)?,
            Self::Colors(_) => lab::colors::run(output)?,
            Self::Article(article) => article.run(output)?,
            Self::Compare(compare) => compare.run(output)?,
        }
        Ok(())
    }
}

impl Article {
    fn run(&self, output: &mut ResultFolder) -> Result<()> {
        let picture = opaque(&self.picture)?;
        let config = article::ArticleRun {
            coverage: self.coverage,
            every: self.every,
            ..self.recipe.config()
        };
        article::run(output, &picture, &config, self.recipe.execution())?;
        Ok(())
    }
}

impl Compare {
    fn run(&self, output: &mut ResultFolder) -> Result<()> {
        for path in &self.pictures {
            let picture = opaque(path)?;
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let name = format!("compare-{stem}");
            let (config, execution) = (self.recipe.config(), self.recipe.execution());
            lab::compare::run(output, &name, &picture, &config, execution)?;
        }
        Ok(())
    }
}

/// A picture, its alpha laid on white.
fn opaque(path: &Path) -> Result<Image> {
    Ok(input::picture(path)?.flattened([1.0; 3]))
}

pub(super) fn run(args: &Args, verbosity: Verbosity) -> Result<Status> {
    let folder = args.experiment.folder();
    let mut output = ResultFolder::new(folder, verbosity.quiet)?;
    let outcome = args.experiment.run(&mut output);
    let written = output.finish();
    outcome?;
    for path in &written {
        verbosity.detail(format_args!("wrote {}", path.display()));
    }
    verbosity.say(format_args!(
        "{}: {} files",
        folder.display(),
        written.len()
    ));
    Ok(Status::Done)
}
