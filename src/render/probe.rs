//! Gain of a stroke that is laid on top of a canvas, in closed form.
//!
//! A stroke of coverage `m`, opacity `v` and colour `c = u/v` over a fixed canvas `C` with residual
//! `e = target − C` leaves `e − m(u − vC)`. Its gain, the squared error that it removes, is quadratic
//! in `(u, v)`, so nine sums over its pixels answer for every colour and opacity at once:
//!
//! ```text
//! S = Σm²   X = Σm²C   Y = Σm·e   Q = Σm²|C|²   Z = Σm·e·C
//! gain(u, v) = 2(u·Y − vZ) − (|u|²S − 2v u·X + v²Q)
//! u = (Y + vX)/S           v = (X·Y/S − Z) / (Q − |X|²/S)
//! ```
//!
//! On several backdrops at once the sums add up, and so do the gains.
//!
//! A place is probed with dots and with capsules of several sizes and of directions spread evenly over half a
//! turn. The search finds the direction first, with capsules of one size, and then the size. That tries a third
//! of all shapes and costs a drawing no more than 0.02 dB.

use std::ops::Range;

use fearless_simd::{Level, dispatch, f32x16, prelude::*};

use super::edge::{Reach, Smoothstep, SoftEdge};
use super::grid::{
    BLOCK, BLOCKS, BlockSet, LANES, Lanes, TILE, TILE_BLOCKS, TileRgb, uniform_tile,
};
use super::kernel::{Segment, length, load, members, store, total};
use super::strokes::{OPACITY, Params, RADIUS, RED};
use crate::image::Image;
use crate::math;

/// Where the probed shapes are centred in a [`Patch`], px.
const PATCH_CENTER: f32 = TILE as f32 / 2.0 + 0.5;

/// The surroundings of a place: canvas and residual of the 32×32 px around it.
#[derive(Debug)]
pub struct Patch {
    canvas: TileRgb,
    residual: TileRgb,
    inside: [Lanes; BLOCKS],
}

impl Patch {
    /// A patch to be filled.
    pub fn new() -> Box<Self> {
        Box::new(Self {
            canvas: uniform_tile([0.0; 3]),
            residual: uniform_tile([0.0; 3]),
            inside: [Lanes::splat(0.0); BLOCKS],
        })
    }

    /// Copies the blocks that `probes` needs around pixel (x, y), which becomes the centre of the patch.
    pub fn fill(&mut self, probes: &Probes, target: &Image, canvas: &Image, x: usize, y: usize) {
        let (width, height) = (canvas.width() as isize, canvas.height() as isize);
        for &block in &probes.blocks {
            let left = x as isize + block_start(block % TILE_BLOCKS);
            let top = y as isize + block_start(block / TILE_BLOCKS);
            let columns = visible(left, width);
            let rows = visible(top, height);
            // Beyond the picture nothing counts: coverage is multiplied by `inside`.
            if columns.len() * rows.len() < LANES {
                self.clear(block);
            }
            if columns.is_empty() {
                continue;
            }
            for row in rows {
                let lane = row * BLOCK + columns.start;
                let source = (top + row as isize) * width + left + columns.start as isize;
                self.copy(block, lane, source as usize, columns.len(), target, canvas);
            }
        }
    }

    fn clear(&mut self, block: usize) {
        self.inside[block] = Lanes::splat(0.0);
        self.canvas[block] = [Lanes::splat(0.0); 3];
        self.residual[block] = [Lanes::splat(0.0); 3];
    }

    /// Copies `count` pixels from index `source` of the pictures to lane `lane` on.
    #[inline]
    fn copy(
        &mut self,
        block: usize,
        lane: usize,
        source: usize,
        count: usize,
        target: &Image,
        canvas: &Image,
    ) {
        let lanes = lane..lane + count;
        self.inside[block].0[lanes.clone()].fill(1.0);
        for channel in 0..3 {
            let c = &canvas.planes()[channel][source..source + count];
            let t = &target.planes()[channel][source..source + count];
            self.canvas[block][channel].0[lanes.clone()].copy_from_slice(c);
            let residual = &mut self.residual[block][channel].0[lanes.clone()];
            for ((r, t), c) in residual.iter_mut().zip(t).zip(c) {
                *r = t - c;
            }
        }
    }
}

/// Where column or row `i` of a patch's blocks starts, relative to the pixel at its centre.
fn block_start(i: usize) -> isize {
    (i * BLOCK) as isize - (TILE / 2) as isize
}

/// Which of the 4 pixels from `start` on lie in a picture of `size`.
fn visible(start: isize, size: isize) -> Range<usize> {
    let within = |v: isize| v.clamp(0, BLOCK as isize) as usize;
    within(-start)..within(size - start).max(within(-start))
}

/// A shape centred on [`PATCH_CENTER`] with its coverage there.
#[derive(Debug, Clone)]
struct Template {
    shape: Params,
    blocks: Vec<(usize, Lanes)>,
}

impl Template {
    /// The template of the geometry of `shape`, in the coordinates of a patch, with a soft edge 1 px wide.
    fn new(level: Level, shape: Params) -> Self {
        let blocks = dispatch!(level, simd => cover(simd, &shape));
        Self { shape, blocks }
    }
}

#[inline(always)]
fn cover<S: Simd>(simd: S, shape: &Params) -> Vec<(usize, Lanes)> {
    let reach = Reach {
        outside: 0.5,
        inside: f32::INFINITY,
    };
    let edge = Smoothstep::new(1.0);
    let &[ax, ay, bx, by, radius, ..] = shape;
    // A template has no core: with an infinite `inside`, every touched block keeps its coverage.
    let segment = Segment::new([[ax, ay], [bx, by]], [0.0; 2]);
    let (touched, _) = segment.blocks(simd, radius, reach);
    members(touched)
        .map(|block| {
            let mut coverage = Lanes::splat(0.0);
            let length = length(segment.at_pixels(simd, block).distance2());
            store(edge.eval(radius - length).0, &mut coverage);
            (block, coverage)
        })
        .collect()
}

/// The best colour and opacity of a shape, and the squared error that it then removes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    /// sRGB-encoded colour, 0..1.
    pub color: [f32; 3],
    /// Opacity, from `min_opacity` to 1.
    pub opacity: f32,
    /// Sum over pixels and channels of the squared error removed; negative where none is.
    pub gain: f32,
}

/// Directions of the probed capsules, evenly over half a turn.
const ANGLES: usize = 8;

/// The shapes that are probed at every place.
#[derive(Debug)]
pub struct Probes {
    level: Level,
    /// The capsules, [`ANGLES`] of each size, and then the dots.
    templates: Vec<Template>,
    /// Number of sizes of capsules.
    sizes: usize,
    /// The blocks of a patch that they touch.
    blocks: Vec<usize>,
}

impl Probes {
    /// Dots of these `radii`, px, and capsules of all of them with these `lengths`, px.
    pub fn new(level: Level, radii: &[f32], lengths: &[f32]) -> Self {
        let sizes: Vec<[f32; 2]> = radii
            .iter()
            .flat_map(|&radius| lengths.iter().map(move |&length| [radius, length]))
            .collect();
        let turned = |&[radius, length]: &[f32; 2]| {
            let angle = |k: usize| std::f32::consts::PI * k as f32 / ANGLES as f32;
            (0..ANGLES).map(move |k| shape(radius, length, angle(k)))
        };
        let capsules = sizes.iter().flat_map(turned);
        let dots = radii.iter().map(|&radius| shape(radius, 0.0, 0.0));
        let templates: Vec<Template> = capsules
            .chain(dots)
            .map(|shape| Template::new(level, shape))
            .collect();
        let touched = templates.iter().flat_map(|template| &template.blocks);
        // A patch copies the blocks that any template touches, and no others.
        let set = touched.fold(0, |set: BlockSet, (block, _)| set | 1 << block);
        Self {
            level,
            templates,
            sizes: sizes.len(),
            blocks: members(set).collect(),
        }
    }

    /// The shape that gains most, among those tried, and its probe. `patches` show the same place on different
    /// backdrops; their gains add up.
    pub fn best(&self, patches: &[Box<Patch>], min_opacity: f32) -> Option<(&Params, Probe)> {
        let search = Search {
            probes: self,
            patches,
            min_opacity,
            best: None,
        };
        let (index, probe) = dispatch!(self.level, simd => search.run(simd))?;
        Some((&self.templates[index].shape, probe))
    }
}

/// A shape about the centre of a patch.
fn shape(radius: f32, length: f32, angle: f32) -> Params {
    let (dx, dy) = (
        math::cos(angle) * length / 2.0,
        math::sin(angle) * length / 2.0,
    );
    let c = PATCH_CENTER;
    [c - dx, c - dy, c + dx, c + dy, radius, 0.0, 0.0, 0.0, 1.0]
}

/// The search for the best shape at one place.
struct Search<'a> {
    probes: &'a Probes,
    patches: &'a [Box<Patch>],
    min_opacity: f32,
    best: Option<(usize, Probe)>,
}

impl Search<'_> {
    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) -> Option<(usize, Probe)> {
        let capsules = self.probes.sizes * ANGLES;
        // The middle size stands for all of them until the direction is known.
        let middle = self.probes.sizes / 2 * ANGLES;
        // Every other direction, then those on both sides of the best.
        for turn in (0..ANGLES).step_by(2) {
            self.probe(simd, middle + turn);
        }
        self.turn(simd);
        // The other sizes in that direction, and the dots; a last look at the neighbouring directions, since
        // another size may turn the best one a little.
        let turn = self.best?.0 % ANGLES;
        for size in (0..capsules).step_by(ANGLES).filter(|&size| size != middle) {
            self.probe(simd, size + turn);
        }
        for dot in capsules..self.probes.templates.len() {
            self.probe(simd, dot);
        }
        self.turn(simd);
        self.best
    }

    /// Tries both neighbours of the best capsule's direction.
    #[inline(always)]
    fn turn<S: Simd>(&mut self, simd: S) {
        match self.best {
            Some((index, _)) if index < self.probes.sizes * ANGLES => {
                let (size, turn) = (index / ANGLES * ANGLES, index % ANGLES);
                self.probe(simd, size + (turn + 1) % ANGLES);
                self.probe(simd, size + (turn + ANGLES - 1) % ANGLES);
            }
            _ => {}
        }
    }

    #[inline(always)]
    fn probe<S: Simd>(&mut self, simd: S, index: usize) {
        let template = &self.probes.templates[index];
        // One stroke on several backdrops has one colour and opacity, so the sums add up before they are solved.
        let mut total = Sums::default();
        for patch in self.patches {
            total.add(&sums(simd, template, patch));
        }
        let probe = total.solve(self.min_opacity);
        if self.best.is_none_or(|(_, held)| probe.gain > held.gain) {
            self.best = Some((index, probe));
        }
    }
}

/// The nine sums at the head of the file.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    s: f32,
    x: [f32; 3],
    y: [f32; 3],
    q: f32,
    z: f32,
}

#[inline(always)]
fn sums<S: Simd>(simd: S, template: &Template, patch: &Patch) -> Sums {
    let zero = f32x16::splat(simd, 0.0);
    let (mut s, mut x, mut y, mut q, mut z) = (zero, [zero; 3], [zero; 3], zero, zero);
    for (block, coverage) in &template.blocks {
        // Pixels off the picture drop out of all nine sums.
        let m = load(simd, coverage) * load(simd, &patch.inside[*block]);
        let m2 = m * m;
        s += m2;
        for channel in 0..3 {
            let c = load(simd, &patch.canvas[*block][channel]);
            let me = m * load(simd, &patch.residual[*block][channel]);
            let m2c = m2 * c;
            x[channel] += m2c;
            y[channel] += me;
            q += m2c * c;
            z += me * c;
        }
    }
    Sums {
        s: total(s),
        x: [total(x[0]), total(x[1]), total(x[2])],
        y: [total(y[0]), total(y[1]), total(y[2])],
        q: total(q),
        z: total(z),
    }
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.s += other.s;
        self.q += other.q;
        self.z += other.z;
        for channel in 0..3 {
            self.x[channel] += other.x[channel];
            self.y[channel] += other.y[channel];
        }
    }

    #[inline(always)]
    fn solve(&self, min_opacity: f32) -> Probe {
        // Too little of the shape is on the picture to tell a colour.
        if self.s < 1e-3 {
            return Probe {
                color: [0.0; 3],
                opacity: 1.0,
                gain: 0.0,
            };
        }
        let dot = |a: &[f32; 3], b: &[f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        // The variance of the canvas under the shape: without it, opacity and colour cannot be told apart.
        let spread = self.q - dot(&self.x, &self.x) / self.s;
        // v = (X·Y/S − Z) / (Q − |X|²/S).
        let pull = dot(&self.x, &self.y) / self.s - self.z;
        // On a flat canvas opacity and colour say the same, and the opaque stroke is preferred.
        let free = if spread > 1e-4 * self.s {
            pull / spread
        } else {
            1.0
        };
        let opacity = free.clamp(min_opacity, 1.0);
        // c = u/v = (Y + vX)/(vS), cut to colours that exist.
        let color = [0, 1, 2]
            .map(|k| ((self.y[k] + opacity * self.x[k]) / (self.s * opacity)).clamp(0.0, 1.0));
        // The gain at the clamped colour and opacity, which may be no gain any more.
        let u = color.map(|c| c * opacity);
        let gain = 2.0 * (dot(&u, &self.y) - opacity * self.z)
            - (dot(&u, &u) * self.s - 2.0 * opacity * dot(&u, &self.x)
                + opacity * opacity * self.q);
        Probe {
            color,
            opacity,
            gain,
        }
    }
}

impl Probe {
    /// The stroke of this probe: `shape` scaled by `scale` about the patch's centre and moved to `center`.
    pub fn stroke(&self, shape: &Params, center: [f32; 2], scale: f32) -> Params {
        let mut p = *shape;
        for end in [0, 2] {
            for axis in 0..2 {
                // Templates are in px of the reduced picture, about the patch's centre.
                p[end + axis] = center[axis] + (shape[end + axis] - PATCH_CENTER) * scale;
            }
        }
        p[RADIUS] = shape[RADIUS] * scale;
        p[RED..RED + 3].copy_from_slice(&self.color);
        p[OPACITY] = self.opacity;
        p
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 48;
    const BAR: f32 = 0.9;

    /// A light bar 5 px wide and 18 px long on black through the middle, at `angle`.
    fn bar(angle: f32) -> Image {
        let pixel = |i: usize| {
            let [x, y] = [i % SIDE, i / SIDE].map(|v| v as f32 - (SIDE / 2) as f32);
            let along = x * math::cos(angle) + y * math::sin(angle);
            let across = y * math::cos(angle) - x * math::sin(angle);
            let inside = along.abs() < 9.0 && across.abs() < 2.5;
            if inside { BAR } else { 0.0 }
        };
        Image::from_planes(
            SIDE,
            SIDE,
            [0; 3].map(|_| (0..SIDE * SIDE).map(pixel).collect()),
        )
    }

    #[test]
    fn a_bar_is_found_in_its_direction_and_size() {
        let probes = Probes::new(Level::new(), &[1.0, 2.5, 4.0], &[4.0, 14.0]);
        let black = Image::from_planes(SIDE, SIDE, [0; 3].map(|_| vec![0.0; SIDE * SIDE]));
        for k in 0..ANGLES {
            let angle = std::f32::consts::PI * k as f32 / ANGLES as f32;
            let mut patch = Patch::new();
            patch.fill(&probes, &bar(angle), &black, SIDE / 2, SIDE / 2);
            let (found, probe) = probes.best(&[patch], 1.0).unwrap();
            let wanted = shape(2.5, 14.0, angle);
            let apart = found.iter().zip(&wanted).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f32::max) < 1e-4, "{k}: {found:?}");
            assert!((probe.color[0] - BAR).abs() < 0.1, "{k}: {probe:?}");
        }
    }
}
