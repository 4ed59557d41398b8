//! `strokefit render`: an SVG as resvg draws it, at once or stroke by stroke.

use std::path::PathBuf;

use anyhow::Result;
use strokefit::svg;

use super::pictures::{FilmOptions, Format, Pictures, Subject};
use super::{Status, domain, input, misuse};

/// Render an SVG to a PNG or an animation, as resvg draws it
///
/// Any SVG will do. Files and addresses that it refers to are not read. No fonts are loaded, so text
/// is drawn only if it was converted to paths. Without a background, the PNG is transparent.
///
/// A file that strokefit wrote can be drawn stroke by stroke: an output named .gif, .webp or .apng is
/// an animation, and an output named .animated.svg draws itself. For single frames see Animation.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  strokefit render photo.svg -o photo.png
  strokefit render photo.svg -o thumbnail.png --scale 0.25
  strokefit render photo.svg -o photo.gif --frames stage --legend")]
pub(super) struct Args {
    /// SVG file. - means standard input
    file: PathBuf,
    /// PNG or animation to write. - means standard output. Repeat -o for more files
    #[arg(short, long, value_name = "OUT.png", required = true)]
    output: Vec<PathBuf>,
    /// Pixels per unit of the SVG
    #[arg(long, value_name = "X", default_value = "1", value_parser = domain::scale, allow_negative_numbers = true)]
    scale: f64,
    #[command(flatten)]
    film: FilmOptions,
}

pub(super) fn run(args: &Args) -> Result<Status> {
    let text = input::svg(&args.file)?;
    let pictures = Pictures::open(&args.output, &args.film)?;
    if !input::is_stdin(&args.file) && pictures.all().any(|(_, output)| output.is(&args.file)) {
        return Err(misuse(format!(
            "{}: would be overwritten: name another output",
            args.file.display()
        )));
    }
    let is_svg = |path: &&PathBuf| Format::of(path) == Some(Format::Svg);
    if let Some(path) = args.output.iter().find(is_svg) {
        return Err(misuse(format!(
            "{}: render writes pictures and animations, not SVG: name another output",
            path.display()
        )));
    }
    write(&pictures, &text, args.scale).map_err(|error| {
        // The file is to blame for errors of the library.
        match error.downcast::<strokefit::Error>() {
            Ok(error) => error.within(input::name(&args.file)).into(),
            Err(error) => error,
        }
    })?;
    Ok(Status::Done)
}

fn write(pictures: &Pictures<'_>, text: &str, scale: f64) -> Result<()> {
    let scene = pictures
        .needs_marks()
        .then(|| svg::read(text))
        .transpose()?;
    pictures.write(&Subject {
        scene: scene.as_ref(),
        text,
        target: None,
        scale,
    })
}
