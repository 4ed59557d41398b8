//! The gradients of smooth places.
//!
//! A place is smooth where values go on as they come: its second differences are those of rounding. A connected smooth part
//! becomes a shade if one gradient meets nearly all of it, and no single colour does so nearly as well. Where one colour has a
//! good part, as a page around a glow, that colour is taken away, and what is left is looked at again.

use rayon::prelude::*;

use super::super::areas::{LEVEL, Pixel, Pixels, away};
use crate::image::flooded;
use crate::math::{self, Point};
use crate::scene::Shade;
use crate::shading::{self, Block, Blocks, Value, stacked};

/// A pixel of no shade.
const NONE: u16 = u16::MAX;

// All of these are guesses.
/// Most gradients of a picture.
const MOST: usize = 64;
/// Largest second difference of smooth pixels, levels: that of rounding is 2.
const BEND: f32 = 3.0;
/// Steepest step from pixel to pixel of one gradient, levels.
const STEEPEST: f32 = 14.0;
/// Fewest pixels of a gradient.
const LEAST_PIXELS: usize = 40;
/// Least range of its values, levels.
const LEAST_RANGE: f32 = 12.0;
/// Blocks along the longer side of a part, whose means are fitted.
const BLOCKS: usize = 40;
/// The share of the blocks that a gradient has to meet.
const LEAST_SHARE: f32 = 0.9;
/// Share of the blocks that it has to meet beyond those of a single colour.
const LEAST_GAIN: f32 = 0.25;
/// Most gradients on top of each other.
const MOST_STACKED: usize = 3;
/// Fewest pixels of a part that may have several.
const LEAST_STACKED: usize = 2000;
/// A colour with this share of a part is taken away from it if no gradient is found.
const FLAT_SHARE: f32 = 0.25;
/// Most times that colours are taken away.
const ROUNDS: usize = 4;
/// Pixels that differ by less are of one colour: rounding.
const FLAT: f32 = 1.5 * LEVEL;

/// The shades of a picture.
pub(super) struct Shaded {
    /// Each as gradients on top of each other, back to front.
    pub(super) list: Vec<Vec<Shade>>,
    /// The shade of each pixel, by its index.
    of: Vec<u16>,
}

/// Meaning of a smooth part.
enum Found {
    /// The shade of this index.
    Shade(u16),
    /// This colour, and something else.
    Color(Pixel),
    Nothing,
}

impl Shaded {
    /// None: a picture of colours alone.
    pub(super) fn none(pixels: &Pixels<'_>) -> Self {
        Self {
            list: Vec::new(),
            of: vec![NONE; pixels.width * pixels.height],
        }
    }

    /// The shades of the smooth parts of a picture on so many mattes.
    pub(super) fn of(pixels: &Pixels<'_>, mattes: usize) -> Self {
        let mut shaded = Self::none(pixels);
        let mut open = smooth_pixels(pixels);
        for _ in 0..ROUNDS {
            let mut is_over = true;
            for mut part in parts(pixels, &open) {
                match shaded.judge(pixels, &part, mattes) {
                    Found::Shade(index) => shaded.take(pixels, &part, mattes, index),
                    Found::Color(color) => {
                        let is_of = |&i: &usize| away(&pixels.target.at(i), &color) < FLAT;
                        part.retain(is_of);
                        is_over = false;
                    }
                    Found::Nothing => {}
                }
                // What is known is not looked at again.
                part.into_iter().for_each(|i| open[i] = false);
            }
            if is_over {
                break;
            }
        }
        shaded
    }

    /// The index of the shade of pixel `i`.
    pub(super) fn at(&self, i: usize) -> Option<u16> {
        Some(self.of[i]).filter(|&shade| shade != NONE)
    }

    /// Tells what a part is: a known shade goes on, or it has one of its own.
    fn judge(&mut self, pixels: &Pixels<'_>, part: &[usize], mattes: usize) -> Found {
        let blocks = blocks(pixels, part, mattes);
        let near = shading::NEAR;
        let share = |shades: &Vec<Shade>| {
            let met = blocks.met(near + LEVEL, |block| stacked(shades, block.center));
            met.share
        };
        // A shade that things in front have cut in parts is one.
        let known = self.list.iter();
        let known = known.map(share).position(|share| share >= LEAST_SHARE);
        if let Some(index) = known {
            return Found::Shade(index as u16);
        }
        // A gradient has to explain more than the usual colour does: a page with a few ramps is none.
        let (color, count) = usual(pixels, part);
        let flat = value(&color, mattes);
        let alone = blocks.met(near, |_| flat).share;
        // A small part is hardly several.
        let most = if part.len() < LEAST_STACKED {
            1
        } else {
            MOST_STACKED
        };
        let found = blocks.best_shades(LEAST_SHARE, most);
        let found =
            found.filter(|(_, met)| met.share >= LEAST_SHARE && met.share >= alone + LEAST_GAIN);
        match found {
            Some((shades, _)) if self.list.len() < MOST => {
                self.list.push(shades);
                Found::Shade(self.list.len() as u16 - 1)
            }
            _ if count as f32 > FLAT_SHARE * part.len() as f32 => Found::Color(color),
            _ => Found::Nothing,
        }
    }

    /// Gives the pixels of a part that a shade meets to it, and those around that it meets as well: where a gradient ends
    /// within a shape, the rest is not smooth there.
    fn take(&mut self, pixels: &Pixels<'_>, part: &[usize], mattes: usize, index: u16) {
        let shades = &self.list[usize::from(index)];
        let is_met = |i: usize| {
            let seen = shown(shades, pixels, i, mattes);
            away(&pixels.target.at(i), &seen) <= shading::NEAR + LEVEL
        };
        let taken: Vec<usize> = part.iter().copied().filter(|&i| is_met(i)).collect();
        taken.iter().for_each(|&i| self.of[i] = index);
        flooded(taken, [pixels.width, self.of.len()], |_, k| {
            let joins = self.of[k] == NONE && is_met(k);
            if joins {
                self.of[k] = index;
            }
            joins
        });
    }
}

/// Shades on top of each other at pixel `i`, on each matte.
pub(super) fn shown(shades: &[Shade], pixels: &Pixels<'_>, i: usize, mattes: usize) -> Pixel {
    let (x, y) = (i % pixels.width, i / pixels.width);
    let center = Point::new(x as f64 + 0.5, y as f64 + 0.5);
    let [red, green, blue, opacity] = stacked(shades, center);
    // The mattes are black and white, or the page is opaque.
    let through = if mattes > 1 { 1.0 - opacity } else { 0.0 };
    let mut pixel = [red, green, blue, 0.0, 0.0, 0.0];
    if mattes > 1 {
        [pixel[3], pixel[4], pixel[5]] = [red, green, blue].map(|v| v + through);
    }
    pixel
}

/// Premultiplied colour and opacity of a pixel on black and white, or on a page.
fn value(pixel: &Pixel, mattes: usize) -> Value {
    let opacity = match mattes {
        1 => 1.0,
        _ => 1.0 - (0..3).map(|k| pixel[k + 3] - pixel[k]).sum::<f32>() / 3.0,
    };
    [pixel[0], pixel[1], pixel[2], opacity]
}

/// True for each pixel whose neighbours on opposite sides have it about in their middle.
fn smooth_pixels(pixels: &Pixels<'_>) -> Vec<bool> {
    let (width, height) = (pixels.width, pixels.height);
    let bend = BEND * LEVEL;
    let mut smooth = vec![true; width * height];
    let rows = smooth.par_chunks_exact_mut(width).enumerate();
    rows.for_each(|(y, row)| {
        for plane in &pixels.target.0 {
            for (x, smooth) in row.iter_mut().enumerate() {
                let i = y * width + x;
                let is_inner = [x > 0 && x + 1 < width, y > 0 && y + 1 < height];
                let steps = [1, width, width + 1, width - 1];
                let is_there = [
                    is_inner[0],
                    is_inner[1],
                    is_inner[0] && is_inner[1],
                    is_inner[0] && is_inner[1],
                ];
                let bends = |(step, is_there): (usize, bool)| {
                    is_there && (plane[i - step] + plane[i + step] - 2.0 * plane[i]).abs() > bend
                };
                *smooth &= !steps.into_iter().zip(is_there).any(bends);
            }
        }
    });
    smooth
}

/// The connected parts of the open pixels that are large and not of one colour, the largest first.
fn parts(pixels: &Pixels<'_>, open: &[bool]) -> Vec<Vec<usize>> {
    let steepest = STEEPEST * LEVEL;
    let mut is_seen: Vec<bool> = open.iter().map(|open| !open).collect();
    let mut parts = Vec::new();
    for start in 0..open.len() {
        if is_seen[start] {
            continue;
        }
        is_seen[start] = true;
        let value = |i: usize| pixels.target.at(i);
        let part = flooded(vec![start], [pixels.width, open.len()], |i, k| {
            let joins = !is_seen[k] && away(&value(k), &value(i)) <= steepest;
            is_seen[k] |= joins;
            joins
        });
        // Flat parts are colours, and small ones tell no axis.
        let ends = |k: usize| {
            let own = part.iter().map(move |&i| value(i)[k]);
            own.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| {
                [low.min(v), high.max(v)]
            })
        };
        let range = |k: usize| ends(k)[1] - ends(k)[0];
        let is_large = part.len() >= LEAST_PIXELS;
        if is_large && (0..6).map(range).fold(0.0, f32::max) >= LEAST_RANGE * LEVEL {
            parts.push(part);
        }
    }
    parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
    parts.truncate(MOST);
    parts
}

/// The means of blocks of a part.
fn blocks(pixels: &Pixels<'_>, part: &[usize], mattes: usize) -> Blocks {
    let place = |i: usize| [i % pixels.width, i / pixels.width];
    let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
    for at in part.iter().map(|&i| place(i)) {
        low = [0, 1].map(|k| low[k].min(at[k]));
        high = [0, 1].map(|k| high[k].max(at[k] + 1));
    }
    let size = [0, 1].map(|k| high[k] - low[k]);
    let side = size[0].max(size[1]).div_ceil(BLOCKS).max(1);
    let [columns, rows] = size.map(|v| v.div_ceil(side));
    // Sums over the pixels of the part in each block, and their number.
    let mut sums = vec![([0.0_f32; 4], 0.0_f32); columns * rows];
    for &i in part {
        let [x, y] = [0, 1].map(|k| (place(i)[k] - low[k]) / side);
        let (sum, count) = &mut sums[y * columns + x];
        let own = value(&pixels.target.at(i), mattes);
        sum.iter_mut().zip(own).for_each(|(sum, v)| *sum += v);
        *count += 1.0;
    }
    let block = |(k, (sum, count)): (usize, ([f32; 4], f32))| {
        let corner = [k % columns, k / columns];
        let [x, y] =
            [0, 1].map(|axis| low[axis] as f64 + (corner[axis] as f64 + 0.5) * side as f64);
        Block {
            center: Point::new(x, y),
            value: sum.map(|sum| sum / count.max(1.0)),
            weight: if 2.0 * count >= (side * side) as f32 {
                1.0
            } else {
                0.0
            },
        }
    };
    Blocks {
        columns,
        all: sums.into_iter().enumerate().map(block).collect(),
        low: low.map(|v| v as f64),
        size: size.map(|v| v as f64),
    }
}

/// The colour that most pixels of a part have, and how many are of it.
fn usual(pixels: &Pixels<'_>, part: &[usize]) -> (Pixel, usize) {
    let key = |i: usize| pixels.target.at(i).map(|v| (v * 255.0).round() as i16);
    let sample = part.iter().step_by(part.len().div_ceil(4096));
    let mut keys: Vec<[i16; 6]> = sample.map(|&i| key(i)).collect();
    let most = math::most_common(&mut keys).map_or([0; 6], |keys| keys[0]);
    let color = most.map(|level| f32::from(level) * LEVEL);
    let is_of = |&&i: &&usize| away(&pixels.target.at(i), &color) < FLAT;
    (color, part.iter().filter(is_of).count())
}
