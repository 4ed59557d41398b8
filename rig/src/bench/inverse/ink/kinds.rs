//! Drawings in ink of several kinds, each drawn by a counter-based seed.

use std::f64::consts::{PI, TAU};

use super::line::{Line, between, place};
use strokefit::math::{Point, Vec2, cos, exp, ln, powf, sin, sin_cos};
use strokefit::rng;

/// A kind of drawings, with its name and how one is drawn on a page.
pub(super) struct Kind {
    pub(super) name: &'static str,
    draw: fn(&mut Dice, [f64; 2]) -> Vec<Line>,
}

/// All kinds.
pub(super) const KINDS: [Kind; 7] = [
    Kind {
        name: "brush",
        draw: brush,
    },
    Kind {
        name: "nib",
        draw: nib,
    },
    Kind {
        name: "pen",
        draw: pen,
    },
    Kind {
        name: "hatch",
        draw: hatch,
    },
    Kind {
        name: "kanji",
        draw: kanji,
    },
    Kind {
        name: "signature",
        draw: signature,
    },
    Kind {
        name: "splines",
        draw: splines,
    },
];

impl Kind {
    /// The lines of drawing `number` of this kind, and its width and height, px.
    pub(super) fn drawing(&self, number: usize) -> (Vec<Line>, [usize; 2]) {
        let mut dice = Dice::new(self.name, number);
        let size = match self.name {
            "kanji" => [GLYPH_PX; 2],
            "splines" => [400.0 + dice.below(201) as f64; 2],
            _ => [0, 1].map(|_| 300.0 + dice.below(301) as f64),
        };
        ((self.draw)(&mut dice, size), size.map(|px| px as usize))
    }
}

/// Random numbers, one after the other.
pub(super) struct Dice {
    kind: u64,
    number: u64,
    drawn: u64,
}

impl Dice {
    /// Those of drawing `number` of a kind.
    pub(super) fn new(kind: &str, number: usize) -> Self {
        let digits = kind.bytes().map(u64::from);
        Self {
            kind: digits.fold(0, |sum, digit| sum * 31 + digit),
            number: number as u64,
            drawn: 0,
        }
    }

    fn uniform(&mut self) -> f64 {
        self.drawn += 1;
        f64::from(rng::draw(0, self.kind, self.number, self.drawn))
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    fn below(&mut self, count: usize) -> usize {
        (self.uniform() * count as f64) as usize
    }

    fn chance(&mut self, share: f64) -> bool {
        self.uniform() < share
    }

    fn within(&mut self, size: [f64; 2], margin: f64) -> Point {
        let [x, y] = size.map(|side| self.between(margin, side - margin));
        Point::new(x, y)
    }
}

/// Points of each span of a spline.
const STEPS: usize = 64;

/// A uniform cubic B-spline from the first of its control points to the last, [`STEPS`] points for each. It stays within the hull
/// of its control points, and its curvature is continuous.
fn spline(controls: &[Point]) -> Vec<Point> {
    let [Some(&first), Some(&last)] = [controls.first(), controls.last()] else {
        return Vec::new();
    };
    let padded = [&[first; 2], controls, &[last; 2]].concat();
    let at = |p: &[Point], t: f64| {
        let s = 1.0 - t;
        let weights = [
            s * s * s,
            3.0 * t * t * t - 6.0 * t * t + 4.0,
            3.0 * s * s * s - 6.0 * s * s + 4.0,
            t * t * t,
        ];
        let sum = p.iter().zip(weights).map(|(p, w)| p.to_vec2() * (w / 6.0));
        sum.fold(Vec2::ZERO, |sum, term| sum + term).to_point()
    };
    let spans = padded.windows(4);
    let curve = spans.flat_map(|span| (0..STEPS).map(move |i| at(span, i as f64 / STEPS as f64)));
    curve.chain([last]).collect()
}

/// A smooth step from 0 to 1 between two places.
fn step(from: f64, to: f64, at: f64) -> f64 {
    let t = ((at - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// 0 at both ends, 1 at `peak` (0..1).
fn bump(t: f64, peak: f64) -> f64 {
    sin(PI * powf(t, ln(0.5) / ln(peak)))
}

/// Splines that cross, 1 px wide at their ends and up to 12 between; some have blunt ends.
fn brush(dice: &mut Dice, size: [f64; 2]) -> Vec<Line> {
    let count = 4 + dice.below(9);
    let line = |_| {
        let centre = sweep(dice, size);
        let (broad, peak) = (dice.between(2.0, 6.0), dice.between(0.25, 0.75));
        let sharp = dice.between(0.8, 1.8);
        let swell = move |t: f64| 0.5 + (broad - 0.5) * powf(bump(t, peak), sharp);
        let [is_blunt, at_both] = [dice.chance(0.3), dice.chance(0.3)];
        Line::with_profile(&centre, move |t| {
            let before = is_blunt && t < peak;
            let after = is_blunt && at_both && t > peak;
            if before || after { broad } else { swell(t) }
        })
    };
    (0..count).map(line).collect()
}

/// An arc across the page that sways a little.
fn sweep(dice: &mut Dice, size: [f64; 2]) -> Vec<Point> {
    const MARGIN_PX: f64 = 14.0;
    let least = 0.4 * size[0].min(size[1]);
    loop {
        let [a, b] = [0, 1].map(|_| dice.within(size, MARGIN_PX));
        let axis = b - a;
        let across = Vec2::new(-axis.y, axis.x);
        let (bow, sway) = (dice.between(-0.35, 0.35), dice.between(-0.12, 0.12));
        let control = |i: u8| {
            let t = f64::from(i) / 6.0;
            a + axis * t + across * (bow * sin(PI * t) + sway * sin(TAU * t))
        };
        let controls: Vec<Point> = (0..=6).map(control).collect();
        let is_in = |p: &Point| {
            let sides = [(p.x, size[0]), (p.y, size[1])];
            sides
                .iter()
                .all(|(at, side)| (MARGIN_PX..=side - MARGIN_PX).contains(at))
        };
        if axis.hypot() > least && controls.iter().all(is_in) {
            return spline(&controls);
        }
    }
}

/// Rows of script with a broad nib: the width depends on the direction, w = max(thin, broad·|sin(angle − nib)|).
fn nib(dice: &mut Dice, size: [f64; 2]) -> Vec<Line> {
    let (thin, broad) = (dice.between(0.6, 1.0), dice.between(3.0, 5.0));
    let (y, x) = sin_cos(-dice.between(0.5, 0.9));
    script(dice, size, |direction| {
        let across = direction.cross(Vec2::new(x, y)).abs();
        thin.max(broad * across)
    })
}

/// Rows of script with a pointed pen: thick where it goes down, thin where it goes up.
fn pen(dice: &mut Dice, size: [f64; 2]) -> Vec<Line> {
    let (thin, broad) = (dice.between(0.5, 0.8), dice.between(2.0, 4.0));
    script(dice, size, |direction| {
        thin + (broad - thin) * powf(direction.y.max(0.0), 1.5)
    })
}

/// Two to four rows of loops and arches, each one line.
fn script(dice: &mut Dice, size: [f64; 2], radius: impl Fn(Vec2) -> f64) -> Vec<Line> {
    let rows = 2 + dice.below(3);
    let height = size[1] / rows as f64;
    let row = |row: usize| {
        let base = height * (row as f64 + 0.5);
        let letters = ((size[0] - 60.0) / (0.5 * height)).clamp(3.0, 8.0) as usize;
        let advance = (size[0] - 60.0) / letters as f64;
        let mut each = |low: f64, high: f64| -> Vec<Point> {
            let value = |_| Point::new(0.0, dice.between(low, high));
            spline(&(0..=letters).map(value).collect::<Vec<_>>())
        };
        // Half the height, and half the width of a letter without that of the row: below 1/TAU it is an arch, above a loop.
        let [tall, wide] = [each(0.2, 0.42), each(-0.3, 0.7)];
        let lean = dice.between(0.0, 0.35);
        let last = (tall.len() - 1) as f64;
        let at = |i: usize| {
            let turns = letters as f64 * i as f64 / last;
            let (s, c) = sin_cos(TAU * turns);
            let rise = height * tall[i].y * c;
            let x = 30.0 + advance * turns + advance * wide[i].y * s + lean * rise;
            Point::new(x.clamp(8.0, size[0] - 8.0), base - rise)
        };
        directed(&(0..tall.len()).map(at).collect::<Vec<_>>(), &radius)
    };
    (0..rows).map(row).collect()
}

/// A line whose radius depends on its direction, a unit vector; smoothed over some px as no hand changes at once.
fn directed(centre: &[Point], radius: impl Fn(Vec2) -> f64) -> Line {
    const HALF_PX: usize = 4;
    let mut line = Line::with_profile(centre, |_| 0.0);
    let samples = &line.samples;
    let near = |i: usize| i.saturating_sub(HALF_PX)..(i + HALF_PX + 1).min(samples.len());
    let own = |i: usize| {
        let near = &samples[near(i)];
        let [first, last] = [near[0], near[near.len() - 1]].map(place);
        let length = first.distance(last).max(f64::MIN_POSITIVE);
        radius((last - first) / length)
    };
    let radii: Vec<f64> = (0..samples.len()).map(own).collect();
    let mean = |i: usize| radii[near(i)].iter().sum::<f64>() / near(i).len() as f64;
    let smooth: Vec<f64> = (0..radii.len()).map(mean).collect();
    for (sample, radius) in line.samples.iter_mut().zip(smooth) {
        sample[2] = (radius * 1000.0).round() / 1000.0;
    }
    line
}

/// Engraving: a layer of lines, or two that cross.
fn hatch(dice: &mut Dice, size: [f64; 2]) -> Vec<Line> {
    let turn = dice.between(-0.6, 0.6);
    let mut lines = layer(dice, size, turn);
    if dice.number.is_multiple_of(2) {
        let other = turn + dice.between(0.9, 1.6);
        lines.extend(layer(dice, size, other));
    }
    lines
}

/// Curved lines 4 to 6 px apart that swell and taper, and may touch where they swell.
fn layer(dice: &mut Dice, size: [f64; 2], turn: f64) -> Vec<Line> {
    let count = 10 + dice.below(6);
    let spacing = dice.between(4.0, 6.0);
    let (s, c) = sin_cos(turn);
    let (along, across) = (Vec2::new(c, s), Vec2::new(-s, c));
    let half = 0.4 * size[0].min(size[1]);
    let middle = Point::new(size[0] / 2.0, size[1] / 2.0);
    let (bow, sway) = (dice.between(-0.25, 0.25), dice.between(-0.1, 0.1));
    let broad = spacing * dice.between(0.35, 0.55);
    let (peak, drift) = (dice.between(0.35, 0.65), dice.between(-0.2, 0.2));
    let line = |i: usize| {
        let row = i as f64 / (count - 1) as f64 - 0.5;
        let [from, to] = [-1.0, 1.0].map(|end| end * half + dice.between(-8.0, 8.0));
        let control = |k: u8| {
            let t = f64::from(k) / 6.0;
            let off = half * (bow * sin(PI * t) + sway * sin(TAU * t));
            let off = off + row * spacing * (count - 1) as f64;
            middle + along * (from + (to - from) * t) + across * off
        };
        let centre = spline(&(0..=6).map(control).collect::<Vec<_>>());
        let broad = broad * (1.0 - 0.8 * row * row);
        Line::with_profile(&centre, |t| {
            0.4 + (broad - 0.4) * bump(t, peak + drift * row)
        })
    };
    (0..count).map(line).collect()
}

/// Side of the box of `KanjiVG`'s glyphs, and of their pictures, px.
const BOX: f64 = 109.0;
const GLYPH_PX: f64 = 4.0 * BOX;

/// Control points of a stroke.
type Stroke = &'static [[f64; 2]];

/// Strokes of some glyphs, in [`BOX`]; a control point that comes three times is a corner.
const GLYPHS: [&[Stroke]; 4] = [
    // Ten.
    &[
        &[[14.0, 50.0], [54.0, 49.0], [96.0, 45.0]],
        &[[54.0, 12.0], [55.0, 55.0], [54.0, 98.0]],
    ],
    // Tree.
    &[
        &[[16.0, 38.0], [54.0, 36.0], [93.0, 33.0]],
        &[[54.0, 11.0], [55.0, 55.0], [54.0, 98.0]],
        &[[52.0, 38.0], [42.0, 58.0], [13.0, 80.0]],
        &[[56.0, 38.0], [66.0, 60.0], [97.0, 78.0]],
    ],
    // Eternity.
    &[
        &[[47.0, 9.0], [53.0, 13.0], [60.0, 20.0]],
        &[
            [37.0, 31.0],
            [56.0, 29.0],
            [56.0, 29.0],
            [56.0, 29.0],
            [56.0, 60.0],
            [55.0, 96.0],
            [55.0, 97.0],
            [53.0, 96.0],
            [43.0, 86.0],
        ],
        &[
            [17.0, 49.0],
            [42.0, 46.0],
            [42.0, 46.0],
            [42.0, 46.0],
            [36.0, 66.0],
            [13.0, 86.0],
        ],
        &[[89.0, 31.0], [80.0, 42.0], [60.0, 53.0]],
        &[[57.0, 40.0], [66.0, 66.0], [99.0, 88.0]],
    ],
    // River.
    &[
        &[[26.0, 18.0], [28.0, 58.0], [13.0, 92.0]],
        &[[54.0, 22.0], [55.0, 50.0], [54.0, 80.0]],
        &[[84.0, 14.0], [85.0, 60.0], [84.0, 98.0]],
    ],
];

/// A glyph of brush strokes.
fn kanji(dice: &mut Dice, _: [f64; 2]) -> Vec<Line> {
    let glyph = GLYPHS[dice.number as usize % GLYPHS.len()];
    let stroke = |controls: &Stroke| {
        let mut moved = |[x, y]: [f64; 2]| {
            let [dx, dy] = [0, 1].map(|_| dice.between(-0.3, 0.3));
            Point::new(x + dx, y + dy)
        };
        let controls: Vec<Point> = controls.iter().map(|p| moved(*p)).collect();
        spline(&controls)
    };
    let centres: Vec<Vec<Point>> = glyph.iter().map(stroke).collect();
    let large = |p: &Point| (p.to_vec2() * (GLYPH_PX / BOX)).to_point();
    let centres = centres
        .iter()
        .map(|centre| centre.iter().map(large).collect());
    pressed(dice, &centres.collect::<Vec<_>>())
}

/// Brush strokes on centre lines: pressed down, thin, and then stopped, or thinner and thinner.
pub(super) fn pressed(dice: &mut Dice, centres: &[Vec<Point>]) -> Vec<Line> {
    let base = dice.between(4.0, 6.5);
    let stroke = |centre: &Vec<Point>| {
        let [down, thin] = [dice.between(1.0, 1.3), dice.between(0.6, 0.85)];
        let (end, from) = if dice.chance(0.5) {
            (dice.between(1.0, 1.3), 0.75)
        } else {
            (0.1, dice.between(0.4, 0.7))
        };
        Line::with_profile(centre, |t| {
            let rise = 0.7 * down + 0.3 * down * step(0.0, 0.08, t);
            let fall = (thin - down) * step(0.08, 0.3, t);
            base * (rise + fall + (end - thin) * step(from, 1.0, t))
        })
    };
    centres.iter().map(stroke).collect()
}

/// Smoothed random walks with loops; the faster the pen, the thinner.
fn signature(dice: &mut Dice, size: [f64; 2]) -> Vec<Line> {
    let count = 1 + dice.below(3);
    let band = (size[1] - 40.0) / count as f64;
    let line = |row: usize| {
        let mut here = Point::ORIGIN;
        let mut walk = vec![here];
        for _ in 0..6 + dice.below(6) {
            if dice.chance(0.5) {
                let (wide, tall) = (dice.between(0.4, 0.9), dice.between(0.6, 1.8));
                let start = dice.between(0.0, TAU);
                for k in 0..6 {
                    let angle = start + f64::from(k) * 0.9;
                    let round = Vec2::new(wide * cos(angle), tall * sin(angle));
                    walk.push(here + round + Vec2::new(0.15 * f64::from(k), 0.0));
                }
            } else {
                let rise = dice.between(-1.6, 1.6);
                walk.push(here + Vec2::new(dice.between(0.2, 0.8), rise));
            }
            here += Vec2::new(dice.between(0.6, 1.8), dice.between(-0.3, 0.3));
        }
        let top = 20.0 + band * row as f64;
        let walk = fitted(&walk, [20.0, top], [size[0] - 40.0, band - 16.0]);
        slowed(&spline(&walk), dice.between(2.5, 4.5))
    };
    (0..count).map(line).collect()
}

/// Points moved and scaled to fill a rectangle.
fn fitted(points: &[Point], corner: [f64; 2], size: [f64; 2]) -> Vec<Point> {
    let axis = |of: fn(&Point) -> f64, k: usize| {
        let low = points.iter().map(of).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        move |p: &Point| corner[k] + (of(p) - low) / (high - low) * size[k]
    };
    let (x, y) = (axis(|p| p.x, 0), axis(|p| p.y, 1));
    points.iter().map(|p| Point::new(x(p), y(p))).collect()
}

/// A line through points that a pen reaches one after the other in equal times: thinner where they are farther apart.
fn slowed(points: &[Point], broad: f64) -> Line {
    let steps: Vec<f64> = points.windows(2).map(|w| w[0].distance(w[1])).collect();
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    let speed = |i: usize| steps[i.min(steps.len() - 1)] / mean;
    let sample = |(i, p): (usize, &Point)| {
        let radius = 0.5 + (broad - 0.5) * exp(-speed(i) * speed(i));
        [p.x, p.y, radius]
    };
    let samples: Vec<[f64; 3]> = points.iter().enumerate().map(sample).collect();
    Line::through(&samples)
}

/// Three splines from left to right that cross, 2 px wide at first, then 18, and 1 at last.
fn splines(dice: &mut Dice, size: [f64; 2]) -> Vec<Line> {
    let sign = if dice.chance(0.5) { 1.0 } else { -1.0 };
    let line = |i: u8| {
        let from = (f64::from(i) + 0.5) / 3.0;
        // The middle one bows, so that no two cross where others do.
        let bow = if i == 1 { 0.3 * sign } else { 0.0 };
        let control = |k: u8| {
            let t = f64::from(k) / 4.0;
            let wave = bow * sin(PI * t) + dice.between(-0.06, 0.06);
            let y = from + (1.0 - 2.0 * from) * t + wave;
            let y = 30.0 + (size[1] - 60.0) * y.clamp(0.0, 1.0);
            Point::new(20.0 + (size[0] - 40.0) * t, y)
        };
        let centre = spline(&(0..=4).map(control).collect::<Vec<_>>());
        let peak = dice.between(0.35, 0.65);
        let ends = [[0.0, 0.0, 1.0], [0.0, 0.0, 9.0], [0.0, 0.0, 0.5]];
        Line::with_profile(&centre, move |t| {
            let rise = between(ends[0], ends[1], step(0.0, peak, t));
            between(rise, ends[2], step(peak, 1.0, t))[2]
        })
    };
    (0..3).map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawings_are_on_their_pages_and_differ() {
        for kind in &KINDS {
            for number in 1..=8 {
                let (lines, size) = kind.drawing(number);
                assert!((2..=30).contains(&lines.len()) || kind.name == "signature");
                let mut samples = lines.iter().flat_map(|line| &line.samples);
                let is_off = |s: &&[f64; 3]| {
                    let sides = size.map(|px| px as f64);
                    s[0] < s[2] || s[1] < s[2] || s[0] + s[2] > sides[0] || s[1] + s[2] > sides[1]
                };
                let off = samples.find(is_off);
                assert_eq!(off, None, "{} {number} {size:?}", kind.name);
                assert_eq!(kind.drawing(number).0, lines);
            }
            assert_ne!(kind.drawing(1), kind.drawing(2));
        }
    }
}
