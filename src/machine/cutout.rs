//! Cut-outs: areas that do not overlap and share their borders, for cutters and for one sheet of foil per colour.

use super::regions;
use crate::error::Result;
use crate::scene::{Area, Scene, Stage, color};

/// The visible parts of the scene as one area per colour. The background is one of them, if there is
/// one; so the scene has none.
///
/// # Errors
/// [`ErrorKind::Config`](crate::ErrorKind::Config) when a mark is translucent, and
/// [`ErrorKind::Svg`](crate::ErrorKind::Svg) when the outlines cannot be told apart.
pub fn cut_out(scene: &Scene) -> Result<Scene> {
    let regions = regions::regions(scene)?.into_iter();
    let areas = regions.map(|region| Area {
        rings: region.rings,
        color: color(region.color),
        opacity: 1.0,
    });
    let areas = areas.filter(|area| !area.rings.is_empty());
    let cut = Scene {
        background: None,
        shade: None,
        stages: areas.map(|area| Stage::from_iter([area])).collect(),
        ..*scene
    };
    Ok(cut.confined())
}
