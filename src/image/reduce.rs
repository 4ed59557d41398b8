//! Reduction of a picture to fewer pixels.

use std::ops::Range;

use rayon::prelude::*;

use super::Image;

impl Image {
    /// The picture at half the size (rounded up), each pixel the mean of up to 2×2; alpha is dropped.
    #[doc(hidden)]
    pub fn halved(&self) -> Self {
        let halves = self
            .planes
            .each_ref()
            .map(|plane| Half::of(plane, self.width));
        let [width, height] = [halves[0].width, halves[0].height];
        Self::from_planes(width, height, halves.map(|half| half.values))
    }

    /// The picture reduced to `width`×`height` px, at most its own size: each pixel is the mean of the area that it covers. Colours count by
    /// their opacity.
    #[must_use]
    pub fn reduced(&self, width: usize, height: usize) -> Self {
        let size = [self.width, self.height];
        let [width, height] = [width.clamp(1, size[0]), height.clamp(1, size[1])];
        let reduce = |plane: &[f32]| reduced(plane, size, [width, height]);
        let Some(alpha) = &self.alpha else {
            let planes = [0, 1, 2].map(|c| reduce(&self.planes[c]));
            return Self::from_planes(width, height, planes);
        };
        // The mean colour is Σ α·c / Σ α: a clear pixel has no colour to add. Weighing before and dividing after makes it two
        // plain means.
        let opacity = reduce(alpha);
        let planes = [0, 1, 2].map(|c| {
            let weighted: Vec<f32> = self.planes[c]
                .iter()
                .zip(alpha)
                .map(|(v, a)| v * a)
                .collect();
            let sums = reduce(&weighted).into_iter().zip(&opacity);
            sums.map(|(sum, &a)| {
                if a > 0.0 {
                    (sum / a).clamp(0.0, 1.0)
                } else {
                    0.0
                }
            })
            .collect()
        });
        Self {
            width,
            height,
            planes,
            alpha: Some(opacity),
        }
    }
}

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

/// The values of an old axis that a value of the new one covers, and the weights of the first and the last of them.
struct Span {
    covered: Range<usize>,
    weights: [f32; 2],
}

/// Spans of an axis of `old` values that the values of one of `new` values cover.
fn spans(old: usize, new: usize) -> Vec<Span> {
    // A new value covers `step` old ones: the first and the last in part, those between as a whole.
    let step = old as f64 / new as f64;
    let span = |i: usize| {
        let (from, to) = (i as f64 * step, (i + 1) as f64 * step);
        let first = (from as usize).min(old - 1);
        let end = (to.ceil() as usize).clamp(first + 1, old);
        // The last one may be the first, too, which then counts by its part within the span.
        let head = ((first + 1) as f64).min(to) - from;
        let tail = to - ((end - 1) as f64).max(from);
        Span {
            covered: first..end,
            weights: [head, tail].map(|share| (share / step) as f32),
        }
    };
    (0..new).map(span).collect()
}

impl Span {
    /// The mean of the values that `at` gives; `step` of them make one of the new axis.
    fn mean(&self, step: f32, at: impl Fn(usize) -> f32) -> f32 {
        let Range { start, end } = self.covered;
        let [head, tail] = self.weights;
        if end - start == 1 {
            // One old value alone is its own mean, to the bit. The weights would round.
            return at(start);
        }
        let middle: f32 = (start + 1..end - 1).map(&at).sum();
        head * at(start) + middle / step + tail * at(end - 1)
    }
}

fn reduced(plane: &[f32], [width, height]: [usize; 2], [columns, rows]: [usize; 2]) -> Vec<f32> {
    // The area of a pixel is a product of spans: means down the columns, then along the row of these means.
    let (across, down) = (spans(width, columns), spans(height, rows));
    let [step_x, step_y] = [width as f32 / columns as f32, height as f32 / rows as f32];
    let row = |span: &Span| {
        let column = |x: usize| span.mean(step_y, |y| plane[y * width + x]);
        let line: Vec<f32> = (0..width).map(column).collect();
        let pixels = across.iter().map(|span| span.mean(step_x, |x| line[x]));
        pixels.collect::<Vec<f32>>()
    };
    down.par_iter().flat_map_iter(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gradient(width: usize, height: usize) -> Image {
        Image::from_fn(width, height, 3, |x, y, c| {
            ((x + 2 * y + c) % 7) as f32 / 7.0
        })
        .unwrap()
    }

    fn mean(plane: &[f32]) -> f32 {
        plane.iter().sum::<f32>() / plane.len() as f32
    }

    #[test]
    fn a_reduction_keeps_the_mean() {
        let picture = gradient(30, 20);
        for (width, height) in [(15, 10), (7, 5), (29, 19), (1, 1), (30, 20)] {
            let reduced = picture.reduced(width, height);
            assert_eq!((reduced.width(), reduced.height()), (width, height));
            for c in 0..3 {
                let [old, new] = [&picture, &reduced].map(|image| mean(&image.planes()[c]));
                assert!((old - new).abs() < 1e-5, "{width}×{height}: {old} {new}");
            }
        }
    }

    #[test]
    fn two_by_two_pixels_become_their_mean() {
        let picture = gradient(8, 6);
        let halved = picture.halved();
        let reduced = picture.reduced(4, 3);
        for (a, b) in halved
            .planes()
            .iter()
            .flatten()
            .zip(reduced.planes().iter().flatten())
        {
            assert!((a - b).abs() < 1e-6);
        }
    }

    #[test]
    fn clear_pixels_lend_no_colour() {
        let planes = [vec![1.0, 0.0], vec![0.5, 0.0], vec![0.0, 1.0]];
        let picture = Image::new(2, 1, planes)
            .unwrap()
            .with_alpha(vec![1.0, 0.0])
            .unwrap();
        let reduced = picture.reduced(1, 1);
        assert_eq!(reduced.alpha(), Some(&[0.5][..]));
        assert_eq!(
            reduced.planes().each_ref().map(|plane| plane[0]),
            [1.0, 0.5, 0.0]
        );
    }
}
