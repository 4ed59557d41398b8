//! The frame of one call: the edges of its strokes, and the backdrop.

use fearless_simd::Level;

use super::edge::{Edge, Reach};
use super::grid::{FULL, Grid, TileRgb, TileWeights, uniform_tile};
use super::kernel::{self, Nothing, OfStroke, Scratch, Sums, TileJob, TileSums};
use super::polylines::Polylines;
use super::strokes::STYLE;
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

    /// The sums of tile `tile`, which `layers` cover as a whole, back to front, where they are known without looking at its
    /// pixels. Adds to those of the layers.
    pub(super) fn uniform_sums(
        &self,
        tile: usize,
        loss: &impl CanvasLoss,
        polylines: &Polylines,
        layers: &mut [OfStroke],
    ) -> Option<TileSums> {
        // Layers that cover the whole tile leave one colour only on a backdrop of one colour.
        let Backdrop::Color(mut color) = self.backdrop else {
            return None;
        };
        // Lay one on another: the formulas of the kernel, for one pixel.
        let mut contrasts = Vec::with_capacity(layers.len());
        for layer in layers.iter() {
            let [_, rgb @ .., opacity] = polylines.styles[layer.id as usize];
            let contrast = [0, 1, 2].map(|channel: usize| rgb[channel] - color[channel]);
            contrasts.push(contrast);
            color = [0, 1, 2].map(|channel| color[channel] + opacity * contrast[channel]);
        }
        // `slope` is summed over the tile's pixels, so everything below is, too.
        let (loss, slope) = loss.uniform(tile, color)?;
        // Hand the derivatives by the colour of the tile back, front to back.
        let mut through = 1.0;
        for (layer, contrast) in layers.iter_mut().zip(contrasts).rev() {
            let opacity = polylines.styles[layer.id as usize][STYLE - 1];
            for channel in 0..3 {
                // ∂L/∂c = T·o·g and ∂L/∂o = T·g·(c − B), with a coverage of 1.
                layer.style[1 + channel] += through * opacity * slope[channel];
                layer.style[STYLE - 1] += through * slope[channel] * contrast[channel];
            }
            through -= through * opacity;
        }
        Some(TileSums {
            loss,
            // The backdrop shows through all layers: ∂L/∂B = T₀·g.
            backdrop: slope.map(|slope| through * slope),
            ..TileSums::default()
        })
    }

    /// The sums of the tile of `job`, which no stroke touches, if `loss` keeps them: as long as the backdrop stays, they do, too.
    pub(super) fn untouched_sums<L: CanvasLoss>(
        &self,
        level: Level,
        job: &TileJob<'_>,
        loss: &L,
        scratch: &mut Scratch,
    ) -> Option<TileSums> {
        let Backdrop::Canvas(_) = self.backdrop else {
            return None;
        };
        // The first call computes them with the usual two passes; the result is the same bits whichever thread comes first.
        let &(loss, backdrop) = loss.kept(job.tile)?.untouched.get_or_init(|| {
            kernel::draw(level, job, scratch);
            let mut none = Sums::default();
            let sums = kernel::differentiate::<L, Nothing>(level, job, loss, scratch, &mut none);
            (sums.loss, sums.backdrop)
        });
        Some(TileSums {
            loss,
            backdrop,
            blocks: 0,
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
