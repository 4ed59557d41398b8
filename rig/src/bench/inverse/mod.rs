//! Drawings of known strokes, and what is found of them in their pictures.
//!
//! The picture of a drawing is rendered at four times its size and averaged, so that it has the drawing's true edges
//! rather than those of the judge. Other programs that draw lines trace the same pictures, where they are installed.

mod distances;
mod gallery;

use std::collections::BTreeSet;
use std::time::Instant;

pub use gallery::Gallery;

use super::peers::LinePeer;
use crate::report::inverse::{Inventory, InverseEntry, InverseReport, OWN};
use distances::Distances;
use strokefit::fit::{Config, Fitter};
use strokefit::image::{Image, Limits};
use strokefit::verify::{self, Element, Size, elements};
use strokefit::{Error, ErrorKind, Result};

/// A drawing of known strokes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Drawing {
    /// Name in lines of the report.
    pub name: String,
    /// SVG text.
    pub svg: String,
}

/// Pictures that are made of each drawing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pictures {
    /// Their longer sides, px.
    pub sides: Vec<u16>,
    /// The qualities of the JPEG that they go through; `None` for clean ones.
    pub qualities: Vec<Option<u8>>,
}

impl Pictures {
    /// From small to large, clean and as JPEG of quality 75.
    pub fn full() -> Self {
        Self {
            sides: vec![48, 96, 192, 384],
            qualities: vec![None, Some(75)],
        }
    }

    /// Clean ones of one size.
    pub fn short() -> Self {
        Self {
            sides: vec![96],
            qualities: vec![None],
        }
    }
}

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
#[derive(Debug, Clone, Copy)]
pub struct Outcome<'a> {
    /// Its record.
    pub entry: &'a InverseEntry,
    /// The picture of the drawing.
    pub picture: &'a Image,
    /// The SVG that was made of it; empty where none was.
    pub svg: &'a str,
}

/// Fits the pictures of all drawings and has `peers` trace them, telling each result as it comes.
///
/// # Errors
/// - [`ErrorKind::Svg`] when a drawing is no SVG or has no stroke; the message names it.
/// - As [`Fitter::fit`], and as `tell`. A peer that makes no SVG is a failure in the report.
pub fn run(
    drawings: &[Drawing],
    pictures: &Pictures,
    peers: &[LinePeer],
    config: &Config,
    tell: &mut dyn FnMut(Outcome<'_>) -> Result<()>,
) -> Result<InverseReport> {
    let mut entries = Vec::new();
    for &quality in &pictures.qualities {
        for &side in &pictures.sides {
            for drawing in drawings {
                let within = |error: Error| error.within(&drawing.name);
                let case = Case::new(drawing, side, quality).map_err(within)?;
                let mut found = vec![case.fitted(config).map_err(within)?];
                found.extend(peers.iter().map(|peer| case.traced(peer)));
                for (entry, svg) in found {
                    tell(Outcome {
                        entry: &entry,
                        picture: &case.picture,
                        svg: &svg,
                    })?;
                    entries.push(entry);
                }
            }
        }
    }
    Ok(InverseReport::new(entries))
}

/// One picture of a drawing.
struct Case<'a> {
    drawing: &'a Drawing,
    side: u16,
    jpeg: Option<u8>,
    original: Vec<Element>,
    picture: Image,
}

impl<'a> Case<'a> {
    fn new(drawing: &'a Drawing, side: u16, jpeg: Option<u8>) -> Result<Self> {
        let mut original = elements(&drawing.svg, f32::from(side))?;
        original.retain(|element| element.width_px.is_some());
        if original.is_empty() {
            let message = "no element has a stroke, so that nothing could be found again: give drawings of strokes";
            return Err(Error::new(ErrorKind::Svg, message));
        }
        Ok(Self {
            drawing,
            side,
            jpeg,
            original,
            picture: picture(&drawing.svg, side, jpeg)?,
        })
    }

    fn fitted(&self, config: &Config) -> Result<(InverseEntry, String)> {
        let began = Instant::now();
        let fit = Fitter::new(config.clone()).fit(&self.picture)?;
        let wall_s = began.elapsed().as_secs_f64();
        let svg = fit.svg();
        Ok((self.judged(OWN, &svg, wall_s)?, svg))
    }

    fn traced(&self, peer: &LinePeer) -> (InverseEntry, String) {
        let trace = || {
            let began = Instant::now();
            let traced = peer.trace(&self.picture, self.colors() + 1)?;
            let wall_s = began.elapsed().as_secs_f64();
            let svg = self.with_width(traced.svg)?;
            Ok((self.judged(peer.name(), &svg, wall_s)?, svg))
        };
        trace().unwrap_or_else(|error: Error| {
            let failed = InverseEntry {
                failure: Some(error.to_string()),
                ..self.entry(peer.name())
            };
            (failed, String::new())
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
        InverseEntry {
            drawing: self.drawing.name.clone(),
            by: by.to_owned(),
            side_px: usize::from(self.side),
            jpeg: self.jpeg,
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

/// The picture of a drawing on white, its longer side as many px.
fn picture(svg: &str, side: u16, jpeg: Option<u8>) -> Result<Image> {
    let own = verify::render(svg, Size::Scale(1.0), None)?;
    let scale = f64::from(side) / own.width().max(own.height()) as f64;
    let large = verify::render(svg, Size::Scale(4.0 * scale), Some([1.0; 3]))?;
    let picture = large.halved().halved();
    match jpeg {
        None => Ok(picture),
        Some(quality) => Image::decode(&picture.encode_jpeg(quality)?, "JPEG", Limits::default()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_have_the_size_asked_for() {
        for drawing in own() {
            let picture = picture(&drawing.svg, 48, Some(75)).unwrap();
            assert_eq!((picture.width(), picture.height()), (48, 48));
        }
    }

    #[test]
    fn a_drawing_without_strokes_is_refused_by_name() {
        let drawing = Drawing {
            name: "blank".into(),
            svg: r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"/>"#.into(),
        };
        let error = run(
            &[drawing],
            &Pictures::short(),
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
