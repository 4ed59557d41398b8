//! Samples, and what the library makes of pictures.

use strokefit::fit::{Config, Fit, Fitter};
use strokefit::image::Image;

use super::repository::committed;

pub(crate) fn sample(name: &str) -> Image {
    Image::open(committed(&format!("samples/{name}.png"))).unwrap()
}

pub(crate) fn drawn(picture: &Image, config: &Config) -> Fit {
    Fitter::new(config.clone()).fit(picture).unwrap()
}
