//! Measuring in processes of their own, so that the peak memory of a case is its own and a case that
//! dies takes nothing with it.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::pareto::{Case, Peer};
use super::scaling::Point;
use crate::error::{Error, ErrorKind, Result};

/// What a child measures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Task {
    /// One drawing; its SVG goes to the file `svg`.
    Case {
        /// The drawing.
        case: Case,
        /// Where its SVG goes.
        svg: PathBuf,
    },
    /// One point of a series.
    Point(Point),
}

/// Does what [`Runner::run`] asked for; the answer is a line of JSON.
///
/// # Errors
/// When `task` is none, or cannot be measured.
pub fn perform(task: &str, peers: &[Box<dyn Peer>]) -> Result<String> {
    let task: Task = serde_json::from_str(task)
        .map_err(|e| Error::new(ErrorKind::Config, format!("no task of a benchmark: {e}")))?;
    let answer = match task {
        Task::Case { case, svg } => serde_json::to_string(&case.measure(&svg, peers)?),
        Task::Point(point) => serde_json::to_string(&point.measure()?),
    };
    answer.map_err(|e| Error::new(ErrorKind::Config, format!("the answer cannot be told: {e}")))
}

/// How children are started.
#[derive(Debug, Clone)]
pub struct Runner {
    program: PathBuf,
    /// What comes before the task.
    args: Vec<OsString>,
}

impl Runner {
    /// This program with `args`, which has to hand the argument after them to [`perform`] and to print
    /// the answer.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when the program cannot be found.
    pub fn new<S: Into<OsString>>(args: impl IntoIterator<Item = S>) -> Result<Self> {
        let program = std::env::current_exe().map_err(|e| {
            Error::new(
                ErrorKind::Io,
                format!("this program's own file cannot be found: {e}"),
            )
        })?;
        Ok(Self {
            program,
            args: args.into_iter().map(Into::into).collect(),
        })
    }

    /// Has `task` done.
    ///
    /// # Errors
    /// [`ErrorKind::Io`], with the last line that the child said, when it did not answer.
    pub fn run<T: DeserializeOwned>(&self, task: &Task) -> Result<T> {
        let refuse = |what: String| Error::new(ErrorKind::Io, what);
        let task = serde_json::to_string(task).map_err(|e| refuse(e.to_string()))?;
        let mut command = Command::new(&self.program);
        let output = command.args(&self.args).arg(task).output();
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
