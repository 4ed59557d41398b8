//! Findings of `strokefit-rig inverse` about drawings of any kind: how much of a drawing is found again, in how many
//! numbers.

mod summary;

use serde::{Deserialize, Serialize};

use super::cases::{Case, Cases};
use super::charts::{Axis, Value, against_size, elements};
use super::statistics::{median, optional};
use super::{Column, Damage, Table};
use strokefit::Result;

/// All cases of a run.
pub type ShapesReport = Cases<ShapesEntry>;

/// Contents of a file, without a rectangle that fills the page behind everything else.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Contents {
    /// Painted elements, each use of one that is used again.
    pub elements: usize,
    /// Subpaths of these.
    pub rings: usize,
    /// Ends, corners and control points of these; a circle is four curves.
    pub points: usize,
    /// Parameters of all shapes in the text.
    pub parameters: usize,
    /// All numbers in the text.
    pub numbers: usize,
    /// Bytes of the file.
    pub bytes: usize,
}

/// Elements as the artist's things, which are his groups and outermost shapes; each number is from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Belonging {
    /// The share of what an element changes that is one thing's; mean of the elements.
    pub purity: f64,
    /// The part of a thing that one element draws, in units of half the median and at most 1; mean of the things.
    pub coverage: f64,
    /// Nearness in painting order of the elements of a thing; mean of the things.
    pub locality: f64,
}

/// A drawing, a picture of it, and what was made of that picture.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ShapesEntry {
    /// The name of the drawing.
    pub drawing: String,
    /// The beginning of its name that it shares with others, or nothing.
    pub family: String,
    /// Who found it: `strokefit`, or another name.
    pub by: String,
    /// The longer side of the picture, px.
    pub side_px: usize,
    /// Damage of the picture.
    pub damage: Damage,
    /// The artist's file.
    pub original: Contents,
    /// The file that was found.
    pub found: Contents,
    /// Fidelity of the found file to the picture, dB.
    pub psnr_db: Option<f64>,
    /// Fidelity of the found file to the picture before it was damaged, dB.
    pub truth_db: Option<f64>,
    /// Fidelity of the artist's file to the picture before it was damaged, dB.
    pub artist_db: Option<f64>,
    /// Mean CIEDE2000 difference from the artist's file, both drawn at 1,024 px.
    pub delta_e: Option<f64>,
    /// Mean displacement of the artist's edges, px; `None` where there are none.
    pub displacement_px: Option<f64>,
    /// Elements as the artist's things; `None` where there are too many.
    pub belonging: Option<Belonging>,
    /// Wall time, s.
    pub wall_s: Option<f64>,
    /// Why nothing was made.
    pub failure: Option<String>,
}

impl ShapesEntry {
    /// Of what was found, a share of what the artist needed.
    pub fn ratio(&self, of: fn(&Contents) -> usize) -> f64 {
        of(&self.found) as f64 / of(&self.original).max(1) as f64
    }

    /// Fidelity beyond that of the artist's file, dB.
    fn beyond_artist_db(&self) -> Option<f64> {
        let (truth, artist) = self.truth_db.zip(self.artist_db)?;
        Some(truth - artist).filter(|db| db.is_finite())
    }
}

impl Case for ShapesEntry {
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
        self.damage
    }

    fn elements(&self) -> [usize; 2] {
        [self.found.elements, self.original.elements]
    }

    fn words(&self) -> String {
        let edges = self
            .displacement_px
            .map_or_else(|| "no edges".into(), |px| format!("edges {px:.3} px off"));
        format!(
            "{} elements of {}, {} parameters of {}, {} bytes of {}, {:.1} dB (the artist's {:.1}), \
             ΔE00 {:.2}, {edges}",
            self.found.elements,
            self.original.elements,
            self.found.parameters,
            self.original.parameters,
            self.found.bytes,
            self.original.bytes,
            self.truth_db.unwrap_or(f64::NAN),
            self.artist_db.unwrap_or(f64::NAN),
            self.delta_e.unwrap_or(f64::NAN)
        )
    }

    fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }
}

impl ShapesReport {
    /// Medians of each kind of picture and of each family, and all cases.
    pub fn markdown(&self) -> String {
        format!(
            "# Drawings found again\n\n{}\n## By family\n\n{}\n## All\n\n{}",
            self.summary().markdown(),
            self.families().markdown(),
            self.table().markdown()
        )
    }

    /// One row for each size and damage, and who found the drawings.
    pub fn summary(&self) -> Table {
        summary::by_picture(&self.made())
    }

    /// One row for each family, size and damage: what we made.
    pub fn families(&self) -> Table {
        summary::by_family(&self.made())
    }

    /// One row per case.
    pub fn table(&self) -> Table {
        Table::of(&COLUMNS, &self.entries)
    }

    /// Name and SVG of each plot.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`](strokefit::ErrorKind::Picture) when one cannot be drawn.
    pub fn charts(&self) -> Result<Vec<(&'static str, String)>> {
        let made = self.made();
        let ratio = "median ÷ artist's";
        let by_size: [(&str, Axis, Value<ShapesEntry>); 4] = [
            ("parameters", ("parameters", ratio, true), |cases| {
                Some(median(
                    cases.iter().map(|e| e.ratio(|c| c.parameters)).collect(),
                ))
            }),
            ("bytes", ("bytes", ratio, true), |cases| {
                Some(median(cases.iter().map(|e| e.ratio(|c| c.bytes)).collect()))
            }),
            ("db", ("median PSNR", "dB", false), |cases| {
                let db = cases.iter().filter_map(|e| e.truth_db);
                Some(median(db.filter(|db| db.is_finite()).collect()))
            }),
            (
                "delta",
                ("ΔE00 at 1,024 px", "mean of families", false),
                summary::mean_of_families,
            ),
        ];
        let mut plots = vec![("elements", elements(&made, false).svg()?)];
        for (name, axes, value) in by_size {
            plots.push((name, against_size(&made, axes, value).svg()?));
        }
        Ok(plots)
    }
}

const COLUMNS: [Column<ShapesEntry>; 28] = [
    ("drawing", |e| e.drawing.clone()),
    ("family", |e| e.family.clone()),
    ("side_px", |e| e.side_px.to_string()),
    ("damage", |e| e.damage.to_string()),
    ("by", |e| e.by.clone()),
    ("drawn_elements", |e| e.original.elements.to_string()),
    ("found_elements", |e| e.found.elements.to_string()),
    ("drawn_rings", |e| e.original.rings.to_string()),
    ("found_rings", |e| e.found.rings.to_string()),
    ("drawn_points", |e| e.original.points.to_string()),
    ("found_points", |e| e.found.points.to_string()),
    ("drawn_parameters", |e| e.original.parameters.to_string()),
    ("found_parameters", |e| e.found.parameters.to_string()),
    ("drawn_numbers", |e| e.original.numbers.to_string()),
    ("found_numbers", |e| e.found.numbers.to_string()),
    ("drawn_bytes", |e| e.original.bytes.to_string()),
    ("found_bytes", |e| e.found.bytes.to_string()),
    ("psnr_db", |e| optional(e.psnr_db, 2)),
    ("truth_db", |e| optional(e.truth_db, 2)),
    ("artist_db", |e| optional(e.artist_db, 2)),
    ("delta_e00", |e| optional(e.delta_e, 3)),
    ("displacement_px", |e| optional(e.displacement_px, 4)),
    ("purity", |e| optional(e.belonging.map(|b| b.purity), 3)),
    ("coverage", |e| optional(e.belonging.map(|b| b.coverage), 3)),
    ("locality", |e| optional(e.belonging.map(|b| b.locality), 3)),
    ("wall_s", |e| optional(e.wall_s, 3)),
    ("svg", Case::svg_name),
    ("failure", |e| e.failure.clone().unwrap_or_default()),
];

#[cfg(test)]
pub(in crate::report) mod tests {
    use super::super::cases::OWN;
    use super::*;

    /// A case of an artist's two elements.
    pub(in crate::report) fn found(by: &str, side_px: usize, elements: usize) -> ShapesEntry {
        let contents = |elements| Contents {
            elements,
            rings: elements,
            points: 4 * elements,
            parameters: 10 * elements,
            numbers: 20 * elements,
            bytes: 100 * elements,
        };
        ShapesEntry {
            drawing: "noto__hole".into(),
            family: "noto".into(),
            by: by.into(),
            side_px,
            original: contents(2),
            found: contents(elements),
            psnr_db: Some(40.0),
            truth_db: Some(42.0),
            artist_db: Some(39.0),
            delta_e: Some(0.5),
            displacement_px: Some(0.125),
            belonging: Some(Belonging {
                purity: 0.75,
                coverage: 1.0,
                locality: 0.5,
            }),
            wall_s: Some(0.2),
            ..ShapesEntry::default()
        }
    }

    #[test]
    fn a_line_tells_what_was_found_beside_what_was_drawn() {
        let line = found("potrace", 128, 6).line();
        assert_eq!(
            line,
            "noto__hole at 128 px, potrace: 6 elements of 2, 60 parameters of 20, 600 bytes of 200, \
             42.0 dB (the artist's 39.0), ΔE00 0.50, edges 0.125 px off: pass"
        );
        let failed = ShapesEntry {
            failure: Some("potrace: killed".into()),
            ..found("potrace", 128, 0)
        };
        assert!(failed.line().ends_with("killed: FAIL"), "{}", failed.line());
        assert_eq!(ShapesReport::new(vec![failed]).failures(), 1);
    }

    #[test]
    fn files_are_named_by_picture_and_finder() {
        let noisy = ShapesEntry {
            damage: Damage::Noise(8),
            ..found("strokefit strokes", 128, 2)
        };
        let names = [found(OWN, 128, 2).svg_name(), noisy.svg_name()];
        let expected = [
            "noto__hole-128.svg",
            "noto__hole-128-noise8-strokefit-strokes.svg",
        ];
        assert_eq!(names, expected);
    }

    #[test]
    fn the_table_has_a_row_for_each_case_and_the_json_reads_back() {
        let report = ShapesReport::new(vec![found(OWN, 128, 3)]);
        let csv = report.table().csv();
        let row = "noto__hole,noto,128,clean,strokefit,2,3,2,3,8,12,20,30,40,60,200,300,40.00,42.00,39.00,";
        assert!(csv.lines().nth(1).unwrap().starts_with(row), "{csv}");
        let text = serde_json::to_string(&report).unwrap();
        assert_eq!(serde_json::from_str::<ShapesReport>(&text).unwrap(), report);
    }

    #[test]
    fn all_who_found_drawings_have_their_lines() {
        let noisy = ShapesEntry {
            damage: Damage::Noise(8),
            ..found("strokefit", 128, 9)
        };
        let entries = vec![
            found("strokefit", 128, 2),
            found("strokefit", 256, 3),
            found("potrace", 128, 4),
            noisy,
        ];
        let charts = ShapesReport::new(entries).charts().unwrap();
        let names: Vec<_> = charts.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["elements", "parameters", "bytes", "db", "delta"]);
        let has = |chart: usize, word| charts[chart].1.contains(word);
        assert!(has(0, "as drawn") && has(0, "potrace") && !has(0, "noise"));
        assert!(has(1, "strokefit noise 8") && has(2, "potrace"));
        let marks = |chart: usize| charts[chart].1.matches("<circle").count();
        assert_eq!([marks(0), marks(1)], [3, 4]);
    }
}
