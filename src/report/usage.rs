//! CPU time and memory of the process, from `/proc` where the system has one.

use std::fs;

/// Clock ticks per second in `/proc/self/stat`: part of Linux's interface to programs, 100 on
/// every architecture in use.
const TICKS_PER_S: f64 = 100.0;

/// CPU time and memory of this process; `None` where the system does not report them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Usage {
    /// CPU time, user and system, all threads, s; to a hundredth.
    pub cpu_s: Option<f64>,
    /// Most memory held at once, bytes.
    pub peak_rss_bytes: Option<u64>,
    /// CPU time of the children that were waited for, s; to a hundredth.
    pub children_cpu_s: Option<f64>,
}

impl Usage {
    /// Up to now.
    pub fn now() -> Self {
        let stat = fs::read_to_string("/proc/self/stat").ok();
        let cpu_s = |first| stat.as_deref().and_then(|stat| cpu_s(stat, first));
        Self {
            cpu_s: cpu_s(OWN),
            peak_rss_bytes: peak_rss_bytes_in("/proc/self/status"),
            children_cpu_s: cpu_s(CHILDREN),
        }
    }

    /// Most memory held at once by the process `id` so far, bytes; `None` when it is no more.
    pub fn peak_of(id: u32) -> Option<u64> {
        peak_rss_bytes_in(&format!("/proc/{id}/status"))
    }
}

/// The fields of `stat` with user and system time, counted from the one after the program's name.
const OWN: usize = 11;
const CHILDREN: usize = 13;

fn peak_rss_bytes_in(file: &str) -> Option<u64> {
    let status = fs::read_to_string(file).ok()?;
    peak_rss_bytes(&status)
}

/// Two fields of `stat`. The second of all, the program's name in brackets, may hold anything.
fn cpu_s(stat: &str, first: usize) -> Option<f64> {
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut ticks = after_name
        .split_ascii_whitespace()
        .skip(first)
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
        let stat = "7 (odd ) name) R 1 7 7 0 -1 4194304 99 0 0 0 123 27 10 20 20 0 3 0 5 6 7";
        assert_eq!(
            (cpu_s(stat, OWN), cpu_s(stat, CHILDREN)),
            (Some(1.5), Some(0.3))
        );
        assert_eq!(
            peak_rss_bytes("Name:\tx\nVmHWM:\t   2048 kB\nVmRSS:\t 1 kB\n"),
            Some(2 << 20)
        );
        assert_eq!(
            (cpu_s("nonsense", OWN), peak_rss_bytes("nonsense")),
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
