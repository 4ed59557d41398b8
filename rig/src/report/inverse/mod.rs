//! Findings of `strokefit-rig inverse`: how much of a drawing is found again in its picture.

mod charts;

use serde::{Deserialize, Serialize};

pub use charts::charts;

use super::cases::{self, Case, Cases};
use super::statistics::{distinct, mean, median, optional};
use super::{Damage, Table};

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

    /// The name of the SVG that was found.
    pub fn svg_name(&self) -> String {
        let (damage, by) = (self.damage().suffix(), cases::suffix(&self.by));
        format!("{}-{}{damage}{by}.svg", self.drawing, self.side_px)
    }

    /// Damage of the picture.
    pub fn damage(&self) -> Damage {
        match (self.jpeg, self.noise) {
            (Some(quality), _) => Damage::Jpeg(quality),
            (None, Some(levels)) => Damage::Noise(levels),
            (None, None) => self.damage,
        }
    }

    /// The picture in words: its size and damage.
    fn kind(&self) -> String {
        self.damage().of(self.side_px)
    }

    /// The line of standard output, ending in the verdict.
    pub fn line(&self) -> String {
        let case = (&*self.drawing, &*self.kind(), &*self.by);
        cases::line(self, case, || self.words())
    }

    /// Words for what was made.
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
}

impl Case for InverseEntry {
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
        for kind in distinct(self.entries.iter().map(InverseEntry::kind)) {
            for by in distinct(self.entries.iter().map(|entry| entry.by.clone())) {
                let made = self.made().into_iter();
                let made = made.filter(|e| e.kind() == kind && e.by == by);
                table.row(summed_up(&kind, &by, &made.collect::<Vec<_>>()));
            }
        }
        table
    }

    /// One row per case.
    pub fn table(&self) -> Table {
        let mut table = Table::new(&[
            "drawing",
            "side_px",
            "jpeg",
            "by",
            "drawn_elements",
            "found_elements",
            "drawn_lines",
            "found_lines",
            "drawn_points",
            "found_points",
            "drawn_bytes",
            "found_bytes",
            "psnr_db",
            "mean_px",
            "largest_px",
            "wall_s",
            "failure",
        ]);
        for entry in &self.entries {
            table.row([
                entry.drawing.clone(),
                entry.side_px.to_string(),
                entry
                    .jpeg
                    .map(|quality| quality.to_string())
                    .unwrap_or_default(),
                entry.by.clone(),
                entry.original.elements.to_string(),
                entry.found.elements.to_string(),
                entry.original.lines.to_string(),
                entry.found.lines.to_string(),
                entry.original.points.to_string(),
                entry.found.points.to_string(),
                entry.original.bytes.to_string(),
                entry.found.bytes.to_string(),
                optional(entry.psnr_db, 2),
                optional(entry.mean_px, 3),
                optional(entry.largest_px, 2),
                optional(entry.wall_s, 3),
                entry.failure.clone().unwrap_or_default(),
            ]);
        }
        table
    }
}

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
    fn files_are_named_by_picture_and_finder() {
        let names = [
            found(OWN, 96, None, 2).svg_name(),
            found("potrace", 96, Some(75), 2).svg_name(),
        ];
        assert_eq!(names, ["clock-96.svg", "clock-96-jpeg75-potrace.svg"]);
    }
}
