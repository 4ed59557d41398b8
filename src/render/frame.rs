//! The frame of one call: the edges of its strokes, and the backdrop.

use super::edge::{Edge, Reach};
use super::grid::{FULL, Grid, TileRgb, TileWeights, uniform_tile};
use super::kernel::{TileJob, TileSums};
use super::polylines::Polylines;
use super::{Backdrop, CanvasLoss, Softness, TileWork};

/// Edges and backdrop of one call.
pub(super) struct Frame<'a> {
    grid: Grid,
    backdrop: Backdrop<'a>,
    /// A tile of the backdrop's colour, if it has one.
    uniform: TileRgb,
    edge: Edge,
    pub(super) reach: Reach,
}

impl<'a> Frame<'a> {
    pub(super) fn new(grid: Grid, softness: Softness, backdrop: Backdrop<'a>) -> Self {
        let (edge, reach) = Edge::new(softness.coverage, softness.width);
        let uniform = match backdrop {
            Backdrop::Color(color) => uniform_tile(color),
            Backdrop::Canvas(_) => uniform_tile([0.0; 3]),
        };
        Self {
            grid,
            backdrop,
            uniform,
            edge,
            reach,
        }
    }

    /// The top left corner of tile `tile`, px.
    pub(super) fn origin(&self, tile: usize) -> [f32; 2] {
        let (x, y) = self.grid.origin(tile);
        [x as f32, y as f32]
    }

    /// The backdrop in tile `tile`.
    pub(super) fn backdrop(&self, tile: usize) -> &TileRgb {
        match self.backdrop {
            Backdrop::Color(_) => &self.uniform,
            Backdrop::Canvas(canvas) => &canvas.tiles()[tile],
        }
    }

    /// The sums of tile `tile` if no stroke touches it, where they are known without looking at its pixels.
    pub(super) fn uniform_sums(&self, tile: usize, loss: &impl CanvasLoss) -> Option<TileSums> {
        let Backdrop::Color(color) = self.backdrop else {
            return None;
        };
        let (loss, backdrop) = loss.uniform(tile, color)?;
        Some(TileSums {
            loss,
            backdrop,
            ..TileSums::default()
        })
    }

    /// The share of tile `tile`, behind these weights.
    pub(super) fn job<'b>(
        &'b self,
        polylines: &'b Polylines,
        tile: usize,
        work: &'b TileWork,
        weights: Option<&'b TileWeights>,
    ) -> TileJob<'b> {
        TileJob {
            tile,
            origin: self.origin(tile),
            polylines,
            listed: &work.listed,
            segments: &work.segments,
            backdrop: self.backdrop(tile),
            weights: weights.unwrap_or(&FULL),
            edge: self.edge,
            reach: self.reach,
        }
    }
}
