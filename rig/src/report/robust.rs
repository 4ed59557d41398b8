//! Findings of `strokefit-rig robust`: how much a drawing grows by damage of its picture, and how near it comes to the clean one.

use serde::{Deserialize, Serialize};

use super::cases::{self, Case, Cases, OWN};
use super::shapes::Contents;
use super::statistics::{distinct, mean, median, optional};
use super::{Damage, Table};

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
    /// The name of the SVG that was made.
    pub fn svg_name(&self) -> String {
        let (damage, by) = (self.damage.suffix(), cases::suffix(&self.by));
        format!("{}{damage}{by}.svg", self.picture)
    }

    /// The line of standard output, ending in the verdict.
    pub fn line(&self) -> String {
        let case = (&*self.picture, &*self.damage.of(self.side_px), &*self.by);
        cases::line(self, case, || self.words())
    }

    /// Words for what was made.
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

    /// True if the drawing is nearer to the clean picture than its damaged input.
    fn is_mended(&self) -> bool {
        self.truth_db > self.input_db
    }
}

impl Case for RobustEntry {
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
        let made = self.made();
        for damage in distinct(made.iter().map(|e| e.damage.to_string())) {
            for by in distinct(made.iter().map(|e| e.by.clone())) {
                let cases = made.iter().copied();
                let cases = cases.filter(|e| e.damage.to_string() == damage && e.by == by);
                let cases: Vec<_> = cases.collect();
                if let Some(first) = cases.first() {
                    let words = first.damage.words().unwrap_or_else(|| "none".into());
                    table.row(self.summed_up(words, &by, &cases));
                }
            }
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
        let ours = (by == OWN).then(|| count(|entry| entry.recognised.is_some()).to_string());
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
        let mut table = Table::new(&[
            "picture",
            "side_px",
            "damage",
            "by",
            "recognised",
            "elements",
            "parameters",
            "numbers",
            "bytes",
            "psnr_db",
            "truth_db",
            "input_db",
            "wall_s",
            "svg",
            "failure",
        ]);
        for entry in &self.entries {
            table.row([
                entry.picture.clone(),
                entry.side_px.to_string(),
                entry.damage.to_string(),
                entry.by.clone(),
                entry.recognised.clone().unwrap_or_default(),
                entry.found.elements.to_string(),
                entry.found.parameters.to_string(),
                entry.found.numbers.to_string(),
                entry.found.bytes.to_string(),
                optional(entry.psnr_db, 2),
                optional(entry.truth_db, 2),
                optional(entry.input_db, 2),
                optional(entry.wall_s, 3),
                entry.svg_name(),
                entry.failure.clone().unwrap_or_default(),
            ]);
        }
        table
    }
}

#[cfg(test)]
mod tests {
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
