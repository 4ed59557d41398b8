//! Which regions are worth their numbers, where a damage has left something behind.
//!
//! A region has an outline and a colour. Without it, its pixels have the colours beside it, or mixtures of them. It stays if that lengthens
//! the description by more than its numbers do: half of χ² of the errors, against a price for each number.

use super::super::areas::{LEVEL, Pixel, distance2, mix};
use super::super::edge::PRICE;
use super::colors::{CANVAS, Colors, NONE, SHADES};
use super::connected::borders;
use super::mixtures::{Mixture, best_mixture};

/// Numbers of a thing: those of a circle, and its colour.
const NUMBERS: f32 = 6.0;
/// Deviation of a channel, in units of the doubt, beyond as much that is alike all over a place and tells nothing. Of 16 drawings at 256 px,
/// in JPEG 75 and with noise of 8 levels, 1 and 2 have 0.91 and 0.97 times the artist's numbers.
const REST: f32 = 1.0;
/// Deviation of whole levels.
const ROUNDED: f32 = 0.29;
/// Deviation of the pixels of an edge, in units of the contrast of its sides. With 0.04 eyes go from faces of 256 px.
const EDGES: f32 = 0.02;
/// How far an edge reaches into a region, px.
const REACH: usize = 2;

/// Which regions are left to which others.
#[derive(Debug, Clone, Copy)]
pub(super) enum Rank {
    /// Those of gradients to those of colours.
    Shaded,
    /// Those of fewer pixels to those that have as many.
    Smaller(usize),
}

/// Gradients first, and then the smallest regions first, so that what is left has only neighbours that stay.
pub(super) fn ranks(members: &[Vec<u32>]) -> impl Iterator<Item = Rank> + use<> {
    let largest = members.iter().map(Vec::len).max().unwrap_or_default();
    let sizes = (0..).map(|k| 8 << (2 * k));
    let sizes = sizes.take_while(move |size| *size <= largest);
    [Rank::Shaded].into_iter().chain(sizes.map(Rank::Smaller))
}

/// The regions of a picture that may be off.
pub(super) struct Worth<'a> {
    pub(super) colors: &'a Colors<'a>,
    /// The region of each pixel, and the pixels of each region.
    pub(super) of: &'a [u32],
    pub(super) members: &'a [Vec<u32>],
    /// How far each pixel may be from what the picture means, RMS in levels of 8 bits.
    pub(super) doubts: &'a [f32],
}

impl Worth<'_> {
    /// Makes mixtures of the pixels of regions of lower rank that are not worth their numbers. Returns whether there were such.
    pub(super) fn leave_to_others(&self, rank: Rank, mixtures: &mut [Mixture]) -> bool {
        let near = self.beside(rank, mixtures);
        let regions = self.members.iter().zip(&near);
        let found = regions.filter_map(|(region, near)| self.without(region, near, mixtures));
        let found: Vec<(usize, Mixture)> = found.flatten().collect();
        for &(i, mixture) in &found {
            mixtures[i] = mixture;
        }
        !found.is_empty()
    }

    /// The labels of regions of higher rank beside each region of lower rank.
    fn beside(&self, rank: Rank, mixtures: &[Mixture]) -> Vec<Vec<u16>> {
        let width = self.colors.pixels.width;
        let is_low = |region: u32| {
            let region = &self.members[region as usize];
            match rank {
                Rank::Shaded => (SHADES..NONE).contains(&mixtures[region[0] as usize].own),
                Rank::Smaller(least) => region.len() < least,
            }
        };
        let mut near: Vec<Vec<u16>> = vec![Vec::new(); self.members.len()];
        let mut touch = |i: usize, k: usize| {
            for (low, high) in [(i, k), (k, i)] {
                let label = mixtures[high].own;
                let labels = &mut near[self.of[low] as usize];
                if is_low(self.of[low]) && !is_low(self.of[high]) && !labels.contains(&label) {
                    labels.push(label);
                }
            }
        };
        borders(self.of, width).for_each(|[i, k]| touch(i, k));
        near
    }

    /// The pixels of a region as mixtures of the labels beside it, if it is not worth its numbers.
    fn without(
        &self,
        region: &[u32],
        near: &[u16],
        mixtures: &[Mixture],
    ) -> Option<Vec<(usize, Mixture)>> {
        if near.is_empty() {
            return None;
        }
        let mean = self.mean(region);
        let mut gain = 0.0;
        let mut found = Vec::with_capacity(region.len());
        for i in region.iter().map(|&i| i as usize) {
            // Only pixels of its edge may be mixtures: a free share explains any colour between two.
            let mut around = self.colors.pixels.around(i, REACH);
            let mixture = match around.any(|k| self.of[k] != self.of[i]) {
                true => best_mixture(self.colors, near, i),
                false => self.nearest(near, i),
            };
            // The region has the best colour of its own, whatever its label is.
            let own = self.error(i, &mixtures[i]).min(self.away2(i, &mean));
            gain += (self.error(i, &mixture) - own) / self.variance(i, &mixture);
            if gain >= 2.0 * PRICE as f32 * NUMBERS {
                return None;
            }
            found.push((i, mixture));
        }
        Some(found)
    }

    /// The mean colour of some pixels.
    fn mean(&self, pixels: &[u32]) -> Pixel {
        let mut mean = [0.0; 6];
        for &i in pixels {
            let target = self.colors.pixels.target.at(i as usize);
            let channels = mean.iter_mut().zip(target);
            channels.for_each(|(sum, v)| *sum += v / pixels.len() as f32);
        }
        mean
    }

    /// The label of some whose colour is nearest to a pixel; the first of equals.
    fn nearest(&self, labels: &[u16], i: usize) -> Mixture {
        let pure = labels.iter().map(|&label| Mixture::pure(label));
        let nearest = pure.min_by(|a, b| self.error(i, a).total_cmp(&self.error(i, b)));
        nearest.unwrap_or(Mixture::pure(CANVAS))
    }

    fn error(&self, i: usize, mixture: &Mixture) -> f32 {
        let [own, other] = self.sides(i, mixture);
        self.away2(i, &mix(&own, &other, mixture.share))
    }

    /// The squared distance of a pixel from a colour, beyond what is left of a damage all over a place.
    fn away2(&self, i: usize, color: &Pixel) -> f32 {
        let target = self.colors.pixels.target.at(i);
        let away = target.iter().zip(color);
        let away = away.map(|(a, b)| ((a - b).abs() - self.doubts[i] * LEVEL).max(0.0));
        away.map(|a| a * a).sum()
    }

    /// The variance of a channel of a pixel that is a mixture.
    fn variance(&self, i: usize, mixture: &Mixture) -> f32 {
        let sigma = REST * self.doubts[i].max(ROUNDED) * LEVEL;
        let [own, other] = self.sides(i, mixture);
        let edge = match mixture.share {
            0.0 => 0.0,
            _ => EDGES * EDGES * distance2(&own, &other),
        };
        sigma * sigma + edge
    }

    fn sides(&self, i: usize, mixture: &Mixture) -> [Pixel; 2] {
        [mixture.own, mixture.other].map(|label| self.colors.at(label, i))
    }
}
