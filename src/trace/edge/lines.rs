//! Lines of one width, or of a varying one, along middles that were traced.
//!
//! The integral of the shares across a line is its width, and their mean is its middle, whatever the filter is.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_4;

use super::super::contour::Field;
use super::coverage::Coverage;
use super::curve::Ring;
use super::describe::{self, PRICE, Sample, corner};
use super::edits;
use super::line::{FLAT, Line};
use super::refine::{self, Target};
use super::segment::{Knot, Segment, distance2};
use super::shapes;
use super::{FREE, Shares, whole};
use crate::math::{self, Point, Vec2, median};
use crate::scene::Cap;

/// Standard deviation of the middle that a column tells in a clean picture, px: that of an edge.
const CLEAN: f64 = 0.03;
/// Deviations with which descriptions are tried, in units of that.
const DOUBTS: [f64; 2] = [1.0, 2.5];
/// Farthest that a line's width in a column may be from its own: px, and in units of it. Where it is farther, something else is there,
/// or the line ends. A guess.
const ODD: [f64; 2] = [0.3, 0.1];
/// Rounds of refining lines that cross.
const ROUNDS: usize = 2;

/// The middle of a line, as it was traced.
pub(in crate::trace) struct Middle {
    /// Places along it, px.
    pub(in crate::trace) places: Vec<Point>,
    pub(in crate::trace) is_closed: bool,
    /// About half its width, px.
    pub(in crate::trace) radius: f64,
    /// About half its width at each place, px, if that varies.
    pub(in crate::trace) radii: Vec<f64>,
    /// Discs in which other lines are, too, so that profiles do not tell its width: centres and radii, px.
    pub(in crate::trace) crossings: Vec<(Point, f64)>,
}

impl Middle {
    fn is_varying(&self) -> bool {
        !self.radii.is_empty()
    }
}

/// Lines along some middles that cover what `shares` tell, and the length of the description of the page by them; `None` if that will not
/// become shorter than `most`.
pub(super) fn lines(
    field: &Field,
    shares: &Shares<'_>,
    middles: &[Middle],
    most: f64,
) -> Option<(Vec<Line>, f64)> {
    // 1. Each by itself.
    let profiles: Vec<Vec<Profile>> = middles
        .iter()
        .map(|middle| profiles(field, shares, middle))
        .collect();
    let even = (0..middles.len()).filter(|&i| !middles[i].is_varying());
    let beyond: f64 = even.map(|i| beyond(middles, i, &profiles[i])).sum();
    if beyond > LOST * most + WIDE {
        return None;
    }
    let described = middles
        .iter()
        .zip(&profiles)
        .map(|(middle, profiles)| described(middle, profiles));
    let described: Vec<Vec<Line>> = described.collect();
    if described.iter().any(Vec::is_empty) {
        return None;
    }
    let first = described.iter().map(|rivals| rivals[0].clone());
    let mut drawn = Drawn::new(shares, first);
    // 2. On the pixels that no other one touches: the nearest of each, then better ones.
    for (i, rivals) in described.iter().enumerate() {
        let target = drawn.target(&rivals[0], &[i]);
        let settled = rivals.iter().map(|line| settled(line, &target));
        if let Some((_, best)) = settled.min_by(|a, b| a.0.total_cmp(&b.0)) {
            drawn.change(&[i], Some(best));
        }
    }
    let is_ink = middles.iter().any(Middle::is_varying);
    let (hopeless, lost) = match is_ink {
        false => (HOPELESS[0] * most + HOPELESS[1], LOST * most),
        true => (HOPELESS_INK * most, LOST_INK * most),
    };
    if drawn.length > hopeless {
        return None;
    }
    for _ in 0..ROUNDS {
        drawn.each(|line, target| improved(line, target).1);
    }
    if drawn.length > lost {
        return None;
    }
    // 3. Those that are one.
    let length = join(&mut drawn);
    Some((drawn.into_lines(), length))
}

/// Lines that are so many times as long as a rival description, and so many nats besides, before any edit do not become shorter than that.
/// Of those that did, of 79 icons and 8 plans, the most is 31 times, and 900.
const HOPELESS: [f64; 2] = [20.0, 1000.0];
/// As [`HOPELESS`], times as long before lines are joined. The most is 2.
const LOST: f64 = 3.0;
/// As [`HOPELESS`] and [`LOST`], of lines of varying width. Of 14 drawings in ink, the most are 7.4 and 1.2.
const HOPELESS_INK: f64 = 10.0;
const LOST_INK: f64 = 1.5;
/// What has widths that no line has by as many nats, and more than [`LOST`], is none. Of lines in 63 clip arts, the most is 400.
const WIDE: f64 = 600.0;

/// Lines that are refined as they are.
pub(super) fn settle(shares: &Shares<'_>, lines: Vec<Line>) -> Vec<Line> {
    let mut drawn = Drawn::new(shares, lines);
    drawn.each(|line, target| settled(line, target).1);
    drawn.into_lines()
}

/// Lines of a page, and the length of its description by them. Who covers each pixel is kept, so that a change costs what it touches.
struct Drawn<'a> {
    shares: &'a Shares<'a>,
    /// `None` where a line is gone.
    lines: Vec<Option<Line>>,
    /// For each pixel of the page, the lines that cover some of it, and how much each does.
    covers: Vec<Vec<(usize, f64)>>,
    /// Where a line is and how wide does not count.
    length: f64,
}

impl<'a> Drawn<'a> {
    fn new(shares: &'a Shares<'a>, lines: impl IntoIterator<Item = Line>) -> Self {
        let mut drawn = Self {
            shares,
            lines: Vec::new(),
            covers: vec![Vec::new(); shares.values.len()],
            length: 0.0,
        };
        let pixels = 0..shares.values.len();
        drawn.length = pixels.map(|i| drawn.half_square(i, &[], 0.0)).sum();
        for (i, line) in lines.into_iter().enumerate() {
            drawn.lines.push(None);
            drawn.change(&[i], Some(line));
        }
        drawn
    }

    fn into_lines(self) -> Vec<Line> {
        self.lines.into_iter().flatten().collect()
    }

    /// The lines that are there.
    fn present(&self) -> impl Iterator<Item = usize> {
        (0..self.lines.len()).filter(|&i| self.lines[i].is_some())
    }

    /// Gives each line the place of what `work` makes of it and of what is left for it.
    fn each(&mut self, work: impl Fn(&Line, &Target) -> Line) {
        for i in 0..self.lines.len() {
            if let Some(line) = &self.lines[i] {
                let line = work(line, &self.target(line, &[i]));
                self.change(&[i], Some(line));
            }
        }
    }

    /// The pixels that a line covers, and how much of each.
    fn covered(&self, line: &Line) -> Vec<(usize, f64)> {
        let mut covered = Vec::new();
        self.shares.covered(&Ring::Line(line.clone()), |i, share| {
            if share > 0.0 {
                covered.push((i, share));
            }
        });
        covered
    }

    /// Half the squared error of a pixel without the lines `gone`, and with a new one that covers `share` of it.
    fn half_square(&self, i: usize, gone: &[usize], share: f64) -> f64 {
        let [mut least, mut most] = [share; 2];
        for (line, share) in &self.covers[i] {
            if !gone.contains(line) {
                (least, most) = (share.max(least), share + most);
            }
        }
        self.shares.half_square(i, [least, most.min(1.0)])
    }

    /// By how much the description becomes longer with a line in the place of those that are `gone`, or without these.
    fn growth(&self, gone: &[usize], line: Option<&Line>) -> f64 {
        let mut touched = line.map_or_else(Vec::new, |line| self.covered(line));
        let mut numbers = line.map_or(0.0, numbers);
        for line in gone.iter().filter_map(|&i| self.lines[i].as_ref()) {
            let uncovered = self.covered(line).into_iter().map(|(i, _)| (i, 0.0));
            touched.extend(uncovered);
            numbers -= self::numbers(line);
        }
        // A pixel of both counts once, with its new share, which comes first.
        touched.sort_by_key(|(i, _)| *i);
        touched.dedup_by_key(|(i, _)| *i);
        let growth = touched.into_iter().map(|(i, share)| {
            let after = self.half_square(i, gone, share);
            after - self.half_square(i, &[], 0.0)
        });
        growth.sum::<f64>() + PRICE * numbers
    }

    /// Puts a line in the place of the first of those that are `gone`, or none. Returns the lines that share pixels with these.
    fn change(&mut self, gone: &[usize], line: Option<Line>) -> BTreeSet<usize> {
        self.length += self.growth(gone, line.as_ref());
        let mut beside = BTreeSet::new();
        for &i in gone {
            let Some(line) = self.lines[i].take() else {
                continue;
            };
            for (pixel, _) in self.covered(&line) {
                self.covers[pixel].retain(|(line, _)| *line != i);
                beside.extend(self.covers[pixel].iter().map(|(line, _)| *line));
            }
        }
        if let Some(line) = &line {
            for (pixel, share) in self.covered(line) {
                beside.extend(self.covers[pixel].iter().map(|(line, _)| *line));
                self.covers[pixel].push((gone[0], share));
            }
        }
        self.lines[gone[0]] = line;
        beside.extend(gone);
        beside
    }

    /// What a line is to cover in the place of those that are `gone`, beside the others.
    fn target(&self, own: &Line, gone: &[usize]) -> Target {
        // Ends and corners may be some way off: bands of 6 px side by side, as wide as the line on each side.
        let radius = own.radius();
        let count = (radius / 6.0).ceil() as i32 + 1;
        let wide = (-count..=count).filter_map(|k| {
            let by = 6.0 * f64::from(k);
            (k != 0 && radius + by > 0.0).then(|| Ring::Line(own.widened(by)))
        });
        let wide: Vec<Ring> = wide.collect();
        let wide: Vec<&Ring> = wide.iter().collect();
        let page = self.shares.page;
        let mut target = self
            .shares
            .target(whole(&Ring::Line(own.clone()), &wide, page));
        let pixels: Vec<usize> = target.band.places().map(|at| page.index(at)).collect();
        for (k, pixel) in pixels.into_iter().enumerate() {
            let others = self.covers[pixel].iter();
            for (_, share) in others.filter(|(line, _)| !gone.contains(line)) {
                // Of a pixel, the others may cover what this one does, or the rest: what is left for it lies in between.
                target.shares[k] -= 0.5 * share;
                target.slacks[k] += 0.5 * share;
                if *share > COVERED {
                    target.weights[k] = 0.0;
                }
            }
        }
        target
    }
}

/// The numbers of a line that count.
fn numbers(line: &Line) -> f64 {
    line.freedom() as f64 - FREE[1]
}

/// The line near this one for which the description is shortest, and the length of that. What cannot become shorter than `most` is given
/// up. Of a line after an edit, what is near that moves.
fn refined(Changed { line, near }: Changed, target: &Target, most: f64) -> (f64, Line) {
    let count = line.knots.len();
    let around = |i: usize| (0..2 * NEAR + 1).map(move |d| (i + count * NEAR + d - NEAR) % count);
    let free: BTreeSet<usize> = match near {
        None => (0..count).collect(),
        Some(i) => around(i).collect(),
    };
    let free: Vec<usize> = free.into_iter().collect();
    let ring = Ring::Line(line.clone());
    let price = PRICE * ring.freedom();
    let (ring, chi2) = refine::refined(&ring, &free, target, ITERATIONS, 2.0 * (most - price));
    match ring {
        Ring::Line(refined) => (0.5 * chi2 + price, refined),
        _ => (f64::INFINITY, line),
    }
}

/// As [`refined`], the whole line.
fn settled(line: &Line, target: &Target) -> (f64, Line) {
    let line = line.clone();
    refined(Changed { line, near: None }, target, f64::INFINITY)
}

/// A share above which nothing else in a pixel is seen.
const COVERED: f64 = 0.98;

/// Takes away lines that do not pay, and joins those whose ends are near each other where that is shorter. Returns the least length of the
/// description on the way.
fn join(drawn: &mut Drawn<'_>) -> f64 {
    // Where a line is and how wide counts here, so that fewer lines are shorter. Lines that win beside outlines as several do so as one.
    let place = PRICE * FREE[1];
    let mut least = drawn.length;
    let count = drawn.lines.len();
    // What was tried with the lines as they are: each pair and, of one line, its ends; and to do without it.
    let mut is_tried = vec![false; count * count];
    let mut is_needed = vec![false; count];
    while let Some((gone, line)) = shorter(drawn, place, &mut is_tried, &mut is_needed) {
        let beside = drawn.change(&gone, line);
        least = least.min(drawn.length);
        for i in beside {
            is_needed[i] = false;
            for k in 0..count {
                (is_tried[i * count + k], is_tried[k * count + i]) = (false, false);
            }
        }
    }
    least
}

/// The first lines that are better gone, or as one, at so much for the `place` of a line.
fn shorter(
    drawn: &Drawn<'_>,
    place: f64,
    is_tried: &mut [bool],
    is_needed: &mut [bool],
) -> Option<(Vec<usize>, Option<Line>)> {
    let count = drawn.lines.len();
    let present: Vec<usize> = drawn.present().collect();
    for (from, &i) in present.iter().enumerate() {
        if present.len() > 1 && !is_needed[i] {
            if drawn.growth(&[i], None) < place {
                return Some((vec![i], None));
            }
            is_needed[i] = true;
        }
        for &k in &present[from..] {
            if std::mem::replace(&mut is_tried[i * count + k], true) {
                continue;
            }
            let [Some(own), Some(other)] = [i, k].map(|i| drawn.lines[i].as_ref()) else {
                continue;
            };
            let (joined, gone, saved) = match k == i {
                true => (own.closed().into_iter().collect(), vec![i], 0.0),
                false => (own.joined_with(other), vec![i, k], place),
            };
            for line in joined {
                let target = drawn.target(&line, &gone);
                let line = settled(&line, &target).1;
                if drawn.growth(&gone, Some(&line)) > saved + JOINED * PRICE {
                    continue;
                }
                let line = improved(&line, &target).1;
                if drawn.growth(&gone, Some(&line)) < saved {
                    return Some((gone, Some(line)));
                }
            }
        }
    }
    None
}

/// Lines that are joined may be longer by so many prices of a number before any edit. A guess.
const JOINED: f64 = 10.0;

/// The line near this one with the shortest description, and the length of that.
fn improved(line: &Line, target: &Target) -> (f64, Line) {
    let mut best = settled(line, target);
    let mut work = 0;
    loop {
        let before = best.0;
        for changed in edits(&best.1, &off(&best.1, target)) {
            work += target.shares.len();
            if work > MOST_WORK {
                return best;
            }
            let changed = refined(changed, target, best.0);
            if changed.0 < best.0 {
                best = changed;
            }
        }
        if best.0 >= before {
            return best;
        }
        let settled = settled(&best.1, target);
        if settled.0 < best.0 {
            best = settled;
        }
    }
}

/// Most pixels that the edits of a line look at, an edit after the other: about a second. A long wide line in JPEG took 9 s.
const MOST_WORK: usize = 10_000_000;

/// True for each segment of a line that more numbers may mend: half of χ² of the pixels that its edges touch is as large as the price
/// of one.
fn off(line: &Line, target: &Target) -> Vec<bool> {
    let covered = Coverage::of(&Ring::Line(line.clone()), &target.band).shares();
    let count = line.knots.len();
    let is_off = |i: usize| {
        let end = Knot {
            segment: Segment::Line,
            is_smooth: false,
            ..line.knots[(i + 1) % count]
        };
        let part = Ring::Line(Line {
            knots: vec![line.knots[i], end],
            is_closed: false,
            ..line.clone()
        });
        let touched = Coverage::of(&part, &target.band).touched();
        (PRICE..FAR * PRICE).contains(&target.half_chi2(&touched, &covered))
    };
    (0..line.segments()).map(is_off).collect()
}

/// A line after an edit, and the vertex near which it is: of the whole line, if none.
struct Changed {
    line: Line,
    near: Option<usize>,
}

/// A segment that is farther off what is seen, in prices of numbers, is another one: more numbers do not mend it. A guess.
const FAR: f64 = 60.0;
/// Vertices before and behind an edit that settle with it.
const NEAR: usize = 2;
/// Iterations in which a line settles.
const ITERATIONS: usize = 12;

/// Lines with other ends, with fewer numbers, and with more in segments that are off.
fn edits(line: &Line, is_off: &[bool]) -> Vec<Changed> {
    let count = line.knots.len();
    let at = |knots: Vec<Knot>, i: usize| Changed {
        near: Some(i.min(knots.len() - 1)),
        line: Line {
            knots,
            ..line.clone()
        },
    };
    let mut edits = Vec::new();
    // 1. Square ends and mitred corners are those of straight lines of one width.
    if line.is_even && (line.cap == Cap::Butt || line.is_within(FLAT)) {
        edits.push(Changed {
            line: with_other_ends(line),
            near: None,
        });
    }
    for i in 0..count {
        // 2. Those of a ring, as far as they leave the ends of an open line where they are.
        let mut own = Vec::new();
        if is_off.get(i) == Some(&true) {
            own = edits::longer(&line.knots, i);
            // The width may bend where the middle does not.
            if !line.is_even {
                own.extend(edits::halved(&line.knots, i));
            }
        }
        if i < line.segments() {
            own.extend(edits::shorter(&line.knots, i));
        }
        own.retain(|edit| line.has_ends_of(&edit.knots));
        edits.extend(own.into_iter().map(|edit| at(edit.knots, i)));
        // 3. Without an end, or a segment, whose neighbours go on until they meet.
        if !line.is_closed && (i == 0 || i + 1 == count) && count > 2 {
            let mut knots = line.knots.clone();
            knots.remove(i);
            knots[0].is_smooth = false;
            // Behind the last vertex is nothing.
            let last = &mut knots[count - 2];
            (last.segment, last.is_smooth) = (Segment::Line, false);
            edits.push(at(knots, i));
        }
        edits.extend(without_segment(&line.knots, i, line.is_closed).map(|knots| at(knots, i)));
    }
    // 4. One width.
    if !line.is_even {
        let radii = line.knots.iter().map(|knot| knot.radius);
        let mean = radii.sum::<f64>() / count as f64;
        edits.push(Changed {
            line: Line::even(&line.knots, line.is_closed, mean, line.cap),
            near: None,
        });
    }
    // Mitred corners are those of straight lines.
    edits.retain(|Changed { line, .. }| line.cap == Cap::Round || line.is_within(0.0));
    edits
}

/// The vertices with one in the place of the segment behind vertex `i`: where its neighbours meet, which are straight.
fn without_segment(knots: &[Knot], i: usize, is_closed: bool) -> Option<Vec<Knot>> {
    let count = knots.len();
    if count < 4 || (!is_closed && (i == 0 || i + 2 >= count)) {
        return None;
    }
    let [before, next, after] = [i + count - 1, i + 1, i + 2].map(|k| k % count);
    let is_line = |k: usize| match knots[k].segment {
        Segment::Line | Segment::Along(_) => true,
        Segment::Arc(bulge) => bulge.abs() < FLAT,
        Segment::Cubic(_) => false,
    };
    let [p, q] = [knots[before].at, knots[next].at];
    let [u, v] = [knots[i].at - p, knots[after].at - q];
    let cross = u.cross(v);
    let along = (q - p).cross(v) / cross;
    let is_near = (along - 1.0).abs() * u.hypot() < 4.0 * (knots[next].at - knots[i].at).hypot();
    if !is_line(before) || !is_line(next) || cross.abs() < 1e-9 || !is_near {
        return None;
    }
    let mut knots = knots.to_vec();
    knots[next].at = p + along * u;
    for k in [before, next] {
        if let Segment::Arc(_) = knots[k].segment {
            knots[k].segment = Segment::Line;
        }
    }
    knots[next].is_smooth = false;
    knots.remove(i);
    Some(knots)
}

/// The line with the other kind of ends, which covers as much.
fn with_other_ends(line: &Line) -> Line {
    // A half disc covers ½πr², as much as a rectangle 2r wide and ¼πr long.
    let beyond = FRAC_PI_4 * line.radius();
    let (cap, beyond) = match line.cap {
        Cap::Round => (Cap::Butt, beyond),
        Cap::Butt => (Cap::Round, -beyond),
    };
    let mut knots = line.knots.clone();
    if cap == Cap::Butt {
        knots
            .iter_mut()
            .for_each(|knot| knot.segment = Segment::Line);
    }
    if !line.is_closed {
        let last = knots.len() - 1;
        for (end, inner) in [(0, 1), (last, last - 1)] {
            let way = line.knots[end].at - line.knots[inner].at;
            knots[end].at += beyond / way.hypot().max(1e-9) * way;
        }
    }
    Line {
        cap,
        knots,
        ..line.clone()
    }
}

/// The lines along one middle: the cheapest description, and shapes near it.
fn described(middle: &Middle, profiles: &[Profile]) -> Vec<Line> {
    if middle.is_varying() {
        return swelling(middle, profiles).into_iter().collect();
    }
    let (samples, radius) = samples(middle, profiles);
    let shapes = match middle.is_closed {
        true => shapes::near(&samples, true),
        false => Vec::new(),
    };
    let shapes = shapes.iter().map(Ring::segmented);
    let own: Vec<Vec<Knot>> = match samples.len() {
        0..5 => {
            let ends = middle.places.first().zip(middle.places.last());
            ends.map(|(a, b)| [*a, *b].map(corner).to_vec())
                .into_iter()
                .collect()
        }
        // How much renderers are off depends on the curve; pixels judge.
        _ => DOUBTS
            .iter()
            .filter_map(|doubt| {
                let samples = samples.iter().map(|sample| Sample {
                    sigma: doubt * sample.sigma,
                    ..*sample
                });
                describe::line(&samples.collect::<Vec<_>>(), middle.is_closed)
            })
            .collect(),
    };
    let line = |knots: Vec<Knot>| Line::even(&knots, middle.is_closed, radius, Cap::Round);
    own.into_iter()
        .chain(shapes)
        .filter(|knots| knots.len() > 1)
        .map(line)
        .collect()
}

/// The line of varying width along one middle.
fn swelling(middle: &Middle, profiles: &[Profile]) -> Option<Line> {
    let is_crossed = |p: Point| {
        let mut crossings = middle.crossings.iter();
        crossings.any(|(at, radius)| (*at - p).hypot() < *radius)
    };
    let known = profiles.iter().filter(|profile| !is_crossed(profile.at));
    let samples: Vec<Sample> = known.filter_map(Profile::whole).collect();
    // Ends that are crossed, or too thin for profiles, are somewhere there.
    let end = |at: Option<&Point>| {
        let far = |p: &&Point| {
            let ends = [samples.first(), samples.last()].into_iter().flatten();
            ends.map(|s| (s.at - **p).hypot())
                .fold(f64::INFINITY, f64::min)
                > 1.5
        };
        at.filter(far).map(|&at| Sample {
            at,
            sigma: LOOSE,
            gap: None,
            half: None,
        })
    };
    let [first, last] = match middle.is_closed {
        true => [None; 2],
        false => [end(middle.places.first()), end(middle.places.last())],
    };
    let samples: Vec<Sample> = first
        .into_iter()
        .chain(samples.iter().copied())
        .chain(last)
        .collect();
    let knots = match samples.len() {
        0..5 => {
            let radii = [middle.radii.first(), middle.radii.last()];
            let ends = [middle.places.first(), middle.places.last()];
            let knots = ends.into_iter().zip(radii).filter_map(|(at, radius)| {
                Some(Knot {
                    radius: *radius?,
                    ..corner(*at?)
                })
            });
            knots.collect()
        }
        _ => describe::line(&samples, middle.is_closed)?,
    };
    let line = Line {
        knots,
        is_closed: middle.is_closed,
        is_even: false,
        cap: Cap::Round,
    };
    // Radii are positive.
    Some(line.widened(0.0)).filter(|line| line.knots.len() > 1)
}

/// Standard deviation of the end of a middle that no profile tells, px. A guess.
const LOOSE: f64 = 1.0;

/// Profiles across a middle, a px apart.
fn profiles(field: &Field, shares: &Shares<'_>, middle: &Middle) -> Vec<Profile> {
    let mut profiles: Vec<Profile> = Vec::new();
    let mut left = 0.5;
    for (i, ends) in middle.places.windows(2).enumerate() {
        let way = ends[1] - ends[0];
        let length = way.hypot();
        while left < length {
            profiles.push(Profile::across(
                field,
                shares,
                (ends[0] + left / length * way, way / length),
                middle.radii.get(i).copied().unwrap_or(middle.radius),
            ));
            left += 1.0;
        }
        left -= length;
    }
    profiles
}

/// The width of a line that these profiles tell.
fn width_of(middle: &Middle, profiles: &[Profile]) -> f64 {
    let width = median(profiles.iter().filter_map(|p| Some(p.width()? as f32))).map(f64::from);
    width.unwrap_or(2.0 * middle.radius)
}

/// A length that any description by lines of one width has beyond its numbers: what profiles across middle `i` of some are wider or
/// narrower than their median is wrong.
fn beyond(middles: &[Middle], i: usize, profiles: &[Profile]) -> f64 {
    let middle = &middles[i];
    let width = width_of(middle, profiles);
    // At corners, and where lines cross, what is seen is wider than any of them.
    let corners = corners(middle);
    let is_crossed = |p: Point| {
        let near = 2.0 * middle.radius + 2.0;
        let mut others = middles.iter().enumerate().filter(|(k, _)| *k != i);
        corners.iter().any(|corner| (*corner - p).hypot() < near)
            || others.any(|(_, other)| distance2(&other.places, p).sqrt() < near + other.radius)
    };
    let off = profiles.iter().map(|profile| match profile.width() {
        Some(own) => (own - width).abs(),
        None => (profile.least - width).max(0.0),
    });
    // An edge may be a pixel off for nothing.
    let off = off.map(|off| (off - 1.0).max(0.0)).zip(profiles);
    let off = off.filter(|(off, profile)| *off > 0.0 && !is_crossed(profile.at));
    0.5 * describe::CAP * off.map(|(off, _)| off).sum::<f64>()
}

/// Samples along a middle by profiles across it, and half the width that they tell.
fn samples(middle: &Middle, profiles: &[Profile]) -> (Vec<Sample>, f64) {
    // At a corner profiles tell the middle of both of its sides.
    let corners = corners(middle);
    let is_cut = |p: Point| {
        corners
            .iter()
            .position(|corner| (*corner - p).hypot() < 1.2 * middle.radius)
    };
    let width = width_of(middle, profiles);
    let found = profiles.iter().filter_map(|profile| profile.sample(width));
    let mut samples: Vec<Sample> = Vec::new();
    let mut last = None;
    let mut gaps = 0;
    for sample in found {
        let cut = is_cut(sample.at);
        match cut {
            None => samples.push(sample),
            Some(corner) if last != cut => {
                samples.push(Sample {
                    at: corners[corner],
                    sigma: f64::INFINITY,
                    gap: Some(gaps),
                    half: None,
                });
                gaps += 1;
            }
            Some(_) => {}
        }
        last = cut;
    }
    (samples, 0.5 * width)
}

/// The corners of a middle: it turns there by more than a radian within its width.
fn corners(middle: &Middle) -> Vec<Point> {
    let places = &middle.places;
    // Places at even steps, and the directions between those half a width apart.
    let mut even: Vec<Point> = Vec::new();
    let step = (0.1 * middle.radius).max(0.1);
    let mut left = 0.0;
    for ends in places.windows(2) {
        let way = ends[1] - ends[0];
        let length = way.hypot();
        while left < length {
            even.push(ends[0] + left / length.max(1e-9) * way);
            left += step;
        }
        left -= length;
    }
    let reach = (0.6 * middle.radius / step).round().max(1.0) as usize;
    let turn = |i: usize| {
        let far = |k: isize| {
            let at = i as isize + k;
            match middle.is_closed {
                true => Some(at.rem_euclid(even.len() as isize) as usize),
                false => usize::try_from(at).ok().filter(|at| *at < even.len()),
            }
        };
        let reach = reach as isize;
        let (Some(a), Some(b)) = (far(-2 * reach), far(2 * reach)) else {
            return 0.0;
        };
        let [u, v] = [even[i] - even[a], even[b] - even[i]];
        2.0 * math::atan(u.cross(v) / (u.hypot() * v.hypot() + u.dot(v)).max(1e-9))
    };
    let turns: Vec<f64> = (0..even.len()).map(|i| turn(i).abs()).collect();
    let is_most = |i: &usize| {
        let around = i.saturating_sub(2 * reach)..(i + 2 * reach + 1).min(turns.len());
        turns[*i] > SHARP
            && around
                .clone()
                .all(|k| turns[k] < turns[*i] || (turns[k] == turns[*i] && k >= *i))
    };
    (0..even.len()).filter(is_most).map(|i| even[i]).collect()
}

/// Least angle of a corner, rad.
const SHARP: f64 = 0.8;

/// What a line covers across a direction.
struct Profile {
    at: Point,
    normal: Vec2,
    /// How far it goes from there against the normal and along it, px; `None` if that is not known.
    sides: [Option<f64>; 2],
    /// What it covers at least, px.
    least: f64,
    /// About half the width there, px.
    radius: f64,
    doubt: f64,
}

impl Profile {
    fn across(field: &Field, shares: &Shares<'_>, (at, way): (Point, Vec2), radius: f64) -> Self {
        const STEP: f64 = 0.25;
        let normal = Vec2::new(-way.y, way.x);
        let place = |k: i32| at + f64::from(k) * STEP * normal;
        let pixel = |p: Point| [p.x.floor() as i32, p.y.floor() as i32];
        let doubt = shares.doubt(pixel(at));
        let flat = (2.0 * doubt).clamp(0.01, 0.1);
        let reach = ((2.0 * radius + 3.0) / STEP).ceil() as i32;
        let share = |k: i32| f64::from(field.at(math::xy(place(k))));
        let side = |step: i32| {
            let end = (1..=reach).find(|&k| share(k * step) < flat);
            let within = || 0..=end.unwrap_or(reach);
            let is_known = |k: &i32| shares.is_known(pixel(place(k * step)));
            let half = |k: i32| if k == 0 { 0.5 } else { 1.0 };
            let known = within().filter(is_known);
            let covered = STEP * known.map(|k| half(k) * share(k * step)).sum::<f64>();
            let is_whole = end.is_some() && within().all(|k| is_known(&k));
            (covered, is_whole.then_some(covered))
        };
        let sides = [side(-1), side(1)];
        Self {
            at,
            normal,
            sides: sides.map(|(_, whole)| whole),
            least: sides[0].0 + sides[1].0,
            radius,
            doubt,
        }
    }

    fn width(&self) -> Option<f64> {
        let width = self.sides[0]? + self.sides[1]?;
        Some(width).filter(|width| *width >= 0.2)
    }

    /// The middle of a line that is so wide. Where one of its edges lies beyond the page, the other one tells.
    fn sample(&self, width: f64) -> Option<Sample> {
        let is_odd = |own: f64| (own - width).abs() > ODD[0] + ODD[1] * width;
        let (along, edges) = match self.sides {
            [Some(before), Some(behind)] if !is_odd(before + behind) => {
                (0.5 * (behind - before), 2.0)
            }
            [Some(before), None] => (0.5 * width - before, 1.0),
            [None, Some(behind)] => (behind - 0.5 * width, 1.0),
            _ => return None,
        };
        let sigma = math::hypot(CLEAN, self.doubt / (0.5 * edges * width).max(1.0).sqrt());
        Some(Sample {
            at: self.at + along * self.normal,
            sigma,
            gap: None,
            half: None,
        })
    }

    /// The middle of a line of any width, and half of that; `None` unless that is about as the skeleton tells.
    fn whole(&self) -> Option<Sample> {
        let [before, behind] = [self.sides[0]?, self.sides[1]?];
        let half = 0.5 * (before + behind);
        let is_odd = (half - self.radius).abs() > ODD_HALF[0] + ODD_HALF[1] * self.radius;
        let sigma = math::hypot(CLEAN, self.doubt / (2.0 * half).max(1.0).sqrt());
        (!is_odd && half > 0.05).then(|| Sample {
            at: self.at + 0.5 * (behind - before) * self.normal,
            sigma,
            gap: None,
            half: Some(half),
        })
    }
}

/// As [`ODD`], of half the width beside the radius of the skeleton there, whose pixels are half a px wide. A guess.
const ODD_HALF: [f64; 2] = [0.7, 0.3];

#[cfg(test)]
mod tests {
    use super::super::coverage::{Band, Page};
    use super::super::describe::tests::knot;
    use super::*;

    /// The lines that are found along a middle on a page of 64 px that shows this line.
    fn found(truth: &Line, middle: &[[f64; 2]]) -> Vec<Line> {
        found_along(truth, truth, middle)
    }

    /// As [`found`], of a middle that is closed as another line is.
    fn found_along(truth: &Line, traced: &Line, middle: &[[f64; 2]]) -> Vec<Line> {
        let page = Page {
            origin: [0; 2],
            width: 64,
            height: 64,
        };
        let ring = Ring::Line(truth.clone());
        let band = Band::around(&ring, page);
        let mut values = vec![0.0; 64 * 64];
        for (at, share) in band.places().zip(Coverage::of(&ring, &band).shares()) {
            values[page.index(at)] = share;
        }
        let field = Field {
            origin: page.origin,
            width: page.width,
            values: values.iter().map(|v| *v as f32).collect(),
        };
        let shares = Shares {
            page,
            values,
            doubts: &[0.05; 64 * 64],
            factor: 1.0,
            slack: 0.0,
        };
        let middle = Middle {
            places: middle.iter().map(|[x, y]| Point::new(*x, *y)).collect(),
            is_closed: traced.is_closed,
            radius: 3.0,
            radii: Vec::new(),
            crossings: Vec::new(),
        };
        lines(&field, &shares, &[middle], f64::INFINITY).unwrap().0
    }

    /// A line that is straight between these places.
    fn straight(places: &[[f64; 2]], cap: Cap, radius: f64) -> Line {
        let knots = places.iter().map(|[x, y]| corner(Point::new(*x, *y)));
        Line::even(&knots.collect::<Vec<_>>(), false, radius, cap)
    }

    fn assert_found(truth: &Line, middle: &[[f64; 2]]) {
        let found = found(truth, middle);
        let [line] = &found[..] else {
            panic!("{found:?}")
        };
        assert_eq!(line.knots.len(), truth.knots.len(), "{line:?}");
        assert!((line.radius() - truth.radius()).abs() < 0.02, "{line:?}");
        for (found, expected) in line.knots.iter().zip(&truth.knots) {
            assert!((found.at - expected.at).hypot() < 0.05, "{line:?}");
        }
    }

    #[test]
    fn a_hook_is_two_lines_and_an_arc_between_them() {
        let knots = [
            knot(12.3, 50.2, Segment::Along(1), false),
            knot(12.3, 28.4, Segment::Arc(1.0), true),
            knot(44.9, 28.4, Segment::Along(1), true),
            knot(44.9, 46.1, Segment::Line, false),
        ];
        let hook = Line::even(&knots, false, 3.2, Cap::Round);
        let middle = [
            [12.0, 49.0],
            [12.5, 28.0],
            [17.0, 16.5],
            [28.5, 12.5],
            [40.5, 17.0],
            [45.0, 28.5],
            [44.5, 45.5],
        ];
        assert_found(&hook, &middle);
    }

    #[test]
    fn a_line_that_the_page_cuts_lengthwise_is_as_wide_as_its_rest() {
        let line = straight(&[[20.2, 12.7], [61.8, 20.3], [61.8, 55.4]], Cap::Round, 4.1);
        let found = found(&line, &[[21.0, 13.0], [61.0, 20.0], [60.5, 55.0]]);
        let [line] = &found[..] else {
            panic!("{found:?}")
        };
        assert_eq!(line.knots.len(), 3, "{line:?}");
        let [a, b] = [&line.knots[1], &line.knots[2]];
        assert!(
            (a.at.x - 61.8).abs() < 0.1 && (b.at.x - 61.8).abs() < 0.1,
            "{line:?}"
        );
    }

    #[test]
    fn a_triangle_that_was_traced_as_an_open_line_is_closed() {
        let open = straight(&[[12.2, 14.5], [50.1, 20.3], [26.4, 52.6]], Cap::Round, 2.8);
        let triangle = Line {
            is_closed: true,
            ..open.clone()
        };
        let found = found_along(
            &triangle,
            &open,
            &[[12.5, 15.0], [50.0, 20.0], [26.5, 52.5], [12.5, 15.5]],
        );
        let [line] = &found[..] else {
            panic!("{found:?}")
        };
        assert!(line.is_closed && line.knots.len() == 3, "{line:?}");
    }

    #[test]
    fn square_ends_and_a_mitred_corner_are_told_from_round_ones() {
        let chevron = straight(&[[10.3, 12.4], [30.2, 48.1], [52.7, 15.2]], Cap::Butt, 3.5);
        assert_found(&chevron, &[[11.5, 14.5], [30.0, 47.0], [51.0, 17.0]]);
        let found = found(&chevron, &[[11.5, 14.5], [30.0, 47.0], [51.0, 17.0]]);
        assert_eq!(found[0].cap, Cap::Butt);
    }
}
