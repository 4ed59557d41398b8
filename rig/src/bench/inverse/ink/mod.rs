//! Drawings in ink, of lines whose width varies: which of them come back as one element each?
//!
//! `kinds` draws them, `line` makes their pictures, and `score` compares what is found with the truth.

mod kinds;
mod line;
mod score;

use std::path::Path;
use std::time::Instant;

use super::Drawer;
use super::anatomy::Anatomy;
use crate::bench::elements::elements;
use crate::bench::files::stem;
use crate::bench::gallery::Gallery;
use crate::bench::programs::TunedProgram;
use crate::report::OWN;
use crate::report::ink::{InkEntry, InkReport};
use kinds::{Dice, KINDS, pressed};
use line::Line;
use score::{Elements, Truth};
use strokefit::fit::Fitter;
use strokefit::image::Image;
use strokefit::metrics::Quality;
use strokefit::verify;
use strokefit::{Error, ErrorKind, Result};

/// Ink and page.
const COLORS: usize = 2;

/// Side of the pictures of glyphs that are read, px: four times that of `KanjiVG`'s box.
const GLYPH_PX: u16 = 436;

/// A picture, and the lines that are in it.
pub struct Drawing {
    name: String,
    kind: String,
    picture: Image,
    lines: Vec<Line>,
}

impl Drawing {
    /// So many drawings of each kind.
    pub fn own(count: usize) -> impl Iterator<Item = Result<Self>> {
        let of = move |kind: &'static kinds::Kind| {
            (1..=count).map(|number| {
                let (lines, size) = kind.drawing(number);
                Self::drawn(kind.name, &number.to_string(), lines, size)
            })
        };
        KINDS.iter().flat_map(of)
    }

    /// The glyph of an SVG of centre lines, such as one of `KanjiVG`, drawn with a brush.
    ///
    /// # Errors
    /// [`ErrorKind::Svg`] when it is no SVG or has no lines.
    pub fn glyph(name: &str, svg: &str, number: usize) -> Result<Self> {
        let strokes = elements(svg, f32::from(GLYPH_PX))?;
        let centres = strokes.into_iter().flat_map(|stroke| stroke.lines);
        let centres: Vec<_> = centres.filter(|line| line.len() > 1).collect();
        if centres.is_empty() {
            let message = format!("{name}: no lines: give SVGs of centre lines, as KanjiVG's");
            return Err(Error::new(ErrorKind::Svg, message));
        }
        let lines = pressed(&mut Dice::new("kanji", number), &centres);
        Self::drawn("kanji", name, lines, [usize::from(GLYPH_PX); 2])
    }

    fn drawn(kind: &str, name: &str, lines: Vec<Line>, size: [usize; 2]) -> Result<Self> {
        Ok(Self {
            name: format!("{kind}-{name}"),
            kind: kind.to_owned(),
            picture: line::picture(&lines, size)?,
            lines,
        })
    }

    /// A picture whose lines are in a file beside it: `NAME.truth.json` or `NAME.json`.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when that cannot be read, [`ErrorKind::Config`] when it is no list of lines.
    pub fn given(path: &Path, picture: &Image) -> Result<Self> {
        let beside = path.with_extension("truth.json");
        let lines = if beside.exists() {
            line::read(&beside)
        } else {
            line::read(&path.with_extension("json"))
        };
        let name = stem(path);
        Ok(Self {
            kind: name.split(['-', '.']).next().unwrap_or_default().to_owned(),
            name,
            picture: picture.flattened([1.0; 3]),
            lines: lines?,
        })
    }

    /// Its name in files.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The picture.
    pub fn picture(&self) -> &Image {
        &self.picture
    }

    /// Its lines as JSON: a list of lines, each a list of `[x, y, half the width]` in px.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when a number is not finite.
    pub fn truth(&self) -> Result<String> {
        serde_json::to_string(&self.lines)
            .map_err(|e| Error::new(ErrorKind::Config, format!("{}: {e}", self.name)))
    }

    fn size(&self) -> [usize; 2] {
        [self.picture.width(), self.picture.height()]
    }
}

/// A result as it comes.
pub struct Outcome<'a> {
    /// Its record.
    pub entry: &'a InkEntry,
    /// What was drawn.
    pub drawing: &'a Drawing,
    /// The SVG that was made of it; empty where none was.
    pub svg: &'a str,
    elements: Option<Elements>,
}

impl Outcome<'_> {
    /// Shows it: the picture, the file, and its elements, each in a colour of its own.
    ///
    /// # Errors
    /// As [`verify::render`].
    pub fn show(&self, gallery: &mut Gallery) -> Result<()> {
        let Some((elements, found)) = self.elements.as_ref().zip(self.entry.found) else {
            return Ok(());
        };
        let Drawing { name, picture, .. } = self.drawing;
        let lines = self.entry.lines;
        gallery.row(&format!("{name}, {lines} lines"), picture)?;
        let db = self.entry.psnr_db.unwrap_or(f64::NAN);
        gallery.add_drawing(&format!("{}, {db:.1} dB", self.entry.by), self.svg, picture)?;
        let title = format!("{} elements, {} whole", found.elements, found.whole);
        gallery.add(&title, &elements.in_colors()?)
    }
}

/// Draws the pictures of `drawings` by ourselves and by `peers`, and tells each result as it comes.
///
/// # Errors
/// Those of `drawings` and of `tell`. A picture of which no SVG is made is a failure in the report.
pub fn run(
    drawings: impl IntoIterator<Item = Result<Drawing>>,
    ours: &Drawer,
    peers: &[TunedProgram],
    tell: &mut dyn FnMut(&Outcome<'_>) -> Result<()>,
) -> Result<InkReport> {
    let mut entries = Vec::new();
    for drawing in drawings {
        let drawing = drawing?;
        let truth = Truth::of(&drawing.lines, drawing.size());
        let fit = || {
            Ok(Fitter::new(ours.config.clone())
                .fit(&drawing.picture)?
                .svg())
        };
        let mut judge = |by: &str, draw: &dyn Fn() -> Result<String>| {
            let mut entry = InkEntry {
                drawing: drawing.name.clone(),
                kind: drawing.kind.clone(),
                by: by.to_owned(),
                lines: drawing.lines.len(),
                ..InkEntry::default()
            };
            let began = Instant::now();
            let drawn = draw().and_then(|svg| {
                entry.wall_s = Some(began.elapsed().as_secs_f64());
                let elements = judged(&mut entry, &svg, &drawing, &truth)?;
                Ok((svg, elements))
            });
            let (svg, elements) = match drawn {
                Ok((svg, elements)) => (svg, Some(elements)),
                Err(error) => {
                    entry.failure = Some(error.to_string());
                    (String::new(), None)
                }
            };
            tell(&Outcome {
                entry: &entry,
                drawing: &drawing,
                svg: &svg,
                elements,
            })?;
            entries.push(entry);
            Ok::<(), Error>(())
        };
        judge(OWN, &fit)?;
        for peer in peers {
            judge(peer.program.name, &|| peer.trace(&drawing.picture, COLORS))?;
        }
    }
    Ok(InkReport::new(entries))
}

/// Sets what is known of SVG text of a drawing; its elements.
fn judged(
    entry: &mut InkEntry,
    svg: &str,
    drawing: &Drawing,
    truth: &Truth<'_>,
) -> Result<Elements> {
    let seen = verify::render_like(svg, &drawing.picture, [1.0; 3])?;
    let seen = Quality::between(&drawing.picture, &seen)?;
    let elements = Elements::of(svg, drawing.size())?;
    entry.found = Some(truth.found(&elements));
    entry.numbers = Anatomy::of(svg)?.line_numbers;
    entry.bytes = svg.len();
    entry.psnr_db = Some(seen.psnr_db);
    entry.ssimulacra2 = Some(seen.ssimulacra2);
    Ok(elements)
}
