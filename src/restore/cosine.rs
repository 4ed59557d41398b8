//! The cosine transform of 8×8 blocks.

use crate::math;

/// Side of a block, px.
pub(super) const SIDE: usize = 8;

/// A block of values, or of its coefficients: rows of growing vertical frequency, of growing horizontal one in each.
pub(super) type Block = [[f32; SIDE]; SIDE];

/// The orthonormal cosine transform, as JPEG has it.
pub(super) struct Cosines {
    /// Each row is a wave.
    waves: Block,
    /// Each column is a wave.
    turned: Block,
}

impl Cosines {
    /// The transform.
    pub(super) fn new() -> Self {
        let wave = |k: usize, x: usize| {
            let scale = if k == 0 { 0.125_f64 } else { 0.25 };
            let angle = (2 * x + 1) as f64 * k as f64 * std::f64::consts::PI / 16.0;
            (scale.sqrt() * math::cos(angle)) as f32
        };
        let waves = std::array::from_fn(|k| std::array::from_fn(|x| wave(k, x)));
        let turned = std::array::from_fn(|x| std::array::from_fn(|k| wave(k, x)));
        Self { waves, turned }
    }

    /// The coefficients of a block of values.
    pub(super) fn forward(&self, values: &Block) -> Block {
        product(&product(&self.waves, values), &self.turned)
    }

    /// The values of a block of coefficients.
    pub(super) fn inverse(&self, coefficients: &Block) -> Block {
        product(&product(&self.turned, coefficients), &self.waves)
    }
}

/// The product of two matrices.
fn product(a: &Block, b: &Block) -> Block {
    let mut out = [[0.0; SIDE]; SIDE];
    for (row, line) in out.iter_mut().zip(a) {
        for (factor, values) in line.iter().zip(b) {
            for (sum, value) in row.iter_mut().zip(values) {
                *sum += factor * value;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_comes_back_and_keeps_its_energy() {
        let cosines = Cosines::new();
        let values: Block =
            std::array::from_fn(|y| std::array::from_fn(|x| ((x * 37 + y * 91) % 101) as f32));
        let coefficients = cosines.forward(&values);
        let back = cosines.inverse(&coefficients);
        let energy = |block: &Block| block.iter().flatten().map(|v| v * v).sum::<f32>();
        assert!((energy(&values) / energy(&coefficients) - 1.0).abs() < 1e-5);
        for (a, b) in values.iter().flatten().zip(back.iter().flatten()) {
            assert!((a - b).abs() < 1e-3, "{a} came back as {b}");
        }
    }

    #[test]
    fn the_first_coefficient_is_eight_times_the_mean() {
        let coefficients = Cosines::new().forward(&[[3.0; SIDE]; SIDE]);
        assert!((coefficients[0][0] - 24.0).abs() < 1e-4);
        assert!(
            coefficients
                .iter()
                .flatten()
                .skip(1)
                .all(|c| c.abs() < 1e-4)
        );
    }
}
