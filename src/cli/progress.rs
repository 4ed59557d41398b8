//! The progress of a fit: a bar on a terminal, an event for each phase that has ended, and with `--verbose` a line for each part as
//! it ends, and now and then for one that takes long.

use std::io::{self, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use strokefit::fit::Progress;
use strokefit::report::{Event, PhaseEntry};

use super::bar::Bar;
use super::output::{self, Output};
use super::{Verbosity, complain};

/// Where `--events` go, if anyone wants them: one JSON object per line.
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

/// Follows one fit.
pub(super) struct Watching<'a> {
    bar: Bar,
    verbosity: Verbosity,
    events: &'a mut Events,
    /// The picture as it was named.
    path: String,
    started: Instant,
    /// Strokes moved so far, each once an iteration.
    moves: u64,
    /// The part under way.
    part: Option<Part>,
    /// The phase that the next event is about, and whether that is polish.
    phase: Option<(bool, PhaseEntry)>,
}

/// A part as lines tell of it.
struct Part {
    place: String,
    began: Instant,
    told: Instant,
    iterations: usize,
    strokes: usize,
    psnr_db: f64,
}

impl<'a> Watching<'a> {
    /// Follows the fit of `path`, which starts now; the bar begins with `heading`.
    pub(super) fn new(
        heading: String,
        path: String,
        events: &'a mut Events,
        verbosity: Verbosity,
    ) -> Self {
        Self {
            bar: Bar::new(verbosity.quiet, heading),
            verbosity,
            events,
            path,
            started: Instant::now(),
            moves: 0,
            part: None,
            phase: None,
        }
    }

    /// Shows and tells how far the fit has come. Trials have no events.
    pub(super) fn watch(&mut self, progress: &Progress<'_>) {
        self.moves += progress.strokes as u64;
        let rate = self.moves as f64 / self.started.elapsed().as_secs_f64().max(1e-3);
        self.bar.show(progress.done, || caption(progress, rate));
        if let Some(line) = self.line(progress).filter(|_| self.verbosity.verbose) {
            self.bar.clear();
            complain(line);
        }
        if self.events.to.is_some() && !progress.is_trial {
            self.count(progress);
        }
    }

    /// Ends with the fit, after all of its work if it `is_done`.
    pub(super) fn end(mut self, is_done: bool) {
        if let Some((_, phase)) = self.phase.as_mut().filter(|_| is_done) {
            phase.done = 1.0;
        }
        self.tell();
        self.bar.clear();
        if let Some(part) = &self.part {
            self.verbosity.detail(part.line());
        }
    }

    /// The line that is due, if one is.
    fn line(&mut self, progress: &Progress<'_>) -> Option<String> {
        let (place, now) = (place(progress), Instant::now());
        let ended = self.part.take_if(|part| part.place != place);
        let part = self.part.get_or_insert(Part {
            place,
            began: now,
            told: now,
            iterations: 0,
            strokes: 0,
            psnr_db: 0.0,
        });
        part.iterations += 1;
        (part.strokes, part.psnr_db) = (progress.strokes, progress.psnr_db);
        if now - part.told < PATIENCE {
            return ended.map(|part| part.line());
        }
        part.told = now;
        let percent = 100.0 * progress.done;
        Some(format!("{}, {percent:.0} % of all", part.line()))
    }

    /// Counts an iteration of the phase, and tells of the one before if that has ended.
    fn count(&mut self, progress: &Progress<'_>) {
        let is_same = |(polish, phase): &(bool, PhaseEntry)| {
            *polish == progress.polishing && phase.stage == progress.stage
        };
        if !self.phase.as_ref().is_some_and(is_same) {
            self.tell();
        }
        let before = self.phase.as_ref().map_or(0, |(_, phase)| phase.iterations);
        let phase = PhaseEntry {
            path: self.path.clone(),
            stage: progress.stage,
            strokes: progress.strokes,
            iterations: before + 1,
            elapsed_s: self.started.elapsed().as_secs_f64(),
            psnr_db: Some(progress.psnr_db).filter(|db| db.is_finite()),
            done: progress.done,
        };
        self.phase = Some((progress.polishing, phase));
    }

    /// Tells of the phase under way, which has ended.
    fn tell(&mut self) {
        match self.phase.take() {
            Some((true, phase)) => self.events.tell(&Event::Polish(phase)),
            Some((false, phase)) => self.events.tell(&Event::Stage(phase)),
            None => {}
        }
    }
}

/// Where the fit stands, and how many strokes it moves in a second.
fn caption(progress: &Progress<'_>, rate: f64) -> String {
    let Progress {
        strokes, psnr_db, ..
    } = *progress;
    let (place, thousands) = (place(progress), rate / 1e3);
    format!("{place}, {strokes} strokes, {psnr_db:.2} dB, {thousands:.0} k moves/s")
}

/// The part of the fit that is under way; how many stages there will be is not always planned.
fn place(progress: &Progress<'_>) -> String {
    let Progress { stage, stages, .. } = *progress;
    let part = match stages {
        _ if progress.settling => "settling".into(),
        _ if progress.polishing => "polish".into(),
        0 => format!("stage {stage}"),
        _ => format!("stage {stage} of {stages}"),
    };
    match progress.is_trial {
        true => format!("trial, {part}"),
        false => part,
    }
}

/// Time after which a part that has not ended is told of, and told of again.
const PATIENCE: Duration = Duration::from_secs(5);

impl Part {
    fn line(&self) -> String {
        let Self {
            place,
            began,
            iterations,
            strokes,
            psnr_db,
            ..
        } = self;
        let wall_s = began.elapsed().as_secs_f64();
        format!(
            "{place}: {strokes} strokes, {iterations} iterations, {wall_s:.2} s, {psnr_db:.2} dB"
        )
    }
}
