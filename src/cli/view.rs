//! `strokefit view` shows a drawing in a browser; `--view` shows a fit.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Result;
use strokefit::fit::{Background, Base, Budget, Config, Fit, Fitter, Observer};
use strokefit::image::Image;
use strokefit::svg;
use strokefit::verify::{self, Size};
use strokefit::view::Viewer;

use super::hint::Hint;
use super::interrupt::GRACE;
use super::job::Draw;
use super::options::Options;
use super::{Status, complain, input};

/// Look at a drawing, stroke by stroke, in a browser
///
/// The command prints the address of a page, which it serves on this machine only. The program ends with
/// the button Done, with Ctrl-C, or when no page has been open for two minutes.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  strokefit view photo.svg photo.jpg
  strokefit view photo.svg")]
pub(super) struct Args {
    /// SVG file that strokefit wrote. - means standard input
    file: PathBuf,
    /// Picture that the SVG should look like. - means standard input
    input: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> Result<Status> {
    let files: Vec<&Path> = [args.file.as_path()]
        .into_iter()
        .chain(args.input.as_deref())
        .collect();
    input::expect_one_stdin(&files, "the SVG and the picture")?;
    let text = input::svg(&args.file)?;
    let name = input::name(&args.file);
    let scene = svg::read(&text).map_err(|error| unread(error, &text, &name))?;
    let picture = args.input.as_deref().map(input::picture).transpose()?;
    if let Some(picture) = &picture {
        // Refuses a picture of another shape.
        verify::fidelity(&text, picture).map_err(|e| e.within(&name))?;
    }
    let viewer = Viewer::open()?;
    viewer.begin(&name, picture.as_ref())?;
    viewer.show(&scene, &text);
    // Whoever reads the address finds the drawing there.
    tell(&viewer);
    viewer.wait();
    Ok(Status::Done)
}

/// Why a file cannot be looked at: another program's is no damaged one of strokefit's.
fn unread(error: strokefit::Error, text: &str, name: &str) -> anyhow::Error {
    if verify::render(text, Size::Scale(1.0), None).is_err() {
        return error.within(name).into();
    }
    let message = format!(
        "{name}: is no drawing by strokefit ({error}): strokes alone can be looked at one by one"
    );
    Hint::on(
        anyhow::anyhow!(message),
        "strokefit check FILE.svg PICTURE compares any SVG, and strokefit refine lays strokes on it",
    )
}

fn tell(viewer: &Viewer) {
    complain(format_args!("see {}", viewer.address()));
}

/// A page for fits, whose address is told.
pub(super) fn open() -> Result<Viewer> {
    let viewer = Viewer::open()?;
    tell(&viewer);
    Ok(viewer)
}

/// Draws `picture`, telling the page and `observer`.
pub(super) fn watched(
    viewer: &Viewer,
    picture: &Image,
    start: Instant,
    observer: &mut (dyn Observer + Send),
    draw: &Draw<'_>,
) -> Result<Fit> {
    let title = format!("{}×{} px", picture.width(), picture.height());
    viewer.begin(&title, Some(picture))?;
    let fit = draw(picture, start, &mut viewer.watch(observer))?;
    viewer.show(&fit.scene, &fit.svg());
    Ok(fit)
}

/// Function that adds `strokes` to the drawing of `fit`, and fits all of them jointly.
pub(super) fn more(
    options: &Options,
    fit: &Fit,
    strokes: usize,
) -> impl Fn(&Image, Instant, &mut (dyn Observer + Send)) -> Result<Fit> + use<> {
    let config = Config {
        budget: Budget {
            strokes: Some(fit.scene.len() + strokes),
            time: options.config().budget.time,
            ..Budget::default()
        },
        // That of the drawing stays.
        background: Background::Auto,
        ..options.config()
    };
    let base = Base {
        document: fit.base.as_ref().and_then(|base| base.document.clone()),
        scene: fit.scene.clone(),
        width: fit.base.as_ref().and_then(|base| base.width),
    };
    let execution = options.execution;
    move |picture, start, observer| {
        let fitter = Fitter::new(config.clone())
            .execution(execution)
            .grace(GRACE)
            .since(start);
        Ok(fitter.on(base.clone()).observer(observer).fit(picture)?)
    }
}
