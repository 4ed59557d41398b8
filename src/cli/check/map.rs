//! The picture of where a render differs for the eye.

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
        let target = Image::filled(40, 20, [0.5; 3]).unwrap();
        let plane: Vec<f32> = (0..800)
            .map(|i| if i % 40 < 20 { 0.5 } else { 0.9 })
            .collect();
        let drawn = Image::new(40, 20, [plane.clone(), plane.clone(), plane]).unwrap();
        let bytes = png(&target, &drawn).unwrap();
        let map = Image::decode(&bytes, "map", strokefit::image::Limits::default()).unwrap();
        let green = |x: usize| map.planes()[1][10 * 40 + x];
        assert!(
            green(3) < 0.4 && green(36) > 0.6,
            "{} {}",
            green(3),
            green(36)
        );
    }
}
