//! Mixtures: how much of a pixel belongs to which of the colours beside it.

use rayon::prelude::*;

use super::super::areas::{LEVEL, Pixel, Pixels, away, distance2, mix};
use super::colors::{Colors, NONE};
use crate::math::median;

/// A pixel as two colours side by side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mixture {
    /// The label of the larger share.
    pub(super) own: u16,
    /// The label of the smaller one; the same if there is only one.
    pub(super) other: u16,
    /// The smaller share, 0 to ½.
    pub(super) share: f32,
    /// The squared error of the mixture.
    pub(super) error: f32,
}

impl Mixture {
    /// A pixel of one colour.
    pub(super) fn pure(label: u16) -> Self {
        Self {
            own: label,
            other: label,
            share: 0.0,
            error: 0.0,
        }
    }
}

/// Root of the squared error over which neither a colour nor a mixture of two explains a pixel, levels. A guess.
const UNEXPLAINED: f32 = 26.0;

/// All pixels as mixtures of the colours beside them. Colours that nothing explains are added.
pub(super) fn mixtures(colors: &mut Colors<'_>, labels: &mut [u16]) -> Vec<Mixture> {
    let all = (0..labels.len()).into_par_iter();
    let mut mixtures: Vec<Mixture> = all.map(|i| mixture(colors, labels, i)).collect();
    let limit = (UNEXPLAINED * LEVEL) * (UNEXPLAINED * LEVEL);
    let unexplained = |mixtures: &[Mixture], i: usize| mixtures[i].error > limit;
    let mut bad: Vec<usize> = (0..labels.len())
        .filter(|&i| unexplained(&mixtures, i))
        .collect();
    for _ in 0..MOST_THIN {
        let Some(color) = thin_color(colors, &mixtures, &bad) else {
            break;
        };
        colors.list.push(color);
        let label = colors.list.len() as u16;
        for &i in &bad {
            if away(&colors.pixels.target.at(i), &color) <= NEAR * LEVEL {
                labels[i] = label;
            }
        }
        let again: Vec<Mixture> = bad
            .par_iter()
            .map(|&i| mixture(colors, labels, i))
            .collect();
        let found = bad.iter().zip(again);
        found.for_each(|(&i, found)| mixtures[i] = found);
        bad.retain(|&i| unexplained(&mixtures, i));
    }
    // Pixels around thin things were mixed without their colours.
    let again: Vec<Mixture> = (0..labels.len())
        .into_par_iter()
        .map(|i| match labels[i] {
            NONE => mixture(colors, labels, i),
            label => Mixture::pure(label),
        })
        .collect();
    again
}

/// Most colours of thin things. A guess.
const MOST_THIN: usize = 24;
/// Pixels this near to the colour of a thin thing are part of it, levels. A guess.
const NEAR: f32 = 16.0;

/// The colour that most unexplained pixels are like, if it is a new one.
fn thin_color(colors: &Colors<'_>, mixtures: &[Mixture], bad: &[usize]) -> Option<Pixel> {
    if bad.len() < 6 {
        return None;
    }
    let target = |i: usize| colors.pixels.target.at(i);
    let sample: Vec<Pixel> = bad
        .iter()
        .step_by(bad.len().div_ceil(2000))
        .map(|&i| target(i))
        .collect();
    // Candidates are those with the largest errors.
    let mut errors: Vec<f32> = bad.iter().map(|&i| mixtures[i].error).collect();
    let at = errors.len() * 4 / 5;
    let (_, &mut large, _) = errors.select_nth_unstable_by(at, f32::total_cmp);
    let worst: Vec<Pixel> = bad
        .iter()
        .filter(|&&i| mixtures[i].error >= large)
        .map(|&i| target(i))
        .collect();
    let votes = |color: &Pixel, reach: f32| {
        let near = sample.iter().filter(|p| away(p, color) < reach * LEVEL);
        near.count()
    };
    let candidates = worst.iter().step_by(worst.len().div_ceil(200));
    let voted = candidates.map(|color| (votes(color, 1.5 * NEAR), color));
    // The first of equals.
    let (count, &color) = voted.fold(None, |best: Option<(usize, &Pixel)>, found| match best {
        Some(best) if best.0 >= found.0 => Some(best),
        _ => Some(found),
    })?;
    if count < 5 {
        return None;
    }
    let near: Vec<&Pixel> = sample
        .iter()
        .filter(|p| away(p, &color) < NEAR * LEVEL)
        .collect();
    let usual = match near.len() {
        ..3 => color,
        _ => std::array::from_fn(|k| median(near.iter().map(|p| p[k])).unwrap_or(color[k])),
    };
    let distance = |color: &Pixel| {
        let all = colors.list.iter().map(|c| away(c, color));
        all.fold(f32::INFINITY, f32::min)
    };
    let is_room = colors.list.len() + 2 < usize::from(NONE);
    if is_room && distance(&usual) > NEAR * LEVEL {
        Some(usual)
    } else {
        (is_room && distance(&color) > 0.75 * NEAR * LEVEL).then_some(color)
    }
}

/// Pixel `i` as a mixture of the labels around it.
fn mixture(colors: &Colors<'_>, labels: &[u16], i: usize) -> Mixture {
    if labels[i] != NONE {
        return Mixture::pure(labels[i]);
    }
    let mut near = Vec::new();
    for reach in 2..=4 {
        near = labels_around(colors.pixels, labels, i, reach);
        if near.len() > 1 {
            break;
        }
    }
    best_mixture(colors, &near, i)
}

fn labels_around(pixels: &Pixels<'_>, labels: &[u16], i: usize, reach: usize) -> Vec<u16> {
    let mut found = Vec::new();
    for k in pixels.around(i, reach) {
        if labels[k] != NONE && !found.contains(&labels[k]) {
            found.push(labels[k]);
        }
    }
    found
}

/// The mixture of at most two of the labels `near` that explains pixel `i` best.
pub(super) fn best_mixture(colors: &Colors<'_>, near: &[u16], i: usize) -> Mixture {
    // Two colours explain anything better than one.
    const BIAS: f32 = 4.0 * LEVEL * LEVEL;
    let target = colors.pixels.target.at(i);
    let mut best = Mixture {
        own: near.first().copied().unwrap_or_default(),
        other: near.first().copied().unwrap_or_default(),
        share: 0.0,
        error: f32::INFINITY,
    };
    let mut least = f32::INFINITY;
    for (n, &own) in near.iter().enumerate() {
        let color = colors.at(own, i);
        let error = distance2(&target, &color);
        if error + BIAS < least {
            least = error + BIAS;
            best = Mixture {
                error,
                ..Mixture::pure(own)
            };
        }
        for &other in &near[n + 1..] {
            let (share, error) = mixed(&target, &color, &colors.at(other, i));
            if error + 2.0 * BIAS < least {
                least = error + 2.0 * BIAS;
                best = Mixture {
                    own,
                    other,
                    share,
                    error,
                };
            }
        }
    }
    if best.share > 0.5 {
        (best.own, best.other) = (best.other, best.own);
        best.share = 1.0 - best.share;
    }
    best
}

/// The share of `b` in the mixture of `a` and `b` that is nearest to `pixel`, and its squared error.
pub(super) fn mixed(pixel: &Pixel, a: &Pixel, b: &Pixel) -> (f32, f32) {
    let (mut along, mut length2) = (0.0, 1e-9);
    for k in 0..6 {
        along += (pixel[k] - a[k]) * (b[k] - a[k]);
        length2 += (b[k] - a[k]) * (b[k] - a[k]);
    }
    let share = (along / length2).clamp(0.0, 1.0);
    (share, distance2(pixel, &mix(a, b, share)))
}
