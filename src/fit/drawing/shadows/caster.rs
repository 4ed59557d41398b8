//! The blurs of a shape that meet the shares of a shadow best.

use super::region::Region;
use crate::math;
use crate::render::{Plane, blurred};
use crate::scene::Area;

/// How far a shadow may reach beyond what casts it, in units of the shorter side of that, and the least and the most of it, px.
const REACH: f64 = 0.75;
const LEAST_REACH: f64 = 24.0;
const MOST_REACH: f64 = 130.0;
/// Largest blur and largest shift, in units of that reach.
const BLUR_OF_REACH: f32 = 0.4;
const SHIFT_OF_REACH: f32 = 0.5;
/// Standard deviations of the blurs that are tried first, px.
const BLURS: [f32; 8] = [1.5, 2.5, 4.0, 6.5, 10.0, 16.0, 26.0, 40.0];
/// The factor between the best of these and its neighbours; its root is the next one, and so on.
const BLUR_STEP: f32 = 1.25;
/// Number of times that blurs are tried.
const REFINEMENTS: usize = 5;
/// The first step of the search for a place, blocks, and that of searches from the place of another blur.
const SHIFT_STEP: f64 = 2.0;
const NEXT_STEP: f64 = 0.5;
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

/// The box around areas on a page of this size that holds their shadows, the shares of its pixels that they cover, and how far it
/// goes beyond them, px.
pub(super) fn reach_of<'a>(
    areas: impl Iterator<Item = &'a Area> + Clone,
    page: [usize; 2],
) -> (Region, Plane, f32) {
    let bounds = areas.clone().map(Area::extent).reduce(|a, b| a.union(b));
    let bounds = bounds.unwrap_or_default();
    let reach = (REACH * bounds.width().min(bounds.height())).clamp(LEAST_REACH, MOST_REACH);
    let region = Region::around(bounds.inflate(reach, reach));
    let mut mask = vec![0.0_f32; region.size[0] * region.size[1]];
    for area in areas {
        let own = region.covered(&area.rings).values;
        let shares = mask.iter_mut().zip(own);
        shares.for_each(|(share, own)| *share = share.max(own));
    }
    // What the border of the page cuts off goes on beyond it.
    let values = (0..mask.len())
        .map(|k| mask[region.on_page(k, page)])
        .collect();
    let width = region.size[0];
    (region, Plane { width, values }, reach as f32)
}

/// The shares of blocks of a region, and of what casts them. Lengths are in px of the picture.
pub(super) struct Search {
    /// Pixels along the side of a block.
    side: usize,
    caster: Plane,
    /// The share of each block that is not explained yet, where it is seen, and how much it counts.
    shares: Vec<(usize, f32, f32)>,
    /// From what casts them to the border of the region, px.
    reach: f32,
}

impl Search {
    /// The search on so many blocks along the longer side of a region, if the share of any of them is seen. `share` is that of a pixel
    /// of the page, with the squared difference that the whole share makes.
    pub(super) fn of(
        (region, mask, reach): (&Region, &Plane, f32),
        (page, blocks): ([usize; 2], usize),
        share: impl Fn(usize) -> Option<(f32, f32)>,
    ) -> Option<Self> {
        let [width, height] = region.size;
        let side = width.max(height).div_ceil(blocks).max(1);
        let columns = width.div_ceil(side);
        let count = columns * height.div_ceil(side);
        let block = |k: usize| k / width / side * columns + k % width / side;
        let mut casts = vec![(0.0_f32, 0.0_f32); count];
        for (k, cast) in mask.values.iter().enumerate() {
            let (sum, pixels) = &mut casts[block(k)];
            *sum += cast;
            *pixels += 1.0;
        }
        // A block counts where all of its pixels are seen.
        let mut sums = vec![(0.0_f32, 0.0_f32, 0.0_f32); count];
        for (k, i) in region.pixels(page) {
            if let Some((share, contrast2)) = share(i) {
                let (sum, weight, seen) = &mut sums[block(k)];
                *sum += share;
                *weight += contrast2;
                *seen += 1.0;
            }
        }
        let all = sums.into_iter().zip(&casts).enumerate();
        let whole = all.filter(|(_, ((.., seen), (_, pixels)))| seen == pixels);
        let known = whole.map(|(block, ((share, weight, seen), _))| (block, share / seen, weight));
        let known: Vec<(usize, f32, f32)> = known.collect();
        let is_shaded = known.iter().any(|(_, share, _)| *share > 0.0);
        is_shaded.then(|| Self {
            side,
            caster: Plane {
                width: columns,
                values: casts.iter().map(|(sum, pixels)| sum / pixels).collect(),
            },
            shares: known,
            reach,
        })
    }

    /// The squared error that no cast explains yet, summed over pixels and channels.
    pub(super) fn error(&self) -> f32 {
        let errors = self
            .shares
            .iter()
            .map(|(_, share, weight)| weight * share * share);
        errors.sum()
    }

    /// The cast that leaves the least error.
    pub(super) fn best(&self) -> Option<Cast> {
        let mut best: Option<(f32, Cast)> = None;
        let mut ratio = BLUR_STEP;
        let blurs = BLURS
            .iter()
            .filter(|blur| **blur <= BLUR_OF_REACH * self.reach);
        let mut blurs: Vec<f32> = blurs.map(|blur| blur / self.side as f32).collect();
        // Coarse ones first, and then ever finer ones beside the best.
        for _ in 0..REFINEMENTS {
            // Each blur is tried from the best shift so far, as the shift hardly depends on the blur.
            for blur in blurs {
                let soft = blurred(self.caster.clone(), blur);
                let (from, step) = best
                    .as_ref()
                    .map_or(([0.0; 2], SHIFT_STEP), |(_, cast)| (cast.shift, NEXT_STEP));
                let (error, shift, opacity) = self.placed(&soft, from, step);
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
        for (i, share, _) in &mut self.shares {
            *share -= cast.opacity * at(&soft, *i, shift);
        }
    }

    /// The least error of a blurred shape, near this shift, with the shift and the opacity there. In blocks.
    fn placed(&self, soft: &Plane, from: [f32; 2], step: f64) -> (f32, [f32; 2], f32) {
        let farthest = SHIFT_OF_REACH * self.reach / self.side as f32;
        let cost = |shift: [f32; 2]| {
            if math::hypot(shift[0], shift[1]) > farthest {
                return (f64::INFINITY, 0.0);
            }
            let (mut both, mut own, mut all) = (0.0, 0.0, 0.0);
            for &(i, share, weight) in &self.shares {
                let covered = at(soft, i, shift);
                both += weight * share * covered;
                own += weight * covered * covered;
                all += weight * share * share;
            }
            // For a given shape the error Σ w·(share − α·covered)² is least at α = Σ w·share·covered / Σ w·covered².
            let opacity = (both / own.max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
            (
                // all − 2α·both + α²·own
                f64::from(all - opacity * (2.0 * both - opacity * own)),
                opacity,
            )
        };
        let shift = math::search(from.map(f64::from), step, SHIFT_FINEST, |shift| {
            cost(shift.map(|px| px as f32)).0
        });
        let shift = shift.map(|px| px as f32);
        let (error, opacity) = cost(shift);
        (error as f32, shift, opacity)
    }
}

/// The value of a plane that was moved by `shift`, at its block `i`: between four blocks.
pub(super) fn at(plane: &Plane, i: usize, shift: [f32; 2]) -> f32 {
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
