//! The examples do what they say.

#[path = "../../examples/fit.rs"]
mod fit;
#[path = "../../examples/loss.rs"]
mod loss;
#[path = "../../examples/memory.rs"]
mod memory;
#[path = "../../examples/observer.rs"]
mod observer;
#[path = "../../examples/refine.rs"]
mod refine;

use crate::support::{committed, on_white, sample};
use strokefit::fit::Stop;
use strokefit::image::{Image, Limits};
use strokefit::svg::{self, WriteOptions};
use strokefit::verify::{self, Size};

#[test]
fn fit_writes_a_faithful_file() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("gem.svg");
    let quality = fit::draw(committed("samples/noto-gem.png").as_ref(), &output, 100).unwrap();
    assert!(quality.psnr_db > 35.0, "{quality:?}");
    let text = std::fs::read_to_string(output).unwrap();
    assert!((1..=100).contains(&svg::read(&text).unwrap().len()));
}

#[test]
fn observer_sees_the_drawing_grow_and_stops_it_before_its_time() {
    let mut patience = observer::Patience::default();
    let picture = sample("noto-gem");
    let drawing = observer::draw(&picture, &mut patience).unwrap();
    assert_eq!(drawing.stop, Stop::Interrupted);
    assert!(patience.strokes.len() > 2, "{:?}", patience.strokes);
    assert!(patience.strokes.is_sorted(), "{:?}", patience.strokes);
    assert!(!drawing.scene.is_empty());
}

#[test]
fn memory_gives_text_and_bytes_that_belong_together() {
    let file = std::fs::read(committed("samples/noto-rocket.png")).unwrap();
    let (text, png) = memory::convert(&file).unwrap();
    let drawn = verify::render(&text, Size::Scale(2.0), None).unwrap();
    assert!(png == drawn.encode_png().unwrap());
    let picture = Image::decode(&png, "png", Limits::default()).unwrap();
    assert_eq!((picture.width(), picture.height()), (512, 512));
    assert!(picture.alpha().is_some(), "the rocket stands on nothing");
    let error = memory::convert(b"no picture").unwrap_err().to_string();
    assert!(error.starts_with("the picture: "), "{error}");
}

#[test]
fn loss_gets_the_brightness_right_and_leaves_the_colours_alone() {
    let picture = sample("coffee-300");
    let scene = loss::draw(&picture).unwrap();
    let text = svg::write(&scene, &WriteOptions::default());
    let drawn = on_white(&text);
    let (mut brightness, mut colors) = (0.0, 0.0);
    for i in 0..picture.width() * picture.height() {
        let errors = [0, 1, 2].map(|c| drawn.planes()[c][i] - picture.planes()[c][i]);
        let sum: f32 = errors.iter().zip(loss::SHARES).map(|(e, s)| e * s).sum();
        brightness += sum * sum;
        colors += errors.iter().map(|e| e * e).sum::<f32>() / 3.0;
    }
    let pixels = (picture.width() * picture.height()) as f32;
    let (brightness, colors) = (brightness / pixels, colors / pixels);
    assert!(
        brightness < 0.005 && colors > 10.0 * brightness,
        "{brightness} {colors}"
    );
}

#[test]
fn refine_keeps_the_base_and_comes_closer() {
    let picture = sample("noto-gem").flattened([1.0; 3]);
    let body = r##"<circle cx="128" cy="128" r="90" fill="#40a0e0"/>"##;
    let base = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="256" height="256" viewBox="0 0 256 256">{body}</svg>"#
    );
    let (text, [before, after]) = refine::refine(&base, &picture, 60).unwrap();
    assert!(text.contains(body), "{text}");
    assert!(after.psnr_db > before.psnr_db + 5.0, "{before:?} {after:?}");
}
