//! `strokefit fit`: pictures in, verified SVGs out.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::batch;
use super::hint::Hint;
use super::job::Job;
use super::options::Options;
use super::pictures::Format;
use super::{Status, Verbosity, input, misuse};

/// Turn pictures into SVGs made of strokes
///
/// The SVG has one layer per stage, from large strokes to small. Equal pictures and options give equal
/// bytes, for any number of threads.
#[derive(Debug, clap::Args)]
#[command(
    override_usage = "strokefit fit [OPTIONS] <INPUT>... --output <OUT.svg>",
    after_help = "Examples:
  strokefit fit photo.jpg -o photo.svg
  strokefit fit photo.jpg -o photo.svg --preset best --strokes 5000 --report photo.json
  strokefit fit logo.png -o logo.svg --opaque --background none --bytes 20000
  strokefit fit *.jpg -o 'out/{stem}.svg' --psnr 30        one SVG for each picture
  strokefit fit --psnr 32 --opaque --print-config > fit.toml
  strokefit fit photo.jpg -o photo.svg --config fit.toml --seed 7
  strokefit fit photo.jpg -o photo.svg --view                watch it grow
  strokefit fit photo.jpg -o photo.svg -o photo.gif --frames stage --legend
  curl -s https://example.org/a.png | strokefit fit - -o - --psnr 30 > a.svg"
)]
pub(super) struct Args {
    /// Pictures: PNG, JPEG, WebP, GIF (first frame), BMP, TIFF and some more. - means standard input
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// SVG to write, or PDF or DXF. - means standard output, {stem} the picture's name without folder and extension. Repeat
    /// -o for more files: .png for a render, .gif, .webp or .apng for an animation, .animated.svg for an
    /// SVG that draws itself; for single frames see Animation. Without -o, an SVG that comes last among the inputs is the output
    #[arg(short, long, value_name = "OUT.svg")]
    output: Vec<PathBuf>,
    /// Write a report as JSON. - means standard output; {stem} works as in --output
    #[arg(long, value_name = "R.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    options: Options,
}

pub(super) fn run<'a>(args: &'a Args, verbosity: Verbosity) -> Result<Status> {
    let options = &args.options;
    let (inputs, outputs) = places(&args.inputs, &args.output)?;
    let job = |input: &'a PathBuf| {
        let named = |template: &PathBuf| batch::named(template, input);
        let outputs: Vec<PathBuf> = outputs.iter().map(named).collect::<Result<_>>()?;
        let report = args.report.as_ref().map(named).transpose()?;
        Job::open(None, input, &outputs, report.as_deref(), options)
    };
    let jobs: Vec<Job<'_>> = inputs.iter().map(job).collect::<Result<_>>()?;
    batch::run(&jobs, verbosity, &|picture, start, observer| {
        options.fit(0, observer, |fitter| fitter.since(start).fit(picture))
    })
}

/// The pictures, and the files to write. Where no output is named, an SVG that comes last is meant as one.
fn places<'a>(
    inputs: &'a [PathBuf],
    outputs: &'a [PathBuf],
) -> Result<(&'a [PathBuf], &'a [PathBuf])> {
    if !outputs.is_empty() {
        return Ok((inputs, outputs));
    }
    match inputs {
        [pictures @ .., last] if !pictures.is_empty() && Format::of(last) == Some(Format::Svg) => {
            Ok((pictures, std::slice::from_ref(last)))
        }
        [picture] if !input::is_stdin(picture) => {
            let output = picture.with_extension("svg");
            Err(unnamed(&output))
        }
        [_] => Err(unnamed(Path::new("out.svg"))),
        _ => Err(unnamed(Path::new("'{stem}.svg'"))),
    }
}

fn unnamed(output: &Path) -> anyhow::Error {
    let advice = format!("add -o {}", output.display());
    Hint::on(
        misuse("no output is named: give one with -o or --output"),
        advice,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places_of(inputs: &[&str], outputs: &[&str]) -> Result<(usize, String), String> {
        let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
        let (inputs, outputs) = (paths(inputs), paths(outputs));
        match places(&inputs, &outputs) {
            Ok((inputs, outputs)) => Ok((inputs.len(), outputs[0].display().to_string())),
            Err(error) => Err(Hint::split(&error)
                .1
                .map_or_else(String::new, ToString::to_string)),
        }
    }

    #[test]
    fn an_svg_after_a_picture_is_the_output() {
        assert_eq!(places_of(&["a.png", "b.svg"], &[]), Ok((1, "b.svg".into())));
        assert_eq!(
            places_of(&["a.png", "b.png", "out/{stem}.svg"], &[]),
            Ok((2, "out/{stem}.svg".into()))
        );
        assert_eq!(
            places_of(&["a.png", "b.svg"], &["c.svg"]),
            Ok((2, "c.svg".into()))
        );
    }

    #[test]
    fn where_no_output_is_named_the_advice_names_one() {
        assert_eq!(places_of(&["d/a.png"], &[]), Err("add -o d/a.svg".into()));
        assert_eq!(places_of(&["-"], &[]), Err("add -o out.svg".into()));
        assert_eq!(
            places_of(&["a.png", "b.png"], &[]),
            Err("add -o '{stem}.svg'".into())
        );
        assert_eq!(places_of(&["a.svg"], &[]), Err("add -o a.svg".into()));
    }
}
