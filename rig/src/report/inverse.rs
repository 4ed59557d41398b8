//! Findings of `strokefit-rig inverse`: how much of a drawing is found again in its picture.

use serde::{Deserialize, Serialize};

use super::cases::{Case, Cases, grouped};
use super::charts::{against_size, elements};
use super::statistics::{mean, median, optional};
use super::{Column, Damage, Table};
use strokefit::Result;

/// All cases of a run.
pub type InverseReport = Cases<InverseEntry>;

/// Contents of a drawing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Inventory {
    /// Elements with a stroke, or else those that are filled.
    pub elements: usize,
    /// Centre lines, or outlines of filled elements: an element has one or more.
    pub lines: usize,
    /// Ends, corners and control points.
    pub points: usize,
    /// Bytes of the file.
    pub bytes: usize,
}

/// A drawing, a picture of it, and what was made of that picture.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct InverseEntry {
    /// The name of the drawing.
    pub drawing: String,
    /// Who found it: `strokefit`, or another program's name.
    pub by: String,
    /// The longer side of the picture, px.
    pub side_px: usize,
    /// The quality of the JPEG that the picture went through; `None` for a clean one.
    pub jpeg: Option<u8>,
    /// Levels of the noise that the picture got, standard deviation; `None` without.
    #[serde(default)]
    pub noise: Option<u8>,
    /// Damage of the picture, of whatever kind.
    #[serde(default)]
    pub damage: Damage,
    /// The drawing.
    pub original: Inventory,
    /// Contents of the drawing that was found.
    pub found: Inventory,
    /// Fidelity of the found file to the picture, dB.
    pub psnr_db: Option<f64>,
    /// Mean distance between the centre lines of both, px; `None` where areas are filled.
    pub mean_px: Option<f64>,
    /// Largest distance between the centre lines of both, px; `None` where areas are filled.
    pub largest_px: Option<f64>,
    /// Wall time, s.
    pub wall_s: Option<f64>,
    /// Why nothing was made.
    pub failure: Option<String>,
}

impl InverseEntry {
    /// Elements found for each that was drawn.
    pub fn ratio(&self) -> f64 {
        self.found.elements as f64 / self.original.elements.max(1) as f64
    }
}

impl Case for InverseEntry {
    fn name(&self) -> &str {
        &self.drawing
    }

    fn by(&self) -> &str {
        &self.by
    }

    fn side_px(&self) -> usize {
        self.side_px
    }

    fn damage(&self) -> Damage {
        match (self.jpeg, self.noise) {
            (Some(quality), _) => Damage::Jpeg(quality),
            (None, Some(levels)) => Damage::Noise(levels),
            (None, None) => self.damage,
        }
    }

    fn elements(&self) -> [usize; 2] {
        [self.found.elements, self.original.elements]
    }

    fn words(&self) -> String {
        let apart = self.mean_px.zip(self.largest_px);
        let apart = apart.map_or_else(
            || "no centre lines".into(),
            |(mean, largest)| format!("centre lines {mean:.2} px off, at most {largest:.1}"),
        );
        format!(
            "{} elements of {}, {} points of {}, {} bytes of {}, {:.1} dB, {apart}",
            self.found.elements,
            self.original.elements,
            self.found.points,
            self.original.points,
            self.found.bytes,
            self.original.bytes,
            self.psnr_db.unwrap_or(f64::NAN)
        )
    }

    fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }
}

impl InverseReport {
    /// Medians and means of each kind of picture, and all cases.
    pub fn markdown(&self) -> String {
        format!(
            "# Drawings found again\n\n{}\n## All\n\n{}",
            self.summary().markdown(),
            self.table().markdown()
        )
    }

    /// One row for each size and quality, and who found the drawings.
    pub fn summary(&self) -> Table {
        let mut table = Table::new(&[
            "pictures",
            "by",
            "drawings",
            "elements found for each drawn, median",
            "points, median",
            "bytes, median",
            "dB, mean",
            "least dB",
            "centre lines off by, px, mean",
            "s, median",
        ]);
        for (kind, by, made) in grouped(&self.made(), Case::kind, |e| e.by.clone()) {
            table.row(summed_up(&kind, &by, &made));
        }
        table
    }

    /// One row per case.
    pub fn table(&self) -> Table {
        Table::of(&COLUMNS, &self.entries)
    }

    /// Name and SVG of each plot: `elements`, `db` and `bytes`.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`](strokefit::ErrorKind::Picture) when one cannot be drawn.
    pub fn charts(&self) -> Result<Vec<(&'static str, String)>> {
        let made = self.made();
        let db = against_size(&made, ("mean PSNR", "dB", false), |cases| {
            let finite = cases.iter().filter_map(|e| e.psnr_db);
            mean(&finite.filter(|db| db.is_finite()).collect::<Vec<_>>())
        });
        let bytes = against_size(&made, ("median bytes", "bytes", true), |cases| {
            Some(median(cases.iter().map(|e| e.found.bytes as f64).collect()))
        });
        let elements = elements(&made, true);
        Ok(vec![
            ("elements", elements.svg()?),
            ("db", db.svg()?),
            ("bytes", bytes.svg()?),
        ])
    }
}

const COLUMNS: [Column<InverseEntry>; 17] = [
    ("drawing", |e| e.drawing.clone()),
    ("side_px", |e| e.side_px.to_string()),
    ("jpeg", |e| optional(e.jpeg.map(f64::from), 0)),
    ("by", |e| e.by.clone()),
    ("drawn_elements", |e| e.original.elements.to_string()),
    ("found_elements", |e| e.found.elements.to_string()),
    ("drawn_lines", |e| e.original.lines.to_string()),
    ("found_lines", |e| e.found.lines.to_string()),
    ("drawn_points", |e| e.original.points.to_string()),
    ("found_points", |e| e.found.points.to_string()),
    ("drawn_bytes", |e| e.original.bytes.to_string()),
    ("found_bytes", |e| e.found.bytes.to_string()),
    ("psnr_db", |e| optional(e.psnr_db, 2)),
    ("mean_px", |e| optional(e.mean_px, 3)),
    ("largest_px", |e| optional(e.largest_px, 2)),
    ("wall_s", |e| optional(e.wall_s, 3)),
    ("failure", |e| e.failure.clone().unwrap_or_default()),
];

/// The cells of the summary for cases of one kind.
fn summed_up(kind: &str, by: &str, cases: &[&InverseEntry]) -> [String; 10] {
    let found = |value: fn(&Inventory) -> usize| {
        let values = cases.iter().map(|entry| value(&entry.found) as f64);
        format!("{:.0}", median(values.collect()))
    };
    let known = |value: fn(&InverseEntry) -> Option<f64>| -> Vec<f64> {
        cases.iter().filter_map(|entry| value(entry)).collect()
    };
    let db = known(|entry| entry.psnr_db);
    let ratios = cases.iter().map(|entry| entry.ratio()).collect();
    [
        kind.to_owned(),
        by.to_owned(),
        cases.len().to_string(),
        format!("{:.2}", median(ratios)),
        found(|inventory| inventory.points),
        found(|inventory| inventory.bytes),
        optional(mean(&db), 1),
        optional(db.iter().copied().reduce(f64::min), 1),
        optional(mean(&known(|entry| entry.mean_px)), 2),
        format!("{:.2}", median(known(|entry| entry.wall_s))),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::cases::OWN;
    use super::*;

    fn found(by: &str, side_px: usize, jpeg: Option<u8>, elements: usize) -> InverseEntry {
        let inventory = |elements| Inventory {
            elements,
            ..Inventory::default()
        };
        InverseEntry {
            drawing: "clock".into(),
            by: by.into(),
            side_px,
            jpeg,
            noise: None,
            damage: Damage::Clean,
            original: inventory(2),
            found: inventory(elements),
            psnr_db: Some(40.0),
            mean_px: Some(0.1).filter(|_| by == OWN),
            largest_px: Some(0.5).filter(|_| by == OWN),
            wall_s: Some(0.2),
            failure: None,
        }
    }

    #[test]
    fn the_summary_has_a_row_for_each_kind_of_picture() {
        let entries = vec![
            found(OWN, 48, None, 2),
            found(OWN, 48, None, 4),
            found(OWN, 48, Some(75), 6),
        ];
        let csv = InverseReport::new(entries).summary().csv();
        let rows: Vec<&str> = csv.lines().skip(1).collect();
        assert!(rows[0].starts_with("48 px,strokefit,2,1.50,"), "{csv}");
        assert!(
            rows[1].starts_with("\"48 px, JPEG 75\",strokefit,1,3.00,"),
            "{csv}"
        );
    }

    #[test]
    fn a_peer_that_fills_areas_has_no_distance() {
        let entries = vec![found(OWN, 48, None, 2), found("potrace", 48, None, 6)];
        let report = InverseReport::new(entries);
        let summary = report.summary().csv();
        let end = "48 px,potrace,1,3.00,0,0,40.0,40.0,,0.20\n";
        assert!(summary.ends_with(end), "{summary}");
        let line = report.entries[1].line();
        assert!(
            line.starts_with("clock at 48 px, potrace: 6 elements of 2,"),
            "{line}"
        );
        assert!(line.ends_with("no centre lines: pass"), "{line}");
    }

    #[test]
    fn what_failed_is_told_and_not_summed_up() {
        let failed = InverseEntry {
            failure: Some("potrace: killed".into()),
            psnr_db: None,
            ..found("potrace", 48, None, 0)
        };
        assert!(failed.line().ends_with("killed: FAIL"), "{}", failed.line());
        let report = InverseReport::new(vec![found("potrace", 48, None, 4), failed]);
        assert_eq!(report.failures(), 1);
        let summary = report.summary().csv();
        assert!(summary.contains("48 px,potrace,1,2.00,"), "{summary}");
    }

    #[test]
    fn all_who_found_drawings_have_their_lines() {
        let report = InverseReport::new(vec![
            found(OWN, 48, None, 2),
            found(OWN, 96, None, 3),
            found(OWN, 48, Some(75), 9),
            found("potrace", 48, None, 6),
        ]);
        let charts = report.charts().unwrap();
        let names: Vec<_> = charts.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["elements", "db", "bytes"]);
        let has = |chart: usize, word| charts[chart].1.contains(word);
        assert!(has(0, "as drawn") && has(0, "potrace") && !has(0, "JPEG"));
        assert!(has(1, "strokefit JPEG 75") && has(2, "potrace"));
        let marks = |chart: usize| charts[chart].1.matches("<circle").count();
        assert_eq!([marks(0), marks(1)], [3, 4]);
    }

    #[test]
    fn files_are_named_by_picture_and_finder() {
        let names = [
            found(OWN, 96, None, 2).svg_name(),
            found("potrace", 96, Some(75), 2).svg_name(),
        ];
        assert_eq!(names, ["clock-96.svg", "clock-96-jpeg75-potrace.svg"]);
    }
}
