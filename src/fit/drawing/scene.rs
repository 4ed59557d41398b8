//! Conversion between scenes and drawings, and our render of a finished scene.

use super::Drawing;
use crate::image::Image;
use crate::render::{Backdrop, Canvas, Strokes};
use crate::scene::{Mark, Scene, Stage};

impl Drawing {
    /// Adds the strokes of `scene`, in px of the picture, to an empty drawing.
    pub(in crate::fit) fn load(&mut self, scene: &Scene) {
        let halvings = self.surface().halvings();
        for (index, stage) in scene.stages.iter().enumerate() {
            let mut strokes = reduced(&stage.marks, halvings);
            self.free_mut().append(&mut strokes);
            self.stage_of.resize(self.len(), index);
        }
    }

    /// Our render of `scene` on each surface.
    pub(in crate::fit) fn soft(&mut self, scene: &Scene) -> Vec<Image> {
        let strokes: Strokes = scene.marks().collect();
        let mut canvas = self.surface().canvas.clone();
        let mut images = Vec::new();
        for surface in &self.surfaces {
            let backdrop = surface.backdrop_of(scene);
            self.renderer
                .forward(&strokes, self.edge, backdrop, &mut canvas);
            images.push(canvas.to_image());
        }
        images
    }

    /// The mean squared error after each layer of `scene`.
    pub(in crate::fit) fn layer_mses(&mut self, scene: &Scene) -> Vec<f64> {
        let mut canvases: Vec<Canvas> = self
            .surfaces
            .iter()
            .map(|s| s.backdrop_canvas(scene))
            .collect();
        let mut below = canvases.clone();
        let halvings = self.surface().halvings();
        let mut mses = Vec::new();
        for stage in &scene.stages {
            let strokes = reduced(&stage.marks, halvings);
            // The canvas of the layer before is the backdrop of this one, so that each stroke is rendered once.
            std::mem::swap(&mut below, &mut canvases);
            for (below, canvas) in below.iter().zip(&mut canvases) {
                let backdrop = Backdrop::Canvas(below);
                self.renderer.forward(&strokes, self.edge, backdrop, canvas);
            }
            mses.push(self.mse_of(canvases.iter()));
        }
        mses
    }

    /// The drawing as a scene in px of the picture, unrounded, with its background if `has_background`, and its ground.
    pub(in crate::fit) fn scene(&self, has_background: bool) -> Scene {
        let picture = self.surface().picture();
        let background = self.background().filter(|_| has_background);
        let [width, height] = [picture.width(), picture.height()].map(|side| side as u32);
        let mut scene = Scene {
            ground: self.ground.clone(),
            ..Scene::empty(width, height, background)
        };
        let mut strokes = self.all();
        // From px of the current resolution to px of the picture.
        enlarge(&mut strokes, self.surface().halvings());
        for (stroke, &stage) in strokes.iter().zip(&self.stage_of) {
            if scene.stages.len() <= stage {
                scene.stages.resize(stage + 1, Stage::default());
            }
            scene.stages[stage].marks.push(stroke.to_mark());
        }
        scene
    }
}

/// Makes the strokes fit a resolution `2^doublings` times as fine.
pub(super) fn enlarge(strokes: &mut Strokes, doublings: usize) {
    scale(strokes, (1_u32 << doublings) as f32);
}

/// The strokes at a resolution `2^halvings` times as coarse.
pub(super) fn reduced(marks: &[Mark], halvings: usize) -> Strokes {
    let mut strokes: Strokes = marks.iter().collect();
    scale(&mut strokes, 1.0 / (1_u32 << halvings) as f32);
    strokes
}

/// Multiplies all lengths by a power of two, which changes no digit.
fn scale(strokes: &mut Strokes, factor: f32) {
    strokes.change(|_, stroke| {
        let [radius, ..] = stroke.style;
        let lengths = stroke.points.as_flattened_mut().iter_mut();
        lengths.chain([radius]).for_each(|length| *length *= factor);
        if let Some(paint) = stroke.paint {
            paint.scale *= factor;
        }
        if let Some(sweep) = stroke.sweep {
            sweep.scale(factor.into());
        }
    });
}
