//! The things of a picture, as they are traced in full light, and which of them cast shadows.

use kurbo::Rect;

use super::region::Region;
use super::shadow::Shadow;
use super::surfaces::{Light, Surfaces};
use super::{Page, SHAPE};
use crate::image::{Image, flooded};
use crate::outline;
use crate::render::{Canvas, Plane};
use crate::restore::Doubt;
use crate::scene::{Area, Blurs, Mark, Marks, Path, Rgb, Shape};
use crate::seed::{Pyramid, Residual};
use crate::shading::Value;
use crate::trace::{self, Tracing};

/// The least share of its outline that a shadow is seen along. A guess.
const SURROUNDED: f32 = 0.3;
/// Least width and height of a caster, px. A guess.
const LEAST_SIDE: f64 = 6.0;
/// Coverage from which on a thing hides what is below it.
const HIDES: f32 = 0.02;
/// Bytes of a shadow, about. A guess.
const BYTES: f32 = 300.0;
/// Share of the squared error around a thing that a blur of it leaves, from which on it is none, and the blocks along the longer side
/// that this is found out on. Guesses: other shadows may be there as well.
const UNLIKE: f32 = 0.4;
const COARSE: usize = 40;
/// Number of times that casters are looked for.
const MOST_LOOKS: usize = 3;
/// Most times that things are traced.
const MOST_ROUNDS: usize = 6;
/// Pixels beside a thing that its edge may change.
const EDGE: usize = 2;
/// Farthest that chords are from the curves of a ring whose sense is asked for, px.
const CHORDS: f64 = 1.0;

/// The things on a page, back to front.
pub(super) struct Things {
    size: [usize; 2],
    pub(super) areas: Vec<Area>,
    /// The topmost thing that a pixel shows, if it isn't the page.
    pub(super) top: Vec<Option<usize>>,
    /// Those that soft pixels surround, the most surrounded first.
    pub(super) casters: Vec<usize>,
    /// True if shadows may lie on them: they are exactly where they are seen, so that no fit would move them.
    pub(super) may_be_below: bool,
}

/// What the choice of shadows needs to know.
#[derive(Clone, Copy)]
pub(in crate::fit) struct Terms<'a> {
    pub(in crate::fit) doubt: Doubt,
    /// How shadows are drawn.
    pub(in crate::fit) blurs: Blurs,
    /// True if there is no time to look for shadows.
    pub(in crate::fit) is_short: bool,
    /// True if areas may lie below shadows.
    pub(in crate::fit) has_things: bool,
    /// The squared error that a byte has to remove.
    pub(in crate::fit) per_byte: f32,
    /// The squared error that a mark has to remove.
    pub(in crate::fit) price: &'a (dyn Fn(&Mark) -> f32 + Sync),
}

impl Terms<'_> {
    /// The squared error that a shadow has to remove.
    pub(super) fn price_of_shadow(&self) -> f32 {
        self.per_byte * BYTES
    }
}

impl Things {
    /// The things of a picture on a page.
    pub(super) fn of(surfaces: &Surfaces<'_>, page: &Page, terms: &Terms<'_>) -> Self {
        let lit = surfaces.lit();
        let mut things = Self::traced(&lit, &lit, surfaces, page, terms);
        // What casts a shadow lies above what that is seen on. Where tracing thinks otherwise, it is told what is there without.
        let mut risen: Vec<Area> = Vec::new();
        for _ in 0..MOST_ROUNDS {
            if !things.may_be_below {
                break;
            }
            let first = things.areas.len() - risen.len();
            let mut casters = things.casters.iter();
            let below = casters.find_map(|&k| Some((k, things.risen(k, surfaces)?)));
            let Some((k, area)) = below else {
                break;
            };
            if k >= first {
                risen.remove(k - first);
            }
            risen.push(area);
            let bare = without(&lit, &risen, surfaces);
            things = Self::traced(&bare, &lit, surfaces, page, terms);
            risen.iter().for_each(|area| things.add(area.clone()));
            things.find_casters(surfaces, terms.price_of_shadow());
        }
        things
    }

    /// The things that are traced in `lit`, and those that show through holes of them in `whole`.
    fn traced(
        lit: &Image,
        whole: &Image,
        surfaces: &Surfaces<'_>,
        page: &Page,
        terms: &Terms<'_>,
    ) -> Self {
        let size = [lit.width(), lit.height()];
        let pages = page.behind(lit);
        let targets = pages
            .iter()
            .map(|(matte, _)| Pyramid::new(lit.flattened(*matte)));
        let targets: Vec<Pyramid> = targets.collect();
        let canvases = pages.iter().map(|(_, page)| Canvas::from_image(page));
        let canvases: Vec<Canvas> = canvases.collect();
        let residuals = targets
            .iter()
            .zip(&canvases)
            .map(|(target, canvas)| Residual {
                target,
                canvas,
                weights: None,
            });
        let tracing = Tracing {
            doubt: terms.doubt,
            has_shades: true,
            most: usize::MAX,
            may_place: true,
            is_of_details: false,
        };
        let residuals: Vec<Residual<'_>> = residuals.collect();
        let marks = trace::trace(&residuals, tracing, Marks::Auto, terms.price);
        let mut things = Self {
            size,
            areas: Vec::new(),
            top: vec![None; size[0] * size[1]],
            casters: Vec::new(),
            may_be_below: terms.has_things && marks.iter().all(|traced| traced.is_placed),
        };
        let mut windows = Vec::new();
        for traced in marks
            .iter()
            .filter(|traced| traced.gain > (terms.price)(&traced.mark))
        {
            for mut part in parts(outline::of_mark(&traced.mark)) {
                // A hole with shadows around it is something that lies on top, in the colour of what is below.
                let holes = part.rings.split_off(1).into_iter();
                for hole in holes {
                    let color = color_in(whole, &hole);
                    let window = Area::plain(vec![hole], color, 1.0);
                    match things.surrounded(&window, surfaces) {
                        Some(_) => windows.push(window),
                        None => part.rings.extend(window.rings),
                    }
                }
                things.add(part);
            }
        }
        windows.into_iter().for_each(|window| things.add(window));
        things.find_casters(surfaces, terms.price_of_shadow());
        things
    }

    /// Lays an area on top.
    fn add(&mut self, area: Area) {
        let number = self.areas.len();
        let (region, mask) = covered(&area, 0.0);
        for (k, i) in region.pixels(self.size) {
            if mask.values[k] >= HIDES {
                self.top[i] = Some(number);
            }
        }
        self.areas.push(area);
    }

    /// The share of the outline of an area that soft pixels are beside, if that may cast a shadow.
    fn surrounded(&self, area: &Area, surfaces: &Surfaces<'_>) -> Option<f32> {
        let border = self.border(area);
        let soft = border.iter().filter(|&&i| surfaces.is_soft(i)).count();
        let share = soft as f32 / border.len().max(1) as f32;
        let is_large = area.extent().size().min_side() >= LEAST_SIDE;
        (area.opacity >= 1.0 && is_large && share > SURROUNDED).then_some(share)
    }

    /// Finds the things with soft pixels around them that a blur of them is like, and that gain `price` by it. Those that soft pixels
    /// surround most come first.
    fn find_casters(&mut self, surfaces: &Surfaces<'_>, price: f32) {
        let all = self.areas.iter().enumerate();
        let shares = all.filter_map(|(k, area)| Some((k, self.surrounded(area, surfaces)?)));
        let mut shares: Vec<(usize, f32)> = shares.collect();
        shares.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        // Where shadows lie on each other, those that are found tell what is left for others.
        let mut left = surfaces.values();
        let mut is_found = vec![false; shares.len()];
        for _ in 0..MOST_LOOKS {
            let rest = (0..shares.len()).filter(|&n| !is_found[n]);
            let of = |n: usize| {
                Some((
                    n,
                    self.likely(&self.areas[shares[n].0], surfaces, &left, price)?,
                ))
            };
            let found: Vec<(usize, Shadow)> = rest.filter_map(of).collect();
            if found.is_empty() {
                break;
            }
            for (n, shadow) in found {
                is_found[n] = true;
                for &(i, share) in shadow.shares() {
                    left[i] = shadow.below(left[i], share);
                }
            }
        }
        let found = shares.into_iter().zip(is_found);
        self.casters = found
            .filter(|(_, found)| *found)
            .map(|((k, _), _)| k)
            .collect();
    }

    /// The shadow of an area, if it is at all like what is left of soft pixels around it, and gains `price`.
    fn likely(
        &self,
        area: &Area,
        surfaces: &Surfaces<'_>,
        left: &[Value],
        price: f32,
    ) -> Option<Shadow> {
        let (region, mask) = covered(area, 0.0);
        let mut is_own = vec![false; left.len()];
        for (k, i) in region.pixels(self.size) {
            is_own[i] = mask.values[k] >= HIDES;
        }
        let known = |i: usize| {
            let (surface, light) = surfaces.at(i)?;
            // What a fit would move is no part of the ground.
            let is_ground = self.may_be_below || self.top[i].is_none();
            let is_known = light != Light::Rim && is_ground && !is_own[i];
            is_known.then(|| (left[i], surfaces.base(surface, i)))
        };
        let shadow = Shadow::of(vec![area.clone()], self.size, COARSE, known)?;
        let [all, left] = shadow.errors(known);
        (left <= UNLIKE * all && all - left >= price).then_some(shadow)
    }

    /// What a thing covers, with its holes where something lies in them.
    pub(super) fn cast_by(&self, number: usize) -> Area {
        let mut area = self.areas[number].clone();
        let holes = area.rings.split_off(1).into_iter();
        let holes = holes.filter(|hole| {
            let own = Area::plain(vec![hole.clone()], area.color, 1.0);
            let (region, mask) = covered(&own, 0.0);
            let pixels = region.pixels(self.size);
            let mut inner = pixels.filter(|(k, _)| mask.values[*k] >= 1.0);
            inner.any(|(_, i)| self.top[i].is_none_or(|top| top <= number))
        });
        area.rings.extend(holes);
        area
    }

    /// The pixels beside the outer ring of an area.
    fn border(&self, area: &Area) -> Vec<usize> {
        let outer = Area::plain(area.rings[..1].to_vec(), area.color, 1.0);
        let (region, mask) = covered(&outer, 1.0);
        let is_beside = |k: usize| {
            let mut beside = crate::image::beside(k, mask.width, mask.values.len());
            mask.values[k] < HIDES && beside.any(|k| mask.values[k] >= HIDES)
        };
        let beside = region.pixels(self.size).filter(|(k, _)| is_beside(*k));
        beside.map(|(_, i)| i).collect()
    }

    /// The part of a caster that nothing hides, with its holes filled, if something above it shows its shadow.
    fn risen(&self, caster: usize, surfaces: &Surfaces<'_>) -> Option<Area> {
        let area = &self.areas[caster];
        let mut soft = self
            .border(area)
            .into_iter()
            .filter(|&i| surfaces.is_soft(i));
        if !soft.any(|i| self.top[i].is_some_and(|top| top > caster)) {
            return None;
        }
        let (region, mut mask) = covered(area, 1.0);
        for above in &self.areas[caster + 1..] {
            let hidden = region.covered(&above.rings).values;
            let shares = mask.values.iter_mut().zip(hidden);
            shares.for_each(|(share, hidden)| *share *= 1.0 - hidden);
        }
        let rings = trace::rings(&mask.values, mask.width, 0.0);
        let seen = Area {
            rings,
            ..area.clone()
        };
        let outers = parts(seen).into_iter().map(|part| part.rings[0].clone());
        let shape = |ring: Path| Shape::like(&ring, SHAPE).map_or(ring, Shape::path);
        let rings = outers.map(|ring| shape(ring).moved(region.corner()));
        let rings: Vec<Path> = rings.collect();
        (!rings.is_empty()).then(|| Area {
            rings,
            ..area.clone()
        })
    }
}

/// The picture with what surrounds these areas in their place.
fn without(lit: &Image, areas: &[Area], surfaces: &Surfaces<'_>) -> Image {
    let (width, count) = (lit.width(), surfaces.len());
    let mut is_gone = vec![false; count];
    for area in areas {
        let (region, mask) = covered(area, 0.0);
        let pixels = region.pixels([width, count / width]);
        let hidden = pixels.filter(|(k, _)| mask.values[*k] >= HIDES);
        hidden.for_each(|(_, i)| is_gone[i] = true);
    }
    for _ in 0..EDGE {
        let beside = |i: usize| crate::image::beside(i, width, count).any(|k| is_gone[k]);
        let edge: Vec<usize> = (0..count).filter(|&i| !is_gone[i] && beside(i)).collect();
        edge.into_iter().for_each(|i| is_gone[i] = true);
    }
    // The surfaces around grow into the gap at the same pace.
    let mut from: Vec<usize> = (0..count).collect();
    let edge = (0..count).filter(|&i| !is_gone[i] && surfaces.at(i).is_some());
    let edge = edge.filter(|&i| crate::image::beside(i, width, count).any(|k| is_gone[k]));
    flooded(edge.collect(), [width, count], |i, k| {
        let joins = std::mem::replace(&mut is_gone[k], false);
        if joins {
            from[k] = from[i];
        }
        joins
    });
    let planes = lit
        .planes()
        .each_ref()
        .map(|plane| from.iter().map(|&i| plane[i]).collect());
    let bare = Image::from_planes(width, count / width, planes);
    match lit.alpha() {
        Some(alpha) => {
            let alpha = from.iter().map(|&i| alpha[i]).collect();
            bare.clone().with_alpha(alpha).unwrap_or(bare)
        }
        None => bare,
    }
}

/// The parts of an area that are apart: each outer ring, and then its holes.
fn parts(area: Area) -> Vec<Area> {
    let sense = |ring: &Path| {
        let corners = ring.flattened(CHORDS);
        let sides = corners.iter().zip(corners.iter().cycle().skip(1));
        sides
            .map(|(a, b)| a.to_vec2().cross(b.to_vec2()))
            .sum::<f64>()
    };
    let bounds = |ring: &Path| Area::plain(vec![ring.clone()], area.color, 1.0).extent();
    let largest = area
        .rings
        .iter()
        .map(sense)
        .max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let outer = |ring: &Path| sense(ring) * largest.unwrap_or(1.0) > 0.0;
    let (outers, holes): (Vec<Path>, Vec<Path>) = area.rings.iter().cloned().partition(outer);
    let boxes: Vec<Rect> = outers.iter().map(bounds).collect();
    let mut parts: Vec<Area> = outers
        .into_iter()
        .map(|ring| Area {
            rings: vec![ring],
            ..area.clone()
        })
        .collect();
    for hole in holes {
        let own = bounds(&hole);
        let around = (0..parts.len()).filter(|&k| boxes[k].union(own) == boxes[k]);
        if let Some(k) = around.min_by(|&a, &b| boxes[a].area().total_cmp(&boxes[b].area())) {
            parts[k].rings.push(hole);
        }
    }
    parts
}

/// The box that goes `reach` px beyond an area, and the shares of its pixels that this covers.
fn covered(area: &Area, reach: f64) -> (Region, Plane) {
    let region = Region::around(area.extent().inflate(reach, reach));
    let mask = region.covered(&area.rings);
    (region, mask)
}

/// The mean colour of the pixels of a picture within a ring.
fn color_in(picture: &Image, ring: &Path) -> Rgb {
    let (region, mask) = covered(&Area::plain(vec![ring.clone()], [0.0; 3], 1.0), 0.0);
    let pixels = region.pixels([picture.width(), picture.height()]);
    let inner: Vec<usize> = pixels
        .filter(|(k, _)| mask.values[*k] >= 1.0)
        .map(|(_, i)| i)
        .collect();
    let count = inner.len().max(1) as f32;
    let planes = picture.planes().each_ref();
    planes.map(|plane| inner.iter().map(|&i| plane[i]).sum::<f32>() / count)
}
