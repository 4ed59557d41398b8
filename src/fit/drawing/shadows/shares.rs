//! The shares of a colour that lies softly on the page, and the caster that they surround.

use crate::image::{Image, beside, flooded};
use crate::render::{self, Plane};
use crate::scene::Rgb;

// Colours are in 0..1.
/// Pixels at most this far from the page's colour are page.
const PAGE: f32 = 1.5 / 255.0;
/// Largest second difference of soft pixels.
const BEND: f32 = 10.0 / 255.0;
/// Reach across an edge, px. A sharp edge changes within a pixel by more than [`SHARP`] of what it does within so many to each side; a
/// blurred one of 1.5 px by 0.52.
const WIDE: usize = 3;
const SHARP: f32 = 0.75;
/// Change that is none.
const STEP: f32 = 1.5 / 255.0;
/// Largest difference of soft pixels from a mixture of the page with one colour.
const NEAR: f32 = 4.0 / 255.0;
/// The least share of the pixels that is soft.
const LEAST_SHARE: f32 = 0.002;
/// Number of times that the colour is found, each time from the pixels near the last one.
const ROUNDS: usize = 3;
/// Fewest pixels of a caster.
const LEAST_PIXELS: usize = 60;
/// The least share of its outline that a shadow is seen along.
const SURROUNDED: f32 = 0.3;
/// Blur of the caster's pixels before its outline is traced, px: unblurred pixels give stairs.
const OUTLINE_BLUR: f32 = 1.0;

/// Premultiplied colour and opacity.
type Value = [f32; 4];

/// The soft part of a picture.
pub(super) struct Shares {
    pub(super) width: usize,
    /// The colour that the page is mixed with.
    pub(super) color: Rgb,
    /// The squared difference between that colour and the page, summed over red, green and blue and a black and a white page.
    pub(super) contrast2: f32,
    /// For each pixel the share of the colour, where it is seen.
    pub(super) seen: Vec<Option<f32>>,
    /// The share of each pixel that belongs to the caster, blurred a little, because pixels have stairs.
    pub(super) caster: Plane,
}

/// A kind of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Page,
    /// Connected with the page, and never with a step.
    Soft,
    Other,
}

impl Shares {
    /// The shares of a picture on a page of this colour, or on none, if there are enough of them around something.
    pub(super) fn of(picture: &Image, page: Option<Rgb>) -> Option<Self> {
        let page = page.map_or([0.0; 4], |[r, g, b]| [r, g, b, 1.0]);
        // 1. The page, and soft pixels connected with it.
        let values = Values(picture);
        let mut kinds = kinds(&values, page);
        let soft = kinds.iter().filter(|kind| **kind == Kind::Soft).count();
        if (soft as f32) < LEAST_SHARE * kinds.len() as f32 {
            return None;
        }
        // 2. The one colour that soft pixels mix the page with. Pixels off that mixture are not soft.
        let ink = ink(&values, &kinds, page)?;
        let along = |i: usize| share(values.at(i), page, ink);
        for (i, kind) in kinds.iter_mut().enumerate() {
            if *kind == Kind::Soft && along(i).1 > NEAR {
                *kind = Kind::Other;
            }
        }
        // 3. The caster: parts of the rest that soft pixels surround.
        let seen = |(i, kind): (usize, &Kind)| match kind {
            Kind::Page => Some(0.0),
            Kind::Soft => Some(along(i).0),
            Kind::Other => None,
        };
        let caster = Plane {
            width: values.width(),
            values: caster(&values, &kinds),
        };
        let is_cast = caster.values.iter().any(|&share| share > 0.0);
        let apart = |c: usize| (ink[c] - page[c]) * (ink[c] - page[c]);
        let contrast2 = (0..4).map(apart).sum();
        is_cast.then(|| Self {
            width: values.width(),
            color: [ink[0], ink[1], ink[2]],
            contrast2,
            seen: kinds.iter().enumerate().map(seen).collect(),
            caster: render::blurred(caster, OUTLINE_BLUR),
        })
    }
}

/// The premultiplied values of a picture.
struct Values<'a>(&'a Image);

impl Values<'_> {
    fn width(&self) -> usize {
        self.0.width()
    }

    fn len(&self) -> usize {
        self.0.width() * self.0.height()
    }

    fn at(&self, i: usize) -> Value {
        let alpha = self.0.alpha().map_or(1.0, |alpha| alpha[i]);
        let [r, g, b] = self.0.planes().each_ref().map(|plane| alpha * plane[i]);
        [r, g, b, alpha]
    }

    /// True for a pixel whose neighbours on opposite sides have it about in their middle, and that is on no sharp edge.
    fn is_smooth(&self, i: usize) -> bool {
        let (w, height) = (self.0.width(), self.0.height());
        let own = self.at(i);
        [(1, i % w, w), (w, i / w, height)]
            .into_iter()
            .all(|(step, at, size)| {
                let ends = |far: usize| {
                    let is_inner = at >= far && at + far < size;
                    is_inner.then(|| [self.at(i - far * step), self.at(i + far * step)])
                };
                let Some([before, after]) = ends(1) else {
                    return true;
                };
                let near = away(before, after);
                let is_sharp =
                    ends(WIDE).is_some_and(|[first, last]| near > STEP + SHARP * away(first, last));
                let bends = |c: usize| (before[c] + after[c] - 2.0 * own[c]).abs() > BEND;
                !is_sharp && !(0..4).any(bends)
            })
    }
}

/// The largest difference of two values.
fn away(a: Value, b: Value) -> f32 {
    (0..4).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max)
}

/// Floods the picture from its page through smooth pixels.
fn kinds(values: &Values<'_>, page: Value) -> Vec<Kind> {
    let kind = |i: usize| match away(values.at(i), page) <= PAGE {
        true => Kind::Page,
        false => Kind::Other,
    };
    let mut kinds: Vec<Kind> = (0..values.len()).map(kind).collect();
    // A flood through smooth pixels: a shadow is connected with the page, and an edge stops it. An edge between a shadow and something
    // lighter than the page has pixels of the page's colour, from which nothing spreads.
    let page = (0..kinds.len()).filter(|&i| kinds[i] == Kind::Page && values.is_smooth(i));
    flooded(page.collect(), [values.width(), values.len()], |_, k| {
        let is_soft = kinds[k] == Kind::Other && values.is_smooth(k);
        if is_soft {
            kinds[k] = Kind::Soft;
        }
        is_soft
    });
    kinds
}

/// The colour that the soft pixels mix the page with: as far from the page as a colour can be.
fn ink(values: &Values<'_>, kinds: &[Kind], page: Value) -> Option<Value> {
    let is_soft = |i: &usize| kinds[*i] == Kind::Soft;
    let mut ink = None;
    for _ in 0..ROUNDS {
        let is_near = |i: &usize| ink.is_none_or(|ink| share(values.at(*i), page, ink).1 <= NEAR);
        let soft = (0..kinds.len()).filter(is_soft).filter(is_near);
        let differences = soft.map(|i| {
            let value = values.at(i);
            [0, 1, 2, 3].map(|c: usize| value[c] - page[c])
        });
        ink = Some(farthest(page, direction(differences)?)?);
    }
    ink
}

/// The direction that differences have on the whole: their sum weighted by size, with opposite ones turned around.
fn direction(differences: impl Iterator<Item = Value>) -> Option<Value> {
    let differences: Vec<Value> = differences.collect();
    let mut axis = [0.0_f32; 4];
    // The first sum has no axis yet and takes all signs as they are; the second turns differences against the axis around.
    for _ in 0..2 {
        let mut sum = [0.0_f64; 4];
        for difference in &differences {
            let along: f32 = (0..4).map(|c| difference[c] * axis[c]).sum();
            let size = (0..4)
                .map(|c| difference[c] * difference[c])
                .sum::<f32>()
                .sqrt();
            let sign = if along < 0.0 { -size } else { size };
            (0..4).for_each(|c| sum[c] += f64::from(sign * difference[c]));
        }
        let length = sum.iter().map(|v| v * v).sum::<f64>().sqrt();
        if length <= 0.0 {
            return None;
        }
        axis = sum.map(|v| (v / length) as f32);
    }
    Some(axis)
}

/// The value farthest from the page in a direction that a colour can have: an opaque one, where there is no page.
fn farthest(page: Value, direction: Value) -> Option<Value> {
    let most = |c: usize| match direction[c] {
        d if d > 1e-4 => (1.0 - page[c]) / d,
        d if d < -1e-4 => -page[c] / d,
        _ => f32::INFINITY,
    };
    let most = match page[3] > 0.0 {
        true => (0..3).map(most).fold(f32::INFINITY, f32::min),
        false => most(3),
    };
    let ink = [0, 1, 2, 3].map(|c| (page[c] + most * direction[c]).clamp(0.0, 1.0));
    (most.is_finite() && most > 0.0).then_some(ink)
}

/// The share of `ink` on the page that a value shows, and how far it is from their mixture.
fn share(value: Value, page: Value, ink: Value) -> (f32, f32) {
    let (mut along, mut whole) = (0.0, 0.0);
    for c in 0..4 {
        let full = ink[c] - page[c];
        along += (value[c] - page[c]) * full;
        whole += full * full;
    }
    let share = along / whole.max(f32::MIN_POSITIVE);
    // The share is the projection of (value − page) onto (ink − page); the rest is the distance from the mixture.
    let mixed = [0, 1, 2, 3].map(|c| page[c] + share * (ink[c] - page[c]));
    (share, away(value, mixed))
}

/// The coverage of pixels by the caster: parts that are neither page nor soft, and that soft pixels surround for the most part.
fn caster(values: &Values<'_>, kinds: &[Kind]) -> Vec<f32> {
    let (width, count) = (values.width(), kinds.len());
    let mut is_cast = vec![false; count];
    let mut is_seen: Vec<bool> = kinds.iter().map(|kind| *kind != Kind::Other).collect();
    // Each connected part, with the number of its borders, and of its borders to soft pixels.
    for start in 0..count {
        if is_seen[start] {
            continue;
        }
        is_seen[start] = true;
        let [mut soft, mut all] = [0, 0];
        let part = flooded(vec![start], [width, count], |_, k| {
            all += usize::from(kinds[k] != Kind::Other);
            soft += usize::from(kinds[k] == Kind::Soft);
            !std::mem::replace(&mut is_seen[k], true)
        });
        if part.len() >= LEAST_PIXELS && soft as f32 > SURROUNDED * all as f32 {
            part.into_iter().for_each(|i| is_cast[i] = true);
        }
    }
    // The step to an edge makes the soft pixel before it look like one of the caster.
    let trimmed = eroded(&is_cast, width);
    let inner = eroded(&trimmed, width);
    let share = |i: usize| match (trimmed[i], inner[i]) {
        (false, _) => 0.0,
        (_, true) => 1.0,
        _ => covered(values, &trimmed, &inner, i),
    };
    (0..count).map(share).collect()
}

/// The pixels of which all four neighbours are among them.
fn eroded(mask: &[bool], width: usize) -> Vec<bool> {
    let is_inner = |i: usize| mask[i] && beside(i, width, mask.len()).all(|k| mask[k]);
    (0..mask.len()).map(is_inner).collect()
}

/// The covered share of a pixel on the edge: by its place between the colours outside and inside.
fn covered(values: &Values<'_>, trimmed: &[bool], inner: &[bool], i: usize) -> f32 {
    let (mut sum, mut number) = (0.0, 0.0);
    for outside in beside(i, values.width(), inner.len()).filter(|&k| !trimmed[k]) {
        // The pixel on the opposite side: i + (i − outside).
        let inside = (2 * i).checked_sub(outside);
        let Some(inside) = inside.filter(|&k| inner.get(k) == Some(&true)) else {
            continue;
        };
        let [outside, own, inside] = [outside, i, inside].map(|k| values.at(k));
        let whole = away(inside, outside).max(f32::MIN_POSITIVE);
        sum += (away(own, outside) / whole).min(1.0);
        number += 1.0;
    }
    if number > 0.0 { sum / number } else { 0.5 }
}
