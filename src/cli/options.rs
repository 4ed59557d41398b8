//! Options for what to draw and how to run, shared by the commands that draw: those of the library, and those of the command line
//! alone.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Result;
use clap::{ArgMatches, Command, FromArgMatches, value_parser};
use strokefit::fit::{
    self, Budget, Checkpoint, Colors, Config, Execution, Fit, Fitter, Focus, MAX_STROKES, Observer,
    Preset,
};
use strokefit::image::Limits;
use strokefit::report::Judged;
use strokefit::svg::{Form, WriteOptions};

use super::interrupt::GRACE;
use super::pictures::{FilmOptions, Made, Subject};
use super::{complain, input};

const EXECUTION: &str = "Execution (never changes the result)";

/// The options of a command that draws.
#[derive(Debug, Clone, clap::Args)]
#[command(
    mut_arg("outline", |outline| outline.conflicts_with("form")),
    mut_arg("cutout", |cutout| cutout.conflicts_with("form")),
)]
pub(super) struct Options {
    /// Stream events as JSON, one object per line: each stage as it ends, then the report. - means
    /// standard output
    #[arg(long, value_name = "E.jsonl")]
    pub(super) events: Option<PathBuf>,
    // Comes first, as clap hands each value over but once.
    #[command(flatten)]
    beyond: Beyond,
    #[command(flatten)]
    budget: Budget,
    #[command(flatten)]
    config: Config,
    /// At most N colours, including the background
    #[arg(long, alias = "colours", value_name = "N", help_heading = "Look")]
    colors: Option<usize>,
    /// Only these colours: a list #rrggbb,white,..., a file with one colour per line, or a GIMP palette. Paper stays as it
    /// is if none of them is like it
    #[arg(long, value_name = "LIST|FILE", help_heading = "Look", value_parser = palette, conflicts_with = "colors")]
    palette: Option<Colors>,
    /// Grey picture of the input's size that says how much an error counts where: white 1, black 0.002. Strokes go where
    /// people look, a face before a wall
    #[arg(long, value_name = "MASK.png", help_heading = "Look")]
    focus: Option<PathBuf>,
    #[command(flatten, next_help_heading = "File")]
    made: Made,
    #[command(flatten)]
    pub(super) film: FilmOptions,
    /// Serve a live page that shows the drawing as it grows, and print its address. After the fit the
    /// program waits for the page's button Done, for Ctrl-C, or until no page has been open for two minutes
    #[arg(long, help_heading = "Watching")]
    pub(super) view: bool,
    #[command(flatten, next_help_heading = EXECUTION)]
    pub(super) execution: Execution,
    /// Refuse pictures with more than N pixels
    #[arg(long, value_name = "N", help_heading = EXECUTION, value_parser = value_parser!(u64).range(1..))]
    max_pixels: Option<u64>,
    /// Save the state of the fit to FILE at intervals. If the fit is cut off, the same command resumes from
    /// FILE. The file is removed when the drawing is done
    #[arg(long, value_name = "FILE", help_heading = EXECUTION)]
    checkpoint: Option<PathBuf>,
    /// Seconds between two checkpoints [default: 10]
    #[arg(long, value_name = "SECONDS", help_heading = EXECUTION, value_parser = fit::seconds, requires = "checkpoint")]
    checkpoint_every: Option<Duration>,
}

impl Options {
    /// The configuration of a drawing that begins from nothing.
    pub(super) fn config(&self) -> Config {
        let mut config = Config {
            budget: self.budget,
            ..self.config.clone()
        };
        let counted = self.colors.map(Colors::AtMost);
        config.colors = self.palette.clone().or(counted).unwrap_or_default();
        if self.made.outline {
            config.file.form = Form::Outlines;
        }
        config.hatched = self.made.hatch.is_some();
        // A machine's paths stay on the page, and lie beside each other.
        config.confined = self.made.is_for_machines();
        config.opaque |= config.confined;
        config
    }

    /// The configuration of a drawing whose base brings `before` strokes.
    pub(super) fn config_beyond(&self, before: usize) -> Config {
        let mut config = self.config();
        if let Some(strokes) = config.budget.strokes.as_mut().filter(|_| self.beyond.0) {
            *strokes = before.saturating_add(*strokes).min(MAX_STROKES);
        }
        config
    }

    /// Refuses an option that is out of its range.
    pub(super) fn check(&self) -> strokefit::Result<()> {
        self.config().check_ranges()?;
        self.execution.check()
    }

    /// The options that keep a drawing from being more faithful.
    pub(super) fn limiting_looks(&self) -> Vec<&'static str> {
        let config = self.config();
        let options = [
            ("--colors or --palette", config.colors != Colors::Free),
            ("--pens", config.pens.is_some()),
            ("--opaque", config.opaque),
            ("--quality", config.quality.is_some()),
            ("--progressive", config.progressive),
            ("--no-polish", !config.polish),
            ("--points 2", config.points == Some(2)),
            ("--preset draft", config.preset == Preset::Draft),
            (
                "--precision",
                config.file.precision < WriteOptions::default().precision,
            ),
        ];
        let given = options.into_iter().filter(|(_, given)| *given);
        given.map(|(name, _)| name).collect()
    }

    /// The drawing as its files hold it: cut out, hatched or outlined if that was asked for.
    pub(super) fn subject<'a>(&self, judged: &'a Judged) -> Result<Subject<'a>> {
        Subject::of(judged, &self.made, self.config().pens.as_ref())
    }

    pub(super) fn limits(&self) -> Limits {
        let limits = Limits::default();
        Limits {
            max_pixels: self.max_pixels.unwrap_or(limits.max_pixels),
            ..limits
        }
    }

    pub(super) fn checkpoint(&self) -> Option<Checkpoint> {
        let kept = Checkpoint::new(self.checkpoint.as_ref()?);
        Some(match self.checkpoint_every {
            Some(span) => kept.every(span),
            None => kept,
        })
    }

    /// Configures a fitter for a drawing whose base brings `before` strokes, with a checkpoint if one was asked for, and
    /// draws with it.
    pub(super) fn fit(
        &self,
        before: usize,
        observer: &mut (dyn Observer + Send),
        draw: impl FnOnce(Fitter<'_>) -> strokefit::Result<Fit>,
    ) -> Result<Fit> {
        let fitter = Fitter::new(self.config_beyond(before))
            .execution(self.execution)
            .grace(GRACE)
            .observer(observer);
        let fitter = match &self.focus {
            Some(path) => {
                let (mask, _) = input::picture_within(path, self.limits())?;
                let focus = Focus::lifted(&mask).map_err(|e| e.within(input::name(path)))?;
                fitter.focus(focus)
            }
            None => fitter,
        };
        let Some(mut checkpoint) = self.checkpoint() else {
            return Ok(draw(fitter)?);
        };
        let fit = draw(fitter.checkpoint(&mut checkpoint));
        if let Some(trouble) = checkpoint.trouble() {
            complain(format_args!("warning: {trouble}"));
        }
        Ok(fit?)
    }
}

/// True if the limit on strokes begins with +: it counts those beyond the base.
#[derive(Debug, Clone, Copy, Default)]
struct Beyond(bool);

impl clap::Args for Beyond {
    fn augment_args(command: Command) -> Command {
        command
    }

    fn augment_args_for_update(command: Command) -> Command {
        command
    }
}

impl FromArgMatches for Beyond {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let text = matches
            .get_raw("strokes")
            .and_then(|mut texts| texts.next());
        Ok(Self(text.is_some_and(|text| {
            text.as_encoded_bytes().starts_with(b"+")
        })))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Longest file that counts as a palette, bytes.
const MAX_PALETTE_BYTES: u64 = 1 << 20;

/// The colours of a list, or of a file.
fn palette(text: &str) -> Result<Colors, String> {
    let list = Colors::palette(text);
    let is_file = Path::new(text).exists();
    let is_list = text.contains(',') || list.is_ok();
    if text.starts_with('#') || !is_file && is_list {
        return list.map_err(|error| error.to_string());
    }
    let remedy =
        "give #rrggbb,#rrggbb,..., a file with one such colour per line, or a GIMP palette";
    let unreadable = |e: io::Error| match e.kind() {
        io::ErrorKind::NotFound => format!("no such file: {remedy}"),
        _ => format!("cannot be read ({e}): {remedy}"),
    };
    if fs::metadata(text).map_err(unreadable)?.len() > MAX_PALETTE_BYTES {
        return Err(format!("the file is longer than 1 MiB: {remedy}"));
    }
    let bytes = fs::read(text).map_err(unreadable)?;
    let text = String::from_utf8(bytes).map_err(|_| format!("not a text file: {remedy}"))?;
    Colors::palette(&text).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use strokefit::fit::OPTIONS;

    fn command() -> Command {
        <Options as clap::Args>::augment_args(Command::new("x"))
    }

    fn drawing(flags: &[&str]) -> Options {
        let args = ["x"].iter().chain(flags);
        Options::from_arg_matches(&command().get_matches_from(args)).unwrap()
    }

    #[test]
    fn without_flags_all_is_as_the_library_has_it() {
        assert_eq!(drawing(&[]).config(), Config::default());
    }

    #[test]
    fn every_option_of_a_drawing_is_a_flag() {
        let command = command();
        let flags: Vec<&str> = command
            .get_arguments()
            .filter_map(|arg| arg.get_long())
            .collect();
        for name in OPTIONS
            .iter()
            .filter(|name| !["threads", "simd"].contains(name))
        {
            assert!(
                flags
                    .iter()
                    .any(|flag| flag.trim_start_matches("no-") == *name),
                "{name}"
            );
        }
    }

    #[test]
    fn a_limit_with_a_plus_counts_strokes_beyond_the_base() {
        let most = |flag| drawing(&[flag]).config_beyond(200).budget.strokes;
        assert_eq!(most("--strokes=300"), Some(300));
        assert_eq!(most("--strokes=+300"), Some(500));
        assert!(drawing(&["--strokes=+0"]).config().check_ranges().is_err());
        for text in ["+", "++3", "+-3"] {
            let args = ["x".to_owned(), format!("--strokes={text}")];
            assert!(command().try_get_matches_from(args).is_err(), "{text}");
        }
    }

    #[test]
    fn switches_set_what_they_say() {
        let config = drawing(&["--no-polish", "--opaque", "--outline"]).config();
        assert!(!config.polish && config.opaque && !config.progressive);
        assert_eq!(config.file.form, Form::Outlines);
    }

    #[test]
    fn a_list_is_told_from_a_file() {
        let two = Colors::Palette(vec![[255, 0, 0], [0, 0, 255]]);
        assert_eq!(palette("red,#00f"), Ok(two.clone()));
        for (text, words) in [
            ("rot,blau", "'rot' is not a colour"),
            ("no-such-file", "no such file"),
        ] {
            let message = palette(text).unwrap_err();
            assert!(message.contains(words), "{message}");
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.txt");
        fs::write(&path, "red\nblue\n").unwrap();
        assert_eq!(palette(&path.to_string_lossy()), Ok(two));
    }
}
