//! `--events`: reports events as they happen, one JSON object per line.

use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

use anyhow::{Result, anyhow};
use strokefit::fit::Progress;
use strokefit::report::{Event, PhaseEntry};

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

/// Observes one fit and reports each phase that has ended.
pub(super) struct Phases<'a> {
    events: &'a mut Events,
    started: Instant,
    /// The part under way: true if it is polish, and what is known of it.
    current: Option<(bool, PhaseEntry)>,
    path: String,
}

impl<'a> Phases<'a> {
    /// Phases of the fit of `path`, which starts now.
    pub(super) fn new(events: &'a mut Events, path: String) -> Self {
        Self {
            events,
            started: Instant::now(),
            current: None,
            path,
        }
    }

    /// Tells of the part under way, which has ended.
    pub(super) fn end(&mut self) {
        match self.current.take() {
            Some((true, phase)) => self.events.tell(&Event::Polish(phase)),
            Some((false, phase)) => self.events.tell(&Event::Stage(phase)),
            None => {}
        }
    }

    /// Tells of the last part, with which all the work is done.
    pub(super) fn finish(&mut self) {
        if let Some((_, phase)) = &mut self.current {
            phase.done = 1.0;
        }
        self.end();
    }

    fn goes_on(&self, progress: &Progress<'_>) -> bool {
        self.current.as_ref().is_some_and(|(polish, phase)| {
            *polish == progress.polishing && phase.stage == progress.stage
        })
    }

    /// Notes how far the fit has come. Trials have no events.
    pub(super) fn watch(&mut self, progress: &Progress<'_>) {
        if self.events.to.is_none() || progress.is_trial {
            return;
        }
        if !self.goes_on(progress) {
            self.end();
        }
        let before = self
            .current
            .as_ref()
            .map_or(0, |(_, phase)| phase.iterations);
        let phase = PhaseEntry {
            path: self.path.clone(),
            stage: progress.stage,
            strokes: progress.strokes,
            iterations: before + 1,
            elapsed_s: self.started.elapsed().as_secs_f64(),
            psnr_db: Some(progress.psnr_db).filter(|db| db.is_finite()),
            done: progress.done,
        };
        self.current = Some((progress.polishing, phase));
    }
}
