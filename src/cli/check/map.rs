//! The map of the places where a render differs for the eye.

use anyhow::Result;
use strokefit::image::Image;
use strokefit::metrics;
use strokefit::report::picture::{self, heat};

/// Where `drawn` loses SSIMULACRA2 against `target`, as PNG.
pub(super) fn png(target: &Image, drawn: &Image) -> Result<Vec<u8>> {
    let scores = metrics::ssimulacra2_map(target, drawn)?;
    let map = picture::map(target.width(), &scores, |score| heat(lost(score)))?;
    Ok(map.encode_png()?)
}

/// 0 for the score of equal pictures, 1 for a score of 0 or less.
fn lost(score: f32) -> f64 {
    1.0 - f64::from(score) / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_bright() {
        // Stripes are lost on the right half.
        let stripes = |is_drawn: bool| {
            let value = |i: usize| match i % 128 {
                64.. if !is_drawn && i % 4 < 2 => 0.8,
                _ => 0.5,
            };
            let plane: Vec<f32> = (0..128 * 64).map(value).collect();
            Image::new(128, 64, [plane.clone(), plane.clone(), plane]).unwrap()
        };
        let bytes = png(&stripes(false), &stripes(true)).unwrap();
        let map = Image::decode(&bytes, "map", strokefit::image::Limits::default()).unwrap();
        let green = |x: usize| map.planes()[1][32 * 128 + x];
        let (left, right) = (green(8), green(120));
        assert!(right > left + 0.3, "{left} {right}");
    }
}
