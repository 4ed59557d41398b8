//! Cost against error: our fits at many settings, the article's recipe, and other programs draw the same
//! pictures. All are judged by the file as resvg draws it.
//!
//! Each result is written at once, as a line of `results.jsonl` and an SVG. A run that was stopped continues
//! where it was, since what is in the folder is not measured again.

mod case;
mod journal;
mod sweep;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

pub use case::{Case, Effort, Limit, Maker};
pub use sweep::{Sweep, Work};

use crate::bench::files::{few, stem};
use crate::bench::gallery::Gallery;
use crate::bench::peers::Peer;
use crate::lab::ResultFolder;
use crate::lab::unwritten;
use crate::report::pareto::{ARTICLE, OWN, ParetoEntry, ParetoReport, charts, front};
use journal::Journal;
use strokefit::image::Image;
use strokefit::report::json;
use strokefit::{Error, ErrorKind, Result};

/// Most drawings of ours on the sheet.
const SHOWN: usize = 6;

/// Measures one case, whose SVG goes to a file of the given name.
pub type Measure<'a> = &'a dyn Fn(&Case, &Path) -> Result<ParetoEntry>;

/// A run under way.
struct Run<'a> {
    folder: &'a Path,
    journal: Journal,
    measure: Measure<'a>,
    say: &'a mut dyn FnMut(&str),
}

/// Measures what `work` asks for on `pictures` and writes to `folder`, telling a line per case.
///
/// # Errors
/// When a picture cannot be read, two have one name, or the folder cannot be written. A case that cannot
/// be measured is a failure in the report.
pub fn run(
    folder: &Path,
    pictures: &[PathBuf],
    work: &Work,
    peers: &[Box<dyn Peer>],
    measure: Measure<'_>,
    say: &mut dyn FnMut(&str),
) -> Result<ParetoReport> {
    check_names(pictures)?;
    fs::create_dir_all(folder.join("svg")).map_err(|e| unwritten(folder, e))?;
    let mut run = Run {
        folder,
        journal: Journal::open(&folder.join("results.jsonl"))?,
        measure,
        say,
    };
    for path in pictures {
        let picture = case::open(path)?;
        let cases = work.cases(path, peers)?;
        for case in &cases {
            run.once(case, &picture)?;
        }
        if let Some(case) = work.at_equal_time(path, &run.journal.entries) {
            run.once(&case, &picture)?;
        }
    }
    let entries = run.journal.current(pictures)?;
    let report = ParetoReport::new(entries);
    for comparison in &report.comparisons {
        (run.say)(&comparison.line());
    }
    Ok(report)
}

impl Run<'_> {
    /// Measures a case, unless that was done before.
    fn once(&mut self, case: &Case, picture: &Image) -> Result<()> {
        let blank = case.entry(picture);
        if let Some(known) = self.journal.find(&blank.id()) {
            (self.say)(&known.line());
            return Ok(());
        }
        let svg = self.folder.join("svg").join(blank.svg_name());
        let entry = (self.measure)(case, &svg).unwrap_or_else(|error| ParetoEntry {
            failure: Some(error.to_string()),
            ..blank
        });
        (self.say)(&entry.line());
        self.journal.append(entry)
    }
}

/// Writes tables, plots and a sheet of the drawings of `report` into `output`, whose folder is that of the run.
///
/// # Errors
/// When a file cannot be written or a plot not be drawn.
pub fn publish(
    output: &mut ResultFolder,
    folder: &Path,
    pictures: &[PathBuf],
    report: &ParetoReport,
) -> Result<()> {
    output.text("pareto.csv", &report.table().csv())?;
    output.text("pareto.md", &report.markdown())?;
    output.text("pareto.json", &json(report)?)?;
    let mut gallery = Gallery::default();
    for path in pictures {
        let name = stem(path);
        for (plot, svg) in charts(&report.entries, &name)? {
            output.text(&format!("{name}-{plot}.svg"), &svg)?;
        }
        let picture = case::open(path)?;
        gallery.row(&name, &picture)?;
        for entry in shown(&report.entries, &name) {
            let svg = folder.join("svg").join(entry.svg_name());
            let svg = fs::read_to_string(&svg).map_err(|e| unread(&svg, e))?;
            let by = entry.preset.as_deref().unwrap_or(&entry.family);
            let db = entry.psnr_db().unwrap_or(f64::NAN);
            let kilobytes = entry.gzip_bytes as f64 / 1000.0;
            let caption = format!("{by}: {db:.1} dB, {kilobytes:.1} kB");
            gallery.add_drawing(&caption, &svg, &picture)?;
        }
    }
    output.picture("pareto.png", &gallery.sheet()?)
}

/// Our front by bytes, what the article's recipe made, and the best of each peer.
fn shown<'a>(entries: &'a [ParetoEntry], name: &str) -> Vec<&'a ParetoEntry> {
    let here = || {
        entries
            .iter()
            .filter(|e| e.picture == name && e.fidelity.is_some())
    };
    let own = here().filter(|e| e.family == OWN);
    let own = front(own, |e| Some(e.gzip_bytes as f64), ParetoEntry::psnr_db);
    let mut shown = few(own, SHOWN);
    shown.extend(here().filter(|e| e.family == ARTICLE));
    let mut best: BTreeMap<&str, &ParetoEntry> = BTreeMap::new();
    for entry in here().filter(|e| e.family != OWN && e.family != ARTICLE) {
        let known = best.entry(&entry.family).or_insert(entry);
        if entry.psnr_db() > known.psnr_db() {
            *known = entry;
        }
    }
    shown.extend(best.into_values());
    shown
}

fn check_names(pictures: &[PathBuf]) -> Result<()> {
    for (i, path) in pictures.iter().enumerate() {
        let name = stem(path);
        if pictures[..i].iter().any(|other| stem(other) == name) {
            let message = format!("two pictures are called {name}: rename one of them");
            return Err(Error::new(ErrorKind::Config, message));
        }
    }
    Ok(())
}

fn unread(path: &Path, cause: std::io::Error) -> Error {
    let message = format!(
        "{}: cannot be read ({cause}): check the name and its permissions",
        path.display()
    );
    Error::new(ErrorKind::Io, message).caused_by(cause)
}
