//! The stops of a shade along a given axis.

use super::{Between, Blocks, Group};
use crate::math::{Normal, Point};
use crate::scene::{Axis, Shade, ShadeStop};

/// Most stops of a gradient that is found.
const MOST: usize = 8;
/// One more stop has to remove this share of the squared error. A guess: eight stops at 0.1 against six at 0.15 are +0.10, +0.05, −0.65
/// and −0.03 dB and −0.9, −3.2, +6.6 and −1.4 % of bytes in four emoji.
const STOP_SHARE: f64 = 0.1;
/// Places along the axis that stops may have at first.
const PLACES: usize = 64;
/// Groups of blocks with similar offsets, whose means stand for them.
const GROUPS: usize = 256;
/// Squared error per block that is the rounding of the picture to 8 bit: nothing is gained below.
const ROUNDING: f64 = 4.0 / 12.0 / (255.0 * 255.0);
/// Pull on stops that no block is near, towards the mean of all. A guess.
const RIDGE: f64 = 1e-4;

/// The shade along `axis`.
pub(super) fn of(blocks: &Blocks, axis: Axis) -> Option<Shade> {
    // Greedy: start with a stop at either end, and add the stop that removes most error, as long as that pays.
    let profile = Profile::of(blocks, axis);
    let mut offsets = vec![0.0, 1.0];
    let mut error = profile.error(&offsets);
    while offsets.len() < MOST && error >= ROUNDING * profile.count {
        // Try one more stop at each of the even places. For each, the best colours of all stops are a linear problem.
        let places = (1..PLACES).map(|i| i as f64 / PLACES as f64);
        let with = |place: f64| {
            let mut more = offsets.clone();
            let at = more.partition_point(|&offset| offset < place);
            more.insert(at, place);
            more
        };
        let is_new = |place: &f64| offsets.iter().all(|offset| (offset - place).abs() > 1e-3);
        let tried = places
            .filter(is_new)
            .map(|place| (profile.error(&with(place)), place));
        let Some((_, place)) = tried.min_by(|(a, _), (b, _)| a.total_cmp(b)) else {
            break;
        };
        // Let all inner stops move before judging: the new one changes where the others are best.
        let (moved, found) = profile.moved(with(place));
        if error - found < STOP_SHARE * error {
            break;
        }
        (offsets, error) = (moved, found);
    }
    let stops = profile.stops(&offsets);
    trimmed(axis, stops)
}

/// The shade as it is written: without stops that say the same as their neighbours at the ends, on an axis that ends where they do.
fn trimmed(axis: Axis, mut stops: Vec<ShadeStop>) -> Option<Shade> {
    let alike = |a: &ShadeStop, b: &ShadeStop| {
        let near = |a: f32, b: f32| (a - b).abs() < 0.5 / 255.0;
        let clear = |stop: &ShadeStop| near(stop.opacity, 0.0);
        let colors = a.color.iter().zip(b.color);
        (clear(a) && clear(b))
            || near(a.opacity, b.opacity) && colors.into_iter().all(|(&a, b)| near(a, b))
    };
    // The last colour goes on for ever, so that a second one like it says nothing. So does the first one on a line, and not
    // at a centre.
    while let [.., a, b] = &stops[..] {
        if stops.len() < 3 || !alike(a, b) {
            break;
        }
        stops.pop();
    }
    let is_linear = matches!(axis, Axis::Linear { .. });
    while let [a, b, ..] = &stops[..] {
        if stops.len() < 3 || !is_linear || !alike(a, b) {
            break;
        }
        stops.remove(0);
    }
    // The axis ends where the stops do.
    let (first, last) = (stops.first()?.offset, stops.last()?.offset);
    let first = if is_linear { first } else { 0.0 };
    for stop in &mut stops {
        // Offsets count from the new start. The division may round a little beyond 1.
        stop.offset = ((stop.offset - first) / (last - first)).clamp(0.0, 1.0);
    }
    let axis = match axis {
        Axis::Linear { from, to } => {
            let at = |offset: f32| -> Point { from.lerp(to, offset.into()) };
            Axis::Linear {
                from: at(first),
                to: at(last),
            }
        }
        Axis::Radial { center, radius } => Axis::Radial {
            center,
            radius: radius * f64::from(last),
        },
    };
    Shade::new(axis, &stops).ok()
}

/// Values along an axis.
struct Profile {
    groups: Vec<Group>,
    /// All blocks.
    count: f64,
}

impl Profile {
    fn of(blocks: &Blocks, axis: Axis) -> Self {
        // A fit takes as long as there are groups, however many blocks there are.
        let groups = blocks.grouped(axis, GROUPS);
        Self {
            count: groups.iter().map(|group| group.count).sum(),
            groups,
        }
    }

    /// The best stops at these offsets.
    fn stops(&self, offsets: &[f64]) -> Vec<ShadeStop> {
        self.stops_seen(offsets, &self.places(offsets))
    }

    /// The place of each group between two offsets.
    fn places(&self, offsets: &[f64]) -> Vec<Between> {
        let place = |group: &Group| Between::of(offsets, group.offset);
        self.groups.iter().map(place).collect()
    }

    /// The best stops at these offsets, which the groups are between at these places. The opacity comes first: once it is
    /// fixed, premultiplied colours are linear in the stops' colours.
    fn stops_seen(&self, offsets: &[f64], places: &[Between]) -> Vec<ShadeStop> {
        let n = offsets.len();
        let opacity = self.fitted(n, places, |group, _| (1.0, group.value[3]));
        let opacity: Vec<f64> = opacity.iter().map(|v| v.clamp(0.0, 1.0)).collect();
        let channel = |c: usize| {
            // opacity · color = premultiplied value, with the opacity as the known factor.
            let of = |group: &Group, at: Between| (at.value(|i| opacity[i]), group.value[c]);
            self.fitted(n, places, of)
        };
        let colors = [channel(0), channel(1), channel(2)];
        let stop = |(i, &offset): (usize, &f64)| ShadeStop {
            offset: offset as f32,
            color: [0, 1, 2].map(|c: usize| colors[c][i].clamp(0.0, 1.0) as f32),
            opacity: opacity[i] as f32,
        };
        offsets.iter().enumerate().map(stop).collect()
    }

    /// The squared error of the best stops at these offsets.
    fn error(&self, offsets: &[f64]) -> f64 {
        let places = self.places(offsets);
        let stops = self.stops_seen(offsets, &places);
        let plane = |of: &dyn Fn(&ShadeStop) -> f32| -> Vec<f64> {
            stops.iter().map(|stop| f64::from(of(stop))).collect()
        };
        let colors = [0, 1, 2].map(|c: usize| plane(&|stop| stop.color[c]));
        let opacity = plane(&|stop| stop.opacity);
        let error = |(group, at): (&Group, &Between)| {
            // Colour and opacity are interpolated apart and multiplied afterwards, as SVG renderers do.
            let opacity = at.value(|i| opacity[i]);
            let channel = |c: usize| opacity * at.value(|i| colors[c][i]);
            let seen = [channel(0), channel(1), channel(2), opacity];
            let errors = seen.iter().zip(group.value).map(|(a, b)| (a - b) * (a - b));
            group.count * errors.sum::<f64>()
        };
        self.groups.iter().zip(&places).map(error).sum()
    }

    /// The offsets, each moved to where the error is least while its neighbours stay, and that error.
    fn moved(&self, mut offsets: Vec<f64>) -> (Vec<f64>, f64) {
        let mut least = self.error(&offsets);
        let mut step = 0.5 / PLACES as f64;
        while step > 5e-4 {
            // The ends stay: they are the ends of the axis.
            let inner = 1..offsets.len() - 1;
            for (i, step) in inner.flat_map(|i| [(i, step), (i, -step)]) {
                let mut tried = offsets.clone();
                tried[i] += step;
                // Stops keep their order and a small distance, so no two are in one place.
                if tried[i] <= tried[i - 1] + 2e-3 || tried[i] >= tried[i + 1] - 2e-3 {
                    continue;
                }
                let error = self.error(&tried);
                if error < least {
                    (offsets, least) = (tried, error);
                }
            }
            step /= 2.0;
        }
        (offsets, least)
    }

    /// Values at `n` offsets, linear between them, that are the least squares of `factor · value − wanted` over all blocks.
    /// `of` gives factor and wanted value of a group at its place.
    fn fitted(
        &self,
        n: usize,
        places: &[Between],
        of: impl Fn(&Group, Between) -> (f64, f64),
    ) -> Vec<f64> {
        let mut equations = Normal::of(n);
        let (mut weight, mut sum) = (1e-12, 0.0);
        for (group, &at) in self.groups.iter().zip(places) {
            let (factor, value) = of(group, at);
            let [from, to] = at.ends;
            let terms = [(from, factor * (1.0 - at.part)), (to, factor * at.part)];
            equations.add(&terms, [value], group.count);
            weight += group.count * factor * factor;
            sum += group.count * factor * value;
        }
        // A ridge towards the mean keeps the matrix positive definite where no group is near an offset.
        let (pull, mean) = (RIDGE * weight.max(1e-6), sum / weight);
        (0..n).for_each(|i| equations.add(&[(i, 1.0)], [mean], pull));
        let found = equations.solve().map(Vec::into_flattened);
        found.unwrap_or_else(|| vec![mean; n])
    }
}
