//! SSIMULACRA2 2.1 (Sneyers 2022–2023): the difference of two pictures as people see it.
//!
//! Both pictures are compared in the XYB colour space of JPEG XL at six scales, each half as large as the one before,
//! halved in linear light. At each pixel there are three kinds of error: a change of *structure* (SSIM without
//! its luminance denominator), an *artefact* (an edge where the reference is smooth) and *lost* detail (the reverse). Of each
//! map the mean and the fourth norm, `(Σ e⁴ / n)^¼`, count with weights that were fitted to 17,611 ratings by people. The
//! weighted sum goes through a polynomial to a score: 90 lossless to the eye, 70 high, 50 medium, 30 low quality.
//!
//! Degenerate cases: equal pictures have 100, very bad ones less than 0. A picture with a side of less than 8 px is enlarged
//! by whole factors. The reference implementation shifts weights where a picture is too small for six scales
//! (a side of less than 113 px); so does this one, so that scores are the same.

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

use super::window::Moments;
use crate::image::{Image, level};
use crate::math;
use crate::scene::linear_light;

const SCALES: usize = 6;
/// The least side that has one more scale, px.
const MIN_SIDE: usize = 8;
/// Half of the window: the recursive Gaussian of σ = 1.5 px (Charalampidis 2016) has these taps. Beyond the border all is 0.
const TAPS: [f32; 5] = [
    0.264_621_1,
    0.212_928_6,
    0.109_335_37,
    0.036_011_115,
    0.009_414_368,
];
/// Keeps the structure term stable where there is no variance.
const C2: f32 = 0.0009;
/// Added to all cone responses, so that the cube root has a slope at black.
const OPSIN_BIAS: f32 = 0.003_793_073_4;
/// Linear RGB to cone responses (long, medium, short).
const OPSIN: [[f32; 3]; 3] = [
    [0.30, 0.622, 0.078],
    [0.23, 0.692, 0.078],
    [0.243_422_69, 0.204_767_45, 0.551_809_86],
];

/// Kinds of error at a pixel.
const KINDS: usize = 3;
/// Mean and fourth norm of a map.
const NORMS: usize = 2;
/// By kind of error and norm.
type Norms = [[f64; NORMS]; KINDS];

/// The weights of the reference implementation, to seven digits: by channel (X, Y, B − Y), scale (finest first), norm (mean, fourth) and kind of error (structure, artefact, lost).
const WEIGHTS: [[[[f64; 3]; 2]; 6]; 3] = [
    [
        [[0.0, 0.0007376607, 0.0], [0.0, 0.0007793482, 0.0]],
        [
            [0.0, 0.0004371156, 0.0],
            [1.104173, 0.0006628483, 0.0001523163],
        ],
        [[0.0, 0.001640644, 0.0], [1.842246, 11.44117, 0.0]],
        [[0.0007989109, 0.0001768164, 0.0], [1.878759, 10.94907, 0.0]],
        [
            [0.0007289347, 0.9677937, 0.0],
            [0.0001400342, 0.9981767, 0.0003194976],
        ],
        [[0.0004550992, 0.0, 0.0], [0.001364877, 0.0, 0.0]],
    ],
    [
        [[0.0, 0.0, 0.0], [7.46689, 0.0, 17.44583]],
        [[0.0006235602, 0.0, 0.0], [6.683678, 0.0003772441, 1.02789]],
        [[225.2052, 0.0, 0.0], [19.21324, 0.001140152, 0.001237756]],
        [[176.3932, 0.0, 0.0], [24.43301, 0.285208, 0.0004485437]],
        [[0.0, 0.0, 0.0], [34.77906, 44.83563, 0.0]],
        [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
    ],
    [
        [[0.0, 0.0008680557, 0.0], [0.0, 0.0, 0.0]],
        [[0.0, 0.0005313192, 0.0], [0.0001653381, 0.0, 0.0]],
        [[0.0, 0.0, 0.0], [0.0004179172, 0.001729083, 0.0]],
        [[0.002082701, 0.0, 0.0], [8.826983, 23.19243, 0.0]],
        [
            [95.10805, 0.9863978, 0.9834383],
            [0.001228641, 171.2667, 0.9807859],
        ],
        [[0.0, 0.0, 0.0], [0.0005130065, 0.0, 0.0001085406]],
    ],
];

/// The score of `picture` against `reference`, of one size.
pub(super) fn score(reference: &Image, picture: &Image) -> f64 {
    let norms: Vec<_> = Scales::new(reference, picture)
        .map(|scale| scale.norms())
        .collect();
    // Scales come one after another, and only the norms of each remain: two pictures in memory, not twelve.
    let weighted = weighted(norms.len()).map(|(weight, [c, s, n, k])| weight * norms[s][c][k][n]);
    of_sum(weighted.sum())
}

/// Scores that the picture would have if all of it were as bad as it is at each pixel, row by row.
///
/// The weighted sum that makes the score is a sum over pixels: a mean is, and a fourth norm is shared out by `e⁴`.
pub(super) fn map(reference: &Image, picture: &Image) -> Vec<f32> {
    let sums = sums(reference, picture);
    sums.iter().map(|&sum| of_sum(sum) as f32).collect()
}

/// The weighted errors at each pixel, whose mean makes the score.
fn sums(reference: &Image, picture: &Image) -> Vec<f64> {
    let (width, height) = (reference.width(), reference.height());
    // The number of scales shifts the weights, so it has to be known before the first scale is weighed.
    let count = Scales::new(reference, picture).count();
    let factor = enlargement(width, height);
    let mut sums = vec![0.0; width * height];
    for (s, scale) in Scales::new(reference, picture).enumerate() {
        let share = scale.shares(s, count);
        // Each pixel of a scale stands for a square of the picture.
        for (i, sum) in sums.iter_mut().enumerate() {
            let [x, y] = [i % width, i / width].map(|at| (at * factor) >> s);
            *sum += share[y * scale.width + x];
        }
    }
    sums
}

/// The score of a weighted sum of errors: a fitted polynomial, then a fitted power.
fn of_sum(sum: f64) -> f64 {
    let x = sum * 0.956_238_261_683_484_4;
    // All constants come from the reference implementation.
    let y = ((6.248_496_625_763_138e-5 * x - 0.020_884_521_182_843_837) * x
        + 2.326_765_642_916_932)
        * x;
    if y > 0.0 {
        100.0 - 10.0 * math::powf(y, 0.627_633_646_783_138_7)
    } else {
        100.0
    }
}

/// The weights that are not 0 of a picture with `scales` scales: each with its channel, scale, norm and kind of error.
fn weighted(scales: usize) -> impl Iterator<Item = (f64, [usize; 4])> {
    let places = (0..3).flat_map(move |c| {
        (0..scales)
            .flat_map(move |s| (0..NORMS).flat_map(move |n| (0..KINDS).map(move |k| [c, s, n, k])))
    });
    // Weights are taken in one run. With fewer scales the run ends early and later channels get weights of earlier ones: the
    // reference's behaviour, kept so that scores agree.
    let weights = WEIGHTS.as_flattened().as_flattened().as_flattened();
    let all = weights.iter().copied().zip(places);
    all.filter(|(weight, _)| *weight > 0.0)
}

/// By which factor a picture is enlarged, so that it has a scale.
fn enlargement(width: usize, height: usize) -> usize {
    MIN_SIDE.div_ceil(width.min(height).min(MIN_SIDE))
}

/// Both pictures in linear light.
struct Scales {
    width: usize,
    height: usize,
    linear: [Vec<[f32; 3]>; 2],
    done: usize,
}

impl Scales {
    fn new(reference: &Image, picture: &Image) -> Self {
        let (width, height) = (reference.width(), reference.height());
        let factor = enlargement(width, height);
        // There are 256 levels: a table replaces a power per sample.
        let linear: Vec<f32> = (0..=u8::MAX).map(linear_light).collect();
        let enlarged = |picture: &Image| -> Vec<[f32; 3]> {
            let size = [width * factor, height * factor];
            let at = |i: usize| i / size[0] / factor * width + i % size[0] / factor;
            let light = |value: f32| linear[usize::from(level(value))];
            let places = (0..size[0] * size[1]).into_par_iter();
            let pixel = |i: usize| {
                let i = at(i);
                [0, 1, 2].map(|c| light(picture.planes()[c][i]))
            };
            places.map(pixel).collect()
        };
        Self {
            width: width * factor,
            height: height * factor,
            linear: [enlarged(reference), enlarged(picture)],
            done: 0,
        }
    }

    /// Halves both pictures. The last row and column of an odd side count twice.
    fn halve(&mut self) {
        let (width, height) = (self.width, self.height);
        let [columns, rows] = [width.div_ceil(2), height.div_ceil(2)];
        for plane in &mut self.linear {
            let halved = (0..columns * rows).into_par_iter().map(|i| {
                let [x, y] = [2 * (i % columns), 2 * (i / columns)];
                let [right, below] = [(x + 1).min(width - 1), (y + 1).min(height - 1)];
                let four = [(x, y), (right, y), (x, below), (right, below)];
                let four = four.map(|(x, y)| plane[y * width + x]);
                [0, 1, 2].map(|c| four.iter().map(|pixel| pixel[c]).sum::<f32>() / 4.0)
            });
            *plane = halved.collect();
        }
        (self.width, self.height) = (columns, rows);
    }
}

impl Iterator for Scales {
    type Item = Scale;

    fn next(&mut self) -> Option<Scale> {
        if self.done == SCALES || self.width.min(self.height) < MIN_SIDE {
            return None;
        }
        if self.done > 0 {
            self.halve();
        }
        self.done += 1;
        let pair = [0, 1].map(|i| xyb(&self.linear[i]));
        Some(Scale {
            width: self.width,
            height: self.height,
            pair,
        })
    }
}

/// Planes X, Y and B − Y, shifted and scaled to about 0..1.
fn xyb(linear: &[[f32; 3]]) -> [Vec<f32>; 3] {
    let black = math::cbrt(OPSIN_BIAS);
    let mut planes = [0, 1, 2].map(|_| vec![0.0; linear.len()]);
    let [x, y, b] = planes.each_mut().map(|plane| plane.par_chunks_mut(CHUNK));
    let chunks = x.zip(y).zip(b).zip(linear.par_chunks(CHUNK));
    chunks.for_each(|(((x, y), b), linear)| {
        for (i, rgb) in linear.iter().enumerate() {
            [x[i], y[i], b[i]] = xyb_of(rgb, black);
        }
    });
    planes
}

/// Pixels that a thread converts at a time.
const CHUNK: usize = 1 << 14;

#[inline(always)]
fn xyb_of(rgb: &[f32; 3], black: f32) -> [f32; 3] {
    let cone = |[r, g, b]: [f32; 3]| {
        let response = r * rgb[0] + g * rgb[1] + b * rgb[2];
        math::cbrt(response + OPSIN_BIAS) - black
    };
    let [long, medium, short] = [cone(OPSIN[0]), cone(OPSIN[1]), cone(OPSIN[2])];
    let (x, y) = (0.5 * (long - medium), 0.5 * (long + medium));
    // X is small and may be negative: these shifts and factors bring all three planes to about 0..1.
    [14.0 * x + 0.42, y + 0.01, short - y + 0.55]
}

/// Both pictures at one scale, reference first.
struct Scale {
    width: usize,
    height: usize,
    pair: [[Vec<f32>; 3]; 2],
}

impl Scale {
    /// The norms of all maps, by channel.
    fn norms(&self) -> [Norms; 3] {
        [0, 1, 2].map(|channel| {
            let sums: Vec<Norms> = self.rows(channel, |errors| {
                [0, 1, 2].map(|k| {
                    let errors = || errors.iter().map(|e| f64::from(e[k]));
                    [errors().sum(), errors().map(|e| math::powi(e, 4)).sum()]
                })
            });
            let pixels = (self.width * self.height) as f64;
            [0, 1, 2].map(|k| {
                let mean = |n: usize| sums.iter().map(|row| row[k][n]).sum::<f64>() / pixels;
                // (Σ e⁴ / n)^¼ by two exact square roots.
                [mean(0), mean(1).sqrt().sqrt()]
            })
        })
    }

    /// The weighted errors at each pixel, as scale `index` of `count`; their mean is the share of this scale in the sum.
    fn shares(&self, index: usize, count: usize) -> Vec<f64> {
        let norms = self.norms();
        let mut shares = vec![0.0; self.width * self.height];
        for (channel, norms) in norms.iter().enumerate() {
            let here = weighted(count).filter(|(_, [c, s, ..])| [*c, *s] == [channel, index]);
            // Factors of an error and of its fourth power.
            let mut factors: Norms = [[0.0; NORMS]; KINDS];
            for (weight, [_, _, n, k]) in here {
                let norm = norms[k][1];
                factors[k][n] = match n {
                    0 => weight,
                    // norm = mean(e⁴)/norm³, so a pixel's part of the norm is e⁴/norm³.
                    _ if norm > 0.0 => weight / math::powi(norm, 3),
                    _ => 0.0,
                };
            }
            let rows = self.rows(channel, |errors| {
                let of = |pixel: &[f32; KINDS]| -> f64 {
                    let terms = pixel.iter().zip(&factors);
                    terms
                        .map(|(&e, factor)| (f64::from(e), factor))
                        .map(|(e, [mean, fourth])| mean * e + fourth * math::powi(e, 4))
                        .sum()
                };
                errors.iter().map(of).collect::<Vec<f64>>()
            });
            for (share, own) in shares.iter_mut().zip(rows.iter().flatten()) {
                *share += own;
            }
        }
        shares
    }

    /// Results of `f` for the errors of each row of a channel.
    fn rows<R: Send>(&self, channel: usize, f: impl Fn(&[[f32; KINDS]]) -> R + Sync) -> Vec<R> {
        let rows = (0..self.height).into_par_iter();
        rows.map_init(
            || {
                let errors = vec![[0.0; KINDS]; self.width];
                (Moments::new(&TAPS, self.width), errors)
            },
            |(moments, errors), y| {
                let [a, b] = [0, 1].map(|i| &*self.pair[i][channel]);
                dispatch!(Level::new(), _simd => measure(moments, errors, [a, b], y));
                f(errors)
            },
        )
        .collect()
    }
}

/// Finds the errors of row `y` of the reference and the picture, with the instructions of the caller.
#[inline(always)]
fn measure(moments: &mut Moments<'_>, errors: &mut [[f32; KINDS]], [a, b]: [&[f32]; 2], y: usize) {
    let start = y * errors.len();
    let [mean_a, mean_b, aa, bb, ab] = moments.of_row(a, b, y);
    for (x, errors) in errors.iter_mut().enumerate() {
        let here = [a[start + x], b[start + x]];
        *errors = errors_at(here, [mean_a[x], mean_b[x], aa[x], bb[x], ab[x]]);
    }
}

/// Structure, artefact and lost detail at a pixel: its values in both pictures, and the blurred values, squares and product.
#[inline(always)]
fn errors_at([a, b]: [f32; 2], [mean_a, mean_b, aa, bb, ab]: [f32; 5]) -> [f32; KINDS] {
    // The luminance ratio of SSIM is 1 − (μa − μb)²/(μa² + μb² + C). Its denominator is left out: XYB is perceptually uniform.
    let luminance = 1.0 - (mean_a - mean_b) * (mean_a - mean_b);
    let covariance = 2.0 * (ab - mean_a * mean_b) + C2;
    let variances = (aa - mean_a * mean_a) + (bb - mean_b * mean_b) + C2;
    let structure = (1.0 - luminance * covariance / variances).max(0.0);
    // More deviation from the local mean than in the reference is an artefact, less is lost detail.
    let change = (1.0 + (b - mean_b).abs()) / (1.0 + (a - mean_a).abs()) - 1.0;
    [structure, change.max(0.0), (-change).max(0.0)]
}

#[cfg(test)]
mod tests {
    use super::super::tests::noise;
    use super::super::{ssimulacra2, ssimulacra2_map};
    use super::*;

    /// Values of a wave and a ramp, with `error` added by a coarser wave.
    fn wave(width: usize, height: usize, error: f32) -> Image {
        let plane = |phase: f32| -> Vec<f32> {
            let at = |i: usize| [(i % width) as f32, (i / width) as f32];
            let value = |[x, y]: [f32; 2]| {
                let fine = math::sin(0.3 * x + phase) * math::cos(0.23 * y);
                let coarse = math::sin(0.11 * (x + y) + phase);
                let ramp = (x + y) / (width + height) as f32;
                ((0.35 * ramp + 0.15 * fine + 0.3 + error * coarse) * 255.0).round() / 255.0
            };
            (0..width * height).map(|i| value(at(i))).collect()
        };
        Image::new(width, height, [plane(0.0), plane(1.0), plane(2.0)]).unwrap()
    }

    /// Width, height, error and score, by the crate ssimulacra2 0.5.1.
    const REFERENCE: [(usize, usize, f32, f64); 5] = [
        (300, 200, 0.02, 42.8914),
        (300, 200, 0.1, -64.2384),
        (127, 131, 0.05, -8.6578),
        (40, 30, 0.03, 75.5958),
        (9, 64, 0.05, 93.5843),
    ];

    #[test]
    fn scores_are_those_of_another_implementation() {
        for (width, height, error, expected) in REFERENCE {
            let (a, b) = (wave(width, height, 0.0), wave(width, height, error));
            let score = ssimulacra2(&a, &b).unwrap();
            assert!(
                (score - expected).abs() < 0.05,
                "{width}×{height}, {error}: {score}, not {expected}"
            );
        }
    }

    #[test]
    fn equal_pictures_have_100_at_every_size() {
        for (width, height) in [(1, 1), (3, 40), (8, 8), (113, 20), (300, 130)] {
            let a = noise(width, height, 1);
            assert_eq!(ssimulacra2(&a, &a).unwrap(), 100.0, "{width}×{height}");
        }
    }

    #[test]
    fn a_map_is_worst_where_pictures_differ() {
        let (a, mut planes) = (wave(200, 120, 0.0), wave(200, 120, 0.0).into_planes());
        let spot = |i: usize| (140..160).contains(&(i % 200)) && (40..60).contains(&(i / 200));
        for plane in &mut planes {
            let changed = plane.iter_mut().enumerate().filter(|(i, _)| spot(*i));
            changed.for_each(|(_, v)| *v = 1.0 - *v);
        }
        let b = Image::new(200, 120, planes).unwrap();
        let map = ssimulacra2_map(&a, &b).unwrap();
        let mean = |inside: bool| {
            let chosen = (0..map.len()).filter(|&i| spot(i) == inside);
            let values: Vec<f32> = chosen.map(|i| map[i]).collect();
            values.iter().sum::<f32>() / values.len() as f32
        };
        assert!(
            mean(true) < 0.0 && mean(false) > 60.0,
            "{} {}",
            mean(true),
            mean(false)
        );
    }

    #[test]
    fn the_score_is_that_of_the_mean_of_all_pixels() {
        let (a, b) = (wave(256, 128, 0.0), wave(256, 128, 0.1));
        let sums = sums(&a, &b);
        let mean = sums.iter().sum::<f64>() / sums.len() as f64;
        let (shared_out, whole) = (of_sum(mean), score(&a, &b));
        assert!((shared_out - whole).abs() < 1e-6, "{shared_out} {whole}");
    }
}
