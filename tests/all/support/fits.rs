//! Samples, what the library makes of pictures, and how that looks.

use std::ops::ControlFlow;
use std::path::Path;

use strokefit::fit::{Budget, Config, Fit, Fitter, Preset};
use strokefit::image::Image;
use strokefit::verify::{self, Size};

/// The whole path of a file that is committed as `path`.
pub(crate) fn committed(path: &str) -> String {
    format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))
}

pub(crate) fn sample(name: &str) -> Image {
    picture(&format!("{name}.png"))
}

/// A picture of the samples or of the tests, by its file name.
pub(crate) fn picture(name: &str) -> Image {
    let folders = ["samples", "tests/data/pictures"];
    let mut files = folders
        .map(|folder| committed(&format!("{folder}/{name}")))
        .into_iter();
    Image::open(files.find(|path| Path::new(path).exists()).unwrap()).unwrap()
}

pub(crate) fn of_strokes(strokes: usize) -> Budget {
    Budget {
        strokes: Some(strokes),
        ..Budget::default()
    }
}

pub(crate) fn of_bytes(bytes: usize) -> Budget {
    Budget {
        bytes: Some(bytes),
        ..Budget::default()
    }
}

pub(crate) fn of_psnr(db: f64) -> Budget {
    Budget {
        psnr_db: Some(db),
        ..Budget::default()
    }
}

/// The default of a drawing within `budget`.
pub(crate) fn within(budget: Budget) -> Config {
    Config {
        budget,
        ..Config::default()
    }
}

/// The draft of a drawing of at most `strokes` strokes.
pub(crate) fn draft(strokes: usize) -> Config {
    Config {
        preset: Preset::Draft,
        ..within(of_strokes(strokes))
    }
}

/// What an observer answers.
pub(crate) fn goes_on(goes_on: bool) -> ControlFlow<()> {
    if goes_on {
        ControlFlow::Continue(())
    } else {
        ControlFlow::Break(())
    }
}

pub(crate) fn drawn(picture: &Image, config: &Config) -> Fit {
    Fitter::new(config.clone()).fit(picture).unwrap()
}

/// An SVG at its own size.
pub(crate) fn rendered(svg: &str) -> Image {
    verify::render(svg, Size::Scale(1.0), None).unwrap()
}

/// An SVG on white paper.
pub(crate) fn on_white(svg: &str) -> Image {
    verify::render(svg, Size::Scale(1.0), Some([1.0; 3])).unwrap()
}
