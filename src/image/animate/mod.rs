//! Animated GIF, PNG and WebP.
//!
//! Each frame after the first holds only the changes: the rectangle around the pixels that differ from
//! the previous frame, with equal pixels transparent. GIF allows 256 colours per frame; PNG and WebP are
//! lossless.

mod apng;
mod gif;
mod patch;
mod webp;

use super::Image;
use crate::error::{Error, ErrorKind, Result};
use patch::Patch;

/// The format of an animation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnimationFormat {
    /// GIF: plays everywhere, 256 colours per frame.
    Gif,
    /// Animated PNG: lossless.
    Apng,
    /// Animated WebP: lossless, smaller than PNG.
    Webp,
}

impl AnimationFormat {
    /// Longest side that the format allows, px.
    fn max_side(self) -> usize {
        match self {
            Self::Gif => usize::from(u16::MAX),
            Self::Apng => i32::MAX as usize,
            Self::Webp => 1 << 14,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Gif => "GIF",
            Self::Apng => "PNG",
            Self::Webp => "WebP",
        }
    }
}

/// A file that shows these frames, each for its milliseconds, which GIF rounds to hundredths of a second. It repeats for
/// ever. The alpha of frames is ignored.
///
/// # Errors
/// The first error of a frame; [`ErrorKind::Picture`] when there is none, when a side is longer than the format allows, or
/// when a frame differs in size from the first.
pub fn animated(
    format: AnimationFormat,
    mut frames: impl ExactSizeIterator<Item = Result<(Image, u32)>>,
) -> Result<Vec<u8>> {
    let count = frames.len() as u32;
    let Some(first) = frames.next() else {
        let message = "the animation has no frames: give at least one";
        return Err(Error::new(ErrorKind::Picture, message));
    };
    let first = first?;
    let [width, height] = [first.0.width(), first.0.height()];
    check(format, [width, height])?;
    // Frames are made one at a time, and only the one before is kept, so memory doesn't grow with the animation.
    let mut shown: Option<Image> = None;
    let mut patches = std::iter::once(Ok(first)).chain(frames).map(move |frame| {
        let (image, ms) = frame?;
        is_equal([width, height], &image)?;
        let patch = Patch::between(shown.as_ref(), &image, ms);
        shown = Some(image);
        Ok(patch)
    });
    let mut patches = Patches {
        // The sides are checked.
        width: width as u32,
        height: height as u32,
        count,
        patches: &mut patches,
    };
    match format {
        AnimationFormat::Gif => gif::encoded(&mut patches),
        AnimationFormat::Apng => apng::encoded(&mut patches),
        AnimationFormat::Webp => webp::encoded(&mut patches),
    }
}

/// The patches of an animation, the first of which is a whole frame.
struct Patches<'a> {
    width: u32,
    height: u32,
    count: u32,
    patches: &'a mut dyn Iterator<Item = Result<Patch>>,
}

impl Iterator for Patches<'_> {
    type Item = Result<Patch>;

    fn next(&mut self) -> Option<Self::Item> {
        self.patches.next()
    }
}

/// Refuses a size that the format does not allow.
fn check(format: AnimationFormat, [width, height]: [usize; 2]) -> Result<()> {
    let (name, most) = (format.name(), format.max_side());
    if width.max(height) <= most {
        return Ok(());
    }
    let message = format!(
        "an animated {name} of {width}×{height} px is not possible: at most {most} px per side"
    );
    Err(Error::new(ErrorKind::Picture, message))
}

/// Refuses a frame that is not of the size of the first.
fn is_equal(first: [usize; 2], frame: &Image) -> Result<()> {
    let size = [frame.width(), frame.height()];
    if size == first {
        return Ok(());
    }
    let ([width, height], [first_width, first_height]) = (size, first);
    let message = format!(
        "a frame has {width}×{height} px and the animation {first_width}×{first_height}: make them equal"
    );
    Err(Error::new(ErrorKind::Picture, message))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use ::image::codecs::gif::GifDecoder;
    use ::image::codecs::png::PngDecoder;
    use ::image::codecs::webp::WebPDecoder;
    use ::image::{AnimationDecoder, Frame};

    use super::*;

    const ALL: [AnimationFormat; 3] = [
        AnimationFormat::Gif,
        AnimationFormat::Apng,
        AnimationFormat::Webp,
    ];

    /// Frames of `width`×`height` px in which a bar grows by a column of its own colour.
    fn film(width: usize, height: usize) -> Vec<Image> {
        let frame = |k: usize| {
            let level = move |i: usize, c: usize| {
                let x = i % width;
                let here = (1..k).contains(&x) && i / width > 0;
                if here { (x * 40 + c * 70) % 256 } else { 255 }
            };
            let plane = |c: usize| (0..width * height).map(move |i| level(i, c) as f32 / 255.0);
            Image::new(width, height, [0, 1, 2].map(|c| plane(c).collect())).unwrap()
        };
        // One frame comes twice.
        [0, 2, 3, 3, width - 1].map(frame).to_vec()
    }

    fn encoded(format: AnimationFormat, frames: &[Image]) -> Vec<u8> {
        let frames = frames.iter().map(|frame| Ok((frame.clone(), 80)));
        animated(format, frames).unwrap()
    }

    fn decoded(format: AnimationFormat, bytes: &[u8]) -> Vec<Frame> {
        let bytes = Cursor::new(bytes);
        let frames = match format {
            AnimationFormat::Gif => GifDecoder::new(bytes).unwrap().into_frames(),
            AnimationFormat::Apng => {
                let decoder = PngDecoder::new(bytes).unwrap();
                decoder.apng().unwrap().into_frames()
            }
            AnimationFormat::Webp => WebPDecoder::new(bytes).unwrap().into_frames(),
        };
        frames.collect_frames().unwrap()
    }

    fn rgb(frame: &Frame) -> Vec<u8> {
        let pixels = frame.buffer().pixels();
        pixels.flat_map(|p| [p.0[0], p.0[1], p.0[2]]).collect()
    }

    #[test]
    fn all_frames_come_back() {
        for (format, (width, height)) in ALL.into_iter().zip([(9, 4), (6, 7), (9, 7)]) {
            let film = film(width, height);
            let frames = decoded(format, &encoded(format, &film));
            assert_eq!(frames.len(), film.len(), "{format:?}");
            for (frame, image) in frames.iter().zip(&film) {
                // The WebP decoder at hand rounds down what it blends, where it is opaque too.
                let lost = u8::from(format == AnimationFormat::Webp);
                let differs = |(a, b): (u8, u8)| a.abs_diff(b) > lost;
                let (read, written) = (rgb(frame), image.to_rgb8());
                assert!(!read.into_iter().zip(written).any(differs), "{format:?}");
                assert!(frame.buffer().pixels().all(|p| p.0[3] == 255), "{format:?}");
                assert_eq!(frame.delay().numer_denom_ms(), (80, 1), "{format:?}");
            }
        }
    }

    #[test]
    fn a_small_change_takes_few_bytes() {
        let noise = |i: usize| (i.wrapping_mul(2_654_435_761) >> 7) % 256;
        let plane: Vec<f32> = (0..64 * 64).map(|i| noise(i) as f32 / 255.0).collect();
        let first = Image::new(64, 64, [plane.clone(), plane.clone(), plane.clone()]).unwrap();
        let mut changed = plane.clone();
        changed[2000] = 1.0 - changed[2000].round();
        let second = Image::new(64, 64, [changed, plane.clone(), plane]).unwrap();
        for format in ALL {
            let still = encoded(format, std::slice::from_ref(&first)).len();
            let moving = encoded(format, &[first.clone(), second.clone()]).len();
            assert!(moving < still + 200, "{format:?}: {still}, {moving}");
        }
    }

    #[test]
    fn they_repeat_for_ever() {
        let film = film(5, 4);
        let gif = encoded(AnimationFormat::Gif, &film);
        assert!(gif.windows(14).any(|w| w == b"NETSCAPE2.0\x03\x01\x00"));
        let png = encoded(AnimationFormat::Apng, &film);
        assert!(png.windows(12).any(|w| w == b"acTL\0\0\0\x05\0\0\0\0"));
        let webp = encoded(AnimationFormat::Webp, &film);
        let anim = webp.windows(4).position(|w| w == b"ANIM").unwrap();
        assert_eq!(webp[anim + 12..anim + 14], [0, 0]);
    }

    #[test]
    fn what_the_format_cannot_say_is_refused() {
        for (format, side) in [
            (AnimationFormat::Gif, 70_000),
            (AnimationFormat::Webp, 16_385),
        ] {
            let wide = Image::filled(side, 1, [0.0; 3]).unwrap();
            let error = animated(format, [Ok((wide, 40))].into_iter()).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Picture);
            assert!(error.to_string().contains(&side.to_string()), "{error}");
        }
    }

    #[test]
    fn frames_of_two_sizes_are_refused() {
        let frames = [[3, 2], [2, 3]].map(|[width, height]| {
            let image = Image::filled(width, height, [0.0; 3])?;
            Ok((image, 40))
        });
        assert!(animated(AnimationFormat::Apng, frames.into_iter()).is_err());
    }

    #[test]
    fn no_frames_make_no_file() {
        assert!(animated(AnimationFormat::Gif, [].into_iter()).is_err());
    }
}
