//! A fit that is killed again and again ends with the bytes of one that was left alone.
#![cfg(unix)]
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::Duration;

use strokefit::rng;
use tempfile::TempDir;

/// Options of fits of moderate length: all kinds of tasks that a fit has.
const FITS: [&[&str]; 3] = [
    &["--strokes", "220"],
    &["--psnr", "27", "--preset", "draft"],
    &[
        "--progressive",
        "--strokes",
        "60",
        "--stages",
        "4",
        "--bytes",
        "4000",
    ],
];
/// The state is kept about every iteration.
const OFTEN: [&str; 2] = ["--checkpoint-every", "0.001"];

/// A folder with a picture.
fn place() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/rocket-320.png");
    let picture = image::open(sample).unwrap().thumbnail(96, 96);
    picture.save(folder.path().join("in.png")).unwrap();
    folder
}

fn fit(folder: &TempDir, output: &str, options: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_strokefit"));
    command
        .args(["-q", "fit", "in.png", "-o", output])
        .args(options)
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    command
}

fn read(folder: &TempDir, name: &str) -> Option<Vec<u8>> {
    fs::read(folder.path().join(name)).ok()
}

/// Starts the fit and kills it after `life`, unless it has ended.
fn live(folder: &TempDir, options: &[&str], life: Duration) -> Option<ExitStatus> {
    let kept = ["--checkpoint", "fit.state"];
    let options = [options, &kept, &OFTEN].concat();
    let mut child = fit(folder, "killed.svg", &options).spawn().unwrap();
    std::thread::sleep(life);
    let ended = child.try_wait().unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    ended
}

/// The fit is killed after spans that are drawn at random and grow only where it gets nowhere.
#[test]
fn fifty_kills_change_no_byte() {
    let (mut kills, mut round) = (0, 0);
    while kills < 50 {
        let options = FITS[round % FITS.len()];
        round += 1;
        let folder = place();
        let whole = fit(&folder, "whole.svg", options).output().unwrap();
        let status = whole.status.code();
        let expected = read(&folder, "whole.svg").unwrap();
        for life in 0.. {
            let drawn = rng::draw(round as u64, life, 0, 0);
            let life = Duration::from_secs_f32(0.02 + 0.25 * drawn + 0.002 * life as f32);
            if let Some(ended) = live(&folder, options, life) {
                assert_eq!(ended.code(), status);
                break;
            }
            // Nothing is written before it is whole.
            assert!(read(&folder, "killed.svg").is_none_or(|svg| svg == expected));
            kills += 1;
        }
        assert!(
            read(&folder, "killed.svg") == Some(expected),
            "{options:?} after {kills} kills"
        );
        assert!(
            read(&folder, "fit.state").is_none(),
            "the checkpoint is left"
        );
    }
}

fn stderr(mut command: Command) -> (Option<i32>, String) {
    let output = command.output().unwrap();
    (
        output.status.code(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

/// A checkpoint of a fit that was killed on its way.
fn killed_fit() -> (TempDir, Vec<u8>) {
    let folder = place();
    let options = ["--preset", "best", "--strokes", "400"];
    for _ in 0..100 {
        assert!(live(&folder, &options, Duration::from_millis(300)).is_none());
        if let Some(state) = read(&folder, "fit.state") {
            return (folder, state);
        }
    }
    panic!("no state is kept");
}

#[test]
fn foreign_and_damaged_checkpoints_are_refused_and_kept() {
    let (folder, state) = killed_fit();
    let kept = ["--checkpoint", "fit.state", "--preset", "best", "--strokes"];
    let mut damaged = state.clone();
    damaged[state.len() / 2] ^= 1;
    let cases: [(&[u8], &str, i32, &str); 4] = [
        (&state, "401", 2, "other options"),
        (&damaged, "400", 1, "damaged"),
        (&state[..state.len() / 2], "400", 1, "damaged"),
        (b"<svg/>", "400", 2, "no checkpoint"),
    ];
    for (bytes, strokes, status, words) in cases {
        fs::write(folder.path().join("fit.state"), bytes).unwrap();
        let (code, line) = stderr(fit(&folder, "out.svg", &[&kept[..], &[strokes]].concat()));
        assert_eq!(code, Some(status), "{line}");
        assert!(
            line.contains("fit.state: ") && line.contains(words),
            "{line}"
        );
        assert_eq!(line.trim_end().lines().count(), 1, "{line}");
        assert_eq!(read(&folder, "fit.state").unwrap(), bytes);
        assert_eq!(read(&folder, "out.svg"), None);
    }
}

#[test]
fn a_place_that_cannot_be_written_is_said_at_once() {
    let folder = place();
    let options = [
        "--preset",
        "best",
        "--strokes",
        "30000",
        "--checkpoint",
        "none/fit.state",
    ];
    let (code, line) = stderr(fit(&folder, "out.svg", &options));
    assert_eq!(code, Some(1), "{line}");
    assert!(line.contains("none/fit.state: cannot be written"), "{line}");
}

/// An interrupted fit writes what it has, and goes on later as if nothing had happened.
#[test]
fn an_interrupted_fit_goes_on() {
    let folder = place();
    let options = ["--strokes", "150"];
    let whole = fit(&folder, "whole.svg", &options).status().unwrap();
    assert!(whole.success());
    let kept = [&options[..], &["--checkpoint", "fit.state"]].concat();
    let child = fit(&folder, "out.svg", &kept).spawn().unwrap();
    while read(&folder, "fit.state").is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let kill = format!("kill -2 {}", child.id());
    assert!(
        Command::new("sh")
            .args(["-c", &kill])
            .status()
            .unwrap()
            .success()
    );
    let interrupted = child.wait_with_output().unwrap();
    assert_eq!(interrupted.status.code(), None);
    let drawn = String::from_utf8(read(&folder, "out.svg").unwrap()).unwrap();
    strokefit::svg::read(&drawn).unwrap();
    assert!(read(&folder, "fit.state").is_some());
    assert!(fit(&folder, "out.svg", &kept).status().unwrap().success());
    assert!(read(&folder, "out.svg") == read(&folder, "whole.svg"));
    assert!(read(&folder, "fit.state").is_none());
}
