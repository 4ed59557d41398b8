//! Animated GIF, PNG and WebP.
//!
//! Each frame after the first holds only the changes: the rectangle around the pixels that differ from
//! the previous frame, with equal pixels transparent. GIF allows 256 colours per frame; PNG and WebP are
//! lossless.

use std::error;

use ::gif::{DisposalMethod, Frame, Repeat};
use ::image::ExtendedColorType;
use ::image::codecs::webp::WebPEncoder;
use ::png::{BitDepth, BlendOp, ColorType, DisposeOp, Filter};

use super::Image;
use crate::error::{Error, ErrorKind, Result};

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
        AnimationFormat::Gif => gif(&mut patches),
        AnimationFormat::Apng => apng(&mut patches),
        AnimationFormat::Webp => webp(&mut patches),
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

/// Speed at which each frame's 256 colours are chosen, from 1 (slowest, with most care) to 30. At 10 a frame of 100,000
/// px takes some 20 ms; below 5 it takes several times as long without a visible difference.
const SPEED: i32 = 10;

/// A GIF of patches, each composited over the previous ones.
fn gif(patches: &mut Patches<'_>) -> Result<Vec<u8>> {
    let fail = |e| unencoded("GIF", e);
    let (width, height) = (patches.width as u16, patches.height as u16);
    let mut encoder = ::gif::Encoder::new(Vec::new(), width, height, &[]).map_err(fail)?;
    encoder.set_repeat(Repeat::Infinite).map_err(fail)?;
    for patch in patches {
        let mut patch = patch?;
        let (width, height) = (patch.width as u16, patch.height as u16);
        let mut frame = Frame::from_rgba_speed(width, height, &mut patch.rgba, SPEED);
        (frame.left, frame.top) = (patch.x as u16, patch.y as u16);
        // Hundredths of a second, rounded up: many viewers slow down a frame of 0.
        frame.delay = u16::try_from(patch.ms.div_ceil(10)).unwrap_or(u16::MAX);
        frame.dispose = DisposalMethod::Keep;
        encoder.write_frame(&frame).map_err(fail)?;
    }
    encoder.into_inner().map_err(fail)
}

/// An animated PNG of patches, each composited over the previous ones.
fn apng(patches: &mut Patches<'_>) -> Result<Vec<u8>> {
    let fail = |e| unencoded("PNG", e);
    let mut file = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut file, patches.width, patches.height);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_filter(Filter::Adaptive);
    // 0 plays mean an endless loop.
    encoder.set_animated(patches.count, 0).map_err(fail)?;
    encoder.set_blend_op(BlendOp::Over).map_err(fail)?;
    encoder.set_dispose_op(DisposeOp::None).map_err(fail)?;
    let mut writer = encoder.write_header().map_err(fail)?;
    for patch in patches {
        let patch = patch?;
        let delay = u16::try_from(patch.ms).unwrap_or(u16::MAX);
        let mut push = || {
            writer.reset_frame_position()?;
            writer.set_frame_dimension(patch.width, patch.height)?;
            writer.set_frame_position(patch.x, patch.y)?;
            writer.set_frame_delay(delay, 1000)?;
            writer.write_image_data(&patch.rgba)
        };
        push().map_err(fail)?;
    }
    writer.finish().map_err(fail)?;
    Ok(file)
}

/// Flags of the extended header: has alpha, has an animation.
const ALPHA_AND_ANIMATION: u8 = 0x12;
/// Bytes before the chunks of a still picture: `RIFF`, length, `WEBP`.
const HEAD: usize = 12;
/// Longest time of a frame, ms.
const MAX_MS: u32 = (1 << 24) - 1;

/// An animated WebP: lossless still pictures in one file, as the WebP container format specifies (RIFF: all numbers
/// little-endian, chunks padded to even lengths).
fn webp(patches: &mut Patches<'_>) -> Result<Vec<u8>> {
    let mut body = b"WEBP".to_vec();
    let mut header = vec![ALPHA_AND_ANIMATION, 0, 0, 0];
    header.extend(three_bytes(patches.width - 1));
    header.extend(three_bytes(patches.height - 1));
    push_chunk(&mut body, b"VP8X", &header);
    // White background; 0 plays mean an endless loop.
    push_chunk(&mut body, b"ANIM", &[255, 255, 255, 255, 0, 0]);
    for patch in patches {
        let patch = patch?;
        let numbers = [patch.x / 2, patch.y / 2, patch.width - 1, patch.height - 1];
        let numbers = numbers.into_iter().chain([patch.ms.min(MAX_MS)]);
        let mut frame: Vec<u8> = numbers.flat_map(three_bytes).collect();
        // Composited over the previous frame, and kept.
        frame.push(0);
        frame.extend(still(&patch)?.get(HEAD..).unwrap_or_default());
        push_chunk(&mut body, b"ANMF", &frame);
    }
    let mut file = Vec::with_capacity(body.len() + 8);
    push_chunk(&mut file, b"RIFF", &body);
    Ok(file)
}

/// The patch as a file of its own: a head and one chunk of lossless data.
fn still(patch: &Patch) -> Result<Vec<u8>> {
    let mut webp = Vec::new();
    let kind = ExtendedColorType::Rgba8;
    WebPEncoder::new_lossless(&mut webp)
        .encode(&patch.rgba, patch.width, patch.height, kind)
        .map_err(|e| unencoded("WebP", e))?;
    Ok(webp)
}

fn three_bytes(number: u32) -> [u8; 3] {
    let [a, b, c, _] = number.to_le_bytes();
    [a, b, c]
}

fn push_chunk(file: &mut Vec<u8>, kind: &[u8; 4], content: &[u8]) {
    file.extend(kind);
    file.extend((content.len() as u32).to_le_bytes());
    file.extend(content);
    if content.len() % 2 == 1 {
        file.push(0);
    }
}

fn unencoded(format: &str, cause: impl error::Error + Send + Sync + 'static) -> Error {
    let message = format!("cannot encode a frame as {format}: {cause}");
    Error::new(ErrorKind::Picture, message).caused_by(cause)
}

/// A rectangle of RGBA pixels, transparent where nothing changes.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Patch {
    /// Left edge, px; even, as WebP requires.
    x: u32,
    /// Upper edge, px; even.
    y: u32,
    width: u32,
    height: u32,
    /// Time for which it is shown, ms.
    ms: u32,
    /// `width·height` pixels row by row, not premultiplied.
    rgba: Vec<u8>,
}

/// An 8-bit colour.
type Rgb8 = [u8; 3];

impl Patch {
    /// The patch that turns `before` into `image`, of the same size; without `before`, the whole image. A
    /// frame that equals the previous one is a single transparent pixel.
    fn between(before: Option<&Image>, image: &Image, ms: u32) -> Self {
        let (width, height) = (image.width(), image.height());
        let after = pixels(image);
        let Some(before) = before.map(pixels) else {
            let opaque = after.iter().flat_map(|&color| opaque(color)).collect();
            return Self::new([0, 0, width, height], opaque, ms);
        };
        let differs = |x: usize, y: usize| before[y * width + x] != after[y * width + x];
        let [x, y, right, bottom] = bounds(width, height, differs).unwrap_or([0, 0, 1, 1]);
        // One column or row more on the left or above, where that makes the corner even: WebP stores half of it.
        let (x, y) = (x & !1, y & !1);
        let mut rgba = Vec::with_capacity((right - x) * (bottom - y) * 4);
        for (x, y) in (y..bottom).flat_map(|y| (x..right).map(move |x| (x, y))) {
            let pixel = differs(x, y).then(|| opaque(after[y * width + x]));
            rgba.extend(pixel.unwrap_or_default());
        }
        Self::new([x, y, right - x, bottom - y], rgba, ms)
    }

    fn new(place: [usize; 4], rgba: Vec<u8>, ms: u32) -> Self {
        let [x, y, width, height] = place.map(|n| n as u32);
        Self {
            x,
            y,
            width,
            height,
            ms,
            rgba,
        }
    }
}

fn opaque([r, g, b]: Rgb8) -> [u8; 4] {
    [r, g, b, 255]
}

fn pixels(image: &Image) -> Vec<Rgb8> {
    let bytes = image.to_rgb8();
    bytes.as_chunks::<3>().0.to_vec()
}

/// Left, top, right and bottom (both exclusive) of the pixels for which `inside` is true.
fn bounds(
    width: usize,
    height: usize,
    inside: impl Fn(usize, usize) -> bool,
) -> Option<[usize; 4]> {
    // From each side to the first pixel inside. Columns are searched between top and bottom alone.
    let in_row = |y: usize| (0..width).any(|x| inside(x, y));
    let top = (0..height).find(|&y| in_row(y))?;
    let bottom = (top..height).rfind(|&y| in_row(y))? + 1;
    let in_column = |x: usize| (top..bottom).any(|y| inside(x, y));
    let left = (0..width).find(|&x| in_column(x))?;
    let right = (left..width).rfind(|&x| in_column(x))? + 1;
    Some([left, top, right, bottom])
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

    fn grey(levels: &[f32], width: usize) -> Image {
        let plane = levels.to_vec();
        Image::new(
            width,
            levels.len() / width,
            [plane.clone(), plane.clone(), plane],
        )
        .unwrap()
    }

    #[test]
    fn only_what_changes_is_said() {
        let before = grey(&[0.0; 20], 5);
        let mut levels = [0.0; 20];
        (levels[13], levels[19]) = (1.0, 1.0);
        let patch = Patch::between(Some(&before), &grey(&levels, 5), 40);
        assert_eq!([patch.x, patch.y, patch.width, patch.height], [2, 2, 3, 2]);
        let alphas: Vec<u8> = patch.rgba.chunks(4).map(|p| p[3]).collect();
        assert_eq!(alphas, [0, 255, 0, 0, 0, 255]);
    }

    #[test]
    fn nothing_new_is_one_clear_pixel() {
        let image = grey(&[0.5; 6], 3);
        let patch = Patch::between(Some(&image), &image, 40);
        assert_eq!((patch.width, patch.height), (1, 1));
        assert_eq!(patch.rgba, [0; 4]);
    }
}
