//! The colour of the page that a picture has, and its drawing.

use std::collections::BTreeMap;

use strokefit::image::Image;

/// Colours are alike that share ranges of so many levels: more than the grain of paper.
const ALIKE_LEVELS: u8 = 16;

/// Largest difference of a channel between the means of a picture and of its drawing where the picture has its most common colours,
/// levels: those of a page, whatever its grain.
pub(super) fn levels(drawn: &Image, picture: &Image) -> Option<f64> {
    let pixels = picture.to_rgb8();
    let pixels = pixels.as_chunks::<3>().0;
    let cell = |color: &[u8; 3]| color.map(|level| level / ALIKE_LEVELS);
    let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    for color in pixels {
        *counts.entry(cell(color)).or_default() += 1;
    }
    let (page, count) = counts.into_iter().max_by_key(|(_, count)| *count)?;
    let drawn = drawn.to_rgb8();
    let pairs = pixels.iter().zip(drawn.as_chunks::<3>().0);
    let mut sums = [0.0; 3];
    for (own, drawn) in pairs.filter(|(own, _)| cell(own) == page) {
        for (sum, (a, b)) in sums.iter_mut().zip(own.iter().zip(drawn)) {
            *sum += f64::from(*b) - f64::from(*a);
        }
    }
    let off = sums.map(|sum| (sum / count as f64).abs());
    off.into_iter().reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_that_became_white_is_off() {
        let sheet = |page: [u8; 3]| {
            let is_page = |x: usize, y: usize| x.abs_diff(16).pow(2) + y.abs_diff(16).pow(2) > 81;
            let level = |x, y, c: usize| if is_page(x, y) { page[c] } else { 0 };
            Image::from_fn(32, 32, 3, level).unwrap()
        };
        let off = |page| levels(&sheet(page), &sheet([0xf5, 0xe6, 0xc8]));
        assert_eq!(off([0xf5, 0xe6, 0xc8]), Some(0.0));
        assert_eq!(off([0xf5, 0xe4, 0xc8]), Some(2.0));
        assert_eq!(off([0xff; 3]), Some(55.0));
    }
}
