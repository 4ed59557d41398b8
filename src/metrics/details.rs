//! Small things of a picture that a drawing may lose: thin lines, dots, letters.
//!
//! A thing is small if it is thinner than a window: opening and closing by the window remove what is brighter or darker than
//! its surroundings and does not hold the window (the *top-hat* of mathematical morphology: Serra, 1982). It is a detail
//! if there are few such things around; many of them are texture, which hides a loss.

use rayon::prelude::*;

use super::{average, extremes};
use crate::image::Image;
use crate::scene::Rgb;

/// Half the side of the window that a small thing does not hold, px.
const REACH: usize = 2;

/// Half the side of the window in which small things are counted, px.
const AROUND: usize = 16;

/// Least contrast of a thing that is seen.
pub(crate) const SEEN: f32 = 10.0 / 255.0;

/// Share of the window that is small things: up to the first they are details, from the second on texture. Lines of text have up
/// to 0.4. A guess.
const TEXTURE: [f32; 2] = [0.2, 0.45];

/// Least mean isolation of the small things of a picture that has details. Photographs have 0.01 to 0.26, a comic and text 0.55
/// and 0.63, maps and charts 0.9 and more.
const LEAST_ISOLATION: f64 = 0.4;

/// Error, in units of the contrast around, of a detail that is lost. Of a legible label 0 to 2 % of the pixels have more, of an
/// illegible one 7 %.
const WRONG: f32 = 0.35;

const WHITE: Rgb = [1.0; 3];

/// The details of a picture.
pub(crate) struct Details {
    /// The picture on white.
    planes: [Vec<f32>; 3],
    /// For each pixel in or beside a detail, its isolation (1 for a thing that stands alone, 0 for texture) and the largest
    /// contrast around.
    near: Vec<[f32; 2]>,
}

impl Details {
    /// The details of a picture, on white, that have more than a `least` contrast.
    pub(crate) fn of(picture: &Image, least: f32) -> Self {
        let width = picture.width();
        let planes = picture.on(WHITE).into_owned().into_planes();
        let contrasts = contrasts(&planes, width);
        // The share of small things around each pixel, and from that how far it stands alone.
        let is_thing = |contrast: &f32| f64::from(u8::from(*contrast > least));
        let mut shares: Vec<f64> = contrasts.iter().map(is_thing).collect();
        average(&mut shares, width, AROUND);
        let isolation = |(contrast, share): (&f32, &f64)| {
            // From 1 at `few` down to 0 at `many`, in a line.
            let [few, many] = TEXTURE;
            let isolation = ((many - *share as f32) / (many - few)).clamp(0.0, 1.0);
            if *contrast > least { isolation } else { 0.0 }
        };
        let mut isolations: Vec<f32> = contrasts.iter().zip(&shares).map(isolation).collect();
        // If hardly any detail stands alone, all of them are texture.
        let things: f64 = contrasts.iter().map(is_thing).sum();
        let isolated: f64 = isolations.iter().map(|v| f64::from(*v)).sum();
        if isolated < LEAST_ISOLATION * things {
            isolations.fill(0.0);
        }
        // A lost line also shows beside itself, where its antialiasing was: widen the details by a pixel.
        let isolations = extremes(&isolations, width, 1, f32::max);
        let strongest = extremes(&contrasts, width, REACH, f32::max);
        let near = isolations.into_iter().zip(strongest);
        Self {
            planes,
            near: near
                .map(|(isolation, contrast)| [isolation, contrast])
                .collect(),
        }
    }

    /// The share of the details that `drawn`, a picture of the same size, keeps; `None` if there are none.
    pub(crate) fn kept(&self, drawn: &Image) -> Option<f64> {
        let sum = |values: &mut dyn Iterator<Item = f32>| values.map(f64::from).sum::<f64>();
        let all = sum(&mut self.near.iter().map(|[isolation, _]| *isolation));
        let lost = sum(&mut self.losses(drawn).into_iter());
        (all > 0.0).then(|| 1.0 - lost / all)
    }

    /// True for each pixel at most `reach` rows and columns from a detail that `drawn`, a picture of the same size, has lost.
    pub(crate) fn near_losses(&self, drawn: &Image, reach: usize) -> Vec<bool> {
        let losses = self.losses(drawn);
        let near = extremes(&losses, drawn.width(), reach, f32::max);
        near.into_iter().map(|loss| loss > 0.0).collect()
    }

    /// The isolation of each pixel in or beside a lost detail, where the error of `drawn` exceeds a share of the contrast.
    pub(crate) fn losses(&self, drawn: &Image) -> Vec<f32> {
        let drawn = drawn.on(WHITE);
        let error = |i: usize| {
            let channels = self.planes.iter().zip(drawn.planes());
            channels
                .map(|(a, b)| (a[i] - b[i]).abs())
                .fold(0.0, f32::max)
        };
        let pixels = self.near.par_iter().enumerate();
        let loss = |(i, [isolation, contrast]): (usize, &[f32; 2])| {
            // The largest contrast around, and not the pixel's own, which is small on an antialiased border.
            let is_lost = *isolation > 0.0 && error(i) > WRONG * contrast;
            if is_lost { *isolation } else { 0.0 }
        };
        pixels.map(loss).collect()
    }
}

/// For each pixel, the largest contrast of a small thing there with its surroundings.
fn contrasts(planes: &[Vec<f32>; 3], width: usize) -> Vec<f32> {
    let of_plane = |plane: &Vec<f32>| {
        let least = |of: &[f32]| extremes(of, width, REACH, f32::min);
        let most = |of: &[f32]| extremes(of, width, REACH, f32::max);
        // Opening (least, then most) removes small bright things, closing (most, then least) small dark ones. The distance from
        // either is the contrast of the thing removed.
        let (opened, closed) = (most(&least(plane)), least(&most(plane)));
        let bounds = opened.into_iter().zip(closed);
        plane
            .iter()
            .zip(bounds)
            .map(|(v, (low, high))| (v - low).max(high - v))
            .collect::<Vec<_>>()
    };
    let [mut largest, others @ ..] = planes.each_ref().map(of_plane);
    for plane in others {
        largest
            .iter_mut()
            .zip(plane)
            .for_each(|(most, v)| *most = most.max(v));
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn details(picture: &Image) -> Details {
        Details::of(picture, SEEN)
    }

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
        // The columns beside it are white, as they should be.
        assert_eq!(details(&picture(line)).kept(&blank), Some(0.5));
        assert_eq!(details(&picture(wide)).kept(&blank), None);
    }

    #[test]
    fn what_is_faint_but_there_is_kept_and_half_of_a_line_is_half() {
        let line = |x: usize, _: usize| (40..42).contains(&x);
        let half = |x: usize, y: usize| line(x, y) && y < 48;
        let details = details(&picture(line));
        assert_eq!(details.kept(&picture(line)), Some(1.0));
        let faint = Image::from_fn(96, 96, 1, |x, y, _| if line(x, y) { 0.55_f32 } else { 1.0 });
        assert_eq!(details.kept(&faint.unwrap()), Some(1.0));
        // Two of the four columns in and beside the line are wrong.
        assert_eq!(details.kept(&picture(half)), Some(0.75));
    }

    #[test]
    fn a_blot_is_no_letter() {
        let bars = |x: usize, y: usize| (40..52).contains(&y) && [40, 43, 46].contains(&x);
        let blot = |x: usize, y: usize| (40..52).contains(&y) && (40..47).contains(&x);
        let kept = details(&picture(bars)).kept(&picture(blot)).unwrap();
        assert!(kept < 0.7, "{kept}");
    }

    #[test]
    fn texture_is_no_detail() {
        let checks = picture(|x, y| (x / 2 + y / 2) % 2 == 0);
        assert_eq!(details(&checks).kept(&picture(|_, _| false)), None);
    }
}
