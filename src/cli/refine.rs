//! `strokefit refine`: adds strokes to an SVG, to make it more like a picture.

use std::path::PathBuf;

use anyhow::Result;
use strokefit::fit::{Background, Base};
use strokefit::image::Image;

use super::job::Job;
use super::options::Options;
use super::{Status, Verbosity, batch, input, misuse};

/// Add strokes to an SVG to bring it closer to a picture
///
/// BASE is the SVG to go on from. If strokefit drew it, its strokes are fitted further, together with new
/// strokes in new layers. Any other SVG stays byte for byte as it is; the new layers go before the end
/// of its root element, and a later refine fits them further. With --freeze-base all strokes of BASE stay
/// as they are, and so do those drawn from a picture of another size.
///
/// Budgets count the whole file: --strokes N counts old and new strokes, --strokes +N new ones alone, --psnr and --bytes apply to the
/// written file, and --stages counts the stages that BASE already has. If BASE already meets a budget, it is
/// written unchanged. The background is that of BASE.
#[derive(Debug, clap::Args)]
#[command(
    mut_arg("background", |background| background.hide(true)),
    after_help = "Examples:
  strokefit refine photo.svg photo.jpg -o better.svg --strokes 2000     2,000 in all
  strokefit refine photo.svg photo.jpg -o better.svg --strokes +500     500 more
  strokefit refine traced.svg photo.png -o finished.svg --strokes 200
  strokefit refine photo.svg photo.jpg -o more.svg --freeze-base --psnr 34"
)]
pub(super) struct Args {
    /// SVG to go on from. - means standard input
    base: PathBuf,
    /// Picture: PNG, JPEG, WebP, GIF (first frame), BMP, TIFF and some more. - means standard input
    input: PathBuf,
    /// SVG to write, or PDF or DXF. - means standard output. Repeat -o for more files: .png for a render, .gif, .webp or
    /// .apng for an animation, .animated.svg for an SVG that draws itself; for single frames see Animation
    #[arg(short, long, value_name = "OUT.svg", required = true)]
    output: Vec<PathBuf>,
    /// Write a report as JSON. - means standard output
    #[arg(long, value_name = "R.json")]
    report: Option<PathBuf>,
    /// Keep the strokes of BASE as they are, and add new layers on top
    #[arg(long)]
    freeze_base: bool,
    #[command(flatten)]
    options: Options,
}

pub(super) fn run(args: &Args, verbosity: Verbosity) -> Result<Status> {
    input::expect_one_stdin(&[&args.base, &args.input], "the SVG and the picture")?;
    if args.options.config().background != Background::Auto {
        return Err(misuse(
            "--background cannot be chosen when refining: the drawing keeps that of the SVG",
        ));
    }
    let report = args.report.as_deref();
    let job = Job::open(
        Some(&args.base),
        &args.input,
        &args.output,
        report,
        &args.options,
    )?;
    let text = input::svg(&args.base)?;
    batch::run(&[job], verbosity, &|picture, start, observer| {
        let base = read(args, text.clone(), picture)?;
        tell(&base, verbosity);
        let before = base.scene.len();
        tell_full(&args.options, before, verbosity);
        args.options.fit(before, observer, |fitter| {
            fitter.on(base).since(start).fit(picture)
        })
    })
}

fn read(args: &Args, text: String, picture: &Image) -> Result<Base> {
    let name = input::name(&args.base);
    Ok(Base::read(text, picture, args.freeze_base).map_err(|error| error.within(name))?)
}

/// Tells the user that the base, with `before` strokes, leaves no room for more, or has too many.
fn tell_full(options: &Options, before: usize, verbosity: Verbosity) {
    let Some(most) = options.config_beyond(before).budget.strokes else {
        return;
    };
    let remedy = format_args!("--strokes +{most} adds {most}");
    if most < before {
        verbosity.say(format_args!(
            "hint: the {most} strokes that contribute most stay of {before}: {remedy}"
        ));
    } else if most == before {
        verbosity.say(format_args!(
            "hint: the SVG has {before} strokes already, and --strokes {most} allows no more: {remedy}"
        ));
    }
}

/// Tells the user how the base is used.
fn tell(base: &Base, verbosity: Verbosity) {
    if !base.scene.is_empty() {
        verbosity.say(format_args!(
            "continuing from {} in {} layers",
            base.scene.counted(),
            base.scene.stages.len()
        ));
    }
    let Some(document) = &base.document else {
        return;
    };
    verbosity.say(format_args!(
        "keeping {} elements as they are",
        document.elements()
    ));
    let unseen = [
        (
            document.texts(),
            "text, and no fonts are loaded: convert it to paths first",
        ),
        (
            document.references(),
            "references to other files, which are not read: embed them first",
        ),
    ];
    for (count, why) in unseen.into_iter().filter(|(count, _)| *count > 0) {
        verbosity.say(format_args!(
            "{count} of these elements cannot be seen and may be drawn over: they are {why}"
        ));
    }
}
