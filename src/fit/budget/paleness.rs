//! Paleness: how much less contrast a drawing on paper has than drawings usually have.
//!
//! An error is seen beside the contrast that there is: 30 dB are little of a pencil sketch with a range of 60 levels.

use crate::fit::drawing::background;
use crate::image::Image;
use crate::math;

/// Contrast of usual drawings, levels. 63 clip arts have 79 to 230, pencil sketches 73 to 122, lines of a px 146.
const USUAL: f64 = 145.0;
/// Largest distance from the paper of what is paper, levels, and how much larger that is for each level of doubt. Guesses.
const PAPER: f64 = 12.0;
const PAPER_OF_DOUBT: f64 = 2.0;
/// Most of the pixels of a drawing on paper. Photographs whose border has one colour have 0.87 and more.
const MOST_DRAWN: f64 = 0.5;
/// Most paleness, dB: fainter drawings are noise. A guess.
const MOST_DB: f64 = 10.0;

/// How much more quality a drawing on paper needs, dB, because its contrast is less than usual; `None` of what is no such drawing. The
/// picture may be `doubt` levels from what it means.
pub(in crate::fit) fn paleness(picture: &Image, doubt: f32) -> Option<f64> {
    let paper = background::paper(picture)?;
    let least = PAPER + PAPER_OF_DOUBT * f64::from(doubt);
    // The RMS distance from the paper, weighted by its square: edges and thin lines have a part of their ink's contrast, and count little.
    let [mut sum, mut squares] = [0.0; 2];
    let mut drawn = 0_usize;
    let count = picture.width() * picture.height();
    for i in 0..count {
        let away = |c: usize| 255.0 * f64::from(picture.planes()[c][i] - paper[c]);
        let away2 = (0..3).map(|c| away(c) * away(c)).sum::<f64>() / 3.0;
        if away2 > least * least {
            sum += away2;
            squares += away2 * away2;
            drawn += 1;
        }
    }
    if drawn == 0 || drawn as f64 > MOST_DRAWN * count as f64 {
        return None;
    }
    let contrast = (squares / sum).sqrt();
    Some((20.0 * math::log10(USUAL / contrast)).clamp(0.0, MOST_DB))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar of so many levels on light grey, of so much of the page.
    fn bar(levels: f32, share: f32) -> Image {
        let value = |_: usize, y: usize, _: usize| match y < 40 || y as f32 >= 40.0 + 100.0 * share
        {
            true => 0.8,
            false => 0.8 - levels / 255.0,
        };
        Image::from_fn(100, 100, 3, value).unwrap()
    }

    #[test]
    fn half_the_contrast_needs_six_decibels() {
        let db = |levels, share| paleness(&bar(levels, share), 0.0);
        let half = db(0.5 * USUAL as f32, 0.1).unwrap();
        assert!((half - 6.02).abs() < 0.05, "{half}");
        assert_eq!(db(150.0, 0.1), Some(0.0));
        assert_eq!(db(8.0, 0.1), None, "nothing but paper");
        assert_eq!(db(20.0, 0.1), Some(MOST_DB));
    }

    #[test]
    fn what_has_no_paper_is_no_drawing() {
        let picture = Image::from_fn(64, 64, 3, |x, y, _| {
            0.4 + (x * 7 + y * 13) as f32 % 64.0 / 400.0
        });
        assert_eq!(paleness(&picture.unwrap(), 0.0), None);
        let clear = bar(50.0, 0.1).with_alpha(vec![0.5; 10_000]).unwrap();
        assert_eq!(paleness(&clear, 0.0), None);
    }
}
