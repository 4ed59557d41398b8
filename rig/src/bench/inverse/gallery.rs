//! A sheet of pictures, what was found in them, and its centre lines as an editor shows them.

use std::fmt::Write as _;

use super::Outcome;
use crate::bench::drawings::side_nearest;
use crate::report::Damage;
use crate::report::cases::OWN;
use crate::report::inverse::InverseEntry;
use crate::report::plot::{Panel, Sheet, framed};
use strokefit::image::Image;
use strokefit::verify::{self, Element, Size, elements};
use strokefit::{Error, ErrorKind, Result};

/// Side of a panel, px.
const PANEL_PX: usize = 192;

/// Panels of a row at most, unless one drawing has more.
const COLUMNS: usize = 6;

/// Share of a picture that is left below its centre lines.
const FADED: f32 = 0.25;

/// Colours of centre lines, one for each element in turn: Okabe & Ito, "Color universal design", 2008.
const COLORS: [&str; 5] = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00"];

/// Results of clean pictures of one size.
#[derive(Debug)]
pub struct Gallery {
    side_px: usize,
    /// The panels of each drawing.
    rows: Vec<Vec<Panel>>,
}

impl Gallery {
    /// A gallery of what is found in pictures of the size nearest to that of a panel.
    pub fn of(sides: &[u16]) -> Self {
        Self {
            side_px: side_nearest(sides, PANEL_PX),
            rows: Vec::new(),
        }
    }

    /// Shows a result, if it is of the gallery's pictures.
    ///
    /// # Errors
    /// As [`verify::render`].
    pub fn show(&mut self, outcome: Outcome<'_>) -> Result<()> {
        let entry = outcome.entry;
        if entry.side_px != self.side_px
            || entry.damage() != Damage::Clean
            || entry.failure.is_some()
        {
            return Ok(());
        }
        if entry.by == OWN {
            self.rows.push(ours(outcome)?);
        } else if let Some(row) = self.rows.last_mut() {
            let (elements, db) = (entry.found.elements, decibels(entry));
            let title = format!("{}: {elements}, {db}", entry.by);
            row.push(Panel::new(title, framed(&drawn(outcome)?, PANEL_PX)?));
        }
        Ok(())
    }

    /// All of them.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when there is nothing to show.
    pub fn sheet(self) -> Result<Image> {
        Sheet::of_rows(self.rows, COLUMNS)?.draw()
    }
}

/// The picture, the drawing, and its centre lines.
fn ours(outcome: Outcome<'_>) -> Result<Vec<Panel>> {
    let entry = outcome.entry;
    let picture = enlarged(outcome.picture, zoom(outcome.picture))?;
    let lines = centre_lines(outcome, &picture)?;
    let name = format!("{}, {} px", entry.drawing, entry.side_px);
    let (found, drawn_elements) = (entry.found.elements, entry.original.elements);
    let numbers = format!("{found} of {drawn_elements}, {}", decibels(entry));
    let apart = entry.mean_px.map(|px| format!("{px:.2} px off"));
    let apart = apart.unwrap_or_else(|| "no centre lines".into());
    Ok(vec![
        Panel::new(name, framed(&picture, PANEL_PX)?),
        Panel::new(numbers, framed(&drawn(outcome)?, PANEL_PX)?),
        Panel::new(apart, framed(&lines, PANEL_PX)?),
    ])
}

fn decibels(entry: &InverseEntry) -> String {
    format!("{:.1} dB", entry.psnr_db.unwrap_or(f64::NAN))
}

/// Px of a panel for each px of the picture.
fn zoom(picture: &Image) -> usize {
    (PANEL_PX / picture.width().max(picture.height())).max(1)
}

fn size(picture: &Image) -> Result<Size> {
    let side = |px: usize| u32::try_from(px * zoom(picture));
    let (width, height) = (side(picture.width()), side(picture.height()));
    match (width, height) {
        (Ok(width), Ok(height)) => Ok(Size::Exact { width, height }),
        _ => Err(Error::new(ErrorKind::Picture, "a picture is too large")),
    }
}

fn drawn(outcome: Outcome<'_>) -> Result<Image> {
    verify::render(outcome.svg, size(outcome.picture)?, Some([1.0; 3]))
}

/// The centre lines of strokes over what is left of the picture, a colour for each element, with its nodes.
fn centre_lines(outcome: Outcome<'_>, picture: &Image) -> Result<Image> {
    let side = outcome.picture.width().max(outcome.picture.height());
    let found = elements(outcome.svg, side as f32)?;
    let strokes = found.iter().filter(|element| element.width_px.is_some());
    let px = 1.0 / zoom(outcome.picture) as f32;
    let marked = strokes.zip(COLORS.iter().cycle());
    let marked: String = marked.map(|(e, color)| marked_up(e, color, px)).collect();
    let (width, height) = (outcome.picture.width(), outcome.picture.height());
    let svg = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">{marked}</svg>"#
    );
    over(
        &verify::render(&svg, size(outcome.picture)?, None)?,
        picture,
    )
}

/// An element's centre lines and nodes as SVG; `px` is a px of the panel.
fn marked_up(element: &Element, color: &str, px: f32) -> String {
    let mut data = String::new();
    for line in &element.lines {
        for (i, p) in line.iter().enumerate() {
            let word = if i == 0 { 'M' } else { 'L' };
            let _ = write!(data, "{word}{:.2} {:.2}", p.x, p.y);
        }
    }
    let mut svg = format!(
        r#"<path d="{data}" fill="none" stroke="{color}" stroke-width="{:.2}"/>"#,
        1.5 * px
    );
    for p in &element.nodes {
        let _ = write!(
            svg,
            r##"<rect x="{:.2}" y="{:.2}" width="{side:.2}" height="{side:.2}" fill="#ffffff" stroke="{color}" stroke-width="{px:.2}"/>"##,
            p.x - 2.0 * f64::from(px),
            p.y - 2.0 * f64::from(px),
            side = 4.0 * px
        );
    }
    svg
}

/// A transparent picture over what is left of another.
fn over(above: &Image, below: &Image) -> Result<Image> {
    let clear = vec![0.0; above.width() * above.height()];
    let alpha = above.alpha().unwrap_or(&clear);
    let plane = |c: usize| {
        let pixels = above.planes()[c].iter().zip(&below.planes()[c]).zip(alpha);
        let faded = |below: f32| 1.0 + FADED * (below - 1.0);
        pixels
            .map(|((above, below), a)| a * above + (1.0 - a) * faded(*below))
            .collect()
    };
    Image::new(above.width(), above.height(), [0, 1, 2].map(plane))
}

/// Each px as a square of `zoom × zoom`.
fn enlarged(picture: &Image, zoom: usize) -> Result<Image> {
    let (width, height) = (picture.width() * zoom, picture.height() * zoom);
    let plane = |c: usize| {
        let from = &picture.planes()[c];
        let at = |i: usize| from[i / width / zoom * picture.width() + i % width / zoom];
        (0..width * height).map(at).collect()
    };
    Image::new(width, height, [0, 1, 2].map(plane))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="48" height="24"><path d="M8 12H40" stroke="#000000" stroke-width="8"/></svg>"##;

    fn entry(by: &str) -> InverseEntry {
        InverseEntry {
            by: by.into(),
            side_px: 48,
            ..InverseEntry::default()
        }
    }

    #[test]
    fn a_sheet_shows_picture_drawing_lines_and_peers() {
        let picture = verify::render(LINE, Size::Scale(1.0), Some([1.0; 3])).unwrap();
        let mut gallery = Gallery::of(&[48]);
        for by in [OWN, "potrace"] {
            gallery
                .show(Outcome {
                    entry: &entry(by),
                    picture: &picture,
                    svg: LINE,
                })
                .unwrap();
        }
        let sheet = gallery.sheet().unwrap();
        assert_eq!(sheet.width(), 8 + 4 * (PANEL_PX + 8));
        // The middle of each panel is on the line: black in all but the third, where its colour is.
        let y = 28 + PANEL_PX / 2;
        let middles = [0, 1, 2, 3].map(|i| {
            let at = y * sheet.width() + 8 + i * (PANEL_PX + 8) + PANEL_PX / 2;
            [0, 1, 2].map(|c| (255.0 * sheet.planes()[c][at]).round() as u8)
        });
        assert_eq!(middles[..2], [[0; 3]; 2]);
        assert_eq!(middles[3], [0; 3]);
        assert!(middles[2][0] > 180 && middles[2][2] < 60, "{middles:?}");
    }

    #[test]
    fn only_clean_pictures_of_its_size_are_shown() {
        let picture = verify::render(LINE, Size::Scale(1.0), Some([1.0; 3])).unwrap();
        let mut gallery = Gallery::of(&[48, 384]);
        assert_eq!(gallery.side_px, 48);
        let lossy = InverseEntry {
            jpeg: Some(75),
            ..entry(OWN)
        };
        let outcome = Outcome {
            entry: &lossy,
            picture: &picture,
            svg: LINE,
        };
        gallery.show(outcome).unwrap();
        assert!(gallery.rows.is_empty() && gallery.sheet().is_err());
    }
}
