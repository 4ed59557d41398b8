//! Findings of `strokefit-rig inverse` and `robust`: how much of a drawing, or of a clean picture, is found again in a picture of it.

mod summary;

use serde::{Deserialize, Serialize};
use strokefit::report::SCHEMA;

pub use super::OWN;
use super::statistics::optional;
use super::{Column, Damage, Table};

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

/// What an artist's elements hide beneath others, px².
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hidden {
    /// The hidden parts of the artist's elements.
    pub px: usize,
    /// Where they and those of the same elements of the file differ.
    pub apart_px: usize,
}

impl Hidden {
    /// The difference in units of what is hidden.
    pub fn apart(&self) -> f64 {
        self.apart_px as f64 / self.px.max(1) as f64
    }
}

/// A picture, and what was made of it. What needs the artist's file is `None` without one.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseEntry {
    /// The name of the drawing or of the clean picture.
    pub drawing: String,
    /// The beginning of its name that it shares with others, or nothing.
    pub family: String,
    /// Who drew it: [`OWN`], or another program or way to draw.
    pub by: String,
    /// The longer side of the picture, px.
    pub side_px: usize,
    /// Damage of the picture.
    pub damage: Damage,
    /// The damage that we recognised, in words.
    pub recognised: Option<String>,
    /// The artist's file.
    pub original: Option<Contents>,
    /// The file that was made.
    pub found: Contents,
    /// Fidelity of that file to the picture, dB.
    pub psnr_db: Option<f64>,
    /// Fidelity of that file to the picture before it was damaged, dB.
    pub truth_db: Option<f64>,
    /// SSIMULACRA2 of that file beside the picture before it was damaged.
    pub ssimulacra2: Option<f64>,
    /// Share of the small things of the picture before it was damaged that are kept.
    pub details_kept: Option<f64>,
    /// Largest difference of a channel where the picture has its most common colours, means, levels of 255.
    pub page_levels: Option<f64>,
    /// Fidelity of the artist's file to the picture before it was damaged, dB.
    pub artist_db: Option<f64>,
    /// Fidelity of the picture to itself before it was damaged, dB; `None` in a report without damage, as JSON has no infinity.
    pub input_db: Option<f64>,
    /// Mean CIEDE2000 difference from the artist's file, both drawn at 1,024 px.
    pub delta_e: Option<f64>,
    /// Mean displacement of the artist's edges, px; `None` where there are none.
    pub displacement_px: Option<f64>,
    /// Mean distance between the centre lines of both, px; `None` where either has no strokes.
    pub mean_px: Option<f64>,
    /// Largest distance between them, px.
    pub largest_px: Option<f64>,
    /// Elements as the artist's things; `None` where there are too many.
    pub belonging: Option<Belonging>,
    /// Their hidden parts; `None` where nothing is hidden, or there are too many.
    #[serde(default)]
    pub hidden: Option<Hidden>,
    /// Wall time, s.
    pub wall_s: Option<f64>,
    /// Why nothing was made.
    pub failure: Option<String>,
}

/// All cases of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CasesReport {
    /// [`SCHEMA`].
    pub schema: u32,
    /// One per picture, and who drew that, in order.
    pub entries: Vec<CaseEntry>,
}

impl CaseEntry {
    /// The picture in words: its size and damage.
    pub fn kind(&self) -> String {
        self.damage.of(self.side_px)
    }

    /// The damage of the picture in words, or `none`.
    pub fn damage_words(&self) -> String {
        self.damage.words().unwrap_or_else(|| "none".into())
    }

    /// True for a drawing of ours.
    pub fn is_own(&self) -> bool {
        self.by == OWN
    }

    /// The name of the SVG that was made: not that of the program where it is ours.
    pub fn svg_name(&self) -> String {
        let by = (!self.is_own()).then(|| format!("-{}", self.by.replace(' ', "-")));
        let (name, by) = (&self.drawing, by.unwrap_or_default());
        format!("{name}-{}{}{by}.svg", self.side_px, self.damage.suffix())
    }

    /// What was found, as a share of what the artist needed.
    fn ratio(&self, of: fn(&Contents) -> usize) -> Option<f64> {
        Some(of(&self.found) as f64 / of(self.original.as_ref()?).max(1) as f64)
    }

    /// Fidelity beyond that of the artist's file, dB.
    fn beyond_artist_db(&self) -> Option<f64> {
        let (truth, artist) = self.truth_db.zip(self.artist_db)?;
        Some(truth - artist).filter(|db| db.is_finite())
    }

    /// The line of standard output: whose picture of what, what was made of it, and the verdict.
    pub fn line(&self) -> String {
        let by = (!self.is_own()).then(|| format!(", {}", self.by));
        let (drawing, kind) = (&self.drawing, self.kind());
        let start = format!("{drawing} at {kind}{}", by.unwrap_or_default());
        match &self.failure {
            Some(why) => format!("{start}: {why}: FAIL"),
            None => format!("{start}: {}: pass", self.words()),
        }
    }

    fn words(&self) -> String {
        let count = |what: &str, of: fn(&Contents) -> usize| {
            let beside = self
                .original
                .map(|original| format!(" of {}", of(&original)));
            format!("{} {what}{}", of(&self.found), beside.unwrap_or_default())
        };
        let beside = |whose: &str, db: Option<f64>| {
            let db = db.filter(|db| db.is_finite());
            db.map_or_else(String::new, |db| format!(" ({whose} {db:.1})"))
        };
        let px = |what: &str, px: Option<f64>, digits: usize| {
            px.map(|px| format!("{what} {px:.digits$} px off"))
        };
        let fidelity = format!(
            "{:.1} dB{}{}",
            self.truth_db.unwrap_or(f64::NAN),
            beside("the artist's", self.artist_db),
            beside("the input", self.input_db)
        );
        let words = [
            Some(count("elements", |c| c.elements)),
            Some(count("points", |c| c.points)),
            Some(count("parameters", |c| c.parameters)),
            Some(count("bytes", |c| c.bytes)),
            Some(fidelity),
            self.delta_e.map(|apart| format!("ΔE00 {apart:.2}")),
            px("edges", self.displacement_px, 3),
            px("centre lines", self.mean_px, 2),
            self.recognised
                .as_ref()
                .map(|what| format!("left out {what}")),
        ];
        words.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }
}

impl CasesReport {
    /// The report of these cases.
    pub fn new(entries: Vec<CaseEntry>) -> Self {
        Self {
            schema: SCHEMA,
            entries,
        }
    }

    /// Number of drawings that could not be made.
    pub fn failures(&self) -> usize {
        self.entries.len() - self.made().len()
    }

    /// The cases of which something was made.
    fn made(&self) -> Vec<&CaseEntry> {
        let entries = self.entries.iter();
        entries.filter(|entry| entry.failure.is_none()).collect()
    }

    /// Sums over pictures of one `kind` and over families, and all cases.
    pub fn markdown(&self, kind: fn(&CaseEntry) -> String) -> String {
        let families = self.families();
        let by_family = families.map(|table| format!("## By family\n\n{}\n", table.markdown()));
        format!(
            "# Drawings found again\n\n{}\n{}## All\n\n{}",
            self.summary(kind).markdown(),
            by_family.unwrap_or_default(),
            self.table().markdown()
        )
    }

    /// One row for each kind of picture, and who drew it.
    pub fn summary(&self, kind: fn(&CaseEntry) -> String) -> Table {
        summary::by_picture(&self.made(), kind)
    }

    /// One row for each family, size and damage: what we made. `None` without families.
    pub fn families(&self) -> Option<Table> {
        let has_families = self.entries.iter().any(|e| !e.family.is_empty());
        has_families.then(|| summary::by_family(&self.made()))
    }

    /// One row per case, without columns that nothing is known of.
    pub fn table(&self) -> Table {
        Table::of(&COLUMNS, &self.entries).without_empty_columns()
    }
}

fn drawn(e: &CaseEntry, of: fn(&Contents) -> usize) -> String {
    e.original.map_or_else(String::new, |c| of(&c).to_string())
}

const COLUMNS: [Column<CaseEntry>; 36] = [
    ("drawing", |e| e.drawing.clone()),
    ("family", |e| e.family.clone()),
    ("side_px", |e| e.side_px.to_string()),
    ("damage", |e| e.damage.to_string()),
    ("by", |e| e.by.clone()),
    ("recognised", |e| e.recognised.clone().unwrap_or_default()),
    ("drawn_elements", |e| drawn(e, |c| c.elements)),
    ("found_elements", |e| e.found.elements.to_string()),
    ("drawn_rings", |e| drawn(e, |c| c.rings)),
    ("found_rings", |e| e.found.rings.to_string()),
    ("drawn_points", |e| drawn(e, |c| c.points)),
    ("found_points", |e| e.found.points.to_string()),
    ("drawn_parameters", |e| drawn(e, |c| c.parameters)),
    ("found_parameters", |e| e.found.parameters.to_string()),
    ("drawn_numbers", |e| drawn(e, |c| c.numbers)),
    ("found_numbers", |e| e.found.numbers.to_string()),
    ("drawn_bytes", |e| drawn(e, |c| c.bytes)),
    ("found_bytes", |e| e.found.bytes.to_string()),
    ("psnr_db", |e| optional(e.psnr_db, 2)),
    ("truth_db", |e| optional(e.truth_db, 2)),
    ("ssimulacra2", |e| optional(e.ssimulacra2, 1)),
    ("details_kept", |e| optional(e.details_kept, 3)),
    ("page_levels", |e| optional(e.page_levels, 1)),
    ("artist_db", |e| optional(e.artist_db, 2)),
    ("input_db", |e| optional(e.input_db, 2)),
    ("delta_e00", |e| optional(e.delta_e, 3)),
    ("displacement_px", |e| optional(e.displacement_px, 4)),
    ("mean_px", |e| optional(e.mean_px, 3)),
    ("largest_px", |e| optional(e.largest_px, 2)),
    ("purity", |e| optional(e.belonging.map(|b| b.purity), 3)),
    ("coverage", |e| optional(e.belonging.map(|b| b.coverage), 3)),
    ("locality", |e| optional(e.belonging.map(|b| b.locality), 3)),
    ("hidden_apart", |e| optional(e.hidden.map(|h| h.apart()), 3)),
    ("wall_s", |e| optional(e.wall_s, 3)),
    ("svg", CaseEntry::svg_name),
    ("failure", |e| e.failure.clone().unwrap_or_default()),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// A case of an artist's two elements.
    pub(super) fn found(by: &str, side_px: usize, elements: usize) -> CaseEntry {
        let contents = |elements| Contents {
            elements,
            rings: elements,
            points: 4 * elements,
            parameters: 10 * elements,
            numbers: 20 * elements,
            bytes: 100 * elements,
        };
        CaseEntry {
            drawing: "noto__hole".into(),
            family: "noto".into(),
            by: by.into(),
            side_px,
            original: Some(contents(2)),
            found: contents(elements),
            psnr_db: Some(40.0),
            truth_db: Some(42.0),
            ssimulacra2: Some(80.0),
            details_kept: Some(0.9),
            page_levels: Some(1.0),
            artist_db: Some(39.0),
            delta_e: Some(0.5),
            displacement_px: Some(0.125),
            belonging: Some(Belonging {
                purity: 0.75,
                coverage: 1.0,
                locality: 0.5,
            }),
            wall_s: Some(0.2),
            ..CaseEntry::default()
        }
    }

    #[test]
    fn a_line_tells_what_was_found_beside_what_was_drawn() {
        let entry = found("potrace", 128, 6);
        assert_eq!(
            entry.line(),
            "noto__hole at 128 px, potrace: 6 elements of 2, 24 points of 8, 60 parameters of 20, 600 bytes of 200, \
             42.0 dB (the artist's 39.0), ΔE00 0.50, edges 0.125 px off: pass"
        );
        let failed = CaseEntry {
            failure: Some("potrace: killed".into()),
            ..entry
        };
        assert!(failed.line().ends_with("killed: FAIL"), "{}", failed.line());
        assert_eq!(CasesReport::new(vec![failed]).failures(), 1);
    }

    #[test]
    fn a_line_of_a_damaged_picture_tells_what_was_recognised() {
        let entry = CaseEntry {
            drawing: "a".into(),
            by: OWN.into(),
            side_px: 96,
            damage: Damage::Noise(8),
            recognised: Some("noise of 8.1 levels".into()),
            truth_db: Some(40.0),
            input_db: Some(32.0),
            mean_px: Some(0.125),
            ..CaseEntry::default()
        };
        assert_eq!(
            entry.line(),
            "a at 96 px, noise 8: 0 elements, 0 points, 0 parameters, 0 bytes, 40.0 dB (the input 32.0), \
             centre lines 0.12 px off, left out noise of 8.1 levels: pass"
        );
    }

    #[test]
    fn files_are_named_by_picture_and_finder() {
        let noisy = CaseEntry {
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
        let report = CasesReport::new(vec![found(OWN, 128, 3)]);
        let csv = report.table().csv();
        let row = "noto__hole,noto,128,clean,strokefit,2,3,2,3,8,12,20,30,40,60,200,300,40.00,42.00,80.0,0.900,1.0,39.00,0.500,";
        assert!(csv.lines().nth(1).unwrap().starts_with(row), "{csv}");
        let text = serde_json::to_string(&report).unwrap();
        assert_eq!(serde_json::from_str::<CasesReport>(&text).unwrap(), report);
    }
}
