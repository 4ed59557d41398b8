//! `strokefit fit`: a picture in, a verified SVG out.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Result;
use clap::ValueEnum;
use strokefit::coverage::CoverageSchedule;
use strokefit::fit::{self, Background, Budget, Config, Execution, Fit, Simd};
use strokefit::image::Image;
use strokefit::metrics::Quality;
use strokefit::report::{self, FitReport, Input, StageEntry, Usage};
use strokefit::svg::{self, WriteOptions};
use strokefit::verify::{self, MIN_AGREEMENT_DB, Verdict};

use super::output::Output;
use super::progress::Bar;
use super::{Status, Verbosity, complain, domain, input, misuse};

const BUDGET: &str = "Budget (the first one reached stops)";
const LOOK: &str = "Look";
const HOW: &str = "Execution (never changes the result)";

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

    /// At most N strokes
    #[arg(long, value_name = "N", help_heading = BUDGET, value_parser = domain::strokes, allow_negative_numbers = true)]
    strokes: Option<usize>,
    /// Until the file is this faithful, in dB of PSNR; 25 is rough, 30 fair, 35 good
    #[arg(long, value_name = "DB", help_heading = BUDGET, value_parser = domain::psnr, allow_negative_numbers = true)]
    psnr: Option<f64>,
    /// At most N bytes of SVG
    #[arg(long, value_name = "N", help_heading = BUDGET, value_parser = domain::bytes, allow_negative_numbers = true)]
    bytes: Option<usize>,
    /// At most this long
    #[arg(long, value_name = "SECONDS", help_heading = BUDGET, value_parser = domain::seconds, allow_negative_numbers = true)]
    time: Option<Duration>,

    /// What a byte is worth, 0 to 60: a stroke stays while each of its bytes removes as much error as
    /// one pixel has at Q dB [default: 30 without a budget of strokes, dB or bytes]
    #[arg(long, value_name = "Q", help_heading = LOOK, allow_negative_numbers = true)]
    quality: Option<f64>,
    /// How much work to spend
    #[arg(long, value_enum, default_value_t = Preset::Balanced, help_heading = LOOK)]
    preset: Preset,
    /// Polish each layer on those below alone: a good drawing after every layer, some dB less in the end
    #[arg(long, conflicts_with = "no_polish", help_heading = LOOK)]
    progressive: bool,
    /// Only opaque strokes: fewer dB, but flat colours that are easy to edit
    #[arg(long, help_heading = LOOK)]
    opaque: bool,
    /// Soft edge while fitting: smoothstep, sigmoid, tanh or atan[:K]; A>B passes from one to another
    #[arg(long, value_name = "EDGE", default_value = "smoothstep", help_heading = LOOK)]
    coverage: CoverageSchedule,
    /// Add the strokes in N stages, each a layer of the SVG [default: from the budget]
    #[arg(long, value_name = "N", help_heading = LOOK, value_parser = domain::stages, allow_negative_numbers = true)]
    stages: Option<usize>,
    /// Leave out the joint fit of all strokes after the stages: faster, some dB less
    #[arg(long, help_heading = LOOK)]
    no_polish: bool,
    /// Decimals of coordinates and widths, 0 to 6
    #[arg(long, value_name = "N", default_value = "2", help_heading = LOOK, value_parser = domain::precision, allow_negative_numbers = true)]
    precision: u8,
    /// Colour behind the strokes: auto, none or #rrggbb; transparency is laid on it, or on white
    #[arg(long, value_name = "COLOR", default_value = "auto", help_heading = LOOK, value_parser = domain::background)]
    background: Background,
    /// Key of every random draw: another seed, another drawing
    #[arg(long, value_name = "S", default_value_t = 0, help_heading = LOOK)]
    seed: u64,

    /// Worker threads [default: all cores]
    #[arg(long, value_name = "N", help_heading = HOW, value_parser = domain::threads, allow_negative_numbers = true)]
    threads: Option<usize>,
    /// Instruction set: auto, avx512, avx2, sse4.2, sse2, neon or scalar
    #[arg(long, value_name = "LEVEL", default_value = "auto", help_heading = HOW)]
    simd: Simd,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Preset {
    /// Quick look
    Draft,
    /// The default
    Balanced,
    /// The last tenths of a dB
    Best,
}

impl Args {
    fn config(&self) -> Config {
        Config {
            budget: Budget {
                strokes: self.strokes,
                psnr_db: self.psnr,
                bytes: self.bytes,
                time: self.time,
            },
            preset: match self.preset {
                Preset::Draft => fit::Preset::Draft,
                Preset::Balanced => fit::Preset::Balanced,
                Preset::Best => fit::Preset::Best,
            },
            quality: self.quality,
            progressive: self.progressive,
            opaque: self.opaque,
            coverage: self.coverage,
            stages: self.stages,
            polish: !self.no_polish,
            precision: self.precision,
            background: self.background,
            seed: self.seed,
            ..Config::default()
        }
    }
}

/// Where the results go, known to be writable.
struct Outputs {
    svg: Output,
    report: Option<Output>,
}

impl Outputs {
    fn open(args: &Args) -> Result<Self> {
        let svg = Output::open(&args.output)?;
        let report = args.report.as_deref().map(Output::open).transpose()?;
        if report.as_ref() == Some(&svg) {
            return Err(misuse(format!(
                "{}: SVG and report cannot go to the same place: name another",
                args.output.display()
            )));
        }
        let outputs = Self { svg, report };
        if !input::is_stdin(&args.input) && outputs.all().any(|output| output.is(&args.input)) {
            return Err(misuse(format!(
                "{}: would be overwritten: name another output",
                args.input.display()
            )));
        }
        Ok(outputs)
    }

    fn all(&self) -> impl Iterator<Item = &Output> {
        [&self.svg].into_iter().chain(&self.report)
    }
}

/// A drawing with its text and the judgement of it.
struct Drawn {
    fit: Fit,
    text: String,
    soft: Quality,
    verdict: Verdict,
}

pub(super) fn run(args: &Args, verbosity: Verbosity) -> Result<Status> {
    let start = Instant::now();
    let picture = input::picture(&args.input)?;
    let outputs = Outputs::open(args)?;
    let drawn = draw(args, &picture, verbosity)?;
    outputs.svg.write(drawn.text.as_bytes())?;
    let wall = start.elapsed();
    if let Some(output) = &outputs.report {
        output.write(&json(&report(args, &drawn, wall))?)?;
    }
    verbosity.say(summary(args, &drawn, wall));
    Ok(judge(args, &drawn))
}

fn draw(args: &Args, picture: &Image, verbosity: Verbosity) -> Result<Drawn> {
    let mut bar = Bar::new(verbosity.quiet);
    let execution = Execution {
        threads: args.threads,
        simd: args.simd,
    };
    let fit = fit::fit(picture, &args.config(), &execution, &mut bar);
    bar.clear();
    let fit = fit?;
    for stage in &fit.stages {
        verbosity.detail(format_args!(
            "stage {}: {} strokes, {} iterations, {:.2} s, {:.2} dB",
            stage.index,
            stage.strokes,
            stage.iterations,
            stage.wall.as_secs_f64(),
            stage.psnr_db
        ));
    }
    let text = svg::write(
        &fit.scene,
        &WriteOptions {
            precision: args.precision,
        },
    );
    let soft = Quality::between(&fit.target, &fit.soft)?;
    let verdict = verify::verify(&text, &fit.target, &fit.soft)?;
    Ok(Drawn {
        fit,
        text,
        soft,
        verdict,
    })
}

fn report(args: &Args, drawn: &Drawn, wall: Duration) -> FitReport {
    let Usage {
        cpu_s,
        peak_rss_bytes,
    } = Usage::now();
    FitReport {
        schema: report::SCHEMA,
        input: Input::new(args.input.display().to_string(), &drawn.fit.target),
        strokes: drawn.fit.scene.len(),
        dropped: drawn.fit.dropped,
        stages: drawn.fit.stages.iter().map(StageEntry::from).collect(),
        svg_bytes: drawn.text.len(),
        wall_s: wall.as_secs_f64(),
        cpu_s,
        peak_rss_bytes,
        stop: report::stop_word(drawn.fit.stop).into(),
        seed: args.seed,
        fidelity: drawn.verdict.fidelity,
        soft: drawn.soft,
        agreement: drawn.verdict.agreement,
    }
}

/// A record as indented JSON.
pub(super) fn json(record: &impl serde::Serialize) -> Result<Vec<u8>> {
    let mut bytes = serde_json::to_vec_pretty(record)?;
    bytes.push(b'\n');
    Ok(bytes)
}

fn summary(args: &Args, drawn: &Drawn, wall: Duration) -> String {
    format!(
        "{}: {} strokes, {} bytes, {:.2} s, fidelity {:.2} dB, agreement {:.2} dB",
        output_name(&args.output),
        drawn.fit.scene.len(),
        drawn.text.len(),
        wall.as_secs_f64(),
        drawn.verdict.fidelity.psnr_db,
        drawn.verdict.agreement.psnr_db,
    )
}

fn output_name(path: &Path) -> String {
    if path == Path::new("-") {
        "standard output".into()
    } else {
        path.display().to_string()
    }
}

/// The status of a drawing that was written. What is short of the promise is said even when quiet.
fn judge(args: &Args, drawn: &Drawn) -> Status {
    if !drawn.verdict.agrees() {
        complain(format_args!(
            "fidelity check failed: resvg draws the file {:.2} dB from what was fitted, the bound is {MIN_AGREEMENT_DB} dB: \
             the file was kept; try --opaque or a higher --precision",
            drawn.verdict.agreement.psnr_db
        ));
        return Status::Disagrees;
    }
    let reached = drawn.verdict.fidelity.psnr_db;
    if let Some(wanted) = args.psnr.filter(|wanted| reached < *wanted) {
        let stop = report::stop_word(drawn.fit.stop);
        complain(format_args!(
            "target not reached: {reached:.2} dB of {wanted} (stopped by: {stop}): allow more strokes, bytes or time"
        ));
        return Status::TargetMissed;
    }
    if let Some(most) = args.bytes.filter(|most| drawn.text.len() > *most) {
        complain(format_args!(
            "target not reached: {} bytes, more than {most}: allow more",
            drawn.text.len()
        ));
        return Status::TargetMissed;
    }
    Status::Done
}
