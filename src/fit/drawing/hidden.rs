//! Hidden strokes: without them the drawing looks the same, because they are covered or have the colour of what they
//! cover. A palette makes many of them, and they are in the way of whoever edits the file.

use crate::fit::drawing::Drawing;
use crate::fit::drawing::objective::Target;
use crate::fit::halves::by_halves;
use crate::image::Image;
use crate::render::{Gradients, StrokeRef};

/// Change of a channel that cannot be seen: less than half an 8-bit level.
const UNSEEN: f32 = 0.5 / 255.0;

/// Most renders that the search may take where hidden strokes hide each other.
const MAX_RENDERS: usize = 64;

impl Drawing {
    /// Removes the hidden strokes and counts them. All strokes must be free.
    pub(in crate::fit) fn remove_hidden(&mut self) {
        let suspects = self.suspects();
        if suspects.is_empty() {
            return;
        }
        let before = self.pictures();
        let mut keep = vec![true; self.free().len()];
        let mut renders = 0;
        // Of two strokes that each hide the other, one may go.
        by_halves(suspects, |group| {
            renders += 1;
            if renders > MAX_RENDERS {
                return true;
            }
            group.iter().for_each(|&i| keep[i] = false);
            let is_unseen = self.change_without(&keep, &before) <= UNSEEN;
            group.iter().for_each(|&i| keep[i] = !is_unseen);
            is_unseen
        });
        self.counters.hidden += keep.iter().filter(|keep| !**keep).count();
        self.retain_free(&keep);
    }

    /// The free strokes that, while all others stay, change their pixels by less than can be seen, on average.
    fn suspects(&mut self) -> Vec<usize> {
        self.render();
        let surfaces = self.surfaces.iter();
        let now = surfaces.map(|s| Target::new(s.canvas.clone(), s.error_weights()));
        let now: Vec<_> = now.collect();
        let (edge, mut changes) = (self.edge(), Gradients::default());
        // Where the drawing itself is the target, a stroke is worth the squared change that it makes.
        self.differentiate::<true>(edge, Some(&now), &mut changes);
        let strokes = self.free().iter().zip(&changes.worth).enumerate();
        let unseen = strokes
            .filter(|(_, (stroke, change))| **change <= 3.0 * pixels(*stroke) * UNSEEN * UNSEEN);
        unseen.map(|(i, _)| i).collect()
    }

    /// The largest change of a channel from `before` to the strokes to `keep` alone.
    fn change_without(&mut self, keep: &[bool], before: &[Image]) -> f32 {
        let memento = self.memento();
        self.retain_free(keep);
        self.render();
        let after = self.pictures();
        self.restore(memento);
        let planes = |images: &[Image]| {
            images
                .iter()
                .flat_map(|i| i.planes().clone())
                .collect::<Vec<_>>()
        };
        let pairs = planes(before)
            .into_iter()
            .flatten()
            .zip(planes(&after).into_iter().flatten());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    }

    fn pictures(&self) -> Vec<Image> {
        let canvases = self.surfaces.iter().map(|surface| &surface.canvas);
        canvases.map(|canvas| canvas.to_image()).collect()
    }
}

/// About how many pixels a stroke covers; of an area, those of its bounding box.
fn pixels(stroke: StrokeRef<'_>) -> f32 {
    if stroke.is_area() {
        let side = |axis: usize| {
            let along = || stroke.points.iter().map(|p| p[axis]);
            along().fold(0.0, f32::max) - along().fold(f32::INFINITY, f32::min)
        };
        return side(0) * side(1);
    }
    let radius = stroke.radius();
    radius * (2.0 * stroke.length() + std::f32::consts::PI * radius)
}
