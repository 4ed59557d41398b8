//! Findings of `strokefit-rig inverse --ink`: which lines whose width varies come back as one element each.

use serde::{Deserialize, Serialize};
use strokefit::report::SCHEMA;

use super::statistics::{distinct, median, optional};
use super::{Column, OWN, Table};

/// What is found of the lines of a drawing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// Lines that are one element each.
    pub whole: usize,
    /// Elements of the file, but a rectangle that fills the page.
    pub elements: usize,
    /// The share of a line's ink that the best element on it covers; mean of the lines.
    pub recall: f64,
    /// Median and 90th percentile of the distance of the whole lines from the centre lines of their elements, px; `None` where these
    /// have none.
    pub centre_px: Option<[f64; 2]>,
    /// Median and 90th percentile of the error of half their width, px.
    pub half_width_px: Option<[f64; 2]>,
}

/// A drawing in ink, and what was made of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct InkEntry {
    /// The name of the drawing.
    pub drawing: String,
    /// Its kind.
    pub kind: String,
    /// Who drew it.
    pub by: String,
    /// True lines.
    pub lines: usize,
    /// What is found of them.
    pub found: Option<Found>,
    /// Numbers of paths and widths in the file.
    pub numbers: usize,
    /// Bytes of the file.
    pub bytes: usize,
    /// Fidelity to the picture, dB.
    pub psnr_db: Option<f64>,
    /// The same as people see it, 100 for equal pictures.
    pub ssimulacra2: Option<f64>,
    /// Wall time, s.
    pub wall_s: Option<f64>,
    /// Why nothing was made.
    pub failure: Option<String>,
}

/// All drawings of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InkReport {
    /// [`SCHEMA`].
    pub schema: u32,
    /// One per drawing, and who drew it, in order.
    pub entries: Vec<InkEntry>,
}

impl InkEntry {
    /// True for a drawing of ours.
    pub fn is_own(&self) -> bool {
        self.by == OWN
    }

    /// The name of the SVG that was made: not that of the program where it is ours.
    pub fn svg_name(&self) -> String {
        match self.by.as_str() {
            OWN => format!("{}.svg", self.drawing),
            by => format!("{}-{by}.svg", self.drawing),
        }
    }

    /// The line of standard output.
    pub fn line(&self) -> String {
        let start = format!("{}, {}", self.drawing, self.by);
        match (&self.failure, self.found) {
            (None, Some(found)) => format!(
                "{start}: {} of {} lines whole, {} elements, {:.1} dB, {} bytes, {:.1} s: pass",
                found.whole,
                self.lines,
                found.elements,
                self.psnr_db.unwrap_or(f64::NAN),
                self.bytes,
                self.wall_s.unwrap_or(f64::NAN)
            ),
            (why, _) => format!(
                "{start}: {}: FAIL",
                why.as_deref().unwrap_or("nothing found")
            ),
        }
    }
}

impl InkReport {
    /// The report of these drawings.
    pub fn new(entries: Vec<InkEntry>) -> Self {
        Self {
            schema: SCHEMA,
            entries,
        }
    }

    /// Number of drawings that could not be made.
    pub fn failures(&self) -> usize {
        let failed = self.entries.iter().filter(|e| e.failure.is_some());
        failed.count()
    }

    /// One row for each drawing.
    pub fn table(&self) -> Table {
        let groups = self.entries.iter().map(|entry| Group {
            name: entry.drawing.clone(),
            by: entry.by.clone(),
            entries: vec![entry],
        });
        let groups: Vec<Group<'_>> = groups.collect();
        Table::of(&columns(), &groups).without_empty_columns()
    }

    /// One row for each kind and for all, and who drew them: sums of lines, and medians of the rest.
    pub fn summary(&self) -> Table {
        let made: Vec<&InkEntry> = self.entries.iter().filter(|e| e.found.is_some()).collect();
        let mut groups = Vec::new();
        for by in distinct(made.iter().map(|e| &e.by)) {
            let own: Vec<&InkEntry> = made.iter().copied().filter(|e| e.by == *by).collect();
            for kind in distinct(own.iter().map(|e| &e.kind)) {
                groups.push(Group {
                    name: kind.clone(),
                    by: by.clone(),
                    entries: own.iter().copied().filter(|e| e.kind == *kind).collect(),
                });
            }
            groups.push(Group {
                name: "all".into(),
                by: by.clone(),
                entries: own,
            });
        }
        Table::of(&columns(), &groups).without_empty_columns()
    }

    /// The summary, and all drawings.
    pub fn markdown(&self) -> String {
        format!(
            "# Lines whose width varies\n\n{}\n## All\n\n{}",
            self.summary().markdown(),
            self.table().markdown()
        )
    }
}

/// Drawings of one row.
struct Group<'a> {
    name: String,
    by: String,
    entries: Vec<&'a InkEntry>,
}

impl Group<'_> {
    fn sum(&self, of: fn(&InkEntry) -> usize) -> String {
        let sum: usize = self.entries.iter().map(|entry| of(entry)).sum();
        sum.to_string()
    }

    fn median(&self, of: fn(&InkEntry) -> Option<f64>, digits: usize) -> String {
        let values = self.entries.iter().filter_map(|entry| of(entry)).collect();
        optional(Some(median(values)).filter(|m| m.is_finite()), digits)
    }
}

fn columns<'a>() -> [Column<Group<'a>>; 17] {
    [
        ("drawing", |g| g.name.clone()),
        ("by", |g| g.by.clone()),
        ("drawings", |g| g.entries.len().to_string()),
        ("lines", |g| g.sum(|e| e.lines)),
        ("whole", |g| {
            g.sum(|e| e.found.map_or(0, |found| found.whole))
        }),
        ("elements", |g| {
            g.median(|e| Some(e.found?.elements as f64), 0)
        }),
        ("recall", |g| g.median(|e| Some(e.found?.recall), 3)),
        ("numbers", |g| g.median(|e| Some(e.numbers as f64), 0)),
        ("bytes", |g| g.median(|e| Some(e.bytes as f64), 0)),
        ("dB", |g| g.median(|e| e.psnr_db, 2)),
        ("SSIMULACRA2", |g| g.median(|e| e.ssimulacra2, 1)),
        ("centre px", |g| {
            g.median(|e| Some(e.found?.centre_px?[0]), 3)
        }),
        ("centre px, p90", |g| {
            g.median(|e| Some(e.found?.centre_px?[1]), 3)
        }),
        ("half width px", |g| {
            g.median(|e| Some(e.found?.half_width_px?[0]), 3)
        }),
        ("half width px, p90", |g| {
            g.median(|e| Some(e.found?.half_width_px?[1]), 3)
        }),
        ("s", |g| g.median(|e| e.wall_s, 1)),
        ("failed", |g| {
            let failed = g.entries.iter().find_map(|e| e.failure.clone());
            failed.unwrap_or_default()
        }),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(kind: &str, whole: usize, recall: f64) -> InkEntry {
        InkEntry {
            drawing: format!("{kind}-1"),
            kind: kind.into(),
            by: OWN.into(),
            lines: 3,
            found: Some(Found {
                whole,
                elements: 4,
                recall,
                ..Found::default()
            }),
            ..InkEntry::default()
        }
    }

    #[test]
    fn kinds_have_the_sums_of_lines_and_medians_of_the_rest() {
        let failed = InkEntry {
            failure: Some("why".into()),
            found: None,
            ..entry("pen", 0, 0.0)
        };
        let report = InkReport::new(vec![
            entry("nib", 1, 0.2),
            entry("nib", 2, 0.4),
            entry("pen", 3, 0.9),
            failed,
        ]);
        let csv = report.summary().csv();
        let rows: Vec<&str> = csv.lines().collect();
        assert!(rows[1].starts_with("nib,strokefit,2,6,3,4,0.300"), "{csv}");
        assert!(rows[3].starts_with("all,strokefit,3,9,6,4,0.400"), "{csv}");
        assert_eq!((rows.len(), report.failures()), (4, 1));
        assert_eq!(report.table().csv().lines().count(), 5);
        assert!(report.entries[3].line().ends_with("why: FAIL"));
    }
}
