//! `strokefit refine`: an SVG and a picture in, the SVG with more strokes out.

use std::path::PathBuf;

use anyhow::Result;
use strokefit::fit::{Background, Base};
use strokefit::image::Image;

use super::job::Job;
use super::options::Options;
use super::{Status, Verbosity, batch, input, misuse, pictures};

/// Add strokes to an SVG so that it comes closer to a picture
///
/// The strokes of a drawing of strokefit's are taken up: fitted further, in their layers, together with
/// the new ones, which come in new layers. Any other SVG stays as it is, byte for byte, and the new layers
/// are laid on it, before the end of its root element; strokes that were laid on it so are taken up too.
/// What was drawn from a picture of another size, or with --freeze-base, stays as it is.
///
/// Budgets count the whole file: --strokes the strokes taken up and the new ones, --psnr and --bytes the
/// file that is written, and --stages plans the whole drawing, of which the stages that are there are left
/// out. An SVG that meets a budget already is written as it is. The background is that of the SVG.
#[derive(Debug, clap::Args)]
#[command(
    mut_arg("background", |background| background.hide(true)),
    after_help = "Examples:
  strokefit refine photo.svg photo.jpg -o better.svg --strokes 2000
  strokefit refine traced.svg photo.png -o finished.svg --strokes 200
  strokefit refine photo.svg photo.jpg -o more.svg --freeze-base --psnr 34"
)]
pub(super) struct Args {
    /// The SVG to go on from; - for standard input
    base: PathBuf,
    /// PNG, JPEG, WebP, GIF (first frame), BMP or TIFF picture; - for standard input
    input: PathBuf,
    /// The SVG to write; - for standard output. Again for more: .png is a render, .gif, .webp or .apng an
    /// animation, .animated.svg draws itself; for single frames see Animation
    #[arg(short, long, value_name = "OUT.svg", required = true)]
    output: Vec<PathBuf>,
    /// Write what was done as JSON; - for standard output
    #[arg(long, value_name = "R.json")]
    report: Option<PathBuf>,
    /// Leave all strokes as they are and lay the new layers on them
    #[arg(long)]
    freeze_base: bool,
    #[command(flatten)]
    options: Options,
}

pub(super) fn run(args: &Args, verbosity: Verbosity) -> Result<Status> {
    if input::is_stdin(&args.base) && input::is_stdin(&args.input) {
        return Err(misuse(
            "standard input cannot be both the SVG and the picture: name one of them",
        ));
    }
    if args.options.config().background != Background::Auto {
        return Err(misuse(
            "--background cannot be chosen when refining: the base is the background",
        ));
    }
    let (output, others) = pictures::split(&args.output)?;
    let job = Job {
        base: Some(&args.base),
        input: &args.input,
        output: output.to_owned(),
        pictures: others.into_iter().map(PathBuf::from).collect(),
        report: args.report.clone(),
        options: &args.options,
    };
    let text = input::svg(&args.base)?;
    batch::run(&[job], verbosity, &|picture, start, observer| {
        let base = read(args, text.clone(), picture)?;
        tell(&base, verbosity);
        args.options
            .fit(observer, |fitter| fitter.on(base).since(start).fit(picture))
    })
}

fn read(args: &Args, text: String, picture: &Image) -> Result<Base> {
    let name = input::name(&args.base);
    Ok(Base::read(text, picture, args.freeze_base).map_err(|error| error.within(name))?)
}

/// Says what becomes of the base.
fn tell(base: &Base, verbosity: Verbosity) {
    if !base.scene.is_empty() {
        verbosity.say(format_args!(
            "taking up {} strokes in {} layers",
            base.scene.len(),
            base.scene.stages.len()
        ));
    }
    let Some(document) = &base.document else {
        return;
    };
    verbosity.say(format_args!(
        "passing through {} elements as they are",
        document.elements()
    ));
    let unseen = [
        (
            document.texts(),
            "text, and there are no fonts here: turn it into paths first",
        ),
        (
            document.references(),
            "in other files, which are not read: embed them first",
        ),
    ];
    for (count, why) in unseen.into_iter().filter(|(count, _)| *count > 0) {
        verbosity.say(format_args!(
            "{count} of them cannot be seen and may be drawn over: they are {why}"
        ));
    }
}
