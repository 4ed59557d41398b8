//! The choice of shadows: soft shadows and glows on the page, each a blur of its caster's shape.
//!
//! A shadow mixes the page with one colour, by shares that change slowly. The caster lies among these shares
//! and differs from the page. Blurs of its shape, at several places, are compared with the shares, which are known where
//! nothing covers the shadow.

mod caster;
mod shares;

use crate::image::Image;
use crate::math;
use crate::scene::{Area, Path, Rgb, Shape};
use crate::shading::Blocks;
use crate::trace;
use caster::{Cast, Search};
use shares::Shares;

// All of these, and the constants of shares and casters, are guesses.
/// Most shadows of one thing.
const MOST: usize = 3;
/// Of the squared error, no second shadow is looked for below this share.
const EXPLAINED: f32 = 0.002;
/// A shadow has to leave less than this share of the squared error.
const LEAST_GAIN: f32 = 0.5;
/// All shadows have to leave less than this share of it.
const LEFT: f32 = 0.03;
/// Bytes of a shadow, about.
const BYTES: f32 = 300.0;
/// Farthest that the outline of a shadow may be off, in units of its blur.
const OUTLINE_OF_BLUR: f32 = 0.15;
/// Farthest that an outline may be from a circle, an ellipse or a rectangle, px, to be one.
const SHAPE: f64 = 0.8;
/// Blocks along the longer side of the picture that a gradient is fitted to.
const GRADIENT_BLOCKS: usize = 64;
/// Share of the soft ones of them that a gradient has to meet to be the better explanation.
const GRADIENT_SHARE: f32 = 0.9;

/// The shadows of `picture` on a page of this colour, or on no page, back to front. None if there is nothing soft on the page,
/// or the blurs of one shape do not explain it, or their bytes cost more than they gain at `price_per_byte`.
pub(in crate::fit) fn choose(picture: &Image, page: Option<Rgb>, price_per_byte: f32) -> Vec<Area> {
    found(picture, page, price_per_byte).unwrap_or_default()
}

fn found(picture: &Image, page: Option<Rgb>, price_per_byte: f32) -> Option<Vec<Area>> {
    // 1. The soft pixels, unless one gradient explains them, and the outline of their caster.
    let shares = Shares::of(picture, page)?;
    if is_gradient(&shares) {
        return None;
    }
    let rings = rings(&shares, 0.0);
    let mut search = Search::of(&shares, &rings)?;
    // 2. Blurs of that outline, if they explain the soft pixels and pay.
    let all = search.error();
    let casts = casts(&mut search);
    let gain = (all - search.error()) * shares.contrast2;
    let is_explained = search.error() <= LEFT * all;
    if !is_explained || gain < price_per_byte * BYTES * casts.len() as f32 {
        return None;
    }
    let shadow = |cast: &Cast| {
        // A shape stays one; of any other outline, a blur hides most points.
        let rings = match &rings[..] {
            [ring] if ring.shape().is_some() => rings.clone(),
            _ => self::rings(&shares, OUTLINE_OF_BLUR * cast.blur),
        };
        // A blur moves with its outline, so the shift is a shift of the rings.
        let by = math::point(cast.shift).to_vec2();
        let rings = rings.into_iter().map(|ring| ring.moved(by)).collect();
        let area = Area::plain(rings, shares.color, cast.opacity);
        area.blurred(cast.blur).ok()
    };
    // The first one found explains most and lies on top.
    casts.iter().rev().map(shadow).collect()
}

/// The blurs that explain the shares: a lamp and the light of the sky make two.
fn casts(search: &mut Search) -> Vec<Cast> {
    let all = search.error();
    let mut casts = Vec::new();
    while casts.len() < MOST && search.error() > EXPLAINED * all {
        let Some(cast) = search.best() else {
            break;
        };
        let before = search.error();
        // Greedy: each blur explains what the ones before it have left.
        search.take(&cast);
        if search.error() > LEAST_GAIN * before {
            break;
        }
        casts.push(cast);
    }
    casts
}

/// The outline of the caster, within `tolerance` px or as exact as the picture is.
fn rings(shares: &Shares, tolerance: f32) -> Vec<Path> {
    let rings = trace::rings(&shares.caster.values, shares.width, tolerance);
    let shape = |ring: Path| Shape::like(&ring, SHAPE).map_or(ring, Shape::path);
    rings.into_iter().map(shape).collect()
}

/// True if the soft pixels lie along one gradient: a glow that is no blur.
fn is_gradient(shares: &Shares) -> bool {
    let size = [shares.width, shares.seen.len() / shares.width];
    let (blocks, _) = Blocks::of_page(size, GRADIENT_BLOCKS, |pixels| {
        let soft = pixels
            .iter()
            .map(|&i| shares.seen[i].filter(|share| *share > 0.0));
        let sum: Option<f32> = soft.sum();
        sum.map(|sum| [sum / pixels.len() as f32; 4])
    });
    let found = blocks.best_shade();
    found.is_some_and(|(_, met)| met.share >= GRADIENT_SHARE)
}
