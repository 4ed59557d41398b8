//! Reduction of a picture to the pixels that its drawing needs.
//!
//! A picture may be larger than its detail: it was enlarged, or is out of focus. Then fewer pixels say the same. And a
//! photograph of many pixels has more detail than the strokes of its drawing can show. The fit takes the reduced picture for its
//! target; the file has the size of the picture.

use rayon::prelude::*;

use crate::fit::config::{Budget, Config, SCREEN_PIXELS};
use crate::image::Image;
use crate::metrics::{self, psnr_db};

// `docs/accuracy.md` has the measurements.
/// Pixels that a drawing of as many strokes as pay needs: twice the pixels of the screen that it is made for.
const ENOUGH_PIXELS: usize = 2 * SCREEN_PIXELS;
/// Fewest pixels that a picture is reduced to, however little detail it has: the price of strokes is that of a screen.
const LEAST_PIXELS: usize = SCREEN_PIXELS;
/// Pixels that a stroke needs, where their number is given: a dozen for each of its points, and more for their places.
const PIXELS_PER_STROKE: usize = 200;
/// Bytes of a stroke, about.
const BYTES_PER_STROKE: usize = 70;
/// Fidelity of a picture that was halved and enlarged again, dB, from which on its half is as good. Strokes end far below.
const SAME_DB: f64 = 44.0;
/// Such a fidelity of lines and sharp edges, whose places half as many pixels tell as well.
const NEARLY_SAME_DB: f64 = 36.0;
/// Share of pixels whose neighbours have their colour: flat art and drawings of lines have more, photographs mostly less.
const FLAT_SHARE: f64 = 0.6;
/// Largest difference of neighbours of one colour.
const ONE_COLOR: f32 = 4.0 / 255.0;
/// Largest share of the detail within 9 px that is finer than 2 px in a picture that was enlarged twice: such ones have 0.07 to 0.09,
/// others 0.16 and more.
const SOFT: f64 = 0.12;
/// Smaller pictures, px, are not reduced because they are soft. A guess.
const LEAST_SOFT_SIDE: usize = 200;
/// A reduction by less than this along each side is not worth it.
const LEAST_FACTOR: f64 = 1.4;

/// Width and height to which `picture` is reduced before it is drawn by `config`; `None` if all of its pixels count.
pub(in crate::fit) fn size(picture: &Image, config: &Config) -> Option<[usize; 2]> {
    let all = pixels(picture);
    let counted = counted(config);
    let enough = counted.max(ENOUGH_PIXELS);
    // Pens given in px are in px of the picture, not of a reduced one.
    if config.pens.is_some() {
        return None;
    }
    // 1. An enlarged picture of few pixels: its half has all of its detail.
    if is_soft(picture, config) && all / 4 >= counted {
        return Some([picture.width().div_ceil(2), picture.height().div_ceil(2)]);
    }
    // 2. A picture of about enough pixels stays as it is.
    if all as f64 <= enough as f64 * LEAST_FACTOR * LEAST_FACTOR {
        return None;
    }
    // 3. Halve as long as nothing is lost that the drawing could show. The last factor may be a fraction, which ends at `enough`.
    let mut factor = 1.0;
    let mut reduced = None;
    loop {
        let now = reduced.as_ref().unwrap_or(picture);
        let half = now.reduced(now.width().div_ceil(2), now.height().div_ceil(2));
        // How much of the detail the half has is measured by enlarging it again.
        let loss_db = psnr_db(mse_enlarged(&half, now));
        if is_same(loss_db, config) && pixels(&half) >= counted.max(LEAST_PIXELS) {
            factor *= 2.0;
        } else if pixels(now) > enough && shows_no_more(loss_db, now, config) {
            factor = f64::min(2.0 * factor, (all as f64 / enough as f64).sqrt());
        } else {
            break;
        }
        reduced = Some(half);
    }
    let side = |px: usize| ((px as f64 / factor).round() as usize).max(1);
    (factor >= LEAST_FACTOR).then(|| [side(picture.width()), side(picture.height())])
}

fn pixels(picture: &Image) -> usize {
    picture.width() * picture.height()
}

/// Pixels that the strokes need that `config` counts; 0 if it counts none.
fn counted(config: &Config) -> usize {
    let Budget { strokes, bytes, .. } = config.budget;
    let by_bytes = bytes.map(|bytes| bytes / BYTES_PER_STROKE);
    let strokes = strokes.into_iter().chain(by_bytes).min();
    strokes.map_or(0, |count| count.saturating_mul(PIXELS_PER_STROKE))
}

/// True if a picture has no detail that its half lacks, from which it can be enlarged again to `loss_db`.
fn is_same(loss_db: f64, config: &Config) -> bool {
    loss_db >= SAME_DB.max(config.budget.psnr_db.unwrap_or(0.0) + 10.0)
}

/// True if strokes show no more of `picture` than of its half, from which it can be enlarged again to `loss_db`.
fn shows_no_more(loss_db: f64, picture: &Image, config: &Config) -> bool {
    // A given fidelity or quality covers everything in the picture.
    let is_for_screen = config.budget.psnr_db.is_none() && config.quality.is_none();
    let is_photograph = || !is_flat(picture);
    is_for_screen && (loss_db >= NEARLY_SAME_DB || is_photograph())
}

/// True if a picture of few pixels is soft, as one that was enlarged is, so that its half has all of its detail.
fn is_soft(picture: &Image, config: &Config) -> bool {
    // A larger one is reduced to the pixels of a screen, and no further.
    let is_small = pixels(picture) <= ENOUGH_PIXELS;
    let least = picture.width().min(picture.height());
    is_small
        && config.budget.psnr_db.is_none()
        && least >= LEAST_SOFT_SIDE
        && metrics::fine_share(picture).is_some_and(|share| share < SOFT)
}

/// True if `picture` is flat art or a drawing of lines.
pub(in crate::fit) fn is_flat(picture: &Image) -> bool {
    flat_share(picture) >= FLAT_SHARE
}

/// The mean squared error of `half`, enlarged linearly, against `picture`.
fn mse_enlarged(half: &Image, picture: &Image) -> f64 {
    let [width, height] = [picture.width(), picture.height()];
    let [columns, rows] = [half.width(), half.height()];
    // The pixels of the half beside a place between them, and the share of the second.
    let beside = |at: usize, old: usize, new: usize| {
        // Centres of pixels are at halves: pixel `at` of the large row is at this place of the small one.
        let place = (at as f32 + 0.5) * new as f32 / old as f32 - 0.5;
        let first = (place.max(0.0) as usize).min(new - 1);
        (
            first,
            (first + 1).min(new - 1),
            (place - first as f32).clamp(0.0, 1.0),
        )
    };
    let across: Vec<_> = (0..width).map(|x| beside(x, width, columns)).collect();
    let of_plane = |(small, large): (&Vec<f32>, &Vec<f32>)| {
        let of_row = |(y, line): (usize, &[f32])| {
            let (top, bottom, share) = beside(y, height, rows);
            let at = |x: usize| {
                let [top, bottom] = [top, bottom].map(|row| small[row * columns + x]);
                top + share * (bottom - top)
            };
            let errors = line
                .iter()
                .zip(&across)
                .map(|(value, &(left, right, share))| {
                    let (left, right) = (at(left), at(right));
                    let error = value - (left + share * (right - left));
                    f64::from(error * error)
                });
            errors.sum::<f64>()
        };
        // Summed in the order of the rows, so that the number of threads does not matter.
        let sums: Vec<f64> = large.par_chunks(width).enumerate().map(of_row).collect();
        sums.iter().sum::<f64>()
    };
    let planes = half.planes().iter().zip(picture.planes());
    planes.map(of_plane).sum::<f64>() / (3 * width * height) as f64
}

/// Share of the pixels that have the colour of the pixels to the right and below.
fn flat_share(picture: &Image) -> f64 {
    let width = picture.width();
    let count = pixels(picture);
    let is_flat = |&i: &usize| {
        let is_near = |plane: &Vec<f32>, k: usize| (plane[i] - plane[k]).abs() <= ONE_COLOR;
        let others = [i + 1, i + width].map(|k| k.min(count - 1));
        picture
            .planes()
            .iter()
            .all(|plane| others.iter().all(|&k| is_near(plane, k)))
    };
    let flat = (0..count).filter(is_flat).count();
    flat as f64 / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;

    /// A picture of 1,600×1,200 px whose detail is `period` px wide.
    fn waves(period: f32) -> Image {
        let wave = |at: usize| math::sin(at as f32 * std::f32::consts::TAU / period);
        Image::from_fn(1600, 1200, 3, |x, y, _| {
            0.5 + 0.2 * wave(x) * wave(y + x / 3)
        })
        .unwrap()
    }

    /// Thin black lines on white.
    fn lines() -> Image {
        Image::from_fn(1600, 1200, 1, |x, y, _| {
            f32::from(u8::from((x + y) % 40 > 1))
        })
        .unwrap()
    }

    fn with(budget: Budget) -> Config {
        Config {
            budget,
            ..Config::default()
        }
    }

    #[test]
    fn what_was_enlarged_is_reduced_whatever_is_asked_for() {
        let psnr = Budget {
            psnr_db: Some(34.0),
            ..Budget::default()
        };
        for budget in [Budget::default(), psnr] {
            assert_eq!(size(&waves(90.0), &with(budget)), Some([800, 600]));
        }
    }

    #[test]
    fn detail_is_kept_where_a_fidelity_is_asked_for() {
        let psnr = Budget {
            psnr_db: Some(34.0),
            ..Budget::default()
        };
        assert_eq!(size(&waves(5.0), &with(psnr)), None);
        assert!(
            size(&waves(5.0), &Config::default()).is_some(),
            "a screen does not show it"
        );
    }

    #[test]
    fn many_strokes_keep_their_pixels() {
        let strokes = Budget {
            strokes: Some(20_000),
            ..Budget::default()
        };
        assert_eq!(size(&waves(90.0), &with(strokes)), None);
    }

    #[test]
    fn lines_are_kept() {
        assert_eq!(size(&lines(), &Config::default()), None);
    }
}
