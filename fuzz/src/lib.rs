//! Properties that hold for any bytes. Each target panics where one does not hold.
//!
//! `cargo fuzz run TARGET` drives them where there is a nightly toolchain and `cargo-fuzz`; the program of
//! this crate drives them on a stable one, and `tests/all/fuzz.rs` does so for a moment.

mod drive;
mod scene;

use std::fmt::Display;
use std::str::FromStr;

use strokefit::fit::{Background, Colors, OPTIONS, Options, Preset, Simd};
use strokefit::image::{Image, Limits};
use strokefit::svg;
use strokefit::verify::{self, Size};

pub use drive::drive;
pub use scene::scene;

/// Function that panics for an input for which something does not hold.
pub type Target = fn(&[u8]);

/// The targets, by name.
pub const TARGETS: [(&str, Target); 4] = [
    ("picture", picture),
    ("svg", svg),
    ("words", words),
    ("scene", scene),
];

/// Small, so that an input takes microseconds.
const LIMITS: Limits = Limits {
    max_pixels: 1 << 14,
    max_bytes: 1 << 20,
};

/// A picture within the limits comes out, or an error of one line.
pub fn picture(data: &[u8]) {
    match Image::decode(data, "x", LIMITS) {
        Ok(image) => {
            assert!((image.width() * image.height()) as u64 <= LIMITS.max_pixels);
            let values = image
                .planes()
                .iter()
                .flatten()
                .chain(image.alpha().unwrap_or_default());
            assert!(values.into_iter().all(|v| (0.0..=1.0).contains(v)));
        }
        Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
    }
}

/// A drawing that is read can be written and read back as it was; a render has the size asked for.
pub fn svg(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    if let Ok(scene) = svg::read(&text) {
        let options = svg::WriteOptions {
            precision: 6,
            ..Default::default()
        };
        let again = svg::read(&svg::write(&scene, &options)).expect("what is written can be read");
        let quantized = scene.quantized(6).scene;
        assert_eq!(again, quantized);
    }
    let size = Size::Exact {
        width: 40,
        height: 30,
    };
    match verify::render(&text, size, Some([1.0; 3])) {
        Ok(image) => assert_eq!((image.width(), image.height()), (40, 30)),
        Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
    }
}

/// Option values are understood or refused in one line.
pub fn words(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let text = text.as_ref();
    let set = |name: &str| {
        let value = serde_json::from_str(text).unwrap_or(serde_json::Value::from(text));
        let read = Options::from_json([(name.to_owned(), value)].into_iter().collect());
        read.err().map(|refusal| refusal.to_string())
    };
    let refusals = [
        word::<Simd>(text),
        word::<Preset>(text),
        word::<Background>(text),
        word::<Colors>(text),
        word::<svg::Form>(text),
        word::<svg::Group>(text),
        word::<svg::Length>(text),
    ];
    let refusals = refusals.into_iter().chain(OPTIONS.map(set));
    if !text.contains(char::is_control) {
        let mut refusals = refusals.flatten();
        assert!(refusals.all(|line| !line.contains('\n')));
    }
}

/// A value that is read is written as text that reads the same. Returns why it is not read otherwise.
fn word<T: Display + FromStr<Err = strokefit::Error>>(text: &str) -> Option<String> {
    match text.parse::<T>() {
        Ok(value) => {
            let written = value.to_string();
            let again = written.parse::<T>().expect("what is written can be read");
            assert_eq!(again.to_string(), written);
            None
        }
        Err(error) => Some(error.to_string()),
    }
}
