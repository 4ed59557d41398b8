//! The report as tables and as Markdown.

use super::super::statistics::optional;
use super::{Comparison, ParetoEntry, ParetoReport, Spread};
use crate::report::{Column, Table};

/// Note on the meaning of the figures.
const NOTE: &str = "Fidelity compares resvg's render of the file with the picture, over 8-bit RGB on white. \
                               Times cover making the drawing, not reading the picture or judging the file. CPU \
                               time is the sum over all threads, in hundredths of a second. Each case is a process \
                               of its own, and memory is its maximum, including the picture; the memory of other \
                               programs is sampled every 2 ms.";

impl ParetoReport {
    /// One row per drawing.
    pub fn table(&self) -> Table {
        Table::of(&COLUMNS, &self.entries)
    }

    /// One row per comparison.
    pub fn comparison_table(&self) -> Table {
        let columns: [Column<Comparison>; 4] = [
            ("picture", |c| c.picture.clone()),
            ("comparison", |c| c.claim.clone()),
            ("figure", |c| c.figure.clone()),
            ("verdict", |c| c.holds.word().to_owned()),
        ];
        Table::of(&columns, &self.comparisons)
    }

    /// One row per set of seeds.
    pub fn spread_table(&self) -> Table {
        let columns: [Column<Spread>; 6] = [
            ("picture", |s| s.picture.clone()),
            ("drawing", |s| s.label.clone()),
            ("seeds", |s| s.seeds.to_string()),
            ("PSNR dB", |s| pair(s.psnr_db, 2)),
            ("CPU s", |s| pair(s.cpu_s, 2)),
            ("gzip bytes", |s| pair(s.gzip_bytes, 0)),
        ];
        Table::of(&columns, &self.spreads)
    }

    /// Everything as Markdown, from tables to quote to those that they rest on.
    pub fn markdown(&self) -> String {
        let sections = [
            ("Fits", self.preset_table()),
            ("The article's recipe", self.recipe_table()),
            ("Spread over seeds", self.spread_table()),
            ("Comparisons", self.comparison_table()),
            ("Drawings", self.table()),
        ];
        let section =
            |(title, table): (&str, Table)| format!("\n## {title}\n\n{}", table.markdown());
        let sections: String = sections.map(section).concat();
        format!("# Cost against error\n\n{NOTE}\n{sections}")
    }
}

const COLUMNS: [Column<ParetoEntry>; 16] = [
    ("picture", |e| e.picture.clone()),
    ("family", |e| e.family.clone()),
    ("settings", |e| e.label.clone()),
    ("strokes", |e| optional(e.strokes.map(|n| n as f64), 0)),
    ("psnr_db", |e| optional(e.fidelity.map(|q| q.psnr_db), 2)),
    ("ssim", |e| optional(e.fidelity.map(|q| q.ssim), 4)),
    ("ssimulacra2", |e| {
        optional(e.fidelity.map(|q| q.ssimulacra2), 1)
    }),
    ("l1", |e| optional(e.fidelity.map(|q| q.l1), 5)),
    ("cpu_s", |e| optional(e.cpu_s, 2)),
    ("wall_s", |e| optional(e.wall_s, 2)),
    ("peak_mib", |e| {
        let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        optional(e.peak_rss_bytes.map(mib), 0)
    }),
    ("svg_bytes", |e| e.svg_bytes.to_string()),
    ("gzip_bytes", |e| e.gzip_bytes.to_string()),
    ("agreement_db", |e| optional(e.agreement_db, 1)),
    ("seed", |e| optional(e.seed.map(|seed| seed as f64), 0)),
    ("failure", |e| e.failure.clone().unwrap_or_default()),
];

/// A mean and its standard deviation.
fn pair([mean, deviation]: [f64; 2], digits: usize) -> String {
    format!("{mean:.digits$} ± {deviation:.digits$}")
}
