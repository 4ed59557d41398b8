//! Ctrl-C, SIGTERM and SIGHUP: the first asks a fit to end early, the second ends the program.
//!
//! Outside of a fit a signal ends the program as it ends any other, since there is nothing to keep. The one door
//! of `signal-hook`.

use std::fs;
use std::io;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use signal_hook::{consts, flag};
use strokefit::fit::{Observer, Progress};

/// Signals that ask a program to end.
#[cfg(unix)]
const SIGNALS: [i32; 3] = [consts::SIGHUP, consts::SIGINT, consts::SIGTERM];
#[cfg(not(unix))]
const SIGNALS: [i32; 2] = [consts::SIGINT, consts::SIGTERM];

/// Time in which a fit that is asked to end may finish its drawing.
pub(super) const GRACE: Duration = Duration::from_secs(1);

/// Signals reach the whole process, so what records them is static.
static WATCH: OnceLock<Interrupt> = OnceLock::new();

/// Stops a fit when a signal has come; what was drawn until then is finished.
#[derive(Debug, Clone)]
pub(super) struct Interrupt {
    /// The last signal that came; 0 before.
    caught: Arc<AtomicUsize>,
    /// True if the next signal ends the program.
    is_last: Arc<AtomicBool>,
}

impl Interrupt {
    /// From now on a first signal is only noted, and a second one ends the program.
    pub(super) fn watch() -> io::Result<Self> {
        let watch = match WATCH.get() {
            Some(watch) => watch.clone(),
            None => Self::register().map(|watch| WATCH.get_or_init(|| watch).clone())?,
        };
        watch
            .is_last
            .store(Self::caught().is_some(), Ordering::Relaxed);
        Ok(watch)
    }

    /// From now on a signal ends the program: there is nothing left to finish.
    pub(super) fn rest() {
        if let Some(watch) = WATCH.get() {
            watch.is_last.store(true, Ordering::Relaxed);
        }
    }

    fn register() -> io::Result<Self> {
        let (is_last, caught) = (Arc::new(AtomicBool::new(false)), Arc::default());
        for signal in SIGNALS.into_iter().filter(|&signal| !is_ignored(signal)) {
            // The order matters: the first signal must find the flag that ends the program still unset.
            flag::register_conditional_default(signal, Arc::clone(&is_last))?;
            flag::register(signal, Arc::clone(&is_last))?;
            flag::register_usize(signal, Arc::clone(&caught), signal.unsigned_abs() as usize)?;
        }
        Ok(Self { caught, is_last })
    }

    /// The signal that came since the first watch, if one did.
    pub(super) fn caught() -> Option<Signal> {
        match WATCH.get()?.caught.load(Ordering::Relaxed) {
            0 => None,
            number => Some(Signal(number as u8)),
        }
    }
}

impl Observer for Interrupt {
    fn observe(&mut self, _: &Progress) -> ControlFlow<()> {
        match Self::caught() {
            Some(_) => ControlFlow::Break(()),
            None => ControlFlow::Continue(()),
        }
    }
}

/// A signal that asked the program to end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Signal(u8);

impl Signal {
    /// Ends the program the way the signal does, so that a shell's loop over files ends with it. Where
    /// that is not possible, gives the status that shells report for it.
    pub(super) fn end(self) -> u8 {
        #[cfg(unix)]
        let _ = signal_hook::low_level::emulate_default_handler(self.0.into());
        128 + self.0
    }
}

/// True if `signal` was set to be ignored when the program started, as `nohup` does; known only on Linux.
fn is_ignored(signal: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    ignored_signals(&status) >> (signal - 1) & 1 == 1
}

/// The bits of the line `SigIgn:` of `status`, 0 where there is none.
fn ignored_signals(status: &str) -> u64 {
    let line = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    line.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok())
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ignored_signals_are_read_from_their_line() {
        let status = "Name:\tx\nSigBlk:\t0000000000000004\nSigIgn:\t0000000000001001\n";
        assert_eq!(ignored_signals(status), 0x1001);
        assert_eq!(ignored_signals("nonsense"), 0);
    }
}
