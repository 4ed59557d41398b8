//! Noise: how far pixels are from the plane through their neighbours, in places that would be flat without it.

use rayon::prelude::*;

use super::cosine::SIDE;
use super::grid;
use super::planes::Planes;

/// Half the side of the window whose noise is measured, px.
const HALF: usize = 2;

/// Half the side of the window that may hold an edge, px: nine such windows cover it.
const REACH: usize = 6;

/// Ranges of luma whose noise is measured apart.
const TONES: usize = 16;

/// Most pixels that are looked at. A guess.
const MOST_SITES: usize = 250_000;
/// Largest range of the means of 5×5 px within 13×13 px where there is nothing but noise, levels. A guess.
const FAR_RANGE: f32 = 24.0;
/// Largest range of 5×5 px without an edge, levels. A guess.
const NEAR_RANGE: f32 = 32.0;
/// Least range of a block with an edge, levels. A guess.
pub(super) const EDGE_RANGE: f32 = 48.0;
/// Least share of pixels far from edges. Photographs of detail have 0.1 to 0.3, flat art 0.4 and more.
const LEAST_FAR: f32 = 0.3;
/// Least share of pixels beside edges. A guess.
const LEAST_NEAR: f32 = 0.001;
/// Least share of pixels of one tone. A guess.
const LEAST_TONE: f32 = 0.02;
/// Least noise, levels: less is not seen.
const LEAST: f32 = 0.6;
/// Most noise, levels: more is hatching.
const MOST: f32 = 25.0;
/// Largest ratio of the quartiles of noise. White noise has 1.3, such noise after JPEG 1.7, photographs 1.5 to 4.
const MOST_UNEVEN: f32 = 1.75;
/// Noise beside edges is larger by this than what is measured there as noise, since edges are in it.
const NEAR_IN_NOISE: f32 = 1.25;
/// Largest noise, upper quartile, of a picture that is clean far from edges, levels. JPEG of flat art has 0 to 0.3, photographs
/// 0.7 and more.
const CLEAN: f32 = 0.6;
/// Least noise in blocks with edges, levels, of which 0.7 have more, where no blocks of JPEG can be told: clean flat art has 0 to 0.5,
/// small text 0.74.
const LEAST_BESIDE: f32 = 0.8;

/// Noise of a picture, RMS in levels of luma.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Noise {
    /// Far from edges, in each of 16 ranges of luma.
    pub(super) far: [f32; TONES],
    /// Beside edges.
    pub(super) near: f32,
}

impl Noise {
    /// The noise at a luma, levels, far from edges.
    pub(super) fn at(&self, luma: f32) -> f32 {
        let place = (luma * TONES as f32 / 256.0 - 0.5).clamp(0.0, (TONES - 1) as f32);
        let first = (place as usize).min(TONES - 2);
        let share = place - first as f32;
        self.far[first] + share * (self.far[first + 1] - self.far[first])
    }

    /// The largest noise far from edges.
    pub(super) fn most(&self) -> f32 {
        self.far.iter().copied().fold(0.0, f32::max)
    }
}

/// The window around a pixel.
struct Site {
    luma: f32,
    /// RMS distance from the plane through the pixels of the window.
    deviation: f32,
    /// True if there is nothing but noise around.
    is_far: bool,
    /// True if the window is flat, and its block of JPEG has an edge.
    is_near: bool,
}

/// The noise of a picture, if there is some; `None` as well where texture cannot be told from it.
///
/// White noise has about the same deviation everywhere; texture has not. Where flat places are clean but those beside
/// edges are not, it is what compression or sharpening leaves there.
pub(super) fn measure(planes: &Planes) -> Option<Noise> {
    let grid = grid::offset(planes);
    let sites = sites(planes, grid.map(Option::unwrap_or_default));
    let count = sites.len();
    let far = |site: &&Site| site.is_far;
    let share = sites.iter().filter(far).count() as f32 / count.max(1) as f32;
    if share < LEAST_FAR {
        return None;
    }
    // What is measured far from edges, and in blocks with an edge.
    let far = sorted(sites.iter().filter(far));
    let near = sorted(sites.iter().filter(|site| site.is_near));
    let is_measured = near.len() as f32 > LEAST_NEAR * count as f32;
    let beside = |share| {
        if is_measured {
            quantile(&near, share)
        } else {
            0.0
        }
    };
    // The same noise everywhere: grain, of which edges have some more.
    let (tones, ratio) = tones(&sites);
    if (LEAST..MOST).contains(&quantile(&far, 0.5)) && ratio <= MOST_UNEVEN {
        return Some(Noise {
            far: filled(tones),
            near: beside(0.5) / NEAR_IN_NOISE,
        });
    }
    // Noise beside edges alone: compression.
    let is_clean = quantile(&far, 0.75) <= CLEAN;
    let has_blocks = grid.iter().all(Option::is_some);
    let is_compressed = has_blocks && beside(0.5) >= LEAST || beside(0.3) >= LEAST_BESIDE;
    (is_clean && is_compressed).then(|| Noise {
        far: [0.0; TONES],
        near: beside(0.5),
    })
}

/// The median deviation of the pixels around those that `counts`; 0 of none.
pub(super) fn median_deviation(planes: &Planes, counts: impl Fn(usize) -> bool + Sync) -> f32 {
    let (luma, width) = (&planes.planes[0], planes.width);
    let rows = HALF..planes.height.saturating_sub(HALF);
    let of_row = |y: usize| {
        let columns = HALF..width.saturating_sub(HALF);
        let counting = columns.filter(|x| counts(y * width + x));
        let deviation = |x: usize| {
            let row = |y: usize| &luma[y * width + x - HALF..=y * width + x + HALF];
            deviation((y - HALF..=y + HALF).map(row))
        };
        counting.map(deviation).collect::<Vec<_>>()
    };
    let mut all: Vec<f32> = rows.into_par_iter().flat_map_iter(of_row).collect();
    all.sort_unstable_by(f32::total_cmp);
    quantile(&all, 0.5)
}

/// The sites of a picture, of which blocks of JPEG begin at `grid`. Nothing is measured where it is not opaque.
fn sites(planes: &Planes, grid: [usize; 2]) -> Vec<Site> {
    let (width, height) = (planes.width, planes.height);
    if width <= 2 * REACH || height <= 2 * REACH {
        return Vec::new();
    }
    let step = (width * height).div_ceil(MOST_SITES).isqrt().max(1);
    let rows: Vec<usize> = (REACH..height - REACH).step_by(step).collect();
    let means = means(planes, step);
    let of_row = |&y: &usize| {
        let columns = (REACH..width - REACH).step_by(step);
        let opaque = columns.filter(|x| is_opaque(planes, [*x, y], HALF));
        opaque
            .map(|x| site(planes, &means, [x, y], grid))
            .collect::<Vec<_>>()
    };
    let sites: Vec<Vec<Site>> = rows.par_iter().map(of_row).collect();
    sites.into_iter().flatten().collect()
}

/// True if all pixels around one are opaque.
fn is_opaque(planes: &Planes, [x, y]: [usize; 2], reach: usize) -> bool {
    let row = |y: usize| y * planes.width + x - reach..=y * planes.width + x + reach;
    planes.alpha.is_none()
        || (y - reach..=y + reach)
            .flat_map(row)
            .all(|i| planes.is_opaque(i))
}

/// The mean of the window around each pixel that sites look at, of which one in `step` rows and columns is there; 0 elsewhere.
fn means(planes: &Planes, step: usize) -> Vec<f32> {
    // Sites look at the windows on both sides, too.
    let side = REACH - HALF;
    let is_seen = |at: &usize| {
        let before =
            |away: &usize| (at + away + 2 * side * step - REACH - side).is_multiple_of(step);
        [0, side, 2 * side].iter().any(before)
    };
    let (luma, width) = (&planes.planes[0], planes.width);
    let mut means = vec![0.0; luma.len()];
    let rows = means.par_chunks_exact_mut(width).enumerate();
    let inner = rows.filter(|(y, _)| (HALF..planes.height - HALF).contains(y) && is_seen(y));
    inner.for_each(|(y, row)| {
        let columns = row.iter_mut().enumerate().take(width - HALF).skip(HALF);
        for (x, mean) in columns.filter(|(x, _)| is_seen(x)) {
            let rows = (y - HALF..=y + HALF).flat_map(|y| &luma[y * width..][x - HALF..=x + HALF]);
            *mean = rows.sum::<f32>() / (2 * HALF + 1).pow(2) as f32;
        }
    });
    means
}

/// The site at a pixel. Blocks of JPEG begin at `grid`.
fn site(planes: &Planes, means: &[f32], [x, y]: [usize; 2], grid: [usize; 2]) -> Site {
    let (luma, width) = (&planes.planes[0], planes.width);
    let rows = |[x, y]: [usize; 2], side: usize| {
        (y..y + side).map(move |row| &luma[row * width + x..row * width + x + side])
    };
    let window = |[x, y]: [usize; 2]| rows([x - HALF, y - HALF], 2 * HALF + 1);
    let step = REACH - HALF;
    let around = [y - step, y, y + step]
        .into_iter()
        .flat_map(|y| [x - step, x, x + step].map(|x| means[y * width + x]));
    // The place in a block of JPEG.
    let place = [(x, grid[0]), (y, grid[1])].map(|(at, start)| (at + SIDE - start) % SIDE);
    // A window within a block.
    let is_within = place.iter().all(|at| (HALF..SIDE - HALF).contains(at));
    let is_flat = || range(window([x, y]).flatten().copied()) <= NEAR_RANGE;
    let has_edge = |block| range(rows(block, SIDE).flatten().copied()) >= EDGE_RANGE;
    Site {
        luma: luma[y * width + x],
        deviation: deviation(window([x, y])),
        is_far: range(around) <= FAR_RANGE && is_opaque(planes, [x, y], REACH),
        is_near: is_within && is_flat() && block(planes, [x, y], place).is_some_and(has_edge),
    }
}

/// The upper left pixel of the block in which a pixel has `place`, if the block is whole.
fn block(planes: &Planes, [x, y]: [usize; 2], place: [usize; 2]) -> Option<[usize; 2]> {
    let (left, top) = (x.checked_sub(place[0])?, y.checked_sub(place[1])?);
    let is_whole = left + SIDE <= planes.width && top + SIDE <= planes.height;
    is_whole.then_some([left, top])
}

/// The difference of the largest value and the least.
fn range(values: impl Iterator<Item = f32>) -> f32 {
    let [low, high] = values.fold([f32::MAX, f32::MIN], |[low, high], v| {
        [low.min(v), high.max(v)]
    });
    high - low
}

/// RMS distance of the values of a window from the plane through them.
fn deviation<'a>(rows: impl Iterator<Item = &'a [f32]>) -> f32 {
    let side = 2 * HALF + 1;
    let count = (side * side) as f32;
    // The sum of the squares of all places, across or down.
    let spread = (side * (1..=HALF).map(|k| 2 * k * k).sum::<usize>()) as f32;
    let [mut sum, mut squares, mut across, mut down] = [0.0; 4];
    let mut first = None;
    for (y, row) in rows.enumerate() {
        for (x, value) in row.iter().enumerate() {
            // Relative to one of them, so that nothing is lost to rounding.
            let value = value - *first.get_or_insert(*value);
            sum += value;
            squares += value * value;
            across += (x as f32 - HALF as f32) * value;
            down += (y as f32 - HALF as f32) * value;
        }
    }
    let rest = squares - sum * sum / count - (across * across + down * down) / spread;
    (rest.max(0.0) / (count - 3.0)).sqrt()
}

/// The noise of each tone that has enough far sites, and how uneven it is: the mean ratio of its upper to its lower quartile.
fn tones(sites: &[Site]) -> ([Option<f32>; TONES], f32) {
    let mut noises = [None; TONES];
    let [mut ratios, mut counts] = [0.0; 2];
    for (tone, noise) in noises.iter_mut().enumerate() {
        let is_of_tone =
            |site: &&Site| site.is_far && (site.luma as usize * TONES / 256).min(TONES - 1) == tone;
        let values = sorted(sites.iter().filter(is_of_tone));
        let count = values.len() as f32;
        if count > LEAST_TONE * sites.len() as f32 {
            let ratio = quantile(&values, 0.75) / quantile(&values, 0.25).max(0.1);
            ratios += count * ratio;
            counts += count;
            *noise = Some(quantile(&values, 0.5)).filter(|_| ratio <= MOST_UNEVEN);
        }
    }
    (noises, ratios / counts.max(1.0))
}

/// The noise of all tones: one that was not measured has that of the nearest one that was, the darker of two.
fn filled(tones: [Option<f32>; TONES]) -> [f32; TONES] {
    std::array::from_fn(|tone| {
        let measured = (0..TONES).filter_map(|k| Some((k.abs_diff(tone), tones[k]?)));
        measured
            .min_by_key(|(away, _)| *away)
            .map_or(0.0, |(_, noise)| noise)
    })
}

/// The deviations of sites, in order.
fn sorted<'a>(sites: impl Iterator<Item = &'a Site>) -> Vec<f32> {
    let mut values: Vec<f32> = sites.map(|site| site.deviation).collect();
    values.sort_unstable_by(f32::total_cmp);
    values
}

/// The value below which a share of sorted values lies; 0 of none.
fn quantile(values: &[f32], share: f32) -> f32 {
    let at = (share * values.len() as f32) as usize;
    values
        .get(at.min(values.len().saturating_sub(1)))
        .copied()
        .unwrap_or(0.0)
}
