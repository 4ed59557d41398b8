//! `strokefit render`: an SVG as resvg draws it.

use std::path::PathBuf;

use anyhow::Result;
use strokefit::verify::{self, Size};

use super::output::Output;
use super::{Status, domain, input, misuse};

/// Render an SVG to a PNG, as resvg draws it
///
/// Any SVG will do. Files and addresses it refers to are not read, and no fonts are loaded, so
/// text that is not outlines is not drawn. Where the SVG has no background, the PNG is transparent.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  strokefit render photo.svg -o photo.png
  strokefit render photo.svg -o thumbnail.png --scale 0.25")]
pub(super) struct Args {
    /// The SVG file; - for standard input
    file: PathBuf,
    /// The PNG to write; - for standard output
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,
    /// Pixels per unit of the SVG
    #[arg(long, value_name = "X", default_value = "1", value_parser = domain::scale, allow_negative_numbers = true)]
    scale: f64,
}

pub(super) fn run(args: &Args) -> Result<Status> {
    let svg = input::svg(&args.file)?;
    let output = Output::open(&args.output)?;
    if !input::is_stdin(&args.file) && output.is(&args.file) {
        return Err(misuse(format!(
            "{}: would be overwritten: name another output",
            args.file.display()
        )));
    }
    let picture = verify::render(&svg, Size::Scale(args.scale), None)
        .map_err(|e| e.within(input::name(&args.file)))?;
    output.write(&picture.encode_png()?)?;
    Ok(Status::Done)
}
