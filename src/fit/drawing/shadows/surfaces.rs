//! The surfaces that shadows fall on, the soft pixels on them, and the picture in full light.

use super::ink::{self, away};
use crate::image::{Image, beside, flooded};
use crate::math::{self, Point};
use crate::scene::Shade;
use crate::shading::{Blocks, NEAR, Value, premultiplied};

// Colours are in 0..1.
/// Pixels at most this far from a surface's colour show it in full light.
pub(super) const FLAT: f32 = 1.5 / 255.0;
/// Largest difference of soft pixels from a mixture of a surface with one colour.
pub(super) const MIXED: f32 = 4.0 / 255.0;
/// Largest second difference of soft pixels.
const BEND: f32 = 10.0 / 255.0;
/// Reach across an edge, px. A sharp edge changes within a pixel by more than [`SHARP`] of what it does within so many to each side; a
/// blurred one of 1.5 px by 0.52.
const WIDE: usize = 3;
const SHARP: f32 = 0.75;
/// Change that is none.
const STEP: f32 = 1.5 / 255.0;
/// Reach of what is even, px, and what differs there, less than a level.
const EVEN: usize = 4;
const LEVEL: f32 = 0.5 / 255.0;
/// Change of a shadow over that reach, in units of itself, and the largest share of a shadow that changes less.
const CHANGE: f32 = 0.1;
const MOST_EVEN: f32 = 0.5;
/// Least depth of what is no blurred edge, px.
const DEPTH: usize = 3;
/// The least share of the pixels that a colour has to have to be a surface's.
const LEAST_SURFACE: f32 = 0.005;
/// The least share that a part without a step has to have to be a surface with a gradient, and the least share of its blocks, of so
/// many along the longer side of the picture, that the gradient has to meet.
const LEAST_SHADED: f32 = 0.02;
const LEAST_MET: f32 = 0.4;
const BLOCKS: usize = 64;
/// Most of an edge that the soft pixel before it shows.
const RIM: f32 = 0.15;

/// Surfaces by number; the page is 0.
pub(super) type Surface = u8;

/// The surfaces of a picture.
pub(super) struct Surfaces<'a> {
    picture: &'a Image,
    /// The paint of each surface.
    bases: Vec<Base>,
    /// The surface that each pixel shows, and how.
    seen: Vec<Option<(Surface, Light)>>,
}

/// What a surface looks like in full light.
#[derive(Debug, Clone)]
pub(super) enum Base {
    Color(Value),
    Shade(Shade),
}

/// How a pixel shows a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Light {
    /// In its own colour.
    Full,
    /// In another one, and joined to what shows its own without a step.
    Soft,
    /// Soft, and beside an edge, which bends it.
    Rim,
}

impl<'a> Surfaces<'a> {
    /// The surfaces of a picture on a page of this paint.
    pub(super) fn of(picture: &'a Image, page: Base) -> Self {
        let count = picture.width() * picture.height();
        let mut surfaces = Self {
            picture,
            bases: Vec::new(),
            seen: vec![None; count],
        };
        let smooth: Vec<bool> = (0..count).map(|i| surfaces.is_smooth(i)).collect();
        // The page first, and then by size: what is soft belongs to the larger surface that it is joined to, and so does a shadow
        // that is even in its middle.
        surfaces.add(page, &smooth);
        for color in surfaces.colors() {
            surfaces.add(Base::Color(color), &smooth);
        }
        for shade in surfaces.shades(&smooth) {
            surfaces.add(Base::Shade(shade), &smooth);
        }
        surfaces.drop_others();
        surfaces.add_rims();
        surfaces
    }

    pub(super) fn width(&self) -> usize {
        self.picture.width()
    }

    pub(super) fn len(&self) -> usize {
        self.seen.len()
    }

    /// Width and height, px.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.width(), self.len() / self.width()]
    }

    /// True if a pixel shows a surface like this.
    pub(super) fn is(&self, i: usize, light: Light) -> bool {
        self.seen[i].is_some_and(|(_, own)| own == light)
    }

    /// The surface that a pixel shows, and how.
    pub(super) fn at(&self, i: usize) -> Option<(Surface, Light)> {
        self.seen[i]
    }

    /// The value of a surface in full light at a pixel.
    pub(super) fn base(&self, surface: Surface, i: usize) -> Value {
        self.value_of(&self.bases[usize::from(surface)], i)
    }

    fn value_of(&self, base: &Base, i: usize) -> Value {
        match base {
            Base::Color(value) => *value,
            Base::Shade(shade) => {
                let [x, y] = [i % self.width(), i / self.width()].map(|px| px as f64 + 0.5);
                premultiplied(shade, Point::new(x, y))
            }
        }
    }

    /// The value of a pixel.
    pub(super) fn value(&self, i: usize) -> Value {
        let alpha = self.picture.alpha().map_or(1.0, |alpha| alpha[i]);
        let [r, g, b] = self
            .picture
            .planes()
            .each_ref()
            .map(|plane| alpha * plane[i]);
        [r, g, b, alpha]
    }

    /// The values of all pixels.
    pub(super) fn values(&self) -> Vec<Value> {
        (0..self.len()).map(|i| self.value(i)).collect()
    }

    /// True if a pixel is soft.
    pub(super) fn is_soft(&self, i: usize) -> bool {
        self.seen[i].is_some_and(|(_, light)| light != Light::Full)
    }

    /// The share of the pixels that show a surface, and that of soft ones.
    pub(super) fn shares(&self) -> [f32; 2] {
        let seen = self.seen.iter().flatten().count();
        let soft = (0..self.len()).filter(|&i| self.is_soft(i)).count();
        [seen, soft].map(|count| count as f32 / self.len() as f32)
    }

    /// True for a pixel whose neighbours on opposite sides have it about in their middle, and that is on no sharp edge.
    fn is_smooth(&self, i: usize) -> bool {
        let [w, height] = self.size();
        let own = self.value(i);
        [(1, i % w, w), (w, i / w, height)]
            .into_iter()
            .all(|(step, at, size)| {
                let ends = |far: usize| {
                    let is_inner = at >= far && at + far < size;
                    is_inner.then(|| [self.value(i - far * step), self.value(i + far * step)])
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

    /// True for a pixel that those [`EVEN`] px away on all sides are at most this far from.
    fn is_even(&self, i: usize, most: f32) -> bool {
        let [width, height] = self.size();
        let [x, y] = [i % width, i / width];
        let row = [x.checked_sub(EVEN), Some(x + EVEN).filter(|&x| x < width)];
        let column = [y.checked_sub(EVEN), Some(y + EVEN).filter(|&y| y < height)];
        let row = row.into_iter().flatten().map(|x| y * width + x);
        let mut around = row.chain(column.into_iter().flatten().map(|y| y * width + x));
        around.all(|k| away(self.value(k), self.value(i)) <= most)
    }

    /// The colours that enough pixels have where nothing changes, the most common first.
    fn colors(&self) -> Vec<Value> {
        let even = (0..self.len()).filter(|&i| self.seen[i].is_none() && self.is_even(i, LEVEL));
        let levels = even.map(|i| self.value(i).map(|v| (255.0 * v).round() as u8));
        let mut levels: Vec<[u8; 4]> = levels.collect();
        let mut colors = Vec::new();
        while let Some(most) = math::most_common(&mut levels) {
            if (most.len() as f32) < LEAST_SURFACE * self.len() as f32 {
                break;
            }
            let color = most[0];
            colors.push(color.map(|level| f32::from(level) / 255.0));
            levels.retain(|own| *own != color);
        }
        colors
    }

    /// The gradients of large parts without a step that show no surface yet.
    fn shades(&self, smooth: &[bool]) -> Vec<Shade> {
        let (size, mut known) = ([self.width(), self.len()], vec![false; self.len()]);
        let mut shades = Vec::new();
        for start in 0..self.len() {
            let is_free = |i: usize| smooth[i] && self.seen[i].is_none();
            if known[start] || !is_free(start) {
                continue;
            }
            known[start] = true;
            let part = flooded(vec![start], size, |_, k| {
                is_free(k) && !std::mem::replace(&mut known[k], true)
            });
            if (part.len() as f32) < LEAST_SHADED * self.len() as f32 {
                continue;
            }
            let mut is_part = vec![false; self.len()];
            part.iter().for_each(|&i| is_part[i] = true);
            let (blocks, _) = Blocks::of_page(self.size(), BLOCKS, |pixels| {
                let mut sum = [0.0; 4];
                for &i in pixels {
                    sum = std::array::from_fn(|c| sum[c] + self.value(i)[c]);
                }
                let is_whole = pixels.iter().all(|&i| is_part[i]);
                is_whole.then(|| sum.map(|sum| sum / pixels.len() as f32))
            });
            let found = blocks.best_shade();
            shades.extend(found.and_then(|(shade, met)| (met.share >= LEAST_MET).then_some(shade)));
        }
        shades
    }

    /// Adds the surface of a paint: pixels of it, and from them through smooth pixels. An edge stops it.
    fn add(&mut self, base: Base, smooth: &[bool]) {
        let Ok(own) = Surface::try_from(self.bases.len()) else {
            return;
        };
        let near = match base {
            Base::Color(_) => FLAT,
            Base::Shade(_) => NEAR,
        };
        let full = (0..self.len()).filter(|&i| self.seen[i].is_none());
        let full: Vec<usize> = full
            .filter(|&i| away(self.value(i), self.value_of(&base, i)) <= near)
            .collect();
        full.iter()
            .for_each(|&i| self.seen[i] = Some((own, Light::Full)));
        self.bases.push(base);
        // An edge between a shadow and something lighter than the surface has pixels of the surface's colour, from which nothing
        // spreads.
        let from = full.into_iter().filter(|&i| smooth[i]).collect();
        flooded(from, [self.width(), self.len()], |_, k| {
            let joins = smooth[k] && self.seen[k].is_none();
            if joins {
                self.seen[k] = Some((own, Light::Soft));
            }
            joins
        });
        self.keep_mixtures();
    }

    /// Takes away from what is soft on the last surface what is no mixture of it with one ink.
    fn keep_mixtures(&mut self) {
        let own = (self.bases.len() - 1) as Surface;
        let soft = (0..self.len()).filter(|&i| self.seen[i] == Some((own, Light::Soft)));
        let soft: Vec<(usize, Value, Value)> = soft
            .map(|i| (i, self.value(i), self.base(own, i)))
            .collect();
        let ink = ink::of(soft.iter().map(|&(_, value, base)| (value, base)), MIXED);
        for (i, value, base) in soft {
            let is_mixed = ink.is_some_and(|ink| {
                let (share, off) = ink::share(value, base, ink);
                off <= MIXED && (share >= 0.0 || away(value, base) <= MIXED)
            });
            if !is_mixed {
                self.seen[i] = None;
            }
        }
    }

    /// Drops soft parts that are no shadow: those that are nowhere so deep that they are no blurred edge, and those of one colour.
    fn drop_others(&mut self) {
        let size = [self.width(), self.len()];
        let is_soft: Vec<bool> = (0..self.len()).map(|i| self.is_soft(i)).collect();
        let mut is_deep = is_soft.clone();
        for _ in 1..DEPTH {
            let is_inner = |i: usize| is_deep[i] && beside(i, size[0], size[1]).all(|k| is_deep[k]);
            is_deep = (0..size[1]).map(is_inner).collect();
        }
        let mut known = vec![false; self.len()];
        for start in (0..self.len()).filter(|&i| is_soft[i]) {
            if std::mem::replace(&mut known[start], true) {
                continue;
            }
            let surface = self.seen[start].map(|own| own.0);
            let part = flooded(vec![start], size, |_, k| {
                let is_same = is_soft[k] && self.seen[k].map(|own| own.0) == surface;
                is_same && !std::mem::replace(&mut known[k], true)
            });
            let even = part.iter().filter(|&&i| self.is_plateau(i)).count();
            if !part.iter().any(|&i| is_deep[i]) || even as f32 > MOST_EVEN * part.len() as f32 {
                part.into_iter().for_each(|i| self.seen[i] = None);
            }
        }
    }

    /// True for a soft pixel around which the difference from full light hardly changes.
    fn is_plateau(&self, i: usize) -> bool {
        let base = self.seen[i].map(|(surface, _)| self.base(surface, i));
        base.is_some_and(|base| self.is_even(i, CHANGE * away(self.value(i), base)))
    }

    /// Adds the pixels between soft ones and an edge. The edge is within reach of them, so that they are not smooth.
    fn add_rims(&mut self) {
        for _ in 0..WIDE {
            let rims = (0..self.len()).filter_map(|i| {
                let edge = self.edge(i)?;
                let is_rim = edge.shown <= RIM || away(self.value(i), edge.dark) <= 2.0 * STEP;
                is_rim.then_some((i, edge.surface))
            });
            for (i, surface) in rims.collect::<Vec<_>>() {
                self.seen[i] = Some((surface, Light::Rim));
            }
        }
    }

    /// The edge that a pixel is on, if it shows no surface alone and one is soft nearby.
    fn edge(&self, i: usize) -> Option<Edge> {
        if self.seen[i].is_some() {
            return None;
        }
        let [width, height] = self.size().map(|side| side as i64);
        let [x, y] = [i as i64 % width, i as i64 / width];
        let at = |[dx, dy]: [i64; 2], steps: i64| {
            let [x, y] = [x + steps * dx, y + steps * dy];
            let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
            is_inside.then(|| (y * width + x) as usize)
        };
        let edges = [[1, 0], [-1, 0], [0, 1], [0, -1]]
            .into_iter()
            .filter_map(|way| {
                let steps = (1..=WIDE as i64)
                    .find(|&steps| at(way, -steps).is_some_and(|k| self.seen[k].is_some()))?;
                let soft = at(way, -steps).filter(|&k| self.is_soft(k))?;
                let (surface, _) = self.seen[soft]?;
                // The shadow goes on as it does before the edge.
                let own = self.value(soft);
                let before = at(way, -steps - 1)
                    .filter(|&k| self.is_soft(k))
                    .map_or(own, |k| self.value(k));
                let dark: Value =
                    std::array::from_fn(|c| own[c] + steps as f32 * (own[c] - before[c]));
                // What the edge leads to differs most.
                let beyond = (1..=WIDE as i64).filter_map(|steps| at(way, steps));
                let beyond = beyond.map(|k| (away(self.value(k), dark), k));
                let (whole, far) = beyond.max_by(|a, b| a.0.total_cmp(&b.0))?;
                let shown = (away(self.value(i), dark) / whole.max(f32::MIN_POSITIVE)).min(1.0);
                // The light that both sides lack.
                let lacks = |(surface, k, value): (Surface, usize, Value)| {
                    let base = self.base(surface, k);
                    std::array::from_fn(|c| base[c] - value[c])
                };
                let near: Value = lacks((surface, i, dark));
                let far = self.seen[far].map(|(surface, _)| lacks((surface, far, self.value(far))));
                let far = far.unwrap_or_default();
                let lacks = std::array::from_fn(|c| near[c] + shown * (far[c] - near[c]));
                Some(Edge {
                    surface,
                    dark,
                    shown,
                    lacks,
                })
            });
        edges.min_by(|a, b| a.shown.total_cmp(&b.shown))
    }

    /// The picture without its shadows: each surface in full light, also where it shows through the edges of what lies on it.
    pub(super) fn lit(&self) -> Image {
        let value = |i: usize| {
            if let Some((surface, _)) = self.seen[i] {
                return self.base(surface, i);
            }
            let own = self.value(i);
            // v = (1 − s)·near + s·far, and the same of both sides in full light.
            let lacks = self.edge(i).map_or([0.0; 4], |edge| edge.lacks);
            std::array::from_fn(|c| (own[c] + lacks[c]).clamp(0.0, 1.0))
        };
        let values: Vec<Value> = (0..self.len()).map(value).collect();
        let color = |c: usize| {
            move |v: &Value| {
                if v[3] > 0.0 {
                    (v[c] / v[3]).min(1.0)
                } else {
                    0.0
                }
            }
        };
        let planes = [0, 1, 2].map(|c| values.iter().map(color(c)).collect());
        let [width, height] = self.size();
        let lit = Image::from_planes(width, height, planes);
        match self.picture.alpha() {
            Some(_) => lit
                .clone()
                .with_alpha(values.iter().map(|v| v[3]).collect())
                .unwrap_or(lit),
            None => lit,
        }
    }
}

/// A pixel between a shadow and what casts it.
struct Edge {
    surface: Surface,
    /// The value of the shadow there.
    dark: Value,
    /// How much of the pixel shows what casts it.
    shown: f32,
    /// What the pixel is short of full light.
    lacks: Value,
}
