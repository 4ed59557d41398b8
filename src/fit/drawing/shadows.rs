//! The choice of shadows: soft shadows and glows, each a blur of the shape of what casts it.
//!
//! ```text
//! surfaces  what shadows fall on, the soft pixels on it, and the picture in full light
//! things    the shapes of that, back to front, and which of them soft pixels surround
//! ink       the colour that a shadow mixes surfaces with
//! caster    the blurs of a shape that meet the soft pixels best
//! steps     blurs for programs without filters
//! ```
//!
//! A shadow lies below what casts it and on all that is below that. So the things that a shadow is seen on go with it below the marks.

mod caster;
mod ink;
mod region;
mod steps;
mod surfaces;
mod things;

use std::collections::{BTreeMap, BTreeSet};

use kurbo::Rect;

use crate::image::Image;
use crate::math;
use crate::render::{Plane, blurred};
use crate::scene::{Area, Blurs, Mark, Path, Rgb, Shade, Shape, quantized_anywhere};
use crate::shading::{Blocks, Value};
use crate::trace;
use caster::{Cast, Search};
use region::Region;
use surfaces::{Base, FLAT, Light, MIXED, Surfaces};
pub(in crate::fit) use things::Terms;
use things::Things;

// All of these, and the constants of surfaces, things and casters, are guesses.
/// Least share of the pixels that is soft, and least share that shows a surface.
const LEAST_SOFT: f32 = 0.002;
const LEAST_SEEN: f32 = 0.5;
/// Most casters that each cast shadows of their own.
const MOST_CASTERS: usize = 16;
/// Number of times that their shadows are fitted beside each other.
const ROUNDS: usize = 2;
/// Most shadows of one thing.
const MOST: usize = 3;
/// Of the squared error, no second shadow is looked for below this share.
const EXPLAINED: f32 = 0.002;
/// A shadow beside another one has to leave less than this share of the squared error.
const LEAST_GAIN: f32 = 0.5;
/// All shadows of a thing have to leave less than this share of it, where they are seen.
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
/// Decimals of things that shadows are seen on.
const PRECISION: u8 = 2;

/// The page that shadows fall on.
pub(in crate::fit) enum Page {
    /// None: the picture is transparent there.
    Clear,
    Color(Rgb),
    Shade(Shade),
}

/// The shadows of `picture`, and the things that they are seen on, back to front. There is none if nothing is soft on a surface, or
/// the blurs of a shape do not explain it, or their bytes cost more than they gain at `price_per_byte`.
pub(in crate::fit) fn choose(
    picture: &Image,
    page: &Page,
    price_per_byte: f32,
    terms: &Terms<impl Fn(&Mark) -> f32 + Sync>,
) -> Vec<Area> {
    found(picture, page, price_per_byte, terms).unwrap_or_default()
}

fn found(
    picture: &Image,
    page: &Page,
    price_per_byte: f32,
    terms: &Terms<impl Fn(&Mark) -> f32 + Sync>,
) -> Option<Vec<Area>> {
    // 1. The soft pixels, unless one gradient explains them.
    let surfaces = Surfaces::of(picture, page.base());
    let [seen, soft] = surfaces.shares();
    if soft < LEAST_SOFT || seen < LEAST_SEEN || is_gradient(&surfaces) {
        return None;
    }
    // 2. The things in full light, and those that soft pixels surround.
    let things = Things::of(&surfaces, page, terms);
    // 3. Blurs of these, all alike or each its own.
    let scene = Scene {
        surfaces: &surfaces,
        things: &things,
    };
    let groups = scene.groups()?;
    // 4. Those that explain soft pixels and pay, with what they are seen on.
    let ground = scene.ground(groups, price_per_byte).into_iter();
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

/// The things of a picture, and the surfaces that their shadows are seen on.
struct Scene<'a> {
    surfaces: &'a Surfaces<'a>,
    things: &'a Things,
}

/// Things that cast their shadows as one.
struct Group {
    things: Vec<usize>,
    casters: Vec<Area>,
    region: Region,
    mask: Plane,
    ink: Value,
    casts: Vec<Cast>,
}

impl Group {
    /// The lowest of its things, above the shadow.
    fn lowest(&self) -> usize {
        self.things[0]
    }

    /// The share of the ink at each pixel of the region, of all of its casts.
    fn cast(&self) -> Vec<f32> {
        let mut through = vec![1.0; self.mask.values.len()];
        for cast in &self.casts {
            let soft = blurred(self.mask.clone(), cast.blur);
            for (i, through) in through.iter_mut().enumerate() {
                *through *= 1.0 - cast.opacity * caster::at(&soft, i, cast.shift);
            }
        }
        through.into_iter().map(|through| 1.0 - through).collect()
    }
}

impl Scene<'_> {
    /// The groups of casters with their shadows: all as one, or each its own if that leaves less.
    fn groups(&self) -> Option<Vec<Group>> {
        let casters = &self.things.casters;
        if casters.is_empty() {
            return None;
        }
        let values: Vec<Value> = (0..self.surfaces.len())
            .map(|i| self.surfaces.value(i))
            .collect();
        let explained = |mut groups: Vec<Group>| {
            let left = self.without(&values, &groups);
            groups.retain(|group| self.is_explained(group, &left));
            let left = self.without(&values, &groups);
            (self.error(&left), groups)
        };
        // One on another casts no shadow together with that.
        let lowest = casters.iter().min().copied().unwrap_or_default();
        let is_light =
            |i: usize, light: Light| self.surfaces.at(i).is_some_and(|own| own.1 == light);
        let soft = (0..values.len()).filter(|&i| is_light(i, Light::Soft));
        let is_above = |&i: &usize| self.things.top[i].is_some_and(|top| top >= lowest);
        let above = soft.clone().filter(is_above).count();
        let is_stack = self.things.may_be_below && above as f32 > LEFT * soft.count() as f32;
        let all = match is_stack {
            true => None,
            false => self.fitted(casters.clone(), &values),
        };
        let one = explained(all.into_iter().collect());
        let is_enough = casters.len() == 1 && !is_stack || one.0 <= LEFT * self.error(&values);
        if is_enough || casters.len() > MOST_CASTERS {
            return Some(one.1);
        }
        // Each from what the ones before it have left, and then again from what all others leave.
        let mut groups: Vec<Group> = Vec::new();
        for &caster in casters {
            let left = self.without(&values, &groups);
            groups.extend(self.fitted(vec![caster], &left));
        }
        let count = groups.len();
        for k in (0..ROUNDS * count).map(|turn| turn % count) {
            let seen = |group: &Group| self.seen(group).into_iter().collect::<BTreeSet<usize>>();
            let own = seen(&groups[k]);
            let others = groups.iter().enumerate().filter(|(i, _)| *i != k);
            let others: Vec<&Group> = others.map(|(_, group)| group).collect();
            if others.iter().all(|other| seen(other).is_disjoint(&own)) {
                continue;
            }
            let left = self.without(&values, others);
            if let Some(group) = self.fitted(groups[k].things.clone(), &left) {
                groups[k] = group;
            }
        }
        let own = explained(groups);
        Some(if own.0 < one.0 { own.1 } else { one.1 })
    }

    /// The squared error of soft pixels with these values.
    fn error(&self, values: &[Value]) -> f32 {
        let soft = (0..values.len()).filter_map(|i| match self.surfaces.at(i)? {
            (surface, Light::Soft) => {
                Some(ink::distance2(values[i], self.surfaces.base(surface, i)))
            }
            _ => None,
        });
        soft.sum()
    }

    /// The surface and the value in full light of a pixel that shows how a shadow below a thing falls.
    fn shows(&self, i: usize, below: usize) -> Option<Value> {
        let (surface, light) = self.surfaces.at(i)?;
        // What a fit would move is no part of the ground.
        let is_below = self.things.top[i].is_none_or(|top| self.things.may_be_below && top < below);
        (is_below && light != Light::Rim).then(|| self.surfaces.base(surface, i))
    }

    /// The shadows of things together, from what others have left of the values.
    fn fitted(&self, mut things: Vec<usize>, values: &[Value]) -> Option<Group> {
        things.sort_unstable();
        let size = self.size();
        let casters: Vec<Area> = things.iter().map(|&k| self.things.cast_by(k)).collect();
        let (region, mask, reach) = caster::reach_of(casters.iter(), size);
        let lowest = *things.first()?;
        let known = |i: usize| Some((values[i], self.shows(i, lowest)?));
        let pixels = region.pixels(size).filter_map(|(_, i)| known(i));
        let ink = ink::of(
            pixels.filter(|(value, base)| surfaces::away(*value, *base) > FLAT),
            MIXED,
        )?;
        let mut search = Search::of((&region, &mask, reach), size, |i| {
            let (value, base) = known(i)?;
            let (share, away) = ink::share(value, base, ink);
            let contrast2 = ink::distance2(ink, base);
            (away <= MIXED).then_some((share, contrast2))
        })?;
        let all = search.error();
        let mut casts = Vec::new();
        while casts.len() < MOST && search.error() > EXPLAINED * all {
            let Some(cast) = search.best() else {
                break;
            };
            let before = search.error();
            // Greedy: each blur explains what the ones before it have left.
            search.take(&cast);
            if !casts.is_empty() && search.error() > LEAST_GAIN * before {
                break;
            }
            casts.push(cast);
        }
        (!casts.is_empty()).then_some(Group {
            things,
            casters,
            region,
            mask,
            ink,
            casts,
        })
    }

    /// The values without the shadows of groups.
    fn without<'g>(
        &self,
        values: &[Value],
        groups: impl IntoIterator<Item = &'g Group>,
    ) -> Vec<Value> {
        let size = self.size();
        let mut left = values.to_vec();
        for group in groups {
            let shares = group.cast();
            for (k, i) in group.region.pixels(size) {
                if self.shows(i, group.lowest()).is_some() {
                    // v = s·ink + (1 − s)·u, with u the value without the shadow.
                    let share = shares[k].min(0.98);
                    left[i] = std::array::from_fn(|c| {
                        (left[i][c] - share * group.ink[c]) / (1.0 - share)
                    });
                }
            }
        }
        left
    }

    /// True if the shadows of a group leave little of the squared error where they are seen.
    fn is_explained(&self, group: &Group, left: &[Value]) -> bool {
        let [all, left] = self.errors(group, left);
        left <= LEFT * all
    }

    /// The squared error where the shadows of a group are seen: of the surfaces in full light, and with these values.
    fn errors(&self, group: &Group, left: &[Value]) -> [f32; 2] {
        let seen = self.seen(group).into_iter().filter_map(|i| {
            let base = self.shows(i, group.lowest())?;
            Some([self.surfaces.value(i), left[i]].map(|value| ink::distance2(value, base)))
        });
        seen.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]])
    }

    /// The pixels that the shadows of a group change.
    fn seen(&self, group: &Group) -> Vec<usize> {
        let shares = group.cast();
        let pixels = group.region.pixels(self.size());
        let seen =
            pixels.filter(|&(k, i)| shares[k] > FLAT && self.shows(i, group.lowest()).is_some());
        seen.map(|(_, i)| i).collect()
    }

    /// True if the border of the page cuts off nothing of an area.
    fn is_on_page(&self, area: &Area) -> bool {
        let [width, height] = self.size().map(|side| side as f64);
        let inner = Rect::new(1.0, 1.0, width - 1.0, height - 1.0);
        let bounds = area.extent();
        inner.intersect(bounds) == bounds
    }

    fn size(&self) -> [usize; 2] {
        let width = self.surfaces.width();
        [width, self.surfaces.len() / width]
    }

    /// The shadows of these groups that pay, and the things that they are seen on, back to front.
    fn ground(&self, groups: Vec<Group>, price_per_byte: f32) -> Vec<Area> {
        let none: Vec<Value> = (0..self.surfaces.len())
            .map(|i| self.surfaces.value(i))
            .collect();
        let left = self.without(&none, &groups);
        let mut layers: BTreeMap<(usize, bool), Vec<Area>> = BTreeMap::new();
        for group in &groups {
            let [all, left] = self.errors(group, &left);
            if all - left < price_per_byte * BYTES * group.casts.len() as f32 {
                continue;
            }
            // Below the lowest of the things that cast it, and above what it is seen on.
            layers.insert((group.lowest(), false), self.shadows(group));
            for below in self
                .seen(group)
                .into_iter()
                .filter_map(|i| self.things.top[i])
            {
                let thing = Mark::Area(self.things.areas[below].clone());
                layers.entry((below, true)).or_insert_with(|| {
                    let rounded = quantized_anywhere(&thing, PRECISION);
                    rounded
                        .and_then(|mark| mark.as_area().cloned())
                        .into_iter()
                        .collect()
                });
            }
        }
        layers.into_values().flatten().collect()
    }

    /// The shadows of a group as areas, back to front.
    fn shadows(&self, group: &Group) -> Vec<Area> {
        let [red, green, blue, _] = group.ink;
        let shadow = |cast: &Cast| {
            // Shapes stay what they are; of any other outline, a blur hides most points.
            let tolerance = OUTLINE_OF_BLUR * cast.blur;
            let near = SHAPE.max(f64::from(tolerance));
            let shapes = group.casters.iter().map(|area| match &area.rings[..] {
                [ring] if self.is_on_page(area) => Shape::like(ring, near),
                _ => None,
            });
            let parts: Vec<Vec<Path>> = match shapes.collect::<Option<Vec<Shape>>>() {
                Some(shapes) => shapes.into_iter().map(|shape| vec![shape.path()]).collect(),
                None => {
                    let rings = trace::rings(&group.mask.values, group.mask.width, tolerance);
                    let by = group.region.corner();
                    vec![rings.into_iter().map(|ring| ring.moved(by)).collect()]
                }
            };
            // A blur moves with its outline, so the shift is a shift of the rings.
            let by = math::point(cast.shift).to_vec2();
            let area = |rings: Vec<Path>| {
                let rings = rings.into_iter().map(|ring| ring.moved(by)).collect();
                let area = Area::plain(rings, [red, green, blue], cast.opacity);
                area.blurred(cast.blur).ok()
            };
            parts.into_iter().filter_map(area).collect::<Vec<Area>>()
        };
        // The first one found explains most and lies on top.
        group.casts.iter().rev().flat_map(shadow).collect()
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
