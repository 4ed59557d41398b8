//! `strokefit check`: the fidelity of an SVG to a picture, in each installed program that draws SVG.

mod map;
mod table;
mod trial;

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Result;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use strokefit::engines::{ENGINES, Engine};
use strokefit::fit;
use strokefit::report::{self, CheckReport, Input, SCHEMA};
use strokefit::{svg, verify};

use super::output::Output;
use super::{Status, Verbosity, complain, input};
use trial::{PictureFolder, Trial};

/// The judge, always asked.
const RESVG: &str = "resvg";

/// Compare renders of an SVG by several programs with a picture and with each other
///
/// resvg is built in. Inkscape, rsvg-convert, Chromium and CairoSVG are used if they are installed.
/// Each renders the file, whoever made it, at the picture's size on white. The render is compared over
/// 8-bit RGB with the picture and with resvg's render: PSNR in dB (more is better), SSIM (1 is
/// equal), SSIMULACRA2 (what people see: 90 is lossless to the eye, 70 high, 50 medium, 30 low quality), the share
/// of details kept (letters, dots, thin lines, if the picture has some), and the largest difference from resvg (0 to 255)
/// with its place. A picture with alpha is also compared on black and on
/// magenta. The text of the file is searched for constructs that programs draw differently.
///
/// Without a picture, the programs are compared with resvg only. With --quiet only the exit status and errors tell.
///
/// Exit status 4: a render differs from resvg's (less than 36 dB) and, if there is a picture, is
/// more than 0.6 dB less faithful to it than resvg's. Exit status 1: an installed program could not draw
/// the file, or a program named with --renderer is not installed.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  strokefit check photo.svg photo.jpg
  strokefit check photo.svg photo.jpg --renderer resvg,chromium --pictures compared/
  strokefit check photo.svg photo.jpg --map lost.png
  strokefit check foreign.svg
  strokefit check photo.svg photo.jpg --report - | jq .renderers[0].fidelity.psnr_db")]
pub(super) struct Args {
    /// SVG file. - means standard input
    file: PathBuf,
    /// Picture that the SVG should look like. - means standard input
    input: Option<PathBuf>,
    /// Programs to use besides resvg [default: all that are installed]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', value_parser = renderer())]
    renderer: Option<Vec<Renderer>>,
    /// Write each render to DIR as NAME.png, with NAME-compared.png beside it: the picture, the render, its
    /// difference from the picture (× 4) and from resvg's render (× 16)
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// Write a picture of where resvg's render loses SSIMULACRA2: dark where all is well, yellow where it would be 0, and
    /// red where a detail is lost
    #[arg(long, value_name = "OUT.png", requires = "input")]
    map: Option<PathBuf>,
    /// Time limit for each program
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = fit::seconds)]
    timeout: Duration,
    /// Write the result as JSON. - means standard output, instead of the table
    #[arg(long, value_name = "R.json")]
    report: Option<PathBuf>,
}

/// A program that draws SVG; `None` is resvg.
type Renderer = Option<&'static Engine>;

fn renderer() -> impl TypedValueParser<Value = Renderer> {
    let names = std::iter::once(RESVG).chain(ENGINES.iter().map(|engine| engine.name));
    PossibleValuesParser::new(names).map(|name| ENGINES.iter().find(|engine| engine.name == name))
}

impl Args {
    /// The programs besides resvg, each once, in the order asked for.
    fn engines(&self) -> Vec<&'static Engine> {
        let Some(asked) = &self.renderer else {
            return ENGINES.iter().collect();
        };
        let mut engines: Vec<&'static Engine> = Vec::new();
        for engine in asked.iter().flatten() {
            if engines.iter().all(|known| known.name != engine.name) {
                engines.push(engine);
            }
        }
        engines
    }
}

pub(super) fn run(args: &Args, verbosity: Verbosity) -> Result<Status> {
    let files: Vec<&Path> = [args.file.as_path()]
        .into_iter()
        .chain(args.input.as_deref())
        .collect();
    input::expect_one_stdin(&files, "the SVG and the picture")?;
    let report = args.report.as_deref().map(Output::open).transpose()?;
    let map = args.map.as_deref().map(Output::open).transpose()?;
    let pictures = args
        .pictures
        .as_deref()
        .map(PictureFolder::open)
        .transpose()?;
    let record = judge(args, pictures, map.as_ref())?;
    if let Some(output) = &report {
        output.write(report::json(&record)?.as_bytes())?;
    }
    if report != Some(Output::Stdout) && !verbosity.quiet {
        Output::Stdout.write(table::table(&record).as_bytes())?;
    }
    Ok(verdict(&record, args.renderer.is_some(), verbosity))
}

fn judge(
    args: &Args,
    pictures: Option<PictureFolder>,
    map: Option<&Output>,
) -> Result<CheckReport> {
    let svg = input::svg(&args.file)?;
    let target = args.input.as_deref().map(input::picture).transpose()?;
    let trial = Trial::new(&svg, target.as_ref(), args.timeout, pictures);
    let mut trial = trial.map_err(|error| input::blame(error, &args.file))?;
    for engine in args.engines() {
        trial.ask(engine)?;
    }
    if let (Some(target), Some(output)) = (&target, map) {
        output.write(&map::png(target, &trial.resvg)?)?;
    }
    let transparent = target.as_ref().filter(|target| target.alpha().is_some());
    let alpha = transparent.map(|target| verify::on_mattes(&svg, target));
    let named_input = args.input.as_ref().zip(target.as_ref());
    Ok(CheckReport {
        schema: SCHEMA,
        input: named_input.map(|(path, image)| Input::new(path.display().to_string(), image)),
        svg: args.file.display().to_string(),
        svg_bytes: svg.len(),
        alpha: alpha.transpose()?,
        renderers: trial.drawn,
        not_drawn: trial.not_drawn,
        lint: svg::lint(&svg),
    })
}

/// Says who did not draw the file, or drew something else, and what that makes of the whole.
fn verdict(record: &CheckReport, asked_by_name: bool, verbosity: Verbosity) -> Status {
    for absent in &record.not_drawn {
        if absent.installed || asked_by_name {
            complain(&absent.reason);
        } else {
            verbosity.say(&absent.reason);
        }
    }
    let differs = || record.renderers.iter().filter(|entry| !entry.passed);
    for entry in differs() {
        complain(table::shortfall(entry));
    }
    let missed = record
        .not_drawn
        .iter()
        .any(|absent| absent.installed || asked_by_name);
    match (differs().next(), missed) {
        (Some(_), _) => Status::Disagrees,
        (None, true) => Status::Failed,
        (None, false) => Status::Done,
    }
}
