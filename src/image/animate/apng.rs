//! Animated PNG. This file alone uses the `png` crate.

use ::png::{BitDepth, BlendOp, ColorType, DisposeOp, Encoder, EncodingError, Filter};

use super::Patches;
use crate::error::{Error, ErrorKind, Result};

/// A file of patches, each composited over the previous ones.
pub(super) fn encoded(patches: &mut Patches<'_>) -> Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, patches.width, patches.height);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_filter(Filter::Adaptive);
    // 0 plays mean an endless loop.
    encoder.set_animated(patches.count, 0).map_err(unencoded)?;
    encoder.set_blend_op(BlendOp::Over).map_err(unencoded)?;
    encoder.set_dispose_op(DisposeOp::None).map_err(unencoded)?;
    let mut writer = encoder.write_header().map_err(unencoded)?;
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
        push().map_err(unencoded)?;
    }
    writer.finish().map_err(unencoded)?;
    Ok(file)
}

fn unencoded(cause: EncodingError) -> Error {
    let message = format!("cannot encode a frame as PNG: {cause}");
    Error::new(ErrorKind::Picture, message).caused_by(cause)
}
