//! A progress bar with an estimate of the time left, on a terminal only.

use std::io::{self, IsTerminal};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use strokefit::fit::Progress;

/// Steps of the bar.
const STEPS: u64 = 1000;

/// Shows the progress of a fit on standard error, or nothing where that is no terminal.
pub(super) struct Bar {
    bar: ProgressBar,
    started: Instant,
    /// Strokes moved so far, each once an iteration.
    moves: u64,
}

impl Bar {
    /// A bar that begins with `heading`.
    pub(super) fn new(quiet: bool, heading: String) -> Self {
        Self {
            bar: bar(quiet).with_prefix(heading),
            started: Instant::now(),
            moves: 0,
        }
    }

    /// Shows how far the fit has come.
    pub(super) fn show(&mut self, progress: &Progress<'_>) {
        if !self.bar.is_hidden() {
            self.moves += progress.strokes as u64;
            self.bar.set_position(position(progress.done));
            self.bar.set_message(self.caption(progress));
        }
    }

    /// Takes the bar off the screen.
    pub(super) fn clear(&self) {
        self.bar.finish_and_clear();
    }

    /// Takes the bar off the screen while `tell` says something.
    pub(super) fn aside(&self, tell: impl FnOnce()) {
        self.bar.suspend(tell);
    }

    /// Where the fit stands, and how fast it goes.
    fn caption(&self, progress: &Progress<'_>) -> String {
        let Progress {
            strokes, psnr_db, ..
        } = *progress;
        let thousands = self.moves as f64 / 1e3 / self.started.elapsed().as_secs_f64().max(1e-3);
        let place = place(progress);
        format!("{place}, {strokes} strokes, {psnr_db:.2} dB, {thousands:.0} k moves/s")
    }
}

fn bar(quiet: bool) -> ProgressBar {
    if quiet || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
    // The least important comes last, because a narrow terminal cuts it off.
    let template = "{prefix}{bar:16} {percent:>3} %, {eta} to go: {wide_msg}";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("━━╌"));
    }
    bar
}

/// Shows how far a sequence of named steps has come, where standard error is a terminal.
pub(super) struct Steps(ProgressBar);

impl Steps {
    pub(super) fn new(quiet: bool) -> Self {
        Self(bar(quiet))
    }

    /// `what` is under way, and a part `done` (0..1) of all is behind it.
    pub(super) fn show(&self, done: f64, what: &str) {
        self.0.set_position(position(done));
        self.0.set_message(what.to_owned());
    }

    /// Takes the bar off the screen.
    pub(super) fn clear(&self) {
        self.0.finish_and_clear();
    }
}

fn position(done: f64) -> u64 {
    (done.clamp(0.0, 1.0) * STEPS as f64) as u64
}

/// The part of the fit that is under way; how many stages there will be is not always planned.
pub(super) fn place(progress: &Progress<'_>) -> String {
    let Progress { stage, stages, .. } = *progress;
    match stages {
        _ if progress.settling => "settling".into(),
        _ if progress.polishing => "polish".into(),
        0 => format!("stage {stage}"),
        _ => format!("stage {stage} of {stages}"),
    }
}
