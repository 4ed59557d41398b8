//! `inverse` and `robust`: known drawings and clean pictures, found again in pictures of them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::bench::drawings::{Drawing, Kind, Pictures};
use crate::bench::files::{few, has_ending, named, stem};
use crate::bench::gallery::{Gallery, PANEL_PX};
use crate::bench::inverse::{self, Drawer, Outcome, Truth, ink};
use crate::bench::programs::installed_for;
use crate::lab::ResultFolder;
use crate::report::Damage;
use crate::report::cases::CaseEntry;
use anyhow::Result;
use strokefit::cli::{Verbosity, input};
use strokefit::report::json;

use super::super::domain;
use super::{Extents, say, say_missing};

/// Drawings of shapes that a short run of `inverse` takes, at most, and pictures that one of `robust` takes.
const FEW_DRAWINGS: usize = 6;
const FEW_PICTURES: usize = 2;

/// Drawings in ink of each kind: usual, and of short runs.
const INK_DRAWINGS: usize = 4;
const FEW_INK_DRAWINGS: usize = 1;

/// Endings of the files that a folder stands for in `robust`.
const ENDINGS: [&str; 4] = ["svg", "png", "jpg", "jpeg"];

/// Longer side of the pictures of SVGs in `robust`, px: usual, and of short runs.
const SIDE: u16 = 256;
const SHORT_SIDE: u16 = 96;

/// Pictures of `robust` that are shown, at most; each has a dozen damages.
const SHOWN: usize = 6;

/// Find known drawings again in pictures of them, beside other programs that are installed (pyautotrace, potrace,
/// vtracer, Inkscape)
///
/// Numbers, colours and edges are compared, and the centre lines of strokes.
#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Inverse {
    /// SVGs, and folders of them [default: drawings of strokes that are built in]; with --ink, pictures with their lines in a JSON
    /// file beside them [default: drawings in ink of seven kinds]
    drawings: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) extents: Extents,
    /// Longer sides of the pictures, px [default: 48 to 384 of strokes, 128 to 512 of other drawings]
    #[arg(long, value_name = "PX", value_delimiter = ',', value_parser = domain::side)]
    sides: Vec<u16>,
    /// Damage of the pictures: clean, jpegQUALITY, noiseLEVELS, aliased, dithered, enlarged, photographed [default: clean,jpeg75; noise8 of other drawings
    /// than of strokes, too]
    #[arg(long, value_name = "DAMAGE", value_delimiter = ',')]
    damage: Vec<Damage>,
    /// Find lines whose width varies again in pictures of drawings in ink: which come back as one element each?
    #[arg(long, conflicts_with_all = ["sides", "damage"])]
    ink: bool,
    /// Drawings in ink of each kind [default: 4; with --short: 1]
    #[arg(long, value_name = "N", value_parser = domain::count, requires = "ink")]
    count: Option<usize>,
    /// Glyphs to draw in ink: SVGs of centre lines, as KanjiVG's
    #[arg(long, value_name = "FILE.svg", num_args = 1.., requires = "ink")]
    kanji: Vec<PathBuf>,
}

/// Damage clean pictures and draw them, beside other programs that are installed (pyautotrace, potrace, vtracer, Inkscape):
/// growth of elements, numbers and bytes, and fidelity to the clean pictures
#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Robust {
    /// Clean pictures, SVGs, and folders of them
    #[arg(required = true)]
    pictures: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) extents: Extents,
    /// Longer side of the pictures of SVGs, px [default: 256; with --short: 96]
    #[arg(long, value_name = "PX", value_parser = domain::side)]
    side: Option<u16>,
    /// Damage: clean, jpegQUALITY, noiseLEVELS, aliased, dithered, enlarged, photographed [default: clean and all others,
    /// JPEG of quality 90, 75, 50, 30, noise of 4, 8, 16 levels]
    #[arg(long, value_name = "DAMAGE", value_delimiter = ',')]
    damage: Vec<Damage>,
}

/// One run over pictures, whose files begin with a name.
struct Run<'a> {
    name: &'a str,
    ours: Vec<Drawer>,
    damages: &'a [Damage],
    /// Whether a case is shown in the gallery.
    is_shown: &'a dyn Fn(&CaseEntry) -> bool,
    /// What cases are summed up by.
    kind: fn(&CaseEntry) -> String,
}

impl Run<'_> {
    /// Draws the pictures, and writes drawings, tables and the gallery; how many cases failed.
    fn over(
        &self,
        truths: impl Iterator<Item = strokefit::Result<Truth>>,
        peers: Kind,
        files: &mut ResultFolder,
    ) -> Result<usize> {
        let (peers, _) = installed_for(peers);
        let mut gallery = Gallery::default();
        let mut tell = |outcome: Outcome<'_>| {
            say(&outcome.entry.line());
            if (self.is_shown)(outcome.entry) {
                inverse::show(&mut gallery, outcome)?;
            }
            match outcome.svg {
                "" => Ok(()),
                svg => files.text(&outcome.entry.svg_name(), svg),
            }
        };
        let report = inverse::run(truths, self.damages, &self.ours, &peers, &mut tell)?;
        let name = self.name;
        files.text(&format!("{name}.csv"), &report.table().csv())?;
        files.text(&format!("{name}.md"), &report.markdown(self.kind))?;
        files.text(&format!("{name}.json"), &json(&report)?)?;
        files.picture(&format!("{name}.png"), &gallery.sheet()?)?;
        Ok(report.failures())
    }
}

impl Inverse {
    /// Runs it; how many cases failed.
    pub(super) fn run(&self, files: &mut ResultFolder, verbosity: Verbosity) -> Result<usize> {
        if self.ink {
            return self.in_ink(files, verbosity);
        }
        let (strokes, mut shapes) = self.drawings(verbosity)?;
        if self.extents.short {
            shapes = few(shapes, FEW_DRAWINGS);
        }
        let mut failures = 0;
        for (name, kind, drawings) in [
            ("inverse", Kind::Strokes, strokes),
            ("shapes", Kind::Shapes, shapes),
        ] {
            let pictures = self.pictures(kind);
            let sides = || pictures.sides.iter().copied();
            // The size nearest to that of a panel.
            let shown = sides().min_by_key(|side| usize::from(*side).abs_diff(PANEL_PX));
            let is_shown = |entry: &CaseEntry| {
                shown.is_some_and(|side| usize::from(side) == entry.side_px)
                    && entry.damage == Damage::Clean
            };
            let run = Run {
                name,
                ours: Drawer::all(kind),
                damages: &pictures.damages,
                is_shown: &is_shown,
                kind: CaseEntry::kind,
            };
            if !drawings.is_empty() {
                let of = |drawing| sides().map(move |side| Truth::of_drawing(drawing, side));
                failures += run.over(drawings.iter().flat_map(of), kind, files)?;
            }
        }
        say_missing(&installed_for(Kind::Shapes).1, verbosity);
        Ok(failures)
    }

    /// Draws pictures in ink again; how many failed.
    fn in_ink(&self, files: &mut ResultFolder, verbosity: Verbosity) -> Result<usize> {
        let usual = if self.extents.short {
            FEW_INK_DRAWINGS
        } else {
            INK_DRAWINGS
        };
        let mut given = Vec::new();
        for (path, _) in named(&self.drawings, &["png"])? {
            given.push(ink::Drawing::given(&path, &input::picture(&path)?)?);
        }
        for (i, (path, _)) in named(&self.kanji, &["svg"])?.iter().enumerate() {
            given.push(ink::Drawing::glyph(&stem(path), &input::svg(path)?, i)?);
        }
        let count = match given.len() {
            0 => self.count.unwrap_or(usual),
            _ => 0,
        };
        let (peers, missing) = installed_for(Kind::Strokes);
        let mut gallery = Gallery::default();
        let mut tell = |outcome: &ink::Outcome<'_>| {
            say(&outcome.entry.line());
            outcome.show(&mut gallery)?;
            let (drawing, name) = (outcome.drawing, outcome.drawing.name());
            if outcome.entry.is_own() {
                files.picture(&format!("{name}.png"), drawing.picture())?;
                files.text(&format!("{name}.truth.json"), &drawing.truth()?)?;
            }
            match outcome.svg {
                "" => Ok(()),
                svg => files.text(&outcome.entry.svg_name(), svg),
            }
        };
        let all = ink::Drawing::own(count).chain(given.into_iter().map(Ok));
        let report = ink::run(all, &Drawer::default_fit(), &peers, &mut tell)?;
        say(&format!("\n{}", report.summary().markdown()));
        files.text("ink.csv", &report.table().csv())?;
        files.text("ink.md", &report.markdown())?;
        files.text("ink.json", &json(&report)?)?;
        files.picture("ink.png", &gallery.sheet()?)?;
        say_missing(&missing, verbosity);
        Ok(report.failures())
    }

    /// The drawings of strokes, with those that are built in, and all others.
    fn drawings(&self, verbosity: Verbosity) -> Result<(Vec<Drawing>, Vec<Drawing>)> {
        let (mut strokes, mut shapes) = (Vec::new(), Vec::new());
        for (path, is_listed) in named(&self.drawings, &["svg"])? {
            let svg = input::svg(&path)?;
            let name = stem(&path);
            let drawing = Drawing { name, svg };
            match drawing.kind() {
                Ok(Kind::Strokes) => strokes.push(drawing),
                Ok(Kind::Shapes) => shapes.push(drawing),
                Err(error) if is_listed => verbosity.say(format_args!("not measured: {error}")),
                Err(error) => return Err(error.into()),
            }
        }
        if shapes.is_empty() || !strokes.is_empty() {
            strokes.splice(0..0, inverse::own());
        }
        Ok((strokes, shapes))
    }

    fn pictures(&self, kind: Kind) -> Pictures {
        let mut pictures = if self.extents.short {
            Pictures::short(kind)
        } else {
            Pictures::full(kind)
        };
        if !self.sides.is_empty() {
            pictures.sides.clone_from(&self.sides);
        }
        if !self.damage.is_empty() {
            pictures.damages.clone_from(&self.damage);
        }
        pictures
    }
}

impl Robust {
    /// Runs it; how many cases failed.
    pub(super) fn run(&self, files: &mut ResultFolder, verbosity: Verbosity) -> Result<usize> {
        let paths = named(&self.pictures, &ENDINGS)?.into_iter();
        let mut paths: Vec<PathBuf> = paths.map(|(path, _)| path).collect();
        if self.extents.short {
            paths = few(paths, FEW_PICTURES);
        }
        let shown: BTreeSet<String> = paths.iter().take(SHOWN).map(|path| stem(path)).collect();
        let truths = paths.iter().map(|path| self.truth(path));
        let truths: Vec<Truth> = truths.collect::<Result<_>>()?;
        let run = Run {
            name: "robust",
            ours: vec![Drawer::default_fit()],
            damages: match self.damage.as_slice() {
                [] => &Damage::ALL,
                chosen => chosen,
            },
            is_shown: &|entry| shown.contains(&entry.drawing),
            kind: CaseEntry::damage_words,
        };
        let failures = run.over(truths.into_iter().map(Ok), Kind::Shapes, files)?;
        say_missing(&installed_for(Kind::Shapes).1, verbosity);
        Ok(failures)
    }

    fn truth(&self, path: &Path) -> Result<Truth> {
        if !has_ending(path, "svg") {
            return Ok(Truth::of_picture(stem(path), &input::picture(path)?));
        }
        let drawing = Drawing {
            name: stem(path),
            svg: input::svg(path)?,
        };
        let usual = if self.extents.short { SHORT_SIDE } else { SIDE };
        Ok(Truth::of_drawing(&drawing, self.side.unwrap_or(usual))?)
    }
}
