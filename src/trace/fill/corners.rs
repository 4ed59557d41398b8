//! Corners of an outline: where lines fitted to either side turn. They are put where the two lines meet, since the
//! pixels have rounded them.

use super::super::contour::Place;
use crate::math::{self, distance};

/// A corner's sides are fitted from the first to the second distance from it, px. A guess.
const SIDES: [f32; 2] = [0.8, 4.5];
/// The cosine of a corner's turn is below this. That of 0.62 rad; a guess.
const CORNER: f32 = 0.814;

/// A corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    /// The index of its sample.
    pub(super) index: usize,
    /// Where it is.
    pub(super) at: Place,
}

/// A line fitted to some places: its middle and direction.
type Line = [Place; 2];

/// The cosine of the turn at each sample of a ring, and the corners.
pub(super) fn corners(ring: &[Place], step: f32) -> (Vec<f32>, Vec<Corner>) {
    let count = ring.len();
    let near = ((SIDES[0] / step).round() as usize).max(1);
    let mut far = ((SIDES[1] / step).round() as usize).max(near + 1);
    if count < 2 * far + 2 {
        far = ((count - 2) / 3).max(near + 1);
    }
    let sides = |i: usize| {
        let before = (near..=far)
            .rev()
            .map(|d| ring[(i + count * 2 - d) % count]);
        let after = (near..=far).map(|d| ring[(i + d) % count]);
        [fitted(before), fitted(after)]
    };
    let sides: Vec<[Line; 2]> = (0..count).map(sides).collect();
    let turn = |[[_, a], [_, b]]: &[Line; 2]| a[0] * b[0] + a[1] * b[1];
    let turns: Vec<f32> = sides.iter().map(turn).collect();
    let reach = ((2.0 / step).round() as usize).max(1);
    // The sharpest one of its neighbours, the first of equals.
    let is_corner = |&i: &usize| {
        turns[i] < CORNER
            && is_pointed(ring, i, &sides[i], turns[i])
            && (1..=reach).all(|d| {
                turns[(i + count * 2 - d) % count] > turns[i] && turns[(i + d) % count] >= turns[i]
            })
    };
    let corner = |index: usize| Corner {
        index,
        at: meeting(ring[index], &sides[index]),
    };
    let corners = (0..count).filter(is_corner).map(corner).collect();
    (turns, corners)
}

/// True if the sides of a corner meet no farther from it than pixels take off a corner. Those of a tight curve
/// meet farther away.
fn is_pointed(ring: &[Place], i: usize, sides: &[Line; 2], turn: f32) -> bool {
    let angle = 2.0 * math::atan(((1.0 - turn) / (1.0 + turn).max(1e-6)).max(0.0).sqrt());
    let lost = 0.42 * angle + 1.1 * (angle - 1.6).max(0.0);
    let count = ring.len();
    let near = (0..5).map(|d| ring[(i + count + d - 2) % count]);
    crossing(sides).is_none_or(|at| near.into_iter().any(|p| distance(at, p) < lost))
}

/// Where two lines cross, unless they are nearly parallel.
fn crossing([[a, u], [b, v]]: &[Line; 2]) -> Option<Place> {
    let cross = u[0] * v[1] - u[1] * v[0];
    let along = ((b[0] - a[0]) * v[1] - (b[1] - a[1]) * v[0]) / cross;
    (cross.abs() >= 0.2).then(|| [0, 1].map(|k| a[k] + along * u[k]))
}

/// The line through places that are in order.
fn fitted(places: impl Iterator<Item = Place> + Clone) -> Line {
    let count = places.clone().count().max(1) as f32;
    let mut middle = [0.0; 2];
    for p in places.clone() {
        middle = [0, 1].map(|k| middle[k] + p[k] / count);
    }
    let [mut xx, mut xy, mut yy] = [0.0_f32; 3];
    for p in places.clone() {
        let [x, y] = [p[0] - middle[0], p[1] - middle[1]];
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    // Half the angle whose cosine and sine are as (xx − yy) and 2·xy.
    let length = ((xx - yy) * (xx - yy) + 4.0 * xy * xy).sqrt();
    let cosine = (xx - yy) / length.max(f32::MIN_POSITIVE);
    let x = (0.5 * (1.0 + cosine)).max(0.0).sqrt();
    let y = (0.5 * (1.0 - cosine)).max(0.0).sqrt();
    let mut axis = [x, if xy < 0.0 { -y } else { y }];
    let mut ends = places;
    if let (Some(first), Some(last)) = (ends.next(), ends.last())
        && (last[0] - first[0]) * axis[0] + (last[1] - first[1]) * axis[1] < 0.0
    {
        axis = axis.map(|v| -v);
    }
    [middle, axis]
}

/// Where the sides of a corner meet, unless that is far from its sample.
fn meeting(sample: Place, sides: &[Line; 2]) -> Place {
    let Some(at) = crossing(sides) else {
        return sample;
    };
    let away = distance(at, sample);
    // The sharper a corner, the more of it is lost.
    let [[_, u], [_, v]] = sides;
    let is_sharp = u[0] * v[0] + u[1] * v[1] < -0.32;
    let reach = if is_sharp { 2.5 } else { 1.2 };
    let share = (reach / away.max(f32::MIN_POSITIVE)).min(1.0);
    [0, 1].map(|k| sample[k] + share * (at[k] - sample[k]))
}
