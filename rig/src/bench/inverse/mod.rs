//! Known drawings and clean pictures, and what is found of them in pictures of them, damaged or not.
//!
//! Other programs trace the same pictures, where they are installed.

mod anatomy;
mod belonging;
mod centre_lines;
mod color_difference;
mod displacement;
mod distances;
mod hidden;
pub mod ink;
mod page;

use std::time::Instant;

use super::damages::{common_colors, damaged};
use super::drawings::{Drawing, Kind, picture};
use super::elements::{Element, elements};
use super::gallery::{BRIGHTEST, Gallery, errors};
use super::programs::TunedProgram;
use crate::report::Damage;
use crate::report::cases::{CaseEntry, CasesReport, Contents, OWN};
use anatomy::Anatomy;
use belonging::Things;
use displacement::Areas;
use distances::Distances;
use hidden::Reaches;
use strokefit::fit::{Config, Fitter};
use strokefit::image::Image;
use strokefit::metrics::{Quality, psnr};
use strokefit::scene::Marks;
use strokefit::verify::{self, Size};
use strokefit::{Error, Result};

/// Longer side of the renders whose colours are compared, px.
const LARGE_PX: f64 = 1024.0;

/// Lines that cross, loops, colours over each other, and translucent strokes.
pub fn own() -> Vec<Drawing> {
    let drawing = |(name, strokes): (&str, &str)| Drawing {
        name: name.to_owned(),
        svg: format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="24" height="24" fill="none" stroke-linecap="round" stroke-linejoin="round">{strokes}</svg>"#
        ),
    };
    [
        (
            "crossings",
            r##"<g stroke="#203040" stroke-width="1.5"><path d="M2 5L22 19"/><path d="M3 20L21 4"/><path d="M12 2V22"/></g>"##,
        ),
        (
            "loops",
            r##"<path d="M2 18C8 2 16 2 12 10S4 14 10 18S22 14 22 6" stroke="#803020" stroke-width="1.6"/>"##,
        ),
        (
            "colours",
            r##"<path d="M3 12C8 2 16 22 21 12" stroke="#d03020" stroke-width="2"/><path d="M4 4L20 20" stroke="#2060c0" stroke-width="2.4"/><circle cx="12" cy="12" r="8" stroke="#20a050" stroke-width="1.6"/>"##,
        ),
        (
            "translucent",
            r##"<path d="M3 8H21" stroke="#c02080" stroke-opacity="0.6" stroke-width="4"/><path d="M8 3V21" stroke="#2080c0" stroke-opacity="0.6" stroke-width="4"/>"##,
        ),
    ]
    .map(drawing)
    .into()
}

/// A way to draw pictures with strokefit.
#[derive(Debug, Clone)]
pub struct Drawer {
    /// Name in tables and files.
    name: &'static str,
    /// Its settings.
    config: Config,
}

impl Drawer {
    /// The default.
    pub fn default_fit() -> Self {
        Self {
            name: OWN,
            config: Config::default(),
        }
    }

    /// All ways for drawings of a kind, the default first.
    pub fn all(kind: Kind) -> Vec<Self> {
        let strokes = Self {
            name: "strokefit strokes",
            config: Config {
                marks: Marks::Strokes,
                ..Config::default()
            },
        };
        match kind {
            Kind::Strokes => vec![Self::default_fit()],
            Kind::Shapes => vec![Self::default_fit(), strokes],
        }
    }
}

/// A clean picture, and what is known of its artist's file.
pub struct Truth {
    name: String,
    picture: Image,
    /// Number of colours that a program is told to draw with.
    colors: usize,
    artist: Option<Artist>,
}

/// The file of an artist, in a picture of one size.
struct Artist {
    family: String,
    contents: Contents,
    /// Its elements, px of the picture.
    elements: Vec<Element>,
    /// Large render on white.
    large: Image,
    /// Fidelity of the file to the picture, dB.
    db: f64,
    areas: Areas,
    things: Things,
    /// `None` if there are too many elements.
    reaches: Option<Reaches>,
}

impl Truth {
    /// A picture on white.
    pub fn of_picture(name: String, picture: &Image) -> Self {
        let picture = picture.flattened([1.0; 3]);
        Self {
            name,
            colors: common_colors(&picture).len().max(2),
            picture,
            artist: None,
        }
    }

    /// The picture of a drawing on white, its longer side as many px.
    ///
    /// # Errors
    /// [`ErrorKind::Svg`](strokefit::ErrorKind::Svg) when a drawing is no SVG; the message names it.
    pub fn of_drawing(drawing: &Drawing, side: u16) -> Result<Self> {
        Self::drawn(drawing, side).map_err(|error| error.within(&drawing.name))
    }

    fn drawn(drawing: &Drawing, side: u16) -> Result<Self> {
        let svg = &drawing.svg;
        let picture = picture(svg, side)?;
        let areas = Areas::of(svg, picture.width(), picture.height())?;
        Ok(Self {
            name: drawing.name.clone(),
            colors: areas.colors().max(2),
            artist: Some(Artist {
                family: drawing.family().to_owned(),
                contents: contents(svg)?,
                elements: elements(svg, f32::from(side))?,
                large: large(svg)?,
                db: decibels(svg, &picture)?,
                areas,
                things: Things::of(svg, exactly(&picture))?,
                reaches: Reaches::of(svg, exactly(&picture))?,
            }),
            picture,
        })
    }

    fn side_px(&self) -> usize {
        self.picture.width().max(self.picture.height())
    }
}

/// A result as it comes.
#[derive(Debug, Clone, Copy)]
pub struct Outcome<'a> {
    /// Its record.
    pub entry: &'a CaseEntry,
    /// The picture that was drawn.
    pub picture: &'a Image,
    /// The SVG that was made of it; empty where none was.
    pub svg: &'a str,
}

/// Draws the pictures of `truths` with each damage, by each of `ours` and of `peers`, and tells each result as it comes.
///
/// # Errors
/// Those of `truths` and of `tell`. A picture of which no SVG is made is a failure in the report.
pub fn run(
    truths: impl IntoIterator<Item = Result<Truth>>,
    damages: &[Damage],
    ours: &[Drawer],
    peers: &[TunedProgram],
    tell: &mut dyn FnMut(Outcome<'_>) -> Result<()>,
) -> Result<CasesReport> {
    let mut entries = Vec::new();
    for truth in truths {
        let truth = truth?;
        for &damage in damages {
            let case = Case::new(&truth, damage)?;
            let drawn = ours.iter().map(|drawer| case.drawn(drawer));
            for (entry, svg) in drawn.chain(peers.iter().map(|peer| case.traced(peer))) {
                tell(Outcome {
                    entry: &entry,
                    picture: &case.picture,
                    svg: &svg,
                })?;
                entries.push(entry);
            }
        }
    }
    Ok(CasesReport::new(entries))
}

/// Shows a result in a gallery: the picture, the drawing, and of ours the centre lines, or else the errors.
///
/// # Errors
/// As [`verify::render`].
pub fn show(gallery: &mut Gallery, outcome: Outcome<'_>) -> Result<()> {
    let Outcome {
        entry,
        picture,
        svg,
    } = outcome;
    if entry.failure.is_some() {
        return Ok(());
    }
    let beside = entry
        .original
        .map(|original| format!(" of {}", original.elements));
    let caption = format!(
        "{}{}, {:.1} dB",
        entry.found.elements,
        beside.unwrap_or_default(),
        entry.truth_db.unwrap_or(f64::NAN)
    );
    let title = format!("{}, {}", entry.drawing, entry.kind());
    gallery.show(entry, [&title, &caption], svg, picture)?;
    if !entry.is_own() {
        return Ok(());
    }
    if let Some(px) = entry.mean_px {
        let lines = centre_lines::centre_lines(svg, picture)?;
        return gallery.add(&format!("{px:.2} px off"), &lines);
    }
    let edges = entry
        .displacement_px
        .map(|px| format!(", edges {px:.3} px off"));
    let title = format!(
        "errors × {:.0}{}",
        1.0 / BRIGHTEST,
        edges.unwrap_or_default()
    );
    let drawn = verify::render_like(svg, picture, [1.0; 3])?;
    gallery.add(&title, &errors(picture, &drawn)?)
}

/// A picture with a damage.
struct Case<'a> {
    truth: &'a Truth,
    damage: Damage,
    picture: Image,
}

impl<'a> Case<'a> {
    fn new(truth: &'a Truth, damage: Damage) -> Result<Self> {
        let picture = damaged(&truth.picture, damage);
        Ok(Self {
            truth,
            damage,
            picture: picture.map_err(|error| error.within(&truth.name))?,
        })
    }

    /// Our drawing, with the damage that was recognised.
    fn drawn(&self, drawer: &Drawer) -> (CaseEntry, String) {
        self.timed(drawer.name, || {
            let fit = Fitter::new(drawer.config.clone()).fit(&self.picture)?;
            Ok((fit.svg(), fit.damage.map(|damage| damage.to_string())))
        })
    }

    fn traced(&self, peer: &TunedProgram) -> (CaseEntry, String) {
        self.timed(peer.program.name, || {
            let svg = peer.trace(&self.picture, self.truth.colors)?;
            Ok((self.with_width(svg)?, None))
        })
    }

    /// The SVG of a peer that tells no widths of its strokes, told the median of those of the drawing, with round ends and joins.
    fn with_width(&self, svg: String) -> Result<String> {
        let artist = self.truth.artist.iter().flat_map(|artist| &artist.elements);
        let mut widths: Vec<f32> = artist.filter_map(|e| e.width_px).collect();
        widths.sort_by(f32::total_cmp);
        let Some(width_px) = widths.get(widths.len() / 2) else {
            return Ok(svg);
        };
        let has_strokes = elements(&svg, 1.0)?.iter().any(|e| e.width_px.is_some());
        if !has_strokes || svg.contains("stroke-width") {
            return Ok(svg);
        }
        let look = format!(
            r#"<svg stroke-width="{width_px:.2}" stroke-linecap="round" stroke-linejoin="round" "#
        );
        Ok(svg.replacen("<svg ", &look, 1))
    }

    /// The record of what `draw` makes, and its SVG; where it fails, the record with the failure, and no SVG.
    fn timed(
        &self,
        by: &str,
        draw: impl FnOnce() -> Result<(String, Option<String>)>,
    ) -> (CaseEntry, String) {
        let began = Instant::now();
        let judged = draw().and_then(|(svg, recognised)| {
            let wall_s = Some(began.elapsed().as_secs_f64());
            let entry = CaseEntry {
                recognised,
                wall_s,
                ..self.judged(by, &svg)?
            };
            Ok((entry, svg))
        });
        judged.unwrap_or_else(|error: Error| {
            let failure = Some(error.to_string());
            let entry = self.entry(by);
            (CaseEntry { failure, ..entry }, String::new())
        })
    }

    /// The record of this case before anything is known of what was found.
    fn entry(&self, by: &str) -> CaseEntry {
        let artist = self.truth.artist.as_ref();
        CaseEntry {
            drawing: self.truth.name.clone(),
            family: artist.map_or_else(String::new, |artist| artist.family.clone()),
            by: by.to_owned(),
            side_px: self.truth.side_px(),
            damage: self.damage,
            original: artist.map(|artist| artist.contents),
            artist_db: artist.map(|artist| artist.db),
            ..CaseEntry::default()
        }
    }

    fn judged(&self, by: &str, svg: &str) -> Result<CaseEntry> {
        // The clean picture has the size of the damaged one.
        let drawn = verify::render_like(svg, &self.picture, [1.0; 3])?;
        let seen = Quality::between(&self.truth.picture, &drawn)?;
        let mut entry = CaseEntry {
            found: contents(svg)?,
            ssimulacra2: Some(seen.ssimulacra2),
            details_kept: seen.details_kept,
            page_levels: page::levels(&drawn, &self.picture),
            psnr_db: Some(psnr(&self.picture, &drawn)?),
            truth_db: Some(seen.psnr_db),
            input_db: Some(psnr(&self.truth.picture, &self.picture)?),
            ..self.entry(by)
        };
        let Some(artist) = &self.truth.artist else {
            return Ok(entry);
        };
        let found = elements(svg, self.truth.side_px() as f32)?;
        let apart = Distances::between(&artist.elements, &found);
        // Where strokes alone were drawn, the strokes that were found are compared with them.
        let strokes = found.iter().filter(|e| e.width_px.is_some());
        if apart.is_some()
            && artist
                .elements
                .iter()
                .all(|e| e.width_px.is_some() && !e.filled)
        {
            count(&mut entry.found, strokes);
        }
        Ok(CaseEntry {
            delta_e: Some(delta_e(&artist.large, svg)?),
            displacement_px: artist.areas.displacement_px(svg)?,
            belonging: artist.things.belonging(svg)?,
            hidden: match &artist.reaches {
                Some(reaches) => reaches.hidden(svg)?,
                None => None,
            },
            mean_px: apart.map(|apart| apart.mean),
            largest_px: apart.map(|apart| apart.largest),
            ..entry
        })
    }
}

/// The large render of an artist's drawing, on white.
pub(super) fn large(svg: &str) -> Result<Image> {
    let own = verify::render(svg, Size::Scale(1.0), None)?;
    let scale = LARGE_PX / own.width().max(own.height()) as f64;
    verify::render(svg, Size::Scale(scale), Some([1.0; 3]))
}

/// Mean colour difference (ΔE00) of SVG text to the large render of its artist's drawing.
pub(super) fn delta_e(large: &Image, svg: &str) -> Result<f64> {
    let drawn = verify::render(svg, exactly(large), Some([1.0; 3]))?;
    Ok(color_difference::mean(large, &drawn))
}

fn exactly(picture: &Image) -> Size {
    let side = |px: usize| u32::try_from(px).unwrap_or(u32::MAX);
    Size::Exact {
        width: side(picture.width()),
        height: side(picture.height()),
    }
}

/// Fidelity of SVG text to a picture on white, dB.
fn decibels(svg: &str, picture: &Image) -> Result<f64> {
    psnr(picture, &verify::render_like(svg, picture, [1.0; 3])?)
}

/// Contents of SVG text.
pub(super) fn contents(svg: &str) -> Result<Contents> {
    let anatomy = Anatomy::of(svg)?;
    let painted = elements(svg, 1.0)?;
    let painted = &painted[usize::from(anatomy.has_page).min(painted.len())..];
    let mut contents = Contents {
        parameters: anatomy.parameters,
        numbers: anatomy.numbers,
        bytes: svg.len(),
        ..Contents::default()
    };
    count(&mut contents, painted.iter());
    Ok(contents)
}

/// Sets the numbers of elements, rings and points.
fn count<'a>(contents: &mut Contents, elements: impl Iterator<Item = &'a Element> + Clone) {
    contents.elements = elements.clone().count();
    contents.rings = elements.clone().map(|element| element.lines.len()).sum();
    contents.points = elements.map(|element| element.points).sum();
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRAWING: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="32" height="32"><rect width="32" height="32" fill="#fff"/><path fill="#d03020" d="M2 2h28v28h-28zM8 8v16h16V8z"/><circle cx="16" cy="16" r="4"/><path id="unpainted" fill="none" d="M0 0L9 9"/></svg>"##;

    fn truth(side: u16) -> Truth {
        let drawing = Drawing {
            name: "box__a".into(),
            svg: DRAWING.into(),
        };
        Truth::of_drawing(&drawing, side).unwrap()
    }

    #[test]
    fn painted_elements_are_counted_without_the_page() {
        let expected = Contents {
            elements: 2,
            rings: 3,
            points: 8 + 13,
            parameters: 12 + 3 + 2,
            numbers: (2 + 3) + (2 + 3) + 3 + 3 + 4,
            bytes: DRAWING.len(),
        };
        assert_eq!(contents(DRAWING).unwrap(), expected);
    }

    #[test]
    fn a_drawing_is_judged_beside_its_artist() {
        let truth = truth(32);
        let case = Case::new(&truth, Damage::Clean).unwrap();
        let itself = case.judged(OWN, DRAWING).unwrap();
        assert_eq!(Some(itself.found), itself.original);
        assert_eq!(itself.truth_db, itself.artist_db);
        assert_eq!(
            (itself.delta_e, itself.displacement_px, itself.mean_px),
            (Some(0.0), Some(0.0), None)
        );
        let moved = DRAWING.replace("M2 2", "M2.5 2");
        let moved = case.judged(OWN, &moved).unwrap();
        assert!(moved.delta_e > Some(0.1) && moved.truth_db < itself.truth_db);
        assert!(moved.displacement_px > Some(0.1), "{moved:?}");
        let (failed, svg) = case.timed(OWN, || Ok(("no SVG".into(), None)));
        assert!(failed.failure.is_some() && svg.is_empty());
    }

    #[test]
    fn a_drawing_is_judged_by_the_clean_picture_and_by_its_input() {
        let truth = truth(64);
        let case = Case::new(&truth, Damage::Noise(8)).unwrap();
        let (entry, _) = case.timed(OWN, || Ok((DRAWING.into(), None)));
        let (truth_db, input_db) = (entry.truth_db.unwrap(), entry.input_db.unwrap());
        assert!(
            truth_db > 40.0 && (28.0..36.0).contains(&input_db),
            "{entry:?}"
        );
        assert!((entry.psnr_db.unwrap() - input_db).abs() < 0.8);
    }

    #[test]
    fn what_is_no_drawing_is_refused_by_name() {
        let drawing = Drawing {
            name: "blank".into(),
            svg: "no SVG".into(),
        };
        let words = Truth::of_drawing(&drawing, 96).err().unwrap().to_string();
        assert!(words.starts_with("blank: "), "{words}");
    }
}
