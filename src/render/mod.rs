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
//! A dark hook: a line, a corner and a curve, in one colour and with one coverage, and on it a dot of white, of opacity 0.6. A
//! character is 1×2 px:
//!
//! ```
//! use strokefit::coverage::Coverage;
//! use strokefit::fit::Simd;
//! use strokefit::math::Point;
//! use strokefit::render::{Backdrop, Canvas, Grid, Renderer, Softness, Strokes};
//! use strokefit::scene::{Cap, Path, PathPoint, Stroke};
//!
//! let [on, off] = [PathPoint::on, PathPoint::off];
//! let points = vec![
//!     on(Point::new(6.0, 4.0)),
//!     on(Point::new(30.0, 4.0)),
//!     off(Point::new(50.0, 16.0)),
//!     on(Point::new(12.0, 20.0)),
//! ];
//! let path = Path::new(points, false)?;
//! let cap = Cap::Round;
//! let hook = Stroke { path, radius: 2.5, radii: Vec::new(), cap, color: [0.0; 3], opacity: 0.9 };
//! let dot = Stroke { path: Path::dot(Point::new(29.0, 5.0)), radius: 4.5, radii: Vec::new(), cap, color: [1.0; 3], opacity: 0.6 };
//! let strokes = Strokes::from_iter([&hook, &dot]);
//!
//! let grid = Grid::new(48, 24);
//! let level = Simd::Auto.level().ok_or("no level")?;
//! let softness = Softness { coverage: Coverage::Smoothstep, width: 1.0 };
//! let mut canvas = Canvas::flat(grid, [1.0; 3]);
//! Renderer::new(grid, level).forward(&strokes, softness, Backdrop::Color([1.0; 3]), &mut canvas);
//!
//! let dark = |x, y| 1.0 - canvas.pixel(x, y)[0];
//! let shade = |x, y| char::from(b" .:-=+*#%@"[(9.0 * dark(x, y)).round() as usize]);
//! let row = |y| (0..48).map(|x| shade(x, y)).collect::<String>();
//! let picture = (0..24).step_by(2).map(|y| row(y).trim_end().to_owned()).collect::<Vec<_>>();
//! assert_eq!(picture, [
//!     "",
//!     "    %%%%%%%%%%%%%%%%%%%%%=------.",
//!     "   -%%%%%%%%%%%%%%%%%%%%*--------*%.",
//!     "     -===================:::::---#%%%:",
//!     "                                #%%%%%+",
//!     "                                  %%%%%:",
//!     "                                 +%%%%%.",
//!     "                           .-#%%%%%%%%:",
//!     "                 .:=*#%%%%%%%%%%%%%%-",
//!     "          %%%%%%%%%%%%%%%%%%%%%#=",
//!     "         -%%%%%%%%%%%%%%*=.",
//!     "           -=:.",
//! ]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`mod@reference`] is the same in naive `f64`, against which all of this is tested.

mod arcs;
mod crossings;
mod edge;
mod frame;
mod gradients;
mod grid;
mod ground;
mod kernel;
mod paint;
mod polylines;
#[doc(hidden)]
pub mod probe;
#[doc(hidden)]
pub mod reference;
mod shares;
mod strokes;

use std::marker::PhantomData;
use std::sync::{Mutex, OnceLock, PoisonError};

use fearless_simd::Level;
use rayon::prelude::*;

pub use gradients::{Gradients, Survey};
pub use grid::{BlockRgb, Canvas, Grid, Lanes, Run, TILE, TileRgb};
pub use ground::{Plane, blurred, coverage, filled, ground};
pub use paint::Paint;
pub use strokes::{
    AX, AY, BX, BY, Form, OPACITY, PARAMS, Params, RADIUS, RED, STYLE, StrokeMut, StrokeRef,
    Strokes,
};

use crate::coverage::Coverage;
use crate::rng;
use crate::threads::PerWorker;
use frame::Frame;
use gradients::add;
use grid::{FULL, TileWeights, clear_padding, edge_weights};
use kernel::{
    Extras, Listed, Nothing, OfStroke, Scratch, Stiffnesses, Sums, TileJob, TileSums, Worths,
};
pub(crate) use polylines::{Knot, Piece, Pieces};
use polylines::{Polylines, flatten};
use shares::shares;

/// A differentiable loss over the canvas, evaluated tile by tile while the tile is still in cache.
pub trait CanvasLoss: Sync {
    /// Writes `∂L/∂canvas` of tile `tile` and, if it is asked for, the signed error `canvas − target`; returns the
    /// tile's share of the loss. On the padding of a tile the canvas is 0.
    fn tile(
        &self,
        tile: usize,
        canvas: &TileRgb,
        error: Option<&mut TileRgb>,
        gradient: &mut TileRgb,
    ) -> f64;

    /// The share of tile `tile` in the loss, and its derivative by `color`, if all pixels of the tile have that colour;
    /// `None` if that is not known without looking at the pixels.
    fn uniform(&self, _tile: usize, _color: [f32; 3]) -> Option<(f64, [f32; 3])> {
        None
    }

    /// The place to keep the share of tile `tile` in the loss; `None` if the loss outlives the backdrop's picture or
    /// the softness.
    fn kept(&self, _tile: usize) -> Option<&KeptLoss> {
        None
    }
}

/// The share of a tile in a loss, as long as softness and the picture behind the strokes are the same.
#[derive(Debug, Default)]
pub struct KeptLoss {
    /// The share and its derivative by the backdrop, where no stroke touches it.
    untouched: OnceLock<(f64, [f32; 3])>,
    /// The shares with the strokes of the last two lists, the latest first, each with the hash of the list.
    ///
    /// Two, because an edit that is refused leaves the list that was there before it.
    touched: Mutex<[(u64, f64); 2]>,
}

impl KeptLoss {
    /// The share with the list of strokes that has this hash, computed by `judge` unless it is kept.
    fn of(&self, list: u64, judge: impl FnOnce() -> f64) -> f64 {
        let mut kept = self.touched.lock().unwrap_or_else(PoisonError::into_inner);
        if kept[0].0 != list {
            kept.swap(0, 1);
            if kept[0].0 != list {
                kept[0] = (list, judge());
            }
        }
        kept[0].1
    }
}

/// Colour or picture behind all strokes.
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

/// One tile's list of strokes and its results.
#[derive(Debug, Default)]
struct TileWork {
    /// The strokes that may touch the tile, back to front.
    listed: Vec<Listed>,
    /// The segments of these strokes that may touch the tile, each by its first vertex.
    segments: Vec<u32>,
    sums: Sums,
    total: TileSums,
    weights: Option<Box<TileWeights>>,
    /// The roots of the weights of errors, 0 on the padding.
    error_weights: Option<Box<TileWeights>>,
}

/// Renders strokes on pictures of one size; keeps its memory from call to call.
#[derive(Debug)]
pub struct Renderer {
    grid: Grid,
    level: Level,
    polylines: Polylines,
    /// The least number of segments that `polylines` has for each line and each curve.
    least: usize,
    /// `∂L/∂vertex`.
    slopes: Vec<[f32; 2]>,
    tiles: Vec<TileWork>,
    scratch: PerWorker<Box<Scratch>>,
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
            polylines: Polylines::default(),
            least: 1,
            slopes: Vec::new(),
            tiles: (0..grid.len()).map(tile).collect(),
            scratch: PerWorker::new(Scratch::new),
        }
    }

    /// The grid of tiles.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Sets how much errors count, for the backward passes alone: the roots `√w` of the weights, in the first channel of
    /// `roots`. These passes then multiply the canvas by the roots before they evaluate the loss.
    ///
    /// If the target is multiplied by the same roots, the squared error, its derivatives and the contributions are exactly those of the
    /// weighted squared error: `(√w·c − √w·t)² = w·(c − t)²`.
    pub fn set_error_weights(&mut self, roots: &Canvas) {
        for (work, tile) in self.tiles.iter_mut().zip(roots.tiles()) {
            let of = |block: usize| {
                let mut lanes = tile[block][0];
                // Pass 1 starts from these weights as transmittance, so the padding has to stay 0 whatever the roots are there.
                let weights = work.weights.as_deref().unwrap_or(&FULL);
                for (lane, weight) in lanes.0.iter_mut().zip(weights[block].0) {
                    *lane *= weight;
                }
                lanes
            };
            work.error_weights = Some(Box::new(std::array::from_fn(of)));
        }
    }

    /// Renders `strokes`, back to front, on `backdrop` into `out`.
    pub fn forward(
        &mut self,
        strokes: &Strokes,
        softness: Softness,
        backdrop: Backdrop<'_>,
        out: &mut Canvas,
    ) {
        let frame = Frame::new(self.grid, softness, backdrop);
        let (tiles, shared) = self.binned(strokes, 1, &frame);
        // Tasks of one tile: tiles differ too much in their number of strokes for longer runs to take equal time.
        let tiles = tiles
            .par_iter_mut()
            .zip(out.tiles_mut())
            .enumerate()
            .with_max_len(1);
        tiles.for_each(|(tile, (work, out))| {
            // `bin` compared bounding boxes of whole strokes; this drops strokes whose segments all miss the tile.
            work.list_segments(tile, &shared);
            let job = frame.job(shared.polylines, tile, work, work.weights.as_deref());
            if job.listed.is_empty() {
                // The tile shows the backdrop alone. Its padding becomes 0, as in a tile that the kernel draws.
                out.clone_from(job.backdrop);
                if let Some(weights) = &work.weights {
                    clear_padding(out, weights);
                }
                return;
            }
            shared.scratch.with(|scratch| {
                kernel::draw(shared.level, &job, scratch);
                out.clone_from(scratch.canvas());
            });
        });
    }

    /// Renders `strokes` on `backdrop` and writes the derivatives of `loss` to `gradients`.
    ///
    /// Tiles that no stroke touches take part with their loss and `∂L/∂backdrop`.
    pub fn backward<L: CanvasLoss>(
        &mut self,
        strokes: &Strokes,
        softness: Softness,
        backdrop: Backdrop<'_>,
        loss: &L,
        gradients: &mut Gradients,
    ) {
        let frame = Frame::new(self.grid, softness, backdrop);
        self.run_backward(strokes, 1, &frame, Single::<L, Nothing>::of(&frame, loss));
        self.reduce(strokes, false, gradients);
    }

    /// The `loss` of `strokes` on `backdrop` under the error weights, the value that [`Self::backward`] computes.
    pub fn loss<L: CanvasLoss>(
        &mut self,
        strokes: &Strokes,
        softness: Softness,
        backdrop: Backdrop<'_>,
        loss: &L,
    ) -> f64 {
        let frame = Frame::new(self.grid, softness, backdrop);
        let pass = LossAlone {
            frame: &frame,
            loss,
        };
        let (tiles, shared) = self.binned(strokes, 1, &frame);
        // A tile that the same strokes reach as before has the loss that it had: after an edit, most of a picture.
        let fingerprints = shared.polylines.fingerprints();
        // A picture behind the strokes doesn't count, as what is kept doesn't outlive it; but it is no colour.
        let color = match backdrop {
            Backdrop::Color(color) => color,
            Backdrop::Canvas(_) => [f32::NAN; 3],
        };
        let bits = color.map(|v| u64::from(v.to_bits()));
        let page = bits.into_iter().fold(0, rng::with);
        let tiles = tiles.par_iter_mut().enumerate().with_max_len(1);
        let losses = tiles.map(|(tile, work)| {
            let strokes = work.listed.iter().map(|listed| listed.stroke as usize);
            let list = strokes.fold(page, |list, i| rng::with(list, fingerprints[i]));
            let mut judge = || work.run(tile, &shared, &pass).loss;
            match loss.kept(tile) {
                Some(kept) => kept.of(list, judge),
                None => judge(),
            }
        });
        // A sum in tile order: the same `f64` for every number of threads.
        losses.collect::<Vec<f64>>().iter().sum()
    }

    /// The derivatives of the sum of two `losses`, each of the canvas on one of the `backdrops`. Takes little longer than
    /// one of them, because the strokes let through the same of both backdrops.
    pub fn backward_on_mattes<L: CanvasLoss>(
        &mut self,
        strokes: &Strokes,
        softness: Softness,
        backdrops: [Backdrop<'_>; 2],
        losses: [&L; 2],
        gradients: &mut Gradients,
    ) {
        // Both frames have one softness, so one binning and one pass 1 serve both backdrops.
        let frames = backdrops.map(|backdrop| Frame::new(self.grid, softness, backdrop));
        let pass = Double {
            frames: &frames,
            losses,
        };
        self.run_backward(strokes, 1, &frames[0], pass);
        self.reduce(strokes, false, gradients);
    }

    /// The derivatives, and every stroke's contribution.
    pub fn backward_with_contributions<L: CanvasLoss>(
        &mut self,
        strokes: &Strokes,
        softness: Softness,
        backdrop: Backdrop<'_>,
        loss: &L,
        gradients: &mut Gradients,
    ) {
        let frame = Frame::new(self.grid, softness, backdrop);
        self.run_backward(strokes, 1, &frame, Single::<L, Worths>::of(&frame, loss));
        self.reduce(strokes, true, gradients);
    }

    /// Surveys how `loss` depends on the vertices of polylines with at least `least` segments for each line and each curve.
    pub fn survey<L: CanvasLoss>(
        &mut self,
        strokes: &Strokes,
        least: usize,
        softness: Softness,
        backdrop: Backdrop<'_>,
        loss: &L,
        survey: &mut Survey,
    ) {
        let frame = Frame::new(self.grid, softness, backdrop);
        let pass = Single::<L, Stiffnesses>::of(&frame, loss);
        self.run_backward(strokes, least, &frame, pass);
        // The reduction leaves `∂L/∂vertex` in `self.slopes`; a survey has no use for the derivatives by points.
        self.reduce(strokes, false, &mut Gradients::default());
        survey.firsts.clone_from(&self.polylines.firsts);
        survey.vertices.clone_from(&self.polylines.vertices);
        survey.slopes.clone_from(&self.slopes);
        survey.stiffness.clear();
        // A vertex between two segments gets a part from each, in each tile that they touch.
        survey.stiffness.resize(self.polylines.vertices.len(), 0.0);
        // Only a survey asks for stiffness, so that its sums are made here, on one thread.
        for work in &self.tiles {
            for (segment, stiffness) in work.sums.segments.iter().zip(&work.sums.stiffness) {
                add(&mut survey.stiffness[segment.id as usize..], stiffness);
            }
        }
    }

    fn run_backward(
        &mut self,
        strokes: &Strokes,
        least: usize,
        frame: &Frame<'_>,
        pass: impl BackwardPass,
    ) {
        let (tiles, shared) = self.binned(strokes, least, frame);
        let tiles = tiles.par_iter_mut().enumerate().with_max_len(1);
        tiles.for_each(|(tile, work)| work.total = work.run(tile, &shared, &pass));
    }

    /// Flattens the strokes and lists for each tile those whose bounding box touches it, back to front. Returns the tiles, and what
    /// they share.
    fn binned<'a>(
        &'a mut self,
        strokes: &Strokes,
        least: usize,
        frame: &'a Frame<'a>,
    ) -> (&'a mut [TileWork], Shared<'a>) {
        // Every stroke is flattened once for all tiles.
        self.polylines.fill(strokes, least, self.grid.rows);
        self.least = least;
        for work in &mut self.tiles {
            work.listed.clear();
        }
        // Strokes come in drawing order, and so do the lists.
        for (id, (style, [low, high])) in self
            .polylines
            .styles
            .iter()
            .zip(&self.polylines.boxes)
            .enumerate()
        {
            // A stroke reaches `radius + soft edge` beyond its centre line, an area (radius 0) the soft edge beyond its contour. A
            // stroke with a number that is not finite has a NaN margin, which touches no tile.
            let margin = style[0] + frame.reach.outside;
            let [columns, rows] = self.grid.tiles_touched(
                low[0] - margin,
                low[1] - margin,
                high[0] + margin,
                high[1] + margin,
            );
            let stroke = id as u32;
            for row in rows {
                for column in columns.clone() {
                    let tile = &mut self.tiles[row * self.grid.columns + column];
                    tile.listed.push(Listed {
                        stroke,
                        first: 0,
                        fills: false,
                    });
                }
            }
        }
        let shared = Shared {
            level: self.level,
            polylines: &self.polylines,
            frame,
            scratch: &self.scratch,
        };
        (&mut self.tiles, shared)
    }

    /// Adds the tiles' sums in tile order.
    fn reduce(&mut self, strokes: &Strokes, with_contributions: bool, gradients: &mut Gradients) {
        let contributions = if with_contributions { strokes.len() } else { 0 };
        for (values, count) in [
            (&mut gradients.strokes, strokes.numbers().len()),
            (&mut gradients.contribution, contributions),
        ] {
            values.clear();
            values.resize(count, 0.0);
        }
        // Totals are few numbers per tile: one thread adds them.
        gradients.loss = 0.0;
        gradients.backdrop = [0.0; 3];
        gradients.blocks = 0;
        for work in &self.tiles {
            gradients.loss += work.total.loss;
            gradients.blocks += work.total.blocks;
            add(&mut gradients.backdrop, &work.total.backdrop);
        }
        let Self {
            ref polylines,
            ref tiles,
            ref mut slopes,
            least,
            ..
        } = *self;
        slopes.clear();
        slopes.resize(polylines.vertices.len(), [0.0; 2]);
        // Threads share out strokes, not tiles: each sum has one owner, and adds in tile order whatever the threads.
        let shares = shares(strokes, polylines, slopes, gradients);
        shares.into_par_iter().for_each(|mut share| {
            // First complete the sums by vertices. Flattening is linear, so one pass per stroke then suffices to go from vertices
            // to points, instead of one per stroke and tile.
            share.gather(strokes, polylines, tiles);
            share.hand_back(strokes, polylines, least);
        });
    }
}

/// What the tiles of a call share.
struct Shared<'a> {
    level: Level,
    polylines: &'a Polylines,
    frame: &'a Frame<'a>,
    scratch: &'a PerWorker<Box<Scratch>>,
}

impl TileWork {
    /// Lists the segments of the listed strokes that touch tile `tile`.
    fn list_segments(&mut self, tile: usize, shared: &Shared<'_>) {
        let Self {
            listed, segments, ..
        } = self;
        let (origin, reach) = (shared.frame.origin(tile), shared.frame.reach);
        kernel::list_segments(
            shared.level,
            shared.polylines,
            origin,
            reach,
            listed,
            segments,
        );
    }

    /// Runs `pass` on tile `tile`, with the strokes that are listed for it. The sums of its strokes and segments are in `sums`.
    fn run(&mut self, tile: usize, shared: &Shared<'_>, pass: &impl BackwardPass) -> TileSums {
        self.list_segments(tile, shared);
        let &Shared {
            level,
            polylines,
            frame,
            scratch,
        } = shared;
        // `job` borrows the rest of the tile's work during the passes, so the sums move out, with their memory, and back in.
        let mut sums = std::mem::take(&mut self.sums);
        sums.clear();
        // A tile of one colour is known without looking at its pixels: most of a page of line art or areas.
        if sums.list_layers(&self.listed, polylines) {
            if let Some(total) = pass.uniform(tile, polylines, &mut sums.strokes) {
                self.sums = sums;
                return total;
            }
            // The kernel lists the strokes anew, in the order of its visits.
            sums.clear();
        }
        // The weights of errors are 0 on the padding, too.
        let weights = self.error_weights.as_deref().or(self.weights.as_deref());
        // Both passes run on one tile at once, while what pass 1 keeps is still in the cache.
        let job = frame.job(polylines, tile, self, weights);
        let total = scratch.with(|scratch| {
            // Without a stroke the tile shows the backdrop, whose sums the loss may keep as long as the picture stays.
            let untouched = || pass.untouched(level, &job, scratch);
            if let Some(total) = job.listed.is_empty().then(untouched).flatten() {
                return total;
            }
            kernel::draw(level, &job, scratch);
            pass.tile(level, &job, scratch, &mut sums)
        });
        self.sums = sums;
        total
    }
}

/// Work that follows pass 1 in a tile.
trait BackwardPass: Sync {
    /// The sums of a tile that strokes cover as a whole, if they are known without looking at its pixels. Adds to those of the
    /// `layers`.
    fn uniform(
        &self,
        tile: usize,
        polylines: &Polylines,
        layers: &mut [OfStroke],
    ) -> Option<TileSums>;

    /// The sums of the tile of `job`, which no stroke touches, if they are kept.
    fn untouched(&self, level: Level, job: &TileJob<'_>, scratch: &mut Scratch)
    -> Option<TileSums>;

    /// The sums of the tile of `job`, which pass 1 has drawn; `sums` takes the sums of its strokes and segments.
    fn tile(
        &self,
        level: Level,
        job: &TileJob<'_>,
        scratch: &mut Scratch,
        sums: &mut Sums,
    ) -> TileSums;
}

/// The derivatives of one loss, and `X`.
struct Single<'a, L, X> {
    frame: &'a Frame<'a>,
    loss: &'a L,
    extras: PhantomData<X>,
}

impl<'a, L: CanvasLoss, X: Extras> Single<'a, L, X> {
    fn of(frame: &'a Frame<'a>, loss: &'a L) -> Self {
        Self {
            frame,
            loss,
            extras: PhantomData,
        }
    }
}

impl<L: CanvasLoss, X: Extras> BackwardPass for Single<'_, L, X> {
    fn uniform(
        &self,
        tile: usize,
        polylines: &Polylines,
        layers: &mut [OfStroke],
    ) -> Option<TileSums> {
        // Worth depends on errors, which are not known.
        if X::CONTRIBUTIONS && !layers.is_empty() {
            return None;
        }
        self.frame.uniform_sums(tile, self.loss, polylines, layers)
    }

    fn untouched(
        &self,
        level: Level,
        job: &TileJob<'_>,
        scratch: &mut Scratch,
    ) -> Option<TileSums> {
        self.frame.untouched_sums(level, job, self.loss, scratch)
    }

    fn tile(
        &self,
        level: Level,
        job: &TileJob<'_>,
        scratch: &mut Scratch,
        sums: &mut Sums,
    ) -> TileSums {
        kernel::differentiate::<L, X>(level, job, self.loss, scratch, sums)
    }
}

/// A loss without derivatives.
struct LossAlone<'a, L> {
    frame: &'a Frame<'a>,
    loss: &'a L,
}

impl<L: CanvasLoss> BackwardPass for LossAlone<'_, L> {
    fn uniform(
        &self,
        tile: usize,
        polylines: &Polylines,
        layers: &mut [OfStroke],
    ) -> Option<TileSums> {
        self.frame.uniform_sums(tile, self.loss, polylines, layers)
    }

    fn untouched(
        &self,
        level: Level,
        job: &TileJob<'_>,
        scratch: &mut Scratch,
    ) -> Option<TileSums> {
        self.frame.untouched_sums(level, job, self.loss, scratch)
    }

    fn tile(
        &self,
        _level: Level,
        job: &TileJob<'_>,
        scratch: &mut Scratch,
        _sums: &mut Sums,
    ) -> TileSums {
        TileSums {
            loss: scratch.judge(job.tile, self.loss),
            ..TileSums::default()
        }
    }
}

/// The derivatives of the sum of two losses, each on its own backdrop.
struct Double<'a, L> {
    frames: &'a [Frame<'a>; 2],
    losses: [&'a L; 2],
}

impl<L: CanvasLoss> BackwardPass for Double<'_, L> {
    fn uniform(
        &self,
        tile: usize,
        polylines: &Polylines,
        layers: &mut [OfStroke],
    ) -> Option<TileSums> {
        // If only one of the two is known, the layers hold half a sum: the caller clears them.
        summed([0, 1].map(|i| self.frames[i].uniform_sums(tile, self.losses[i], polylines, layers)))
    }

    fn untouched(
        &self,
        level: Level,
        job: &TileJob<'_>,
        scratch: &mut Scratch,
    ) -> Option<TileSums> {
        summed([0, 1].map(|i| {
            // Without strokes the two canvases have nothing in common: each is its own backdrop.
            let job = job.on(self.frames[i].backdrop(job.tile));
            self.frames[i].untouched_sums(level, &job, self.losses[i], scratch)
        }))
    }

    fn tile(
        &self,
        level: Level,
        job: &TileJob<'_>,
        scratch: &mut Scratch,
        sums: &mut Sums,
    ) -> TileSums {
        // `job` has the first backdrop.
        let other = self.frames[1].backdrop(job.tile);
        let losses = self.losses;
        kernel::differentiate_on_mattes(level, job, other, losses, scratch, sums)
    }
}

/// The sums on two backdrops together, if both are known. The blocks of the first count.
fn summed([first, second]: [Option<TileSums>; 2]) -> Option<TileSums> {
    let (mut sums, second) = (first?, second?);
    sums.loss += second.loss;
    add(&mut sums.backdrop, &second.backdrop);
    Some(sums)
}

/// The vertices of the polyline that replaces a stroke, px. The polyline of a dot has two vertices in one place; the polyline of a
/// closed path ends where it starts.
pub fn flattened(stroke: StrokeRef<'_>) -> Vec<[f32; 2]> {
    let mut vertices = Vec::new();
    flatten(stroke, 1, &mut vertices, &mut Vec::new());
    vertices
}
