//! A folder to run the program in, and what to expect of its refusals.
#![allow(dead_code, unreachable_pub)]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// A folder of its own for each test.
pub struct Place(TempDir);

impl Place {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn file(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        fs::write(self.path(name), bytes).unwrap();
        name.into()
    }

    pub fn picture(&self, name: &str, width: u32, height: u32) -> String {
        let level = |x: u32, n: u32| (x * 255 / n.max(2)) as u8;
        let picture = image::RgbImage::from_fn(width, height, |x, y| {
            image::Rgb([level(x, width), level(y, height), 90])
        });
        picture.save(self.path(name)).unwrap();
        name.into()
    }

    pub fn run(&self, args: &[&str]) -> Output {
        self.pipe(args, b"")
    }

    pub fn pipe(&self, args: &[&str], stdin: &[u8]) -> Output {
        let mut child = Command::new(env!("CARGO_BIN_EXE_strokefit"))
            .args(args)
            .current_dir(self.0.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // The program may leave before it has read everything.
        let _ = child.stdin.take().unwrap().write_all(stdin);
        child.wait_with_output().unwrap()
    }

    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A line of error and perhaps one of advice that hold all of `words`, the exit status, and no new file.
#[track_caller]
pub fn assert_refused(place: &Place, args: &[&str], status: i32, words: &[&str]) {
    let before = place.names();
    let output = place.run(args);
    let line = stderr(&output);
    assert_eq!(output.status.code(), Some(status), "{args:?}: {line}");
    let mut lines = line.lines();
    assert!(
        lines
            .next()
            .is_some_and(|first| first.starts_with("error: ")),
        "{args:?}: {line}"
    );
    assert!(
        lines.all(|other| other.starts_with("hint: ")),
        "{args:?}: {line}"
    );
    assert!(line.lines().count() <= 2, "{args:?}: {line}");
    for word in words {
        assert!(
            line.contains(word),
            "{args:?} does not say {word:?}: {line}"
        );
    }
    assert!(
        output.stdout.is_empty(),
        "{args:?} wrote on standard output"
    );
    assert_eq!(place.names(), before, "{args:?} left a file");
}

pub fn report(place: &Place, name: &str) -> serde_json::Value {
    serde_json::from_slice(&fs::read(place.path(name)).unwrap()).unwrap()
}

pub fn sample(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("samples")
        .join(name);
    path.to_str().unwrap().into()
}
