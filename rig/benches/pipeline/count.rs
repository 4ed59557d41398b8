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
