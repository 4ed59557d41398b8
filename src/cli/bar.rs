//! A line on a terminal that shows how far something has come, with an estimate of the time left.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

/// Least time between two drawings of the line.
const EVERY: Duration = Duration::from_millis(50);

/// Length of the bar, characters.
const LENGTH: usize = 16;

/// Columns of a terminal that tells none.
const COLUMNS: usize = 80;

/// The line on standard error, or nothing where that is no terminal.
pub struct Bar {
    is_hidden: bool,
    heading: String,
    started: Instant,
    /// When the line that is on the screen was drawn.
    drawn: Option<Instant>,
}

impl Bar {
    /// A bar that begins with `heading`.
    pub fn new(quiet: bool, heading: impl Into<String>) -> Self {
        Self {
            is_hidden: quiet || !io::stderr().is_terminal(),
            heading: heading.into(),
            started: Instant::now(),
            drawn: None,
        }
    }

    /// Shows that a part `done` (0..1) of all is behind, and what is under way, unless the line was drawn a moment ago.
    pub fn show(&mut self, done: f64, what: impl FnOnce() -> String) {
        let is_fresh = self.drawn.is_some_and(|drawn| drawn.elapsed() < EVERY);
        if !self.is_hidden && !is_fresh {
            let line = self.line(done.clamp(0.0, 1.0), &what());
            draw(&line);
            self.drawn = Some(Instant::now());
        }
    }

    /// Takes the bar off the screen.
    pub fn clear(&mut self) {
        if self.drawn.take().is_some() {
            draw("");
        }
    }

    /// The least important comes last, because a narrow terminal cuts it off.
    fn line(&self, done: f64, what: &str) -> String {
        let full = (done * LENGTH as f64) as usize + 1;
        let bar: String = (0..LENGTH)
            .map(|i| if i < full { '━' } else { '╌' })
            .collect();
        let percent = (done * 100.0) as u8;
        let left = left(self.started.elapsed(), done);
        format!("{}{bar} {percent:>3} %, {left} to go: {what}", self.heading)
    }
}

/// Overwrites the current line, which works on every terminal.
fn draw(line: &str) {
    let size = terminal_size::terminal_size_of(io::stderr());
    // A character in the last column could begin a new line.
    let columns = size
        .map_or(COLUMNS, |(width, _)| usize::from(width.0))
        .saturating_sub(1);
    let end = if line.is_empty() { "\r" } else { "" };
    let mut stderr = io::stderr().lock();
    let _ = write!(stderr, "\r{line:columns$.columns$}{end}").and_then(|()| stderr.flush());
}

/// The time left, if it goes on as it went: `40s`, `5m`, `2h`.
fn left(elapsed: Duration, done: f64) -> String {
    let seconds = elapsed.as_secs_f64() * (1.0 - done) / done.max(f64::MIN_POSITIVE);
    match seconds {
        _ if done <= 0.0 => "0s".into(),
        ..89.5 => format!("{seconds:.0}s"),
        ..5370.0 => format!("{:.0}m", seconds / 60.0),
        _ => format!("{:.0}h", seconds / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_tells_all() {
        let bar = Bar::new(true, "1 of 2 ");
        let line = bar.line(0.5, "polish");
        assert_eq!(line, "1 of 2 ━━━━━━━━━╌╌╌╌╌╌╌  50 %, 0s to go: polish");
        assert!(bar.line(1.0, "").contains(&"━".repeat(LENGTH)));
    }

    #[test]
    fn the_time_left_has_one_unit() {
        let of = |elapsed_s| left(Duration::from_secs(elapsed_s), 0.25);
        assert_eq!(
            [of(1), of(29), of(31), of(1000), of(9000)],
            ["3s", "87s", "2m", "50m", "8h"]
        );
        assert_eq!(left(Duration::from_secs(9), 0.0), "0s");
    }
}
