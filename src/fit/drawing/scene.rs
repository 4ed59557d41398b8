//! Conversion between scenes and drawings, and our render of a finished scene.

use super::Drawing;
use crate::image::Image;
use crate::render::{AX, Backdrop, Canvas, Params, RADIUS, pack, unpack};
use crate::scene::{Scene, Stage};

impl Drawing {
    /// Adds the strokes of `scene`, in px of the picture, to an empty drawing.
    pub(in crate::fit) fn load(&mut self, scene: &Scene) {
        let halvings = self.surface().halvings();
        for (index, stage) in scene.stages.iter().enumerate() {
            let strokes = stage.strokes.iter().map(|s| reduced(pack(s), halvings));
            self.extend(strokes, index);
        }
    }

    /// Our render of `scene` on each surface.
    pub(in crate::fit) fn soft(&mut self, scene: &Scene) -> Vec<Image> {
        let strokes: Vec<Params> = scene.strokes().map(pack).collect();
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
        let mut canvases: Vec<Canvas> = self.surfaces.iter().map(|s| s.empty(scene)).collect();
        let mut below = canvases.clone();
        let halvings = self.surface().halvings();
        let mut mses = Vec::new();
        for stage in &scene.stages {
            let strokes: Vec<Params> = stage
                .strokes
                .iter()
                .map(|s| reduced(pack(s), halvings))
                .collect();
            std::mem::swap(&mut below, &mut canvases);
            for (below, canvas) in below.iter().zip(&mut canvases) {
                let backdrop = Backdrop::Canvas(below);
                self.renderer.forward(&strokes, self.edge, backdrop, canvas);
            }
            mses.push(self.mse_of(canvases.iter()));
        }
        mses
    }

    /// The drawing as a scene in px of the picture, unrounded, with its background if `has_background`.
    pub(in crate::fit) fn scene(&self, has_background: bool) -> Scene {
        let picture = self.surface().picture();
        let background = self.background().filter(|_| has_background);
        let mut scene = Scene::empty(picture.width() as u32, picture.height() as u32, background);
        let halvings = self.surface().halvings();
        for (&stroke, &stage) in self.strokes.iter().zip(&self.stage_of) {
            if scene.stages.len() <= stage {
                scene.stages.resize(stage + 1, Stage::default());
            }
            scene.stages[stage]
                .strokes
                .push(unpack(&enlarged(stroke, halvings)));
        }
        scene
    }
}

/// The stroke at a resolution `2^doublings` times as fine.
pub(super) fn enlarged(mut stroke: Params, doublings: usize) -> Params {
    let factor = (1_u32 << doublings) as f32;
    for length in &mut stroke[AX..=RADIUS] {
        *length *= factor;
    }
    stroke
}

/// The stroke at a resolution `2^halvings` times as coarse.
fn reduced(mut stroke: Params, halvings: usize) -> Params {
    let factor = (1_u32 << halvings) as f32;
    for length in &mut stroke[AX..=RADIUS] {
        *length /= factor;
    }
    stroke
}
