//! Levenberg–Marquardt on the numbers of a ring, by exact coverage of the pixels that its edges touch.
//!
//! K. Levenberg, "A method for the solution of certain non-linear problems in least squares", 1944; D. Marquardt, "An algorithm for
//! least-squares estimation of nonlinear parameters", 1963.

use super::coverage::{Band, Coverage};
use super::curve::Ring;
use super::segment::Segment;
use crate::math::Normal;

/// What a ring is to cover.
#[derive(Debug, Clone)]
pub(super) struct Target {
    pub(super) band: Band,
    /// The share of each pixel of the band.
    pub(super) shares: Vec<f64>,
    /// 1 / the standard deviation of each share; 0 where nothing is known.
    pub(super) weights: Vec<f64>,
    /// How far the coverage of each pixel may be from its share for nothing, as other things may be there.
    pub(super) slacks: Vec<f64>,
}

impl Target {
    /// How far a share is from that of a pixel of the band, in units of its deviation.
    pub(super) fn error(&self, pixel: usize, share: f64) -> f64 {
        let away = share - self.shares[pixel];
        beyond(away, self.slacks[pixel]) * self.weights[pixel]
    }

    /// χ² of all pixels of the band, which are covered like this.
    fn chi2(&self, shares: &[f64]) -> f64 {
        // Eight sums go side by side.
        let mut sums = [0.0; 8];
        let parts = self.shares.chunks(8).zip(self.slacks.chunks(8));
        let parts = parts.zip(self.weights.chunks(8)).zip(shares.chunks(8));
        for (((own, slacks), weights), shares) in parts {
            let pixels = own.iter().zip(slacks).zip(weights).zip(shares);
            for (sum, (((own, slack), weight), share)) in sums.iter_mut().zip(pixels) {
                let error = beyond(share - own, *slack) * weight;
                *sum += error * error;
            }
        }
        sums.iter().sum()
    }

    /// Half of χ² of some pixels of the band that are covered like this.
    pub(super) fn half_chi2(&self, pixels: &[usize], shares: &[f64]) -> f64 {
        let errors = pixels.iter().map(|&pixel| self.error(pixel, shares[pixel]));
        0.5 * errors.map(|error| error * error).sum::<f64>()
    }
}

/// How far a difference is outside of a slack.
fn beyond(away: f64, slack: f64) -> f64 {
    (away - slack).max(0.0) + (away + slack).min(0.0)
}

/// Standard deviation of the angle of a smooth joint, rad.
const ANGLE: f64 = 0.005;
/// Farthest that a number moves in an iteration, px: farther away the linear model of coverage says nothing.
const FARTHEST: f64 = 0.7;
/// The descent ends when an iteration lessens the sum by a smaller share than this.
const ENOUGH: f64 = 1e-3;

/// A step that promises a smaller share than this is none. With [`ENOUGH`], which of two kinds of ends a line has is not found.
const NOTHING: f64 = 1e-4;
/// All iterations together gain at most this many times as much as the first one promises, by the linear model of coverage. Of 63 clip
/// arts, 1, 1.5 and 3 need 1.02, 1 and 1 times the points, and 0.8, 1 and 1.2 times the steps.
const PROMISE: f64 = 1.5;
/// All further iterations together gain at most this many times as much as the last one. A guess.
const HOPE: f64 = 3.0;

/// A ring some vertices of which may move.
struct Moving<'a> {
    target: &'a Target,
    /// The segments that move.
    segments: Vec<usize>,
    /// What the others cover.
    rest: Coverage<'a>,
    /// For each unknown of the ring its index among those that move.
    indices: Vec<Option<usize>>,
    count: usize,
    /// The smooth vertices, whose angles are to stay 0.
    joints: Vec<usize>,
}

impl<'a> Moving<'a> {
    /// Lets the vertices `free` move, and what belongs to the segments beside them.
    fn of(ring: &Ring, free: &[usize], target: &'a Target) -> Self {
        let count = ring.segments();
        let owns = ring.owns();
        let mut moves = vec![false; count];
        let mut indices = vec![None; ring.unknowns()];
        let mut joints = Vec::new();
        match ring {
            Ring::Shape { .. } => {
                moves[0] = true;
                indices.fill(Some(0));
            }
            Ring::Line(_) | Ring::Knots(_) => {
                let knots = ring.knots();
                let before = |i: usize| (i + knots.len() - 1) % knots.len();
                let mut beside = vec![false; knots.len()];
                for &i in free {
                    indices[2 * i..2 * i + 2].fill(Some(0));
                    (beside[i], beside[before(i)]) = (true, true);
                }
                // Behind the end of an open line is nothing.
                let segments = match ring {
                    Ring::Line(line) => line.segments(),
                    _ => count,
                };
                for i in (0..segments).filter(|&i| beside[i]) {
                    let own = owns[i]..owns[i] + knots[i].segment.unknowns();
                    indices[own].fill(Some(0));
                }
                match ring {
                    // An outline is one polyline, whichever of its vertices move.
                    Ring::Line(line) => {
                        moves[0] = true;
                        let first = line.radius_index();
                        match line.is_even {
                            true => indices[first] = Some(0),
                            false => free.iter().for_each(|&i| indices[first + i] = Some(0)),
                        }
                        joints.extend(ring.smooth());
                    }
                    _ => {
                        let is_near = |i: &usize| beside[*i] || beside[before(*i)];
                        joints.extend(ring.smooth().filter(is_near));
                        moves = beside;
                    }
                }
            }
        }
        // The ends of lines along an axis have one place across, which stays where one of them does.
        let ties = ties(ring);
        let first = |mut k: usize| {
            while let Some(before) = ties[k] {
                k = before;
            }
            k
        };
        for k in 0..indices.len() {
            if indices[k].is_none() {
                indices[first(k)] = None;
            }
        }
        let mut next = 0;
        for k in 0..indices.len() {
            match first(k) {
                own if own == k => {
                    if let Some(index) = &mut indices[k] {
                        *index = next;
                        next += 1;
                    }
                }
                tied => indices[k] = indices[tied],
            }
        }
        let mut rest = Coverage::none(&target.band);
        (0..count)
            .filter(|&i| !moves[i])
            .for_each(|i| rest.add(ring, i, &owns));
        rest.forget();
        Self {
            target,
            segments: (0..count).filter(|&i| moves[i]).collect(),
            rest,
            indices,
            count: next,
            joints,
        }
    }

    fn coverage(&self, ring: &Ring) -> Coverage<'a> {
        let mut coverage = self.rest.clone();
        let owns = ring.owns();
        self.segments
            .iter()
            .for_each(|&i| coverage.add(ring, i, &owns));
        coverage
    }

    /// χ²: the squares of all errors in units of their deviations.
    fn cost(&self, ring: &Ring, shares: &[f64]) -> f64 {
        let angles = self.joints.iter().map(|&i| ring.angle(i) / ANGLE);
        self.target.chi2(shares) + angles.map(|error| error * error).sum::<f64>()
    }

    /// The damped step from here.
    fn equations(
        &self,
        ring: &Ring,
        coverage: &Coverage<'_>,
        shares: &[f64],
    ) -> (Normal<1>, Vec<f64>) {
        let target = self.target;
        let mut equations = Normal::<1>::of(self.count);
        let mut scale = vec![1.0; self.count];
        let mut add = |terms: &[(usize, f64)], error: f64| {
            equations.add(terms, [error], 1.0);
            terms
                .iter()
                .for_each(|(k, slope)| scale[*k] += slope * slope);
        };
        // 1. The pixels that edges touch.
        const NONE: u32 = u32::MAX;
        let mut rows = vec![NONE; target.weights.len()];
        let (mut pixels, mut slopes) = (Vec::new(), Vec::new());
        for (pixel, unknown, slope) in coverage.slopes() {
            let is_open = target.error(pixel, shares[pixel]) != 0.0;
            let Some(index) = self.indices[unknown].filter(|_| is_open) else {
                continue;
            };
            if rows[pixel] == NONE {
                rows[pixel] = pixels.len() as u32;
                pixels.push(pixel);
                slopes.resize(slopes.len() + self.count, 0.0);
            }
            slopes[rows[pixel] as usize * self.count + index] += slope * target.weights[pixel];
        }
        let mut terms = Vec::new();
        for (pixel, slopes) in pixels.into_iter().zip(slopes.chunks(self.count.max(1))) {
            terms.clear();
            terms.extend(
                slopes
                    .iter()
                    .copied()
                    .enumerate()
                    .filter(|term| term.1 != 0.0),
            );
            add(&terms, -target.error(pixel, shares[pixel]));
        }
        // 2. Smooth joints.
        let owns = ring.owns();
        for &i in &self.joints {
            let (angle, slopes) = ring.joint(i, &owns);
            let terms = slopes
                .into_iter()
                .filter_map(|(k, slope)| Some((self.indices[k]?, slope / ANGLE)));
            add(&terms.collect::<Vec<_>>(), -angle / ANGLE);
        }
        (equations, scale)
    }

    /// The ring after a step.
    fn moved(&self, ring: &Ring, step: &[[f64; 1]]) -> Ring {
        let values = ring
            .values()
            .into_iter()
            .zip(ring.units())
            .zip(&self.indices);
        let moved = values.map(|((value, unit), index)| match index {
            Some(k) => value + step[*k][0].clamp(-FARTHEST * unit, FARTHEST * unit),
            None => value,
        });
        ring.with(&moved.collect::<Vec<_>>())
    }
}

/// For each unknown of a ring an earlier one that has its value, too.
fn ties(ring: &Ring) -> Vec<Option<usize>> {
    let mut ties = vec![None; ring.unknowns()];
    let knots = ring.knots();
    let first = |ties: &[Option<usize>], mut k: usize| {
        while let Some(before) = ties[k] {
            k = before;
        }
        k
    };
    for (i, knot) in knots.iter().enumerate() {
        if let Segment::Along(axis) = knot.segment {
            let ends = [i, (i + 1) % knots.len()].map(|k| first(&ties, 2 * k + 1 - axis));
            if ends[0] != ends[1] {
                ties[ends[0].max(ends[1])] = Some(ends[0].min(ends[1]));
            }
        }
    }
    ties
}

/// The ring near this one for which χ² is least after so many iterations, and χ², where the vertices `free` may move. It ends where χ²
/// will hardly become less than `most`.
pub(super) fn refined(
    ring: &Ring,
    free: &[usize],
    target: &Target,
    iterations: usize,
    most: f64,
) -> (Ring, f64) {
    let moving = Moving::of(ring, free, target);
    let mut ring = ring.clone();
    let mut damping = 1e-3;
    let mut coverage = moving.coverage(&ring);
    let mut shares = coverage.shares();
    let mut cost = moving.cost(&ring, &shares);
    for i in 0..iterations {
        let (equations, scale) = moving.equations(&ring, &coverage, &shares);
        // Longer steps as long as they help, shorter ones until one does, or promises too little.
        let mut better = None;
        for _ in 0..9 {
            let mut damped = equations.clone();
            for (k, scale) in scale.iter().enumerate() {
                damped.add(&[(k, 1.0)], [0.0], damping * scale);
            }
            if let Some(step) = damped.solve() {
                let promised = equations.gain(&step);
                if promised < NOTHING * cost || cost - PROMISE * promised > most {
                    break;
                }
                let ring = moving.moved(&ring, &step);
                let coverage = moving.coverage(&ring);
                let shares = coverage.shares();
                let now = moving.cost(&ring, &shares);
                if now < cost && !coverage.is_outside {
                    damping = (damping / 5.0_f64).max(1e-7);
                    better = Some((ring, coverage, shares, now));
                    break;
                }
            }
            damping *= 6.0;
        }
        let Some(better) = better else {
            break;
        };
        let gain = cost - better.3;
        (ring, coverage, shares, cost) = better;
        // Each iteration gains less than the one before, once the first ones have found the way.
        if gain < ENOUGH * cost || (i > 0 && cost - HOPE * gain > most) {
            break;
        }
    }
    (ring, cost)
}

/// χ² of a ring as it is, with the angles of its smooth joints.
pub(super) fn chi2(ring: &Ring, free: &[usize], target: &Target) -> f64 {
    refined(ring, free, target, 0, f64::INFINITY).1
}

/// All vertices of a ring.
pub(super) fn all(ring: &Ring) -> Vec<usize> {
    (0..ring.segments()).collect()
}
