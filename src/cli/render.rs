//! `strokefit render`: an SVG as resvg draws it, at once or stroke by stroke.

use std::borrow::Cow;
use std::path::PathBuf;

use anyhow::Result;
use strokefit::svg::{self, Form, WriteOptions};

use super::pictures::{FilmOptions, Format, Made, Pictures, Subject};
use super::{Status, input, misuse};

/// Render an SVG to a PNG or an animation, as resvg draws it, or convert it to PDF or DXF
///
/// Any SVG will do for a PNG. Files and addresses that it refers to are not read. No fonts are loaded, so text
/// is drawn only if it was converted to paths. Without a background, the PNG is transparent.
///
/// A file that strokefit wrote can be drawn stroke by stroke: an output named .gif, .webp or .apng is
/// an animation, and an output named .animated.svg draws itself. For single frames see Animation. It
/// can also be a PDF, for print, or a DXF, for cutters and CAD.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  strokefit render photo.svg -o photo.png
  strokefit render photo.svg -o thumbnail.png --scale 0.25
  strokefit render logo.svg -o logo.pdf -o logo.dxf
  strokefit render photo.svg -o photo.gif --frames stage --legend")]
pub(super) struct Args {
    /// SVG file. - means standard input
    file: PathBuf,
    /// PNG, PDF, DXF or animation to write. - means standard output. Repeat -o for more files
    #[arg(short, long, value_name = "OUT.png", required = true)]
    output: Vec<PathBuf>,
    /// Pixels per unit of the SVG
    #[arg(long, value_name = "X", default_value = "1", value_parser = scale)]
    scale: f64,
    #[command(
        flatten,
        next_help_heading = "Machines (for a file that strokefit wrote; the output may be an SVG)"
    )]
    made: Made,
    #[command(flatten)]
    film: FilmOptions,
}

fn scale(text: &str) -> Result<f64, &'static str> {
    let factor = text.parse().ok();
    let factor = factor.filter(|factor: &f64| factor.is_finite() && *factor > 0.0);
    factor.ok_or("give a factor above 0, such as 2 or 0.5")
}

pub(super) fn run(args: &Args) -> Result<Status> {
    let text = input::svg(&args.file)?;
    let pictures = Pictures::open(&args.output, args.film)?;
    if !input::is_stdin(&args.file) && pictures.all().any(|(_, output)| output.is(&args.file)) {
        return Err(misuse(format!(
            "{}: would be overwritten: name another output",
            args.file.display()
        )));
    }
    let is_svg = |path: &&PathBuf| Format::of(path) == Some(Format::Svg);
    let svg = args.output.iter().find(is_svg);
    let is_made = args.made.outline || args.made.is_for_machines();
    if let Some(path) = svg.filter(|_| !is_made) {
        return Err(misuse(format!(
            "{}: render writes an SVG only with --cutout, --hatch or --outline: name another output",
            path.display()
        )));
    }
    write(&pictures, &text, args, is_made).map_err(|error| input::blame(error, &args.file))?;
    Ok(Status::Done)
}

fn write(pictures: &Pictures, text: &str, args: &Args, is_made: bool) -> Result<()> {
    let mut subject = if is_made {
        let file = WriteOptions {
            form: match args.made.outline {
                true => Form::Outlines,
                false => Form::Plain,
            },
            width: svg::page_width(text),
            ..WriteOptions::default()
        };
        args.made.subject(&svg::read(text)?, &file, None)?
    } else {
        let scene = pictures.needs_marks().then(|| svg::read(text));
        Subject::new(scene.transpose()?.map(Cow::Owned), text.into())
    };
    subject.scale = args.scale;
    pictures.write(&subject)
}
