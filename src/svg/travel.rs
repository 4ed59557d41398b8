//! The travel of a pen that draws a file: its ways along strokes, and between them.

use serde::{Deserialize, Serialize};

use super::arrange;
use super::layer::{Layer, Written};
use super::options::{Order, WriteOptions};
use super::tour;
use crate::scene::{Path, Scene};

/// Travel of a pen that draws a file, in px of the picture. The ways to the first stroke of a layer and from its last
/// one are not counted: that is where pens are changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Travel {
    /// Travel between strokes in the order that they were fitted in.
    pub before_px: f64,
    /// Travel between strokes in the order of the file.
    pub after_px: f64,
    /// One per layer of the file, in order.
    pub layers: Vec<LayerTravel>,
}

/// Travel of a pen that draws a layer, in px of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LayerTravel {
    /// Strokes of the layer.
    pub strokes: usize,
    /// Length of their centre lines.
    pub drawn_px: f64,
    /// Travel in the order that they were fitted in.
    pub before_px: f64,
    /// Travel in the order of the file.
    pub after_px: f64,
}

/// Travel of a pen that draws the file that [`write`](super::write()) makes of the scene; `None` unless the file is in
/// an order of little travel.
pub fn travel(scene: &Scene, options: &WriteOptions) -> Option<Travel> {
    if options.order != Order::Travel {
        return None;
    }
    let scene = scene.quantized(options.precision).scene;
    // The same layers without the tour, so that both numbers are of the same strokes.
    let fitted = WriteOptions {
        order: Order::Fitted,
        ..*options
    };
    let (before, after) = (
        arrange::layers(&scene, &fitted),
        arrange::layers(&scene, options),
    );
    let layers: Vec<_> = before
        .iter()
        .zip(&after)
        .map(|(before, after)| layer_travel(before, after))
        .collect();
    let sum = |px: fn(&LayerTravel) -> f64| layers.iter().map(px).sum();
    Some(Travel {
        before_px: sum(|layer| layer.before_px),
        after_px: sum(|layer| layer.after_px),
        layers,
    })
}

fn layer_travel(before: &Layer, after: &Layer) -> LayerTravel {
    LayerTravel {
        strokes: after.strokes.len(),
        drawn_px: after.strokes.iter().map(drawn).sum(),
        before_px: tour::between(&before.strokes),
        after_px: tour::between(&after.strokes),
    }
}

/// Largest distance of chords from the curve whose length they give, px.
const CHORD: f64 = 1e-3;

/// Length of the paths of a mark, px.
fn drawn(stroke: &Written) -> f64 {
    let length = |path: &Path| {
        let corners = path.flattened(CHORD);
        let lengths = corners.windows(2).map(|ends| ends[0].distance(ends[1]));
        lengths.sum::<f64>()
    };
    stroke.paths().iter().map(length).sum()
}
