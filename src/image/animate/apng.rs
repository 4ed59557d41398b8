//! Animated PNG: combines the data of still PNGs in one file, as specified by PNG, third edition, section
//! 11.3.6.

use ::image::codecs::png::{CompressionType, FilterType, PngEncoder};
use ::image::{ExtendedColorType, ImageEncoder};

use super::{Encoder, Patch, unencoded};
use crate::error::{Error, ErrorKind, Result};

const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
/// Frames stay, and the next one is composited over them.
const KEEP_AND_BLEND: [u8; 2] = [0, 1];

/// An unfinished PNG.
pub(super) struct Apng {
    width: u32,
    height: u32,
    frames: u32,
    /// Sequence number of the next chunk that has one.
    sequence: u32,
    /// Chunks of all frames.
    chunks: Vec<u8>,
}

impl Apng {
    pub(super) fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            frames: 0,
            sequence: 0,
            chunks: Vec::new(),
        }
    }

    fn numbered(&mut self) -> Vec<u8> {
        self.sequence += 1;
        (self.sequence - 1).to_be_bytes().to_vec()
    }

    fn push_control(&mut self, patch: &Patch, ms: u32) {
        let mut control = self.numbered();
        for number in [patch.width, patch.height, patch.x, patch.y] {
            control.extend(number.to_be_bytes());
        }
        control.extend(u16::try_from(ms).unwrap_or(u16::MAX).to_be_bytes());
        control.extend(1000_u16.to_be_bytes());
        control.extend(KEEP_AND_BLEND);
        push_chunk(&mut self.chunks, b"fcTL", &control);
    }
}

impl Encoder for Apng {
    fn push(&mut self, patch: &Patch, ms: u32) -> Result<()> {
        let data = still(patch)?;
        self.push_control(patch, ms);
        if self.frames == 0 {
            push_chunk(&mut self.chunks, b"IDAT", &data);
        } else {
            let mut numbered = self.numbered();
            numbered.extend(data);
            push_chunk(&mut self.chunks, b"fdAT", &numbered);
        }
        self.frames += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>> {
        let mut file = SIGNATURE.to_vec();
        let mut header = [self.width, self.height].map(u32::to_be_bytes).concat();
        // 8 bits of RGBA, deflate, the usual filters, not interlaced.
        header.extend([8, 6, 0, 0, 0]);
        push_chunk(&mut file, b"IHDR", &header);
        // 0 plays mean an endless loop.
        push_chunk(
            &mut file,
            b"acTL",
            &[self.frames, 0].map(u32::to_be_bytes).concat(),
        );
        file.extend(self.chunks);
        push_chunk(&mut file, b"IEND", &[]);
        Ok(file)
    }
}

/// The compressed data of the patch as a picture of its own.
fn still(patch: &Patch) -> Result<Vec<u8>> {
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive)
        .write_image(
            &patch.rgba,
            patch.width,
            patch.height,
            ExtendedColorType::Rgba8,
        )
        .map_err(|cause| unencoded("PNG", cause))?;
    let mut data = Vec::new();
    let mut rest = png.get(SIGNATURE.len()..).unwrap_or_default();
    while let Some((kind, content, after)) = split_chunk(rest) {
        if kind == b"IDAT" {
            data.extend(content);
        }
        rest = after;
    }
    if data.is_empty() {
        let message = "cannot encode a frame as PNG: the encoder gave no data";
        return Err(Error::new(ErrorKind::Picture, message));
    }
    Ok(data)
}

/// Kind and content of the first chunk, and the bytes after it.
fn split_chunk(bytes: &[u8]) -> Option<(&[u8], &[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    let (kind, rest) = rest.split_at_checked(4)?;
    let (content, rest) = rest.split_at_checked(u32::from_be_bytes(*length) as usize)?;
    let (_checksum, rest) = rest.split_at_checked(4)?;
    Some((kind, content, rest))
}

fn push_chunk(file: &mut Vec<u8>, kind: &[u8; 4], content: &[u8]) {
    file.extend((content.len() as u32).to_be_bytes());
    file.extend(kind);
    file.extend(content);
    let mut checksum = crc32fast::Hasher::new();
    checksum.update(kind);
    checksum.update(content);
    file.extend(checksum.finalize().to_be_bytes());
}
