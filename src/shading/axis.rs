//! The axis of a shade.

use std::f64::consts::FRAC_PI_2;

use super::{Between, Block, Blocks, NEAR};
use crate::math::{self, Point, Vec2};
use crate::scene::Axis;

/// Which axes there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Linear,
    Radial,
}

/// Blocks whose values are compared because their offsets are similar: so many groups.
const GROUPS: usize = 64;
/// A line that is level or upright may be worse than the best one by this factor. A guess.
const LEVEL: f32 = 1.1;

/// The axis of this kind along which the blocks are most alike across. `None` if nothing changes, or the centre would be
/// far away.
pub(super) fn of(blocks: &Blocks, kind: Kind) -> Option<Axis> {
    match kind {
        Kind::Linear => {
            let angle = direction(blocks)?;
            // The closed form fits slopes. A search then fits the values themselves.
            let cost = |angle: f64| spread(blocks, line(blocks, angle));
            // A degree, down to a hundredth of one.
            let [angle] = math::search([angle], 0.02, 0.0002, |[angle]| cost(angle));
            // If a level or upright axis fits nearly as well, the picture was likely made with it.
            let straight = (angle / FRAC_PI_2).round() * FRAC_PI_2;
            let is_straight = cost(straight) <= f64::from(LEVEL) * cost(angle);
            Some(line(blocks, if is_straight { straight } else { angle }))
        }
        Kind::Radial => {
            let center = center(blocks)?;
            // From a fiftieth of the longer side down to a twentieth of a pixel.
            let step = blocks.size[0].max(blocks.size[1]) / 50.0;
            let [x, y] = math::search([center.x, center.y], step, 0.05, |[x, y]| {
                spread(blocks, circle(blocks, Point::new(x, y)))
            });
            Some(circle(blocks, Point::new(x, y)))
        }
    }
}

/// The angle along which values change most: of the largest eigenvector of Σ g gᵀ over all gradients g.
fn direction(blocks: &Blocks) -> Option<f64> {
    let [xx, xy, yy] = tensor(blocks, |_, [x, y]| [x * x, x * y, y * y]);
    let is_flat = xx + yy <= 0.0;
    // Half the angle whose tangent is 2·xy / (xx − yy), in any quadrant.
    let (sine, cosine) = (2.0 * xy, xx - yy);
    let length = math::hypot(sine, cosine);
    // tan(φ/2) = sin φ / (1 + cos φ), and the tangent of half of φ gives φ itself.
    let half = |sine: f64, cosine: f64| {
        if cosine <= -1.0 + 1e-6 {
            FRAC_PI_2
        } else {
            math::atan(sine / (1.0 + cosine))
        }
    };
    (!is_flat && length > 0.0).then(|| half(sine / length, cosine / length))
}

/// The point that the gradients g at p point to or away from: the least squares of g⊥·(p − c) over all of them.
fn center(blocks: &Blocks) -> Option<Point> {
    // With g⊥ = (y, −x) of a gradient (x, y): Σ g⊥g⊥ᵀ · c = Σ g⊥(g⊥·p), two equations for the centre c.
    let [xx, xy, yy] = tensor(blocks, |_, [x, y]| [y * y, -x * y, x * x]);
    let [bx, by, _] = tensor(blocks, |p, [x, y]| {
        let along = p.x * y - p.y * x;
        [y * along, -x * along, 0.0]
    });
    let determinant = xx * yy - xy * xy;
    // Gradients that are parallel have no common point.
    if determinant <= 1e-3 * (xx + yy) * (xx + yy) {
        return None;
    }
    // Cramer's rule.
    let [x, y] = [
        (yy * bx - xy * by) / determinant,
        (xx * by - xy * bx) / determinant,
    ];
    let [[left, top], [width, height]] = [blocks.low, blocks.size];
    // From a centre farther away the level lines are nearly straight: the linear kind covers these.
    let [right, down] = [x - left - width / 2.0, y - top - height / 2.0];
    let is_near = right.abs() < 2.0 * width && down.abs() < 2.0 * height;
    is_near.then(|| Point::new(x, y))
}

/// The sum over blocks and channels of what `term` makes of the place and the gradient. Steep gradients are edges of
/// things, and do not count.
fn tensor(blocks: &Blocks, term: impl Fn(Point, [f64; 2]) -> [f64; 3]) -> [f64; 3] {
    let steepest = 4.0 * NEAR;
    let mut sums = [0.0; 3];
    for (place, slopes) in blocks.slopes() {
        // One steep channel drops the block: an edge bends the direction of all channels.
        let size = |[x, y]: &[f32; 2]| math::hypot(*x, *y);
        if slopes.iter().map(size).fold(0.0, f32::max) > steepest {
            continue;
        }
        for slope in slopes {
            let terms = term(place, slope.map(f64::from));
            sums.iter_mut()
                .zip(terms)
                .for_each(|(sum, term)| *sum += term);
        }
    }
    sums
}

/// The line in this direction, in radians, from one end of the part to the other.
pub(super) fn line(blocks: &Blocks, angle: f64) -> Axis {
    let (sine, cosine) = math::sin_cos(angle);
    let along = Vec2::new(cosine, sine);
    let [[left, top], [width, height]] = [blocks.low, blocks.size];
    let middle = Point::new(left + width / 2.0, top + height / 2.0);
    let unit = Axis::Linear {
        from: middle,
        to: middle + along,
    };
    // On an axis of unit length offsets are px, so the extent gives the distances of both ends from the middle.
    let [first, last] = blocks.extent(unit);
    Axis::Linear {
        from: middle + along * first,
        to: middle + along * last,
    }
}

/// The radius from `center` to the farthest corner of the part.
fn circle(blocks: &Blocks, center: Point) -> Axis {
    let unit = Axis::Radial {
        center,
        radius: 1.0,
    };
    let [_, radius] = blocks.extent(unit);
    Axis::Radial { center, radius }
}

/// Spread of blocks of similar offsets: the sum of squared differences from the polyline through the means of groups. Differences
/// from the means themselves would be those along the axis where groups are wide.
fn spread(blocks: &Blocks, axis: Axis) -> f64 {
    // Each group has a knot at its mean offset.
    let knots = blocks.grouped(axis, GROUPS);
    let offsets: Vec<f64> = knots.iter().map(|knot| knot.offset).collect();
    let apart = |block: &Block| {
        let at = axis.offset(block.center).clamp(0.0, 1.0);
        let at = Between::of(&offsets, at);
        let channel = |c: usize| f64::from(block.value[c]) - at.value(|i| knots[i].value[c]);
        [0, 1, 2, 3].map(channel).map(|v| v * v).iter().sum::<f64>()
    };
    blocks.taking_part().map(apart).sum()
}
