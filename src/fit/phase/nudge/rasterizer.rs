//! Ways to antialias the edges of strokes.

use crate::browser::Footprinter;
use crate::image::Footprint;
use crate::render::area::{self, Region, Slots};
use crate::scene::Stroke;
use crate::verify;

/// A way to antialias edges.
#[derive(Debug, Clone, Copy)]
pub(super) enum Rasterizer {
    /// By samples, as resvg does.
    Resvg,
    /// As the model of a browser does.
    Browser,
    /// By exact areas, nearly as Cairo does.
    Area,
}

/// All of them.
pub(super) const RASTERIZERS: [Rasterizer; 3] =
    [Rasterizer::Resvg, Rasterizer::Browser, Rasterizer::Area];

/// Scratch of one worker, for pictures of one size.
pub(super) struct Scratch {
    width: usize,
    height: usize,
    footprinter: Footprinter,
    slots: Slots,
}

/// Some pixels of the picture, and scratch to draw on them.
pub(super) struct Selection<'a> {
    pixels: &'a [u32],
    scratch: &'a mut Scratch,
}

impl Scratch {
    pub(super) fn new([width, height]: [usize; 2]) -> Self {
        Self {
            width,
            height,
            footprinter: Footprinter::new(width, height),
            slots: Slots::new(width * height),
        }
    }

    /// What `stroke` covers if its radius is larger by so many px.
    pub(super) fn swept(&self, stroke: &Stroke, wider: f32) -> Footprint {
        let radius = stroke.radius + wider;
        if radius <= 0.0 {
            return Footprint::default();
        }
        let stroke = Stroke {
            radius,
            ..stroke.clone()
        };
        verify::footprint(&stroke, self.width, self.height)
    }

    /// Runs `work` with these pixels chosen.
    pub(super) fn on<T>(
        &mut self,
        pixels: &[u32],
        work: impl FnOnce(&mut Selection<'_>) -> T,
    ) -> T {
        self.slots.set(pixels);
        let done = work(&mut Selection {
            pixels,
            scratch: self,
        });
        self.slots.clear(pixels);
        done
    }
}

impl Selection<'_> {
    /// What `stroke` covers. Exact areas are known of the chosen pixels alone.
    pub(super) fn footprint(&mut self, rasterizer: Rasterizer, stroke: &Stroke) -> Footprint {
        let Scratch {
            width,
            height,
            ref mut footprinter,
            ref slots,
        } = *self.scratch;
        match rasterizer {
            Rasterizer::Resvg => verify::footprint(stroke, width, height),
            Rasterizer::Browser => footprinter.footprint(stroke),
            Rasterizer::Area => area::footprint(
                stroke,
                &Region {
                    pixels: self.pixels,
                    slots,
                    width,
                },
            ),
        }
    }

    /// Of the chosen pixels, those that `footprint` covers: the place of each among them, and its coverage, 0 to 255.
    pub(super) fn chosen(&self, footprint: &Footprint) -> impl Iterator<Item = (usize, u8)> {
        let slots = &self.scratch.slots;
        footprint
            .iter()
            .filter_map(|(pixel, level)| Some((slots.find(pixel)?, level)))
    }
}
