//! What `strokefit bench inverse` found: how much of a drawing is found again in its picture.

use serde::{Deserialize, Serialize};

use super::{SCHEMA, Table};

/// All cases of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InverseReport {
    /// [`SCHEMA`].
    pub schema: u32,
    /// One per drawing and picture of it, in order.
    pub entries: Vec<InverseEntry>,
}

/// What a drawing consists of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Inventory {
    /// Elements with a stroke.
    pub elements: usize,
    /// Ends, corners and control points.
    pub points: usize,
    /// Bytes of the file.
    pub bytes: usize,
}

/// A drawing, a picture of it, and what was made of that picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InverseEntry {
    /// The name of the drawing.
    pub drawing: String,
    /// The longer side of the picture, px.
    pub side_px: usize,
    /// The quality of the JPEG that the picture went through; `None` for a clean one.
    pub jpeg: Option<u8>,
    /// The drawing.
    pub original: Inventory,
    /// What was found.
    pub found: Inventory,
    /// Fidelity of the found file to the picture, dB.
    pub psnr_db: f64,
    /// Mean distance between the centre lines of both, px.
    pub mean_px: f64,
    /// Largest distance between the centre lines of both, px.
    pub largest_px: f64,
    /// Wall time of the fit, s.
    pub wall_s: f64,
}

impl InverseEntry {
    /// Elements found for each that was drawn.
    pub fn ratio(&self) -> f64 {
        self.found.elements as f64 / self.original.elements.max(1) as f64
    }

    fn kind(&self) -> String {
        let quality = self.jpeg.map(|quality| format!(", JPEG {quality}"));
        format!("{} px{}", self.side_px, quality.unwrap_or_default())
    }

    /// The line of standard output, ending in the verdict.
    pub fn line(&self) -> String {
        format!(
            "{} at {}: {} elements of {}, {} points of {}, {} bytes of {}, {:.1} dB, centre lines {:.2} px off, at most \
             {:.1}: pass",
            self.drawing,
            self.kind(),
            self.found.elements,
            self.original.elements,
            self.found.points,
            self.original.points,
            self.found.bytes,
            self.original.bytes,
            self.psnr_db,
            self.mean_px,
            self.largest_px
        )
    }
}

impl InverseReport {
    /// The report of these cases.
    pub fn new(entries: Vec<InverseEntry>) -> Self {
        Self {
            schema: SCHEMA,
            entries,
        }
    }

    /// Medians and means of each kind of picture, and all cases.
    pub fn markdown(&self) -> String {
        format!(
            "# Drawings found again\n\n{}\n## All\n\n{}",
            self.summary().markdown(),
            self.table().markdown()
        )
    }

    /// One row for each size and quality.
    pub fn summary(&self) -> Table {
        let mut table = Table::new(&[
            "pictures",
            "drawings",
            "elements found for each drawn, median",
            "points, median",
            "bytes, median",
            "dB, mean",
            "least dB",
            "centre lines off by, px, mean",
            "s, median",
        ]);
        let mut kinds: Vec<String> = self.entries.iter().map(InverseEntry::kind).collect();
        kinds.dedup();
        for kind in kinds {
            let of_kind = || self.entries.iter().filter(|entry| entry.kind() == kind);
            let column = |value: fn(&InverseEntry) -> f64| of_kind().map(value).collect();
            let db: Vec<f64> = column(|entry| entry.psnr_db);
            table.row([
                kind.clone(),
                of_kind().count().to_string(),
                format!("{:.2}", median(column(InverseEntry::ratio))),
                format!("{:.0}", median(column(|entry| entry.found.points as f64))),
                format!("{:.0}", median(column(|entry| entry.found.bytes as f64))),
                format!("{:.1}", mean(&db)),
                format!("{:.1}", db.iter().copied().fold(f64::INFINITY, f64::min)),
                format!("{:.2}", mean(&column(|entry| entry.mean_px))),
                format!("{:.2}", median(column(|entry| entry.wall_s))),
            ]);
        }
        table
    }

    /// One row per case.
    pub fn table(&self) -> Table {
        let mut table = Table::new(&[
            "drawing",
            "side_px",
            "jpeg",
            "drawn_elements",
            "found_elements",
            "drawn_points",
            "found_points",
            "drawn_bytes",
            "found_bytes",
            "psnr_db",
            "mean_px",
            "largest_px",
            "wall_s",
        ]);
        for entry in &self.entries {
            table.row([
                entry.drawing.clone(),
                entry.side_px.to_string(),
                entry
                    .jpeg
                    .map(|quality| quality.to_string())
                    .unwrap_or_default(),
                entry.original.elements.to_string(),
                entry.found.elements.to_string(),
                entry.original.points.to_string(),
                entry.found.points.to_string(),
                entry.original.bytes.to_string(),
                entry.found.bytes.to_string(),
                format!("{:.2}", entry.psnr_db),
                format!("{:.3}", entry.mean_px),
                format!("{:.2}", entry.largest_px),
                format!("{:.3}", entry.wall_s),
            ]);
        }
        table
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match (values.len() % 2, values.get(middle)) {
        (1, Some(&value)) => value,
        (0, Some(&value)) if middle > 0 => f64::midpoint(values[middle - 1], value),
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_of_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(Vec::new()).is_nan());
    }

    #[test]
    fn the_summary_has_a_row_for_each_kind_of_picture() {
        let entry = |side_px, jpeg, elements| InverseEntry {
            drawing: "clock".into(),
            side_px,
            jpeg,
            original: Inventory {
                elements: 2,
                ..Inventory::default()
            },
            found: Inventory {
                elements,
                ..Inventory::default()
            },
            psnr_db: 40.0,
            mean_px: 0.1,
            largest_px: 0.5,
            wall_s: 0.2,
        };
        let entries = vec![
            entry(48, None, 2),
            entry(48, None, 4),
            entry(48, Some(75), 6),
        ];
        let csv = InverseReport::new(entries).summary().csv();
        let rows: Vec<&str> = csv.lines().skip(1).collect();
        assert!(rows[0].starts_with("48 px,2,1.50,"), "{csv}");
        assert!(rows[1].starts_with("\"48 px, JPEG 75\",1,3.00,"), "{csv}");
    }
}
