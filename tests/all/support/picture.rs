//! A picture to draw: a smooth ramp.

use super::place::Place;

impl Place {
    pub(crate) fn picture(&self, name: &str, width: u32, height: u32) {
        let level = |x: u32, n: u32| (x * 255 / n.max(2)) as u8;
        let picture = image::RgbImage::from_fn(width, height, |x, y| {
            image::Rgb([level(x, width), level(y, height), 90])
        });
        picture.save(self.path(name)).unwrap();
    }
}
