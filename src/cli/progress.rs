//! A bar with an estimate of the time left, on a terminal only.

use std::io::{self, IsTerminal};
use std::ops::ControlFlow;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use strokefit::fit::{Observer, Progress};

/// Steps of the bar.
const STEPS: u64 = 1000;

/// Shows the progress of a fit on standard error, or nothing where that is no terminal.
pub(super) struct Bar(ProgressBar);

impl Bar {
    pub(super) fn new(quiet: bool) -> Self {
        if quiet || !io::stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
        let template = "{bar:24} {percent:>3} %  {msg}  {elapsed} gone, {eta} to go";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("━━╌"));
        }
        Self(bar)
    }

    /// Takes the bar off the screen.
    pub(super) fn clear(&self) {
        self.0.finish_and_clear();
    }
}

/// Shows how far a sequence of named steps has come, where standard error is a terminal.
pub(super) struct Steps(Bar);

impl Steps {
    pub(super) fn new(quiet: bool) -> Self {
        Self(Bar::new(quiet))
    }

    /// `what` is under way, and a part `done` (0..1) of all is behind it.
    pub(super) fn show(&self, done: f64, what: &str) {
        let Self(Bar(bar)) = self;
        bar.set_position((done.clamp(0.0, 1.0) * STEPS as f64) as u64);
        bar.set_message(what.to_owned());
    }

    /// Takes the bar off the screen.
    pub(super) fn clear(&self) {
        self.0.clear();
    }
}

impl Observer for Bar {
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        self.0
            .set_position((progress.done.clamp(0.0, 1.0) * STEPS as f64) as u64);
        self.0.set_message(caption(progress));
        ControlFlow::Continue(())
    }
}

fn caption(progress: &Progress<'_>) -> String {
    let Progress {
        stage,
        stages,
        strokes,
        psnr_db,
        ..
    } = *progress;
    let place = if stage > stages {
        "polish".into()
    } else {
        format!("stage {stage} of {stages}")
    };
    format!("{place}, {strokes} strokes, {psnr_db:.2} dB")
}
