//! `strokefit check`: the fidelity of an SVG to a picture, in each installed program that draws SVG.

mod table;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use strokefit::engines::{self, DrawRequest, ENGINES, Engine, Rendering};
use strokefit::image::Image;
use strokefit::metrics::{self, Agreement, Quality};
use strokefit::report::{
    self, AgainstResvg, CheckReport, Input, NotDrawn, RendererEntry, SCHEMA, heat,
};
use strokefit::verify::{self, Size};
use strokefit::{fit, svg};

use super::output::Output;
use super::{Status, Verbosity, complain, input};

/// The judge, always asked.
const RESVG: &str = "resvg";

/// Colour of details that are lost on the map; no score has it.
const DETAIL: [f64; 3] = [0.86, 0.08, 0.08];

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
    if let Some(folder) = &args.pictures {
        fs::create_dir_all(folder).map_err(|e| {
            let path = folder.display();
            anyhow!("{path}: pictures cannot be written to this folder ({e}): name another one")
        })?;
    }
    let record = judge(args, map.as_ref())?;
    if let Some(output) = &report {
        output.write(report::json(&record)?.as_bytes())?;
    }
    if report != Some(Output::Stdout) && !verbosity.quiet {
        Output::Stdout.write(table::table(&record).as_bytes())?;
    }
    Ok(verdict(&record, args.renderer.is_some(), verbosity))
}

fn judge(args: &Args, map: Option<&Output>) -> Result<CheckReport> {
    let svg = input::svg(&args.file)?;
    let target = args.input.as_deref().map(input::picture).transpose()?;
    let trial = Trial::new(&svg, target.as_ref(), args.pictures.as_deref());
    let mut trial = trial.map_err(|error| input::blame(error, &args.file))?;
    for engine in args.engines() {
        trial.ask(engine, args.timeout)?;
    }
    if let (Some(target), Some(output)) = (&target, map) {
        output.write(&losses(target, &trial.resvg)?.encode_png()?)?;
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

/// A file drawn by one program after another.
struct Trial<'a> {
    svg: &'a str,
    target: Option<&'a Image>,
    /// Where pictures go, if they are wanted.
    folder: Option<&'a Path>,
    resvg: Image,
    /// resvg first.
    drawn: Vec<RendererEntry>,
    not_drawn: Vec<NotDrawn>,
}

impl<'a> Trial<'a> {
    /// Begins with resvg.
    fn new(svg: &'a str, target: Option<&'a Image>, folder: Option<&'a Path>) -> Result<Self> {
        let start = Instant::now();
        let image = match target {
            Some(target) => verify::render_like(svg, target, [1.0; 3])?,
            None => verify::render(svg, Size::Scale(1.0), Some([1.0; 3]))?,
        };
        let mut trial = Self {
            svg,
            target,
            folder,
            resvg: image.clone(),
            drawn: Vec::new(),
            not_drawn: Vec::new(),
        };
        let (version, wall) = (verify::RESVG_VERSION.into(), start.elapsed());
        trial.keep(
            RESVG,
            Rendering {
                image,
                version,
                wall,
            },
        )?;
        Ok(trial)
    }

    /// Draws with `engine`. A missing or failing program is a result, not an error.
    fn ask(&mut self, engine: &Engine, timeout: Duration) -> Result<()> {
        let (svg, [width, height]) = (self.svg, [self.resvg.width(), self.resvg.height()]);
        let request = DrawRequest { svg, width, height };
        let program = engine.locate();
        let installed = program.is_some();
        let drawn = program.map(|program| engine.draw(&program, request, timeout));
        let reason = match drawn {
            Some(Ok(drawn)) => return self.keep(engine.name, drawn),
            Some(Err(error)) => error.to_string(),
            None => format!("{}: not installed: {}", engine.name, engine.install),
        };
        self.not_drawn.push(NotDrawn {
            renderer: engine.name.into(),
            installed,
            reason,
        });
        Ok(())
    }

    /// Records a render, compared with the picture and, unless it is that, with resvg's render.
    fn keep(&mut self, name: &str, drawn: Rendering) -> Result<()> {
        let image = &drawn.image;
        let fidelity = self.target.map(|target| Quality::between(target, image));
        let fidelity = fidelity.transpose()?;
        let agreement = Agreement::between(&self.resvg, image)?;
        let resvg = self.drawn.first();
        let fidelities = resvg.and_then(|resvg| resvg.fidelity).zip(fidelity);
        let shortfall_db = fidelities.map(|(resvg, own)| resvg.psnr_db - own.psnr_db);
        self.drawn.push(RendererEntry {
            renderer: name.into(),
            fidelity,
            against_resvg: resvg.map(|_| against(&self.resvg, image, &agreement)),
            wall_s: drawn.wall.as_secs_f64(),
            passed: engines::passes(&agreement, shortfall_db),
            version: drawn.version,
        });
        let Some(folder) = self.folder else {
            return Ok(());
        };
        // What it is compared with lies beside it.
        let sheet = engines::compared(self.target, &self.resvg, image)?;
        for (end, picture) in [("", image), ("-compared", &sheet)] {
            let path = folder.join(format!("{name}{end}.png"));
            Output::open(&path)?.write(&picture.encode_png()?)?;
        }
        Ok(())
    }
}

/// The difference of a render from resvg's.
fn against(resvg: &Image, drawn: &Image, agreement: &Agreement) -> AgainstResvg {
    let max_abs = agreement.max_abs;
    let (left, right) = (resvg.to_rgb8(), drawn.to_rgb8());
    let mut differences = left.iter().zip(&right).map(|(a, b)| a.abs_diff(*b));
    let pixel = differences.position(|level| level == max_abs).unwrap_or(0) / 3;
    AgainstResvg {
        psnr_db: Some(agreement.psnr_db).filter(|db| db.is_finite()),
        max_abs,
        x: pixel % resvg.width(),
        y: pixel / resvg.width(),
    }
}

/// The map of the places where a render differs for the eye: its SSIMULACRA2 by colour, lost details in red.
fn losses(target: &Image, drawn: &Image) -> Result<Image> {
    let scores = metrics::ssimulacra2_map(target, drawn)?;
    let details = metrics::details_lost(target, drawn)?;
    let places: Vec<(f32, f32)> = scores.into_iter().zip(details).collect();
    let map = report::map(target.width(), &places, |(score, detail)| {
        // 0 for the score of equal pictures, 1 for a score of 0 or less.
        let score = heat(1.0 - f64::from(score) / 100.0);
        let share = f64::from(detail);
        std::array::from_fn(|k| score[k] + share * (DETAIL[k] - score[k]))
    })?;
    Ok(map)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_bright() {
        // Stripes are lost on the right half.
        let stripes = |is_drawn: bool| {
            let value = |i: usize| match i % 128 {
                64.. if !is_drawn && i % 4 < 2 => 0.8,
                _ => 0.5,
            };
            let plane: Vec<f32> = (0..128 * 64).map(value).collect();
            Image::new(128, 64, [plane.clone(), plane.clone(), plane]).unwrap()
        };
        let map = losses(&stripes(false), &stripes(true)).unwrap();
        let green = |x: usize| map.planes()[1][32 * 128 + x];
        let (left, right) = (green(8), green(120));
        assert!(right > left + 0.3, "{left} {right}");
    }

    #[test]
    fn a_detail_that_is_lost_is_red() {
        // One of two thin lines is lost.
        let lines = |columns: &[usize]| {
            let value = |x, _, _| if columns.contains(&x) { 0.2_f32 } else { 1.0 };
            Image::from_fn(128, 64, 1, value).unwrap()
        };
        let map = losses(&lines(&[32, 96]), &lines(&[32])).unwrap();
        let color = |x: usize| [0, 1, 2].map(|c| f64::from(map.planes()[c][32 * 128 + x]));
        let is_red = |x| {
            color(x)
                .iter()
                .zip(DETAIL)
                .all(|(a, b)| (a - b).abs() < 0.01)
        };
        assert_eq!([32, 96, 98].map(is_red), [false, true, false]);
    }
}
