//! A fit that is killed again and again ends with the bytes of one that was left alone.

use std::fs;
use std::process::{Command, ExitStatus, Stdio};
use std::time::Duration;

use crate::support::{Place, STROKEFIT, Words, assert_says, committed, send, stderr};
use strokefit::rng;

const PHOTOGRAPH: &str = "samples/rocket-320.png";

/// Pictures, and options of fits of moderate length: all kinds of tasks that a fit has.
const FITS: [(&str, &str); 7] = [
    // Circles and lines, and lines with square ends.
    ("tests/data/plans/markers.svg", ""),
    ("tests/data/plans/chevrons.svg", ""),
    // Of 17 to 50 in SSIMULACRA2, so that the price is lowered.
    (PHOTOGRAPH, ""),
    (PHOTOGRAPH, "--strokes 90"),
    (PHOTOGRAPH, "--psnr 27 --preset draft"),
    (
        PHOTOGRAPH,
        "--progressive --strokes 60 --stages 4 --bytes 3000",
    ),
    // Labels are lost, and traced again.
    ("tests/data/pictures/map.png", "--marks strokes"),
];
/// The state is kept about every iteration.
const OFTEN: &str = "--checkpoint fit.state --checkpoint-every 0.001";

/// A folder with a picture: a photograph of so many px, a quarter of the map, or a drawing.
fn with_picture(name: &str, side: u32) -> Place {
    let place = Place::new();
    if name.ends_with("svg") {
        place.done(&format!("render @{name} -o in.png"));
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

/// A quiet run of the program.
fn quiet(place: &Place, args: &str) -> Command {
    let mut command = place.command(STROKEFIT);
    command.arg("-q").args(args.words());
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn fit(place: &Place, output: &str, options: &str) -> Command {
    quiet(place, &format!("fit in.png -o {output} {options}"))
}

fn read(place: &Place, name: &str) -> Option<Vec<u8>> {
    fs::read(place.path(name)).ok()
}

/// Starts the command and kills it after `life`, unless it has ended.
fn live(mut command: Command, life: Duration) -> Option<ExitStatus> {
    let mut child = command.spawn().unwrap();
    std::thread::sleep(life);
    let ended = child.try_wait().unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    ended
}

/// Runs the command, which draws `killed.svg`, until it is not killed before its end; returns its status and the number of
/// kills. The spans are drawn at random, and grow so that it gets somewhere on a slow machine, too.
fn end_of_killed(place: &Place, args: &str, seed: u64) -> (ExitStatus, u64) {
    let whole = read(place, "whole.svg").unwrap();
    let mut kills = 0;
    loop {
        let span_s = 0.02 + 0.25 * rng::draw(seed, kills, 0, 0);
        let life = Duration::from_secs_f32(span_s * 1.05_f32.powi(kills as i32));
        let ended = live(quiet(place, &format!("{args} -o killed.svg {OFTEN}")), life);
        let killed = read(place, "killed.svg");
        if let Some(status) = ended {
            assert!(killed == Some(whole), "{args} after {kills} kills");
            let left = read(place, "fit.state");
            assert!(left.is_none(), "the checkpoint is left");
            return (status, kills);
        }
        // Nothing is written before it is whole.
        assert!(killed.is_none_or(|svg| svg == whole));
        kills += 1;
    }
}

#[test]
fn fifty_kills_change_no_byte() {
    let (mut kills, mut round) = (0, 0);
    while kills < 50 || round < FITS.len() {
        let (picture, options) = FITS[round % FITS.len()];
        round += 1;
        let place = with_picture(picture, 56);
        let whole = fit(&place, "whole.svg", options).status().unwrap();
        let (status, more) = end_of_killed(&place, &format!("fit in.png {options}"), round as u64);
        assert_eq!(status.code(), whole.code());
        kills += more;
    }
}

#[test]
fn a_fit_that_strokes_alone_have_won_goes_on_with_them() {
    let place = with_picture(PHOTOGRAPH, 160);
    let words = stderr(&place.done("fit in.png -o whole.svg -v --threads 1"));
    // Areas are drawn as well, and given up before their polish.
    let begun = |part: &str| words.lines().filter(|line| line.starts_with(part)).count();
    assert_eq!(begun("stage 1:"), 2, "{words}");
    place.done("fit in.png -o strokes.svg --marks strokes --threads 1");
    assert_eq!(read(&place, "whole.svg"), read(&place, "strokes.svg"));
    let (status, kills) = end_of_killed(&place, "fit in.png", 1);
    assert!(status.success() && kills > 0, "{status}, {kills} kills");
}

/// Status and standard error.
fn outcome(mut command: Command) -> (Option<i32>, String) {
    let output = command.output().unwrap();
    (output.status.code(), stderr(&output))
}

/// A checkpoint of a fit that was killed on its way.
fn killed_fit() -> (Place, Vec<u8>) {
    let place = with_picture(PHOTOGRAPH, 96);
    for _ in 0..100 {
        let options = format!("--preset best --strokes 400 {OFTEN}");
        let command = fit(&place, "killed.svg", &options);
        assert!(live(command, Duration::from_millis(300)).is_none());
        if let Some(state) = read(&place, "fit.state") {
            return (place, state);
        }
    }
    panic!("no state is kept");
}

#[test]
fn foreign_and_damaged_checkpoints_are_refused_and_kept() {
    let (place, state) = killed_fit();
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
        let options = format!("--checkpoint fit.state --preset best --strokes {strokes}");
        let (code, line) = outcome(fit(&place, "out.svg", &options));
        assert_eq!(code, Some(status), "{line}");
        assert_says(&line, &["fit.state: ", words]);
        assert_eq!(line.trim_end().lines().count(), 1, "{line}");
        assert_eq!(read(&place, "fit.state").unwrap(), bytes);
        assert_eq!(read(&place, "out.svg"), None);
    }
}

#[test]
fn a_place_that_cannot_be_written_is_said_at_once() {
    let place = with_picture(PHOTOGRAPH, 96);
    let options = "--preset best --strokes 30000 --checkpoint none/fit.state";
    let (code, line) = outcome(fit(&place, "out.svg", options));
    assert_eq!(code, Some(1), "{line}");
    assert_says(&line, &["none/fit.state: cannot be written"]);
}

/// An interrupted fit writes what it has, and goes on later as if nothing had happened.
#[test]
fn an_interrupted_fit_goes_on() {
    let place = with_picture(PHOTOGRAPH, 96);
    let whole = fit(&place, "whole.svg", "--strokes 150").status();
    assert!(whole.unwrap().success());
    let kept = "--strokes 150 --checkpoint fit.state";
    let child = fit(&place, "out.svg", kept).spawn().unwrap();
    while read(&place, "fit.state").is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    send(&child, 15);
    let interrupted = child.wait_with_output().unwrap();
    assert_eq!(interrupted.status.code(), None);
    let drawn = String::from_utf8(read(&place, "out.svg").unwrap()).unwrap();
    strokefit::svg::read(&drawn).unwrap();
    assert!(read(&place, "fit.state").is_some());
    assert!(fit(&place, "out.svg", kept).status().unwrap().success());
    assert!(read(&place, "out.svg") == read(&place, "whole.svg"));
    assert!(read(&place, "fit.state").is_none());
}

/// A refinement that is killed on its way goes on, too.
#[test]
fn a_killed_refinement_goes_on() {
    let place = with_picture(PHOTOGRAPH, 96);
    let base = fit(&place, "base.svg", "--strokes 100 --preset draft").status();
    assert!(base.unwrap().success());
    let refine = "refine base.svg in.png --strokes 220";
    let whole = quiet(&place, &format!("{refine} -o whole.svg")).status();
    assert!(whole.unwrap().success());
    let (status, kills) = end_of_killed(&place, refine, 0);
    assert!(status.success());
    assert!(kills > 0, "it ended before it was killed");
}
