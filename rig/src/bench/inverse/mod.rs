//! Drawings of known strokes, and what is found of them in their pictures.
//!
//! Other programs that draw lines trace the same pictures, where they are installed.

mod centre_lines;
mod distances;

use std::collections::BTreeSet;
use std::time::Instant;

use super::damages::damaged;
use super::drawings::{self, Drawing, Pictures, attempt, picture, record, side_nearest};
use super::gallery::{Gallery, PANEL_PX};
use super::peers::TunedPeer;
use crate::report::Damage;
use crate::report::cases::{Case as _, OWN};
use crate::report::inverse::{Inventory, InverseEntry, InverseReport};
use distances::Distances;
use strokefit::fit::{Config, Fitter};
use strokefit::image::Image;
use strokefit::verify::{self, Element, elements};
use strokefit::{Error, ErrorKind, Result};

/// Lines that cross, loops, colours over each other, and translucent strokes.
pub fn own() -> Vec<Drawing> {
    let drawing = |name: &str, strokes: &str| Drawing {
        name: name.to_owned(),
        svg: format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="24" height="24" fill="none" stroke-linecap="round" stroke-linejoin="round">{strokes}</svg>"#
        ),
    };
    vec![
        drawing(
            "crossings",
            r##"<g stroke="#203040" stroke-width="1.5"><path d="M2 5L22 19"/><path d="M3 20L21 4"/><path d="M12 2V22"/></g>"##,
        ),
        drawing(
            "loops",
            r##"<path d="M2 18C8 2 16 2 12 10S4 14 10 18S22 14 22 6" stroke="#803020" stroke-width="1.6"/>"##,
        ),
        drawing(
            "colours",
            r##"<path d="M3 12C8 2 16 22 21 12" stroke="#d03020" stroke-width="2"/><path d="M4 4L20 20" stroke="#2060c0" stroke-width="2.4"/><circle cx="12" cy="12" r="8" stroke="#20a050" stroke-width="1.6"/>"##,
        ),
        drawing(
            "translucent",
            r##"<path d="M3 8H21" stroke="#c02080" stroke-opacity="0.6" stroke-width="4"/><path d="M8 3V21" stroke="#2080c0" stroke-opacity="0.6" stroke-width="4"/>"##,
        ),
    ]
}

/// A result as it comes.
pub type Outcome<'a> = drawings::Outcome<'a, InverseEntry>;

/// Shows a result in a gallery, if it is of a clean picture of the size nearest to that of a panel: the picture, the drawing, and
/// the centre lines of ours.
///
/// # Errors
/// As [`verify::render`].
pub fn show(gallery: &mut Gallery, outcome: Outcome<'_>, sides: &[u16]) -> Result<()> {
    let entry = outcome.entry;
    let is_shown =
        entry.side_px == side_nearest(sides, PANEL_PX) && entry.damage() == Damage::Clean;
    if !is_shown || entry.failure.is_some() {
        return Ok(());
    }
    let title = format!("{}, {} px", entry.drawing, entry.side_px);
    let [found, of] = entry.elements();
    let db = entry.psnr_db.unwrap_or(f64::NAN);
    gallery.show(outcome, &title, &format!("{found} of {of}, {db:.1} dB"))?;
    if !entry.is_own() {
        return Ok(());
    }
    let apart = entry.mean_px.map(|px| format!("{px:.2} px off"));
    let apart = apart.unwrap_or_else(|| "no centre lines".into());
    let lines = centre_lines::centre_lines(outcome.svg, outcome.picture)?;
    gallery.add(&apart, &lines)
}

/// Fits the pictures of all drawings and has `peers` trace them, telling each result as it comes.
///
/// # Errors
/// - [`ErrorKind::Svg`] when a drawing is no SVG or has no stroke; the message names it.
/// - As [`Fitter::fit`], and as `tell`. A peer that makes no SVG is a failure in the report.
pub fn run(
    drawings: &[Drawing],
    pictures: &Pictures,
    peers: &[TunedPeer],
    config: &Config,
    tell: &mut dyn FnMut(Outcome<'_>) -> Result<()>,
) -> Result<InverseReport> {
    let mut entries = Vec::new();
    for &damage in &pictures.damages {
        for &side in &pictures.sides {
            for drawing in drawings {
                let within = |error: Error| error.within(&drawing.name);
                let case = Case::new(drawing, side, damage).map_err(within)?;
                let mut found = vec![case.fitted(config).map_err(within)?];
                found.extend(peers.iter().map(|peer| case.traced(peer)));
                record(found, &case.picture, tell, &mut entries)?;
            }
        }
    }
    Ok(InverseReport::new(entries))
}

/// One picture of a drawing.
struct Case<'a> {
    drawing: &'a Drawing,
    side: u16,
    damage: Damage,
    original: Vec<Element>,
    picture: Image,
}

impl<'a> Case<'a> {
    fn new(drawing: &'a Drawing, side: u16, damage: Damage) -> Result<Self> {
        let mut original = elements(&drawing.svg, f32::from(side))?;
        original.retain(|element| element.width_px.is_some());
        if original.is_empty() {
            let message = "no element has a stroke, so that nothing could be found again: give drawings of strokes";
            return Err(Error::new(ErrorKind::Svg, message));
        }
        Ok(Self {
            drawing,
            side,
            damage,
            original,
            picture: damaged(&picture(&drawing.svg, side)?, damage)?,
        })
    }

    fn fitted(&self, config: &Config) -> Result<(InverseEntry, String)> {
        let began = Instant::now();
        let fit = Fitter::new(config.clone()).fit(&self.picture)?;
        let wall_s = began.elapsed().as_secs_f64();
        let svg = fit.svg();
        Ok((self.judged(OWN, &svg, wall_s)?, svg))
    }

    fn traced(&self, peer: &TunedPeer) -> (InverseEntry, String) {
        let trace = || {
            let began = Instant::now();
            let traced = peer.trace(&self.picture, self.colors() + 1)?;
            let wall_s = began.elapsed().as_secs_f64();
            let svg = self.with_width(traced.svg)?;
            Ok((self.judged(peer.name(), &svg, wall_s)?, svg))
        };
        attempt(trace, |failure| InverseEntry {
            failure,
            ..self.entry(peer.name())
        })
    }

    /// Number of colours of the strokes.
    fn colors(&self) -> usize {
        let colors: BTreeSet<_> = self.original.iter().map(|element| element.color).collect();
        colors.len()
    }

    /// The SVG of a peer that tells no widths, told the median of those of the drawing, with round ends and joins.
    fn with_width(&self, svg: String) -> Result<String> {
        let found = elements(&svg, f32::from(self.side))?;
        let has_strokes = found.iter().any(|element| element.width_px.is_some());
        if !has_strokes || svg.contains("stroke-width") {
            return Ok(svg);
        }
        let mut widths: Vec<f32> = self.original.iter().filter_map(|e| e.width_px).collect();
        widths.sort_by(f32::total_cmp);
        let width_px = widths[widths.len() / 2];
        let look = format!(
            r#"<svg stroke-width="{width_px:.2}" stroke-linecap="round" stroke-linejoin="round" "#
        );
        Ok(svg.replacen("<svg ", &look, 1))
    }

    /// The record of this case before anything is known of what was found.
    fn entry(&self, by: &str) -> InverseEntry {
        let (jpeg, noise) = match self.damage {
            Damage::Jpeg(quality) => (Some(quality), None),
            Damage::Noise(levels) => (None, Some(levels)),
            _ => (None, None),
        };
        InverseEntry {
            drawing: self.drawing.name.clone(),
            by: by.to_owned(),
            side_px: usize::from(self.side),
            jpeg,
            noise,
            damage: self.damage,
            original: inventory(&self.original, &self.drawing.svg),
            ..InverseEntry::default()
        }
    }

    fn judged(&self, by: &str, svg: &str, wall_s: f64) -> Result<InverseEntry> {
        let mut found = elements(svg, f32::from(self.side))?;
        // Ours have a background below the strokes.
        if found.iter().any(|element| element.width_px.is_some()) {
            found.retain(|element| element.width_px.is_some());
        }
        let distances = Distances::between(&self.original, &found);
        Ok(InverseEntry {
            found: inventory(&found, svg),
            psnr_db: Some(verify::fidelity(svg, &self.picture)?.psnr_db),
            mean_px: distances.map(|distances| distances.mean),
            largest_px: distances.map(|distances| distances.largest),
            wall_s: Some(wall_s),
            ..self.entry(by)
        })
    }
}

fn inventory(elements: &[Element], svg: &str) -> Inventory {
    Inventory {
        elements: elements.len(),
        lines: elements.iter().map(|element| element.lines.len()).sum(),
        points: elements.iter().map(|element| element.points).sum(),
        bytes: svg.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawings::Kind;
    use super::*;

    #[test]
    fn a_drawing_without_strokes_is_refused_by_name() {
        let drawing = Drawing {
            name: "blank".into(),
            svg: r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"/>"#.into(),
        };
        let error = run(
            &[drawing],
            &Pictures::short(Kind::Strokes),
            &[],
            &Config::default(),
            &mut |_| Ok(()),
        );
        let words = error.unwrap_err().to_string();
        assert!(
            words.starts_with("blank: ") && words.contains("stroke"),
            "{words}"
        );
    }
}
