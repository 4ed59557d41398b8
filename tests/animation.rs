//! Animations and pictures beside the SVG, and of files that are there already.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use image::codecs::gif::GifDecoder;
use image::codecs::png::PngDecoder;
use image::codecs::webp::WebPDecoder;
use image::{AnimationDecoder, RgbImage, RgbaImage};
use tempfile::TempDir;

/// A folder with a picture that takes several stages.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/coffee-300.png");
        let picture = image::open(sample).unwrap().thumbnail(90, 60);
        picture.save(place.path("a.png")).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, args: &[&str]) -> Output {
        let program = env!("CARGO_BIN_EXE_strokefit");
        let mut command = Command::new(program);
        command
            .args(args)
            .current_dir(self.0.path())
            .output()
            .unwrap()
    }

    #[track_caller]
    fn done(&self, args: &[&str]) {
        let output = self.run(args);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{args:?}: {said}");
    }

    #[track_caller]
    fn refused(&self, args: &[&str], word: &str) {
        let output = self.run(args);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(
            matches!(output.status.code(), Some(1 | 2)),
            "{args:?}: {said}"
        );
        let errors = said.lines().filter(|line| line.starts_with("error: "));
        assert_eq!(errors.count(), 1, "{said}");
        assert!(
            said.contains(word),
            "{args:?} does not say {word:?}: {said}"
        );
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    fn frames(&self, name: &str) -> Vec<RgbaImage> {
        let file = BufReader::new(File::open(self.path(name)).unwrap());
        let frames = match name.rsplit('.').next().unwrap() {
            "gif" => GifDecoder::new(file).unwrap().into_frames(),
            "webp" => WebPDecoder::new(file).unwrap().into_frames(),
            _ => PngDecoder::new(file).unwrap().apng().unwrap().into_frames(),
        };
        let frames = frames.collect_frames().unwrap();
        frames.into_iter().map(image::Frame::into_buffer).collect()
    }

    fn picture(&self, name: &str) -> RgbImage {
        image::open(self.path(name)).unwrap().to_rgb8()
    }
}

fn rgb(frame: &RgbaImage) -> RgbImage {
    image::DynamicImage::from(frame.clone()).to_rgb8()
}

#[test]
fn a_fit_writes_all_kinds_beside_the_svg() {
    let place = Place::new();
    place.done(&[
        "fit",
        "a.png",
        "--strokes",
        "60",
        "--frames",
        "25",
        "-o",
        "b.svg",
        "-o",
        "b.gif",
        "-o",
        "b.webp",
        "-o",
        "b.apng",
        "-o",
        "b.png",
        "-o",
        "b.animated.svg",
        "-o",
        "f{n}.png",
    ]);
    let whole = place.picture("b.png");
    for name in ["b.gif", "b.webp", "b.apng"] {
        let frames = place.frames(name);
        assert_eq!(frames.len(), 3, "{name}");
        assert_eq!(frames[2].dimensions(), whole.dimensions(), "{name}");
    }
    assert!(rgb(&place.frames("b.apng")[2]) == whole);
    assert!(place.picture("f3.png") == whole && place.picture("f1.png") != whole);
    assert!(!place.path("f4.png").exists());
    let animated = String::from_utf8(place.read("b.animated.svg")).unwrap();
    assert_eq!(animated.matches("<path").count(), 60);
}

#[test]
fn a_file_is_filmed_like_the_fit_that_wrote_it() {
    let place = Place::new();
    place.done(&[
        "fit",
        "a.png",
        "--strokes",
        "40",
        "-o",
        "b.svg",
        "-o",
        "b.gif",
        "-o",
        "b.animated.svg",
    ]);
    place.done(&["render", "b.svg", "-o", "c.gif", "-o", "c.animated.svg"]);
    assert!(place.read("b.gif") == place.read("c.gif"));
    assert!(place.read("b.animated.svg") == place.read("c.animated.svg"));
}

#[test]
fn stages_are_frames_at_any_scale_and_with_a_legend() {
    let place = Place::new();
    place.done(&[
        "fit",
        "a.png",
        "--strokes",
        "60",
        "--stages",
        "4",
        "-o",
        "b.svg",
        "--report",
        "r.json",
    ]);
    let report: serde_json::Value = serde_json::from_slice(&place.read("r.json")).unwrap();
    let stages = report["stages"].as_array().unwrap().iter();
    let drawn = stages
        .filter(|stage| stage["strokes"].as_u64() > Some(0))
        .count();
    place.done(&[
        "render", "b.svg", "-o", "c.apng", "--frames", "stage", "--scale", "3", "--legend",
    ]);
    let frames = place.frames("c.apng");
    assert_eq!(frames.len(), drawn);
    assert!(frames[0].width() == 270 && frames[0].height() > 180);
}

#[test]
fn the_animated_file_is_drawn_like_the_other() {
    let place = Place::new();
    place.done(&[
        "fit",
        "a.png",
        "--strokes",
        "40",
        "-o",
        "b.svg",
        "-o",
        "b.animated.svg",
    ]);
    place.done(&["render", "b.svg", "-o", "b.png"]);
    place.done(&["render", "b.animated.svg", "-o", "c.png"]);
    assert!(place.read("b.png") == place.read("c.png"));
}

#[test]
fn outputs_that_make_no_sense_are_refused() {
    let place = Place::new();
    place.refused(&["fit", "a.png", "-o", "b.gif"], "out.svg");
    place.refused(&["fit", "a.png", "-o", "b.svg", "-o", "c.svg"], "c.svg");
    place.refused(
        &["fit", "a.png", "-o", "b.svg", "-o", "b.gif", "-o", "b.gif"],
        "b.gif",
    );
    place.refused(&["fit", "a.png", "-o", "b.svg", "-o", "a.png"], "a.png");
    place.refused(&["fit", "a.png", "-o", "b.svg", "-o", "none/b.gif"], "none");
    place.refused(&["fit", "a.png", "-o", "b.svg", "--legend"], "--legend");
    place.refused(
        &[
            "fit", "a.png", "-o", "b.svg", "-o", "b.gif", "--frames", "0",
        ],
        "stage",
    );
    assert!(!place.path("b.svg").exists());
}

#[test]
fn foreign_files_are_no_film() {
    let place = Place::new();
    let svg =
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="2"><circle r="1"/></svg>"#;
    fs::write(place.path("b.svg"), svg).unwrap();
    place.refused(&["render", "b.svg", "-o", "b.gif"], "b.svg");
    place.refused(&["render", "b.svg", "-o", "c.svg"], "c.svg");
    place.done(&["render", "b.svg", "-o", "b.png"]);
}
