//! The choice of shadows: soft shadows and glows, each a blur of the shape of what casts it.
//!
//! ```text
//! surfaces  what shadows fall on, the soft pixels on it, and the picture in full light
//! things    the shapes of that, back to front, and which of them soft pixels surround
//! groups    which of them cast their shadows together, and what these are seen on
//! floor     shadows of no thing's shape
//! shadow    the blurs of a shape, in one ink
//! ink       the colour that a shadow mixes surfaces with
//! caster    the search for a blur
//! region    the box around things and their shadows
//! steps     blurs for programs without filters
//! ```
//!
//! A shadow lies below what casts it and on all that is below that. So the things that a shadow is seen on go with it below the marks.

mod caster;
mod floor;
mod groups;
mod ink;
mod region;
mod shadow;
mod steps;
mod surfaces;
mod things;

use crate::image::Image;
use crate::render;
use crate::scene::{Area, Blurs, Rgb, Scene, Shade};
use crate::shading::Blocks;
use groups::Shaded;
use surfaces::{Base, MIXED, Surfaces};
pub(in crate::fit) use things::Terms;
use things::Things;

// All of these are guesses.
/// Least share of the pixels that is soft, and least share that shows a surface.
const LEAST_SOFT: f32 = 0.002;
const LEAST_SEEN: f32 = 0.5;
/// Farthest that the outline of a shadow may be off, in units of its blur.
const OUTLINE_OF_BLUR: f32 = 0.15;
/// Farthest that an outline may be from a circle, an ellipse or a rectangle, px, to be one.
const SHAPE: f64 = 0.8;
/// Blocks along the longer side of the picture that a gradient is fitted to.
const GRADIENT_BLOCKS: usize = 64;
/// Share of the soft ones of them that a gradient has to meet to be the better explanation.
const GRADIENT_SHARE: f32 = 0.9;

/// The page that shadows fall on.
pub(in crate::fit) enum Page {
    /// None: the picture is transparent there.
    Clear,
    Color(Rgb),
    Shade(Shade),
}

/// The shadows of `picture`, and the things that they are seen on, back to front. There is none if nothing is soft on a surface, or
/// the blurs of a shape do not explain it, or their bytes cost more than they gain.
pub(in crate::fit) fn choose(picture: &Image, page: &Page, terms: &Terms<'_>) -> Vec<Area> {
    found(picture, page, terms).unwrap_or_default()
}

fn found(picture: &Image, page: &Page, terms: &Terms<'_>) -> Option<Vec<Area>> {
    // 1. The soft pixels, unless one gradient explains them.
    let surfaces = Surfaces::of(picture, page.base());
    let [seen, soft] = surfaces.shares();
    if soft < LEAST_SOFT || seen < LEAST_SEEN || is_gradient(&surfaces) {
        return None;
    }
    // 2. The things in full light, and those that soft pixels surround.
    let things = Things::of(&surfaces, page, terms);
    // 3. Blurs of these that explain soft pixels and pay, with what they are seen on.
    let (shaded, price) = (Shaded::new(&surfaces, &things), terms.price_of_shadow());
    let groups = shaded.with_floors(shaded.groups(), price);
    let ground = shaded.ground(groups, price).into_iter();
    Some(match terms.blurs {
        Blurs::Filter => ground.collect(),
        Blurs::Steps => ground.flat_map(without_blur).collect(),
    })
}

/// The areas that draw an area without a filter.
fn without_blur(area: Area) -> Vec<Area> {
    match area.blur > 0.0 {
        true => steps::of(&area),
        false => vec![area],
    }
}

impl Page {
    fn base(&self) -> Base {
        match self {
            Self::Clear => Base::Color([0.0; 4]),
            Self::Color([r, g, b]) => Base::Color([*r, *g, *b, 1.0]),
            Self::Shade(shade) => Base::Shade(shade.clone()),
        }
    }

    /// The page on each matte that a picture is seen on.
    fn behind(&self, picture: &Image) -> Vec<(Rgb, Image)> {
        let mattes: &[Rgb] = match picture.alpha() {
            Some(_) => &[[0.0; 3], [1.0; 3]],
            None => &[[1.0; 3]],
        };
        let size = [picture.width(), picture.height()];
        let [width, height] = size.map(|side| side as u32);
        let empty = Scene::empty(width, height, None);
        let scene = match self {
            Self::Clear => empty,
            Self::Color(color) => Scene {
                background: Some(*color),
                ..empty
            },
            Self::Shade(shade) => Scene {
                ground: vec![Area::page(shade.clone(), [width, height])],
                ..empty
            },
        };
        let page = |&matte: &Rgb| {
            let planes = render::ground(&scene, matte);
            (matte, Image::from_planes(size[0], size[1], planes))
        };
        mattes.iter().map(page).collect()
    }
}

/// True if the soft pixels of the page lie along one gradient, and no others are soft: a glow that is no blur.
fn is_gradient(surfaces: &Surfaces<'_>) -> bool {
    let soft = (0..surfaces.len()).filter(|&i| surfaces.is_soft(i));
    if soft
        .clone()
        .any(|i| surfaces.at(i).is_none_or(|(surface, _)| surface > 0))
    {
        return false;
    }
    let pixels = soft.map(|i| (surfaces.value(i), surfaces.base(0, i)));
    let Some(ink) = ink::of(pixels, MIXED) else {
        return false;
    };
    let (blocks, _) = Blocks::of_page(surfaces.size(), GRADIENT_BLOCKS, |pixels| {
        let share = |&i: &usize| {
            let (share, away) = ink::share(surfaces.value(i), surfaces.base(0, i), ink);
            (surfaces.is_soft(i) && share > 0.0 && away <= MIXED).then_some(share)
        };
        let sum: Option<f32> = pixels.iter().map(share).sum();
        sum.map(|sum| [sum / pixels.len() as f32; 4])
    });
    let found = blocks.best_shade();
    found.is_some_and(|(_, met)| met.share >= GRADIENT_SHARE)
}
