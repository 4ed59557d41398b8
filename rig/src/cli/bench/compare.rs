//! `compare`: two programs over the same pictures.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::bench::compare::{self, Program, Wanted, cases};
use crate::lab::ResultFolder;
use crate::report::compare::CompareEntry;
use anyhow::{Result, bail};
use strokefit::cli::Verbosity;
use strokefit::report::json;

use super::{Extents, say};

/// Compare two versions of strokefit over pictures of all kinds: fidelity, sizes of files, CPU time
///
/// Run it in the root of a clone, whose samples are drawn. Markdown goes to standard output; the means of each kind and its ten
/// worst drawings, all numbers as JSON, and the SVGs go to the folder. A picture that a program has drawn into the folder is
/// not drawn again. About ten minutes on two cores, three with --short.
#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Compare {
    /// The old program
    old: PathBuf,
    /// The new program
    new: PathBuf,
    #[command(flatten)]
    pub(super) extents: Extents,
    /// Draw the pictures and SVGs of this folder, too. Its name is their kind, unless KIND= comes before it
    #[arg(long, value_name = "[KIND=]DIR", num_args = 1..)]
    samples: Vec<Folder>,
    /// Draw these kinds alone: photograph, flat, lines, text, alpha, damaged, or one of --samples
    #[arg(long, value_name = "KIND", value_delimiter = ',')]
    kind: Vec<String>,
}

/// A kind, and the folder of its pictures.
#[derive(Debug, Clone)]
struct Folder(String, PathBuf);

impl FromStr for Folder {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let name = || {
            let name = Path::new(text).file_name().unwrap_or_default();
            name.to_string_lossy().into_owned()
        };
        Ok(match text.split_once('=') {
            Some((kind, folder)) => Self(kind.into(), folder.into()),
            None => Self(name(), text.into()),
        })
    }
}

impl Compare {
    /// Runs it; how many cases failed.
    pub(super) fn run(&self, files: &mut ResultFolder, verbosity: Verbosity) -> Result<usize> {
        let programs = [Program::new(&self.old)?, Program::new(&self.new)?];
        let cases = cases(&Wanted {
            folders: self
                .samples
                .iter()
                .map(|f| (f.0.clone(), f.1.clone()))
                .collect(),
            kinds: self.kind.clone(),
            is_short: self.extents.short,
        })?;
        if cases.is_empty() {
            bail!(
                "no picture is of the kinds that --kind names: give photograph, flat, lines, text, alpha or damaged"
            );
        }
        let tell = |entry: &_| verbosity.detail(format_args!("{}", CompareEntry::line(entry)));
        let report = compare::run(programs.each_ref(), &cases, files.path(), &tell)?;
        let name = format!("compare-{}", report.programs.join("-"));
        let markdown = report.markdown();
        files.text(&format!("{name}.md"), &markdown)?;
        files.text(&format!("{name}.json"), &json(&report)?)?;
        say(&markdown);
        Ok(report.failures())
    }
}
