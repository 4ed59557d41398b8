//! Runs each measurement in a process of its own: its peak memory is then that of one case, and a case
//! that crashes ends nothing else.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::pareto::Case;
use super::peers::Peer;
use super::scaling::Point;
use crate::report::pareto::ParetoEntry;
use crate::report::scaling::PointEntry;
use strokefit::{Error, ErrorKind, Result};

/// Measurement that a child makes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Measurement {
    /// One drawing; its SVG goes to the file `svg`.
    Case { case: Case, svg: PathBuf },
    /// One point of a series.
    Point(Point),
}

/// Measures what a [`Runner`] asked for; the answer is a line of JSON.
///
/// # Errors
/// When `measurement` is not one, or cannot be measured.
pub fn perform(measurement: &str, peers: &[Box<dyn Peer>]) -> Result<String> {
    let measurement: Measurement = serde_json::from_str(measurement).map_err(|e| {
        Error::new(
            ErrorKind::Config,
            format!("not a measurement of a benchmark: {e}"),
        )
    })?;
    let answer = match measurement {
        Measurement::Case { case, svg } => serde_json::to_string(&case.measure(&svg, peers)?),
        Measurement::Point(point) => serde_json::to_string(&point.measure()?),
    };
    answer.map_err(|e| {
        Error::new(
            ErrorKind::Config,
            format!("the answer cannot be written as JSON: {e}"),
        )
    })
}

/// Starts children, each for one measurement.
#[derive(Debug, Clone)]
pub struct Runner {
    program: PathBuf,
    /// Arguments before the measurement.
    args: Vec<OsString>,
}

impl Runner {
    /// Starts this program with `args` and one argument more. The program has to pass that argument to
    /// [`perform`] and print the answer.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when the program cannot be found.
    pub fn new<S: Into<OsString>>(args: impl IntoIterator<Item = S>) -> Result<Self> {
        let program = std::env::current_exe().map_err(|e| {
            Error::new(
                ErrorKind::Io,
                format!("the file of this program cannot be found: {e}"),
            )
        })?;
        Ok(Self {
            program,
            args: args.into_iter().map(Into::into).collect(),
        })
    }

    /// Makes and measures the drawing of `case` in a child, which writes its SVG to `svg`.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when the child does not answer; the message is the last line that it printed.
    pub fn case(&self, case: &Case, svg: &Path) -> Result<ParetoEntry> {
        self.answer(&Measurement::Case {
            case: case.clone(),
            svg: svg.to_owned(),
        })
    }

    /// Measures one point of a series in a child.
    ///
    /// # Errors
    /// As [`Self::case`].
    pub fn point(&self, point: &Point) -> Result<PointEntry> {
        self.answer(&Measurement::Point(point.clone()))
    }

    fn answer<T: DeserializeOwned>(&self, measurement: &Measurement) -> Result<T> {
        let refuse = |what: String| Error::new(ErrorKind::Io, what);
        let text = serde_json::to_string(measurement).map_err(|e| refuse(e.to_string()))?;
        let mut command = Command::new(&self.program);
        let output = command.args(&self.args).arg(text).output();
        let output =
            output.map_err(|e| refuse(format!("cannot start {}: {e}", self.program.display())))?;
        let answer = serde_json::from_slice(&output.stdout);
        answer.map_err(|_| {
            let said = String::from_utf8_lossy(&output.stderr);
            let last = said.lines().last().unwrap_or("nothing was said");
            match last.strip_prefix("error: ") {
                Some(why) => refuse(why.to_owned()),
                None => refuse(format!("{last} ({})", output.status)),
            }
        })
    }
}
