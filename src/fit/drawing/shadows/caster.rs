//! The blurs of a shape that meet the shares of a shadow best.

use super::shares::Shares;
use crate::math;
use crate::render::{self, Plane, blurred};
use crate::scene::Path;

/// Blocks along the longer side of the picture, whose shares are fitted.
const BLOCKS: usize = 160;
/// Standard deviations of the blurs that are tried first, px.
const BLURS: [f32; 8] = [1.5, 2.5, 4.0, 6.5, 10.0, 16.0, 26.0, 40.0];
/// The factor between the best of these and its neighbours; its root is the next one, and so on.
const BLUR_STEP: f32 = 1.25;
/// Number of times that blurs are tried.
const REFINEMENTS: usize = 5;
/// The first step of the search for a place, blocks.
const SHIFT_STEP: f64 = 2.0;
/// The last step.
const SHIFT_FINEST: f64 = 0.05;

/// A blur of the caster's shape.
pub(super) struct Cast {
    /// To the right and down, px.
    pub(super) shift: [f32; 2],
    /// Standard deviation, px.
    pub(super) blur: f32,
    pub(super) opacity: f32,
}

/// The shares of a reduced picture, and of what casts them. Lengths are in px of the picture.
pub(super) struct Search {
    /// Pixels along the side of a block.
    side: usize,
    caster: Plane,
    /// The share of each block that is not explained yet, where it is seen, and the number of its pixels.
    shares: Vec<(usize, f32)>,
}

impl Search {
    /// The search on the blocks that a shadow is fitted on, if any of them is seen.
    pub(super) fn of(shares: &Shares, rings: &[Path]) -> Option<Self> {
        let (width, height) = (shares.width, shares.seen.len() / shares.width);
        let caster = render::filled(rings.iter().cloned(), [width, height]);
        let side = width.max(height).div_ceil(BLOCKS).max(1);
        let columns = width.div_ceil(side);
        let count = columns * height.div_ceil(side);
        // A block counts where nothing covers any of its pixels.
        let mut sums = vec![(0.0_f32, 0.0_f32, 0_usize, true); count];
        for (i, (seen, caster)) in shares.seen.iter().zip(&caster.values).enumerate() {
            let block = i / width / side * columns + i % width / side;
            let (share, cast, pixels, is_seen) = &mut sums[block];
            *share += seen.unwrap_or(0.0);
            *cast += caster;
            *pixels += 1;
            *is_seen &= seen.is_some();
        }
        let whole = |&(i, &(share, _, pixels, is_seen)): &(usize, &(f32, f32, usize, bool))| {
            is_seen.then(|| (i, share / pixels as f32))
        };
        let known: Vec<(usize, f32)> = sums
            .iter()
            .enumerate()
            .filter_map(|sum| whole(&sum))
            .collect();
        let caster = sums
            .iter()
            .map(|&(_, cast, pixels, _)| cast / pixels as f32);
        let caster = Plane {
            width: columns,
            values: caster.collect(),
        };
        let is_shaded = known.iter().any(|(_, share)| *share > 0.0);
        is_shaded.then_some(Self {
            side,
            caster,
            shares: known,
        })
    }

    /// The squared error of the shares that no cast explains yet, summed over pixels.
    pub(super) fn error(&self) -> f32 {
        let pixels = (self.side * self.side) as f32;
        pixels
            * self
                .shares
                .iter()
                .map(|(_, share)| share * share)
                .sum::<f32>()
    }

    /// The cast that leaves the least error.
    pub(super) fn best(&self) -> Option<Cast> {
        let mut best: Option<(f32, Cast)> = None;
        let mut ratio = BLUR_STEP;
        let mut blurs: Vec<f32> = BLURS.iter().map(|blur| blur / self.side as f32).collect();
        // Coarse ones first, and then ever finer ones beside the best.
        for _ in 0..REFINEMENTS {
            // Each blur is tried from the best shift so far, as the shift hardly depends on the blur.
            for blur in blurs {
                let soft = blurred(self.caster.clone(), blur);
                let from = best.as_ref().map_or([0.0; 2], |(_, cast)| cast.shift);
                let (error, shift, opacity) = self.placed(&soft, from);
                if best.as_ref().is_none_or(|(least, _)| error < *least) {
                    best = Some((
                        error,
                        Cast {
                            shift,
                            blur,
                            opacity,
                        },
                    ));
                }
            }
            let blur = best.as_ref()?.1.blur;
            blurs = vec![blur * ratio, blur / ratio];
            ratio = ratio.sqrt();
        }
        let (_, cast) = best?;
        let px = self.side as f32;
        (cast.opacity > 0.0).then_some(Cast {
            shift: cast.shift.map(|v| v * px),
            blur: cast.blur * px,
            opacity: cast.opacity.min(1.0),
        })
    }

    /// Subtracts the shares that a cast explains.
    pub(super) fn take(&mut self, cast: &Cast) {
        let px = self.side as f32;
        let soft = blurred(self.caster.clone(), cast.blur / px);
        let shift = cast.shift.map(|v| v / px);
        for (i, share) in &mut self.shares {
            *share -= cast.opacity * at(&soft, *i, shift);
        }
    }

    /// The least error of a blurred shape, near this shift, with the shift and the opacity there. In blocks.
    fn placed(&self, soft: &Plane, from: [f32; 2]) -> (f32, [f32; 2], f32) {
        let cost = |shift: [f32; 2]| {
            let (mut both, mut own, mut all) = (0.0, 0.0, 0.0);
            for &(i, share) in &self.shares {
                let covered = at(soft, i, shift);
                both += share * covered;
                own += covered * covered;
                all += share * share;
            }
            // For a given shape the error Σ (share − α·covered)² is least at α = Σ share·covered / Σ covered².
            let opacity = (both / own.max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
            (
                // all − 2α·both + α²·own
                f64::from(all - opacity * (2.0 * both - opacity * own)),
                opacity,
            )
        };
        let shift = math::search(from.map(f64::from), SHIFT_STEP, SHIFT_FINEST, |shift| {
            cost(shift.map(|px| px as f32)).0
        });
        let shift = shift.map(|px| px as f32);
        let (error, opacity) = cost(shift);
        (error as f32, shift, opacity)
    }
}

/// The value of a plane that was moved by `shift`, at its block `i`: between four blocks.
fn at(plane: &Plane, i: usize, shift: [f32; 2]) -> f32 {
    let height = plane.values.len() / plane.width;
    let [x, y] = [
        (i % plane.width) as f32 - shift[0],
        (i / plane.width) as f32 - shift[1],
    ];
    let (left, top) = (x.floor(), y.floor());
    let [u, v] = [x - left, y - top];
    let value = |x: f32, y: f32| {
        let is_inside = x >= 0.0 && y >= 0.0 && x < plane.width as f32 && y < height as f32;
        match is_inside {
            true => plane.values[y as usize * plane.width + x as usize],
            false => 0.0,
        }
    };
    let row = |y: f32| value(left, y) * (1.0 - u) + value(left + 1.0, y) * u;
    row(top) * (1.0 - v) + row(top + 1.0) * v
}
