//! The command line: arguments and subcommands. Messages, hints and exit statuses are those of `strokefit`.

mod bench;
mod domain;
mod lab;

use std::ffi::OsString;

use anyhow::Result;
use clap::{Command, CommandFactory, FromArgMatches, Parser, Subcommand};
use strokefit::cli::{Status, Verbosity, usage};

use bench::Benchmark;

/// Runs the program and returns its exit status. `args` begin with the program's name.
pub fn main(args: Vec<OsString>) -> u8 {
    // The measurements have this program fit, so that what is measured is the library that it was built with.
    if args.get(1).is_some_and(|word| word == "fit") {
        return strokefit::cli::main(args);
    }
    let status = match parse(&args) {
        Ok(args) => run(&args).unwrap_or_else(|error| strokefit::cli::fail(&error)),
        Err(error) => usage::refuse(&error.into(), &args),
    };
    status.leave()
}

/// Measures cost against error, what is found again, and growth with size; repeats the article's experiments
///
/// Each case of a measurement prints a line to standard output that ends with its verdict. Tables, plots and pages go to
/// the folder. The exit status is 1 if a case fails.
#[derive(Debug, Parser)]
#[command(
    name = "strokefit-rig",
    version,
    after_help = "Examples:
  strokefit-rig pareto photo.png -o out --short
  strokefit-rig pareto photo.png -o out --settings '--time 0.5' --settings '--time 1'
  strokefit-rig inverse icons/*.svg -o out
  strokefit-rig inverse emoji -o out --short
  strokefit-rig robust emoji -o out --short
  strokefit-rig scaling photo.png -o out
  strokefit-rig compare ../old/strokefit target/release/strokefit -o out --short
  strokefit-rig lab circle -o out"
)]
struct Args {
    #[command(subcommand)]
    rig: Rig,
    #[command(flatten)]
    verbosity: Verbosity,
}

#[derive(Debug, Subcommand)]
enum Rig {
    #[command(flatten)]
    Benchmark(Benchmark),
    Lab(lab::Args),
}

fn parse(args: &[OsString]) -> Result<Args, clap::Error> {
    let matches = command().try_get_matches_from(args)?;
    Args::from_arg_matches(&matches)
}

/// The whole command line.
fn command() -> Command {
    usage::examples_first(Args::command())
}

/// Does what the arguments ask for.
fn run(args: &Args) -> Result<Status> {
    strokefit::verify::silence_panics();
    match &args.rig {
        Rig::Benchmark(benchmark) => bench::run(benchmark, args.verbosity),
        Rig::Lab(lab) => lab::run(lab, args.verbosity),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        command().debug_assert();
    }
}
