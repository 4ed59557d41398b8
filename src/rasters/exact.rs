//! Exact areas: how much of each pixel a stroke covers, as renderers that take no samples compute it.
//!
//! Across a line in direction `n`, a pixel is the convolution of two boxes, of widths `|n_x|` and `|n_y|`. With `F`, its
//! integral, a stroke of radius `r` whose centre line is at a distance `t` from the pixel's centre covers
//! `F(r − t) − F(−r − t)`. This is exact beside straight lines. At ends and bends it takes the outline for straight
//! within a pixel.

use std::f32::consts::FRAC_1_SQRT_2;
use std::ops::Range;

use super::footprint::Footprint;
use super::slots::Slots;
use crate::math::{Point, Vector};
use crate::scene::Stroke;

/// Farthest that a curve is from the lines in its place, px.
const FLATNESS: f32 = 0.05;

/// Half the diagonal of a pixel: farther from the outline, px, none is partly covered.
const HALF_DIAGONAL: f32 = FRAC_1_SQRT_2;

/// Below this squared distance, px², the direction to the centre line is taken from the line.
const ON_LINE2: f32 = 1e-6;

/// Some pixels of a picture: those that a footprint is wanted of.
pub(super) struct Region<'a> {
    /// Their indices, counted row by row, rising.
    pub(super) pixels: &'a [u32],
    /// For each pixel of the picture, its place among these, if any.
    pub(super) slots: &'a Slots,
    /// Width of the picture, px.
    pub(super) width: usize,
}

/// Place of the centre line as seen from the centre of a pixel.
#[derive(Clone, Copy)]
struct Nearest {
    distance2: f32,
    across: Vector,
}

/// The pixels of `region` that `stroke` covers.
pub(super) fn footprint(stroke: &Stroke, region: &Region<'_>) -> Footprint {
    let far = Nearest {
        distance2: f32::INFINITY,
        across: Vector::new(1.0, 0.0),
    };
    let mut nearest = vec![far; region.pixels.len()];
    let mut vertices = stroke.path.flattened(FLATNESS);
    // A dot is a line without a length.
    if let [dot] = *vertices {
        vertices.push(dot);
    }
    let reach = stroke.radius + HALF_DIAGONAL;
    for ends in vertices.windows(2) {
        region.look_from([ends[0], ends[1]], reach, &mut nearest);
    }
    let covered = region.pixels.iter().zip(&nearest).map(|(&pixel, nearest)| {
        let covered = covered(stroke.radius, nearest);
        (pixel, (255.0 * covered + 0.5) as u8)
    });
    covered.collect()
}

impl Region<'_> {
    /// Looks at the pixels within `reach` of a line.
    fn look_from(&self, [a, b]: [Point; 2], reach: f32, nearest: &mut [Nearest]) {
        let along = b - a;
        let per_length2 = 1.0 / along.norm_squared().max(f32::MIN_POSITIVE);
        let height = self.slots.pixels() / self.width;
        // Row by row, only the pixels beside the part of the line that is near enough to the row.
        for row in range(a.y.min(b.y) - reach, a.y.max(b.y) + reach, height) {
            let y = row as f32 + 0.5;
            // The part of the line that is near enough to the row.
            let ends = [y - reach, y + reach].map(|y| {
                let h = (y - a.y) / along.y;
                // Of a level line, which divides by zero, all of it is.
                a.x + h.clamp(0.0, 1.0) * along.x
            });
            let [left, right] = if along.y == 0.0 { [a.x, b.x] } else { ends };
            for column in range(left.min(right) - reach, left.max(right) + reach, self.width) {
                let Some(slot) = self.slots.find((row * self.width + column) as u32) else {
                    continue;
                };
                let nearest = &mut nearest[slot];
                let p = Vector::new(column as f32 + 0.5 - a.x, y - a.y);
                // Squared distances are compared, so that one root is enough, of the nearest.
                let h = (p.dot(&along) * per_length2).clamp(0.0, 1.0);
                let q = p - along * h;
                let distance2 = q.norm_squared();
                if distance2 < nearest.distance2 {
                    let is_on_line = distance2 < ON_LINE2;
                    let across = if is_on_line {
                        Vector::new(-along.y, along.x)
                    } else {
                        q
                    };
                    *nearest = Nearest { distance2, across };
                }
            }
        }
    }
}

/// The pixels, of `end`, that a part of an axis touches.
fn range(from: f32, to: f32, end: usize) -> Range<usize> {
    let [from, to] = [from.floor(), to.ceil()].map(|v| (v.max(0.0) as usize).min(end));
    from..to
}

/// Share of a pixel that a stroke of this radius covers.
fn covered(radius: f32, &Nearest { distance2, across }: &Nearest) -> f32 {
    let distance = distance2.sqrt();
    if distance >= radius + HALF_DIAGONAL {
        return 0.0;
    }
    let across = across.abs() / across.norm().max(f32::MIN_POSITIVE);
    // Seen along the outline a pixel is a trapezoid, the convolution of its two sides.
    let [wide, narrow] = [across.max(), across.min()].map(|width| 0.5 * width);
    integral(radius - distance, wide, narrow) - integral(-radius - distance, wide, narrow)
}

/// The integral, up to `at`, of the convolution of two boxes of half these widths, of area 1.
fn integral(at: f32, wide: f32, narrow: f32) -> f32 {
    let away = at.abs();
    // The flat top of the trapezoid, its slope, and what is beyond.
    let from_middle = if away <= wide - narrow {
        0.5 * away / wide
    } else if away < wide + narrow {
        let rest = wide + narrow - away;
        0.5 - rest * rest / (8.0 * wide * narrow)
    } else {
        0.5
    };
    0.5 + from_middle.copysign(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Path, PathPoint};

    const SIDE: usize = 24;

    /// The area of each pixel that a stroke covers, by 32×32 samples.
    fn sampled(vertices: &[Point], radius: f32) -> Vec<f32> {
        let covers = |p: Point| {
            vertices.windows(2).any(|ends| {
                let (along, p) = (ends[1] - ends[0], p - ends[0]);
                let h = (p.dot(&along) / along.norm_squared().max(1e-9)).clamp(0.0, 1.0);
                (p - along * h).norm() <= radius
            })
        };
        let share = |pixel: usize| {
            let samples = (0..32 * 32).filter(|k| {
                let [x, y] = [pixel % SIDE, pixel / SIDE].map(|at| at as f32);
                let [dx, dy] = [k % 32, k / 32].map(|at| (at as f32 + 0.5) / 32.0);
                covers(Point::new(x + dx, y + dy))
            });
            samples.count() as f32 / 1024.0
        };
        (0..SIDE * SIDE).map(share).collect()
    }

    fn computed(stroke: &Stroke) -> Vec<f32> {
        let pixels: Vec<u32> = (0..(SIDE * SIDE) as u32).collect();
        let mut slots = Slots::new(SIDE * SIDE);
        slots.set(&pixels);
        let region = Region {
            pixels: &pixels,
            slots: &slots,
            width: SIDE,
        };
        let mut areas = vec![0.0; SIDE * SIDE];
        for (pixel, level) in footprint(stroke, &region).iter() {
            areas[pixel as usize] = f32::from(level) / 255.0;
        }
        areas
    }

    #[test]
    fn areas_are_those_of_many_samples() {
        let [on, off] = [PathPoint::on, PathPoint::off];
        let bent = vec![
            on([-3.0, 4.0].into()),
            off([30.0, 6.0].into()),
            on([12.0, 20.0].into()),
            on([4.0, 15.0].into()),
        ];
        let paths = [
            Path::line([3.2, 5.4].into(), [20.1, 5.4].into()),
            Path::line([3.2, 5.4].into(), [18.0, 20.2].into()),
            Path::line([15.0, -9.0].into(), [9.3, 40.0].into()),
            Path::dot([11.3, 12.6].into()),
            Path::new(bent, false).unwrap(),
        ];
        for (path, radius) in paths
            .iter()
            .flat_map(|path| [0.51, 1.2, 4.0].map(|r| (path, r)))
        {
            let stroke = Stroke {
                path: path.clone(),
                radius,
                color: [0.0; 3],
                opacity: 1.0,
            };
            let mut vertices = path.flattened(0.01);
            vertices.extend(vertices.last().copied());
            let pairs = computed(&stroke)
                .into_iter()
                .zip(sampled(&vertices, radius));
            let errors: Vec<f32> = pairs.map(|(a, b)| (a - b).abs()).collect();
            let worst = errors.iter().copied().fold(0.0, f32::max);
            let mean2 = errors.iter().map(|e| e * e).sum::<f32>() / errors.len() as f32;
            assert!(
                worst < 0.2 && mean2.sqrt() < 0.012,
                "{path:?} {radius}: {worst} {mean2}"
            );
        }
    }
}
