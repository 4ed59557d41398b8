//! `strokefit fit`: pictures in, verified SVGs out.

use std::path::PathBuf;

use anyhow::Result;

use super::batch;
use super::options::Options;
use super::{Status, Verbosity};

/// Turn pictures into SVGs made of strokes
///
/// The SVG has one layer per stage, from large strokes to small. Equal pictures and options give equal
/// bytes, for any number of threads.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  strokefit fit photo.jpg -o photo.svg
  strokefit fit photo.jpg -o photo.svg --preset best --strokes 5000 --report photo.json
  strokefit fit logo.png -o logo.svg --opaque --background none --bytes 20000
  strokefit fit *.jpg -o 'out/{stem}.svg' --psnr 30        one SVG for each picture
  strokefit fit --psnr 32 --opaque --print-config > fit.toml
  strokefit fit photo.jpg -o photo.svg --config fit.toml --seed 7
  strokefit fit photo.jpg -o photo.svg --view                watch it grow
  strokefit fit photo.jpg -o photo.svg -o photo.gif --frames stage --legend
  curl -s https://example.org/a.png | strokefit fit - -o - --psnr 30 > a.svg")]
pub(super) struct Args {
    /// Pictures: PNG, JPEG, WebP, GIF (first frame), BMP, TIFF and some more. - means standard input
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// SVG to write. - means standard output, {stem} the picture's name without folder and extension. Repeat
    /// -o for more files: .png for a render, .gif, .webp or .apng for an animation, .animated.svg for an
    /// SVG that draws itself; for single frames see Animation
    #[arg(short, long, value_name = "OUT.svg", required = true)]
    output: Vec<PathBuf>,
    /// Write a report as JSON. - means standard output; {stem} works as in --output
    #[arg(long, value_name = "R.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    options: Options,
}

pub(super) fn run(args: &Args, verbosity: Verbosity) -> Result<Status> {
    let options = &args.options;
    let jobs = batch::jobs(&args.inputs, &args.output, args.report.as_deref(), options)?;
    batch::run(&jobs, verbosity, &|picture, start, observer| {
        options.fit(0, observer, |fitter| fitter.since(start).fit(picture))
    })
}
