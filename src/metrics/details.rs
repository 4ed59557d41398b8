//! Small things of a picture that a drawing may lose: thin lines, dots, letters.
//!
//! A thing is small if it is thinner than a window: opening and closing by the window remove what is brighter or darker than
//! its surroundings and does not hold the window (the *top-hat* of mathematical morphology: Serra, 1982). It is a detail
//! if there are few such things around; many of them are texture, which hides what is missing.

use rayon::prelude::*;

use super::average;
use crate::image::Image;
use crate::scene::Rgb;

/// Half the side of the window that a small thing does not hold, px.
const REACH: usize = 2;

/// Half the side of the window in which small things are counted, px.
const AROUND: usize = 16;

/// Least contrast of a thing that is seen.
const LEAST: f32 = 10.0 / 255.0;

/// Share of the window that is small things: up to the first they are details, from the second on texture. Lines of text have up
/// to 0.4. A guess.
const TEXTURE: [f32; 2] = [0.2, 0.45];

const WHITE: Rgb = [1.0; 3];

/// The details of a picture.
pub(crate) struct Details {
    width: usize,
    pixels: Vec<Detail>,
}

/// What is small at a pixel.
#[derive(Debug, Clone, Copy)]
struct Detail {
    /// The largest contrast of a channel, 0..1.
    contrast: f32,
    /// Which channel that is, and whether the thing is brighter than its surroundings.
    channel: usize,
    is_bright: bool,
    /// 1 for what stands alone, 0 for texture.
    isolation: f32,
}

impl Details {
    /// The details of a picture, on white.
    pub(crate) fn of(picture: &Image) -> Self {
        let width = picture.width();
        let contrasts = contrasts(picture);
        let mut pixels: Vec<Detail> = (0..contrasts[0][0].len())
            .into_par_iter()
            .map(|i| {
                let all = (0..3).flat_map(|channel| [(channel, false), (channel, true)]);
                let contrast = |&(channel, is_bright): &(usize, bool)| {
                    contrasts[channel][usize::from(is_bright)][i]
                };
                let strongest = all.max_by(|a, b| contrast(a).total_cmp(&contrast(b)));
                let (channel, is_bright) = strongest.unwrap_or((0, false));
                Detail {
                    contrast: contrast(&(channel, is_bright)),
                    channel,
                    is_bright,
                    isolation: 0.0,
                }
            })
            .collect();
        let is_small = |detail: &Detail| f64::from(u8::from(detail.contrast > LEAST));
        let mut shares: Vec<f64> = pixels.iter().map(is_small).collect();
        average(&mut shares, width, AROUND);
        for (detail, share) in pixels.iter_mut().zip(shares) {
            let [few, many] = TEXTURE;
            detail.isolation = ((many - share as f32) / (many - few)).clamp(0.0, 1.0);
        }
        Self { width, pixels }
    }

    /// The share of the details that `drawn`, a picture of the same size, shows with half of their contrast or more; `None` if
    /// there are none.
    pub(crate) fn kept(&self, drawn: &Image) -> Option<f64> {
        let contrasts = contrasts(drawn);
        let [mut all, mut kept] = [0.0; 2];
        for (i, detail) in self.pixels.iter().enumerate().filter(|(_, d)| d.is_one()) {
            let shown = contrasts[detail.channel][usize::from(detail.is_bright)][i];
            all += f64::from(detail.isolation);
            if shown >= detail.contrast / 2.0 {
                kept += f64::from(detail.isolation);
            }
        }
        (all > 0.0).then(|| kept / all)
    }

    /// By how much an error at each pixel counts more than elsewhere: in and beside details, the more the fainter these are, since
    /// an error is seen relative to them.
    pub(crate) fn weights(&self, gain: f32, contrast: f32, most: f32) -> Vec<f32> {
        let faintness = |detail: &Detail| {
            if detail.is_one() {
                detail.isolation * (contrast / detail.contrast).clamp(1.0, most)
            } else {
                0.0
            }
        };
        let own: Vec<f32> = self.pixels.iter().map(faintness).collect();
        let around = extremes(&own, self.width, 1, f32::max);
        around.iter().map(|weight| 1.0 + gain * weight).collect()
    }
}

impl Detail {
    fn is_one(&self) -> bool {
        self.contrast > LEAST && self.isolation > 0.0
    }
}

/// The contrasts of what is darker and of what is brighter than its surroundings, of each channel and pixel.
fn contrasts(picture: &Image) -> [[Vec<f32>; 2]; 3] {
    let on_white = picture.on(WHITE);
    let width = on_white.width();
    on_white.planes().each_ref().map(|plane| {
        let filter = |of: &[f32], pick| extremes(of, width, REACH, pick);
        let opened = filter(&filter(plane, f32::min), f32::max);
        let closed = filter(&filter(plane, f32::max), f32::min);
        let dark = closed.iter().zip(plane).map(|(closed, v)| closed - v);
        let bright = plane.iter().zip(&opened).map(|(v, opened)| v - opened);
        [dark.collect(), bright.collect()]
    })
}

/// The extreme value of the window of 2`reach` + 1 rows and columns around each pixel, as far as that is in the picture.
fn extremes(values: &[f32], width: usize, reach: usize, pick: fn(f32, f32) -> f32) -> Vec<f32> {
    let height = values.len() / width;
    let mut across = vec![0.0; values.len()];
    across
        .par_chunks_exact_mut(width)
        .zip(values.par_chunks_exact(width))
        .for_each(|(out, row)| {
            for (x, value) in out.iter_mut().enumerate() {
                let near = &row[x.saturating_sub(reach)..(x + reach + 1).min(width)];
                *value = near.iter().copied().fold(row[x], pick);
            }
        });
    let mut out = vec![0.0; values.len()];
    out.par_chunks_exact_mut(width)
        .enumerate()
        .for_each(|(y, out)| {
            out.copy_from_slice(&across[y * width..(y + 1) * width]);
            for row in y.saturating_sub(reach)..(y + reach + 1).min(height) {
                let row = &across[row * width..(row + 1) * width];
                out.iter_mut()
                    .zip(row)
                    .for_each(|(value, other)| *value = pick(*value, *other));
            }
        });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White, with dark pixels where `is_dark` says.
    fn picture(is_dark: impl Fn(usize, usize) -> bool) -> Image {
        Image::from_fn(
            96,
            96,
            1,
            |x, y, _| if is_dark(x, y) { 0.4_f32 } else { 1.0 },
        )
        .unwrap()
    }

    #[test]
    fn a_thin_line_is_a_detail_and_a_wide_one_is_none() {
        let line = |x: usize, _: usize| (40..42).contains(&x);
        let wide = |x: usize, _: usize| (40..52).contains(&x);
        let blank = picture(|_, _| false);
        assert_eq!(Details::of(&picture(line)).kept(&blank), Some(0.0));
        assert_eq!(Details::of(&picture(wide)).kept(&blank), None);
    }

    #[test]
    fn what_is_faint_but_there_is_kept_and_half_of_a_line_is_half() {
        let line = |x: usize, _: usize| (40..42).contains(&x);
        let half = |x: usize, y: usize| line(x, y) && y < 48;
        let details = Details::of(&picture(line));
        assert_eq!(details.kept(&picture(line)), Some(1.0));
        assert_eq!(details.kept(&picture(half)), Some(0.5));
    }

    #[test]
    fn texture_is_no_detail() {
        let checks = picture(|x, y| (x / 2 + y / 2) % 2 == 0);
        assert_eq!(Details::of(&checks).kept(&picture(|_, _| false)), None);
    }

    #[test]
    fn an_error_counts_more_beside_faint_things() {
        let weight = |value: f32| {
            let plane: Vec<f32> = (0..64 * 64)
                .map(|i| if i % 64 == 30 { value } else { 1.0 })
                .collect();
            let picture = Image::new(64, 64, [plane.clone(), plane.clone(), plane]).unwrap();
            let weights = Details::of(&picture).weights(2.0, 0.4, 3.0);
            [weights[32 * 64 + 31], weights[32 * 64 + 5]]
        };
        assert_eq!(weight(0.2), [3.0, 1.0]);
        assert_eq!(weight(0.8)[1], 1.0);
        assert!((weight(0.8)[0] - 5.0).abs() < 1e-4);
    }
}
