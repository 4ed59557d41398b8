//! A model of Chromium, which draws marks as version 156 was seen to draw them on the CPU.
//!
//! The rules were found from Chromium's pictures of single strokes and of stacks of them, and follow Skia's stroker and
//! its rasteriser with analytic antialiasing:
//!
//! - An area is its own `contour`. A stroke becomes one: both sides (`side`) of its `pieces`, arcs on the outside of bends, and caps. Sides of curves are
//!   parabolas up to 1/4 px away, arcs are parabolas up to 1/4 px outside.
//! - The page is drawn in tiles, and each clips contours to its `window`.
//! - The `outline` within a window is made of lines: a parabola becomes a few chords. The y of every end of a chord or
//!   line is rounded to a quarter of a px, and a slight bend of a capsule's side within a row of pixels is moved to the
//!   next row. The end of a chord that is 2 px high or more moves along it to a whole px instead.
//! - A pixel's coverage is the exact area inside of this outline, 0 to 255, which an `accumulator` adds up by the rule `nonzero`. Where edges cross, their order
//!   is that at the top of a quarter of a row.
//! - Products of colours, opacities and coverages are rounded down, so that each translucent stroke darkens a picture
//!   by half a level, where tiny-skia brightens it.
//!
//! On drawings of 500 strokes and more the model agrees with Chromium to 54 to 57 dB, where resvg does to 39 to 47; on single strokes
//! that bend, to 51 to 63 (docs/engines.md).
//!
//! ```
//! use strokefit::image::Image;
//! use strokefit::rasters::chromium;
//! use strokefit::scene::{Path, Stroke};
//!
//! let path = Path::line([3.0, 2.5].into(), [9.0, 2.5].into());
//! let stroke = Stroke { path, radius: 1.0, color: [0.0; 3], opacity: 0.5 };
//! let page = Image::filled(12, 5, [1.0; 3])?;
//! let picture = chromium::draw([&stroke.into()].into_iter(), &[page]).remove(0);
//! assert_eq!(picture.to_rgb8()[3 * (2 * 12 + 6)], 127);
//! # Ok::<(), strokefit::Error>(())
//! ```

mod accumulator;
mod contour;
mod curve;
mod footprinter;
mod outline;
mod part;
mod pieces;
mod side;
mod window;

use rayon::prelude::*;

use accumulator::Accumulator;
use contour::Contour;
pub(super) use footprinter::Footprinter;
use outline::Outline;
use window::Window;

use crate::image::Image;
use crate::math::Point;
use crate::scene::{Mark, Rgb, quantum};

/// The marks, back to front, on each of the `pages`, which are opaque and of one size.
pub fn draw<'a>(marks: impl Iterator<Item = &'a Mark>, pages: &[Image]) -> Vec<Image> {
    let Some((width, height)) = pages.first().map(|page| (page.width(), page.height())) else {
        return Vec::new();
    };
    let shapes: Vec<Shape<'_>> = marks.map(Shape::of).collect();
    let mut pictures: Vec<Vec<u8>> = pages.iter().map(Image::to_rgb8).collect();
    // Tiles are independent, as in Chromium, and put back in order since they overlap.
    let windows = Window::all(width, height);
    let drawn: Vec<Vec<Vec<u8>>> = windows
        .par_iter()
        .map(|&window| {
            let seen = pictures.iter().map(|rgb| window.cut_out(rgb, width));
            draw_window(&shapes, window, seen.collect())
        })
        .collect();
    for (window, seen) in windows.iter().zip(&drawn) {
        for (picture, seen) in pictures.iter_mut().zip(seen) {
            window.put_back(seen, picture, width);
        }
    }
    let pictures = pictures.iter();
    pictures.map(|rgb| image(rgb, width, height)).collect()
}

/// Draws `shapes` on `pictures`, as far as a window of their size shows them.
fn draw_window(shapes: &[Shape<'_>], window: Window, mut pictures: Vec<Vec<u8>>) -> Vec<Vec<u8>> {
    let [width, height] = window.size;
    let (mut outline, mut accumulator) = (Outline::default(), Accumulator::new(width, height));
    for shape in shapes
        .iter()
        .filter(|shape| window.touches(shape.contour.bounds))
    {
        outline.follow(&shape.contour, window);
        accumulator.fill(&outline, |y, x, coverages| {
            for picture in &mut pictures {
                let pixels = &mut picture[3 * (y * width + x)..];
                let from = [x + window.corner[0], y + window.corner[1]];
                shape.ink.lay(pixels, coverages, from);
            }
        });
    }
    pictures
}

/// A mark that is ready to be drawn.
struct Shape<'a> {
    contour: Contour,
    ink: Ink<'a>,
}

impl<'a> Shape<'a> {
    fn of(mark: &'a Mark) -> Self {
        Self {
            contour: Contour::of(mark),
            ink: Ink::of(mark),
        }
    }
}

fn image(rgb: &[u8], width: usize, height: usize) -> Image {
    let planes = [0, 1, 2].map(|c| {
        let channel = rgb.iter().skip(c).step_by(3);
        channel.map(|&v| f32::from(v) / 255.0).collect()
    });
    Image::from_planes(width, height, planes)
}

/// Ink of a mark.
enum Ink<'a> {
    Flat(Levels),
    /// That of an area with a gradient, by the place.
    Shaded(&'a Mark),
}

impl<'a> Ink<'a> {
    fn of(mark: &'a Mark) -> Self {
        match mark.shade() {
            Some(_) => Self::Shaded(mark),
            None => Self::Flat(Levels::of((mark.color(), mark.opacity()))),
        }
    }

    /// Paints the pixels to the right of one, as far as they are covered.
    fn lay(&self, rgb: &mut [u8], coverages: &[u8], [x, y]: [usize; 2]) {
        let pixels = rgb.chunks_exact_mut(3).zip(coverages);
        match self {
            Self::Flat(levels) => {
                pixels.for_each(|(pixel, &coverage)| levels.lay(pixel, coverage));
            }
            Self::Shaded(mark) => {
                for (x, (pixel, &coverage)) in (x..).zip(pixels) {
                    let center = Point::new(x as f32 + 0.5, y as f32 + 0.5);
                    Levels::of(mark.ink(center)).lay(pixel, coverage);
                }
            }
        }
    }
}

/// Colour and opacity, 0 to 255.
struct Levels {
    /// The colour times the opacity.
    color: [u32; 3],
    opacity: u32,
}

impl Levels {
    fn of((color, opacity): (Rgb, f32)) -> Self {
        let level = |v| u32::from(quantum(v));
        let opacity = level(opacity);
        let color = color.map(|c| (level(c) * opacity + 127) / 255);
        Self { color, opacity }
    }

    /// Paints a pixel as far as it is covered.
    fn lay(&self, pixel: &mut [u8], coverage: u8) {
        let coverage = u32::from(coverage);
        let rest = 255 - product(self.opacity, coverage);
        for (value, &color) in pixel.iter_mut().zip(&self.color) {
            // Both products are rounded down, so that a picture darkens by half a level a stroke.
            let sum = product(color, coverage) + product(u32::from(*value), rest);
            *value = sum.min(255) as u8;
        }
    }
}

/// The product of two numbers of 255ths, rounded down; exact where `b` is 255.
fn product(a: u32, b: u32) -> u32 {
    (a * b + a) >> 8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Path, Stroke};

    fn pixel(backdrop: u8, color: u8, opacity: f32) -> u8 {
        let level = |v: u8| [f32::from(v) / 255.0; 3];
        let stroke = Stroke {
            path: Path::dot([4.0, 4.0].into()),
            radius: 3.0,
            color: level(color),
            opacity,
        };
        let page = Image::filled(8, 8, level(backdrop)).unwrap();
        draw([&stroke.into()].into_iter(), &[page])[0].to_rgb8()[3 * (4 * 8 + 4)]
    }

    #[test]
    fn levels_are_those_that_chromium_shows() {
        for (backdrop, color, opacity, seen) in [
            (17, 201, 0.83, 169),
            (90, 91, 0.7, 91),
            (255, 255, 0.2, 255),
            (200, 40, 1.0, 40),
        ] {
            assert_eq!(
                pixel(backdrop, color, opacity),
                seen,
                "{backdrop} {color} {opacity}"
            );
        }
    }

    #[test]
    fn every_page_has_its_own_backdrop() {
        let stroke = Stroke {
            path: Path::line([1.0, 2.0].into(), [1.0, 3.0].into()),
            radius: 0.8,
            color: [0.2, 0.4, 0.6],
            opacity: 1.0,
        };
        let pages = [[0.0; 3], [1.0; 3]].map(|color| Image::filled(4, 4, color).unwrap());
        let drawn = draw([&stroke.into()].into_iter(), &pages).into_iter();
        let [black, white] = [
            drawn.clone().next().unwrap().to_rgb8(),
            drawn.last().unwrap().to_rgb8(),
        ];
        let at = |picture: &[u8], x: usize| picture[3 * (2 * 4 + x) + 1];
        assert_eq!([at(&black, 3), at(&white, 3)], [0, 255]);
        assert!(at(&black, 1) > 60 && at(&black, 1) < at(&white, 1));
    }
}
