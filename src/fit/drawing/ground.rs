//! The ground of a drawing: gradient and shadows on its background, behind all marks.

use crate::fit::config::Background;
use crate::fit::drawing::{background, shading, shadows};
use crate::image::Image;
use crate::scene::{Rgb, Scene, Shade, Shadow};

/// A gradient and shadows, in this order, if there are any.
#[derive(Debug, Clone, Default)]
pub(in crate::fit) struct Ground {
    pub(in crate::fit) shade: Option<Shade>,
    pub(in crate::fit) shadows: Vec<Shadow>,
}

impl Ground {
    /// The background and the ground of a new drawing. A shade replaces the background, and a shadow lies on one of one colour
    /// that stays.
    pub(in crate::fit) fn choose(picture: &Image, price_per_byte: f32) -> (Background, Self) {
        let shade = shading::choose(picture, price_per_byte);
        if shade.is_some() {
            let shadows = Vec::new();
            return (Background::None, Self { shade, shadows });
        }
        // A transparent picture has no page, but may have shadows. An opaque one without paper has neither.
        let page = match picture.alpha() {
            Some(_) => Some(None),
            None => background::paper(picture).map(Some),
        };
        let of = |page| shadows::choose(picture, page, price_per_byte);
        let shadows = page.map_or_else(Vec::new, of);
        // The blurs were fitted on this colour, so the background has to keep it.
        let background = match page.flatten() {
            Some(color) if !shadows.is_empty() => Background::Color(color),
            _ => Background::Auto,
        };
        let shade = None;
        (background, Self { shade, shadows })
    }

    /// The ground of a scene.
    pub(in crate::fit) fn of(scene: &Scene) -> Self {
        Self {
            shade: scene.shade.clone(),
            shadows: scene.shadows.clone(),
        }
    }

    /// True if there is nothing.
    pub(in crate::fit) fn is_empty(&self) -> bool {
        self.shade.is_none() && self.shadows.is_empty()
    }

    /// An empty scene on this ground.
    pub(in crate::fit) fn scene(
        &self,
        width: usize,
        height: usize,
        background: Option<Rgb>,
    ) -> Scene {
        Scene {
            shade: self.shade.clone(),
            shadows: self.shadows.clone(),
            ..Scene::empty(width as u32, height as u32, background)
        }
    }
}
