//! The report of `strokefit-rig pareto`: cost against error of our drawings and others'.
//!
//! An entry holds all that is known of one drawing. Fronts, comparisons, tables and plots are made
//! from entries alone, so they can be made again without a fit.

mod charts;
mod compare;
mod front;
mod headline;
mod peers;
mod recipe;
mod spread;
mod tables;

use serde::{Deserialize, Serialize};
use strokefit::fit::StageRecord;
use strokefit::report::SCHEMA;

pub use charts::charts;
pub use compare::{Comparison, Holds};
pub use front::front;
pub use spread::{Spread, spreads};

use super::statistics::{distinct, optional};
use peers::AgainstPeer;
use recipe::{AtEqualStrokes, AtEqualTime};
use strokefit::metrics::Quality;

/// The family of the drawings of the article's recipe.
pub const ARTICLE: &str = "article";
/// The family of our own drawings.
pub use super::cases::OWN;

/// All drawings of a run, and what follows from them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParetoReport {
    /// [`SCHEMA`].
    pub schema: u32,
    /// One per drawing.
    pub entries: Vec<ParetoEntry>,
    /// Claims, and whether they hold.
    pub comparisons: Vec<Comparison>,
    /// Spreads over seeds.
    pub spreads: Vec<Spread>,
}

/// One drawing.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ParetoEntry {
    /// The picture's name, without folder and ending.
    pub picture: String,
    /// A hash of its pixels.
    pub digest: String,
    /// Its width in px.
    pub width: usize,
    /// Its height in px.
    pub height: usize,
    /// Who made the drawing: `strokefit`, `article`, or another's name.
    pub family: String,
    /// With which settings; family and label tell the drawings of a picture apart.
    pub label: String,
    /// Amount of work, for our own: `stages`, `draft`, `balanced` or `best`.
    pub preset: Option<String>,
    /// The coverage function, for our own.
    pub coverage: Option<String>,
    /// Key of every random draw.
    pub seed: Option<u64>,
    /// Strokes in the file.
    pub strokes: Option<usize>,
    /// Wall time of making it, s.
    pub wall_s: Option<f64>,
    /// CPU time of making it, all threads, s; to a hundredth.
    pub cpu_s: Option<f64>,
    /// Most memory held at once while it was made, the picture included, bytes.
    pub peak_rss_bytes: Option<u64>,
    /// Length of the SVG, bytes.
    pub svg_bytes: usize,
    /// Its length after gzip, bytes.
    pub gzip_bytes: usize,
    /// The file as resvg draws it against the picture.
    pub fidelity: Option<Quality>,
    /// The file as resvg draws it against our own soft render, dB, for our own; `null` when perfect.
    pub agreement_db: Option<f64>,
    /// The stages, for our own.
    pub stages: Vec<StageRecord>,
    /// Why there is no drawing, or none that is as it was fitted.
    pub failure: Option<String>,
}

impl ParetoEntry {
    /// Name that tells the drawing from all others.
    pub fn id(&self) -> String {
        format!(
            "{} {} {} {}",
            self.picture, self.digest, self.family, self.label
        )
    }

    /// The name of its SVG in the folder `svg`.
    pub fn svg_name(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        let mut name: String = self.id().chars().map(plain).collect();
        while name.contains("--") {
            name = name.replace("--", "-");
        }
        format!("{}.svg", name.trim_matches('-'))
    }

    /// Number of strokes that a fit was given, in words: the second word of its label.
    fn asked_strokes(&self) -> Option<&str> {
        self.label.split(' ').nth(1).filter(|_| self.family == OWN)
    }

    /// Fidelity in dB, where there is a drawing.
    pub fn psnr_db(&self) -> Option<f64> {
        self.fidelity.map(|quality| quality.psnr_db)
    }

    /// Fidelity as people see it, where there is a drawing.
    pub fn ssimulacra2(&self) -> Option<f64> {
        self.fidelity.map(|quality| quality.ssimulacra2)
    }

    /// The line of standard output, ending in the verdict.
    pub fn line(&self) -> String {
        let Self {
            picture,
            family,
            label,
            ..
        } = self;
        let verdict = match &self.failure {
            Some(why) => format!("{why}: FAIL"),
            None => "pass".into(),
        };
        let Some(quality) = self.fidelity else {
            return format!("{picture}, {family} {label}: {verdict}");
        };
        format!(
            "{picture}, {family} {label}: {:.2} dB, SSIM {:.4}, SSIMULACRA2 {:.1}, {} s of CPU, {} bytes, {} after gzip: {verdict}",
            quality.psnr_db,
            quality.ssim,
            quality.ssimulacra2,
            optional(self.cpu_s, 2),
            self.svg_bytes,
            self.gzip_bytes
        )
    }
}

impl ParetoReport {
    /// The report of these drawings.
    pub fn new(entries: Vec<ParetoEntry>) -> Self {
        Self {
            schema: SCHEMA,
            comparisons: comparisons(&entries),
            spreads: spreads(&entries),
            entries,
        }
    }

    /// Number of drawings that failed, and of claims that do not hold.
    pub fn failures(&self) -> usize {
        let failed = self.entries.iter().filter(|e| e.failure.is_some());
        let refuted = self
            .comparisons
            .iter()
            .filter(|c| c.holds == Holds::Refuted);
        failed.count() + refuted.count()
    }
}

/// Comparisons that follow from `entries`. That fits beat the article's own run by so much is a claim, and a failure
/// where it does not hold; all other comparisons are findings.
pub fn comparisons(entries: &[ParetoEntry]) -> Vec<Comparison> {
    let mut all = Vec::new();
    for picture in pictures(entries) {
        let here: Vec<&ParetoEntry> = entries.iter().filter(|e| e.picture == picture).collect();
        all.extend(
            AtEqualStrokes::all(&here)
                .iter()
                .map(AtEqualStrokes::comparison),
        );
        all.extend(AtEqualTime::all(&here).iter().map(AtEqualTime::comparison));
        all.extend(AgainstPeer::all(&here).iter().map(AgainstPeer::comparison));
    }
    all
}

/// Pictures in the order of their first entries.
pub(super) fn pictures(entries: &[ParetoEntry]) -> Vec<&str> {
    distinct(entries.iter().map(|entry| entry.picture.as_str()))
}

#[cfg(test)]
pub(super) fn drawing(
    family: &str,
    label: &str,
    cpu_s: f64,
    gzip_bytes: usize,
    psnr_db: f64,
) -> ParetoEntry {
    ParetoEntry {
        picture: "cat".into(),
        family: family.into(),
        label: label.into(),
        cpu_s: Some(cpu_s),
        gzip_bytes,
        seed: Some(0),
        strokes: Some(100),
        fidelity: Some(Quality {
            details_kept: None,
            psnr_db,
            ssim: 0.9,
            mse: strokefit::math::powf(10.0, -psnr_db / 10.0),
            l1: 0.01,
            ssimulacra2: 40.0 + psnr_db,
        }),
        ..ParetoEntry::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_ends_in_its_verdict() {
        let mut entry = drawing(OWN, "draft 100 smoothstep seed 0", 0.5, 900, 30.0);
        assert!(entry.line().ends_with(": pass"), "{}", entry.line());
        entry.failure = Some("killed".into());
        assert!(entry.line().ends_with("killed: FAIL"), "{}", entry.line());
    }

    #[test]
    fn file_names_are_plain() {
        let entry = drawing("a/b", "x > y", 1.0, 1, 20.0);
        assert_eq!(entry.svg_name(), "cat-a-b-x-y.svg");
    }
}
