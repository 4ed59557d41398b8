//! The picture to draw.

use strokefit::image::{Image, Limits, Rows};
use wasm_bindgen::prelude::*;

/// A picture in the memory of the WebAssembly.
#[wasm_bindgen]
pub struct Target(Image);

#[wasm_bindgen]
impl Target {
    /// A picture from its samples, row by row: 1 (grey), 2 (grey, alpha), 3 (RGB) or 4 (RGBA) for each pixel. Alpha is
    /// straight.
    ///
    /// # Errors
    /// When there are no pixels, or the samples are too many or too few.
    #[wasm_bindgen(js_name = fromPixels)]
    pub fn from_pixels(samples: &[u8], width: usize, height: usize) -> Result<Self, JsError> {
        let pixels = width.saturating_mul(height).max(1);
        if !samples.len().is_multiple_of(pixels) {
            let message = format!(
                "{} samples are not 1 to 4 for each of {width}×{height} px: give one value of 0 to 255 for each channel",
                samples.len()
            );
            return Err(JsError::new(&message));
        }
        let rows = Rows::packed(width, height, samples.len() / pixels, samples);
        Ok(Self(Image::from_rows(rows)?))
    }

    /// The picture that a PNG file holds, to the bit; colour profiles are ignored.
    ///
    /// # Errors
    /// When the bytes are no PNG, or a damaged one.
    #[wasm_bindgen(js_name = fromPng)]
    pub fn from_png(bytes: &[u8]) -> Result<Self, JsError> {
        Ok(Self(Image::decode(
            bytes,
            "the picture",
            Limits::default(),
        )?))
    }
}

impl Target {
    /// The picture itself.
    pub(crate) fn image(&self) -> &Image {
        &self.0
    }
}
