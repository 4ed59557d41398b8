//! The command line: arguments, subcommands and exit statuses.
//!
//! [`main`] is the whole program. Packages for other languages start it as `strokefit` does. `rig/` builds its own
//! program from parts of this one.

pub mod bar;
mod batch;
mod check;
mod fit;
mod hint;
pub mod input;
mod interrupt;
mod job;
mod options;
pub mod output;
mod pictures;
mod progress;
mod refine;
mod refusal;
mod render;
mod rig;
mod settings;
pub mod usage;
mod view;

use std::ffi::OsString;
use std::fmt::Display;
use std::io::{self, Write};

use clap::{Parser, Subcommand};

use hint::Hint;
use interrupt::Signal;
use usage::parse;

/// Runs the program and returns its exit status. `args` begin with the program's name.
pub fn main(args: Vec<OsString>) -> u8 {
    let status = match parse(args) {
        Ok(args) => run(&args).unwrap_or_else(|error| fail(&error)),
        Err(status) => status,
    };
    // Another program's end does not write what is left here.
    let _ = io::stdout().flush();
    status.leave()
}

/// Turns a raster picture into an editable SVG made of strokes.
///
/// A stroke is a line, a bent line or a curve with round caps. strokefit puts strokes where the drawing differs most from
/// the picture, improves them by gradient descent, and repeats. Then it writes the SVG, renders it
/// with resvg, and reports how faithful it is.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES, after_long_help = EXAMPLES_AND_STATUSES)]
struct Args {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    verbosity: Verbosity,
}

#[derive(Debug, Subcommand)]
enum Command {
    Fit(fit::Args),
    Refine(refine::Args),
    Check(check::Args),
    Render(render::Args),
    View(view::Args),
    #[command(hide = true)]
    Bench(rig::Rest),
    #[command(hide = true)]
    Lab(rig::Rest),
    Completions(usage::Completions),
    Man(usage::Man),
}

const EXAMPLES: &str = "Examples:
  strokefit fit photo.jpg -o photo.svg
  strokefit fit logo.png -o logo.svg --strokes 300 --opaque
  strokefit refine photo.svg photo.jpg -o better.svg --strokes 2000
  strokefit check photo.svg photo.jpg
  strokefit render photo.svg -o large.png --scale 4";

const EXAMPLES_AND_STATUSES: &str = "Examples:
  strokefit fit photo.jpg -o photo.svg                 all defaults
  strokefit fit logo.png -o logo.svg --strokes 300     at most 300 strokes
  strokefit fit a.png -o a.svg --psnr 32 --time 60     until 32 dB or one minute
  strokefit fit *.jpg -o 'out/{stem}.svg'              one SVG for each picture
  cat a.png | strokefit fit - -o - > a.svg             in a pipe
  strokefit refine a.svg a.png -o b.svg --strokes 900  more strokes on any SVG
  strokefit check photo.svg photo.jpg                  how faithful is the file?
  strokefit render photo.svg -o large.png --scale 4    four times the size

Exit status: 0 done, 1 failed, 2 wrong usage, 3 a target was not reached, 4 the fidelity check
failed (a renderer does not draw the SVG as it was fitted). On Ctrl-C, SIGTERM or SIGHUP during a
fit, the program writes the drawing as far as it has come, within a second or so, and then ends as
the signal does; shells report status 130, 143 or 129. A second signal ends it at once.";

/// Amount of text on standard error.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct Verbosity {
    /// Print errors only
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Print a line for each part of a fit as it ends, and every few seconds for one that takes long
    #[arg(short, long, global = true)]
    verbose: bool,
}

impl Verbosity {
    /// A line for the user, unless quiet.
    pub fn say(self, line: impl Display) {
        if !self.quiet {
            complain(line);
        }
    }

    /// A line for the curious.
    pub fn detail(self, line: impl Display) {
        if self.verbose {
            complain(line);
        }
    }
}

/// Outcome of the command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// All is well.
    Done,
    /// Nothing was made.
    Failed,
    /// The arguments make no sense.
    Usage,
    /// The drawing is there, but short of what was asked for.
    TargetMissed,
    /// The drawing is there, but not drawn as it was fitted.
    Disagrees,
    /// A signal ended the fit; what was drawn until then is there.
    Interrupted(Signal),
    /// Another program did the work, and ended with this number.
    Other(u8),
}

impl Status {
    /// The worse of two.
    fn or_worse(self, other: Self) -> Self {
        let rank = |status| match status {
            Self::Done => 0,
            Self::TargetMissed => 1,
            Self::Disagrees => 2,
            Self::Usage => 3,
            Self::Failed | Self::Other(_) => 4,
            Self::Interrupted(_) => 5,
        };
        if rank(other) > rank(self) {
            other
        } else {
            self
        }
    }

    /// The number of this status. If a signal was the cause, it ends the process.
    pub fn leave(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Failed => 1,
            Self::Usage => 2,
            Self::TargetMissed => 3,
            Self::Disagrees => 4,
            Self::Interrupted(signal) => signal.end(),
            Self::Other(number) => number,
        }
    }
}

/// Does what the arguments ask for.
fn run(args: &Args) -> anyhow::Result<Status> {
    strokefit::verify::silence_panics();
    match &args.command {
        Command::Fit(fit) => fit::run(fit, args.verbosity),
        Command::Refine(refine) => refine::run(refine, args.verbosity),
        Command::Check(check) => check::run(check, args.verbosity),
        Command::Render(render) => render::run(render),
        Command::View(view) => view::run(view),
        Command::Bench(rest) => rig::run(&[], rest, args.verbosity),
        Command::Lab(rest) => rig::run(&["lab"], rest, args.verbosity),
        Command::Completions(completions) => usage::complete(completions),
        Command::Man(man) => usage::man(man, args.verbosity),
    }
}

/// Says what went wrong in one line, and what to do in another where there is advice.
pub fn fail(error: &anyhow::Error) -> Status {
    let (wrong, hint) = Hint::split(error);
    complain(format_args!("error: {wrong}"));
    if let Some(hint) = hint {
        complain(format_args!("hint: {hint}"));
    }
    match error.downcast_ref::<strokefit::Error>() {
        Some(error) if error.kind() == strokefit::ErrorKind::Config => Status::Usage,
        _ => Status::Failed,
    }
}

/// A line on standard error, which may be closed.
fn complain(line: impl Display) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// An error of wrong usage.
fn misuse(message: impl Into<String>) -> anyhow::Error {
    strokefit::Error::new(strokefit::ErrorKind::Config, message).into()
}
