//! Belonging: how well the elements of a file are the things of its artist, by leaving each out (arXiv 2604.08809).
//!
//! `D_i` is the change of the picture without element `i`, and `H_c` marks the pixels that change without the artist's thing
//! `c`; `A(i, c) = Σ H_c·D_i`. Purity is how much of what an element changes is one thing's, coverage how many things an element
//! draws, and locality how near to each other in painting order the elements of a thing are.

use std::ops::Range;

use super::anatomy::{elements, things};
use crate::report::cases::Belonging;
use crate::report::statistics::mean;
use strokefit::Result;
use strokefit::verify::{self, Size};

/// Files with more elements are not judged: each costs a render.
pub(super) const MOST: usize = 400;

/// Least change of a pixel that counts as one, of the sum of its four channels.
pub(super) const CHANGED: f32 = 4.0 / 255.0;

/// The things of an artist.
#[derive(Debug)]
pub(super) struct Things {
    size: Size,
    /// True for each pixel that a thing is seen in.
    masks: Vec<Vec<bool>>,
}

impl Things {
    /// The things of a drawing in a picture of so many px.
    ///
    /// # Errors
    /// As [`verify::render`].
    pub(super) fn of(svg: &str, size: Size) -> Result<Self> {
        let mut masks = Vec::new();
        for change in changes(svg, things(svg)?, size)?.unwrap_or_default() {
            let mask: Vec<bool> = change.iter().map(|change| *change > CHANGED).collect();
            if mask.contains(&true) {
                masks.push(mask);
            }
        }
        Ok(Self { size, masks })
    }

    /// The measures of the elements of other SVG text; `None` if there are none, no things, or too many.
    ///
    /// # Errors
    /// As [`verify::render`].
    pub(super) fn belonging(&self, svg: &str) -> Result<Option<Belonging>> {
        let Some(changes) = changes(svg, elements(svg)?, self.size)? else {
            return Ok(None);
        };
        let shares = |change: &Vec<f32>| -> Vec<f64> {
            let within = |mask: &Vec<bool>| {
                let inside = change.iter().zip(mask).filter(|(_, inside)| **inside);
                inside.map(|(change, _)| f64::from(*change)).sum()
            };
            self.masks.iter().map(within).collect()
        };
        let attributed: Vec<Vec<f64>> = changes.iter().map(shares).collect();
        Ok(belonging(&attributed, self.masks.len()))
    }
}

/// For each range of the text, the change of each pixel without it; `None` if there are too many.
fn changes(svg: &str, ranges: Vec<Range<usize>>, size: Size) -> Result<Option<Vec<Vec<f32>>>> {
    if ranges.len() > MOST {
        return Ok(None);
    }
    let whole = drawn(svg, size)?;
    let change = |range| {
        let text = without(svg, &[range]);
        let pairs = whole.iter().zip(drawn(&text, size)?);
        let apart = |(a, b): (&[f32; 4], [f32; 4])| {
            let channels = a.iter().zip(b);
            channels.map(|(a, b)| (a - b).abs()).sum()
        };
        Ok(pairs.map(apart).collect())
    };
    let changes: Result<Vec<Vec<f32>>> = ranges.into_iter().map(change).collect();
    changes.map(Some)
}

/// The text without the elements in some of its ranges, which are in order.
pub(super) fn without(svg: &str, ranges: &[Range<usize>]) -> String {
    let mut text = svg.to_owned();
    // An element within another one is gone with it.
    let mut from = text.len() + 1;
    for range in ranges.iter().rev() {
        if range.end <= from {
            text.replace_range(range.clone(), "");
            from = range.start;
        }
    }
    text
}

/// Colour, multiplied by alpha, and alpha of each pixel.
pub(super) fn drawn(svg: &str, size: Size) -> Result<Vec<[f32; 4]>> {
    let picture = verify::render(svg, size, None)?;
    let [red, green, blue] = picture.planes();
    let pixel = |i: usize| {
        let alpha = picture.alpha().map_or(1.0, |alpha| alpha[i]);
        [red[i] * alpha, green[i] * alpha, blue[i] * alpha, alpha]
    };
    Ok((0..red.len()).map(pixel).collect())
}

/// The measures of `A(i, c)`, element by element, for so many things.
fn belonging(attributed: &[Vec<f64>], things: usize) -> Option<Belonging> {
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    // Elements that change nothing of any thing belong to none.
    let purities = attributed.iter().filter_map(|own| {
        let all: f64 = own.iter().sum();
        (all > 0.0).then(|| largest(&mut own.iter().copied()) / all)
    });
    let of_thing = |c: usize| attributed.iter().map(move |own| own[c]);
    let mut most: Vec<f64> = (0..things).map(|c| largest(&mut of_thing(c))).collect();
    let locality = |c: usize| {
        let weight: f64 = of_thing(c).sum();
        let places = || of_thing(c).enumerate().map(|(i, a)| (i as f64, a / weight));
        let middle: f64 = places().map(|(place, share)| place * share).sum();
        let deviation: f64 = places()
            .map(|(place, share)| (place - middle).abs() * share)
            .sum();
        let half = (attributed.len() as f64 - 1.0) / 2.0;
        (weight > 0.0).then(|| 1.0 - if half > 0.0 { deviation / half } else { 0.0 })
    };
    let localities: Vec<f64> = (0..things).filter_map(locality).collect();
    let (purity, locality) = (mean(&purities.collect::<Vec<_>>())?, mean(&localities)?);
    let shown = most.clone();
    most.sort_by(f64::total_cmp);
    let threshold = most[things / 2] / 2.0;
    let covered = shown.iter().map(|a| (a / threshold).clamp(0.0, 1.0));
    let coverage = mean(&covered.collect::<Vec<_>>())?;
    coverage.is_finite().then_some(Belonging {
        purity,
        coverage,
        locality,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size::Scale(1.0);

    fn svg(body: &str) -> String {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="32" height="32">{body}</svg>"#)
    }

    const SQUARES: &str = r##"<rect x="2" y="2" width="8" height="8" fill="#d00"/><rect x="20" y="2" width="8" height="8" fill="#00d"/>"##;

    fn measured(own: &str, other: &str) -> Belonging {
        let things = Things::of(&svg(own), SIZE).unwrap();
        things.belonging(&svg(other)).unwrap().unwrap()
    }

    #[test]
    fn a_drawing_belongs_to_itself() {
        let itself = measured(SQUARES, SQUARES);
        assert_eq!([itself.purity, itself.coverage, itself.locality], [1.0; 3]);
    }

    #[test]
    fn an_element_of_two_things_is_half_of_each() {
        let both = r##"<path d="M2 2h8v8h-8zM20 2h8v8h-8z" fill="#d00"/>"##;
        let found = measured(SQUARES, both);
        assert!((found.purity - 0.5).abs() < 1e-6, "{found:?}");
        assert_eq!([found.coverage, found.locality], [1.0; 2]);
    }

    #[test]
    fn pieces_far_apart_in_painting_order_are_less_local() {
        let halves = r##"<rect x="2" y="2" width="4" height="8" fill="#d00"/><rect x="20" y="2" width="8" height="8" fill="#00d"/><rect x="6" y="2" width="4" height="8" fill="#d00"/>"##;
        let found = measured(SQUARES, halves);
        assert_eq!(found.purity, 1.0);
        // The red one's pieces are 1 from their middle, of (3 − 1) / 2; the blue one's is at it.
        assert!((found.locality - 0.5).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn a_lost_thing_is_not_covered_and_groups_are_things() {
        let grouped = format!("<g>{SQUARES}</g><g><circle cx='16' cy='24' r='5'/></g>");
        let found = measured(&grouped, SQUARES);
        // One of two things is lost, and the other is in two elements.
        assert_eq!([found.purity, found.coverage], [1.0, 0.5]);
    }
}
