//! Lines between two rows or columns of pixels: each of the two has half of their ink, so they look twice as wide and pale.
//!
//! Only a crossing tells such a line from a pale one. Where opaque lines of pale colours cross, the upper colour stays; where
//! lines cross that cover shares of a pixel, they cover more of it together. If a picture has such crossings, its lines
//! are traced as if they lay half a pixel away, on one row: there they have the colour of their pen, and are one shape
//! with what else that pen has drawn.

use super::Traced;
use super::areas::{LEVEL, Pixel, Pixels, away, distance2, mix};
use crate::math::{self, Point, Vec2, median};
use crate::scene::{Mark, Stroke};

/// Levels within which pixels are alike. A guess.
const ALIKE: f32 = 3.0 * LEVEL;
/// Shares whose difference is less are one. A guess.
const NEAR: f32 = 0.03;
/// Largest difference of the channels of inks that are one. A guess.
const ALMOST: f32 = 0.1;
/// Most inks that are compared with all others. A guess.
const MOST_INKS: usize = 64;
/// The share of a crossing's colour that none of its lines has. A guess.
const DARKER: f32 = 0.06;
/// Fewest crossings that tell a pen. A guess.
const LEAST_CROSSINGS: usize = 4;
/// Fewest pixels along a line. A guess.
const LEAST_LENGTH: usize = 6;
/// The share of a stroke that has to run along lines between rows. A guess.
const LEAST_ALONG: f32 = 0.7;

/// Lines between two rows or columns of a picture, and the pen that has drawn them.
#[derive(Debug)]
pub(crate) struct Halves {
    pen: Pen,
    list: Vec<Half>,
}

/// A pen, and the shares of a pixel that its lines cover.
#[derive(Debug)]
struct Pen {
    ink: Pixel,
    shares: Vec<f32>,
}

/// A line between two rows, or columns if it is upright.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Half {
    is_upright: bool,
    /// The first of the two rows.
    row: usize,
    /// Where it starts along those, and how long it is, px.
    start: usize,
    length: usize,
    /// The share of the pixels that it covers.
    share: f32,
}

impl Halves {
    /// Sets the lines between two rows or columns on one, if their crossings tell that they are such; and returns them.
    pub(super) fn set_on_rows(pixels: &mut Pixels<'_>) -> Option<Self> {
        let pen = pen(pixels)?;
        let mut list = pen.halves(pixels, false);
        if list.is_empty() || pen.halves(pixels, true).is_empty() {
            return None;
        }
        list.iter().for_each(|half| pixels.set(half, &pen.ink));
        // Once level lines are set, less crosses the upright ones: they are found anew.
        let upright = pen.halves(pixels, true);
        upright.iter().for_each(|half| pixels.set(half, &pen.ink));
        list.extend(upright);
        Some(Self { pen, list })
    }

    /// Puts strokes along those lines back to between their rows.
    pub(super) fn put_back(&self, traced: &mut [Traced]) {
        for mark in traced.iter_mut().map(|traced| &mut traced.mark) {
            if let Mark::Stroke(stroke) = mark {
                let back = |p| self.list.iter().fold(p, |p, half| half.put_back(p));
                stroke.path = stroke.path.clone().map(back);
            }
        }
    }

    /// The stroke as the pen has drawn it, if it runs along those lines for most of its way. On one matte.
    pub(crate) fn drawn(&self, stroke: &Stroke) -> Option<Stroke> {
        let line = stroke.path.flattened(0.1);
        let (mut all, mut own, mut covered) = (0.0, 0.0, 0.0);
        for ends in line.windows(2) {
            let way = ends[1] - ends[0];
            let steps = way.hypot().ceil();
            for step in 0..steps as usize {
                let at = ends[0] + way * ((step as f64 + 0.5) / steps);
                let is_along = |half: &&Half| half.is_at(at) && half.is_along(way);
                all += 1.0;
                if let Some(half) = self.list.iter().find(is_along) {
                    own += 1.0;
                    covered += half.share;
                }
            }
        }
        (own > LEAST_ALONG * all).then(|| Stroke {
            radius: (covered / own).into(),
            color: [0, 1, 2].map(|k| self.pen.ink[k]),
            opacity: 1.0,
            ..stroke.clone()
        })
    }
}

/// The pen that most of the crossings tell.
fn pen(pixels: &Pixels<'_>) -> Option<Pen> {
    let crossings = crossings(pixels);
    let told = crossings.iter();
    let told: Vec<(usize, Pixel)> = told
        .filter_map(|&crossing| Some((crossing, ink(pixels, crossing)?)))
        .collect();
    // A crossing tells little of a pale ink; what most of them tell is about right.
    let stride = told.len().div_ceil(MOST_INKS).max(1);
    let like = |ink: &Pixel| {
        let ink = *ink;
        told.iter()
            .filter(move |(_, other)| away(&ink, other) < ALMOST)
    };
    let (_, ink) = told
        .iter()
        .step_by(stride)
        .max_by_key(|(_, ink)| like(ink).count())?;
    let told: Vec<&(usize, Pixel)> = like(ink).collect();
    if told.len() < LEAST_CROSSINGS {
        return None;
    }
    let middle = |k: usize| median(told.iter().map(|(_, ink)| ink[k])).unwrap_or(ink[k]);
    let ink: Pixel = std::array::from_fn(middle);
    let mut shares: Vec<f32> = Vec::new();
    for side in told.iter().flat_map(|(i, _)| [i - 1, i - pixels.width]) {
        let share = pixels.share(side, &ink);
        let is_new = |share: &f32| shares.iter().all(|other| (other - share).abs() > NEAR);
        shares.extend(share.filter(is_new));
    }
    Some(Pen { ink, shares })
}

/// The crossings of lines between two rows and lines between two columns: four pixels alike, of which this is the first.
fn crossings(pixels: &Pixels<'_>) -> Vec<usize> {
    let w = pixels.width;
    let columns = 1..w.saturating_sub(2);
    let rows = 1..pixels.height.saturating_sub(2);
    let all = rows.flat_map(|y| columns.clone().map(move |x| y * w + x));
    let is_crossing = |&i: &usize| {
        let alike = |first: usize, others: [usize; 3]| {
            let mut others = others.into_iter();
            others.all(|other| pixels.are_alike(first, other))
        };
        !pixels.are_alike(i, i - 1)
            && alike(i, [i + 1, i + w, i + w + 1])
            && alike(i - 1, [i + 2, i + w - 1, i + w + 2])
            && alike(i - w, [i - w + 1, i + 2 * w, i + 2 * w + 1])
            && [i - w - 1, i - w + 2, i + 2 * w - 1, i + 2 * w + 2]
                .iter()
                .all(|&corner| pixels.is_bare(corner))
    };
    all.filter(is_crossing).collect()
}

/// The colour of two lines that cross, if they cover more of a pixel together than either does: as much as both do, less what
/// they share.
fn ink(pixels: &Pixels<'_>, crossing: usize) -> Option<Pixel> {
    let (canvas, both) = (pixels.canvas.at(crossing), pixels.target.at(crossing));
    let level = pixels.share(crossing - 1, &both)?;
    let upright = pixels.share(crossing - pixels.width, &both)?;
    if level.max(upright) > 1.0 - DARKER || level + upright < 1.0 + DARKER {
        return None;
    }
    // Of shares a and b of an ink, `both` is a + b − ab.
    let strength = level * upright / (level + upright - 1.0);
    let ink = mix(&canvas, &both, strength);
    let is_color = |value: &f32| (-ALMOST..1.0 + ALMOST).contains(value);
    let ink = Some(ink).filter(|ink| ink.iter().all(is_color));
    ink.map(|ink| ink.map(|value| value.clamp(0.0, 1.0)))
}

impl Pen {
    /// The lines between two rows, or columns.
    fn halves(&self, pixels: &Pixels<'_>, is_upright: bool) -> Vec<Half> {
        let [length, rows] = match is_upright {
            false => [pixels.width, pixels.height],
            true => [pixels.height, pixels.width],
        };
        let mut found = Vec::new();
        for row in 1..rows.saturating_sub(2) {
            let mut start = 0;
            while start < length {
                let half = Half {
                    is_upright,
                    row,
                    start,
                    length: 0,
                    share: 0.0,
                };
                let half = self.grown(pixels, half, length);
                found.extend(
                    half.filter(|(_, own)| *own >= LEAST_LENGTH)
                        .map(|(half, _)| half),
                );
                start += half.map_or(1, |(half, _)| half.length.max(1));
            }
        }
        found
    }

    /// The line that starts where `half` does, as far as it goes, and how many of its pixels nothing else covers.
    fn grown(&self, pixels: &Pixels<'_>, half: Half, end: usize) -> Option<(Half, usize)> {
        let mut half = Half {
            share: self.bare_share(pixels, half.pair(half.start, pixels.width))?,
            ..half
        };
        let mut own = 0;
        for k in half.start..end {
            let pair = half.pair(k, pixels.width);
            // What crosses the line, or lies on top of it, covers more.
            let covers = |i| {
                pixels
                    .share(i, &self.ink)
                    .is_some_and(|s| s > half.share - NEAR)
            };
            if !pair[1..3].iter().all(|&i| covers(i)) {
                break;
            }
            if self.bare_share(pixels, pair) == Some(half.share) {
                half.length = k + 1 - half.start;
                own += 1;
            }
        }
        Some((half, own))
    }

    /// The share that one of its lines covers of the two pixels in the middle of four side by side, if nothing else does.
    fn bare_share(&self, pixels: &Pixels<'_>, [above, a, b, below]: [usize; 4]) -> Option<f32> {
        let is_half = pixels.are_alike(a, b) && pixels.is_bare(above) && pixels.is_bare(below);
        let share = pixels.share(a, &self.ink).filter(|_| is_half)?;
        let mut shares = self.shares.iter().copied();
        shares.find(|own| (own - share).abs() < NEAR)
    }
}

impl Half {
    /// The pixels of both rows at `k` px along those, and the ones beside.
    fn pair(&self, k: usize, width: usize) -> [usize; 4] {
        [0, 1, 2, 3].map(|side| {
            let row = self.row + side - 1;
            match self.is_upright {
                false => row * width + k,
                true => k * width + row,
            }
        })
    }

    /// The shares that it covers once it is set on its first row.
    fn set(&self) -> [f32; 2] {
        // About a pixel is a pixel: nothing is left of it on the second row.
        match 2.0 * self.share {
            ink if (ink - 1.0).abs() < NEAR => [1.0, 0.0],
            ink => [ink.min(1.0), (ink - 1.0).max(0.0)],
        }
    }

    /// A place along and across the line, px.
    fn turned(&self, p: Point) -> [f32; 2] {
        let [x, y] = math::xy(p);
        if self.is_upright { [y, x] } else { [x, y] }
    }

    /// True near the line, where it lies in the picture.
    fn is_at(&self, p: Point) -> bool {
        let [x, y] = self.turned(p);
        self.reaches(x) && (y - self.row as f32 - 1.0).abs() < 0.5
    }

    fn is_along(&self, way: Vec2) -> bool {
        let [x, y] = self.turned(way.to_point());
        y.abs() < 0.1 * x.abs()
    }

    fn reaches(&self, along: f32) -> bool {
        let from = self.start as f32 - 1.0;
        (from..from + self.length as f32 + 2.0).contains(&along)
    }

    /// A place on the line as it was set, where that lies in the picture.
    fn put_back(&self, p: Point) -> Point {
        let [first, second] = self.set();
        let middle = self.row as f32 + (0.5 * first + 1.5 * second) / (first + second);
        let back = f64::from(self.row as f32 + 1.0 - middle);
        let [x, y] = self.turned(p);
        match self.reaches(x) && (y - middle).abs() < 1.0 {
            true if self.is_upright => Point::new(p.x + back, p.y),
            true => Point::new(p.x, p.y + back),
            false => p,
        }
    }
}

impl Pixels<'_> {
    fn are_alike(&self, a: usize, b: usize) -> bool {
        away(&self.target.at(a), &self.target.at(b)) < ALIKE
    }

    /// True if the canvas shows.
    fn is_bare(&self, i: usize) -> bool {
        away(&self.target.at(i), &self.canvas.at(i)) < ALIKE
    }

    /// The share of a pixel that `ink` covers, if it is a mixture of that and the canvas.
    fn share(&self, i: usize, ink: &Pixel) -> Option<f32> {
        let (target, canvas) = (self.target.at(i), self.canvas.at(i));
        let channels = || (0..6).map(|k| (target[k] - canvas[k], ink[k] - canvas[k]));
        let along: f32 = channels().map(|(seen, ink)| seen * ink).sum();
        let share = along / distance2(ink, &canvas).max(LEVEL * LEVEL);
        let beside = channels().map(|(seen, ink)| (seen - share * ink).abs());
        (beside.fold(0.0, f32::max) < ALIKE).then_some(share.clamp(0.0, 1.0))
    }

    /// Sets a line on its first row, as far as its ink goes, and the rest on the second one.
    fn set(&mut self, half: &Half, ink: &Pixel) {
        for k in half.start..half.start + half.length {
            let [_, a, b, _] = half.pair(k, self.width);
            for (i, own) in [a, b].into_iter().zip(half.set()) {
                // What others cover stays.
                let seen = self.coverage(i, ink);
                let others = (1.0 - (1.0 - seen) / (1.0 - half.share)).clamp(0.0, 1.0);
                let now = 1.0 - (1.0 - others) * (1.0 - own);
                let pixel = mix(&self.canvas.at(i), ink, now);
                let planes = self.target.0.iter_mut().zip(pixel);
                planes.for_each(|(plane, value)| plane.to_mut()[i] = value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::areas::Planes;
    use super::*;
    use crate::scene::{Cap, Path};

    const SIZE: usize = 48;

    /// A white page with these shares of black.
    fn page(share: impl Fn(usize, usize) -> f32) -> Pixels<'static> {
        let levels: Vec<f32> = (0..SIZE * SIZE)
            .map(|i| 1.0 - share(i % SIZE, i / SIZE))
            .collect();
        let planes = |levels: Vec<f32>| Planes(vec![levels.into(); 3]);
        Pixels {
            width: SIZE,
            height: SIZE,
            target: planes(levels),
            canvas: planes(vec![1.0; SIZE * SIZE]),
            weights: None,
        }
    }

    /// The share of a pixel that two level and two upright lines of 1.2 px cover between rows, where `both` is that of a
    /// crossing.
    fn grid(x: usize, y: usize, both: f32) -> f32 {
        let is_on = |v: usize| matches!(v, 11 | 12 | 31 | 32);
        let is_in = (4..44).contains(&x) && (4..44).contains(&y);
        match (is_on(x), is_on(y)) {
            (true, true) => both,
            (true, false) | (false, true) if is_in => 0.6,
            _ => 0.0,
        }
    }

    #[test]
    fn crossings_that_are_darker_tell_lines_between_rows() {
        let mut pixels = page(|x, y| grid(x, y, 0.84));
        let halves = Halves::set_on_rows(&mut pixels).unwrap();
        assert_eq!(halves.list.len(), 4, "{halves:?}");
        assert!(halves.pen.ink[0].abs() < 0.01, "{halves:?}");
        // All on the first row, and what is left on the second one.
        let at = |x: usize, y: usize| pixels.target.at(y * SIZE + x)[0];
        assert!(at(20, 11).abs() < 0.02 && (at(20, 12) - 0.8).abs() < 0.02);
        assert!(at(11, 11).abs() < 0.02 && (at(12, 12) - 0.64).abs() < 0.02);
        // A stroke along one of them has the pen's colour and width.
        let [from, to] = [5.0, 43.0].map(|x| Point::new(x, 12.1));
        let pale = Stroke {
            path: Path::line(from, to),
            radius: 1.0,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [0.4; 3],
            opacity: 1.0,
        };
        let drawn = halves.drawn(&pale).unwrap();
        assert!((drawn.radius - 0.6).abs() < 0.01 && drawn.color[0] < 0.01);
        let beside = pale.path.map(|p| Point::new(p.x, p.y + 3.0));
        let beside = Stroke {
            path: beside,
            ..pale
        };
        assert!(halves.drawn(&beside).is_none());
    }

    #[test]
    fn pale_lines_that_cross_are_pale() {
        let mut pixels = page(|x, y| grid(x, y, 0.6));
        assert!(Halves::set_on_rows(&mut pixels).is_none());
    }

    #[test]
    fn strokes_are_put_back_between_the_rows() {
        let mut pixels = page(|x, y| grid(x, y, 0.84));
        let halves = Halves::set_on_rows(&mut pixels).unwrap();
        // The ink of 1.2 px has its middle at a sixth of a pixel beyond that of the first row.
        let back = |p| halves.list.iter().fold(p, |p, half| half.put_back(p));
        let moved = back(Point::new(20.0, 11.5 + 1.0 / 6.0));
        assert!(
            (moved.y - 12.0).abs() < 0.01 && moved.x == 20.0,
            "{moved:?}"
        );
        let apart = Point::new(20.0, 20.0);
        assert_eq!(back(apart), apart);
    }
}
