//! Pictures one after another, as an animated GIF.

use std::io::Write;

use ::image::codecs::gif::{GifEncoder, Repeat};
use ::image::{Delay, Frame, ImageError, RgbaImage};

use super::Image;
use crate::error::{Error, ErrorKind, Result};

/// How carefully each frame's 256 colours are chosen, from 1 (slowest) to 30. At 10 a frame of
/// 100,000 px takes some 20 ms; below 5 it takes several times that, and nobody sees a difference.
const SPEED: i32 = 10;

/// An animated GIF that is being written. It repeats for ever, and is complete when dropped.
pub struct Animation<W: Write> {
    encoder: GifEncoder<W>,
    frame_ms: u32,
}

impl<W: Write> Animation<W> {
    /// An animation of frames of `frame_ms` each, rounded by the format to hundredths of a second.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when `writer` does not take it.
    pub fn new(writer: W, frame_ms: u32) -> Result<Self> {
        let mut encoder = GifEncoder::new_with_speed(writer, SPEED);
        encoder.set_repeat(Repeat::Infinite).map_err(unwritten)?;
        Ok(Self { encoder, frame_ms })
    }

    /// Appends a frame; its alpha plays no part. All frames are as large as the first.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when the writer does not take it; [`ErrorKind::Picture`] when a side is
    /// beyond 65,535 px, which is what a GIF can say.
    pub fn push(&mut self, image: &Image) -> Result<()> {
        let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let rgba = image.to_rgb8().chunks_exact(3).flat_map(opaque).collect();
        let buffer = RgbaImage::from_raw(side(image.width()), side(image.height()), rgba);
        let Some(buffer) = buffer else {
            let message = "the picture is too large for a GIF: at most 65535 px a side";
            return Err(Error::new(ErrorKind::Picture, message));
        };
        let delay = Delay::from_numer_denom_ms(self.frame_ms, 1);
        let frame = Frame::from_parts(buffer, 0, 0, delay);
        self.encoder.encode_frame(frame).map_err(unwritten)
    }
}

fn opaque(rgb: &[u8]) -> [u8; 4] {
    [rgb[0], rgb[1], rgb[2], 255]
}

fn unwritten(cause: ImageError) -> Error {
    let kind = match cause {
        ImageError::IoError(_) => ErrorKind::Io,
        _ => ErrorKind::Picture,
    };
    Error::new(kind, format!("cannot write the animation: {cause}")).caused_by(cause)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Limits;

    #[test]
    fn the_first_frame_can_be_read_back() {
        let mut bytes = Vec::new();
        let mut animation = Animation::new(&mut bytes, 40).unwrap();
        let red = Image::filled(5, 3, [1.0, 0.0, 0.0]).unwrap();
        animation.push(&red).unwrap();
        animation
            .push(&Image::filled(5, 3, [0.0; 3]).unwrap())
            .unwrap();
        drop(animation);
        assert_eq!(
            Image::decode(&bytes, "a.gif", Limits::default()).unwrap(),
            red
        );
        assert!(
            bytes.windows(11).any(|w| w == b"NETSCAPE2.0"),
            "does not repeat"
        );
    }

    #[test]
    fn a_picture_too_large_is_refused() {
        let mut animation = Animation::new(std::io::sink(), 40).unwrap();
        let wide = Image::filled(70_000, 1, [0.0; 3]).unwrap();
        assert_eq!(
            animation.push(&wide).unwrap_err().kind(),
            ErrorKind::Picture
        );
    }
}
