//! Findings of `strokefit-rig compare`: two programs over the same pictures.

use serde::{Deserialize, Serialize};
use strokefit::report::SCHEMA;

use super::Table;
use super::statistics::{distinct, mean, optional};

/// Fidelity of a drawing that cannot be told from its picture, dB: more does not count, as means would be of it alone.
pub const MOST_DB: f64 = 60.0;

/// Drawings of a kind that are named.
const WORST: usize = 10;

/// What one program made of a picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// Fidelity, at most [`MOST_DB`]; with alpha, on black or white, whichever is worse.
    pub psnr_db: f64,
    /// Fidelity as people see it, on white.
    pub ssimulacra2: f64,
    /// Share of small things that are kept.
    pub details_kept: Option<f64>,
    /// Mean colour difference (ΔE00) to the artist's drawing at 1,024 px.
    pub delta_e: Option<f64>,
    /// Painted elements.
    pub elements: usize,
    /// Parameters of their shapes.
    pub parameters: usize,
    /// Length of the file.
    pub bytes: usize,
    /// CPU time of the fit on one thread, s.
    pub cpu_s: f64,
}

/// A measure: its name, its decimals, and whether its changes are told in per cent.
struct Measure(&'static str, usize, bool);

const MEASURES: [Measure; 8] = [
    Measure("dB", 2, false),
    Measure("SSIMULACRA2", 2, false),
    Measure("details kept", 3, false),
    Measure("ΔE00 at 1,024 px", 3, false),
    Measure("elements", 1, true),
    Measure("parameters", 0, true),
    Measure("bytes", 0, true),
    Measure("CPU s", 2, true),
];

impl Drawn {
    fn values(&self) -> [Option<f64>; MEASURES.len()] {
        [
            Some(self.psnr_db),
            Some(self.ssimulacra2),
            self.details_kept,
            self.delta_e,
            Some(self.elements as f64),
            Some(self.parameters as f64),
            Some(self.bytes as f64),
            Some(self.cpu_s),
        ]
    }
}

/// A picture, and what both programs made of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareEntry {
    /// Kind of the picture.
    pub kind: String,
    /// Picture and options.
    pub name: String,
    /// Of the old program.
    pub old: Option<Drawn>,
    /// Of the new one.
    pub new: Option<Drawn>,
    /// True if both wrote the same file.
    pub has_same_bytes: bool,
    /// Why one of them wrote nothing.
    pub failure: Option<String>,
}

impl CompareEntry {
    /// A line, ending in the verdict.
    pub fn line(&self) -> String {
        let start = format!("{} {}", self.kind, self.name);
        match (self.pair(), &self.failure) {
            (Some([old, new]), _) => {
                let pair = MEASURES.iter().zip(old.into_iter().zip(new));
                let pair = pair.map(|(measure, pair)| measure.pair(pair));
                format!("{start}: {}: pass", pair.collect::<Vec<_>>().join(", "))
            }
            (None, why) => format!("{start}: {}: FAIL", why.as_deref().unwrap_or_default()),
        }
    }

    fn pair(&self) -> Option<[[Option<f64>; MEASURES.len()]; 2]> {
        Some([self.old.as_ref()?.values(), self.new.as_ref()?.values()])
    }

    /// Gain of fidelity, dB.
    fn gain_db(&self) -> f64 {
        let db = |drawn: &Option<Drawn>| drawn.as_ref().map_or(0.0, |drawn| drawn.psnr_db);
        db(&self.new) - db(&self.old)
    }
}

impl Measure {
    /// Old and new value of a drawing.
    fn pair(&self, (old, new): (Option<f64>, Option<f64>)) -> String {
        let [old, new] = [old, new].map(|value| optional(value, self.1));
        if old == new {
            old
        } else {
            format!("{old} → {new}")
        }
    }

    /// Means of old and new values, over the cases that have both.
    fn means(&self, i: usize, entries: &[&CompareEntry]) -> Option<[f64; 2]> {
        let pairs = entries.iter().filter_map(|entry| entry.pair());
        let pairs = pairs.filter_map(|[old, new]| Some([old[i]?, new[i]?]));
        let pairs: Vec<[f64; 2]> = pairs.collect();
        let of = |k: usize| mean(&pairs.iter().map(|pair| pair[k]).collect::<Vec<_>>());
        Some([of(0)?, of(1)?])
    }

    /// The change of a mean.
    fn change(&self, [old, new]: [f64; 2]) -> String {
        if self.2 {
            format!("{:+.1} %", 100.0 * (new / old.max(f64::MIN_POSITIVE) - 1.0))
        } else {
            format!("{:+.*}", self.1, new - old)
        }
    }
}

/// All cases of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CompareReport {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Digests of the old and the new program.
    pub programs: [String; 2],
    /// One per picture and its options.
    pub entries: Vec<CompareEntry>,
}

impl CompareReport {
    /// The report of these cases.
    pub fn new(programs: [String; 2], entries: Vec<CompareEntry>) -> Self {
        Self {
            schema: SCHEMA,
            programs,
            entries,
        }
    }

    /// Number of pictures of which one program made nothing.
    pub fn failures(&self) -> usize {
        self.entries.iter().filter(|e| e.failure.is_some()).count()
    }

    /// Changes of all means, then each kind with its worst drawings.
    pub fn markdown(&self) -> String {
        let kinds = distinct(self.entries.iter().map(|e| e.kind.clone()));
        let of = |kind: &String| -> Vec<&CompareEntry> {
            self.entries.iter().filter(|e| e.kind == *kind).collect()
        };
        let mut head = vec!["kind", "drawings", "same bytes"];
        head.extend(MEASURES.iter().map(|measure| measure.0));
        let mut changes = Table::new(&head);
        let mut parts = String::new();
        for kind in &kinds {
            changes.row(row(kind, &of(kind)));
            parts += &format!("\n## {kind}\n\n{}", means(&of(kind)).markdown());
            parts += &worst(of(kind));
        }
        changes.row(row("all", &self.entries.iter().collect::<Vec<_>>()));
        let [old, new] = &self.programs;
        let failed = self.entries.iter().filter(|e| e.failure.is_some());
        let failed: String = failed.map(|e| format!("\n{}\n", e.line())).collect();
        let changes = changes.markdown();
        format!("# Changes of means from {old} to {new}\n\n{changes}{failed}{parts}")
    }
}

/// Changes of the means of a kind.
fn row(kind: &str, entries: &[&CompareEntry]) -> Vec<String> {
    let same = entries.iter().filter(|e| e.has_same_bytes).count();
    let mut cells = vec![kind.to_owned(), entries.len().to_string(), same.to_string()];
    cells.extend(MEASURES.iter().enumerate().map(|(i, measure)| {
        let means = measure.means(i, entries);
        means.map_or_else(String::new, |means| measure.change(means))
    }));
    cells
}

/// Means of a kind.
fn means(entries: &[&CompareEntry]) -> Table {
    let mut table = Table::new(&["mean", "old", "new", "change"]);
    for (i, measure) in MEASURES.iter().enumerate() {
        if let Some(means) = measure.means(i, entries) {
            let [old, new] = means.map(|mean| format!("{mean:.*}", measure.1));
            table.row([measure.0.to_owned(), old, new, measure.change(means)]);
        }
    }
    table
}

/// The drawings that lost most dB; nothing if none did.
fn worst(mut entries: Vec<&CompareEntry>) -> String {
    entries.retain(|entry| entry.gain_db() < 0.0);
    entries.sort_by(|a, b| a.gain_db().total_cmp(&b.gain_db()));
    let mut head = vec!["worst", "dB lost"];
    head.extend(MEASURES.iter().map(|measure| measure.0));
    let mut table = Table::new(&head);
    for entry in entries.iter().take(WORST) {
        let pairs = entry.pair().into_iter().flat_map(|[old, new]| {
            let pairs = old.into_iter().zip(new).zip(&MEASURES);
            pairs.map(|(pair, measure)| measure.pair(pair))
        });
        let lost = format!("{:.2}", -entry.gain_db());
        table.row([entry.name.clone(), lost].into_iter().chain(pairs));
    }
    if entries.is_empty() {
        String::new()
    } else {
        format!("\n{}", table.markdown())
    }
}
