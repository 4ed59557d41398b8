//! Shades: the gradient that a picture, or a part of it, is of.
//!
//! Two axes are tried, a line and a radius, on the means of some thousand blocks. Level lines of a shade run across the line, or
//! around the centre. So the colours' gradients point along the line, or through the centre, which gives both in closed form. A
//! pattern search then makes the blocks at equal offsets as equal as possible. Last come the stops: the best colours for given
//! offsets are a linear least-squares problem, and offsets are added as long as they remove a share of the error. All of this is
//! repeated on the blocks that the last shade has met, so that things in front of the shade do not bend it.

mod axis;
mod profile;
mod stack;

use crate::math::Point;
use crate::scene::{Axis, Shade};
pub(crate) use stack::stacked;

/// A block is met by a gradient if no channel is farther from it than this. A guess.
pub(crate) const NEAR: f32 = 3.0 / 255.0;

/// A gradient that meets less than this share of the blocks is not refined any further. A guess.
const HOPELESS_SHARE: f32 = 0.1;
/// Tolerances of the fits of a gradient, in units of [`NEAR`], each to the blocks that the last fit has met. A guess.
const ROUNDS: [f32; 4] = [1.0; 4];

/// Premultiplied colour, and opacity.
pub(crate) type Value = [f32; 4];

/// The mean of a square of the picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block {
    pub(crate) center: Point,
    pub(crate) value: Value,
    /// 1, or 0 for a block that does not take part.
    pub(crate) weight: f32,
}

/// The means of squares of a part of the picture, row by row.
pub(crate) struct Blocks {
    pub(crate) columns: usize,
    pub(crate) all: Vec<Block>,
    /// The corner of the part with the least coordinates, and its size, px.
    pub(crate) low: [f64; 2],
    pub(crate) size: [f64; 2],
}

/// Mean offset along an axis, number and mean value of a group of blocks.
#[derive(Debug, Clone, Copy, Default)]
struct Group {
    offset: f64,
    count: f64,
    value: [f64; 4],
}

/// A place between the offsets of two neighbours: their indices, which are equal beyond the first and the last, and the part of
/// the way from one to the other.
#[derive(Debug, Clone, Copy)]
struct Between {
    ends: [usize; 2],
    part: f64,
}

impl Between {
    /// The place of `at` among rising offsets, of which there is one at least.
    fn of(offsets: &[f64], at: f64) -> Self {
        let after = offsets.partition_point(|&offset| offset <= at);
        let ends = [after.saturating_sub(1), after.min(offsets.len() - 1)];
        let [from, to] = ends.map(|i| offsets[i]);
        let part = if to > from {
            (at - from) / (to - from)
        } else {
            0.0
        };
        Self { ends, part }
    }

    /// The value here, linear between the values of the neighbours.
    fn value(self, of: impl Fn(usize) -> f64) -> f64 {
        let [from, to] = self.ends.map(of);
        from + self.part * (to - from)
    }
}

/// Likeness of blocks to a shade.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Met {
    /// Share of the blocks that it has met, among the blocks that take part.
    pub(crate) share: f32,
    /// Squared error, each value cut off at the error of a block that just fails.
    pub(crate) error: f32,
}

impl Blocks {
    /// The blocks of a page, at most `most` along its longer side, and the side of one, px. `value` gives the value of a block
    /// from the indices of its pixels, row by row. Blocks without a value do not take part.
    pub(crate) fn of_page(
        [width, height]: [usize; 2],
        most: usize,
        value: impl Fn(&[usize]) -> Option<Value>,
    ) -> (Self, usize) {
        let side = width.max(height).div_ceil(most).max(1);
        let [columns, rows] = [width, height].map(|pixels| pixels.div_ceil(side));
        let block = |k: usize| {
            let [x, y] = [k % columns * side, k / columns * side];
            let [right, below] = [(x + side).min(width), (y + side).min(height)];
            let pixels = (y..below).flat_map(|y| (x..right).map(move |x| y * width + x));
            let value = value(&pixels.collect::<Vec<_>>());
            Block {
                center: Point::new((x + right) as f64 / 2.0, (y + below) as f64 / 2.0),
                value: value.unwrap_or_default(),
                weight: if value.is_some() { 1.0 } else { 0.0 },
            }
        };
        let blocks = Self {
            columns,
            all: (0..columns * rows).map(block).collect(),
            low: [0.0; 2],
            size: [width as f64, height as f64],
        };
        (blocks, side)
    }

    /// The blocks that take part.
    fn taking_part(&self) -> impl Iterator<Item = &Block> {
        self.all.iter().filter(|block| block.weight > 0.0)
    }

    /// The blocks that take part, in at most so many groups of similar offsets along an axis, by rising offset.
    fn grouped(&self, axis: Axis, most: usize) -> Vec<Group> {
        let mut groups = vec![Group::default(); most];
        for block in self.taking_part() {
            let offset = axis.offset(block.center).clamp(0.0, 1.0);
            let group = &mut groups[((offset * most as f64) as usize).min(most - 1)];
            group.count += 1.0;
            group.offset += offset;
            let sums = group.value.iter_mut().zip(block.value);
            sums.for_each(|(sum, v)| *sum += f64::from(v));
        }
        groups.retain(|group| group.count > 0.0);
        for group in &mut groups {
            group.offset /= group.count;
            group.value = group.value.map(|sum| sum / group.count);
        }
        groups
    }

    /// The linear or radial shade that meets most blocks, if the blocks seem to lie along one.
    pub(crate) fn best_shade(&self) -> Option<(Shade, Met)> {
        self.best_of(&ROUNDS)
    }

    /// As [`Self::best_shade`], fitted so many times, each time to the blocks that the last shade has met within this factor of
    /// what is near.
    fn best_of(&self, factors: &[f32]) -> Option<(Shade, Met)> {
        // Fit both kinds: no cheap test says which one a picture has. The share of blocks that are met decides.
        let candidates = [axis::Kind::Linear, axis::Kind::Radial];
        let candidates = candidates.map(|kind| self.shade(kind, factors));
        let met = |shade: Shade| {
            let met = self.met(NEAR, |block| premultiplied(&shade, block.center));
            (shade, met)
        };
        let candidates = candidates.into_iter().flatten().map(met);
        candidates.max_by(|(_, a), (_, b)| a.share.total_cmp(&b.share))
    }

    /// The shade of this kind, if there is an axis and the blocks seem to lie along it.
    fn shade(&self, kind: axis::Kind, factors: &[f32]) -> Option<Shade> {
        let mut blocks = Self {
            all: self.all.clone(),
            ..*self
        };
        let mut found = None;
        for factor in factors {
            let near = factor * NEAR;
            // Axis, then stops along it, both from the blocks that the last round has met; the first round takes all.
            let axis = blocks.seen(axis::of(&blocks, kind)?);
            let shade = profile::of(&blocks, axis)?;
            // Judge all blocks, so that one that the last round has dropped may come back.
            let met = self.met(near, |block| premultiplied(&shade, block.center));
            if met.share < HOPELESS_SHARE {
                return None;
            }
            // Blocks off the shade are things in front of it. Without them the next fit is closer to the shade behind.
            for block in &mut blocks.all {
                let meets = is_near(near, block, premultiplied(&shade, block.center));
                block.weight = if meets { 1.0 } else { 0.0 };
            }
            found = Some(shade);
        }
        found
    }

    /// Likeness of the blocks to a value by place, where values `near` each other are alike.
    pub(crate) fn met(&self, near: f32, value: impl Fn(&Block) -> Value) -> Met {
        let mut met = Met {
            share: 0.0,
            error: 0.0,
        };
        let count = self.taking_part().count() as f32;
        for block in self.taking_part() {
            let value = value(block);
            if is_near(near, block, value) {
                met.share += 1.0 / count;
            }
            // Errors are cut off: a thing in front of the shade counts by its size, and not by its contrast.
            let most = near * near;
            let errors = block
                .value
                .iter()
                .zip(value)
                .map(|(a, b)| (a - b) * (a - b));
            met.error += errors.map(|error| error.min(most)).sum::<f32>();
        }
        met
    }

    /// The colours' gradients at each block that takes part with its neighbours, per px: by x and by y, for each channel.
    fn slopes(&self) -> impl Iterator<Item = (Point, [[f32; 2]; 4])> {
        let (columns, rows) = (self.columns, self.all.len() / self.columns);
        let inner = (1..rows.saturating_sub(1))
            .flat_map(move |y| (1..columns.saturating_sub(1)).map(move |x| y * columns + x));
        inner.filter_map(|i| {
            // Central differences. A block beside one that does not take part has none.
            let near = [i - 1, i + 1, i - self.columns, i + self.columns];
            let [left, right, above, below] = near.map(|i| self.all[i]);
            let weights = [left, right, above, below, self.all[i]].map(|block| block.weight);
            if weights.contains(&0.0) {
                return None;
            }
            let slope = |c: usize| {
                [
                    (right.value[c] - left.value[c]) / (right.center.x - left.center.x) as f32,
                    (below.value[c] - above.value[c]) / (below.center.y - above.center.y) as f32,
                ]
            };
            Some((self.all[i].center, [0, 1, 2, 3].map(slope)))
        })
    }

    /// The axis without its ends where no block takes part, since no data give the colours there.
    fn seen(&self, axis: Axis) -> Axis {
        // About a block.
        const NEAR: f64 = 0.03;
        // The range of offsets in which there are blocks.
        let (mut first, mut last) = (1.0_f64, 0.0_f64);
        let offset = |block: &Block| axis.offset(block.center).clamp(0.0, 1.0);
        for offset in self.taking_part().map(offset) {
            (first, last) = (first.min(offset), last.max(offset));
        }
        let first = if first > NEAR { first } else { 0.0 };
        let last = if last < 1.0 - NEAR { last } else { 1.0 };
        match axis {
            // A line loses both ends. A radial axis starts at its centre, so it loses the outer end alone.
            Axis::Linear { from, to } if last > first => Axis::Linear {
                from: from + (to - from) * first,
                to: from + (to - from) * last,
            },
            Axis::Radial { center, radius } if last > 0.0 => Axis::Radial {
                center,
                radius: radius * last,
            },
            axis => axis,
        }
    }

    /// The smallest and the largest offset of the part along `axis`.
    fn extent(&self, axis: Axis) -> [f64; 2] {
        let [left, top] = self.low;
        let [right, bottom] = [0, 1].map(|k| self.low[k] + self.size[k]);
        // On a line an offset is linear in the place, and from a centre it is convex, so the largest is at a corner. The smallest
        // is used of lines alone.
        let corners = [[left, top], [right, top], [left, bottom], [right, bottom]];
        let offsets = corners.map(|[x, y]| axis.offset(Point::new(x, y)));
        [
            offsets.iter().copied().fold(f64::INFINITY, f64::min),
            offsets.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ]
    }
}

fn is_near(near: f32, block: &Block, value: Value) -> bool {
    let apart = block.value.iter().zip(value).map(|(a, b)| (a - b).abs());
    apart.fold(0.0, f32::max) <= near
}

/// Premultiplied colour and opacity of a shade at a place.
pub(crate) fn premultiplied(shade: &Shade, at: Point) -> Value {
    let ([r, g, b], opacity) = shade.at(at);
    [r * opacity, g * opacity, b * opacity, opacity]
}
