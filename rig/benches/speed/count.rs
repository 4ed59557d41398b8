//! The work in a drawing: pairs, the blocks that the renderer visits, and what it does in each.
//!
//! A stroke is one, however many segments it has: where they overlap, its pixels and blocks count once. Paths are without
//! curves here, and dots are lines of no length. Written apart from the renderer, in scalars, from its description.

use strokefit::render::{Grid, StrokeRef, Strokes, TILE};

use rig::bench::measure::EDGE;

/// Pixels of a block.
pub(crate) const LANES: u64 = 16;
/// Side of a block, px.
const BLOCK: usize = 4;
/// Distance from a block's centre to its corner pixels' centres, px, as rounded by the renderer.
const BLOCK_RADIUS: f32 = 2.121_5;
/// Transmittance behind which the renderer does not look.
const OPAQUE: f32 = 1.0 / 16384.0;

/// The work in a drawing.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Count {
    /// (stroke, pixel) with coverage above 0, hidden or not.
    pub(crate) pairs: u64,
    /// Blocks visited on soft edges.
    pub(crate) edge: u64,
    /// Blocks visited in hard cores.
    pub(crate) core: u64,
}

/// Operations and traffic, per lane or in all.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Work {
    /// Add, subtract, multiply, divide, root, minimum, maximum and comparison, one each.
    pub(crate) operations: f64,
    /// Read and written. Caches hold a tile's scratch, so this is no traffic to memory; what stays in
    /// registers over a stroke's blocks is not counted.
    pub(crate) bytes: f64,
    /// Roots and divisions among the operations, as many of one as of the other.
    pub(crate) roots: f64,
}

impl Work {
    const fn per_lane(operations: u32, bytes: u32, roots: u32) -> Self {
        Self {
            operations: operations as f64,
            bytes: bytes as f64,
            roots: roots as f64,
        }
    }

    /// `p − a` 2; `h` and `q` 10 (dot product 3, scale and clamp 3, foot 4); `|q|` 5; `d` 1; σ and σ' 10;
    /// `m`, `o·σ'`, `1/|q|` 3; then as in a core, 12.
    /// Bytes: 12 kept of the edge, then as in a core.
    const PASS_1_EDGE: Self = Self::per_lane(43, 56, 2);

    /// `T·m` 1; `C ← C + T·m·c` 6; what is left without the most opaque stroke 3; `T` 1; comparison 1.
    /// Bytes: colour, `T` and the other transmittance read and written 40, `T` kept 4.
    const PASS_1_CORE: Self = Self::per_lane(12, 44, 0);

    /// As in a core 41; `p − a`, `h` and `q` 12; `∂L/∂d` and its pull 2; sum for the radius 1; sums for the
    /// two ends 8.
    /// Bytes: what was kept of the edge 12, then as in a core.
    const PASS_2_EDGE: Self = Self::per_lane(64, 64, 0);

    /// `T·m` 1; per channel contrast 1, `g·(c − B)` 2, sum for the colour 2, `B` 2, and for the worth 5:
    /// 36; sum for the worth 1; `∂L/∂m` 1; sum for the opacity 2.
    /// Bytes: `T` 4, error and gradient 24, colour behind read and written 24.
    const PASS_2_CORE: Self = Self::per_lane(41, 52, 0);

    /// By name, for print.
    pub(crate) const TABLE: [(&str, Self); 4] = [
        ("pass 1, edge", Self::PASS_1_EDGE),
        ("pass 1, core", Self::PASS_1_CORE),
        ("pass 2, edge", Self::PASS_2_EDGE),
        ("pass 2, core", Self::PASS_2_CORE),
    ];

    fn times(self, lanes: u64) -> Self {
        Self {
            operations: self.operations * lanes as f64,
            bytes: self.bytes * lanes as f64,
            roots: self.roots * lanes as f64,
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            operations: self.operations + other.operations,
            bytes: self.bytes + other.bytes,
            roots: self.roots + other.roots,
        }
    }
}

impl Count {
    /// Counts the work in `strokes` over the picture of `grid`.
    pub(crate) fn of(grid: Grid, strokes: &Strokes) -> Self {
        let mut count = Self::default();
        // Blocks of tiles: the padding of the last ones is visited too.
        let columns = grid.columns * (TILE / BLOCK);
        let rows = grid.rows * (TILE / BLOCK);
        let mut veils: Vec<Veil> = (0..columns * rows)
            .map(|i| Veil::new(grid, i % columns * BLOCK, i / columns * BLOCK))
            .collect();
        for i in (0..strokes.len()).rev() {
            let stroke = strokes.get(i);
            let reach = stroke.radius() + EDGE.width / 2.0 + BLOCK_RADIUS;
            let range = |axis: usize, blocks: usize| {
                let along = stroke.points.iter().map(|p| p[axis]);
                let low = along.clone().fold(f32::INFINITY, f32::min);
                let high = along.fold(f32::NEG_INFINITY, f32::max);
                let first = (low - reach).max(0.0) as usize / BLOCK;
                let last = (high + reach).max(0.0) as usize / BLOCK + 1;
                first..last.min(blocks)
            };
            for row in range(1, rows) {
                for column in range(0, columns) {
                    count.block(stroke, &mut veils[row * columns + column]);
                }
            }
        }
        count
    }

    fn block(&mut self, stroke: StrokeRef<'_>, veil: &mut Veil) {
        let from_center = distance(stroke, veil.x as f32 + 2.0, veil.y as f32 + 2.0);
        if from_center <= -(EDGE.width / 2.0 + BLOCK_RADIUS) {
            return;
        }
        let core = from_center > EDGE.width / 2.0 + 1e-4 + BLOCK_RADIUS;
        if veil.live {
            *(if core { &mut self.core } else { &mut self.edge }) += 1;
        }
        for (lane, pixel) in veil.pixels.iter_mut().enumerate() {
            let x = (veil.x + lane % BLOCK) as f32 + 0.5;
            let y = (veil.y + lane / BLOCK) as f32 + 0.5;
            let coverage = smoothstep(distance(stroke, x, y));
            self.pairs += u64::from(pixel.inside && coverage > 0.0);
            pixel.cover(stroke.opacity() * coverage);
        }
        veil.live &= veil.pixels.iter().any(|pixel| pixel.less_one >= OPAQUE);
    }

    pub(crate) fn blocks(&self) -> u64 {
        self.edge + self.core
    }

    pub(crate) fn lanes(&self) -> u64 {
        self.blocks() * LANES
    }

    /// Both passes, with leave-one-out.
    pub(crate) fn work(&self) -> Work {
        let edge = Work::PASS_1_EDGE.plus(Work::PASS_2_EDGE);
        let core = Work::PASS_1_CORE.plus(Work::PASS_2_CORE);
        edge.times(self.edge * LANES)
            .plus(core.times(self.core * LANES))
    }
}

/// A block and how much is seen through what is in front of it.
struct Veil {
    x: usize,
    y: usize,
    live: bool,
    pixels: [Pixel; LANES as usize],
}

#[derive(Clone, Copy)]
struct Pixel {
    /// True if it is on the picture.
    inside: bool,
    through: f32,
    /// Transmittance were the most opaque stroke not there.
    less_one: f32,
}

impl Veil {
    fn new(grid: Grid, x: usize, y: usize) -> Self {
        let pixel = |lane| {
            let inside = x + lane % BLOCK < grid.width && y + lane / BLOCK < grid.height;
            let through = f32::from(u8::from(inside));
            Pixel {
                inside,
                through,
                less_one: through,
            }
        };
        Self {
            x,
            y,
            live: true,
            pixels: std::array::from_fn(pixel),
        }
    }
}

impl Pixel {
    fn cover(&mut self, alpha: f32) {
        self.less_one = (self.less_one - self.less_one * alpha).max(self.through);
        self.through -= self.through * alpha;
    }
}

/// Signed distance of (x, y) from the outline, px, positive inside.
fn distance(stroke: StrokeRef<'_>, x: f32, y: f32) -> f32 {
    let from_segment = |ends: &[[f32; 2]]| {
        let ([ax, ay], [bx, by]) = (ends[0], ends[1]);
        let (ux, uy) = (bx - ax, by - ay);
        let (px, py) = (x - ax, y - ay);
        let h = ((px * ux + py * uy) / (ux * ux + uy * uy + 1e-6)).clamp(0.0, 1.0);
        (px - h * ux).hypot(py - h * uy)
    };
    let distances = stroke.points.windows(2).map(from_segment);
    stroke.radius() - distances.fold(f32::INFINITY, f32::min)
}

fn smoothstep(d: f32) -> f32 {
    let t = (d / EDGE.width + 0.5).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
