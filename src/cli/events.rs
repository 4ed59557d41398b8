//! `--events`: reports events as they happen, one JSON object per line.

use std::io::{self, Write};
use std::path::Path;

use anyhow::{Result, anyhow};
use strokefit::report::Event;

use super::output::{self, Output};

/// Where events go, if anyone wants them.
pub(super) struct Events {
    name: String,
    to: Option<Box<dyn Write + Send>>,
    /// Why events were lost.
    lost: Option<io::Error>,
}

impl Events {
    /// The stream that goes to `path`.
    pub(super) fn open(path: Option<&Path>) -> Result<Self> {
        let name = path.map(output::name).unwrap_or_default();
        let output = path.map(Output::open).transpose()?;
        let to = output.map(|output| output.stream());
        let to = to.transpose().map_err(|e| unwritable(&name, &e))?;
        Ok(Self {
            name,
            to,
            lost: None,
        })
    }

    /// True if anyone wants events.
    pub(super) fn is_open(&self) -> bool {
        self.to.is_some()
    }

    /// Writes one event. The drawing matters more, so a failure to write is reported only at the end.
    pub(super) fn tell(&mut self, event: &Event) {
        let Some(to) = &mut self.to else {
            return;
        };
        let line = serde_json::to_string(event).map_err(io::Error::from);
        let written = line.and_then(|line| writeln!(to, "{line}").and_then(|()| to.flush()));
        if let Err(error) = written {
            self.to = None;
            self.lost = Some(error);
        }
    }

    /// Fails unless all events were written. A reader that went away has seen what it wanted.
    pub(super) fn close(self) -> Result<()> {
        match self.lost {
            Some(error) if error.kind() != io::ErrorKind::BrokenPipe => {
                Err(unwritable(&self.name, &error))
            }
            _ => Ok(()),
        }
    }
}

fn unwritable(name: &str, error: &io::Error) -> anyhow::Error {
    anyhow!("{name}: events cannot be written ({error}): choose another place")
}
