//! Rasterisers of marks: resvg takes samples, Chromium the areas of a rounded outline, others exact areas.
//!
//! [`chromium::draw`] draws whole pictures; resvg does so itself, from the file (see [`verify`](crate::verify)). Within the
//! crate, `Rasters` draws single marks by each `Rasterizer`, and says which pixels they cover.

pub mod chromium;
mod exact;
mod footprint;
mod resvg;
mod slots;

use chromium::Footprinter;
use exact::Region;
pub(crate) use footprint::Footprint;
use slots::Slots;

use crate::scene::{Mark, Stroke};

/// A way to antialias edges.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Rasterizer {
    /// By samples, as resvg does.
    Resvg,
    /// As the model of Chromium does.
    Chromium,
    /// By exact areas, nearly as Cairo does.
    Exact,
}

impl Rasterizer {
    /// All of them.
    pub(crate) const ALL: [Self; 3] = [Self::Resvg, Self::Chromium, Self::Exact];
}

/// A value for each rasteriser.
pub(crate) type PerRasterizer<T> = [T; Rasterizer::ALL.len()];

/// Draws single marks by each rasteriser on pictures of one size. One worker uses it at a time.
pub(crate) struct Rasters {
    width: usize,
    height: usize,
    chromium: Footprinter,
    slots: Slots,
}

/// Some pixels of the picture, and what draws on them.
pub(crate) struct Selection<'a> {
    pixels: &'a [u32],
    rasters: &'a mut Rasters,
}

impl Rasters {
    /// For pictures of `[width, height]` px.
    pub(crate) fn new([width, height]: [usize; 2]) -> Self {
        Self {
            width,
            height,
            chromium: Footprinter::new(width, height),
            slots: Slots::new(width * height),
        }
    }

    /// The footprint in resvg of `stroke` with its radius larger by `wider` px.
    pub(crate) fn swept(&self, stroke: &Stroke, wider: f32) -> Footprint {
        let radius = stroke.radius + wider;
        if radius <= 0.0 {
            return Footprint::default();
        }
        let stroke = Stroke {
            radius,
            ..stroke.clone()
        };
        resvg::footprint(&stroke.into(), self.width, self.height)
    }

    /// Runs `work` with these pixels selected.
    pub(crate) fn on<T>(
        &mut self,
        pixels: &[u32],
        work: impl FnOnce(&mut Selection<'_>) -> T,
    ) -> T {
        self.slots.set(pixels);
        let done = work(&mut Selection {
            pixels,
            rasters: self,
        });
        self.slots.clear(pixels);
        done
    }
}

impl Selection<'_> {
    /// The footprint of `mark`. Exact areas of strokes are known of the selected pixels alone.
    pub(crate) fn footprint(&mut self, rasterizer: Rasterizer, mark: &Mark) -> Footprint {
        let Rasters {
            width,
            height,
            ref mut chromium,
            ref slots,
        } = *self.rasters;
        match (rasterizer, mark) {
            (Rasterizer::Resvg, _) => resvg::footprint(mark, width, height),
            // Of a filled outline Chromium takes exact areas, but for the rounding of its corners to a quarter of a row.
            (Rasterizer::Chromium, _) | (Rasterizer::Exact, Mark::Area(_)) => {
                chromium.footprint(mark)
            }
            // It looks at pixels one by one, so that few pixels save time; the others fill an outline.
            (Rasterizer::Exact, Mark::Stroke(stroke)) => {
                let pixels = self.pixels;
                let region = Region {
                    pixels,
                    slots,
                    width,
                };
                exact::footprint(stroke, &region)
            }
        }
    }

    /// The selected pixels that `footprint` covers: the place of each in the selection, and its coverage, 0 to 255.
    pub(crate) fn covered(&self, footprint: &Footprint) -> impl Iterator<Item = (usize, u8)> {
        let slots = &self.rasters.slots;
        footprint
            .iter()
            .filter_map(|(pixel, level)| Some((slots.find(pixel)?, level)))
    }
}
