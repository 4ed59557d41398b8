//! Filled shapes of flat art.
//!
//! ```text
//! shades     the gradients of smooth places
//! colors     the colours of flat places
//! mixtures   all other pixels as mixtures of the two colours beside them
//! connected  the pixels of one label that touch, and where such regions touch each other
//! regions    the connected pixels of one colour
//! worth      which of them are more than what a damage has left
//! translucent what is seen through, and where two such shapes cross
//! overlaps   which of two shapes lies on top
//! stack      larger shapes lie below and go on beneath what lies on top
//! corners    where that turns
//! outline    its corners and the splines between them, as few points as are near enough
//! placing    or shapes and lines where their edges are seen
//! compound   shapes of one colour with nothing between them are one
//! ```

mod colors;
mod compound;
mod connected;
mod corners;
mod doubts;
mod hull;
mod mixtures;
mod outline;
mod overlaps;
mod placing;
mod regions;
mod shades;
mod span;
mod stack;
mod translucent;
mod worth;

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::areas::{self, Pixel, Pixels, away, distance2, is_opaque, mix};
use super::contour::{self, Field, Place, between};
use super::parts::{Part, Parts};
use super::tracing::Tracing;
use crate::scene::{Area, Path, Rgb};
use colors::{CANVAS, NONE};
pub(super) use compound::Fill;
use outline::Surroundings;
pub(super) use placing::{Placing, TIP};
use regions::{Region, Regions};
use shades::Shaded;
use stack::{Layer, Stack};
use translucent::{Translucent, on_top};

/// A filled shape, what it gains, and its place in the stack.
#[derive(Debug, Clone)]
pub(super) struct Filled {
    pub(super) area: Area,
    pub(super) gain: f32,
    pub(super) rank: usize,
}

/// A picture as a stack of regions.
pub(super) struct Flat<'a> {
    pixels: &'a Pixels<'a>,
    pub(super) mattes: usize,
    regions: Regions,
    neighbours: Vec<BTreeMap<u32, u32>>,
    translucent: Translucent,
    stack: Stack,
    pub(super) tracing: Tracing,
    /// How far each pixel may be from what the picture means, levels.
    doubts: Vec<f32>,
}

/// The share of the pixels that has to be flat, or there are no filled shapes, which would take long to find. Drawings of filled shapes
/// have 0.69 to 0.99, an icon of 32 px 0.54, photographs 0.07 to 0.49, scanned line drawings 0.53 to 0.68.
const LEAST_FLAT: f32 = 0.5;
/// More borders than this, px, and than this share of the pixels, are those of levels of shades and of noise, and not of shapes. Of 70
/// pictures of flat art and of lines of up to a megapixel the most is 40,000 px; three photographs that pass for flat have 65,000 to 130,000,
/// and 0.18 to 0.24. Areas of these take 4 to 10 times as long as strokes, and up to twice the bytes.
const TEXTURE: (f32, f32) = (50_000.0, 0.12);
/// Farthest that a hidden edge may be beyond the samples, px. A guess.
const HIDDEN: f32 = 32.0;

/// True if the borders between regions, of so many pixels, are those of a texture.
fn are_of_texture(neighbours: &[BTreeMap<u32, u32>], pixels: usize) -> bool {
    // Each border is one of both of its regions.
    let borders = 0.5
        * neighbours
            .iter()
            .flat_map(BTreeMap::values)
            .map(|&px| px as f32)
            .sum::<f32>();
    borders > TEXTURE.0.max(TEXTURE.1 * pixels as f32)
}

impl<'a> Flat<'a> {
    /// The stack of a picture whose shapes come apart like this, if it is one of few colours.
    pub(super) fn of(
        pixels: &'a Pixels<'a>,
        mattes: usize,
        parts: &Parts,
        tracing: Tracing,
    ) -> Option<Self> {
        let shaded = match tracing.has_shades {
            true => Shaded::of(pixels, mattes),
            false => Shaded::none(pixels),
        };
        let doubts = doubts::doubts(pixels, tracing.doubt);
        let (mut colors, mut labels) = colors::flat_colors(pixels, shaded, mattes, &doubts);
        let flat = labels.iter().filter(|label| **label != NONE).count();
        if (flat as f32) < LEAST_FLAT * labels.len() as f32 {
            return None;
        }
        let mixtures = mixtures::mixtures(&mut colors, &mut labels);
        let regions = Regions::of(&colors, mixtures, parts, &doubts);
        let neighbours = regions.neighbours();
        if are_of_texture(&neighbours, pixels.width * pixels.height) {
            return None;
        }
        let translucent = match mattes {
            1 => Translucent::none(regions.list.len()),
            _ => Translucent::of(&regions, &neighbours, pixels),
        };
        // What is translucent and of one colour on top of a drawing is left to strokes.
        let is_drawn = |(region, r): (&Region, u32)| {
            let is_whole = mattes == 1 || !region.shades.is_empty() || is_opaque(&region.color);
            region.label == CANVAS || is_whole || translucent.has(r)
        };
        let drawn: Vec<bool> = regions.list.iter().zip(0..).map(is_drawn).collect();
        let stack = Stack::of(&regions, &neighbours, &drawn, &translucent);
        Some(Self {
            pixels,
            mattes,
            regions,
            neighbours,
            translucent,
            stack,
            tracing,
            doubts,
        })
    }

    /// The shapes of the stack, from back to front.
    pub(super) fn fills(&self) -> Vec<Fill> {
        let gains = self.gains();
        let layers = self.stack.layers.par_iter();
        layers
            .filter_map(|layer| self.fill(layer, &gains))
            .collect()
    }

    /// The areas of shapes, those of one colour joined, from back to front. Those of `left_out` regions are not drawn.
    pub(super) fn areas(&self, fills: Vec<Fill>, left_out: &[bool]) -> Vec<Filled> {
        let fills = fills
            .into_iter()
            .filter(|fill| !left_out[fill.region as usize]);
        self.painted(&self.joined(fills.collect()), |rings| vec![rings.to_vec()])
    }

    /// Shapes, those of one colour joined.
    fn joined<R>(&self, fills: Vec<Fill<R>>) -> Vec<Fill<R>> {
        compound::joined(fills, &self.neighbours, |fill| {
            self.part(fill.region) != Part::Whole
        })
    }

    /// The areas of shapes, whose rings make some elements, each of some paths.
    fn painted<R>(
        &self,
        fills: &[Fill<R>],
        mut elements: impl FnMut(&[R]) -> Vec<Vec<Path>>,
    ) -> Vec<Filled> {
        let filled = fills.iter().flat_map(|fill| {
            let paths = elements(&fill.rings);
            self.areas_of(fill, paths).map(|area| Filled {
                area,
                gain: fill.gain / self.mattes as f32,
                rank: fill.rank,
            })
        });
        filled.collect()
    }

    /// The areas of a shape: one, or one for each of its gradients.
    pub(super) fn area_of(&self, fill: &Fill) -> impl Iterator<Item = Area> {
        self.areas_of(fill, vec![fill.rings.clone()])
    }

    /// The areas of a shape, back to front, for each of its gradients and each of some elements.
    fn areas_of<R>(
        &self,
        fill: &Fill<R>,
        paths: Vec<Vec<Path>>,
    ) -> impl Iterator<Item = Area> + use<R> {
        let (color, opacity) = areas::ink(&fill.color, self.mattes);
        let plain = fill.shades.is_empty().then_some(None);
        // A gradient has opacities of its own.
        let opacity = if fill.shades.is_empty() { opacity } else { 1.0 };
        let shades: Vec<_> = fill.shades.iter().cloned().map(Some).collect();
        plain.into_iter().chain(shades).flat_map(move |shade| {
            let area = move |rings: &Vec<Path>| Area {
                shade: shade.clone(),
                ..Area::plain(rings.clone(), color, opacity)
            };
            paths.iter().map(area).collect::<Vec<_>>()
        })
    }

    /// The shape of a layer.
    fn fill(&self, layer: &Layer, gains: &[f32]) -> Option<Fill> {
        let (field, free) = self.seen_of(layer);
        let around = Surroundings {
            page: [self.regions.width, self.regions.height].map(|v| v as f32),
            field: &field,
            depth: |at, outward| self.depth(at, outward, &free, HIDDEN),
        };
        // A contour around less than a region may have is noise of the shares.
        let least = 0.6 * colors::LEAST_AREA as f32;
        let contours = field.contours();
        let rings = contours
            .iter()
            .filter(|ring| contour::twice_area(ring).abs() > 2.0 * least);
        let rings = rings.filter_map(|contour| outline::ring(contour, outline::TOLERANCE, &around));
        self.filled(layer, rings.collect(), gains)
    }

    /// The number of pairs of pixels in which regions touch.
    pub(super) fn edges(&self) -> u32 {
        let touching = self.neighbours.iter().flat_map(BTreeMap::values);
        // Each pair counts for both of its regions.
        touching.sum::<u32>() / 2
    }

    /// The shares of pixels that a layer covers, and for each region whether it hides the layer's outline.
    fn seen_of(&self, layer: &Layer) -> (Field, Vec<bool>) {
        let regions = &self.regions;
        let covered = self.members(&layer.covers);
        // The outline is free below regions that lie on top, except where both are translucent and it would be seen.
        let is_free = |r: u32| {
            let is_above = self.rank(r).is_some_and(|rank| rank > layer.rank);
            let is_seen = self.translucent.has(layer.region) && self.translucent.has(r);
            covered[r as usize] || (is_above && !is_seen)
        };
        let free: Vec<bool> = (0..regions.list.len() as u32).map(is_free).collect();
        (self.field(layer, &covered), free)
    }

    /// The shape of a layer with these rings, if there are any.
    fn filled<R>(&self, layer: &Layer, rings: Vec<R>, gains: &[f32]) -> Option<Fill<R>> {
        let region = &self.regions.list[layer.region as usize];
        (!rings.is_empty()).then(|| Fill {
            rings,
            color: self.own_color(layer.region),
            shades: region.shades.clone(),
            region: layer.region,
            size: region.members.len() as f32,
            gain: gains[layer.region as usize],
            rank: layer.rank,
            covers: layer.covers.clone(),
            deviation: 0.0,
        })
    }

    /// The colour of a shape on a clear page, by that of the region and of what it lies on.
    fn own_color(&self, region: u32) -> Pixel {
        let color = |r: u32| self.regions.list[r as usize].color;
        let seen = color(region);
        let back = self.stack.below[region as usize].filter(|_| self.translucent.has(region));
        let own = back.and_then(|back| on_top(&seen, &color(back)));
        own.unwrap_or(seen)
    }

    /// The share of each pixel that a layer covers. At the picture's border it goes on for two pixels.
    fn field(&self, layer: &Layer, covered: &[bool]) -> Field {
        let (width, height) = (self.regions.width, self.regions.height);
        let members = layer
            .covers
            .iter()
            .flat_map(|&r| &self.regions.list[r as usize].members);
        // The box of all covered pixels, with a margin: contours need a border of zeros, and those that leave the page go on for two pixels.
        let mut low = [width, height];
        let mut high = [0, 0];
        for &i in members {
            let at = [i as usize % width, i as usize / width];
            low = [0, 1].map(|k| low[k].min(at[k]));
            high = [0, 1].map(|k| high[k].max(at[k] + 1));
        }
        let size = [width, height].map(|v| v as i32);
        let margin = |at: i32, border: i32| if at == border { 3 } else { 2 };
        let low = low.map(|v| v as i32).map(|v| v - margin(v, 0));
        let high = [0, 1].map(|k| high[k] as i32 + margin(high[k] as i32, size[k]));
        let value = |x: i32, y: i32| {
            let is_near = |v: i32, size: i32| (-2..size + 2).contains(&v);
            let is_edge = x == low[0] || y == low[1] || x == high[0] - 1 || y == high[1] - 1;
            if is_edge || !is_near(x, size[0]) || !is_near(y, size[1]) {
                return 0.0;
            }
            let [x, y] = [x.clamp(0, size[0] - 1), y.clamp(0, size[1] - 1)];
            self.regions
                .share_of(y as usize * width + x as usize, covered)
        };
        let rows = (low[1]..high[1]).flat_map(|y| (low[0]..high[0]).map(move |x| [x, y]));
        Field {
            origin: low,
            width: (high[0] - low[0]) as usize,
            values: rows.map(|[x, y]| value(x, y)).collect(),
        }
    }

    /// Farthest that an outline may lie beyond a place: as far as all that it would cover is `free`, as that lies on top.
    fn depth(&self, at: Place, outward: Place, free: &[bool], most: f32) -> f32 {
        const STEP: f32 = 0.5;
        let mut reached = 0.0;
        while reached + STEP <= most {
            let further = reached + STEP;
            let p = [0, 1].map(|k| at[k] + further * outward[k]);
            if self.share_at(p, free) <= 0.9 {
                break;
            }
            reached = further;
        }
        (reached - 1.0).max(0.0)
    }

    /// The share of `is_member` at a place between pixels; 1 outside of the picture.
    pub(super) fn share_at(&self, p: Place, is_member: &[bool]) -> f32 {
        let (width, height) = (self.regions.width, self.regions.height);
        let at = [p[0] - 0.5, p[1] - 0.5];
        if at[0] < -0.5 || at[1] < -0.5 || at[0] > width as f32 - 0.5 || at[1] > height as f32 - 0.5
        {
            return 1.0;
        }
        between(at, [width, height], |i| self.regions.share_of(i, is_member))
    }

    pub(super) fn region_count(&self) -> usize {
        self.regions.list.len()
    }

    /// The region of pixel `i`.
    pub(super) fn region(&self, i: usize) -> u32 {
        self.regions.of[i]
    }

    /// The region of pixel `i`, if it has about this colour and is not the canvas.
    pub(super) fn region_like(&self, i: usize, color: &Pixel) -> Option<u32> {
        const LIKE: f32 = 0.12;
        let region = self.regions.of[i];
        let Region {
            label,
            color: own,
            shades,
            ..
        } = &self.regions.list[region as usize];
        let is_like = away(own, color) < LIKE;
        (*label != CANVAS && shades.is_empty() && is_like).then_some(region)
    }

    /// The pixels of a region.
    pub(super) fn pixels_of(&self, region: u32) -> impl Iterator<Item = usize> + '_ {
        self.regions.list[region as usize]
            .members
            .iter()
            .map(|&i| i as usize)
    }

    /// The number of pixels of a region.
    pub(super) fn size(&self, region: u32) -> f32 {
        self.regions.list[region as usize].members.len() as f32
    }

    /// The part of a region.
    pub(super) fn part(&self, region: u32) -> Part {
        self.regions.list[region as usize].part
    }

    /// The regions that are shapes of their own, from back to front.
    pub(super) fn shapes(&self) -> impl Iterator<Item = u32> {
        self.stack.layers.iter().map(|layer| layer.region)
    }

    /// True if a shape came apart.
    pub(super) fn is_apart(&self) -> bool {
        self.regions
            .list
            .iter()
            .any(|region| region.part != Part::Whole)
    }

    /// Some regions, those together that are as near to each other as `gap`, px, and are one with the first of them.
    pub(super) fn scattered(
        &self,
        regions: &[u32],
        gap: usize,
        is_one: impl Fn(u32, u32) -> bool,
    ) -> Vec<Vec<u32>> {
        let Regions {
            width, height, of, ..
        } = &self.regions;
        let mut open: BTreeSet<u32> = regions.iter().copied().collect();
        let mut found = Vec::new();
        for &first in regions {
            if !open.remove(&first) {
                continue;
            }
            let mut shape = vec![first];
            let mut next = 0;
            while next < shape.len() {
                for &i in &self.regions.list[shape[next] as usize].members {
                    let [x, y] = [i as usize % width, i as usize / width];
                    for row in y.saturating_sub(gap)..(y + gap + 1).min(*height) {
                        let columns = x.saturating_sub(gap)..(x + gap + 1).min(*width);
                        for other in columns.map(|x| of[row * width + x]) {
                            if open.contains(&other) && is_one(first, other) {
                                open.remove(&other);
                                shape.push(other);
                            }
                        }
                    }
                }
                next += 1;
            }
            found.push(shape);
        }
        found
    }

    /// The label of a region.
    pub(super) fn label(&self, region: u32) -> u16 {
        self.regions.list[region as usize].label
    }

    /// The place of a region in the stack.
    pub(super) fn rank(&self, region: u32) -> Option<usize> {
        self.stack.ranks[region as usize]
    }

    /// True for each of some regions.
    pub(super) fn members(&self, regions: &[u32]) -> Vec<bool> {
        let mut members = vec![false; self.regions.list.len()];
        regions
            .iter()
            .for_each(|&region| members[region as usize] = true);
        members
    }

    /// The share of pixel `i` that belongs to `members`.
    pub(super) fn share(&self, i: usize, members: &[bool]) -> f32 {
        self.regions.share_of(i, members)
    }

    /// The squared error that something of a colour removes on top of all regions, where it covers some shares of
    /// pixels.
    pub(super) fn gain_on_top(
        &self,
        (color, opacity): (Rgb, f32),
        coverage: &[(usize, f32)],
    ) -> f32 {
        let gain = coverage.iter().map(|&(i, covered)| {
            let target = self.pixels.target.at(i);
            let seen = self.seen(i);
            let drawn: Pixel = std::array::from_fn(|k| match k < 3 * self.mattes {
                true => seen[k] + opacity * covered * (color[k % 3] - seen[k]),
                false => 0.0,
            });
            let weight = self.pixels.weights.map_or(1.0, |weights| weights[i]);
            weight * (distance2(&target, &seen) - distance2(&target, &drawn))
        });
        gain.sum::<f32>() / self.mattes as f32
    }

    /// Pixel `i` as its regions show it.
    fn seen(&self, i: usize) -> Pixel {
        let [own, second] = [self.regions.of[i], self.regions.second[i]].map(|r| self.shown(r, i));
        mix(&own, &second, self.regions.share[i])
    }

    /// The colour of a region at pixel `i`.
    fn shown(&self, region: u32, i: usize) -> Pixel {
        match &self.regions.list[region as usize] {
            Region { label: CANVAS, .. } => self.pixels.canvas.at(i),
            Region { color, shades, .. } if shades.is_empty() => *color,
            Region { shades, .. } => shades::shown(shades, self.pixels, i, self.mattes),
        }
    }

    /// The squared error that each region spares: without it, what is next below it would be seen.
    fn gains(&self) -> Vec<f32> {
        let regions = &self.regions;
        let below = &self.stack.below;
        // Lines that came apart are strokes: they go on beneath nothing.
        let is_lines = |region: u32| matches!(self.part(region), Part::Lines(_));
        let below_area = |region: u32| {
            let mut lower = below[region as usize];
            while let Some(lines) = lower.filter(|&lower| is_lines(lower)) {
                lower = below[lines as usize];
            }
            lower
        };
        let mut gains = vec![0.0; regions.list.len()];
        for i in 0..regions.of.len() {
            let (own, second, share) = (regions.of[i], regions.second[i], regions.share[i]);
            let seen = |region: u32| self.shown(region, i);
            let behind = |region: u32| match below_area(region) {
                Some(lower) => seen(lower),
                None => self.pixels.canvas.at(i),
            };
            let target = self.pixels.target.at(i);
            let error = |a: Pixel, b: Pixel| distance2(&target, &mix(&a, &b, share));
            let weight = self.pixels.weights.map_or(1.0, |weights| weights[i]);
            let drawn = error(seen(own), seen(second));
            let [own, second] = [own, second].map(|r| self.translucent.shape(r));
            gains[own as usize] += weight * (error(behind(own), seen(second)) - drawn);
            if share > 0.0 {
                gains[second as usize] += weight * (error(seen(own), behind(second)) - drawn);
            }
        }
        gains
    }
}

/// The rings around what covers at least half of a pixel; `shares` are those of all pixels of a page, row by row. They are
/// as exact as `tolerance` px, or as those of areas.
pub(super) fn rings(shares: &[f32], width: usize, tolerance: f32) -> Vec<Path> {
    let height = shares.len() / width;
    let framed = width + 2;
    let mut values = vec![0.0; framed * (height + 2)];
    for (row, shares) in values
        .chunks_exact_mut(framed)
        .skip(1)
        .zip(shares.chunks_exact(width))
    {
        row[1..=width].copy_from_slice(shares);
    }
    let field = Field {
        origin: [-1; 2],
        width: framed,
        values,
    };
    let around = Surroundings {
        page: [width, height].map(|side| side as f32),
        field: &field,
        depth: |_, _| 0.0,
    };
    let contours = field.contours();
    let rings = contours.iter();
    rings
        .filter_map(|contour| outline::ring(contour, tolerance.max(outline::TOLERANCE), &around))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_are_of_texture_where_there_are_many_for_the_picture() {
        // Two regions with one border.
        let is_texture = |border: u32, pixels| {
            let neighbours = [(1, border), (0, border)].map(|of| BTreeMap::from([of]));
            are_of_texture(&neighbours, pixels)
        };
        assert!(!is_texture(40_000, 100_000), "a small picture of lines");
        assert!(is_texture(60_000, 400_000));
        assert!(!is_texture(60_000, 1_000_000), "a large drawing");
    }
}
