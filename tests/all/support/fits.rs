//! Samples, and what the library makes of pictures.

use std::path::Path;

use strokefit::fit::{Config, Fit, Fitter};
use strokefit::image::Image;

use super::repository::committed;

pub(crate) fn sample(name: &str) -> Image {
    Image::open(committed(&format!("samples/{name}.png"))).unwrap()
}

/// A picture of the samples or of the tests, by its file name.
pub(crate) fn picture(name: &str) -> Image {
    let folders = ["samples", "tests/data/pictures"];
    let mut files = folders
        .map(|folder| committed(&format!("{folder}/{name}")))
        .into_iter();
    Image::open(files.find(|path| Path::new(path).exists()).unwrap()).unwrap()
}

pub(crate) fn drawn(picture: &Image, config: &Config) -> Fit {
    Fitter::new(config.clone()).fit(picture).unwrap()
}
