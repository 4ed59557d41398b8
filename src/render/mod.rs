//! The differentiable renderer: strokes to canvas, `∂L/∂canvas` to `∂L/∂stroke`.
//!
//! The picture is cut in tiles of 32×32 px. Strokes are binned to the tiles that their extent
//! touches; each tile then renders its own strokes over its own pixels with scratch of its worker
//! and writes its own sums, which are added in tile order. No result depends on the number of
//! threads or on the SIMD level, there are no locks to wait for and no atomics, and after the
//! first iteration nothing is allocated.
//!
//! Work is proportional to the (stroke, block) pairs that can be seen; memory to pixels, strokes
//! per tile, and the pairs of one tile per worker.
//!
//! A dark bar, and on it a dot of white, of opacity 0.6; a character is 1×2 px:
//!
//! ```
//! use strokefit::coverage::Coverage;
//! use strokefit::fit::Simd;
//! use strokefit::render::{Backdrop, Canvas, Grid, Renderer, Softness};
//!
//! // Two ends, radius, colour, opacity.
//! let bar = [8.0, 4.0, 40.0, 12.0, 3.0, 0.0, 0.0, 0.0, 1.0];
//! let dot = [36.0, 5.0, 36.0, 5.0, 4.5, 1.0, 1.0, 1.0, 0.6];
//!
//! let grid = Grid::new(48, 16);
//! let level = Simd::Auto.level().ok_or("no level")?;
//! let softness = Softness { coverage: Coverage::Smoothstep, width: 1.0 };
//! let mut canvas = Canvas::flat(grid, [1.0; 3]);
//! Renderer::new(grid, level).forward(&[bar, dot], softness, Backdrop::Color([1.0; 3]), &mut canvas);
//!
//! let dark = |x, y| 1.0 - canvas.pixel(x, y)[0];
//! let shade = |x, y| char::from(b" .:-=+*#%@"[(9.0 * dark(x, y)).round() as usize]);
//! let row = |y| (0..48).map(|x| shade(x, y)).collect::<String>();
//! let picture = (2..16).step_by(2).map(|y| row(y).trim_end().to_owned()).collect::<Vec<_>>();
//! assert_eq!(picture, [
//!     "     *@@@@@@@#=.",
//!     "     @@@@@@@@@@@@@@@@#=.",
//!     "      *@@@@@@@@@@@@@@@@@@@@@@#=.",
//!     "            .=#@@@@@@@@@@@@@@@@@@+===-:.",
//!     "                    .=#@@@@@@@@@@@@@@@@@@@*",
//!     "                            .=#@@@@@@@@@@@@",
//!     "                                    .=#@@*",
//! ]);
//! # Ok::<(), &str>(())
//! ```
//!
//! [`mod@reference`] is the same in naive `f64`, against which all of this is tested.

mod edge;
mod grid;
mod kernel;
pub mod probe;
pub mod reference;
mod strokes;

use std::sync::{Mutex, PoisonError};

use fearless_simd::Level;
use rayon::prelude::*;

pub use grid::{BlockRgb, Canvas, Grid, Lanes, TILE, TileRgb};
pub use strokes::{AX, AY, BX, BY, OPACITY, PARAMS, Params, RADIUS, RED, pack, unpack};

use crate::coverage::Coverage;
use edge::{Edge, Reach};
use grid::{FULL, TileWeights, edge_weights, flat_tile};
use kernel::{Scratch, StrokeSums, TileJob, TileSums, WORTH};

/// A differentiable loss over the canvas, told tile by tile while the tile is still in cache.
pub trait CanvasLoss: Sync {
    /// Writes the signed error `canvas − target` and `∂L/∂canvas` of tile `tile` and returns its
    /// share of the loss. On the padding of a tile the canvas is 0.
    fn tile(
        &self,
        tile: usize,
        canvas: &TileRgb,
        error: &mut TileRgb,
        gradient: &mut TileRgb,
    ) -> f64;
}

/// What lies behind all strokes.
#[derive(Debug, Clone, Copy)]
pub enum Backdrop<'a> {
    /// One colour.
    Color([f32; 3]),
    /// A picture, such as the frozen stages below.
    Canvas(&'a Canvas),
}

/// Coverage and its softness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Softness {
    /// The coverage function.
    pub coverage: Coverage,
    /// Width of the soft edge, px, above 0.
    pub width: f32,
}

/// Derivatives of a loss by everything that was drawn.
#[derive(Debug, Clone, Default)]
pub struct Gradients {
    /// The loss itself.
    pub loss: f64,
    /// `∂L/∂(parameters)`, one row per stroke.
    pub strokes: Vec<Params>,
    /// `∂L/∂backdrop`, summed over the pixels.
    pub backdrop: [f32; 3],
    /// By how much the squared error (summed over pixels and channels) grows when the stroke is
    /// left out, exactly; filled by [`Renderer::backward_with_worth`] alone.
    pub worth: Vec<f32>,
    /// Blocks of 16 px that were visited: the work done.
    pub blocks: u64,
}

impl Gradients {
    /// Adds the derivatives of another loss by the same strokes.
    pub(crate) fn add(&mut self, other: &Self) {
        let add = |sums: &mut [f32], parts: &[f32]| {
            for (sum, part) in sums.iter_mut().zip(parts) {
                *sum += part;
            }
        };
        self.loss += other.loss;
        self.blocks += other.blocks;
        add(&mut self.backdrop, &other.backdrop);
        add(&mut self.worth, &other.worth);
        add(
            self.strokes.as_flattened_mut(),
            other.strokes.as_flattened(),
        );
    }

    /// Multiplies the loss, its derivatives and the worth by `factor`.
    pub(crate) fn scale(&mut self, factor: f32) {
        self.loss *= f64::from(factor);
        let values = self.strokes.as_flattened_mut().iter_mut();
        for value in values.chain(&mut self.backdrop).chain(&mut self.worth) {
            *value *= factor;
        }
    }
}

/// One tile's list of strokes and its results.
#[derive(Debug, Default)]
struct TileWork {
    ids: Vec<u32>,
    sums: Vec<StrokeSums>,
    total: TileSums,
    weights: Option<Box<TileWeights>>,
}

/// Renders strokes on pictures of one size; keeps its memory from call to call.
#[derive(Debug)]
pub struct Renderer {
    grid: Grid,
    level: Level,
    tiles: Vec<TileWork>,
    scratch: Vec<Mutex<Box<Scratch>>>,
}

impl Renderer {
    /// A renderer for pictures of the size of `grid`, at SIMD level `level`, for use in the rayon
    /// pool that is current now.
    pub fn new(grid: Grid, level: Level) -> Self {
        let tile = |tile| TileWork {
            weights: edge_weights(&grid, tile),
            ..TileWork::default()
        };
        Self {
            grid,
            level,
            tiles: (0..grid.len()).map(tile).collect(),
            scratch: (0..rayon::current_num_threads())
                .map(|_| Mutex::new(Scratch::new()))
                .collect(),
        }
    }

    /// How the picture is cut.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Renders `strokes`, back to front, on `backdrop` into `out`.
    pub fn forward(
        &mut self,
        strokes: &[Params],
        softness: Softness,
        backdrop: Backdrop<'_>,
        out: &mut Canvas,
    ) {
        let frame = Frame::new(self.grid, strokes, softness, backdrop);
        self.bin(strokes, frame.reach);
        let Self {
            level,
            ref mut tiles,
            ref scratch,
            ..
        } = *self;
        let tiles = tiles
            .par_iter()
            .zip(out.tiles_mut())
            .enumerate()
            .with_max_len(1);
        tiles.for_each(|(tile, (work, out))| {
            let job = frame.job(tile, work);
            if job.ids.is_empty() {
                out.clone_from(job.backdrop);
                return;
            }
            with_scratch(scratch, |scratch| {
                kernel::draw(level, &job, scratch);
                out.clone_from(scratch.canvas());
            });
        });
    }

    /// Renders `strokes` on `backdrop` and writes the derivatives of `loss` to `gradients`.
    ///
    /// Tiles that no stroke touches take part with their loss and `∂L/∂backdrop`.
    pub fn backward<L: CanvasLoss>(
        &mut self,
        strokes: &[Params],
        softness: Softness,
        backdrop: Backdrop<'_>,
        loss: &L,
        gradients: &mut Gradients,
    ) {
        self.run_backward::<L, false>(
            &Frame::new(self.grid, strokes, softness, backdrop),
            loss,
            gradients,
        );
    }

    /// The same, and every stroke's worth.
    pub fn backward_with_worth<L: CanvasLoss>(
        &mut self,
        strokes: &[Params],
        softness: Softness,
        backdrop: Backdrop<'_>,
        loss: &L,
        gradients: &mut Gradients,
    ) {
        self.run_backward::<L, true>(
            &Frame::new(self.grid, strokes, softness, backdrop),
            loss,
            gradients,
        );
    }

    fn run_backward<L: CanvasLoss, const WITH_WORTH: bool>(
        &mut self,
        frame: &Frame<'_>,
        loss: &L,
        gradients: &mut Gradients,
    ) {
        self.bin(frame.strokes, frame.reach);
        let Self {
            level,
            ref mut tiles,
            ref scratch,
            ..
        } = *self;
        tiles
            .par_iter_mut()
            .enumerate()
            .with_max_len(1)
            .for_each(|(tile, work)| {
                let mut sums = std::mem::take(&mut work.sums);
                sums.resize(work.ids.len(), [0.0; PARAMS + 1]);
                let job = frame.job(tile, work);
                let total = with_scratch(scratch, |scratch| {
                    kernel::draw(level, &job, scratch);
                    kernel::differentiate::<L, WITH_WORTH>(level, &job, loss, scratch, &mut sums)
                });
                work.total = total;
                work.sums = sums;
            });
        self.reduce(frame.strokes.len(), WITH_WORTH, gradients);
    }

    /// Lists for each tile the strokes whose extent touches it, back to front.
    fn bin(&mut self, strokes: &[Params], reach: Reach) {
        for work in &mut self.tiles {
            work.ids.clear();
        }
        for (id, p) in strokes.iter().enumerate() {
            let margin = p[RADIUS] + reach.outside;
            let [columns, rows] = self.grid.tiles_touched(
                p[AX].min(p[BX]) - margin,
                p[AY].min(p[BY]) - margin,
                p[AX].max(p[BX]) + margin,
                p[AY].max(p[BY]) + margin,
            );
            for row in rows {
                for column in columns.clone() {
                    self.tiles[row * self.grid.columns + column]
                        .ids
                        .push(id as u32);
                }
            }
        }
    }

    /// Adds the tiles' sums in tile order.
    fn reduce(&self, strokes: usize, with_worth: bool, gradients: &mut Gradients) {
        gradients.loss = 0.0;
        gradients.backdrop = [0.0; 3];
        gradients.blocks = 0;
        gradients.strokes.clear();
        gradients.strokes.resize(strokes, [0.0; PARAMS]);
        gradients.worth.clear();
        gradients
            .worth
            .resize(if with_worth { strokes } else { 0 }, 0.0);
        for work in &self.tiles {
            gradients.loss += work.total.loss;
            gradients.blocks += work.total.blocks;
            for (sum, backdrop) in gradients.backdrop.iter_mut().zip(work.total.backdrop) {
                *sum += backdrop;
            }
            for (&id, sums) in work.ids.iter().zip(&work.sums) {
                for (sum, part) in gradients.strokes[id as usize].iter_mut().zip(sums) {
                    *sum += part;
                }
                if with_worth {
                    gradients.worth[id as usize] += sums[WORTH];
                }
            }
        }
    }
}

/// What one call renders.
struct Frame<'a> {
    grid: Grid,
    strokes: &'a [Params],
    backdrop: Backdrop<'a>,
    /// A tile of the backdrop's colour, if it is flat.
    flat: TileRgb,
    edge: Edge,
    reach: Reach,
}

impl<'a> Frame<'a> {
    fn new(grid: Grid, strokes: &'a [Params], softness: Softness, backdrop: Backdrop<'a>) -> Self {
        let (edge, reach) = Edge::new(softness.coverage, softness.width);
        let flat = match backdrop {
            Backdrop::Color(color) => flat_tile(color),
            Backdrop::Canvas(_) => flat_tile([0.0; 3]),
        };
        Self {
            grid,
            strokes,
            backdrop,
            flat,
            edge,
            reach,
        }
    }

    /// The share of tile `tile`.
    fn job<'b>(&'b self, tile: usize, work: &'b TileWork) -> TileJob<'b> {
        let (x, y) = self.grid.origin(tile);
        TileJob {
            tile,
            origin: [x as f32, y as f32],
            strokes: self.strokes,
            ids: &work.ids,
            backdrop: match self.backdrop {
                Backdrop::Color(_) => &self.flat,
                Backdrop::Canvas(canvas) => &canvas.tiles()[tile],
            },
            weights: work.weights.as_deref().unwrap_or(&FULL),
            edge: self.edge,
            reach: self.reach,
        }
    }
}

/// Runs `f` with the scratch of this worker.
fn with_scratch<R>(scratch: &[Mutex<Box<Scratch>>], f: impl FnOnce(&mut Scratch) -> R) -> R {
    // A worker never waits here: no other has its index. A panic elsewhere leaves only stale
    // numbers behind, which every tile overwrites, so a poisoned lock is as good as another.
    let index = rayon::current_thread_index().unwrap_or(0) % scratch.len();
    f(&mut scratch[index]
        .lock()
        .unwrap_or_else(PoisonError::into_inner))
}
