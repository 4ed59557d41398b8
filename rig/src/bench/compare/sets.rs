//! The pictures that two programs are compared by, by their kinds.

use std::fs;
use std::path::{Path, PathBuf};

use crate::bench::damages::damaged;
use crate::bench::drawings::picture;
use crate::bench::files::{digest, few, has_ending, named, stem};
use crate::report::Damage;
use crate::report::compare::CompareEntry;
use strokefit::image::Image;
use strokefit::{Error, ErrorKind, Result};

/// Kinds of the samples, in their order.
const KINDS: [&str; 5] = ["photograph", "flat", "lines", "text", "alpha"];

/// Sample pictures, which are drawn with all [`OPTIONS`].
const PICTURES: [(&str, &str); 14] = [
    ("photograph", "coffee-300.png"),
    ("photograph", "chelsea-cat.png"),
    ("photograph", "coffee-550x220.png"),
    ("photograph", "rocket-320.png"),
    ("photograph", "starry-night.jpg"),
    ("lines", "bicycle.png"),
    ("lines", "crayon.jpg"),
    ("text", "dashboard-900.png"),
    ("alpha", "noto-gem.png"),
    ("alpha", "noto-hibiscus.png"),
    ("alpha", "noto-rocket.png"),
    ("alpha", "noto-telescope.png"),
    ("alpha", "glow-300.png"),
    ("alpha", "fade-400.png"),
];

/// Folders of drawings by artists, and the longer side of their pictures, px.
const DRAWINGS: [(&str, &str, u16); 3] = [
    ("flat", "samples/filled", 256),
    ("lines", "samples/icons", 192),
    ("lines", "samples/lines", 256),
];

/// What pictures are drawn with: the defaults, and the drafts of `tests/all/repeatability.rs`.
const OPTIONS: [(&str, &str); 5] = [
    ("", ""),
    ("150 strokes", "--preset draft --look exact --strokes 150"),
    (
        "22 dB in 9 kB",
        "--preset draft --look exact --psnr 22 --bytes 9000",
    ),
    (
        "opaque, progressive, seed 7",
        "--preset draft --look exact --strokes 150 --opaque --progressive --background none --coverage atan:4>smoothstep --precision 1 --seed 7",
    ),
    (
        "100 strokes for the eye",
        "--preset draft --look eye --strokes 100",
    ),
];

/// Drafts of single samples, from the same test: kind, sample, name, command, options.
const SINGLE: [(&str, &str, &str, &str, &str); 7] = [
    (
        "photograph",
        "coffee-300.png",
        "12 colours",
        "fit",
        "--preset draft --look exact --strokes 150 --colors 12",
    ),
    (
        "lines",
        "bicycle.png",
        "6 colours, smallest",
        "fit",
        "--preset draft --look exact --strokes 150 --colors 6 --opaque --form smallest --group color",
    ),
    (
        "alpha",
        "noto-rocket.png",
        "a palette of 4, from tanh",
        "fit",
        "--preset draft --look exact --strokes 150 --palette #fff,#28283c,#dc3c32,#7896c8 --coverage tanh>smoothstep",
    ),
    (
        "alpha",
        "noto-hibiscus.png",
        "opaque on blue, smallest",
        "fit",
        "--preset draft --look exact --strokes 150 --opaque --background #336699 --form smallest --precision 1",
    ),
    (
        "alpha",
        "noto-gem.png",
        "outlines in 20 kB, from sigmoid",
        "fit",
        "--preset draft --look exact --bytes 20000 --coverage sigmoid>smoothstep --outline --precision 3",
    ),
    (
        "alpha",
        "noto-telescope.png",
        "quality 24 in 4 stages, unpolished",
        "fit",
        "--preset draft --look exact --quality 24 --no-polish --stages 4",
    ),
    (
        "photograph",
        "chelsea-cat.png",
        "60 strokes on a traced file",
        "refine tests/data/chelsea-traced.svg",
        "--preset draft --look exact --strokes +60",
    ),
];

/// Kind of the damaged pictures; the number of drawings that are damaged, and the longer side of their pictures, px.
const DAMAGED: &str = "damaged";
const DAMAGED_DRAWINGS: usize = 6;
const DAMAGED_PX: u16 = 128;

/// Longer side of the picture of a drawing that has no picture beside it, px.
const SIDE: u16 = 256;

/// Most cases of a kind in a short run.
const FEW: usize = 16;

/// Endings of the files that a folder stands for.
const ENDINGS: [&str; 4] = ["svg", "png", "jpg", "jpeg"];

/// What is to be compared.
#[derive(Debug, Clone, Default)]
pub struct Wanted {
    /// Folders beside the samples, each a kind of its own, by its name.
    pub folders: Vec<(String, PathBuf)>,
    /// Kinds; all if there are none.
    pub kinds: Vec<String>,
    /// A few cases of each kind.
    pub is_short: bool,
}

/// A picture that a program draws with some options.
#[derive(Debug)]
pub struct Case {
    kind: String,
    name: String,
    /// Words before the picture, and those behind it.
    pub(super) command: Vec<String>,
    pub(super) options: Vec<String>,
    /// The picture's file.
    picture: Option<PathBuf>,
    /// SVG text of its artist, and the longer side of the picture where there is no file of it.
    artist: Option<(String, u16)>,
    damage: Damage,
}

/// A case on which programs can be judged.
pub(super) struct Subject {
    /// The picture to draw.
    pub(super) file: PathBuf,
    /// The picture that a drawing is compared with: before it was damaged.
    pub(super) reference: Image,
    /// SVG text of its artist.
    pub(super) artist: Option<String>,
}

/// The cases that are wanted, kind by kind.
///
/// # Errors
/// When a folder or a file cannot be read.
pub fn cases(wanted: &Wanted) -> anyhow::Result<Vec<Case>> {
    let is_wanted = |kind: &str| wanted.kinds.is_empty() || wanted.kinds.iter().any(|k| k == kind);
    let mut all = Vec::new();
    for kind in KINDS.into_iter().filter(|kind| is_wanted(kind)) {
        let mut cases = Vec::new();
        for (_, sample) in PICTURES.into_iter().filter(|set| set.0 == kind) {
            cases.extend(OPTIONS.map(|(name, words)| drawn(kind, sample, name, "fit", words)));
        }
        for (_, sample, name, command, words) in SINGLE.into_iter().filter(|set| set.0 == kind) {
            cases.push(drawn(kind, sample, name, command, words));
        }
        for (_, folder, side) in DRAWINGS.into_iter().filter(|set| set.0 == kind) {
            cases.extend(in_folder(kind, Path::new(folder), side)?);
        }
        all.push(cases);
    }
    if is_wanted(DAMAGED) {
        let drawings = in_folder(DAMAGED, Path::new(DRAWINGS[0].1), DAMAGED_PX)?;
        let drawings = few(drawings, DAMAGED_DRAWINGS);
        let damages = Damage::ALL.into_iter().filter(|d| *d != Damage::Clean);
        let cases = damages.flat_map(|damage| drawings.iter().map(move |case| case.with(damage)));
        all.push(cases.collect());
    }
    for (kind, folder) in wanted.folders.iter().filter(|(kind, _)| is_wanted(kind)) {
        all.push(in_folder(kind, folder, SIDE)?);
    }
    if wanted.is_short {
        all = all.into_iter().map(|cases| few(cases, FEW)).collect();
    }
    Ok(all.into_iter().flatten().collect())
}

fn words(text: &str) -> Vec<String> {
    text.split_whitespace().map(str::to_owned).collect()
}

/// A sample drawn by a command with options.
fn drawn(kind: &str, sample: &str, name: &str, command: &str, options: &str) -> Case {
    let picture = Path::new("samples").join(sample);
    let name = match name {
        "" => stem(&picture),
        name => format!("{}: {name}", stem(&picture)),
    };
    Case {
        name,
        command: words(command),
        options: words(options),
        ..Case::plain(kind, Some(picture), None)
    }
}

/// The pictures and drawings in a folder, drawn with the defaults. A picture and a drawing of one name are one case.
fn in_folder(kind: &str, folder: &Path, side: u16) -> anyhow::Result<Vec<Case>> {
    let mut cases: Vec<Case> = Vec::new();
    let files = named(&[folder.to_owned()], &ENDINGS)?;
    for (path, _) in files {
        let is_drawing = has_ending(&path, "svg");
        let svg = is_drawing.then(|| strokefit::cli::input::svg(&path));
        let artist = svg.transpose()?.map(|svg| (svg, side));
        let picture = (!is_drawing).then_some(path.clone());
        match cases.iter_mut().find(|case| case.name == stem(&path)) {
            Some(case) => {
                case.picture = case.picture.take().or(picture);
                case.artist = case.artist.take().or(artist);
            }
            None => cases.push(Case {
                name: stem(&path),
                ..Case::plain(kind, picture, artist)
            }),
        }
    }
    Ok(cases)
}

impl Case {
    /// A case without a name, drawn with the defaults.
    fn plain(kind: &str, picture: Option<PathBuf>, artist: Option<(String, u16)>) -> Self {
        Self {
            kind: kind.to_owned(),
            name: String::new(),
            command: words("fit"),
            options: Vec::new(),
            picture,
            artist,
            damage: Damage::Clean,
        }
    }

    fn with(&self, damage: Damage) -> Self {
        Self {
            name: format!("{}: {damage}", self.name),
            damage,
            ..Self::plain(&self.kind, self.picture.clone(), self.artist.clone())
        }
    }

    /// Its record before anything was drawn.
    pub(super) fn entry(&self) -> CompareEntry {
        CompareEntry {
            kind: self.kind.clone(),
            name: self.name.clone(),
            ..CompareEntry::default()
        }
    }

    /// The beginning of the names of its files: other options or another picture have another.
    pub(super) fn file_name(&self) -> String {
        let picture = self.picture.as_ref().and_then(|path| fs::read(path).ok());
        let (artist, side) = self.artist.clone().unwrap_or_default();
        let words = [&self.command[..], &self.options].concat().join(" ");
        let words = format!("{words} {side} {}", self.damage);
        let picture = picture.unwrap_or_default();
        let digest = digest(&[&picture, artist.as_bytes(), words.as_bytes()]);
        let name = format!("{}-{}", self.kind, self.name);
        let name = name.replace(|c: char| !c.is_ascii_alphanumeric(), "-");
        format!("{name}-{digest}")
    }

    /// The pictures of the case. One that has no file yet is written to `folder`.
    pub(super) fn subject(&self, folder: &Path) -> Result<Subject> {
        let reference = match (&self.picture, &self.artist) {
            (Some(path), _) => Image::open(path)?,
            (None, artist) => {
                let (svg, side) = artist.clone().unwrap_or_default();
                picture(&svg, side).map_err(|error| error.within(&self.name))?
            }
        };
        let file = match &self.picture {
            Some(path) if self.damage == Damage::Clean => path.clone(),
            _ => {
                let png = damaged(&reference, self.damage)?.encode_png()?;
                let path = folder.join(self.file_name() + ".png");
                // Another run may read it now.
                if fs::read(&path).ok() != Some(png.clone()) {
                    fs::write(&path, png)
                        .map_err(|e| refuse(format!("cannot write {}: {e}", path.display())))?;
                }
                path
            }
        };
        Ok(Subject {
            file,
            reference,
            artist: self.artist.clone().map(|(svg, _)| svg),
        })
    }
}

pub(super) fn refuse(what: String) -> Error {
    Error::new(ErrorKind::Io, what)
}
