//! Cut-outs: areas that do not overlap and share their borders, for cutters and for one sheet of foil per colour.

use super::visible;
use crate::error::Result;
use crate::scene::{Scene, Stage};

/// The visible parts of the scene as one area per colour. The background is one of them, if there is
/// one; so the scene has none.
///
/// # Errors
/// [`ErrorKind::Config`](crate::ErrorKind::Config) when a mark is translucent, and
/// [`ErrorKind::Svg`](crate::ErrorKind::Svg) when the outlines cannot be told apart.
pub fn cut_out(scene: &Scene) -> Result<Scene> {
    let areas = visible::areas(scene)?.into_iter();
    let areas = areas.filter(|area| !area.rings.is_empty());
    let cut = Scene {
        background: None,
        shade: None,
        shadows: Vec::new(),
        stages: areas.map(|area| Stage::from_iter([area])).collect(),
        ..*scene
    };
    Ok(cut.confined())
}
