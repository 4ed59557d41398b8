//! What the process has used so far, from `/proc` where there is one.

use std::fs;

/// Clock ticks per second in `/proc/self/stat`: part of Linux's interface to programs, 100 on
/// every architecture in use.
const TICKS_PER_S: f64 = 100.0;

/// CPU time and memory of this process; `None` where the system does not tell.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Usage {
    /// CPU time, user and system, all threads, s; to a hundredth.
    pub cpu_s: Option<f64>,
    /// Most memory held at once, bytes.
    pub peak_rss_bytes: Option<u64>,
}

impl Usage {
    /// Up to now.
    pub fn now() -> Self {
        let read = |file| fs::read_to_string(file).ok();
        Self {
            cpu_s: read("/proc/self/stat").and_then(|stat| cpu_s(&stat)),
            peak_rss_bytes: read("/proc/self/status").and_then(|status| peak_rss_bytes(&status)),
        }
    }
}

/// Fields 14 and 15 of `stat`. The second, the program's name in brackets, may hold anything.
fn cpu_s(stat: &str) -> Option<f64> {
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut ticks = after_name
        .split_ascii_whitespace()
        .skip(11)
        .map(str::parse::<u64>);
    let (user, system) = (ticks.next()?.ok()?, ticks.next()?.ok()?);
    Some((user + system) as f64 / TICKS_PER_S)
}

/// The line `VmHWM:   1234 kB` of `status`.
fn peak_rss_bytes(status: &str) -> Option<u64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stat_and_status_are_understood() {
        let stat = "7 (odd ) name) R 1 7 7 0 -1 4194304 99 0 0 0 123 27 0 0 20 0 3 0 5 6 7";
        assert_eq!(cpu_s(stat), Some(1.5));
        assert_eq!(
            peak_rss_bytes("Name:\tx\nVmHWM:\t   2048 kB\nVmRSS:\t 1 kB\n"),
            Some(2 << 20)
        );
        assert_eq!(
            (cpu_s("nonsense"), peak_rss_bytes("nonsense")),
            (None, None)
        );
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_process_uses_memory() {
        assert!(
            Usage::now()
                .peak_rss_bytes
                .is_some_and(|bytes| bytes > 100_000)
        );
    }
}
