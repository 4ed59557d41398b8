//! Animated GIF. This file alone uses the `gif` crate.

use ::gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};

use super::Patches;
use crate::error::{Error, ErrorKind, Result};

/// Speed at which each frame's 256 colours are chosen, from 1 (slowest, with most care) to 30. At 10 a frame of 100,000
/// px takes some 20 ms; below 5 it takes several times as long without a visible difference.
const SPEED: i32 = 10;

/// A file of patches, each composited over the previous ones.
pub(super) fn encoded(patches: &mut Patches<'_>) -> Result<Vec<u8>> {
    let (width, height) = (patches.width as u16, patches.height as u16);
    let mut encoder = Encoder::new(Vec::new(), width, height, &[]).map_err(unencoded)?;
    encoder.set_repeat(Repeat::Infinite).map_err(unencoded)?;
    for patch in patches {
        let mut patch = patch?;
        let (width, height) = (patch.width as u16, patch.height as u16);
        let mut frame = Frame::from_rgba_speed(width, height, &mut patch.rgba, SPEED);
        (frame.left, frame.top) = (patch.x as u16, patch.y as u16);
        // Hundredths of a second, rounded up: many viewers slow down a frame of 0.
        frame.delay = u16::try_from(patch.ms.div_ceil(10)).unwrap_or(u16::MAX);
        frame.dispose = DisposalMethod::Keep;
        encoder.write_frame(&frame).map_err(unencoded)?;
    }
    encoder.into_inner().map_err(unencoded)
}

fn unencoded(cause: EncodingError) -> Error {
    let message = format!("cannot encode a frame as GIF: {cause}");
    Error::new(ErrorKind::Picture, message).caused_by(cause)
}
