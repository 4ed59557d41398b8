//! Animated WebP: combines lossless still pictures in one file, as the WebP container format specifies
//! (RIFF: all numbers little-endian, chunks padded to even lengths).

use ::image::codecs::webp::WebPEncoder;
use ::image::{ExtendedColorType, ImageError};

use super::{Patch, Patches};
use crate::error::{Error, ErrorKind, Result};

/// Flags of the extended header: has alpha, has an animation.
const ALPHA_AND_ANIMATION: u8 = 0x12;
/// Bytes before the chunks of a still picture: `RIFF`, length, `WEBP`.
const HEAD: usize = 12;
/// Longest time of a frame, ms.
const MAX_MS: u32 = (1 << 24) - 1;

/// A file of patches, each composited over the previous ones.
pub(super) fn encoded(patches: &mut Patches<'_>) -> Result<Vec<u8>> {
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
        .map_err(unencoded)?;
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

fn unencoded(cause: ImageError) -> Error {
    let message = format!("cannot encode a frame as WebP: {cause}");
    Error::new(ErrorKind::Picture, message).caused_by(cause)
}
