//! A fit that is killed again and again ends with the bytes of one that was left alone.

use std::fs;
use std::process::{Command, ExitStatus, Stdio};
use std::time::Duration;

use crate::support::{Place, STROKEFIT, committed, send};
use strokefit::rng;

const PHOTOGRAPH: &str = "samples/rocket-320.png";

/// Pictures, and options of fits of moderate length: all kinds of tasks that a fit has.
const FITS: [(&str, &[&str]); 6] = [
    // Circles and lines, and lines with square ends.
    ("tests/data/plans/markers.svg", &[]),
    ("tests/data/plans/chevrons.svg", &[]),
    (PHOTOGRAPH, &["--strokes", "90"]),
    (PHOTOGRAPH, &["--psnr", "27", "--preset", "draft"]),
    (
        PHOTOGRAPH,
        &[
            "--progressive",
            "--strokes",
            "60",
            "--stages",
            "4",
            "--bytes",
            "3000",
        ],
    ),
    // Labels are lost, and traced again.
    ("tests/data/pictures/map.png", &["--marks", "strokes"]),
];
/// The state is kept about every iteration.
const OFTEN: [&str; 2] = ["--checkpoint-every", "0.001"];

/// A folder with a picture: a photograph of so many px, a quarter of the map, or a drawing.
fn with_picture(name: &str, side: u32) -> Place {
    let place = Place::new();
    if name.ends_with("svg") {
        place.done(&["render", &committed(name), "-o", "in.png"]);
        return place;
    }
    let picture = image::open(committed(name)).unwrap();
    let picture = match name {
        PHOTOGRAPH => picture.thumbnail(side, side),
        _ => picture.crop_imm(0, 0, picture.width() / 2, picture.height() / 2),
    };
    picture.save(place.path("in.png")).unwrap();
    place
}

fn fit(place: &Place, output: &str, options: &[&str]) -> Command {
    let mut command = place.command(STROKEFIT);
    command
        .args(["-q", "fit", "in.png", "-o", output])
        .args(options)
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    command
}

fn read(place: &Place, name: &str) -> Option<Vec<u8>> {
    fs::read(place.path(name)).ok()
}

/// Starts the fit and kills it after `life`, unless it has ended.
fn live(place: &Place, options: &[&str], life: Duration) -> Option<ExitStatus> {
    let kept = ["--checkpoint", "fit.state"];
    let options = [options, &kept, &OFTEN].concat();
    let mut child = fit(place, "killed.svg", &options).spawn().unwrap();
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
    while kills < 50 || round < FITS.len() {
        let (picture, options) = FITS[round % FITS.len()];
        round += 1;
        let place = with_picture(picture, 56);
        let whole = fit(&place, "whole.svg", options).output().unwrap();
        let status = whole.status.code();
        let expected = read(&place, "whole.svg").unwrap();
        for life in 0.. {
            let drawn = rng::draw(round as u64, life, 0, 0);
            let life = Duration::from_secs_f32(0.02 + 0.25 * drawn + 0.002 * life as f32);
            if let Some(ended) = live(&place, options, life) {
                assert_eq!(ended.code(), status);
                break;
            }
            // Nothing is written before it is whole.
            assert!(read(&place, "killed.svg").is_none_or(|svg| svg == expected));
            kills += 1;
        }
        assert!(
            read(&place, "killed.svg") == Some(expected),
            "{options:?} after {kills} kills"
        );
        assert!(
            read(&place, "fit.state").is_none(),
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
fn killed_fit() -> (Place, Vec<u8>) {
    let place = with_picture(PHOTOGRAPH, 96);
    let options = ["--preset", "best", "--strokes", "400"];
    for _ in 0..100 {
        assert!(live(&place, &options, Duration::from_millis(300)).is_none());
        if let Some(state) = read(&place, "fit.state") {
            return (place, state);
        }
    }
    panic!("no state is kept");
}

#[test]
fn foreign_and_damaged_checkpoints_are_refused_and_kept() {
    let (place, state) = killed_fit();
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
        fs::write(place.path("fit.state"), bytes).unwrap();
        let (code, line) = stderr(fit(&place, "out.svg", &[&kept[..], &[strokes]].concat()));
        assert_eq!(code, Some(status), "{line}");
        assert!(
            line.contains("fit.state: ") && line.contains(words),
            "{line}"
        );
        assert_eq!(line.trim_end().lines().count(), 1, "{line}");
        assert_eq!(read(&place, "fit.state").unwrap(), bytes);
        assert_eq!(read(&place, "out.svg"), None);
    }
}

#[test]
fn a_place_that_cannot_be_written_is_said_at_once() {
    let place = with_picture(PHOTOGRAPH, 96);
    let options = [
        "--preset",
        "best",
        "--strokes",
        "30000",
        "--checkpoint",
        "none/fit.state",
    ];
    let (code, line) = stderr(fit(&place, "out.svg", &options));
    assert_eq!(code, Some(1), "{line}");
    assert!(line.contains("none/fit.state: cannot be written"), "{line}");
}

/// An interrupted fit writes what it has, and goes on later as if nothing had happened.
#[test]
fn an_interrupted_fit_goes_on() {
    let place = with_picture(PHOTOGRAPH, 96);
    let options = ["--strokes", "150"];
    let whole = fit(&place, "whole.svg", &options).status().unwrap();
    assert!(whole.success());
    let kept = [&options[..], &["--checkpoint", "fit.state"]].concat();
    let child = fit(&place, "out.svg", &kept).spawn().unwrap();
    while read(&place, "fit.state").is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    send(&child, 15);
    let interrupted = child.wait_with_output().unwrap();
    assert_eq!(interrupted.status.code(), None);
    let drawn = String::from_utf8(read(&place, "out.svg").unwrap()).unwrap();
    strokefit::svg::read(&drawn).unwrap();
    assert!(read(&place, "fit.state").is_some());
    assert!(fit(&place, "out.svg", &kept).status().unwrap().success());
    assert!(read(&place, "out.svg") == read(&place, "whole.svg"));
    assert!(read(&place, "fit.state").is_none());
}

/// A refinement that is killed on its way goes on, too.
#[test]
fn a_killed_refinement_goes_on() {
    let place = with_picture(PHOTOGRAPH, 96);
    let base = ["--strokes", "100", "--preset", "draft"];
    assert!(fit(&place, "base.svg", &base).status().unwrap().success());
    let refine = |output: &str, options: &[&str]| {
        let mut command = place.command(STROKEFIT);
        command
            .args(["-q", "refine", "base.svg", "in.png", "-o", output])
            .args(["--strokes", "220"])
            .args(options);
        command
    };
    assert!(refine("whole.svg", &[]).status().unwrap().success());
    let kept = [&["--checkpoint", "fit.state"], &OFTEN[..]].concat();
    let mut kills = 0;
    loop {
        let mut child = refine("killed.svg", &kept).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(100 + 20 * kills));
        let ended = child.try_wait().unwrap();
        child.kill().unwrap();
        child.wait().unwrap();
        if let Some(status) = ended {
            assert!(status.success());
            break;
        }
        kills += 1;
    }
    assert!(kills > 0, "it ended before it was killed");
    assert!(read(&place, "killed.svg") == read(&place, "whole.svg"));
}
