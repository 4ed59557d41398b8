//! The choice of shadows: soft shadows and glows on the page, each a blur of the shape of what casts it.
//!
//! A shadow mixes the page with one colour, by shares that change slowly. What lies among these shares, and is none of the page
//! either, casts it. Blurs of its shape, at several places, are tried against the shares, which are known where nothing covers
//! the shadow.

mod caster;
mod shares;

use crate::fit::recipe::ShadowChoice;
use crate::image::Image;
use crate::math::{Point, Vector};
use crate::render::{self, Plane};
use crate::scene::{Area, Path, Rgb, Shadow, Shape};
use crate::shading::{Block, Blocks};
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
    let shares = Shares::of(picture, page, choice)?;
    if is_gradient(&shares, choice) {
        return None;
    }
    let rings = rings(&shares, choice, 0.0);
    let mut search = Search::of(&shares, &rings, choice)?;
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
    let caster = Plane {
        width: shares.width,
        values: shares.caster.clone(),
    };
    let smooth = render::blurred(caster, choice.outline_blur);
    let rings = trace::rings(&smooth.values, shares.width, &outlines);
    let shape = |ring: Path| Shape::like(&ring, choice.shape).map_or(ring, |shape| shape.ring());
    rings.into_iter().map(shape).collect()
}

/// True if the soft pixels lie along one gradient: a glow that is no blur.
fn is_gradient(shares: &Shares, choice: &ShadowChoice) -> bool {
    let (width, height) = (shares.width, shares.seen.len() / shares.width);
    let side = width.max(height).div_ceil(choice.gradient_blocks).max(1);
    let [columns, rows] = [width, height].map(|pixels| pixels.div_ceil(side));
    let block = |k: usize| {
        let [x, y] = [k % columns * side, k / columns * side];
        let center = Point::new(x as f32 + side as f32 / 2.0, y as f32 + side as f32 / 2.0);
        let [right, below] = [(x + side).min(width), (y + side).min(height)];
        let pixels = (y..below).flat_map(|y| (x..right).map(move |x| y * width + x));
        let soft = pixels.map(|i| shares.seen[i].filter(|share| *share > 0.0));
        let soft: Option<Vec<f32>> = soft.collect();
        let share = soft.map(|soft| soft.iter().sum::<f32>() / soft.len() as f32);
        Block {
            center,
            value: [share.unwrap_or(0.0); 4],
            weight: if share.is_some() { 1.0 } else { 0.0 },
        }
    };
    let blocks = Blocks {
        columns,
        all: (0..columns * rows).map(block).collect(),
        low: [0.0; 2],
        size: [width as f32, height as f32],
    };
    let found = blocks.best_shade(&choice.fit);
    found.is_some_and(|(_, met)| met.share >= choice.gradient_share)
}
