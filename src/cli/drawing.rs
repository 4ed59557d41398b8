//! The options of a drawing as flags: the library reads their values.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser, ValueParser};
use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgMatches, Command, FromArgMatches, value_parser};
use strokefit::fit::{Config, MAX_STROKES, Options, Value};
use strokefit::machine::Hatch;

use super::palette;

/// The options by heading, as in the help: the flag, the name of its value with its default, what it is for, and the words
/// that it may have; a word without help is one of former versions. A flag without a value is a switch.
const OPTIONS: [(&str, &str); 3] = [
    (
        "Budget (the first one reached stops)",
        "
--strokes N
    At most N strokes. With refine, +N counts those beyond the strokes that BASE brings
--psnr DB
    Stop when the file reaches DB decibels of PSNR: 25 is rough, 30 fair, 35 good
--bytes N
    At most N bytes of SVG; 20kB, 1.5MB and 64KiB are understood
--time SECONDS
    At most this many seconds, from reading the picture to writing the SVG",
    ),
    (
        "Look",
        "
--quality Q
    Quality, 0 to 60; higher keeps more. A stroke is kept while every byte it costs removes at least the squared error
    that one pixel has at Q dB [default: 30, less for pictures over 768×512, unless --strokes, --psnr or --bytes is given]
--preset PRESET=balanced
    How much time to spend for a better drawing
    * draft: An eighth of the time, 2 to 3 dB worse
    * balanced: The default
    * best: Three to five times the time, 0.7 to 0.9 dB better
--marks MARKS=auto
    What the drawing is made of
    * auto: Areas for what is filled, strokes for lines and for the rest. With --pens or --bytes, strokes
    * strokes: Strokes alone, for plotters and embroidery
    * areas: Areas alone, for cutters
--progressive
    Fit each layer for the layers below it only. The drawing is good after every layer, and some dB worse in the end
--literal
    Draw noise, traces of JPEG and other damage of the picture as they are
--opaque
    Use opaque strokes only. They are easier to edit and cost some dB
--look LOOK
    Which errors count: eye (those that people see, so that smooth places have fewer seams) or exact (all alike, for a
    tenth of a dB more) [default: eye, but exact with --psnr]
--pens WIDTHS
    Only these widths of strokes: lengths such as 0.3mm,0.8mm on a page of a --width, or numbers in px of the picture
--coverage EDGE=smoothstep
    Coverage function of soft edges: smoothstep, sigmoid, tanh or atan[:K]; A>B changes from A to B during the fit. Here
    tanh draws the same as sigmoid, and atan:K the same as atan for any K, because a fit gives all edges the same slope
--points N
    Most points of a stroke, 2 or more. 2 draws line segments alone [default: as many as pay]
--stages N
    Number of stages, each a layer of the SVG [default: chosen from the budget]
--no-polish
    Skip the joint fit of all strokes after the stages. The fit is faster and some dB worse
--background COLOR=auto
    Background colour: auto, none, #rrggbb or a name such as white. auto keeps transparency; with --opaque it flattens a
    picture with translucent areas onto white. A colour is what the picture is flattened onto
--focus MASK.png
    Grey picture of the input's size that says how much an error counts where: white 1, black 0.002. Strokes go where
    people look, a face before a wall
--seed S=0
    Seed of all random choices. Another seed gives a slightly different drawing
--colors N
    At most N colours, including the background
--palette LIST|FILE
    Only these colours: a list #rrggbb,white,..., a file with one colour per line, or a GIMP palette. Paper stays as it
    is if none of them is like it",
    ),
    (
        "File",
        "
--precision N=2
    Decimals of coordinates and widths, 0 to 6
--form FORM=plain
    What one element of the SVG holds
    * plain: One stroke
    * smallest: As many strokes as possible: fewest bytes, hardest to edit
    * css: One stroke; its colour and its width are in classes of a style sheet, the one place to change them
    * elements:
--group GROUP=stage
    What one layer of the SVG holds
    * stage: The strokes of one stage
    * color: Strokes of one colour. With --colors or --palette each colour has one layer
    * object: A thing: an area with what lies on it, or touching strokes of one colour. Marks have names
      and keep the order that they were fitted in
--order ORDER=fitted
    In which order the strokes of a layer come
    * fitted: The order that they were fitted in
    * travel: With short ways between them, for a plotter; the picture stays the same
--outline
    Write filled outlines instead of strokes, one for each, for programs that ignore strokes
--cutout
    Write what is seen of each colour as one path, for cutters: areas do not overlap, share their borders, and end at the
    page. All is opaque; the background is one of the areas unless it is none
--hatch DISTANCE[:ANGLE]
    Fill areas with lines for a plotter, so far apart, such as 0.5mm, at an angle, 45 degrees if none is given. The lines are as wide as the
    thinnest of the --pens, or as they are far apart
--width LENGTH
    Width of the page in mm, cm, in, pt or px, such as 120mm [default: one px per pixel of the picture]",
    ),
];

/// The switches, with the option that each sets and its value.
const SWITCHES: [(&str, &str, Value<'_>); 5] = [
    ("literal", "literal", Value::Switch(true)),
    ("progressive", "progressive", Value::Switch(true)),
    ("opaque", "opaque", Value::Switch(true)),
    ("no-polish", "polish", Value::Switch(false)),
    ("outline", "form", Value::Text("outlines")),
];

/// The drawing that is asked for.
#[derive(Debug, Clone, Default)]
pub(super) struct Drawing {
    pub(super) options: Options,
    /// True if the limit on strokes counts those beyond the base.
    counts_new: bool,
    /// The picture of weights.
    pub(super) focus: Option<PathBuf>,
    /// True if areas are cut out.
    pub(super) cutout: bool,
    /// Lines that fill areas, if they do.
    pub(super) hatch: Option<Hatch>,
}

impl Drawing {
    /// The configuration of a drawing whose base brings `before` strokes.
    pub(super) fn config_beyond(&self, before: usize) -> Config {
        let mut config = self.options.config.clone();
        if let Some(strokes) = config.budget.strokes.as_mut().filter(|_| self.counts_new) {
            *strokes = before.saturating_add(*strokes).min(MAX_STROKES);
        }
        config
    }
}

impl clap::Args for Drawing {
    fn augment_args(command: Command) -> Command {
        command.args(args())
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Drawing {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut drawing = Self::default();
        drawing.update_from_arg_matches(matches)?;
        Ok(drawing)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        let mut set = |name: &str, value: Value<'_>| {
            let refused = |refusal| clap::Error::raw(ErrorKind::ValueValidation, refusal);
            self.options.set(name, value).map_err(refused)
        };
        for arg in args() {
            let name = arg.get_id().as_str();
            // Switches and paths are no texts.
            if let Ok(Some(text)) = matches.try_get_one::<String>(name) {
                set(name, Value::Written(text.trim_start_matches('+')))?;
            }
        }
        for (flag, name, value) in SWITCHES {
            if matches.get_flag(flag) {
                set(name, value)?;
            }
        }
        self.counts_new = matches
            .get_one("strokes")
            .is_some_and(|text: &String| text.starts_with('+'));
        self.focus = matches.get_one("focus").cloned();
        self.cutout = matches.get_flag("cutout");
        self.hatch = matches.get_one("hatch").copied();
        let config = &mut self.options.config;
        config.hatched |= self.hatch.is_some();
        if self.cutout || self.hatch.is_some() {
            (config.confined, config.opaque) = (true, true);
        }
        Ok(())
    }
}

fn args() -> impl Iterator<Item = Arg> {
    OPTIONS.into_iter().flat_map(|(heading, options)| {
        let entries = options.split("\n--").skip(1);
        entries.map(move |entry| related(arg(entry).help_heading(heading)))
    })
}

/// The argument with what sets it apart.
fn related(arg: Arg) -> Arg {
    match arg.get_id().as_str() {
        "progressive" => arg.conflicts_with("no-polish"),
        "outline" => arg.conflicts_with("form"),
        "cutout" => arg.conflicts_with_all(["outline", "hatch", "form"]),
        "hatch" => arg.conflicts_with("outline").allow_hyphen_values(true),
        "palette" => arg.conflicts_with("colors"),
        "colors" => arg.alias("colours"),
        "pens" | "width" => arg.allow_hyphen_values(true),
        _ => arg,
    }
}

fn arg(entry: &'static str) -> Arg {
    let (flag, text) = entry.split_once('\n').unwrap_or((entry, ""));
    let mut parts = text.split("    * ");
    let help = parts.next().unwrap_or_default().split_whitespace();
    let help = help.collect::<Vec<_>>().join(" ");
    let Some((name, value)) = flag.split_once(' ') else {
        return Arg::new(flag)
            .long(flag)
            .help(help)
            .action(ArgAction::SetTrue);
    };
    let (value, default) = match value.split_once('=') {
        Some((value, default)) => (value, Some(default)),
        None => (value, None),
    };
    let words: Vec<_> = parts.filter_map(|part| part.split_once(':')).collect();
    Arg::new(name)
        .long(name)
        .help(help)
        .value_name(value)
        .default_value(default)
        .value_parser(parser(name, &words))
        .allow_negative_numbers(true)
}

/// The parser of an option's value, which stays text. It may be one of these words, if there are any.
fn parser(name: &'static str, words: &[(&'static str, &'static str)]) -> ValueParser {
    let checked = move |text: &str| checked(name, text);
    match name {
        "strokes" => ValueParser::new(move |text: &str| {
            checked(text.strip_prefix('+').unwrap_or(text)).map(|_| text.to_owned())
        }),
        "palette" => ValueParser::new(move |text: &str| checked(&palette::read(text)?)),
        "focus" => value_parser!(PathBuf),
        "hatch" => ValueParser::new(|text: &str| text.parse::<Hatch>()),
        _ if words.is_empty() => ValueParser::new(checked),
        _ => {
            let values = words.iter().map(|(word, help)| {
                let help = help.trim();
                PossibleValue::new(*word).help(help).hide(help.is_empty())
            });
            let words = PossibleValuesParser::new(values);
            ValueParser::new(words.try_map(move |word| checked(&word)))
        }
    }
}

/// The text, if it is a value of the option.
fn checked(name: &str, text: &str) -> Result<String, String> {
    read(name, text).map(|_| text.to_owned())
}

/// The default options with this one set.
pub(super) fn read(name: &str, text: &str) -> Result<Options, String> {
    let mut options = Options::default();
    let set = options.set(name, Value::Written(text));
    set.map(|()| options).map_err(|refusal| refusal.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(flags: &[&str]) -> Drawing {
        let command = <Drawing as clap::Args>::augment_args(Command::new("x"));
        let args = ["x"].iter().chain(flags);
        Drawing::from_arg_matches(&command.get_matches_from(args)).unwrap()
    }

    #[test]
    fn without_flags_all_is_as_the_library_has_it() {
        assert_eq!(drawing(&[]).options, Options::default());
    }

    #[test]
    fn a_limit_with_a_plus_counts_strokes_beyond_the_base() {
        let most = |flag| drawing(&[flag]).config_beyond(200).budget.strokes;
        assert_eq!(most("--strokes=300"), Some(300));
        assert_eq!(most("--strokes=+300"), Some(500));
        for text in ["+", "+0", "++3", "+-3"] {
            let command = <Drawing as clap::Args>::augment_args(Command::new("x"));
            let args = ["x".to_owned(), format!("--strokes={text}")];
            assert!(command.try_get_matches_from(args).is_err(), "{text}");
        }
    }

    #[test]
    fn switches_set_what_they_say() {
        let config = drawing(&["--no-polish", "--opaque", "--outline"])
            .options
            .config;
        assert!(!config.polish && config.opaque && !config.progressive);
        assert_eq!(config.file.form.to_string(), "outlines");
    }
}
