//! Gradients on top of each other: a part that no single shade explains, as a glow on a sky, may be two.
//!
//! A shade on top changes a value `v` below to `(1 − a)·v + p`, with its opacity `a` and its premultiplied colour `p`. Along a
//! given axis both are linear between knots, so that the best ones are a linear least-squares problem. Places of the axis are
//! searched for the least error. Then the lower shade is fitted again to what it must have been below the upper one, and so on.

use super::{Block, Blocks, Met, NEAR, Value, axis, premultiplied, profile};
use crate::math::{self, Normal, Point};
use crate::scene::{Axis, Shade};

/// Knots of the profile of a shade on top.
const KNOTS: usize = 9;
/// Pull on the numbers of knots towards nothing, as a share of all weights.
const RIDGE: f64 = 1e-4;
/// Nothing below is darker than this, or brighter than 1 less this.
const DARKEST: f64 = 0.004;
/// Places along each side of a part, and lengths of an axis in units of the part's longer side, that a search starts from.
const STARTS: usize = 4;
const LENGTHS: [f64; 2] = [0.25, 0.7];
/// Angles that a line starts from, radians.
const ANGLES: [f64; 4] = [0.0, 0.785, 1.571, 2.356];
/// Number of times that each shade is fitted anew.
const ROUNDS: usize = 4;
/// Tolerances of the rounds that fit the lowest shade, in units of the last one: blocks with something on top drop out bit by bit.
const FACTORS: [f32; 6] = [16.0, 8.0, 4.0, 2.0, 1.0, 1.0];
/// Radii of circles around the blocks that a stack does not explain, in units of their spread.
const SPREADS: [f64; 4] = [1.2, 2.0, 3.0, 4.5];
/// Above this opacity the shade below can't be recovered.
const HIDING: f32 = 0.8;

impl Blocks {
    /// Shades on top of each other, back to front, that meet at least this `share` of the blocks; at most `most` of them.
    pub(crate) fn best_shades(&self, share: f32, most: usize) -> Option<(Vec<Shade>, Met)> {
        let mut lowest = self.best_shade();
        if most > 1 && lowest.as_ref().is_none_or(|(_, met)| met.share < share) {
            // A fit to all blocks may follow the shade on top. This one starts with a wide tolerance and narrows it, so it settles
            // on the shade below.
            let robust = self.best_of(&FACTORS);
            lowest = lowest
                .into_iter()
                .chain(robust)
                .max_by(|(_, a), (_, b)| a.share.total_cmp(&b.share));
        }
        let (shade, met) = lowest?;
        let mut found = (vec![shade], met);
        // Add shades on top, one at a time, as long as each meets more blocks.
        while found.1.share < share && found.0.len() < most {
            let stack = self.stacked(&found.0)?;
            let met = self.met(NEAR, |block| stacked(&stack, block.center));
            if met.share <= found.1.share {
                break;
            }
            found = (stack, met);
        }
        Some(found)
    }

    /// The shades with one more on top, all fitted to each other.
    fn stacked(&self, below: &[Shade]) -> Option<Vec<Shade>> {
        let mut stack = below.to_vec();
        let mut from = self.starts(below);
        // Alternate: fit the top shade to what the others leave, then the lowest one to what shows through. A round may be worse
        // than the one before, so keep the best.
        let mut best: Option<(f32, Vec<Shade>)> = None;
        for _ in 0..ROUNDS {
            stack.truncate(below.len());
            let top = self.on_top(&stack, &from)?;
            // Later rounds search near the axis that was found, and not from all starts again.
            from = vec![top.axis()];
            stack.push(top);
            self.refit(&mut stack);
            let met = self.met(NEAR, |block| stacked(&stack, block.center));
            if best.as_ref().is_none_or(|(share, _)| met.share > *share) {
                best = Some((met.share, stack.clone()));
            }
        }
        best.map(|(_, stack)| stack)
    }

    /// Fits the lowest shade to the values that it must have below the others.
    fn refit(&self, stack: &mut [Shade]) {
        let Some((lowest, others)) = stack.split_first_mut() else {
            return;
        };
        let unmixed = |block: &Block| {
            let above = stacked(others, block.center);
            // value = (1 − a)·below + p, so below = (value − p)/(1 − a). The division magnifies errors, so nearly opaque places
            // don't count.
            let through = 1.0 - above[3];
            if through <= 1.0 - HIDING || block.weight == 0.0 {
                return Block {
                    weight: 0.0,
                    ..*block
                };
            }
            let value = [0, 1, 2, 3].map(|c| (block.value[c] - above[c]) / through);
            Block { value, ..*block }
        };
        let blocks = Self {
            all: self.all.iter().map(unmixed).collect(),
            ..*self
        };
        if let Some((shade, _)) = blocks.best_shade() {
            *lowest = shade;
        }
    }

    /// Axes that a search for a shade on top starts from: circles around what these shades do not explain and all over the
    /// part, and lines.
    fn starts(&self, below: &[Shade]) -> Vec<Axis> {
        let side = self.size[0].max(self.size[1]);
        // The centres of a grid of STARTS × STARTS cells.
        let place = |i: usize| {
            [0, 1].map(|k| {
                let step = [i % STARTS, i / STARTS][k] as f64 + 0.5;
                self.low[k] + self.size[k] * step / STARTS as f64
            })
        };
        let places = (0..STARTS * STARTS).map(place);
        let circles = places.flat_map(|center| {
            LENGTHS.map(|length| Axis::Radial {
                center: Point::new(center[0], center[1]),
                radius: length * side,
            })
        });
        let lines = ANGLES
            .into_iter()
            .flat_map(|angle| [angle, angle + std::f64::consts::PI]);
        let lines = lines.map(|angle| axis::line(self, angle));
        let around = self.unexplained(below).into_iter();
        let around = around.flat_map(|(center, spread)| {
            SPREADS.map(|spreads| Axis::Radial {
                center,
                radius: spreads * spread,
            })
        });
        around.chain(circles).chain(lines).collect()
    }

    /// The middle of the blocks that these shades do not explain, and their spread, px.
    fn unexplained(&self, below: &[Shade]) -> Option<(Point, f64)> {
        let missing = |block: &Block| {
            let seen = stacked(below, block.center);
            let apart = block.value.iter().zip(seen).map(|(a, b)| (a - b).abs());
            // Differences within the tolerance are explained. The rest counts by its square.
            let beyond = (apart.fold(0.0, f32::max) - NEAR).max(0.0);
            block.weight * beyond * beyond
        };
        let missing = self.all.iter().map(missing).map(f64::from);
        let weights: Vec<f64> = missing.collect();
        let mean = |of: &dyn Fn(&Block) -> f64| {
            let sum = self
                .all
                .iter()
                .zip(&weights)
                .map(|(block, weight)| weight * of(block));
            sum.sum::<f64>() / weights.iter().sum::<f64>()
        };
        let center = Point::new(mean(&|block| block.center.x), mean(&|block| block.center.y));
        // The RMS distance from the middle. Without any weight the mean is 0/0, and the comparison below is false.
        let spread = mean(&|block| (block.center - center).hypot2()).sqrt();
        (spread > 0.0).then_some((center, spread))
    }

    /// The shade that brings what these shades show nearest to the blocks, along the best axis near one of `from`.
    fn on_top(&self, below: &[Shade], from: &[Axis]) -> Option<Shade> {
        let seen: Vec<Value> = self
            .all
            .iter()
            .map(|block| stacked(below, block.center))
            .collect();
        let cost = |axis: Axis| {
            let layer = self.layer(axis, &seen);
            layer.map_or(f64::INFINITY, |layer| layer.error)
        };
        // The best start, and the best axis near it.
        let starts = from.iter().map(|&axis| (cost(axis), axis));
        let (_, start) = starts.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
        let step = self.size[0].max(self.size[1]) / 25.0;
        let numbers = math::search(numbers(start), step, step / 100.0, |numbers| {
            cost(moved(start, numbers))
        });
        let axis = moved(start, numbers);
        // The layer's profile as a gradient of few stops.
        let layer = self.layer(axis, &seen)?;
        let blocks = Self {
            all: self
                .all
                .iter()
                .map(|block| Block {
                    value: layer.at(axis, block.center),
                    ..*block
                })
                .collect(),
            ..*self
        };
        profile::of(&blocks, axis)
    }

    /// The best layer along an axis on top of what is `seen`, where differences far beyond [`NEAR`] count little.
    fn layer(&self, axis: Axis, seen: &[Value]) -> Option<Layer> {
        if axis.length() < 2.0 {
            return None;
        }
        // Unknowns: the premultiplied value of each knot. Each block adds one equation per channel, (1 − a)·seen + p = value, to
        // the normal equations.
        const N: usize = 4 * KNOTS;
        let mut equations = Normal::of(N);
        let both = || self.all.iter().zip(seen);
        let taking_part = || both().filter(|(block, _)| block.weight > 0.0);
        let (mut below, mut counts) = ([[0.0; 3]; KNOTS], [0.0; KNOTS]);
        let mut weights = 0.0;
        for (block, seen) in taking_part() {
            weights += 1.0;
            let ends = knots(axis, block.center);
            // The mean colour below each knot, for the choice among equal layers at the end.
            for (knot, share) in ends {
                counts[knot] += share;
                (0..3).for_each(|c| below[knot][c] += share * f64::from(seen[c]));
            }
            for channel in 0..4 {
                let wanted = f64::from(block.value[channel] - seen[channel]);
                // The change by the layer's own value in this channel, and by its opacity.
                let terms = match channel {
                    3 => [(3, 1.0 - f64::from(seen[3])), (3, 0.0)],
                    _ => [(channel, 1.0), (3, -f64::from(seen[channel]))],
                };
                let of = |(knot, share): (usize, f64), (c, factor): (usize, f64)| {
                    (4 * knot + c, share * factor)
                };
                // Both terms at both knots around the block: four entries of the row.
                let [first, last] = ends;
                let entries = [
                    of(first, terms[0]),
                    of(first, terms[1]),
                    of(last, terms[0]),
                    of(last, terms[1]),
                ];
                equations.add(&entries, [wanted], 1.0);
            }
        }
        // Knots that no block is near stay clear.
        for k in 0..N {
            equations.add(&[(k, 1.0)], [0.0], RIDGE * weights / KNOTS as f64);
        }
        let found = equations.solve()?.into_flattened();
        // Where something opaque shows, any opacity and the colour that goes with it show it alike. The one that is found may
        // need a colour that is none; the least one that does not takes its place.
        let knots = std::array::from_fn(|k| {
            let behind =
                |c: usize| (below[k][c] / counts[k].max(RIDGE)).clamp(DARKEST, 1.0 - DARKEST);
            let change = [0, 1, 2].map(|c| found[4 * k + c] - found[4 * k + 3] * behind(c));
            let least = |c: usize| (change[c] / (1.0 - behind(c))).max(-change[c] / behind(c));
            let opacity = [0, 1, 2]
                .map(least)
                .into_iter()
                .fold(found[4 * k + 3], f64::max);
            let opacity = opacity.clamp(0.0, 1.0);
            let value = |c: usize| (change[c] + opacity * behind(c)).clamp(0.0, opacity) as f32;
            [value(0), value(1), value(2), opacity as f32]
        });
        let mut layer = Layer { knots, error: 0.0 };
        // Cut off large differences: things in front of all shades don't decide.
        let most = f64::from(4.0 * NEAR);
        for (block, seen) in taking_part() {
            let shown = over(layer.at(axis, block.center), *seen);
            let errors = (0..4).map(|c| f64::from(shown[c] - block.value[c]).abs().min(most));
            layer.error += errors.map(|error| error * error).sum::<f64>();
        }
        Some(layer)
    }
}

/// Premultiplied values along an axis, at even offsets, and the squared error that they leave.
struct Layer {
    knots: [Value; KNOTS],
    error: f64,
}

impl Layer {
    fn at(&self, axis: Axis, at: Point) -> Value {
        let mut value = [0.0; 4];
        for (knot, share) in knots(axis, at) {
            for (sum, v) in value.iter_mut().zip(self.knots[knot]) {
                *sum += share as f32 * v;
            }
        }
        value
    }
}

/// The two knots that a place lies between, with their shares.
fn knots(axis: Axis, at: Point) -> [(usize, f64); 2] {
    // Knots lie at even offsets. The last one closes the last interval, hence the `min`.
    let along = axis.offset(at).clamp(0.0, 1.0) * (KNOTS - 1) as f64;
    let first = (along as usize).min(KNOTS - 2);
    let share = along - first as f64;
    [(first, 1.0 - share), (first + 1, share)]
}

/// The numbers of an axis that a search changes.
fn numbers(axis: Axis) -> [f64; 4] {
    match axis {
        Axis::Linear { from, to } => [from.x, from.y, to.x, to.y],
        Axis::Radial { center, radius } => [center.x, center.y, radius, 0.0],
    }
}

/// The axis of the kind of `axis` with these numbers.
fn moved(axis: Axis, numbers: [f64; 4]) -> Axis {
    let [a, b, c, d] = numbers;
    match axis {
        Axis::Linear { .. } => Axis::Linear {
            from: Point::new(a, b),
            to: Point::new(c, d),
        },
        Axis::Radial { .. } => Axis::Radial {
            center: Point::new(a, b),
            radius: c.abs(),
        },
    }
}

/// A premultiplied value on another.
fn over(upper: Value, lower: Value) -> Value {
    [0, 1, 2, 3].map(|c| upper[c] + (1.0 - upper[3]) * lower[c])
}

/// The premultiplied value of shades on each other, given back to front.
pub(crate) fn stacked(shades: &[Shade], at: Point) -> Value {
    shades.iter().fold([0.0; 4], |below, shade| {
        over(premultiplied(shade, at), below)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 40;

    /// Blocks of 8 px of an opaque picture.
    fn blocks(value: impl Fn(Point) -> [f32; 3]) -> Blocks {
        let block = |i: usize| {
            let center = Point::new((i % SIDE) as f64 * 8.0 + 4.0, (i / SIDE) as f64 * 8.0 + 4.0);
            let [r, g, b] = value(center).map(|v| (v * 255.0).round() / 255.0);
            Block {
                center,
                value: [r, g, b, 1.0],
                weight: 1.0,
            }
        };
        let size = 8.0 * SIDE as f64;
        Blocks {
            columns: SIDE,
            all: (0..SIDE * SIDE).map(block).collect(),
            low: [0.0; 2],
            size: [size; 2],
        }
    }

    #[test]
    fn a_glow_on_a_sky_is_a_shade_on_a_shade() {
        let sun = Point::new(230.0, 90.0);
        let sky = |p: Point| {
            let t = (p.y / 320.0) as f32;
            let glow = 0.9 * (1.0 - (p.distance(sun) / 80.0) as f32).max(0.0);
            let below = [0.15 + 0.7 * t, 0.5 + 0.4 * t, 0.75 + 0.2 * t];
            [0, 1, 2].map(|c| below[c] + glow * ([1.0, 0.95, 0.7][c] - below[c]))
        };
        let blocks = blocks(sky);
        let (alone, met) = blocks.best_shades(0.95, 1).unwrap();
        assert!(alone.len() == 1 && met.share < 0.95, "{met:?}");
        let (shades, met) = blocks.best_shades(0.95, 3).unwrap();
        assert!(shades.len() == 2 && met.share >= 0.95, "{met:?}");
        let Axis::Radial { center, .. } = shades[1].axis() else {
            panic!("{shades:?}");
        };
        assert!((center - sun).hypot() < 3.0, "{shades:?}");
        assert!(shades[0].is_opaque(), "{shades:?}");
    }

    #[test]
    fn a_ramp_needs_no_second_shade() {
        let blocks = blocks(|p| [(p.x / 320.0) as f32, 0.5, 0.2]);
        let (shades, _) = blocks.best_shades(0.95, 3).unwrap();
        assert_eq!(shades.len(), 1);
    }
}
