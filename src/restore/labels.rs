//! The colours of a picture that has few.

use crate::image::{Image, flooded};

/// Red, green, blue and alpha, 0 or 1; all are 0 where a picture is transparent.
pub(super) type Color = [f32; 4];

/// The colours of a picture of few, by pixel.
pub(super) struct Labels {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) colors: Vec<Color>,
    pub(super) of: Vec<u16>,
}

impl Labels {
    /// Most colours of a picture of few: those of a GIF.
    pub(super) const MOST: usize = 256;

    /// Smaller pictures of few colours, px, are pixel art. A guess.
    pub(super) const LEAST_SIDE: usize = 48;

    /// The labels of a picture of at most so many colours; `None` if it has more, or a pixel is translucent.
    pub(super) fn of(picture: &Image, most: usize) -> Option<Self> {
        let pixels = picture.width() * picture.height();
        let mut colors: Vec<Color> = Vec::new();
        let mut of = Vec::with_capacity(pixels);
        let mut last = 0;
        for pixel in 0..pixels {
            let color = color(picture, pixel)?;
            if colors.get(last) != Some(&color) {
                last = match colors.iter().position(|known| *known == color) {
                    Some(known) => known,
                    None if colors.len() < most => {
                        colors.push(color);
                        colors.len() - 1
                    }
                    None => return None,
                };
            }
            of.push(u16::try_from(last).ok()?);
        }
        Some(Self {
            width: picture.width(),
            height: picture.height(),
            colors,
            of,
        })
    }

    /// True if the picture is transparent somewhere.
    pub(super) fn is_transparent(&self) -> bool {
        self.colors.contains(&[0.0; 4])
    }

    /// True for each pixel of a shape of at most so many pixels of one colour, joined along their sides; and their share of the
    /// pixels of all shapes but the largest.
    pub(super) fn specks(&self, most: usize) -> (Vec<bool>, f32) {
        let (mut specks, mut largest) = (0, 0);
        let mut is_speck = vec![false; self.of.len()];
        let mut is_seen = vec![false; self.of.len()];
        for first in 0..self.of.len() {
            if std::mem::replace(&mut is_seen[first], true) {
                continue;
            }
            let size = [self.width, self.of.len()];
            let shape = flooded(vec![first], size, |pixel, other| {
                self.of[other] == self.of[pixel] && !std::mem::replace(&mut is_seen[other], true)
            });
            largest = shape.len().max(largest);
            if shape.len() <= most {
                specks += shape.len();
                shape.into_iter().for_each(|pixel| is_speck[pixel] = true);
            }
        }
        let others = (self.of.len() - largest).max(1);
        (is_speck, specks as f32 / others as f32)
    }

    /// The label at a place; that of the border outside of the picture.
    pub(super) fn at(&self, x: isize, y: isize) -> u16 {
        self.of[self.pixel_at(x, y)]
    }

    /// The pixel at a place; the nearest one outside of the picture.
    pub(super) fn pixel_at(&self, x: isize, y: isize) -> usize {
        let within = |at: isize, size: usize| at.clamp(0, size as isize - 1) as usize;
        within(y, self.height) * self.width + within(x, self.width)
    }

    /// The number of the four pixels beside a place that have another colour.
    pub(super) fn others(&self, x: isize, y: isize) -> usize {
        let beside = [[1, 0], [-1, 0], [0, 1], [0, -1]];
        let is_other = |[dx, dy]: &[isize; 2]| self.at(x + dx, y + dy) != self.at(x, y);
        beside.iter().filter(|step| is_other(step)).count()
    }

    /// The number of pixels at a border, and that of those that are unlike three or all of the pixels beside them, as antialiased
    /// and dithered ones are.
    pub(super) fn borders(&self) -> [usize; 2] {
        let [mut borders, mut lonely] = [0; 2];
        for y in 0..self.height as isize {
            for x in 0..self.width as isize {
                let others = self.others(x, y);
                borders += usize::from(others > 0);
                lonely += usize::from(others >= 3);
            }
        }
        [borders, lonely]
    }
}

/// The colour of a pixel; `None` of a translucent one.
fn color(picture: &Image, pixel: usize) -> Option<Color> {
    let [red, green, blue] = picture.planes().each_ref().map(|plane| plane[pixel]);
    match picture.alpha().map_or(1.0, |alpha| alpha[pixel]) {
        1.0 => Some([red, green, blue, 1.0]),
        0.0 => Some([0.0; 4]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_shapes_are_specks() {
        // A dot, and a bar of ten pixels; pixels that only touch at a corner are apart.
        let is_dark =
            |x: usize, y: usize| (x, y) == (2, 2) || y == 5 && x < 10 || (x, y) == (10, 6);
        let value = |x, y, _| f32::from(u8::from(is_dark(x, y)));
        let picture = Image::from_fn(16, 8, 1, value).unwrap();
        let (specks, share) = Labels::of(&picture, 2).unwrap().specks(8);
        let found: Vec<usize> = (0..16 * 8).filter(|i| specks[*i]).collect();
        assert_eq!(found, [2 * 16 + 2, 6 * 16 + 10]);
        // The bar has ten pixels.
        assert!((share - 2.0 / 12.0).abs() < 1e-6);
    }

    #[test]
    fn transparency_is_a_label_and_translucent_pixels_have_none() {
        let grey = || Image::filled(2, 1, [0.5; 3]).unwrap();
        let clear = grey().with_alpha(vec![1.0, 0.0]).unwrap();
        let labels = Labels::of(&clear, 4).unwrap();
        assert!(labels.is_transparent());
        assert_eq!(labels.colors, [[0.5, 0.5, 0.5, 1.0], [0.0; 4]]);
        let veiled = grey().with_alpha(vec![1.0, 0.5]).unwrap();
        assert!(Labels::of(&veiled, 4).is_none());
    }
}
