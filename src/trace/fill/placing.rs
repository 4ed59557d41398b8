//! Placing: shapes and lines where their edges are seen, by [`edge`].

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::super::areas::{LEVEL, Pixel, away};
use super::super::contour::Field;
use super::super::edge::{self, Ring};
use super::super::ink;
use super::colors::CANVAS;
use super::compound::{self, Fill};
use super::mixtures::mixed;
use super::regions::{Region, Regions};
use super::stack::Layer;
use super::{Filled, Flat};
use crate::math::{self, Point};

/// Farthest that shapes go on beyond the picture's border, px. A guess: twice what fields do.
const BEYOND: f64 = 4.0;
/// Standard deviation of the share of a pixel that renderers say an edge covers: resvg takes 16 samples, and is off by 0.05 in the
/// mean of squares. Of 16 icons of 128, 256 and 512 px, 0.01, 0.05 and 0.12 leave a mean colour error of 0.0075, 0.011 and 0.016
/// ΔE00 with 1.00, 0.91 and 0.86 times the artist's numbers.
const RENDERED: f64 = 0.05;
/// Edges whose pixels deviate by less from what is described, shares, are where they are seen. A guess: where colours are few they deviate
/// by 0.05 to 0.1, between the steps of gradients by 0.2 to 8.
const SURE: f64 = 0.2;
/// A region of as many pixels may be the tip of a line, which is pale as it is thin. A guess.
pub(in crate::trace) const TIP: f32 = 40.0;
/// Farthest that the tip of a line goes on as it gets paler, px. A guess.
const PALE: i32 = 12;
/// How far lines that the picture's border cuts go on beyond it, px.
const BORDER: i32 = 3;
/// Root of the squared error below which a pixel is a mixture of an ink and what it lies on.
const MIXED: f32 = 8.0 * LEVEL;
/// Least share of a pixel that is not hidden for it to tell something of what is seen there. A guess.
const LEAST_SEEN: f32 = 0.03;

/// The stack of a picture, and what tells how well its edges are seen.
pub(in crate::trace) struct Placing<'a> {
    flat: &'a Flat<'a>,
    spreads: Vec<f64>,
    gains: Vec<f32>,
}

/// What is seen of some shapes: the share of each pixel that they cover, its standard deviation, and their rings.
struct Seen {
    field: Field,
    doubts: Vec<f64>,
    rings: Vec<Ring>,
}

impl Seen {
    /// Lines along middles that draw it, if edges tell where they are and their description is shorter than that of the rings.
    fn lines(&self, middles: &[edge::Middle]) -> Option<Vec<edge::Line>> {
        let lines = edge::lines(&self.field, &self.doubts, middles, &self.rings)?;
        let [by_lines, by_rings] = lines.lengths;
        (by_lines < by_rings && lines.deviation < SURE).then_some(lines.lines)
    }
}

impl<'a> Placing<'a> {
    pub(in crate::trace) fn of(flat: &'a Flat<'a>) -> Self {
        Self {
            flat,
            spreads: spreads(flat),
            gains: flat.gains(),
        }
    }

    /// The shapes of the stack, from back to front; `None` if colours do not tell where the edges of one are that has to be sure.
    pub(in crate::trace) fn fills(
        &self,
        has_to_be_sure: impl Fn(u32) -> bool + Sync,
    ) -> Option<Vec<Fill<Ring>>> {
        let layers = self.flat.stack.layers.par_iter();
        let fills = layers.map(|layer| match has_to_be_sure(layer.region) {
            true => self.fill(layer, SURE),
            false => self.fill(layer, f64::INFINITY),
        });
        let fills = fills.collect::<Option<Vec<Option<Fill<Ring>>>>>()?;
        Some(fills.into_iter().flatten().collect())
    }

    /// The areas of shapes, those of one colour joined, from back to front, beside so many strokes. Those of `left_out` regions are
    /// not drawn.
    pub(in crate::trace) fn areas(
        &self,
        fills: &[Fill<Ring>],
        left_out: &[bool],
        strokes: usize,
    ) -> Vec<Filled> {
        let fills = fills.iter().filter(|fill| !left_out[fill.region as usize]);
        let fills: Vec<Fill<Ring>> = fills.cloned().collect();
        let joined = self.flat.joined(fills);
        let is_only = joined.len() == 1;
        let mut room = self
            .flat
            .tracing
            .most
            .saturating_sub(joined.len() + strokes);
        self.flat
            .painted(&joined, |rings| compound::paths(rings, is_only, &mut room))
    }

    /// True if colours tell where the edges of shapes are, but of those that are `left_out`.
    pub(in crate::trace) fn is_sure(
        &self,
        fills: &[Fill<Ring>],
        left_out: impl Fn(&Fill<Ring>) -> bool,
    ) -> bool {
        fills
            .iter()
            .filter(|fill| !left_out(fill))
            .map(|fill| fill.deviation)
            .all(|deviation| deviation < SURE)
    }

    /// The shape of a layer by its edges, if there is one; `None` if these deviate by `most` or more.
    fn fill(&self, layer: &Layer, most: f64) -> Option<Option<Fill<Ring>>> {
        let flat = self.flat;
        let (width, height) = (flat.regions.width, flat.regions.height);
        let (mut field, mut hides) = flat.seen_of(layer);
        hides[layer.region as usize] = false;
        let shown = flat.members(&[layer.region]);
        let doubts = self.doubts(&mut field, (&shown, &hides));
        // Beyond its border the picture hides what it cuts, but shapes do not go on far.
        let far = |at: f64, size: usize| !(-BEYOND..size as f64 + BEYOND).contains(&at);
        let hidden = |p: Point| match far(p.x, width) || far(p.y, height) {
            true => 0.0,
            false => flat.share_at(math::xy(p), &hides),
        };
        let (rings, deviation) = edge::rings(&field, &doubts, hidden, most)?;
        let fill = flat.filled(layer, rings, &self.gains);
        Some(fill.map(|fill| Fill { deviation, ..fill }))
    }

    /// Lines along middles that draw what some shapes show; `None` where colours do not tell where they are, or if the shapes have a
    /// shorter description.
    pub(in crate::trace) fn lines(
        &self,
        fills: &[&Fill<Ring>],
        middles: &[edge::Middle],
    ) -> Option<Vec<edge::Line>> {
        self.seen(fills)?.lines(middles)
    }

    /// Lines of varying width that draw what some shapes show; `None` if these have a shorter description.
    pub(in crate::trace) fn ink(&self, fills: &[&Fill<Ring>]) -> Option<Vec<edge::Line>> {
        let seen = self.inked(fills)?;
        seen.lines(&ink::middles(&seen.field)?)
    }

    /// What is seen of some shapes in the ink of the first one, which may be pale on what that lies on where they are thin.
    fn inked(&self, fills: &[&Fill<Ring>]) -> Option<Seen> {
        let flat = self.flat;
        let regions = &flat.regions;
        let size = [regions.width, regions.height].map(|v| v as i32);
        let main = fills.first()?.region;
        let back = flat.stack.below[main as usize];
        let ids: Vec<u32> = fills.iter().map(|fill| fill.region).collect();
        let is_own = flat.members(&ids);
        // 1. The box of all, with what may be too pale to be one of them.
        let own = ids.iter().flat_map(|&r| &regions.list[r as usize].members);
        let (mut low, mut high) = (size, [0; 2]);
        for &i in own {
            let at = [i as usize % regions.width, i as usize / regions.width].map(|v| v as i32);
            low = [0, 1].map(|k| low[k].min(at[k]));
            high = [0, 1].map(|k| high[k].max(at[k] + 1));
        }
        let low = low.map(|v| (v - PALE).max(-BORDER));
        let high = [0, 1].map(|k| (high[k] + PALE).min(size[k] + BORDER));
        // 2. Each pixel is a mixture of the ink and what it lies on, or it shows something else.
        let share = |[x, y]: [i32; 2]| {
            let is_edge = x == low[0] || y == low[1] || x + 1 == high[0] || y + 1 == high[1];
            if is_edge {
                return (0.0, f64::INFINITY);
            }
            // At the picture's border lines go on.
            let [column, row] = [0, 1].map(|k| [x, y][k].clamp(0, size[k] - 1));
            let is_beyond = [column, row] != [x, y];
            let i = row as usize * regions.width + column as usize;
            let region = regions.of[i];
            let target = flat.pixels.target.at(i);
            let [below, ink] = self.inks(main, i);
            let (share, error) = mixed(&target, &below, &ink);
            let is_between = |region: u32| {
                let is_back = match back {
                    Some(back) => back == region,
                    None => flat.label(region) == CANVAS,
                };
                is_own[region as usize] || is_back || flat.size(region) <= TIP
            };
            if !is_between(region) || !is_between(regions.second[i]) || error > MIXED * MIXED {
                let own = f32::from(u8::from(is_own[region as usize]));
                return (own, f64::INFINITY);
            }
            let contrast = f64::from(away(&below, &ink)).max(0.01);
            let noise = f64::from(flat.doubts[i].max(0.3) * LEVEL);
            let noise = noise.max(self.spreads[main as usize]);
            let doubt = math::hypot(
                RENDERED,
                math::hypot(noise, f64::from(error.sqrt())) / contrast,
            );
            (share, if is_beyond { f64::INFINITY } else { doubt })
        };
        let places = (low[1]..high[1]).flat_map(|y| (low[0]..high[0]).map(move |x| [x, y]));
        let (values, doubts) = places.map(share).unzip();
        let rings = fills.iter().flat_map(|fill| fill.rings.iter().cloned());
        Some(Seen {
            field: Field {
                origin: low,
                width: (high[0] - low[0]) as usize,
                values,
            },
            doubts,
            rings: rings.collect(),
        })
    }

    /// True if a region may be the tip of a line in the colour of another one: it is small, and a mixture of that colour and what that
    /// lies on.
    pub(in crate::trace) fn is_tip_of(&self, region: u32, line: u32) -> bool {
        let region = &self.flat.regions.list[region as usize];
        let [below, ink] = self.inks(line, region.members[0] as usize);
        let (_, error) = mixed(&region.color, &below, &ink);
        region.members.len() as f32 <= TIP && error < MIXED * MIXED
    }

    /// The colours at pixel `i` of what a region lies on, and of the region.
    fn inks(&self, region: u32, i: usize) -> [Pixel; 2] {
        let flat = self.flat;
        let below = match flat.stack.below[region as usize] {
            Some(back) => flat.shown(back, i),
            None => flat.pixels.canvas.at(i),
        };
        [below, flat.shown(region, i)]
    }

    /// What is seen of some shapes.
    fn seen(&self, fills: &[&Fill<Ring>]) -> Option<Seen> {
        let regions: Vec<u32> = fills.iter().map(|fill| fill.region).collect();
        let covers = fills.iter().flat_map(|fill| &fill.covers);
        let covers: BTreeSet<u32> = covers.copied().collect();
        let layer = Layer {
            region: *regions.first()?,
            rank: fills.iter().map(|fill| fill.rank).min()?,
            covers: covers.into_iter().collect(),
        };
        // What lies on top hides a line, and so does what has its colour.
        let (mut field, mut hides) = self.flat.seen_of(&layer);
        let label = self.flat.label(layer.region);
        let others = hides.iter_mut().zip(&self.flat.regions.list);
        others.for_each(|(hides, other)| *hides |= other.label == label);
        regions.iter().for_each(|&r| hides[r as usize] = false);
        let shown = self.flat.members(&regions);
        let doubts = self.doubts(&mut field, (&shown, &hides));
        let rings = fills.iter().flat_map(|fill| fill.rings.iter().cloned());
        let rings: Vec<Ring> = rings.collect();
        Some(Seen {
            field,
            doubts,
            rings,
        })
    }

    /// The standard deviation of the share of each pixel of a field, and, where something `hides` a part of the pixel, that share: all
    /// of what is seen there, if it is `shown`, or nothing. Where nothing is seen, the deviation is infinite.
    fn doubts(&self, field: &mut Field, (shown, hides): (&[bool], &[bool])) -> Vec<f64> {
        let flat = self.flat;
        let regions = &flat.regions;
        let (origin, width) = (field.origin, field.width);
        let height = field.values.len() / width;
        let doubt = |(k, value): (usize, &mut f32)| {
            let [column, row] = [k % width, k / width];
            // Contours need a border of zeros.
            let is_border = column == 0 || row == 0 || column + 1 == width || row + 1 == height;
            let [x, y] = [origin[0] + column as i32, origin[1] + row as i32];
            if x < 0 || y < 0 || x as usize >= regions.width || y as usize >= regions.height {
                return f64::INFINITY;
            }
            let i = y as usize * regions.width + x as usize;
            let (own, second) = (regions.of[i], regions.second[i]);
            let hidden = regions.share_of(i, hides);
            if 1.0 - hidden < LEAST_SEEN {
                return f64::INFINITY;
            }
            let seen = match hides[own as usize] {
                true => second,
                false => own,
            };
            if hidden > 0.0 && !is_border {
                *value = f32::from(u8::from(shown[seen as usize]));
            }
            // A pixel of one region tells by its colour that none of its neighbours' is there.
            let others = match own == second {
                true => beside(regions, i),
                false => vec![second],
            };
            let others = others.into_iter().map(|other| {
                let contrast = f64::from(away(&flat.shown(own, i), &flat.shown(other, i)));
                let spread = |r: u32| self.spreads[r as usize];
                (contrast, spread(own).max(spread(other)))
            });
            let (contrast, spread) = others
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((1.0, 0.0));
            let noise = f64::from(flat.doubts[i].max(0.3) * LEVEL).max(spread);
            // What two colours do not explain may be a third one.
            let rest = f64::from(away(&flat.pixels.target.at(i), &flat.seen(i)));
            let rest = if own == second { 0.0 } else { rest };
            math::hypot(RENDERED, math::hypot(noise, rest) / contrast.max(0.01))
                / f64::from(1.0 - hidden)
        };
        field.values.iter_mut().enumerate().map(doubt).collect()
    }
}

/// The regions that the pixels beside a pixel belong to, but its own.
fn beside(regions: &Regions, i: usize) -> Vec<u32> {
    let Regions {
        width, height, of, ..
    } = regions;
    let [x, y] = [i % width, i / width];
    let beside = [
        (x > 0).then(|| i - 1),
        (x + 1 < *width).then_some(i + 1),
        (y > 0).then(|| i - width),
        (y + 1 < *height).then_some(i + width),
    ];
    let beside = beside.into_iter().flatten().map(|k| of[k]);
    beside.filter(|r| *r != of[i]).collect()
}

/// How far the colours of the pixels of each region are from what is shown of it, in the mean of squares.
fn spreads(flat: &Flat<'_>) -> Vec<f64> {
    let spread = |(region, r): (&Region, u32)| {
        let own = region.members.iter().map(|&i| i as usize);
        let pure = own.filter(|&i| flat.regions.share[i] == 0.0);
        let (sum, count) = pure.fold((0.0, 0.0), |(sum, count): (f64, f64), i| {
            let away = away(&flat.pixels.target.at(i), &flat.shown(r, i));
            (sum + f64::from(away * away), count + 1.0)
        });
        (sum / count.max(1.0)).sqrt()
    };
    let numbered: Vec<(&Region, u32)> = flat.regions.list.iter().zip(0..).collect();
    numbered.into_par_iter().map(spread).collect()
}
