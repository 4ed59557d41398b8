//! Inputs of the corpus, mutated without end.
//!
//! Input `i` depends on the corpus, the seed and `i` alone, so that a finding can be made again.

use std::fs;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use strokefit::rng;

use super::TARGETS;

/// Most time for an input.
const LIMIT: Duration = Duration::from_secs(10);
/// Longest input.
const LONGEST: usize = 1 << 14;

/// Pieces that random bytes would not hit upon.
const WORDS: [&[u8]; 36] = [
    b"<g>",
    b"</g>",
    b"<g opacity=\".5\">",
    b"<path d=\"",
    b"\"/>",
    b"url(#a)",
    b" id=\"a\"",
    b"<use href=\"#a\"/>",
    b"<pattern ",
    b"<mask ",
    b"<clipPath ",
    b"<filter ",
    b"<image href=\"data:",
    b"<text>",
    b"<!DOCTYPE svg [<!ENTITY a \"",
    b"&a;",
    b" transform=\"",
    b" style=\"",
    b"1e38",
    b"-1e38",
    b"NaN",
    b"-0",
    b"0.000001",
    b"99999999999",
    b"h0.01",
    b" stroke-opacity=\"0",
    b"IHDR",
    b"IDAT",
    b"\xff\xd8\xff",
    b"\xff\xc0\x00\x11",
    b"RIFF",
    b"VP8X",
    b"GIF89a",
    b"BM",
    b"II*\0",
    b"\x7f\xff\xff\xff",
];

/// Runs so many inputs, the corpus first, of the folder `fuzz`; says how it went, or what the first finding is, which
/// is written to `fuzz/findings`. No finding is to be printed otherwise: set a silent panic hook.
pub fn drive(fuzz: &Path, name: &str, runs: u64, seed: u64) -> Result<String, String> {
    let Some(&(_, target)) = TARGETS.iter().find(|(n, _)| *n == name) else {
        let names = TARGETS.map(|(name, _)| name).join(", ");
        return Err(format!("{name} is no target: give one of {names}"));
    };
    let corpus = corpus(&fuzz.join("corpus").join(name));
    if corpus.is_empty() {
        return Err(format!("the corpus of {name} has no files"));
    }
    let findings = fuzz.join("findings");
    let current = watch(name, &findings);
    let start = Instant::now();
    for run in 0..runs.max(corpus.len() as u64) {
        let input = match corpus.get(run as usize) {
            Some(file) => file.clone(),
            None => mutated(&corpus, seed, run),
        };
        *current.lock().expect("no panic under the lock") = (Some(Instant::now()), input.clone());
        if let Err(panic) = panic::catch_unwind(AssertUnwindSafe(|| target(&input))) {
            let what = panic.downcast_ref::<String>().cloned();
            let what = what.or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()));
            let kept = keep(&findings, name, &input);
            return Err(format!(
                "{name}, run {run}: {} ({kept})",
                what.unwrap_or_default()
            ));
        }
        if (run + 1).is_multiple_of(1_000_000) {
            eprintln!(
                "{name}: {} runs in {:.0} s",
                run + 1,
                start.elapsed().as_secs_f32()
            );
        }
    }
    *current.lock().expect("no panic under the lock") = (None, Vec::new());
    Ok(format!(
        "{name}: {runs} runs in {:.0} s, no finding",
        start.elapsed().as_secs_f32()
    ))
}

/// Ends the program when an input takes too long.
fn watch(name: &str, findings: &Path) -> Arc<Mutex<(Option<Instant>, Vec<u8>)>> {
    let current = Arc::new(Mutex::new((None::<Instant>, Vec::new())));
    let watched = Arc::clone(&current);
    let (name, findings) = (name.to_owned(), findings.to_owned());
    thread::spawn(move || {
        loop {
            thread::sleep(LIMIT / 4);
            let current = watched.lock().expect("no panic under the lock");
            if current.0.is_some_and(|since| since.elapsed() > LIMIT) {
                let kept = keep(&findings, &name, &current.1);
                eprintln!("{name}: an input takes more than {LIMIT:?} ({kept})");
                std::process::exit(1);
            }
        }
    });
    current
}

/// The files of a target's corpus, in the order of their names.
fn corpus(folder: &Path) -> Vec<Vec<u8>> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths.iter().flat_map(fs::read).collect()
}

/// Writes an input down and says where.
fn keep(findings: &Path, name: &str, input: &[u8]) -> String {
    let hash = input
        .iter()
        .fold(0, |hash, &byte| rng::bits(hash, byte.into(), 0, 0));
    let path = findings.join(format!("{name}-{hash:016x}"));
    let written = fs::create_dir_all(findings).and_then(|()| fs::write(&path, input));
    match written {
        Ok(()) => path.display().to_string(),
        Err(error) => format!("not written: {error}"),
    }
}

/// An input of the corpus with a few changes.
fn mutated(corpus: &[Vec<u8>], seed: u64, run: u64) -> Vec<u8> {
    let pick = |k: u64, n: usize| (rng::bits(seed, run, 0, k) % n.max(1) as u64) as usize;
    let mut bytes = corpus[pick(0, corpus.len())].clone();
    let other = &corpus[pick(1, corpus.len())];
    for step in 1..=(1 << pick(2, 5)) as u64 {
        let draw = |k: u64, n: usize| (rng::bits(seed, run, step, k) % n.max(1) as u64) as usize;
        let at = draw(0, bytes.len());
        let end = (at + 1 + draw(1, 32)).min(bytes.len());
        match draw(2, 9) {
            0 if at < bytes.len() => bytes[at] ^= 1 << draw(3, 8),
            1 if at < bytes.len() => bytes[at] = draw(3, 256) as u8,
            2 if at < bytes.len() => {
                bytes[at] = [0, 1, 0x7f, 0x80, 0xff, b'0', b'-', b'.'][draw(3, 8)]
            }
            3 => bytes.truncate(at),
            4 => drop(bytes.drain(at..end)),
            5 => drop(bytes.splice(at..at, bytes[at..end].to_vec())),
            6 => drop(bytes.splice(at..end, WORDS[draw(3, WORDS.len())].iter().copied())),
            7 => drop(bytes.splice(at..at, WORDS[draw(3, WORDS.len())].iter().copied())),
            _ => {
                let from = draw(3, other.len());
                let to = (from + draw(4, 200)).min(other.len());
                bytes.splice(at..end, other[from..to].iter().copied());
            }
        }
    }
    bytes.truncate(LONGEST);
    bytes
}
