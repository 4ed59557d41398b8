//! `strokefit fit`: a picture in, a verified SVG out.

use std::path::PathBuf;

use anyhow::Result;
use strokefit::fit::Fitter;

use super::job::Job;
use super::options::Options;
use super::{Status, Verbosity};

/// Draw a picture with strokes
///
/// The SVG has one layer per stage, from large strokes to small. Equal pictures and options give
/// equal bytes, on any number of threads.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  strokefit fit photo.jpg -o photo.svg
  strokefit fit photo.jpg -o photo.svg --preset best --strokes 5000 --report photo.json
  strokefit fit logo.png -o logo.svg --opaque --background none --bytes 20000
  curl -s https://example.org/a.png | strokefit fit - -o - --psnr 30 > a.svg")]
pub(super) struct Args {
    /// PNG, JPEG, WebP, GIF (first frame), BMP or TIFF picture; - for standard input
    input: PathBuf,
    /// The SVG to write; - for standard output
    #[arg(short, long, value_name = "OUT.svg")]
    output: PathBuf,
    /// Write what was done as JSON; - for standard output
    #[arg(long, value_name = "R.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    options: Options,
}

pub(super) fn run(args: &Args, verbosity: Verbosity) -> Result<Status> {
    let job = Job {
        input: &args.input,
        output: &args.output,
        report: args.report.as_deref(),
        options: &args.options,
    };
    job.run(verbosity, &|picture, observer| {
        let fitter = Fitter::new(args.options.config()).execution(args.options.execution());
        Ok(fitter.observer(observer).fit(picture)?)
    })
}
