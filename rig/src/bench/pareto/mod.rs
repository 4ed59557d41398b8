//! Cost against error: our fits at many settings, the article's recipe, and other programs draw the same
//! pictures. All are judged by the file as resvg draws it.
//!
//! Each result is written at once, as a line of `results.jsonl` and an SVG. A run that was stopped continues
//! where it was, since what is in the folder is not measured again.

mod case;
mod gallery;
mod journal;
mod sweep;

use std::fs;
use std::path::{Path, PathBuf};

pub use case::{Case, Effort, Limit, Maker};
pub use sweep::{Sweep, Work};

use crate::bench::peers::Peer;
use crate::lab::ResultFolder;
use crate::lab::unwritten;
use crate::report::pareto::{ParetoEntry, ParetoReport, charts, page};
use journal::Journal;
use strokefit::image::Image;
use strokefit::{Error, ErrorKind, Result};

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

/// Writes tables, plots and the page of `report` into `output`, whose folder is that of the run.
///
/// # Errors
/// When a file cannot be written or a plot not be drawn.
pub fn publish(
    output: &mut ResultFolder<'_>,
    folder: &Path,
    pictures: &[PathBuf],
    report: &ParetoReport,
) -> Result<()> {
    output.text("pareto.csv", &report.table().csv())?;
    output.text("pareto.md", &report.markdown())?;
    let json = serde_json::to_string_pretty(report).map_err(|e| {
        Error::new(
            ErrorKind::Io,
            format!("the report cannot be written as JSON: {e}"),
        )
    })?;
    output.text("pareto.json", &(json + "\n"))?;
    let mut exhibits = Vec::new();
    for path in pictures {
        let name = case::stem(path);
        for (plot, svg) in charts(&report.entries, &name)? {
            output.text(&format!("{name}-{plot}.svg"), &svg)?;
        }
        exhibits.extend(gallery::exhibits(
            folder,
            &case::open(path)?,
            &name,
            &report.entries,
        )?);
    }
    output.text("pareto.html", &page(report, &exhibits)?)
}

fn check_names(pictures: &[PathBuf]) -> Result<()> {
    for (i, path) in pictures.iter().enumerate() {
        let name = case::stem(path);
        if pictures[..i].iter().any(|other| case::stem(other) == name) {
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
