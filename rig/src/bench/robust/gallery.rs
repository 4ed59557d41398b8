//! A sheet of damaged pictures and what was made of them.

use super::super::shapes::{panel, shortened};
use super::Outcome;
use crate::report::cases::OWN;
use crate::report::plot::{Panel, Sheet};
use strokefit::Result;
use strokefit::image::Image;
use strokefit::verify;

/// Panels of a row at most, unless one picture has more.
const COLUMNS: usize = 8;

/// Pictures that are shown, at most; each has a dozen damages.
const MOST: usize = 6;

/// Damaged pictures beside their drawings.
#[derive(Debug, Default)]
pub struct Gallery {
    names: Vec<String>,
    rows: Vec<Vec<Panel>>,
}

impl Gallery {
    /// Shows a result, if it is of one of the first pictures: the damaged picture where it is the first, and the drawing.
    ///
    /// # Errors
    /// As [`verify::render`].
    pub fn show(&mut self, outcome: Outcome<'_>) -> Result<()> {
        let entry = outcome.entry;
        if !self.names.contains(&entry.picture) {
            self.names.push(entry.picture.clone());
        }
        if self.names.len() > MOST || entry.failure.is_some() {
            return Ok(());
        }
        if entry.by == OWN {
            let db = entry.input_db.unwrap_or(f64::NAN);
            let title = format!("{}, {db:.1} dB", entry.damage);
            let panel = Panel::new(shortened(&title), panel(outcome.picture)?);
            self.rows.push(vec![panel]);
        }
        let Some(row) = self.rows.last_mut() else {
            return Ok(());
        };
        let drawn = verify::render_like(outcome.svg, outcome.picture, [1.0; 3])?;
        let by = if entry.by == OWN { "" } else { &entry.by };
        let db = entry.truth_db.unwrap_or(f64::NAN);
        let title = format!("{by} {} elements, {db:.1} dB", entry.found.elements);
        row.push(Panel::new(shortened(title.trim()), panel(&drawn)?));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Damage;
    use crate::report::robust::RobustEntry;
    use strokefit::verify::Size;

    const SVG: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="48" height="24"><rect width="24" height="24"/></svg>"#;

    #[test]
    fn a_sheet_shows_a_few_pictures_with_what_was_made_of_them() {
        let picture = verify::render(SVG, Size::Scale(1.0), Some([1.0; 3])).unwrap();
        let mut gallery = Gallery::default();
        for number in 0..MOST + 2 {
            for (by, damage) in [
                (OWN, Damage::Clean),
                (OWN, Damage::Noise(8)),
                ("potrace", Damage::Noise(8)),
            ] {
                let entry = RobustEntry {
                    picture: number.to_string(),
                    by: by.into(),
                    damage,
                    ..RobustEntry::default()
                };
                let outcome = Outcome {
                    entry: &entry,
                    picture: &picture,
                    svg: SVG,
                };
                gallery.show(outcome).unwrap();
            }
        }
        let panels = gallery.rows.iter().map(Vec::len);
        assert_eq!(panels.collect::<Vec<_>>(), [2, 3].repeat(MOST));
        let sheet = gallery.sheet().unwrap();
        let panel = panel(&picture).unwrap();
        assert_eq!(sheet.width(), 8 + 6 * (panel.width() + 8));
    }
}
