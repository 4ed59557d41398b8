//! The colours of flat places, and which pixels have one of them.
//!
//! A place is flat where the pixels beside it are alike. Flat pixels are counted by bins of some levels; the fullest
//! bins become colours, apart from each other and from the canvas. Thin things have no flat pixels: their colours are
//! found where neither a colour nor a mixture of two explains the pixels.

use rayon::prelude::*;

use super::super::areas::{LEVEL, Pixel, Pixels, away};
use super::shades::{self, Shaded};
use crate::scene::Shade;

// Levels are the largest difference of a channel. The measured values are those of 64 drawings at 256 px (`docs/areas.md`).
/// Most colours of a picture. A guess.
const MOST_COLORS: usize = 255;
/// A pixel is flat if the pixels beside it are within this range, levels.
const FLAT: f32 = 8.0;
/// Colours are farther apart than this, levels. 12 took #f4f4f4 for white.
const APART: f32 = 5.0;
/// A pixel has a colour beside another one only if it is this near, levels; or else it is a mixture. Without this rule pale edges
/// have steps: 220 points instead of 116.
const EXACT: f32 = 2.5;
/// How much larger [`FLAT`] is for each level of doubt. With this and the next two, 20 drawings and icons in JPEG 75 and with noise
/// of 8 levels have 1.40 and 1.19 instead of 1.87 and 1.40 times the numbers of the clean picture in the mean.
const FLAT_OF_DOUBT: f32 = 2.0;
/// As [`FLAT_OF_DOUBT`], of [`APART`].
const APART_OF_DOUBT: f32 = 2.0;
/// As [`FLAT_OF_DOUBT`], of [`EXACT`].
const EXACT_OF_DOUBT: f32 = 1.0;
/// Fewest pixels of a shape. A guess.
pub(super) const LEAST_AREA: usize = 4;

/// The label of the canvas, whose colour depends on the pixel.
pub(super) const CANVAS: u16 = 0;
/// The label of the first shade.
pub(super) const SHADES: u16 = 1 << 15;
/// The label of a pixel that is no colour alone.
pub(super) const NONE: u16 = u16::MAX;
/// The colours of a picture. Label 0 is the canvas, label k the colour k − 1, and labels from [`SHADES`] on are shades.
pub(super) struct Colors<'a> {
    pub(super) pixels: &'a Pixels<'a>,
    pub(super) list: Vec<Pixel>,
    shades: Vec<Vec<Shade>>,
    mattes: usize,
}

impl Colors<'_> {
    /// The colour of a label at pixel `i`.
    pub(super) fn at(&self, label: u16, i: usize) -> Pixel {
        match label {
            CANVAS => self.pixels.canvas.at(i),
            SHADES.. => match self.shades(label) {
                [] => self.pixels.canvas.at(i),
                shades => shades::shown(shades, self.pixels, i, self.mattes),
            },
            _ => self.list[usize::from(label) - 1],
        }
    }

    /// The shades of a label, back to front; none if it is that of a colour.
    pub(super) fn shades(&self, label: u16) -> &[Shade] {
        let index = label.checked_sub(SHADES);
        let shades = index.and_then(|index| self.shades.get(usize::from(index)));
        shades.map_or(&[], Vec::as_slice)
    }

    /// The nearest label of a pixel but those of shades, and how far it is.
    fn nearest(&self, i: usize) -> (u16, f32) {
        let target = self.pixels.target.at(i);
        let mut best = (CANVAS, away(&target, &self.pixels.canvas.at(i)));
        for (k, color) in self.list.iter().enumerate() {
            let distance = away(&target, color);
            if distance < best.1 {
                best = (k as u16 + 1, distance);
            }
        }
        best
    }
}

/// The colours of flat places, and the label of each pixel that has a colour or a shade by itself.
pub(super) fn flat_colors<'a>(
    pixels: &'a Pixels<'a>,
    shaded: Shaded,
    mattes: usize,
    doubts: &[f32],
) -> (Colors<'a>, Vec<u16>) {
    let mut flat = flat_pixels(pixels, doubts);
    for (i, flat) in flat.iter_mut().enumerate() {
        *flat &= shaded.at(i).is_none();
    }
    let list = clusters(pixels, &flat, doubts);
    let colors = Colors {
        pixels,
        list,
        shades: shaded.list.clone(),
        mattes,
    };
    let mut labels = labels(&colors, &flat, doubts);
    for (i, label) in labels.iter_mut().enumerate() {
        if let Some(shade) = shaded.at(i) {
            *label = SHADES + shade;
        }
    }
    (colors, labels)
}

/// How many levels colours of such a doubt are apart.
fn apart(doubt: f32) -> f32 {
    APART + APART_OF_DOUBT * doubt
}

/// How many levels a pixel of such a doubt may be from its colour beside another one.
fn exact(doubt: f32) -> f32 {
    EXACT + EXACT_OF_DOUBT * doubt
}

/// True for each pixel whose 3×3 neighbours are within a range that its doubt allows.
fn flat_pixels(pixels: &Pixels<'_>, doubts: &[f32]) -> Vec<bool> {
    let (width, height) = (pixels.width, pixels.height);
    let mut flat = vec![true; width * height];
    let rows = flat.par_chunks_exact_mut(width).enumerate();
    rows.for_each(|(y, row)| {
        let around = y.saturating_sub(1)..(y + 2).min(height);
        let mut columns = vec![[0.0_f32; 2]; width];
        for plane in &pixels.target.0 {
            columns.fill([f32::INFINITY, f32::NEG_INFINITY]);
            for y in around.clone() {
                let values = &plane[y * width..(y + 1) * width];
                for ([low, high], value) in columns.iter_mut().zip(values) {
                    (*low, *high) = (low.min(*value), high.max(*value));
                }
            }
            for (x, flat) in row.iter_mut().enumerate() {
                let near = &columns[x.saturating_sub(1)..(x + 2).min(width)];
                let low = near.iter().fold(f32::INFINITY, |low, c| low.min(c[0]));
                let high = near
                    .iter()
                    .fold(f32::NEG_INFINITY, |high, c| high.max(c[1]));
                let tolerance = FLAT + FLAT_OF_DOUBT * doubts[y * width + x];
                *flat &= high - low <= tolerance * LEVEL;
            }
        }
    });
    flat
}

/// Pixels of one bin: their number, and the sums of their colours and doubts.
struct Bin {
    key: u64,
    count: f32,
    sum: Pixel,
    doubt: f32,
}

/// The colours of the flat pixels that are not those of the canvas, the most frequent first.
fn clusters(pixels: &Pixels<'_>, flat: &[bool], doubts: &[f32]) -> Vec<Pixel> {
    const LEVELS_PER_BIN: f32 = 4.0;
    let mut bins: Vec<Bin> = Vec::new();
    for i in (0..flat.len()).filter(|&i| flat[i]) {
        let pixel = pixels.target.at(i);
        if away(&pixel, &pixels.canvas.at(i)) <= apart(doubts[i]) * LEVEL {
            continue;
        }
        let bin = |v: &f32| (v.clamp(0.0, 1.0) * (255.0 / LEVELS_PER_BIN)) as u64;
        let key = pixel.iter().fold(0, |key, v| (key << 8) | bin(v));
        // Runs of one bin are one entry.
        let bin = Bin {
            key,
            count: 1.0,
            sum: pixel,
            doubt: doubts[i],
        };
        match bins.last_mut().filter(|last| last.key == key) {
            Some(last) => last.add(&bin),
            None => bins.push(bin),
        }
    }
    bins.sort_by_key(|bin| bin.key);
    bins.dedup_by(|next, kept| {
        let is_same = next.key == kept.key;
        if is_same {
            kept.add(next);
        }
        is_same
    });
    bins.sort_by(|a, b| b.count.total_cmp(&a.count).then(a.key.cmp(&b.key)));
    let mut colors: Vec<Pixel> = Vec::new();
    for bin in bins.iter().take_while(|bin| bin.count >= LEAST_AREA as f32) {
        let mean = bin.sum.map(|sum| sum / bin.count);
        let apart = apart(bin.doubt / bin.count);
        let is_new = |color: &Pixel| away(color, &mean) > apart * LEVEL;
        if colors.len() < MOST_COLORS && colors.iter().all(is_new) {
            colors.push(mean);
        }
    }
    colors
}

impl Bin {
    fn add(&mut self, other: &Self) {
        self.count += other.count;
        self.doubt += other.doubt;
        let channels = self.sum.iter_mut().zip(other.sum);
        channels.for_each(|(all, more)| *all += more);
    }
}

/// The label of each pixel that is flat, or about of one colour. Beside another label it has to be nearer.
fn labels(colors: &Colors<'_>, flat: &[bool], doubts: &[f32]) -> Vec<u16> {
    let pixels = colors.pixels;
    let all = (0..flat.len()).into_par_iter();
    let alone = all.clone().map(|i| {
        let (label, distance) = colors.nearest(i);
        let reach = match (flat[i], label) {
            (true, _) => apart(doubts[i]) + 3.0,
            (false, CANVAS) => exact(doubts[i]),
            (false, _) => 1.0,
        };
        let is_own = distance <= reach * LEVEL;
        (if is_own { label } else { NONE }, distance)
    });
    let alone: Vec<(u16, f32)> = alone.collect();
    let label = |i: usize| {
        let (label, distance) = alone[i];
        let is_exact = distance <= exact(doubts[i]) * LEVEL;
        let is_inner = || pixels.around(i, 1).all(|k| alone[k].0 == label);
        if is_exact || is_inner() { label } else { NONE }
    };
    all.map(label).collect()
}
