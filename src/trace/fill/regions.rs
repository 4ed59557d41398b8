//! Regions: the connected pixels of one label, and the share of each pixel that belongs to the region beside it.

use std::collections::BTreeMap;

use super::super::areas::{LEVEL, Pixel, away, distance2, mix};
use super::super::parts::{Part, Parts};
use super::colors::{self, CANVAS, Colors};
use super::connected::{borders, connected};
use super::mixtures::{Mixture, best_mixture};
use super::worth::{self, Worth};
use crate::math::{Normal, median};
use crate::scene::Shade;

/// A region.
#[derive(Debug, Clone)]
pub(super) struct Region {
    pub(super) label: u16,
    /// Its pixels, row by row.
    pub(super) members: Vec<u32>,
    /// The median of its pixels of one colour.
    pub(super) color: Pixel,
    /// The gradients on top of each other that take the place of the colour, back to front.
    pub(super) shades: Vec<Shade>,
    /// The part that it is of a shape that came apart.
    pub(super) part: Part,
}

/// The regions of a picture.
pub(super) struct Regions {
    pub(super) width: usize,
    pub(super) height: usize,
    /// The region of each pixel.
    pub(super) of: Vec<u32>,
    /// The region that the smaller share of each pixel belongs to.
    pub(super) second: Vec<u32>,
    /// That share, 0 to ½.
    pub(super) share: Vec<f32>,
    pub(super) list: Vec<Region>,
}

impl Regions {
    /// The regions of pixels as mixtures. What is too small, or only edges, becomes part of what is beside it.
    pub(super) fn of(
        colors: &Colors<'_>,
        mut mixtures: Vec<Mixture>,
        parts: &Parts,
        doubts: &[f32],
    ) -> Self {
        let width = colors.pixels.width;
        // 1. Connected pixels of one label are a region.
        let by_label = |mixtures: &[Mixture]| connected(mixtures.len(), width, |i| mixtures[i].own);
        let (mut of, mut members) = by_label(&mixtures);
        if dissolve(colors, &of, &members, &mut mixtures) {
            (of, members) = by_label(&mixtures);
        }
        // 2. What the rest of a damage explains is nothing of its own.
        let are_doubtful = doubts.iter().any(|doubt| *doubt > 0.0);
        for rank in worth::ranks(&members).filter(|_| are_doubtful) {
            let worth = Worth {
                colors,
                of: &of,
                members: &members,
                doubts,
            };
            if worth.leave_to_others(rank, &mut mixtures) {
                (of, members) = by_label(&mixtures);
            }
        }
        // 3. Small regions join a neighbour. That can leave others small, such as the two halves of a ring, so it repeats.
        for _ in 0..6 {
            let is_small = |pixels: &Vec<u32>| is_small(colors, &mixtures, pixels);
            let small: Vec<bool> = members.iter().map(is_small).collect();
            if small.iter().all(|small| *small) || !small.contains(&true) {
                break;
            }
            absorb(colors, &of, &members, &small, &mut mixtures);
            (of, members) = by_label(&mixtures);
        }
        // 4. A shape that came apart into lines and blobs is a region for each.
        let mut parts_of = Vec::new();
        if !parts.are_whole() {
            parts_of = self::parts_of(&of, &members, parts, |i| mixtures[i].own == CANVAS);
            (of, members) = connected(of.len(), width, |i| (of[i], parts_of[i]));
        }
        // 5. An antialiased pixel belongs to a second region by a share.
        let (second, share) = seconds(colors, &mixtures, &of);
        let region = |pixels: Vec<u32>| {
            let label = mixtures[pixels[0] as usize].own;
            let color = color(colors, &share, &pixels, label);
            Region {
                label,
                color,
                shades: colors.shades(label).to_vec(),
                part: *parts_of.get(pixels[0] as usize).unwrap_or(&Part::Whole),
                members: pixels,
            }
        };
        let list = members.into_iter().map(region).collect();
        Self {
            width,
            height: colors.pixels.height,
            of,
            second,
            share,
            list,
        }
    }

    /// The share of pixel `i` that belongs to regions with `is_member`.
    pub(super) fn share_of(&self, i: usize, is_member: &[bool]) -> f32 {
        let share = |region: u32, share: f32| match is_member[region as usize] {
            true => share,
            false => 0.0,
        };
        share(self.of[i], 1.0 - self.share[i]) + share(self.second[i], self.share[i])
    }

    /// The number of pairs of pixels in which regions touch, for each region its neighbours.
    pub(super) fn neighbours(&self) -> Vec<BTreeMap<u32, u32>> {
        let mut found: Vec<BTreeMap<u32, u32>> = vec![BTreeMap::new(); self.list.len()];
        for [i, k] in borders(&self.of, self.width) {
            let (a, b) = (self.of[i], self.of[k]);
            *found[a as usize].entry(b).or_default() += 1;
            *found[b as usize].entry(a).or_default() += 1;
        }
        found
    }
}

/// The part of each pixel of the regions `of`. Edges belong to what is beside them.
fn parts_of(
    of: &[u32],
    members: &[Vec<u32>],
    parts: &Parts,
    is_canvas: impl Fn(usize) -> bool,
) -> Vec<Part> {
    // A blob belongs to the region that has most of it.
    let mut votes: Vec<BTreeMap<u32, u32>> = vec![BTreeMap::new(); parts.blobs()];
    for i in (0..of.len()).filter(|&i| !is_canvas(i)) {
        if let Part::Blob(blob) = parts.at(i) {
            *votes[blob as usize].entry(of[i]).or_default() += 1;
        }
    }
    let home = |votes: &BTreeMap<u32, u32>| {
        let most = votes.iter().max_by_key(|&(region, votes)| (votes, region));
        most.map(|(&region, _)| region)
    };
    let homes: Vec<Option<u32>> = votes.iter().map(home).collect();
    let mut apart = vec![None; members.len()];
    for (blob, home) in (0..).zip(&homes) {
        if let Some(region) = home {
            apart[*region as usize] = Some(Part::Lines(parts.shape(blob)));
        }
    }
    let own = |i: usize| match (parts.near(i), apart[of[i] as usize]) {
        (_, None) => Part::Whole,
        (Part::Blob(blob), _) if homes[blob as usize] == Some(of[i]) => Part::Blob(blob),
        (_, Some(lines)) => lines,
    };
    (0..of.len()).map(own).collect()
}

/// Makes mixtures of thin regions whose pixels lie between the colours on either side. Returns whether there were such.
fn dissolve(
    colors: &Colors<'_>,
    of: &[u32],
    members: &[Vec<u32>],
    mixtures: &mut [Mixture],
) -> bool {
    let mut found = Vec::new();
    for (region, pixels) in members.iter().enumerate() {
        let label = mixtures[pixels[0] as usize].own;
        if label == CANVAS || !is_thin(colors, of, region as u32, pixels) {
            continue;
        }
        // What tapers off is beside both colours only at its end.
        let is_long = pixels.len() >= SHORT;
        let all = if is_long { &[] } else { pixels.as_slice() };
        let mixed = pixels.iter().map(|&i| {
            let near = labels_without(colors, mixtures, label, all, i as usize);
            let mixture = best_mixture(colors, &near, i as usize);
            (mixture, near.len())
        });
        let mixed: Vec<(Mixture, usize)> = mixed.collect();
        // At the picture's border the canvas may lie beyond it.
        let is_open =
            |i, m: &Mixture| is_border(colors, i) && (m.own == CANVAS || m.other == CANVAS);
        let is_edge = |&(&i, (m, labels)): &(&u32, &(Mixture, usize))| {
            (m.error < EDGE * EDGE || (is_long && has_third(colors, label, m, i as usize)))
                && m.share > 0.04
                && (*labels < 3
                    || is_open(i as usize, m)
                    || is_between(colors, mixtures, i as usize, m))
        };
        let edges = pixels.iter().zip(&mixed).filter(is_edge).count();
        let mixed = mixed.into_iter().map(|(mixture, _)| mixture);
        if edges * 5 > pixels.len() * 4 {
            found.extend(pixels.iter().copied().zip(mixed));
        }
    }
    let is_found = !found.is_empty();
    for (i, mixture) in found {
        mixtures[i as usize] = mixture;
    }
    is_found
}

/// Root of the squared error below which a mixture explains a pixel of a thin region. A guess.
const EDGE: f32 = 8.0 * LEVEL;

/// True if a pixel shows a third colour besides those of a mixture, as far as it is seen between two edges that coincide: a renderer
/// covers a share a of a pixel by each, so that (1 − a)·a, a quarter at most, of what is below the upper one stays.
fn has_third(colors: &Colors<'_>, label: u16, mixture: &Mixture, i: usize) -> bool {
    const MOST: f32 = 0.25;
    let target = colors.pixels.target.at(i);
    let [a, b] = [mixture.own, mixture.other].map(|label| colors.at(label, i));
    let flat = 0..=colors.list.len() as u16;
    let mut others = flat.filter(|third| ![label, mixture.own, mixture.other].contains(third));
    others.any(|third| {
        // The shares s and t of b and of the third colour, by least squares.
        let c = colors.at(third, i);
        let mut equations = Normal::<1>::of(2);
        for k in 0..6 {
            let terms = [(0, f64::from(b[k] - a[k])), (1, f64::from(c[k] - a[k]))];
            equations.add(&terms, [f64::from(target[k] - a[k])], 1.0);
        }
        let Some(shares) = equations.solve() else {
            return false;
        };
        let [s, t] = [shares[0][0] as f32, shares[1][0] as f32];
        let drawn = mix(&mix(&a, &b, s / (1.0 - t).max(f32::MIN_POSITIVE)), &c, t);
        s > 0.0
            && s + t < 1.0
            && (0.0..=MOST).contains(&t)
            && distance2(&target, &drawn) < EDGE * EDGE
    })
}

/// True if a region is about a pixel thick: few of its pixels are corners of squares of four.
fn is_thin(colors: &Colors<'_>, of: &[u32], region: u32, pixels: &[u32]) -> bool {
    let width = colors.pixels.width;
    let is_own = |i: usize| of.get(i) == Some(&region);
    let is_corner = |&&i: &&u32| {
        let i = i as usize;
        !(i + 1).is_multiple_of(width)
            && is_own(i + 1)
            && is_own(i + width)
            && is_own(i + width + 1)
    };
    let corners = pixels.iter().filter(is_corner).count();
    2 * corners <= pixels.len()
}

/// True if the two colours of a mixture are on opposite sides of pixel `i`.
fn is_between(colors: &Colors<'_>, mixtures: &[Mixture], i: usize, mixture: &Mixture) -> bool {
    let width = colors.pixels.width;
    let mut sums = [[0_isize; 2]; 2];
    for k in colors.pixels.around(i, 2) {
        for (sum, label) in sums.iter_mut().zip([mixture.own, mixture.other]) {
            if mixtures[k].own == label && mixtures[k].share < 0.1 {
                let away = |a: usize, b: usize| a as isize - b as isize;
                sum[0] += away(k % width, i % width);
                sum[1] += away(k / width, i / width);
            }
        }
    }
    let [a, b] = sums;
    a[0] * b[0] + a[1] * b[1] < 0
}

/// True if pixel `i` is one of the picture's border.
fn is_border(colors: &Colors<'_>, i: usize) -> bool {
    let (width, height) = (colors.pixels.width, colors.pixels.height);
    let (x, y) = (i % width, i / width);
    x == 0 || y == 0 || x + 1 == width || y + 1 == height
}

/// A thin region of fewer pixels may be a mixture of colours that are beside any of them. A guess.
const SHORT: usize = 16;

/// The labels other than `label` around pixel `i` and around `more` pixels. Beyond the picture's border lies the canvas.
fn labels_without(
    colors: &Colors<'_>,
    mixtures: &[Mixture],
    label: u16,
    more: &[u32],
    i: usize,
) -> Vec<u16> {
    let pixels = colors.pixels;
    let mut near = Vec::new();
    if is_border(colors, i) {
        near.push(CANVAS);
    }
    let places = more.iter().map(|&i| i as usize).chain([i]);
    for k in places.flat_map(|i| pixels.around(i, 2)) {
        let Mixture { own, share, .. } = mixtures[k];
        if own != label && share < 0.1 && !near.contains(&own) {
            near.push(own);
        }
    }
    near
}

/// True if a region has few pixels, or hardly any of its colour.
fn is_small(colors: &Colors<'_>, mixtures: &[Mixture], pixels: &[u32]) -> bool {
    let area = pixels.len();
    if area >= 60 {
        return false;
    }
    let is_pure = |&&i: &&u32| {
        let i = i as usize;
        let color = colors.at(mixtures[i].own, i);
        away(&colors.pixels.target.at(i), &color) < 14.0 * LEVEL
    };
    let pure = pixels.iter().filter(is_pure).count();
    area < colors::LEAST_AREA || (area < 12 && pure == 0) || pure * 8 < area
}

/// Gives the pixels of small regions to the regions beside them that are nearest in colour.
fn absorb(
    colors: &Colors<'_>,
    of: &[u32],
    members: &[Vec<u32>],
    small: &[bool],
    mixtures: &mut [Mixture],
) {
    let is_small = |i: usize| small[of[i] as usize];
    let pixels = members.iter().zip(small).filter(|(_, small)| **small);
    let pixels = pixels.flat_map(|(pixels, _)| pixels).map(|&i| i as usize);
    let labels: Vec<(usize, u16)> = pixels
        .filter_map(|i| {
            let target = colors.pixels.target.at(i);
            let near = |reach| colors.pixels.around(i, reach).filter(|&k| !is_small(k));
            let reach = [2, 4]
                .into_iter()
                .find(|&reach| near(reach).next().is_some())?;
            let error = |label: u16| distance2(&target, &colors.at(label, i));
            let labels = near(reach).map(|k| mixtures[k].own);
            let nearest = labels.min_by(|&a, &b| error(a).total_cmp(&error(b)))?;
            Some((i, nearest))
        })
        .collect();
    for (i, label) in labels {
        mixtures[i] = Mixture::pure(label);
    }
}

/// The region that the smaller share of each pixel belongs to, and that share.
fn seconds(colors: &Colors<'_>, mixtures: &[Mixture], of: &[u32]) -> (Vec<u32>, Vec<f32>) {
    let width = colors.pixels.width;
    let second = |i: usize| {
        let Mixture {
            own, other, share, ..
        } = mixtures[i];
        if share <= 0.0 || own == other {
            return (of[i], 0.0);
        }
        let away2 = |k: usize| {
            let dx = (k % width).abs_diff(i % width);
            let dy = (k / width).abs_diff(i / width);
            dx * dx + dy * dy
        };
        let near = colors.pixels.around(i, 2);
        let near = near.filter(|&k| mixtures[k].own == other);
        match near.min_by_key(|&k| away2(k)) {
            Some(k) => (of[k], share),
            None => (of[i], 0.0),
        }
    };
    (0..mixtures.len()).map(second).unzip()
}

/// The median of the pixels of a region that are no mixtures.
fn color(colors: &Colors<'_>, share: &[f32], pixels: &[u32], label: u16) -> Pixel {
    let pure = pixels.iter().filter(|&&i| share[i as usize] == 0.0).count();
    if label == CANVAS || pure < 9 {
        return colors.at(label, pixels[0] as usize);
    }
    let pure = pixels.iter().filter(|&&i| share[i as usize] == 0.0);
    let sample = pure.step_by(pixels.len().div_ceil(4096));
    let sample: Vec<Pixel> = sample
        .map(|&i| colors.pixels.target.at(i as usize))
        .collect();
    std::array::from_fn(|k| median(sample.iter().map(|p| p[k])).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::super::super::areas::{Pixels, Planes};
    use super::super::mixtures;
    use super::super::shades::Shaded;
    use super::*;

    /// A page of two greys side by side, with a speck of so many levels less on the lighter one.
    fn speck(levels: f32) -> Pixels<'static> {
        let value = |i: usize| match (i % 40, i / 40) {
            (10..14, 10..13) => 1.0 - levels * LEVEL,
            (..20, _) => 1.0,
            _ => 0.2,
        };
        let plane: Vec<f32> = (0..40 * 24).map(value).collect();
        let planes = |plane: Vec<f32>| Planes(vec![plane.into(); 3]);
        Pixels {
            width: 40,
            height: 24,
            target: planes(plane),
            canvas: planes(vec![1.0; 40 * 24]),
            weights: None,
        }
    }

    /// The number of regions of a page with a speck, if colours may be off by so much.
    fn regions_of_speck(levels: f32, doubt: f32) -> usize {
        let pixels = speck(levels);
        let shaded = Shaded::none(&pixels);
        let (mut colors, mut labels) = colors::flat_colors(&pixels, shaded, 1, &[0.0; 40 * 24]);
        let mixtures = mixtures::mixtures(&mut colors, &mut labels);
        let parts = Parts::of(&[], 40, 40 * 24);
        Regions::of(&colors, mixtures, &parts, &[doubt; 40 * 24])
            .list
            .len()
    }

    #[test]
    fn a_speck_is_a_region_if_no_damage_explains_it() {
        assert_eq!(regions_of_speck(16.0, 0.0), 3);
        assert_eq!(regions_of_speck(16.0, 2.0), 3);
        assert_eq!(regions_of_speck(16.0, 8.0), 2);
        assert_eq!(regions_of_speck(60.0, 8.0), 3);
    }
}
