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
use crate::math;
use crate::scene::{Area, Blurs, Rgb, Shade};
use crate::shading::Blocks;
use groups::Scene;
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
    let (scene, price) = (Scene::new(&surfaces, &things), terms.price_of_shadow());
    let groups = scene.with_floors(scene.groups(), price);
    let ground = scene.ground(groups, price).into_iter();
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
        let page = |&matte: &Rgb| {
            let of = |x: usize, y: usize| match self {
                Self::Clear => matte,
                Self::Color(color) => *color,
                Self::Shade(shade) => {
                    let at = math::point([x as f32 + 0.5, y as f32 + 0.5]);
                    let (color, opacity) = shade.at(at);
                    std::array::from_fn(|c| matte[c] + opacity * (color[c] - matte[c]))
                }
            };
            let (width, height) = (picture.width(), picture.height());
            let plane = |c: usize| {
                let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
                places.map(|(x, y)| of(x, y)[c]).collect()
            };
            (
                matte,
                Image::from_planes(width, height, [0, 1, 2].map(plane)),
            )
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
    let size = [surfaces.width(), surfaces.len() / surfaces.width()];
    let (blocks, _) = Blocks::of_page(size, GRADIENT_BLOCKS, |pixels| {
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
