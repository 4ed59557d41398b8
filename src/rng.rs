//! Counter-based random numbers.
//!
//! A draw is a pure function of (seed, stage, item, draw index). So no result depends on the order in which
//! threads draw, and a stage can be recomputed alone. The mixer is the finaliser of `SplitMix64` (Steele,
//! Lea & Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014), applied once per word of
//! the key.

use std::f32::consts::TAU;

use crate::math;

/// 64 random bits for the key `(seed, stage, i, k)`.
pub fn bits(seed: u64, stage: u64, i: u64, k: u64) -> u64 {
    [stage, i, k].into_iter().fold(mix(seed), with)
}

/// The hash of words that have the hash `hash`, and of one `word` more.
pub(crate) fn with(hash: u64, word: u64) -> u64 {
    mix(hash ^ mix(word))
}

/// A uniform number in `0.0 .. 1.0` for the key `(seed, stage, i, k)`, a multiple of 2⁻²⁴.
pub fn draw(seed: u64, stage: u64, i: u64, k: u64) -> f32 {
    (bits(seed, stage, i, k) >> 40) as f32 / (1u64 << 24) as f32
}

/// A standard normal number for the key, by Box–Muller from draws `2k` and `2k + 1`.
pub fn normal(seed: u64, stage: u64, i: u64, k: u64) -> f32 {
    let radius = (-2.0 * math::ln(1.0 - draw(seed, stage, i, 2 * k))).sqrt();
    radius * math::cos(TAU * draw(seed, stage, i, 2 * k + 1))
}

fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_uniform_and_keyed() {
        let n = 20_000;
        let mean = (0..n).map(|i| f64::from(draw(7, 1, i, 0))).sum::<f64>() / n as f64;
        assert!((mean - 0.5).abs() < 0.01, "mean {mean}");
        assert_ne!(draw(7, 1, 2, 3), draw(7, 1, 3, 2));
        assert_ne!(draw(7, 1, 2, 3), draw(8, 1, 2, 3));
    }

    #[test]
    fn normals_have_unit_variance() {
        let n = 20_000;
        let variance = (0..n)
            .map(|i| math::powi(f64::from(normal(7, 1, i, 0)), 2))
            .sum::<f64>()
            / n as f64;
        assert!((variance - 1.0).abs() < 0.05, "variance {variance}");
    }
}
