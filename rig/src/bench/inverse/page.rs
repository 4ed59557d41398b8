//! The colour of the page that a picture has, and its drawing.

use std::collections::BTreeMap;

use strokefit::Result;
use strokefit::image::Image;
use strokefit::verify;

/// Colours are alike that share ranges of so many levels: more than the grain of paper.
const ALIKE_LEVELS: u8 = 16;

/// Largest difference of a channel between the means of a picture and of its drawing where the picture has its most common colours,
/// levels: those of a page, whatever its grain.
pub(super) fn levels(svg: &str, picture: &Image) -> Result<Option<f64>> {
    let pixels = picture.to_rgb8();
    let pixels = pixels.as_chunks::<3>().0;
    let cell = |color: &[u8; 3]| color.map(|level| level / ALIKE_LEVELS);
    let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    for color in pixels {
        *counts.entry(cell(color)).or_default() += 1;
    }
    let Some((page, count)) = counts.into_iter().max_by_key(|(_, count)| *count) else {
        return Ok(None);
    };
    let drawn = verify::render_like(svg, picture, [1.0; 3])?.to_rgb8();
    let pairs = pixels.iter().zip(drawn.as_chunks::<3>().0);
    let mut sums = [0.0; 3];
    for (own, drawn) in pairs.filter(|(own, _)| cell(own) == page) {
        for (sum, (a, b)) in sums.iter_mut().zip(own.iter().zip(drawn)) {
            *sum += f64::from(*b) - f64::from(*a);
        }
    }
    let off = sums.map(|sum| (sum / count as f64).abs());
    Ok(off.into_iter().reduce(f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_that_became_white_is_off() {
        let sheet = |page: &str| {
            format!(
                r##"<svg xmlns="http://www.w3.org/2000/svg" width="32" height="32"><rect width="32" height="32" fill="{page}"/><circle cx="16" cy="16" r="9"/></svg>"##
            )
        };
        let cream = verify::render(&sheet("#f5e6c8"), verify::Size::Scale(1.0), None).unwrap();
        let off = |page| levels(&sheet(page), &cream).unwrap();
        assert_eq!(off("#f5e6c8"), Some(0.0));
        assert_eq!(off("#f5e4c8"), Some(2.0));
        assert_eq!(off("#ffffff"), Some(55.0));
    }
}
