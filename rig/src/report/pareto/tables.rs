//! The report as tables and as Markdown.

use super::{ParetoEntry, ParetoReport, Spread, optional};
use crate::report::Table;
use strokefit::metrics::Quality;

/// Note on the meaning of the figures.
pub(super) const NOTE: &str = "Fidelity compares resvg's render of the file with the picture, over 8-bit RGB on white. \
                               Times cover making the drawing, not reading the picture or judging the file. CPU \
                               time is the sum over all threads, in hundredths of a second. Each case is a process \
                               of its own, and memory is its maximum, including the picture; the memory of other \
                               programs is sampled every 2 ms.";

impl ParetoReport {
    /// One row per drawing.
    pub fn table(&self) -> Table {
        let mut table = Table::new(&HEAD);
        self.entries
            .iter()
            .for_each(|entry| table.row(cells(entry)));
        table
    }

    /// One row per comparison.
    pub fn comparison_table(&self) -> Table {
        let mut table = Table::new(&["picture", "comparison", "figure", "verdict"]);
        for c in &self.comparisons {
            table.row([&c.picture, &c.claim, &c.figure, &c.holds.word().to_owned()]);
        }
        table
    }

    /// One row per set of seeds.
    pub fn spread_table(&self) -> Table {
        let mut table = Table::new(&[
            "picture",
            "drawing",
            "seeds",
            "PSNR dB",
            "CPU s",
            "gzip bytes",
        ]);
        for spread in &self.spreads {
            let Spread {
                psnr_db,
                cpu_s,
                gzip_bytes,
                ..
            } = spread;
            let pair = |[mean, deviation]: [f64; 2], digits| {
                format!("{mean:.digits$} ± {deviation:.digits$}")
            };
            table.row([
                spread.picture.clone(),
                spread.label.clone(),
                spread.seeds.to_string(),
                pair(*psnr_db, 2),
                pair(*cpu_s, 2),
                pair(*gzip_bytes, 0),
            ]);
        }
        table
    }

    /// Everything as Markdown.
    pub fn markdown(&self) -> String {
        let all = self.quoted().into_iter().chain(self.details());
        let section =
            |(title, table): (&str, Table)| format!("\n## {title}\n\n{}", table.markdown());
        let sections: String = all.map(section).collect();
        format!("# Cost against error\n\n{NOTE}\n{sections}")
    }

    /// Titles and tables to quote.
    pub(super) fn quoted(&self) -> [(&'static str, Table); 5] {
        [
            ("Fits", self.preset_table()),
            ("The article's recipe", self.recipe_table()),
            ("Other programs", self.peer_table()),
            ("Spread over seeds", self.spread_table()),
            ("Comparisons", self.comparison_table()),
        ]
    }

    /// Tables that the quoted ones rest on.
    pub(super) fn details(&self) -> [(&'static str, Table); 1] {
        [("Drawings", self.table())]
    }
}

const HEAD: [&str; 16] = [
    "picture",
    "family",
    "settings",
    "strokes",
    "psnr_db",
    "ssim",
    "ssimulacra2",
    "l1",
    "cpu_s",
    "wall_s",
    "peak_mib",
    "svg_bytes",
    "gzip_bytes",
    "agreement_db",
    "seed",
    "failure",
];

fn cells(entry: &ParetoEntry) -> [String; 16] {
    let quality = |f: fn(Quality) -> f64| entry.fidelity.map(f);
    let mib = entry
        .peak_rss_bytes
        .map(|bytes| bytes as f64 / f64::from(1 << 20));
    let whole = |v: Option<f64>| optional(v, 0);
    [
        entry.picture.clone(),
        entry.family.clone(),
        entry.label.clone(),
        whole(entry.strokes.map(|n| n as f64)),
        optional(quality(|q| q.psnr_db), 2),
        optional(quality(|q| q.ssim), 4),
        optional(quality(|q| q.ssimulacra2), 1),
        optional(quality(|q| q.l1), 5),
        optional(entry.cpu_s, 2),
        optional(entry.wall_s, 2),
        optional(mib, 0),
        entry.svg_bytes.to_string(),
        entry.gzip_bytes.to_string(),
        optional(entry.agreement_db, 1),
        whole(entry.seed.map(|seed| seed as f64)),
        entry.failure.clone().unwrap_or_default(),
    ]
}
