//! Circles, ellipses and rectangles near the samples of a contour.

use super::super::contour::{self, Place};
use super::curve::{Ring, with_radius};
use super::describe::{self, PRICE, Sample};
use crate::math::{self, Normal, Point, Vec2};
use crate::scene::Shape;

/// Beneath what hides a whole side of a rectangle it ends this much farther on, px, so that no gap is seen.
const BENEATH: f64 = 2.0;
/// Share of the samples of a contour that a shape may miss: pixels judge those that are left.
const MISSED: f64 = 0.25;

/// The shapes near a contour, nearest first. Only a ring that is `alone` is written as an ellipse or with round corners.
pub(super) fn near(samples: &[Sample], is_alone: bool) -> Vec<Ring> {
    let seen: Vec<Sample> = samples
        .iter()
        .copied()
        .filter(|s| s.gap.is_none())
        .collect();
    if seen.len() < 5 {
        return Vec::new();
    }
    let circle = |samples: &[Sample]| {
        let (center, radius) = describe::nearest_circle(samples)?;
        Some(Shape::circle(center, radius))
    };
    let circle = most(&seen, circle);
    let [sharp, round, full] = rectangles(&seen, samples.len() > seen.len());
    let rare = [most(&seen, ellipse), Some(round), Some(full)];
    let found = [circle, Some(sharp)]
        .into_iter()
        .chain(rare.map(|shape| shape.filter(|_| is_alone)));
    let turn = 1.0_f64.copysign(twice_area(samples));
    let found = found.flatten().filter_map(|shape| {
        let finite = with_radius(&shape);
        let ring = Ring::Shape { shape, turn };
        let squares = seen
            .iter()
            .map(|sample| sample.square(distance(&finite, sample.at)));
        let cost = 0.5 * squares.sum::<f64>() + PRICE * ring.freedom();
        let limit = 0.5 * describe::CAP * MISSED * seen.len() as f64;
        (finite.is_solid() && cost - PRICE * ring.freedom() < limit).then_some((cost, ring))
    });
    let mut found: Vec<(f64, Ring)> = found.collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, ring)| ring).collect()
}

/// The rectangle around a contour of a few pixels.
pub(super) fn around(contour: &[Place]) -> Ring {
    let along = |axis: usize| contour.iter().map(move |p| f64::from(p[axis]));
    let low = [0, 1].map(|axis| along(axis).fold(f64::INFINITY, f64::min));
    let high = [0, 1].map(|axis| along(axis).fold(f64::NEG_INFINITY, f64::max));
    let [low, high] = [low, high].map(|[x, y]| Point::new(x, y));
    Ring::Shape {
        shape: Shape::rect([low, high], 0.0),
        // Contours have what is inside on their left, rings on their right.
        turn: -f64::from(contour::twice_area(contour).signum()),
    }
}

/// The shape of most samples: those are left out that are far from that of all, in units of what half of them are. Beside what hides
/// a contour, samples are off.
fn most(samples: &[Sample], fit: impl Fn(&[Sample]) -> Option<Shape>) -> Option<Shape> {
    let mut shape = fit(samples)?;
    for _ in 0..ROUNDS {
        let away = |sample: &Sample| distance(&shape, sample.at).abs() / sample.sigma;
        let mut all: Vec<f64> = samples.iter().map(away).collect();
        let middle = all.len() / 2;
        let median = *all.select_nth_unstable_by(middle, f64::total_cmp).1;
        let kept: Vec<Sample> = samples
            .iter()
            .copied()
            .filter(|s| away(s) <= FAR * median.max(1.0))
            .collect();
        shape = fit(&kept)?;
    }
    Some(shape)
}

/// Rounds of leaving samples out.
const ROUNDS: usize = 3;
/// Four standard deviations of a normal distribution are so many times as far as half of it.
const FAR: f64 = 6.0;

fn twice_area(samples: &[Sample]) -> f64 {
    let middle = samples[0].at;
    let next = samples.iter().cycle().skip(1);
    let pairs = samples.iter().zip(next);
    pairs
        .map(|(a, b)| (a.at - middle).cross(b.at - middle))
        .sum()
}

/// The distance of a place from the outline of a shape, positive outside; of an ellipse to first order.
fn distance(shape: &Shape, p: Point) -> f64 {
    match *shape {
        Shape::Circle { center, radius } => (p - center).hypot() - radius,
        Shape::Ellipse {
            center,
            radii: [a, b],
        } => {
            let d = p - center;
            let out = Vec2::new(d.x / a, d.y / b);
            let slope = Vec2::new(out.x / a, out.y / b).hypot() / out.hypot().max(1e-9);
            (out.hypot() - 1.0) / slope.max(1e-9)
        }
        Shape::Rect { low, high, radius } => {
            let (middle, half) = (low.midpoint(high), 0.5 * (high - low));
            let d = p - middle;
            let [x, y] = [d.x.abs() - half.x + radius, d.y.abs() - half.y + radius];
            math::hypot(x.max(0.0), y.max(0.0)) + x.max(y).min(0.0) - radius
        }
    }
}

/// The ellipse parallel to the axes near some samples, by least squares of x² + p·y² + q·x + r·y = s.
fn ellipse(samples: &[Sample]) -> Option<Shape> {
    let origin = samples[0].at;
    let mut equations = Normal::<1>::of(4);
    for sample in samples {
        let d = sample.at - origin;
        let terms = [(0, d.y * d.y), (1, d.x), (2, d.y), (3, -1.0)];
        equations.add(&terms, [-d.x * d.x], 1.0);
    }
    let solution = equations.solve()?;
    let [p, q, r, s] = [0, 1, 2, 3].map(|k| solution[k][0]);
    let center = Vec2::new(-0.5 * q, -0.5 * r / p);
    let square = s + center.x * center.x + p * center.y * center.y;
    let radii = [square.sqrt(), (square / p).sqrt()];
    let is_one = radii.iter().all(|radius| (0.2..3000.0).contains(radius));
    is_one.then(|| Shape::ellipse(origin + center, radii))
}

/// The rectangle around some samples, with sharp corners, with round ones, and with half circles at its ends. Beneath what hides a side it goes on.
fn rectangles(samples: &[Sample], is_hidden: bool) -> [Shape; 3] {
    let side = |axis: usize, sign: f64| {
        let along = |sample: &Sample| sign * if axis == 0 { sample.at.x } else { sample.at.y };
        let most = samples.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
        let is_close = |sample: &&Sample| along(sample) > most - 3.0 * sample.sigma;
        let close: Vec<f64> = samples.iter().filter(is_close).map(along).collect();
        let mean = close.iter().sum::<f64>() / close.len() as f64;
        let is_told = close.len() > 2 || !is_hidden;
        sign * if is_told { mean } else { most + BENEATH }
    };
    let low = Point::new(side(0, -1.0), side(1, -1.0));
    let high = Point::new(side(0, 1.0), side(1, 1.0));
    // The corner of a quarter circle is (√2 − 1)·r away from it. Hidden corners are farther from what is seen.
    let corners = [
        low,
        Point::new(high.x, low.y),
        high,
        Point::new(low.x, high.y),
    ];
    let away = corners.map(|corner| {
        let squares = samples.iter().map(|sample| (sample.at - corner).hypot2());
        squares.fold(f64::INFINITY, f64::min).sqrt()
    });
    let least = away.into_iter().fold(f64::INFINITY, f64::min);
    let half = 0.5 * (high.x - low.x).min(high.y - low.y);
    let radius = (least / (2.0_f64.sqrt() - 1.0)).clamp(0.1, half.max(0.1));
    [0.0, radius, f64::INFINITY].map(|radius| Shape::rect([low, high], radius))
}

#[cfg(test)]
mod tests {
    use super::super::describe::tests::sampled;
    use super::*;

    const SIGMA: f64 = 0.03;

    fn rect([left, top, right, bottom]: [f64; 4], radius: f64) -> Shape {
        Shape::rect([Point::new(left, top), Point::new(right, bottom)], radius)
    }

    /// The nearest shape to samples of this one, a share of which is hidden.
    fn found(shape: Shape, hidden: f64) -> Shape {
        let mut samples = sampled(&Ring::Shape { shape, turn: 1.0 }, SIGMA);
        samples.truncate((samples.len() as f64 * (1.0 - hidden)) as usize);
        samples.push(Sample {
            at: samples[0].at,
            sigma: f64::INFINITY,
            gap: Some(0),
            half: None,
        });
        match near(&samples, true).into_iter().next() {
            Some(Ring::Shape { shape, .. }) => shape,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_shape_is_near_its_own_samples() {
        let center = Point::new(20.3, 31.7);
        let shapes = [
            Shape::circle(center, 12.4),
            Shape::ellipse(center, [18.3, 9.6]),
            rect([3.2, 5.1, 44.6, 30.9], 0.0),
            rect([3.2, 5.1, 44.6, 30.9], 6.0),
        ];
        for shape in shapes {
            let found = found(shape, 0.0);
            assert_eq!(found.kind(), shape.kind());
            let places = sampled(&Ring::Shape { shape, turn: 1.0 }, 0.0);
            let farthest = places
                .iter()
                .map(|sample| distance(&found, sample.at).abs());
            let farthest = farthest.fold(0.0, f64::max);
            // Round corners are guessed by one sample each; refinement fits them.
            assert!(farthest < 0.5, "{found:?}: {farthest}");
        }
    }

    #[test]
    fn two_thirds_tell_a_circle() {
        let Shape::Circle { center, radius } =
            found(Shape::circle(Point::new(20.3, 31.7), 12.4), 0.33)
        else {
            panic!()
        };
        let away = (center - Point::new(20.3, 31.7)).hypot();
        assert!(
            away < 0.05 && (radius - 12.4).abs() < 0.05,
            "{center:?} {radius}"
        );
    }
}
