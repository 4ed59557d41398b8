//! Animations and pictures beside the SVG, and of files that are there already.

use std::fs::File;
use std::io::BufReader;

use crate::support::{Place, assert_refused, committed, rendered};
use image::codecs::gif::GifDecoder;
use image::codecs::png::PngDecoder;
use image::codecs::webp::WebPDecoder;
use image::{AnimationDecoder, RgbImage, RgbaImage};

/// A folder with a picture that takes several stages.
fn with_picture() -> Place {
    let place = Place::new();
    let sample = image::open(committed("samples/coffee-300.png")).unwrap();
    sample.thumbnail(90, 60).save(place.path("a.png")).unwrap();
    place
}

fn frames(place: &Place, name: &str) -> Vec<RgbaImage> {
    let file = BufReader::new(File::open(place.path(name)).unwrap());
    let frames = match name.rsplit('.').next().unwrap() {
        "gif" => GifDecoder::new(file).unwrap().into_frames(),
        "webp" => WebPDecoder::new(file).unwrap().into_frames(),
        _ => PngDecoder::new(file).unwrap().apng().unwrap().into_frames(),
    };
    let frames = frames.collect_frames().unwrap();
    frames.into_iter().map(image::Frame::into_buffer).collect()
}

fn picture(place: &Place, name: &str) -> RgbImage {
    image::open(place.path(name)).unwrap().to_rgb8()
}

fn rgb(frame: &RgbaImage) -> RgbImage {
    image::DynamicImage::from(frame.clone()).to_rgb8()
}

#[test]
fn a_fit_writes_all_kinds_beside_the_svg() {
    let place = with_picture();
    place.done(
        "fit a.png --strokes 60 --frames 25 -o b.svg -o b.gif -o b.webp -o b.apng -o b.png -o b.animated.svg \
         -o f{n}.png",
    );
    let whole = picture(&place, "b.png");
    for name in ["b.gif", "b.webp", "b.apng"] {
        let frames = frames(&place, name);
        assert_eq!(frames.len(), 3, "{name}");
        assert_eq!(frames[2].dimensions(), whole.dimensions(), "{name}");
    }
    assert!(rgb(&frames(&place, "b.apng")[2]) == whole);
    assert!(picture(&place, "f3.png") == whole && picture(&place, "f1.png") != whole);
    assert!(!place.path("f4.png").exists());
    let animated = place.text("b.animated.svg");
    assert_eq!(animated.matches("<path").count(), 60);
}

#[test]
fn a_file_is_filmed_like_the_fit_that_wrote_it() {
    let place = with_picture();
    place.done("fit a.png --strokes 40 -o b.svg -o b.gif -o b.animated.svg");
    place.done("render b.svg -o c.gif -o c.animated.svg");
    assert!(place.bytes("b.gif") == place.bytes("c.gif"));
    assert!(place.bytes("b.animated.svg") == place.bytes("c.animated.svg"));
    // What plays ends as the picture of the file.
    assert!(rendered(&place.text("b.svg")) == rendered(&place.text("b.animated.svg")));
}

#[test]
fn stages_are_frames_at_any_scale_and_with_a_legend() {
    let place = with_picture();
    place.done("fit a.png --strokes 60 --stages 4 -o b.svg --report r.json");
    let report = place.report("r.json");
    let stages = report["stages"].as_array().unwrap().iter();
    let drawn = stages
        .filter(|stage| stage["strokes"].as_u64() > Some(0))
        .count();
    place.done("render b.svg -o c.apng --frames stage --scale 3 --legend");
    let frames = frames(&place, "c.apng");
    assert_eq!(frames.len(), drawn);
    assert!(frames[0].width() == 270 && frames[0].height() > 180);
}

#[test]
fn outputs_that_make_no_sense_are_refused() {
    let place = with_picture();
    for (outputs, status, word) in [
        ("b.jpg", 2, "b.jpg: strokefit does not write .jpg files"),
        ("b.gif", 2, "out.svg"),
        ("b.svg -o c.svg", 2, "c.svg"),
        ("b.svg -o b.gif -o b.gif", 2, "b.gif"),
        ("b.svg -o ./a.png", 2, "overwritten"),
        ("b.svg -o a.png/b.gif", 1, "is a file"),
        ("b.svg --legend", 2, "--legend"),
        ("b.svg -o b.gif --frames 0", 2, "stage"),
    ] {
        assert_refused(&place, &format!("fit a.png -o {outputs}"), status, &[word]);
    }
}

#[test]
fn foreign_files_are_no_film() {
    let place = Place::new();
    let svg =
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="2"><circle r="1"/></svg>"#;
    place.file("b.svg", svg);
    assert_refused(&place, "render b.svg -o b.gif", 1, &["b.svg"]);
    assert_refused(&place, "render b.svg -o c.svg", 2, &["c.svg"]);
    place.done("render b.svg -o b.png");
}
