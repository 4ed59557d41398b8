//! A sheet of pictures, what was made of them, and a look at that.

use crate::report::cases::CaseEntry;
use crate::report::picture::{self, heat};
use crate::report::plot::{Panel, Sheet, framed};
use strokefit::Result;
use strokefit::image::Image;
use strokefit::verify::{self, Size};

/// Side of a panel, px.
pub(crate) const PANEL_PX: usize = 256;

/// Panels of a row at most, unless one picture has more.
const COLUMNS: usize = 6;

/// Largest error of a channel that is told from larger ones, 0..1: that has the brightest colour.
pub(super) const BRIGHTEST: f64 = 0.25;

/// A row of panels for each picture.
#[derive(Debug, Default)]
pub struct Gallery {
    rows: Vec<Vec<Panel>>,
}

impl Gallery {
    /// Shows a drawing that was made, after its picture if it is ours; `caption` is that of the drawing.
    ///
    /// # Errors
    /// As [`verify::render`].
    pub(super) fn show(
        &mut self,
        entry: &CaseEntry,
        [title, caption]: [&str; 2],
        svg: &str,
        picture: &Image,
    ) -> Result<()> {
        if entry.is_own() {
            self.row(title, picture)?;
        }
        let by = if entry.is_own() { "" } else { &entry.by };
        self.add_drawing(&format!("{by} {caption}"), svg, picture)
    }

    /// Begins a row with a picture.
    ///
    /// # Errors
    /// As [`Self::add`].
    pub(super) fn row(&mut self, title: &str, picture: &Image) -> Result<()> {
        self.rows.push(vec![framed_panel(title, picture)?]);
        Ok(())
    }

    /// Adds a drawing of a picture to the last row.
    ///
    /// # Errors
    /// As [`verify::render`].
    pub(super) fn add_drawing(&mut self, title: &str, svg: &str, picture: &Image) -> Result<()> {
        self.add(title, &verify::render(svg, size(picture), Some([1.0; 3]))?)
    }

    /// Adds a picture to the last row.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`](strokefit::ErrorKind::Picture) when there is no memory for it.
    pub(super) fn add(&mut self, title: &str, picture: &Image) -> Result<()> {
        if let Some(row) = self.rows.last_mut() {
            row.push(framed_panel(title, picture)?);
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

/// In a panel, under as much of the title as there is room for.
fn framed_panel(title: &str, picture: &Image) -> Result<Panel> {
    let title: String = title.trim().chars().take(PANEL_PX / 8).collect();
    Ok(Panel::new(title, framed(&fitted(picture)?, PANEL_PX)?))
}

/// The px of a panel for each px of a picture, where that is smaller.
pub(super) fn zoom(picture: &Image) -> usize {
    (PANEL_PX / picture.width().max(picture.height())).max(1)
}

/// The size of a picture in a panel.
pub(super) fn size(picture: &Image) -> Size {
    let longer = picture.width().max(picture.height()) * zoom(picture);
    let side = |px: usize| {
        let px = px * zoom(picture);
        let px = if longer > PANEL_PX {
            px * PANEL_PX / longer
        } else {
            px
        };
        u32::try_from(px.max(1)).unwrap_or(u32::MAX)
    };
    Size::Exact {
        width: side(picture.width()),
        height: side(picture.height()),
    }
}

/// A picture at the size that it has in a panel: each px as a square, or several as one.
pub(super) fn fitted(picture: &Image) -> Result<Image> {
    let Size::Exact { width, height } = size(picture) else {
        return Ok(picture.clone());
    };
    let (width, height, zoom) = (width as usize, height as usize, zoom(picture));
    if width < picture.width() || height < picture.height() {
        return Ok(picture.reduced(width, height));
    }
    let plane = |c: usize| {
        let from = &picture.planes()[c];
        let at = |i: usize| from[i / width / zoom * picture.width() + i % width / zoom];
        (0..width * height).map(at).collect()
    };
    Image::new(width, height, [0, 1, 2].map(plane))
}

/// The largest error of a channel, by colour.
pub(super) fn errors(picture: &Image, drawn: &Image) -> Result<Image> {
    let of = |i: usize| {
        let planes = picture.planes().iter().zip(drawn.planes());
        let apart = planes.map(|(a, b)| f64::from((a[i] - b[i]).abs()));
        apart.fold(0.0, f64::max)
    };
    let pixels = picture.width() * picture.height();
    let values: Vec<f64> = (0..pixels).map(of).collect();
    picture::map(picture.width(), &values, |v| heat(v / BRIGHTEST))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::cases::OWN;

    const SVG: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="48" height="24"><rect width="24" height="24"/></svg>"#;

    #[test]
    fn a_sheet_shows_picture_drawing_and_peers() {
        let picture = verify::render(SVG, Size::Scale(1.0), Some([1.0; 3])).unwrap();
        let mut gallery = Gallery::default();
        for by in [OWN, "potrace", OWN] {
            let entry = CaseEntry {
                by: by.into(),
                ..CaseEntry::default()
            };
            gallery.show(&entry, ["a", "b"], SVG, &picture).unwrap();
        }
        assert_eq!(
            gallery.rows.iter().map(Vec::len).collect::<Vec<_>>(),
            [3, 2]
        );
        let sheet = gallery.sheet().unwrap();
        assert_eq!(sheet.width(), 8 + 6 * (PANEL_PX + 8));
        assert!(Gallery::default().sheet().is_err());
    }

    #[test]
    fn pictures_fill_their_panels() {
        for (width, height, shown) in [(512, 300, (256, 150)), (48, 24, (240, 120))] {
            let picture = Image::filled(width, height, [0.0; 3]).unwrap();
            let fitted = fitted(&picture).unwrap();
            assert_eq!((fitted.width(), fitted.height()), shown);
        }
    }
}
