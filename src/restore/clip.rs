//! Tones whose noise was cut off at black or white.
//!
//! Noise on white paper can only darken it, so that the mean is darker than the paper; likewise on black.

use crate::image::Image;
use crate::math;

/// Share of the pixels about an end of the range that are at that end, if noise was cut off there.
const LEAST_CUT: f32 = 0.25;

/// Levels from an end within which noise may have been cut off, in RMS of the noise.
const REACH: f32 = 3.0;

/// Of noise with an RMS of 1: the mean distance of what is left of it from the end where it is cut off, by the distance of its
/// mean from there, z·Φ(z) + φ(z).
const CUT: [[f32; 2]; 8] = [
    [0.3989, 0.0],
    [0.5364, 0.25],
    [0.6978, 0.5],
    [0.8812, 0.75],
    [1.0833, 1.0],
    [1.5293, 1.5],
    [2.0085, 2.0],
    [3.0004, 3.0],
];

/// RMS of the part of such noise that is left where its mean is at the end, in units of the whole.
const LEFT: f32 = 0.583;

/// Levels from an end within which pixels are about there.
const ABOUT: f32 = 20.0;

/// The channels of `restored` as they were before noise was cut off from them, as `noisy` shows.
pub(super) fn unclipped(noisy: &Image, restored: Image) -> [Vec<f32>; 3] {
    let mut planes = restored.into_planes();
    let is_opaque = |i: usize| noisy.alpha().is_none_or(|alpha| alpha[i] >= 1.0);
    for (plane, noisy) in planes.iter_mut().zip(noisy.planes()) {
        for is_white in [false, true] {
            // The distance from the end, in levels.
            let away = |value: f32| 255.0 * if is_white { 1.0 - value } else { value };
            let pixels = plane.iter().zip(noisy).enumerate();
            let opaque = pixels.filter(|(i, _)| is_opaque(*i));
            let distances = opaque.map(|(_, (restored, noisy))| [away(*restored), away(*noisy)]);
            let Some(noise) = cut_noise(distances) else {
                continue;
            };
            for value in plane.iter_mut() {
                let distance = away(*value);
                if distance < REACH * noise {
                    let mean = noise * before(distance / noise) / 255.0;
                    *value = if is_white { 1.0 - mean } else { mean };
                }
            }
        }
    }
    planes
}

/// RMS of the noise that was cut off at an end, from the distances of pixels from it without and with noise; `None` if none
/// was.
fn cut_noise(pixels: impl Iterator<Item = [f32; 2]>) -> Option<f32> {
    let [mut count, mut at_end, mut squares] = [0.0_f64; 3];
    for [restored, noisy] in pixels.filter(|[restored, _]| *restored < ABOUT) {
        count += 1.0;
        at_end += f64::from(u8::from(noisy < 0.5));
        squares += math::powi(f64::from(noisy - restored), 2);
    }
    let rms = (squares / count.max(1.0)).sqrt() as f32 / LEFT;
    (count > 0.0 && at_end > f64::from(LEAST_CUT) * count && rms > 1.0).then_some(rms)
}

/// The distance of the mean of all noise from the end, by that of the mean of what is left, both in units of its RMS.
fn before(cut: f32) -> f32 {
    let above = CUT.iter().position(|[after, _]| *after > cut);
    match above {
        Some(0) => 0.0,
        Some(k) => {
            let [[low, from], [high, to]] = [CUT[k - 1], CUT[k]];
            from + (to - from) * (cut - low) / (high - low)
        }
        None => cut,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng;

    #[test]
    fn paper_under_noise_is_white_again() {
        let noise = |i| rng::normal(5, 0, i, 0) * 8.0 / 255.0;
        let noisy: Vec<f32> = (0..4096).map(|i| (1.0 + noise(i)).min(1.0)).collect();
        let mean = noisy.iter().sum::<f32>() / 4096.0;
        let planes = || [noisy.clone(), noisy.clone(), noisy.clone()];
        let picture = Image::new(64, 64, planes()).unwrap();
        let flat = Image::filled(64, 64, [mean; 3]).unwrap();
        assert!(mean < 0.99, "noise darkens paper");
        let back = unclipped(&picture, flat);
        assert!(back.iter().flatten().all(|v| *v > 0.998), "{}", back[0][0]);
    }
}
