//! A sheet of pictures, what was found in them, and the errors.

use super::Outcome;
use crate::bench::drawings::side_nearest;
use crate::report::Damage;
use crate::report::cases::OWN;
use crate::report::picture::{self, heat};
use crate::report::plot::{Panel, Sheet, framed};
use strokefit::Result;
use strokefit::image::Image;
use strokefit::verify;

/// Side of a panel, px.
const PANEL_PX: usize = 256;

/// Panels of a row at most, unless one drawing has more.
const COLUMNS: usize = 6;

/// Errors are shown this many times as large; those of a quarter or more have the brightest colour.
const ENLARGED: f64 = 4.0;

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

    /// Shows a result, if it is of the gallery's pictures: its picture where it is the first, the drawing, and the errors
    /// of ours.
    ///
    /// # Errors
    /// As [`verify::render`].
    pub fn show(&mut self, outcome: Outcome<'_>) -> Result<()> {
        let entry = outcome.entry;
        let is_shown = entry.side_px == self.side_px && entry.damage == Damage::Clean;
        if !is_shown || entry.failure.is_some() {
            return Ok(());
        }
        if entry.by == OWN {
            let name = format!("{}, {} px", entry.drawing, entry.side_px);
            let panel = Panel::new(shortened(&name), panel(outcome.picture)?);
            self.rows.push(vec![panel]);
        }
        let Some(row) = self.rows.last_mut() else {
            return Ok(());
        };
        let drawn = verify::render_like(outcome.svg, outcome.picture, [1.0; 3])?;
        let by = if entry.by == OWN { "" } else { &entry.by };
        let (found, of) = (entry.found.elements, entry.original.elements);
        let db = entry.truth_db.unwrap_or(f64::NAN);
        let title = format!("{by} {found} of {of}, {db:.1} dB");
        row.push(Panel::new(shortened(title.trim()), panel(&drawn)?));
        if entry.by == OWN {
            let edges = entry.displacement_px.unwrap_or(f64::NAN);
            let title = format!("errors × 4, edges {edges:.3} px off");
            let errors = errors(outcome.picture, &drawn)?;
            row.push(Panel::new(title, panel(&errors)?));
        }
        Ok(())
    }

    /// All of them.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`](strokefit::ErrorKind::Picture) when there is nothing to show.
    pub fn sheet(self) -> Result<Image> {
        Sheet::of_rows(self.rows, COLUMNS)?.draw()
    }
}

/// As much of a title as there is room for above a panel.
pub(in crate::bench) fn shortened(title: &str) -> String {
    title.chars().take(PANEL_PX / 8).collect()
}

/// In a panel, smaller if need be.
pub(in crate::bench) fn panel(picture: &Image) -> Result<Image> {
    let longer = picture.width().max(picture.height());
    if longer <= PANEL_PX {
        return framed(picture, PANEL_PX);
    }
    let side = |px: usize| px * PANEL_PX / longer;
    let small = picture.reduced(side(picture.width()), side(picture.height()));
    framed(&small, PANEL_PX)
}

/// The largest error of a channel, by colour.
fn errors(picture: &Image, drawn: &Image) -> Result<Image> {
    let of = |i: usize| {
        let planes = picture.planes().iter().zip(drawn.planes());
        let apart = planes.map(|(a, b)| f64::from((a[i] - b[i]).abs()));
        apart.fold(0.0, f64::max)
    };
    let pixels = picture.width() * picture.height();
    let values: Vec<f64> = (0..pixels).map(of).collect();
    picture::map(picture.width(), &values, |v| heat(ENLARGED * v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::shapes::ShapesEntry;
    use strokefit::verify::Size;

    const SVG: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="48" height="24"><rect width="24" height="24"/></svg>"#;

    #[test]
    fn a_sheet_shows_picture_drawing_errors_and_peers() {
        let picture = verify::render(SVG, Size::Scale(1.0), Some([1.0; 3])).unwrap();
        let mut gallery = Gallery::of(&[48, 2048]);
        for by in [OWN, "potrace"] {
            for damage in [Damage::Clean, Damage::Noise(8)] {
                let entry = ShapesEntry {
                    by: by.into(),
                    side_px: 48,
                    damage,
                    ..ShapesEntry::default()
                };
                let outcome = Outcome {
                    entry: &entry,
                    picture: &picture,
                    svg: SVG,
                };
                gallery.show(outcome).unwrap();
            }
        }
        assert_eq!(gallery.rows.iter().map(Vec::len).collect::<Vec<_>>(), [4]);
        let sheet = gallery.sheet().unwrap();
        assert_eq!(sheet.width(), 8 + 4 * (PANEL_PX + 8));
    }

    #[test]
    fn large_pictures_are_shown_smaller() {
        let large = Image::filled(512, 300, [0.0; 3]).unwrap();
        let shown = panel(&large).unwrap();
        assert_eq!((shown.width(), shown.height()), (PANEL_PX, PANEL_PX));
        let at = |y: usize| shown.planes()[0][y * PANEL_PX + 4];
        assert_eq!((at(2), at(128)), (1.0, 0.0));
    }
}
