//! Animated GIF. This file alone uses the `gif` crate.

use ::gif::{DisposalMethod, EncodingError, Frame, Repeat};

use super::{Encoder, Patch};
use crate::error::{Error, ErrorKind, Result};

/// Speed at which each frame's 256 colours are chosen, from 1 (slowest, with most care) to 30. At 10 a frame of 100,000
/// px takes some 20 ms; below 5 it takes several times as long without a visible difference.
const SPEED: i32 = 10;

/// An unfinished GIF.
pub(super) struct Gif(::gif::Encoder<Vec<u8>>);

impl Gif {
    pub(super) fn new(width: u32, height: u32) -> Result<Self> {
        let (width, height) = (width as u16, height as u16);
        let mut encoder = ::gif::Encoder::new(Vec::new(), width, height, &[]).map_err(unwritten)?;
        encoder.set_repeat(Repeat::Infinite).map_err(unwritten)?;
        Ok(Self(encoder))
    }
}

impl Encoder for Gif {
    fn push(&mut self, patch: &Patch, ms: u32) -> Result<()> {
        let (width, height) = (patch.width as u16, patch.height as u16);
        let mut rgba = patch.rgba.clone();
        let mut frame = Frame::from_rgba_speed(width, height, &mut rgba, SPEED);
        (frame.left, frame.top) = (patch.x as u16, patch.y as u16);
        frame.delay = u16::try_from(ms.div_ceil(10)).unwrap_or(u16::MAX);
        frame.dispose = DisposalMethod::Keep;
        self.0.write_frame(&frame).map_err(unwritten)
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>> {
        self.0.into_inner().map_err(unwritten)
    }
}

fn unwritten(cause: EncodingError) -> Error {
    let message = format!("cannot encode a frame as GIF: {cause}");
    Error::new(ErrorKind::Picture, message).caused_by(cause)
}
