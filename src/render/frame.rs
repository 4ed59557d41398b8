//! The input of one call: the edges of its strokes, and the backdrop behind them.

use super::edge::{Edge, Reach};
use super::flat::Flat;
use super::grid::{FULL, Grid, TileRgb, TileWeights, flat_tile};
use super::kernel::{TileJob, TileSums};
use super::{Backdrop, CanvasLoss, Softness, TileWork};

/// What one call renders.
pub(super) struct Frame<'a> {
    grid: Grid,
    backdrop: Backdrop<'a>,
    /// A tile of the backdrop's colour, if it is flat.
    flat: TileRgb,
    edge: Edge,
    pub(super) reach: Reach,
}

impl<'a> Frame<'a> {
    pub(super) fn new(grid: Grid, softness: Softness, backdrop: Backdrop<'a>) -> Self {
        let (edge, reach) = Edge::new(softness.coverage, softness.width);
        let flat = match backdrop {
            Backdrop::Color(color) => flat_tile(color),
            Backdrop::Canvas(_) => flat_tile([0.0; 3]),
        };
        Self {
            grid,
            backdrop,
            flat,
            edge,
            reach,
        }
    }

    /// The top left corner of tile `tile`, px.
    pub(super) fn origin(&self, tile: usize) -> [f32; 2] {
        let (x, y) = self.grid.origin(tile);
        [x as f32, y as f32]
    }

    /// What is behind all strokes in tile `tile`.
    pub(super) fn backdrop(&self, tile: usize) -> &TileRgb {
        match self.backdrop {
            Backdrop::Color(_) => &self.flat,
            Backdrop::Canvas(canvas) => &canvas.tiles()[tile],
        }
    }

    /// The sums of tile `tile` if no stroke touches it, where they are known without looking at its pixels.
    pub(super) fn flat_sums(&self, tile: usize, loss: &impl CanvasLoss) -> Option<TileSums> {
        let Backdrop::Color(color) = self.backdrop else {
            return None;
        };
        let (loss, backdrop) = loss.flat(tile, color)?;
        Some(TileSums {
            loss,
            backdrop,
            ..TileSums::default()
        })
    }

    /// The share of tile `tile`, behind these weights.
    pub(super) fn job<'b>(
        &'b self,
        flat: &'b Flat,
        tile: usize,
        work: &'b TileWork,
        weights: Option<&'b TileWeights>,
    ) -> TileJob<'b> {
        TileJob {
            tile,
            origin: self.origin(tile),
            flat,
            listed: &work.listed,
            segments: &work.segments,
            backdrop: self.backdrop(tile),
            weights: weights.unwrap_or(&FULL),
            edge: self.edge,
            reach: self.reach,
        }
    }
}
