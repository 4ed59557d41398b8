//! Animated WebP: combines lossless still pictures in one file, as the WebP container format specifies
//! (RIFF: all numbers little-endian, chunks padded to even lengths).

use ::image::codecs::webp::WebPEncoder;
use ::image::{ExtendedColorType, ImageEncoder};

use super::{Encoder, Patch, unencoded};
use crate::error::{Error, ErrorKind, Result};

/// Flags of the extended header: has alpha, has an animation.
const ALPHA_AND_ANIMATION: u8 = 0x12;
/// Bytes before the chunks of a still picture: `RIFF`, length, `WEBP`.
const HEAD: usize = 12;
/// Longest time of a frame, ms.
const MAX_MS: u32 = (1 << 24) - 1;

/// An unfinished WebP.
pub(super) struct Webp {
    width: u32,
    height: u32,
    /// Chunks of all frames.
    chunks: Vec<u8>,
}

impl Webp {
    pub(super) fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            chunks: Vec::new(),
        }
    }
}

impl Encoder for Webp {
    fn push(&mut self, patch: &Patch, ms: u32) -> Result<()> {
        let mut frame = Vec::new();
        let numbers = [patch.x / 2, patch.y / 2, patch.width - 1, patch.height - 1];
        for number in numbers.into_iter().chain([ms.min(MAX_MS)]) {
            frame.extend(three_bytes(number));
        }
        // Composited over the previous frame, and kept.
        frame.push(0);
        frame.extend(&still(patch)?[HEAD..]);
        push_chunk(&mut self.chunks, b"ANMF", &frame);
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>> {
        let mut body = b"WEBP".to_vec();
        let mut header = vec![ALPHA_AND_ANIMATION, 0, 0, 0];
        header.extend(three_bytes(self.width - 1));
        header.extend(three_bytes(self.height - 1));
        push_chunk(&mut body, b"VP8X", &header);
        // White background; 0 plays mean an endless loop.
        push_chunk(&mut body, b"ANIM", &[255, 255, 255, 255, 0, 0]);
        body.extend(self.chunks);
        let mut file = Vec::with_capacity(body.len() + 8);
        push_chunk(&mut file, b"RIFF", &body);
        Ok(file)
    }
}

/// The patch as a file of its own: a head and one chunk of lossless data.
fn still(patch: &Patch) -> Result<Vec<u8>> {
    let mut webp = Vec::new();
    WebPEncoder::new_lossless(&mut webp)
        .write_image(
            &patch.rgba,
            patch.width,
            patch.height,
            ExtendedColorType::Rgba8,
        )
        .map_err(|cause| unencoded("WebP", cause))?;
    if webp.get(HEAD..HEAD + 4) != Some(b"VP8L") {
        let message = "cannot encode a frame as WebP: the encoder gave no lossless data";
        return Err(Error::new(ErrorKind::Picture, message));
    }
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
