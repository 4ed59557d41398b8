//! The choice of shadows: soft shadows and glows on the page, each a blur of the shape of what casts it.
//!
//! A shadow mixes the page with one colour, by shares that change slowly. What lies among these shares, and is none of the page
//! either, casts it. Blurs of its shape, at several places, are tried against the shares, which are known where nothing covers
//! the shadow.

mod caster;
mod shares;

use crate::fit::recipe::ShadowChoice;
use crate::image::Image;
use crate::math::Vector;
use crate::scene::{Area, Path, Rgb, Shadow, Shape};
use crate::shading::Blocks;
use crate::trace::{self, Outlines};
use caster::{Cast, Search};
use shares::Shares;

/// The shadows of `picture` on a page of this colour, or on no page, back to front. None if there is nothing soft on the page,
/// or the blurs of one shape do not explain it, or their bytes cost more than they gain at `price_per_byte`.
pub(in crate::fit) fn choose(
    picture: &Image,
    page: Option<Rgb>,
    choice: &ShadowChoice,
    price_per_byte: f32,
) -> Vec<Shadow> {
    found(picture, page, choice, price_per_byte).unwrap_or_default()
}

fn found(
    picture: &Image,
    page: Option<Rgb>,
    choice: &ShadowChoice,
    price_per_byte: f32,
) -> Option<Vec<Shadow>> {
    // What is soft, unless a gradient does, and the outline of what casts it.
    let shares = Shares::of(picture, page, choice)?;
    if is_gradient(&shares, choice) {
        return None;
    }
    let rings = rings(&shares, choice, 0.0);
    let mut search = Search::of(&shares, &rings, choice)?;
    // The blurs of that outline, if they explain it and pay.
    let all = search.error();
    let casts = casts(&mut search, choice);
    let gain = (all - search.error()) * shares.contrast2;
    let is_explained = search.error() <= choice.left * all;
    if !is_explained || gain < price_per_byte * choice.bytes * casts.len() as f32 {
        return None;
    }
    let shadow = |cast: &Cast| {
        // A shape stays one; of any other outline, a blur hides most points.
        let rings = match &rings[..] {
            [ring] if Shape::of(ring).is_some() => rings.clone(),
            _ => self::rings(&shares, choice, choice.outline_of_blur * cast.blur),
        };
        let by = Vector::new(cast.shift[0], cast.shift[1]);
        let area = Area {
            rings: rings.into_iter().map(|ring| ring.map(|p| p + by)).collect(),
            color: shares.color,
            opacity: cast.opacity,
            shade: None,
        };
        Shadow::new(area, cast.blur).ok()
    };
    casts.iter().rev().map(shadow).collect()
}

/// The blurs that explain the shares: a lamp and the light of the sky make two.
fn casts(search: &mut Search<'_>, choice: &ShadowChoice) -> Vec<Cast> {
    let all = search.error();
    let mut casts = Vec::new();
    while casts.len() < choice.most && search.error() > choice.explained * all {
        let Some(cast) = search.best() else {
            break;
        };
        let before = search.error();
        search.take(&cast);
        if search.error() > choice.least_gain * before {
            break;
        }
        casts.push(cast);
    }
    casts
}

/// The outline of what casts a shadow, as exact as `tolerance` px or as the picture tells.
fn rings(shares: &Shares, choice: &ShadowChoice, tolerance: f32) -> Vec<Path> {
    let tolerance = tolerance.max(choice.outlines.tolerance);
    let outlines = Outlines {
        tolerance,
        candidates: 0.75 * tolerance,
        ..choice.outlines
    };
    let rings = trace::rings(&shares.caster.values, shares.width, &outlines);
    let shape = |ring: Path| Shape::like(&ring, choice.shape).map_or(ring, |shape| shape.ring());
    rings.into_iter().map(shape).collect()
}

/// True if the soft pixels lie along one gradient: a glow that is no blur.
fn is_gradient(shares: &Shares, choice: &ShadowChoice) -> bool {
    let size = [shares.width, shares.seen.len() / shares.width];
    let (blocks, _) = Blocks::of_page(size, choice.gradient_blocks, |pixels| {
        let soft = pixels
            .iter()
            .map(|&i| shares.seen[i].filter(|share| *share > 0.0));
        let sum: Option<f32> = soft.sum();
        sum.map(|sum| [sum / pixels.len() as f32; 4])
    });
    let found = blocks.best_shade(&choice.fit);
    found.is_some_and(|(_, met)| met.share >= choice.gradient_share)
}
