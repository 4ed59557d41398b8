//! The task of a fit: what it draws, and how.

use std::sync::{Arc, OnceLock};

use super::base::Base;
use super::budget::price::Price;
use super::budget::reduction;
use super::config::{Background, Config};
use super::drawing::background;
use super::drawing::focus::Focus;
use crate::error::{Error, Result};
use crate::image::Image;
use crate::restore::Doubt;
use crate::scene::{Area, Scene};

/// What a fit draws, and how.
#[derive(Clone)]
pub(super) struct Task {
    pub(super) config: Config,
    pub(super) base: Option<Base>,
    /// Where errors count, if not everywhere alike.
    pub(super) focus: Option<Focus>,
    /// Size of the picture, px, if a reduced one is drawn.
    pub(super) page: Option<[u32; 2]>,
    /// How far the picture may be from what it means.
    pub(super) doubt: Doubt,
    /// How much more quality a drawing on paper needs for want of contrast, dB; `None` of other pictures.
    pub(super) paleness_db: Option<f64>,
    /// Most marks that areas are split into.
    pub(super) most_marks: usize,
    /// The background and the ground of all drawings of the picture, once they are found.
    pub(super) ground: Arc<OnceLock<(Background, Vec<Area>)>>,
}

impl Task {
    /// A task with this configuration.
    pub(super) fn new(config: Config) -> Self {
        Self {
            config,
            base: None,
            focus: None,
            page: None,
            doubt: Doubt::default(),
            paleness_db: None,
            most_marks: usize::MAX,
            ground: Arc::default(),
        }
    }

    /// The price of what is drawn of a picture of `pixels` pixels.
    pub(super) fn price(&self, pixels: usize) -> Price {
        Price::of(
            &self.config,
            self.doubt.most(),
            self.paleness_db.unwrap_or(0.0),
            pixels,
        )
    }

    /// This task by another configuration.
    pub(super) fn with(&self, config: Config) -> Self {
        Self {
            config,
            ..self.clone()
        }
    }

    /// Checks the configuration and the base against `picture`, and decides on the background for opaque strokes.
    pub(super) fn prepare(&mut self, picture: &Image) -> Result<()> {
        let config = &mut self.config;
        config.check()?;
        config.background = background::for_strokes(config.background, config.opaque, picture);
        if let Some(focus) = &self.focus {
            focus.check_size(picture)?;
        }
        if let Some(base) = &self.base {
            check_size(&base.scene, picture)?;
            // The palette does not apply to a document, whose background is its own.
            if let (None, Some(color)) = (&base.document, base.scene.background) {
                config.check_background(color, ", since the base stays on it")?;
            }
        }
        Ok(())
    }

    /// The picture reduced to the pixels that its drawing needs, if these are fewer, or to the size that its base was drawn at.
    pub(super) fn reduce(&mut self, picture: &Image) -> Option<Image> {
        let side = |px: usize| u32::try_from(px).unwrap_or(u32::MAX);
        let page = [side(picture.width()), side(picture.height())];
        let [width, height] = match &self.base {
            Some(base) if base.document.is_some() || base.scene.page != Some(page) => return None,
            Some(base) => [base.scene.width, base.scene.height].map(|px| px as usize),
            None => reduction::size(picture, &self.config)?,
        };
        // A page of a given width has the proportions of the drawing.
        self.page = Some(page).filter(|_| self.config.file.width.is_none());
        self.focus = self.focus.take().map(|focus| focus.reduced(width, height));
        Some(picture.reduced(width, height))
    }
}

fn check_size(scene: &Scene, picture: &Image) -> Result<()> {
    let (width, height) = (picture.width(), picture.height());
    let is_of_size = |[w, h]: [u32; 2]| (w as usize, h as usize) == (width, height);
    if is_of_size([scene.width, scene.height]) || scene.page.is_some_and(is_of_size) {
        return Ok(());
    }
    let message = format!(
        "the drawing of {}×{} px is no base for a picture of {width}×{height} px: scale the picture",
        scene.width, scene.height
    );
    Err(Error::config(message))
}
