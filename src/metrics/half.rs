//! Planes at half the size, and their linear enlargement.

/// A plane at half the size, each pixel the mean of 2×2.
pub(crate) struct Half {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) values: Vec<f32>,
}

impl Half {
    /// The half of a plane, rows of `width`; the last row and column count twice where their number is odd.
    pub(crate) fn of(values: &[f32], width: usize) -> Self {
        let rows: Vec<&[f32]> = values.chunks(width).collect();
        let pairs = rows.chunks(2).map(|pair| (pair[0], pair[pair.len() - 1]));
        let mean = |(top, bottom): (&[f32], &[f32])| {
            let quads = top.chunks(2).zip(bottom.chunks(2));
            let sum = |pair: &[f32]| pair[0] + pair[pair.len() - 1];
            quads
                .map(|(a, b)| (sum(a) + sum(b)) / 4.0)
                .collect::<Vec<_>>()
        };
        Self {
            width: width.div_ceil(2),
            height: rows.len().div_ceil(2),
            values: pairs.flat_map(mean).collect(),
        }
    }

    /// The value at pixel (x, y) of the whole plane, interpolated between the pixels of the half.
    pub(crate) fn at(&self, x: usize, y: usize) -> f32 {
        let beside = |at: usize, size: usize| {
            // A pixel's centre is a quarter of a half-size pixel from the centre of the one it lies in, towards the neighbour on
            // its side: linear weights ¾ and ¼. At the border the neighbour is the pixel itself.
            let own = at / 2;
            let other = if at.is_multiple_of(2) {
                own.saturating_sub(1)
            } else {
                own + 1
            };
            (own, other.min(size - 1))
        };
        let ((x, left), (y, above)) = (beside(x, self.width), beside(y, self.height));
        let at = |x: usize, y: usize| self.values[y * self.width + x];
        let row = |y: usize| 0.75 * at(x, y) + 0.25 * at(left, y);
        0.75 * row(y) + 0.25 * row(above)
    }
}
