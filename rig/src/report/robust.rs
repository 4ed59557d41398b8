//! Findings of `strokefit-rig robust`: how much a drawing grows by damage of its picture, and how near it comes to the clean one.

use serde::{Deserialize, Serialize};

use super::cases::{Case, Cases, grouped};
use super::shapes::Contents;
use super::statistics::{mean, median, optional};
use super::{Column, Damage, Table};

/// All cases of a run.
pub type RobustReport = Cases<RobustEntry>;

/// A damaged picture, and what was made of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RobustEntry {
    /// The name of the picture.
    pub picture: String,
    /// Who drew it: `strokefit`, or another program's name.
    pub by: String,
    /// The longer side of the picture, px.
    pub side_px: usize,
    /// Damage of the picture.
    pub damage: Damage,
    /// The damage that we recognised, in words.
    pub recognised: Option<String>,
    /// The file that was made.
    pub found: Contents,
    /// Fidelity of that file to the damaged picture, dB.
    pub psnr_db: Option<f64>,
    /// Fidelity of that file to the clean picture, dB.
    pub truth_db: Option<f64>,
    /// Fidelity of the damaged picture to the clean one, dB; `None` in a report without damage, as JSON has no infinity.
    pub input_db: Option<f64>,
    /// Wall time, s.
    pub wall_s: Option<f64>,
    /// Why nothing was made.
    pub failure: Option<String>,
}

impl RobustEntry {
    /// True if the drawing is nearer to the clean picture than its damaged input.
    fn is_mended(&self) -> bool {
        self.truth_db > self.input_db
    }
}

impl Case for RobustEntry {
    fn name(&self) -> &str {
        &self.picture
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
        [self.found.elements; 2]
    }

    fn svg_name(&self) -> String {
        format!("{}{}", self.picture, self.suffix())
    }

    fn words(&self) -> String {
        let recognised = self.recognised.as_ref();
        let recognised = recognised.map(|words| format!(", left out {words}"));
        format!(
            "{} elements, {} numbers, {} bytes, {:.1} dB of the clean picture (the input {:.1}){}, {:.2} s",
            self.found.elements,
            self.found.numbers,
            self.found.bytes,
            self.truth_db.unwrap_or(f64::NAN),
            self.input_db.unwrap_or(f64::INFINITY),
            recognised.unwrap_or_default(),
            self.wall_s.unwrap_or(f64::NAN)
        )
    }

    fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }
}

impl RobustReport {
    /// Growth by each damage, and all cases.
    pub fn markdown(&self) -> String {
        format!(
            "# Damaged pictures\n\n{}\n## All\n\n{}",
            self.summary().markdown(),
            self.table().markdown()
        )
    }

    /// One row for each damage, and who drew the pictures.
    pub fn summary(&self) -> Table {
        let mut table = Table::new(&[
            "damage",
            "by",
            "pictures",
            "recognised",
            "elements ÷ clean, median",
            "numbers ÷, median",
            "numbers ÷, mean",
            "bytes ÷, median",
            "dB of the clean picture, mean",
            "the input's",
            "nearer than the input",
            "s, median",
            "s, most",
        ]);
        let damage = |entry: &RobustEntry| entry.damage.words().unwrap_or_else(|| "none".into());
        for (damage, by, cases) in grouped(&self.made(), damage, |e| e.by.clone()) {
            table.row(self.summed_up(damage, &by, &cases));
        }
        table
    }

    /// The cells of the summary for cases of one kind.
    fn summed_up(&self, damage: String, by: &str, cases: &[&RobustEntry]) -> [String; 13] {
        let grown = |of: fn(&Contents) -> usize| -> Vec<f64> {
            let clean = cases.iter().map(|entry| self.clean(entry));
            let pairs = cases.iter().zip(clean);
            let ratios = pairs.filter_map(|(entry, clean)| {
                Some(of(&entry.found) as f64 / of(&clean?.found).max(1) as f64)
            });
            ratios.collect()
        };
        let middle = |values| optional(Some(median(values)).filter(|m| m.is_finite()), 2);
        let known = |value: fn(&RobustEntry) -> Option<f64>| -> Vec<f64> {
            cases.iter().filter_map(|entry| value(entry)).collect()
        };
        let count = |is: fn(&RobustEntry) -> bool| cases.iter().filter(|entry| is(entry)).count();
        let finite = |values: Vec<f64>| mean(&values).filter(|mean| mean.is_finite());
        let seconds = known(|entry| entry.wall_s);
        let ours = cases
            .first()
            .filter(|entry| entry.is_own())
            .map(|_| count(|entry| entry.recognised.is_some()).to_string());
        [
            damage,
            by.to_owned(),
            cases.len().to_string(),
            ours.unwrap_or_default(),
            middle(grown(|contents| contents.elements)),
            middle(grown(|contents| contents.numbers)),
            optional(mean(&grown(|contents| contents.numbers)), 2),
            middle(grown(|contents| contents.bytes)),
            optional(finite(known(|entry| entry.truth_db)), 1),
            optional(finite(known(|entry| entry.input_db)), 1),
            count(RobustEntry::is_mended).to_string(),
            middle(seconds.clone()),
            optional(seconds.into_iter().reduce(f64::max), 2),
        ]
    }

    /// Who drew it also drew this, the clean picture.
    fn clean(&self, entry: &RobustEntry) -> Option<&RobustEntry> {
        self.entries.iter().find(|e| {
            let is_same = e.picture == entry.picture && e.by == entry.by;
            is_same && e.damage == Damage::Clean && e.failure.is_none()
        })
    }

    /// One row per case.
    pub fn table(&self) -> Table {
        Table::of(&COLUMNS, &self.entries)
    }
}

const COLUMNS: [Column<RobustEntry>; 15] = [
    ("picture", |e| e.picture.clone()),
    ("side_px", |e| e.side_px.to_string()),
    ("damage", |e| e.damage.to_string()),
    ("by", |e| e.by.clone()),
    ("recognised", |e| e.recognised.clone().unwrap_or_default()),
    ("elements", |e| e.found.elements.to_string()),
    ("parameters", |e| e.found.parameters.to_string()),
    ("numbers", |e| e.found.numbers.to_string()),
    ("bytes", |e| e.found.bytes.to_string()),
    ("psnr_db", |e| optional(e.psnr_db, 2)),
    ("truth_db", |e| optional(e.truth_db, 2)),
    ("input_db", |e| optional(e.input_db, 2)),
    ("wall_s", |e| optional(e.wall_s, 3)),
    ("svg", Case::svg_name),
    ("failure", |e| e.failure.clone().unwrap_or_default()),
];

#[cfg(test)]
mod tests {
    use super::super::cases::OWN;
    use super::*;

    fn found(picture: &str, damage: Damage, numbers: usize, truth_db: f64) -> RobustEntry {
        RobustEntry {
            picture: picture.into(),
            by: OWN.into(),
            side_px: 128,
            damage,
            recognised: (damage != Damage::Clean).then(|| "noise of 8.1 levels".into()),
            found: Contents {
                elements: 2,
                numbers,
                ..Contents::default()
            },
            truth_db: Some(truth_db),
            input_db: (damage != Damage::Clean).then_some(32.0),
            wall_s: Some(0.2),
            ..RobustEntry::default()
        }
    }

    #[test]
    fn growth_is_that_against_the_clean_picture() {
        let noise = Damage::Noise(8);
        let report = RobustReport::new(vec![
            found("a", Damage::Clean, 10, 45.0),
            found("a", noise, 12, 40.0),
            found("b", Damage::Clean, 100, 45.0),
            found("b", noise, 200, 30.0),
        ]);
        let csv = report.summary().csv();
        let rows: Vec<&str> = csv.lines().collect();
        assert_eq!(rows.len(), 3, "{csv}");
        let expected = "noise 8,strokefit,2,2,1.00,1.60,1.60,0.00,35.0,32.0,1,0.20,0.20";
        assert_eq!(rows[2], expected);
    }

    #[test]
    fn a_line_tells_what_was_made_and_recognised() {
        let entry = found("a", Damage::Noise(8), 12, 40.0);
        assert_eq!(
            entry.line(),
            "a at 128 px, noise 8: 2 elements, 12 numbers, 0 bytes, 40.0 dB of the clean picture (the input 32.0), \
             left out noise of 8.1 levels, 0.20 s: pass"
        );
        assert_eq!(entry.svg_name(), "a-noise8.svg");
        let failed = RobustEntry {
            failure: Some("vtracer: killed".into()),
            by: "vtracer".into(),
            ..entry
        };
        assert!(failed.line().ends_with(", vtracer: vtracer: killed: FAIL"));
        assert_eq!(RobustReport::new(vec![failed]).failures(), 1);
    }
}
