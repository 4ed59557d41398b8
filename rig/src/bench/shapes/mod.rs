//! Drawings of any kind by their artists, and what is found of them in their pictures.
//!
//! Other programs trace the same pictures, where they are installed.

mod anatomy;
mod belonging;
mod color_difference;
mod displacement;

use std::time::Instant;

use super::damages::damaged;
use super::drawings::{self, Drawing, Pictures, attempt, picture, record, side_nearest};
use super::gallery::{BRIGHTEST, Gallery, PANEL_PX, errors};
use super::peers::TunedPeer;
use crate::report::Damage;
use crate::report::cases::{Case as _, OWN};
use crate::report::shapes::{Contents, ShapesEntry, ShapesReport};
use anatomy::Anatomy;
use belonging::Things;
use displacement::Areas;
use strokefit::fit::{Config, Fitter};
use strokefit::image::Image;
use strokefit::metrics::psnr;
use strokefit::scene::Marks;
use strokefit::verify::{self, Size, elements};
use strokefit::{Error, Result};

/// Longer side of the renders whose colours are compared, px.
const LARGE_PX: f64 = 1024.0;

/// A way to draw pictures with strokefit.
#[derive(Debug, Clone)]
pub struct Drawer {
    /// Name in tables and files.
    pub name: &'static str,
    /// Its settings.
    pub config: Config,
}

/// All ways of ours, the default first.
pub fn drawers() -> Vec<Drawer> {
    let strokes = Config {
        marks: Marks::Strokes,
        ..Config::default()
    };
    vec![
        Drawer {
            name: OWN,
            config: Config::default(),
        },
        Drawer {
            name: "strokefit strokes",
            config: strokes,
        },
    ]
}

/// A few of the drawings, at most so many, from all over the list.
pub fn few<T>(all: Vec<T>, most: usize) -> Vec<T> {
    let step = all.len().div_ceil(most).max(1);
    all.into_iter().step_by(step).collect()
}

/// A result as it comes.
pub type Outcome<'a> = drawings::Outcome<'a, ShapesEntry>;

/// Shows a result in a gallery, if it is of a clean picture of the size nearest to that of a panel: the picture, the drawing, and
/// the errors of ours.
///
/// # Errors
/// As [`verify::render`].
pub fn show(gallery: &mut Gallery, outcome: Outcome<'_>, sides: &[u16]) -> Result<()> {
    let entry = outcome.entry;
    let is_shown = entry.side_px == side_nearest(sides, PANEL_PX) && entry.damage == Damage::Clean;
    if !is_shown || entry.failure.is_some() {
        return Ok(());
    }
    let title = format!("{}, {} px", entry.drawing, entry.side_px);
    let [found, of] = entry.elements();
    let db = entry.truth_db.unwrap_or(f64::NAN);
    gallery.show(outcome, &title, &format!("{found} of {of}, {db:.1} dB"))?;
    if !entry.is_own() {
        return Ok(());
    }
    let drawn = verify::render_like(outcome.svg, outcome.picture, [1.0; 3])?;
    let edges = entry.displacement_px.unwrap_or(f64::NAN);
    let title = format!("errors × {:.0}, edges {edges:.3} px off", 1.0 / BRIGHTEST);
    gallery.add(&title, &errors(outcome.picture, &drawn)?)
}

/// Draws the pictures of all drawings in each of our ways and by each of `peers`, telling each result as it comes.
///
/// # Errors
/// - [`ErrorKind::Svg`](strokefit::ErrorKind::Svg) when a drawing is no SVG; the message names it.
/// - As `tell`. A picture of which no SVG is made is a failure in the report.
pub fn run(
    drawings: &[Drawing],
    pictures: &Pictures,
    ours: &[Drawer],
    peers: &[TunedPeer],
    tell: &mut dyn FnMut(Outcome<'_>) -> Result<()>,
) -> Result<ShapesReport> {
    let mut entries = Vec::new();
    for drawing in drawings {
        let within = |error: Error| error.within(&drawing.name);
        let original = Original::new(drawing).map_err(within)?;
        for &side in &pictures.sides {
            let truth = Truth::new(&original, side).map_err(within)?;
            for &damage in &pictures.damages {
                let case = Case::new(&truth, damage).map_err(within)?;
                let found = ours.iter().map(|drawer| case.drawn(drawer));
                record(
                    found.chain(peers.iter().map(|peer| case.traced(peer))),
                    &case.picture,
                    tell,
                    &mut entries,
                )?;
            }
        }
    }
    Ok(ShapesReport::new(entries))
}

/// A drawing as its artist made it.
struct Original<'a> {
    drawing: &'a Drawing,
    contents: Contents,
    /// On white.
    large: Image,
}

impl<'a> Original<'a> {
    fn new(drawing: &'a Drawing) -> Result<Self> {
        Ok(Self {
            drawing,
            contents: contents(&drawing.svg)?,
            large: large(&drawing.svg)?,
        })
    }
}

/// A drawing in a picture of one size.
struct Truth<'a> {
    original: &'a Original<'a>,
    side: u16,
    picture: Image,
    /// Fidelity of the artist's file, dB.
    artist_db: f64,
    areas: Areas,
    things: Things,
}

impl<'a> Truth<'a> {
    fn new(original: &'a Original<'a>, side: u16) -> Result<Self> {
        let svg = &original.drawing.svg;
        let picture = picture(svg, side)?;
        Ok(Self {
            original,
            side,
            artist_db: decibels(svg, &picture)?,
            areas: Areas::of(svg, picture.width(), picture.height())?,
            things: Things::of(svg, exactly(&picture))?,
            picture,
        })
    }
}

/// One picture of a drawing.
struct Case<'a> {
    truth: &'a Truth<'a>,
    damage: Damage,
    picture: Image,
}

impl<'a> Case<'a> {
    fn new(truth: &'a Truth<'a>, damage: Damage) -> Result<Self> {
        Ok(Self {
            truth,
            damage,
            picture: damaged(&truth.picture, damage)?,
        })
    }

    fn drawn(&self, drawer: &Drawer) -> (ShapesEntry, String) {
        self.timed(drawer.name, || {
            let fit = Fitter::new(drawer.config.clone()).fit(&self.picture)?;
            Ok(fit.svg())
        })
    }

    fn traced(&self, peer: &TunedPeer) -> (ShapesEntry, String) {
        self.timed(peer.name(), || {
            let colors = self.truth.areas.colors();
            Ok(peer.trace(&self.picture, colors)?.svg)
        })
    }

    /// The record of what `draw` makes, and its SVG; empty if it fails.
    fn timed(&self, by: &str, draw: impl FnOnce() -> Result<String>) -> (ShapesEntry, String) {
        let began = Instant::now();
        let judge = |svg: String| {
            let wall_s = began.elapsed().as_secs_f64();
            Ok((self.judged(by, &svg, wall_s)?, svg))
        };
        attempt(
            || draw().and_then(judge),
            |failure| ShapesEntry {
                failure,
                ..self.entry(by)
            },
        )
    }

    /// The record of this case before anything is known of what was found.
    fn entry(&self, by: &str) -> ShapesEntry {
        let original = self.truth.original;
        ShapesEntry {
            drawing: original.drawing.name.clone(),
            family: original.drawing.family().to_owned(),
            by: by.to_owned(),
            side_px: usize::from(self.truth.side),
            damage: self.damage,
            original: original.contents,
            artist_db: Some(self.truth.artist_db),
            ..ShapesEntry::default()
        }
    }

    fn judged(&self, by: &str, svg: &str, wall_s: f64) -> Result<ShapesEntry> {
        Ok(ShapesEntry {
            found: contents(svg)?,
            psnr_db: Some(decibels(svg, &self.picture)?),
            truth_db: Some(decibels(svg, &self.truth.picture)?),
            delta_e: Some(delta_e(&self.truth.original.large, svg)?),
            displacement_px: self.truth.areas.displacement_px(svg)?,
            belonging: self.truth.things.belonging(svg)?,
            wall_s: Some(wall_s),
            ..self.entry(by)
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
    Ok(Contents {
        elements: painted.len(),
        rings: painted.iter().map(|element| element.lines.len()).sum(),
        points: painted.iter().map(|element| element.points).sum(),
        parameters: anatomy.parameters,
        numbers: anatomy.numbers,
        bytes: svg.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRAWING: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="32" height="32"><rect width="32" height="32" fill="#fff"/><path fill="#d03020" d="M2 2h28v28h-28zM8 8v16h16V8z"/><circle cx="16" cy="16" r="4"/><path id="unpainted" fill="none" d="M0 0L9 9"/></svg>"##;

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
    fn a_few_are_from_all_over_the_list() {
        assert_eq!(few(vec![0, 1], 6), [0, 1]);
        assert_eq!(few((0..12).collect(), 6), [0, 2, 4, 6, 8, 10]);
        assert!(few(Vec::<usize>::new(), 6).is_empty());
    }

    #[test]
    fn a_drawing_is_judged_beside_its_artist() {
        let drawing = Drawing {
            name: "box__a".into(),
            svg: DRAWING.into(),
        };
        let original = Original::new(&drawing).unwrap();
        let truth = Truth::new(&original, 32).unwrap();
        let case = Case::new(&truth, Damage::Clean).unwrap();
        let itself = case.judged(OWN, DRAWING, 0.0).unwrap();
        assert_eq!(itself.found, itself.original);
        assert_eq!(itself.truth_db, itself.artist_db);
        assert_eq!(
            (itself.delta_e, itself.displacement_px),
            (Some(0.0), Some(0.0))
        );
        let moved = DRAWING.replace("M2 2", "M2.5 2");
        let moved = case.judged(OWN, &moved, 0.0).unwrap();
        assert!(moved.delta_e > Some(0.1) && moved.truth_db < itself.truth_db);
        assert!(moved.displacement_px > Some(0.1), "{moved:?}");
        let (failed, svg) = case.timed(OWN, || Ok("no SVG".into()));
        assert!(failed.failure.is_some() && svg.is_empty());
    }
}
