//! `strokefit check`: how faithful an SVG is to a picture.

use std::path::PathBuf;

use anyhow::Result;
use clap::ValueEnum;
use strokefit::image::Image;
use strokefit::report::{CheckReport, Input, RendererEntry, SCHEMA};
use strokefit::verify;

use super::job::json;
use super::output::Output;
use super::{Status, input, misuse};

/// Measure how faithful an SVG is to a picture
///
/// The SVG is rendered at the picture's size on white, whoever made it, and compared over 8-bit
/// RGB: PSNR in dB (more is better), SSIM (1 is equal), MSE and L1 (0 is equal).
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  strokefit check photo.svg photo.jpg
  strokefit check photo.svg photo.jpg --report - | jq .renderers[0].fidelity.psnr_db")]
pub(super) struct Args {
    /// The SVG file; - for standard input
    file: PathBuf,
    /// The picture it should look like; - for standard input
    input: PathBuf,
    /// Who draws the SVG
    #[arg(long, value_enum, value_delimiter = ',', default_value = "resvg")]
    renderer: Vec<Renderer>,
    /// Write the result as JSON; - for standard output, instead of the table
    #[arg(long, value_name = "R.json")]
    report: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Renderer {
    Resvg,
}

impl Renderer {
    fn name(self) -> &'static str {
        match self {
            Self::Resvg => "resvg",
        }
    }

    fn measure(self, svg: &str, picture: &Image) -> Result<RendererEntry> {
        let fidelity = match self {
            Self::Resvg => verify::fidelity(svg, picture)?,
        };
        Ok(RendererEntry {
            renderer: self.name().into(),
            fidelity,
        })
    }
}

pub(super) fn run(args: &Args) -> Result<Status> {
    if input::is_stdin(&args.file) && input::is_stdin(&args.input) {
        return Err(misuse(
            "standard input cannot be both the SVG and the picture: name one of them",
        ));
    }
    let report = args.report.as_deref().map(Output::open).transpose()?;
    let svg = input::svg(&args.file)?;
    let picture = input::picture(&args.input)?;
    let record = measure(args, &svg, &picture)?;
    if let Some(output) = &report {
        output.write(&json(&record)?)?;
    }
    if report != Some(Output::Stdout) {
        Output::Stdout.write(table(&record).as_bytes())?;
    }
    Ok(Status::Done)
}

fn measure(args: &Args, svg: &str, picture: &Image) -> Result<CheckReport> {
    let named = |error: anyhow::Error| match error.downcast::<strokefit::Error>() {
        Ok(error) => error.within(input::name(&args.file)).into(),
        Err(error) => error,
    };
    let entries = args
        .renderer
        .iter()
        .map(|renderer| renderer.measure(svg, picture));
    Ok(CheckReport {
        schema: SCHEMA,
        input: Input::new(args.input.display().to_string(), picture),
        svg: args.file.display().to_string(),
        svg_bytes: svg.len(),
        renderers: entries.collect::<Result<_>>().map_err(named)?,
    })
}

fn table(record: &CheckReport) -> String {
    let mut table = String::from("renderer   PSNR dB     SSIM        MSE         L1\n");
    for RendererEntry { renderer, fidelity } in &record.renderers {
        table += &format!(
            "{renderer:<8} {:>9.2} {:>8.4} {:>10.7} {:>10.6}\n",
            fidelity.psnr_db, fidelity.ssim, fidelity.mse, fidelity.l1
        );
    }
    table
}
