//! Edges: outlines of few numbers that cover what a picture shows, by exact coverage.
//!
//! ```text
//! samples    places along a contour, by sums of shares
//! describe   the cheapest ring along them, by description length
//! shapes     circles, ellipses and rectangles near them
//! segment    lines, arcs and cubics between vertices, as functions of few numbers
//! curve      rings of these, shapes, and lines of one width
//! line       lines of one width
//! lines      those along middles that were traced
//! coverage   the share of each pixel that they cover, and its derivatives
//! refine     the numbers by Levenberg–Marquardt on the pixels that edges touch
//! edits      more numbers or fewer, judged by those pixels
//! ```
//!
//! What decides is *description length*: half of χ² of the pixels, and [`describe::PRICE`] for each number.

mod coverage;
mod curve;
mod describe;
mod edits;
mod line;
mod lines;
mod refine;
mod samples;
mod segment;
mod shapes;

pub(in crate::trace) use curve::Ring;
pub(in crate::trace) use describe::PRICE;
pub(in crate::trace) use line::Line;
pub(in crate::trace) use lines::Middle;

use super::contour::{self, Field, Place};
use crate::math::{self, Point};
use coverage::{Band, Coverage, Page};
use describe::Contour;
use refine::Target;

/// The rings around what a field covers. `doubts` are the standard deviations of its shares, infinite where they are unknown, and
/// `hidden` is the share of a place where an outline would not be seen. And the deviation of the shares from what is described, in the middle of
/// edges; `None` if it is `most` or more.
pub(super) fn rings(
    field: &Field,
    doubts: &[f64],
    hidden: impl Fn(Point) -> f32,
    most: f64,
) -> Option<(Vec<Ring>, f64)> {
    let doubt = doubt_of_edges(field, doubts);
    if doubt >= most {
        return None;
    }
    let is_hidden = |p: Point| hidden(p) > COVERED;
    let page = field.page();
    let mut shares = Shares {
        page,
        values: field.values.iter().map(|v| f64::from(*v)).collect(),
        doubts,
        factor: 1.0,
        slack: BIASES[0],
    };
    // 1. The shape and the cheapest description of each contour.
    let contours = field.contours();
    let large = |contour: &&Vec<Place>| contour::twice_area(contour).abs() > LEAST_AREA;
    let contours: Vec<&Vec<Place>> = contours.iter().filter(large).collect();
    let described = contours.iter().map(|places| {
        let (samples, gaps) = samples::samples(field, places, |at| shares.doubt(at), &hidden);
        let others = contours
            .iter()
            .filter(|other| !std::ptr::eq(**other, *places));
        let is_alone = others
            .clone()
            .all(|other| !contour::is_within(other, places) && !contour::is_within(places, other));
        let shapes = shapes::near(&samples, is_alone);
        let refined = shapes.iter().map(|shape| shares.refined(shape, &[]));
        let shape = refined.min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((shape, length)) = &shape
            && *length < LEAST_LENGTH
        {
            return (shape.clone(), None);
        }
        let contour = Contour {
            samples,
            gaps,
            is_hidden: &is_hidden,
        };
        let ring = describe::ring(&contour);
        // What is hidden may have led it astray, so that it misses what is seen.
        let ring = match contour.gaps.is_empty() {
            true => ring,
            false => {
                let rivals = ring.into_iter().chain(describe::polygon_of(places));
                let rivals = rivals.map(|ring| shares.refined(&ring, &[]).0);
                let lengths = rivals.map(|ring| (shares.length(&ring), ring));
                let best = lengths.min_by(|a, b| a.0.total_cmp(&b.0));
                best.map(|(_, ring)| ring)
            }
        };
        let shape = shape.map(|(shape, _)| shape);
        match (ring, shape) {
            (Some(ring), shape) => (ring, shape),
            (None, Some(shape)) => (shape, None),
            // A few pixels.
            (None, None) => (shapes::around(places), None),
        }
    });
    let mut described: Vec<(Ring, Option<Ring>)> = described.collect();
    // 2. Each ring on what the others leave.
    let is_single = described.len() == 1;
    if !is_single {
        described
            .iter()
            .for_each(|(ring, _)| shares.add(ring, -1.0));
    }
    let mut misfits: Vec<f64> = Vec::new();
    for (ring, shape) in &mut described {
        shares.alone(ring, is_single, |shares, ring| {
            *ring = shares.refined(ring, &[]).0;
            shares.choose(ring, shape);
            misfits.extend(shares.misfits(ring));
        });
    }
    // 3. What edges are off by beyond what pixels tell is the error of the model: mixtures of three colours, blurs, blocks.
    shares.factor = factor(misfits);
    let deviation = shares.factor * doubt;
    if deviation >= most {
        return None;
    }
    // 4. More numbers or fewer, and the shape once more.
    for (ring, shape) in &mut described {
        shares.alone(ring, is_single, |shares, ring| {
            edits::improve(ring, &|band| shares.target(band), page);
            shares.choose(ring, shape);
        });
    }
    // 5. Of several, those that pay, as near as all that pixels tell.
    shares.slack = 0.0;
    let mut rings = Vec::new();
    for (ring, _) in described {
        if !is_single {
            shares.add(&ring, 1.0);
        }
        if is_single || shares.pay_for(&ring) {
            let ring = shares.refined(&ring, &[]).0;
            if !is_single {
                shares.add(&ring, -1.0);
            }
            rings.push(ring);
        }
    }
    Some((rings, deviation))
}

/// Deviations of the edges in units of what the pixels tell, by the errors of pixels in these units; 1 at least.
fn factor(mut misfits: Vec<f64>) -> f64 {
    // Of a normal distribution, a quarter is farther away than 1.15 deviations.
    let at = misfits.len() * 3 / 4;
    let misfit = match misfits.len() {
        0 => 0.0,
        _ => *misfits.select_nth_unstable_by(at, f64::total_cmp).1 / 1.15,
    };
    misfit.max(1.0)
}

/// How far the share of a pixel is off for nothing, where outlines are filled and where lines are drawn: renderers take few samples of a
/// pixel, whose errors are alike all along an edge, so that they do not average out. resvg is off by 0.047 in the mean of squares around
/// a ring that is filled, and by 0.05 to 0.09 around the same ring that is drawn as a line. Of 41 drawings and of 39 icons of lines at
/// 128 px, 0, 0.05 and 0.08 need 0.73, 0.69 and 0.68, and 3.7, 2.1 and 2.0 times the artist's numbers.
const BIASES: [f64; 2] = [0.05, 0.08];

/// The numbers of a ring, and of a line, that do not count where they compete: where it is, and the width of a line, which many share.
const FREE: [f64; 2] = [2.0, 3.0];

/// Share of a place that what lies on top covers from which on an edge is hidden there. A guess.
const COVERED: f32 = 0.9;

/// Twice the area of the smallest contour, px²: that of one pixel, of which marching squares cut the corners.
const LEAST_AREA: f32 = 0.8;

/// A ring of segments has at least so many numbers, so no such ring has a shorter description than this, nats.
const LEAST_LENGTH: f64 = 5.0 * PRICE;

/// Lines along middles that cover what a field does.
pub(super) struct Lines {
    pub(super) lines: Vec<Line>,
    /// The lengths of the descriptions by them and by rings.
    pub(super) lengths: [f64; 2],
    /// Deviation of the shares from what they cover, in the middle of edges.
    pub(super) deviation: f64,
}

/// Lines along middles that cover what a field does, beside some rings.
pub(super) fn lines(
    field: &Field,
    doubts: &[f64],
    middles: &[Middle],
    rings: &[Ring],
) -> Option<Lines> {
    let mut shares = Shares {
        page: field.page(),
        values: field.values.iter().map(|v| f64::from(*v)).collect(),
        doubts,
        factor: 1.0,
        slack: BIASES[1],
    };
    // What the rings, which have more numbers, are off by is the error of the model.
    rings.iter().for_each(|ring| shares.add(ring, -1.0));
    let mut misfits = Vec::new();
    for ring in rings {
        shares.alone(&mut ring.clone(), false, |shares, ring| {
            misfits.extend(shares.misfits(ring));
        });
    }
    rings.iter().for_each(|ring| shares.add(ring, 1.0));
    shares.factor = factor(misfits);
    let by_rings = shares.length_of(rings);
    let (lines, by_lines) = lines::lines(field, &shares, middles, by_rings)?;
    let lengths = [by_lines, by_rings];
    shares.slack = 0.0;
    let lines = lines::settle(&shares, lines);
    shares.slack = BIASES[1];
    shares.factor = 1.0;
    let deviation = factor(shares.misfits_of_lines(&lines)) * doubt_of_edges(field, doubts);
    Some(Lines {
        lines,
        lengths,
        deviation,
    })
}

impl Field {
    fn page(&self) -> Page {
        Page {
            origin: self.origin,
            width: self.width,
            height: self.values.len() / self.width,
        }
    }
}

/// What rings are to cover.
struct Shares<'a> {
    page: Page,
    values: Vec<f64>,
    doubts: &'a [f64],
    /// Deviations in units of these.
    factor: f64,
    /// How far shares may be off for nothing.
    slack: f64,
}

impl Shares<'_> {
    /// What is to be covered of a part of the page.
    fn target(&self, band: Band) -> Target {
        let indices: Vec<usize> = band.places().map(|at| self.page.index(at)).collect();
        Target {
            shares: indices.iter().map(|&i| self.values[i]).collect(),
            weights: indices
                .iter()
                .map(|&i| 1.0 / (self.factor * self.doubts[i]))
                .collect(),
            slacks: vec![self.slack; indices.len()],
            band,
        }
    }

    /// Adds what a ring covers, times a sign.
    fn add(&mut self, ring: &Ring, sign: f64) {
        let mut values = std::mem::take(&mut self.values);
        self.covered(ring, |i, share| values[i] += sign * share);
        self.values = values;
    }

    /// Gives what a ring covers back to it, and takes it away again after `work`, unless it `is_single` and has kept it.
    fn alone(&mut self, ring: &mut Ring, is_single: bool, work: impl FnOnce(&Self, &mut Ring)) {
        if !is_single {
            self.add(ring, 1.0);
        }
        work(self, ring);
        if !is_single {
            self.add(ring, -1.0);
        }
    }

    /// The ring after Levenberg–Marquardt, and the length of its description on the pixels near it and near others.
    fn refined(&self, ring: &Ring, others: &[&Ring]) -> (Ring, f64) {
        const ITERATIONS: usize = 12;
        let target = self.target(whole(ring, others, self.page));
        let (ring, chi2) =
            refine::refined(ring, &refine::all(ring), &target, ITERATIONS, f64::INFINITY);
        let length = 0.5 * chi2 + PRICE * ring.freedom();
        (ring, length)
    }

    /// The length of a rough description of the whole page by one ring: a pixel counts if it is on the wrong side.
    fn length(&self, ring: &Ring) -> f64 {
        let mut rest = self.values.clone();
        self.covered(ring, |i, share| rest[i] -= share);
        let is_wrong = |(rest, doubt): &(&f64, &f64)| rest.abs() > 0.5 && doubt.is_finite();
        let wrong = rest.iter().zip(self.doubts).filter(is_wrong).count();
        0.5 * describe::CAP * wrong as f64 + PRICE * ring.freedom()
    }

    /// The length of the description of the whole page by rings, holes among them, which cover what one of them does.
    fn length_of(&self, rings: &[Ring]) -> f64 {
        let mut covered = vec![0.0; self.values.len()];
        let mut freedom = 0.0;
        for ring in rings {
            freedom += ring.freedom() - FREE[0];
            self.covered(ring, |i, share| covered[i] += share);
        }
        let covered = covered.iter().map(|&share: &f64| [share.min(1.0); 2]);
        self.half_chi2(covered) + PRICE * freedom
    }

    /// The least and the largest share of each pixel that lines cover: edges of lines that meet in a pixel may cover the same part of it
    /// or others, and no two renderers agree there.
    fn covered_by(&self, lines: &[Line]) -> Vec<[f64; 2]> {
        let mut covered = vec![[0.0; 2]; self.values.len()];
        for line in lines {
            self.covered(&Ring::Line(line.clone()), |i, share| {
                let [least, most] = covered[i];
                covered[i] = [share.max(least), (share + most).min(1.0)];
            });
        }
        covered
    }

    /// Half of χ² of the whole page, if each pixel is covered by a share between these two.
    fn half_chi2(&self, covered: impl Iterator<Item = [f64; 2]>) -> f64 {
        let pixels = covered.enumerate();
        pixels
            .map(|(i, covered)| self.half_square(i, covered))
            .sum()
    }

    /// Half the squared error of a pixel of which so much is covered.
    fn half_square(&self, i: usize, covered: [f64; 2]) -> f64 {
        let away = self.outside(self.values[i], covered, self.doubts[i]);
        0.5 * (away * away).min(describe::CAP)
    }

    /// The errors of the pixels that edges of lines touch, or should, in units of their deviations.
    fn misfits_of_lines(&self, lines: &[Line]) -> Vec<f64> {
        let covered = self.covered_by(lines).into_iter();
        let pixels = covered.zip(&self.values).zip(self.doubts);
        let is_edge = |share: f64| share > 0.0 && share < 1.0;
        let edges = pixels.filter(|(([least, most], value), doubt)| {
            doubt.is_finite() && (is_edge(*least) || is_edge(*most) || is_edge(**value))
        });
        edges
            .map(|((covered, value), doubt)| self.outside(*value, covered, *doubt))
            .collect()
    }

    /// How far a value is outside of a range, in units of its deviation.
    fn outside(&self, value: f64, [least, most]: [f64; 2], doubt: f64) -> f64 {
        let away = (least - value).max(value - most) - self.slack;
        away.max(0.0) / (self.factor * doubt)
    }

    /// The standard deviation of the share of a pixel.
    fn doubt(&self, at: [i32; 2]) -> f64 {
        Some(self.doubts[self.page.index(at)])
            .filter(|doubt| doubt.is_finite())
            .unwrap_or(0.05)
    }

    /// True if something is known about the share of a pixel.
    fn is_known(&self, at: [i32; 2]) -> bool {
        self.doubts[self.page.index(at)].is_finite()
    }

    /// The shares of all pixels that a ring covers, by their indices.
    fn covered(&self, ring: &Ring, mut each: impl FnMut(usize, f64)) {
        let band = Band::around(ring, self.page);
        let shares = Coverage::of(ring, &band).shares();
        for (at, share) in band.places().zip(shares) {
            each(self.page.index(at), share);
        }
    }

    /// Takes the shape in the place of a ring, and forgets it, if it has the shorter description on the pixels near both.
    fn choose(&self, ring: &mut Ring, shape: &mut Option<Ring>) {
        let Some(rival) = shape else { return };
        let (refined, length) = self.refined(rival, &[ring]);
        let target = self.target(whole(ring, &[rival], self.page));
        let own = 0.5 * refine::chi2(ring, &[], &target) + PRICE * ring.freedom();
        if length <= own {
            *ring = refined;
            *shape = None;
        }
    }

    /// True if what a ring covers is worth its numbers.
    fn pay_for(&self, ring: &Ring) -> bool {
        let mut gain = 0.0;
        self.covered(ring, |i, share| {
            let sigma = self.factor * self.doubts[i];
            let square = |share: f64| (share / sigma) * (share / sigma);
            gain += square(self.values[i]) - square(self.values[i] - share);
        });
        0.5 * gain > PRICE * ring.freedom()
    }

    /// The errors of the pixels that the edges of a ring touch, in units of their deviations.
    fn misfits(&self, ring: &Ring) -> Vec<f64> {
        let target = self.target(whole(ring, &[], self.page));
        let coverage = Coverage::of(ring, &target.band);
        let covered = coverage.shares();
        let touched = coverage.touched().into_iter();
        let known = touched.filter(|&pixel| target.weights[pixel] > 0.0);
        let misfits = known.map(|pixel| target.error(pixel, covered[pixel]).abs());
        misfits.collect()
    }
}

/// The median of the deviations of the pixels of edges.
fn doubt_of_edges(field: &Field, doubts: &[f64]) -> f64 {
    let pixels = field.values.iter().zip(doubts);
    let edges = pixels
        .filter(|(share, doubt)| **share > 0.0 && **share < 1.0 && doubt.is_finite())
        .map(|(_, doubt)| *doubt as f32);
    math::median(edges).map_or(0.0, f64::from)
}

/// The band of all segments of a ring, and near others.
fn whole(ring: &Ring, others: &[&Ring], page: Page) -> Band {
    Band::of(ring, &refine::all(ring), others, page)
}

#[cfg(test)]
mod tests {
    use super::coverage::{Band, Coverage, Page};
    use super::curve::Ring;
    use super::describe::tests::knot;
    use super::refine::{Target, all, refined};
    use super::segment::Segment;
    use crate::rng;

    #[test]
    fn a_shape_is_found_again_from_a_tenth_of_its_pixels_away() {
        // A tab: three sides and a half circle that two of them touch.
        let ring = Ring::Knots(vec![
            knot(6.2, 25.1, Segment::Line, false),
            knot(6.2, 12.4, Segment::Arc(1.0), true),
            knot(24.6, 12.4, Segment::Line, true),
            knot(24.6, 25.1, Segment::Line, false),
        ]);
        let truth = ring;
        let page = Page {
            origin: [0; 2],
            width: 40,
            height: 40,
        };
        let band = Band::of(&truth, &all(&truth), &[], page);
        let shares = Coverage::of(&truth, &band).shares();
        let values = truth.values();
        let moved: Vec<f64> = values
            .iter()
            .zip(0..)
            .map(|(v, k)| v + 0.3 * (f64::from(rng::draw(0, 0, 0, k)) - 0.5))
            .collect();
        let target = Target {
            band: band.clone(),
            weights: vec![100.0; shares.len()],
            slacks: vec![0.0; shares.len()],
            shares,
        };
        let (found, cost) = refined(
            &truth.with(&moved),
            &all(&truth),
            &target,
            12,
            f64::INFINITY,
        );
        assert!(cost < 0.1, "{cost}");
        for (found, expected) in found.values().iter().zip(&values) {
            assert!((found - expected).abs() < 0.002, "{found} {expected}");
        }
    }
}
