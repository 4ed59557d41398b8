//! A shadow: blurs of the shape of what casts it, in one ink.

use kurbo::Rect;

use super::caster::{self, Cast, Search};
use super::ink::{self, away};
use super::region::Region;
use super::surfaces::{FLAT, MIXED};
use super::{OUTLINE_OF_BLUR, SHAPE};
use crate::math;
use crate::render::{Plane, blurred};
use crate::scene::{Area, Path, Shape};
use crate::shading::Value;
use crate::trace;

// All of these are guesses.
/// Most blurs of one thing: a lamp and the light of the sky make two.
const MOST: usize = 3;
/// Of the squared error, no second blur is looked for below this share.
const EXPLAINED: f32 = 0.002;
/// A blur beside another one has to leave less than this share of the squared error.
const LEAST_GAIN: f32 = 0.5;
/// Largest share that is taken from a pixel.
const DARKEST: f32 = 0.98;

/// A shadow of some areas together.
pub(super) struct Shadow {
    casters: Vec<Area>,
    region: Region,
    mask: Plane,
    ink: Value,
    casts: Vec<Cast>,
    /// The pixels of the page that it may change, each with the share of the ink there.
    shares: Vec<(usize, f32)>,
}

impl Shadow {
    /// The shadow of areas on a page of this size that explains best what `known` tells of a pixel: its value, and that of its surface
    /// in full light. It is fitted to so many blocks along the longer side.
    pub(super) fn of(
        casters: Vec<Area>,
        size: [usize; 2],
        blocks: usize,
        known: impl Fn(usize) -> Option<(Value, Value)>,
    ) -> Option<Self> {
        let (region, mask, reach) = caster::reach_of(casters.iter(), size);
        let pixels = region.pixels(size).filter_map(|(_, i)| known(i));
        let soft = pixels.filter(|(value, base)| away(*value, *base) > FLAT);
        let ink = ink::of(soft, MIXED)?;
        let mut search = Search::of((&region, &mask, reach), (size, blocks), |i| {
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
        let shares = shares(&region, &mask, &casts, size);
        (!casts.is_empty()).then_some(Self {
            casters,
            region,
            mask,
            ink,
            casts,
            shares,
        })
    }

    /// The number of its blurs.
    pub(super) fn len(&self) -> usize {
        self.casts.len()
    }

    /// The pixels of the page that it may change, each with the share of the ink there.
    pub(super) fn shares(&self) -> &[(usize, f32)] {
        &self.shares
    }

    /// The squared error of what `known` tells of the pixels where it is seen: from full light, and without the shadow.
    pub(super) fn errors(&self, known: impl Fn(usize) -> Option<(Value, Value)>) -> [f32; 2] {
        let seen = self.shares.iter().filter(|(_, share)| *share > FLAT);
        let errors = seen.filter_map(|&(i, share)| {
            let (value, base) = known(i)?;
            let values = [value, self.below(value, share)];
            Some(values.map(|value| ink::distance2(value, base)))
        });
        errors.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]])
    }

    /// The value below a share of its ink.
    pub(super) fn below(&self, value: Value, share: f32) -> Value {
        // v = s·ink + (1 − s)·u, with u the value without the shadow.
        let share = share.min(DARKEST);
        std::array::from_fn(|c| (value[c] - share * self.ink[c]) / (1.0 - share))
    }

    /// Its blurs as areas, back to front.
    pub(super) fn areas(&self, size: [usize; 2]) -> Vec<Area> {
        // The first one found explains most and lies on top.
        let casts = self.casts.iter().rev();
        casts.flat_map(|cast| self.blurs(cast, size)).collect()
    }

    fn blurs(&self, cast: &Cast, size: [usize; 2]) -> Vec<Area> {
        // Shapes stay what they are; of any other outline, a blur hides most points.
        let tolerance = OUTLINE_OF_BLUR * cast.blur;
        let near = SHAPE.max(f64::from(tolerance));
        let shapes = self.casters.iter().map(|area| match &area.rings[..] {
            [ring] if is_within(area, size) => Shape::like(ring, near),
            _ => None,
        });
        let outline = || {
            let rings = trace::rings(&self.mask.values, self.mask.width, tolerance);
            let by = self.region.corner();
            vec![rings.into_iter().map(|ring| ring.moved(by)).collect()]
        };
        let parts = shapes.map(|shape| shape.map(|shape| vec![shape.path()]));
        let parts: Vec<Vec<Path>> = parts.collect::<Option<_>>().unwrap_or_else(outline);
        // A blur moves with its outline, so the shift is a shift of the rings.
        let by = math::point(cast.shift).to_vec2();
        let [red, green, blue, _] = self.ink;
        let area = |rings: Vec<Path>| {
            let rings = rings.into_iter().map(|ring| ring.moved(by)).collect();
            let area = Area::plain(rings, [red, green, blue], cast.opacity);
            area.blurred(cast.blur).ok()
        };
        parts.into_iter().filter_map(area).collect()
    }
}

/// The shares of the ink of blurs at the pixels of a page.
fn shares(region: &Region, mask: &Plane, casts: &[Cast], page: [usize; 2]) -> Vec<(usize, f32)> {
    let mut through = vec![1.0; mask.values.len()];
    for cast in casts {
        let soft = blurred(mask.clone(), cast.blur);
        for (k, through) in through.iter_mut().enumerate() {
            *through *= 1.0 - cast.opacity * caster::at(&soft, k, cast.shift);
        }
    }
    let pixels = region.pixels(page);
    pixels.map(|(k, i)| (i, 1.0 - through[k])).collect()
}

/// True if the border of a page of this size cuts off nothing of an area.
fn is_within(area: &Area, size: [usize; 2]) -> bool {
    let [width, height] = size.map(|side| side as f64);
    let inner = Rect::new(1.0, 1.0, width - 1.0, height - 1.0);
    let bounds = area.extent();
    inner.intersect(bounds) == bounds
}
