//! Few pens: opaque strokes that look nearly alike get one look, and the rest is fitted to that.
//!
//! The smallest form of a file has one path for all strokes of a pen (colour and width) that may be drawn one after
//! the other. The pairs that cost least are given one pen, as long as no stroke has to be drawn between them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f32::consts::TAU;
use std::ops::Range;

use super::anneal::Anneal;
use super::control::Control;
use super::descent::{Descent, MIN_RADIUS};
use super::drawing::Drawing;
use super::palette::without_color;
use super::recipe::{Rates, Recipe};
use super::rounds::Rounds;
use crate::render::{AX, AY, BX, BY, OPACITY, Params, RADIUS, RED, unpack};
use crate::scene::{Rgb, Written, color, quantum};

/// Pens per opaque stroke. Fewer pens make fewer bytes and cost fidelity: 600 strokes on seven samples take 41 to
/// 50 bytes each. Of equal bytes (24,000 on the same), 0.6 makes 0.1 to 1 dB less, 0.8 from 0.7 dB less to 0.1
/// more, and 1.0 from 0.8 dB less to 0.3 more.
const PENS: f64 = 0.7;
/// Each width that a pen may have is this many times the one before.
const LADDER: f32 = 1.2;
/// Squared contrast at the edge of a typical stroke, summed over the channels: what a px of wrong radius costs for
/// each px of edge.
const EDGE: f32 = 0.02;
/// Strokes that may share pens: their pairs are all compared.
const WINDOW: usize = 1024;
/// Rounds of fitting places to pens and colours of pens to places.
pub(super) const ROUNDS: Rounds = Rounds {
    count: 8,
    iterations: 0.2,
    rate: 0.1,
};
/// Share of its Newton step that a colour takes: those under and over it take theirs as well.
const DAMPING: f32 = 0.7;

/// Makes the strokes of each stage of `drawing` share pens, with one another's very colours if they `keep_colors`.
/// All strokes must be free.
pub(super) fn run(
    drawing: &mut Drawing,
    keep_colors: bool,
    recipe: &Recipe,
    anneal: Anneal,
    control: &mut Control<'_>,
) {
    let mut pens = hand_out(drawing, keep_colors);
    let rates = without_pen(recipe.polish_rates);
    for round in 0..ROUNDS.count {
        let descent = Descent::new(drawing.free(), rates, drawing.limits);
        ROUNDS.descend(round, drawing, descent, recipe, anneal, control);
        if round + 1 == ROUNDS.count {
            // Where strokes have come between those of a pen, others are to share one: most drawings get up to 6 %
            // shorter by that, as faithful as before.
            pens = hand_out(drawing, keep_colors);
        }
        if !keep_colors {
            tint(drawing, &pens);
        }
    }
}

/// Gives the strokes few pens, and says which share each.
fn hand_out(drawing: &mut Drawing, keep_colors: bool) -> Vec<Vec<usize>> {
    let weights: Vec<f32> = drawing.wishes(0.0).iter().map(|w| w.weight).collect();
    let mut strokes = drawing.free().to_vec();
    let mut pens = Vec::new();
    for window in windows(&drawing.stage_sizes()) {
        let shared = share(
            &mut strokes[window.clone()],
            &weights[window.clone()],
            keep_colors,
        );
        let of_drawing = |pen: Vec<usize>| pen.iter().map(|i| i + window.start).collect();
        pens.extend(shared.into_iter().map(of_drawing));
    }
    drawing.set_free(&strokes);
    pens
}

/// The ranges of strokes that may share pens.
fn windows(stage_sizes: &[usize]) -> Vec<Range<usize>> {
    let mut windows = Vec::new();
    let mut start = 0;
    for size in stage_sizes {
        let end = start + size;
        windows.extend(
            (start..end)
                .step_by(WINDOW)
                .map(|at| at..(at + WINDOW).min(end)),
        );
        start = end;
    }
    windows
}

/// Gives each pen the mean of the colours that its strokes would like to have.
fn tint(drawing: &mut Drawing, pens: &[Vec<usize>]) {
    let mut wishes = drawing.wishes(DAMPING);
    for pen in pens {
        let weight: f32 = pen.iter().map(|&i| wishes[i].weight).sum();
        let mean = [0, 1, 2].map(|c| {
            let sum: f32 = pen
                .iter()
                .map(|&i| wishes[i].weight * wishes[i].color[c])
                .sum();
            sum / weight
        });
        if weight > 0.0 {
            let shared = color(mean.map(quantum));
            pen.iter().for_each(|&i| wishes[i].color = shared);
        }
    }
    let colors: Vec<Rgb> = wishes.iter().map(|wish| wish.color).collect();
    drawing.set_colors(&colors);
}

/// Rates that leave colours and widths as they are.
pub(super) fn without_pen(rates: Rates) -> Rates {
    Rates {
        radius: 0.0,
        ..without_color(rates)
    }
}

/// Strokes of one pen.
#[derive(Debug, Clone)]
struct Pen {
    members: Vec<usize>,
    color: Rgb,
    /// How the squared error grows with the squared distance from the colour.
    area: f32,
    radius: f32,
    /// Length of all outlines, px.
    edge: f32,
}

impl Pen {
    fn new(i: usize, p: &Params, weight: f32) -> Self {
        Self {
            members: vec![i],
            color: [p[RED], p[RED + 1], p[RED + 2]],
            area: weight,
            radius: rung(p[RADIUS]),
            edge: 2.0 * (p[BX] - p[AX]).hypot(p[BY] - p[AY]) + TAU * p[RADIUS],
        }
    }

    /// What one pen for the strokes of both adds to the squared error.
    fn cost(&self, other: &Self) -> f32 {
        let both = |a: f32, b: f32| a * b / (a + b).max(f32::MIN_POSITIVE);
        let away: f32 = (0..3)
            .map(|c| (self.color[c] - other.color[c]).powi(2))
            .sum();
        let wider = (self.radius - other.radius).powi(2);
        both(self.area, other.area) * away + EDGE * both(self.edge, other.edge) * wider
    }

    fn join(&mut self, other: Self) {
        let mean = |a: f32, b: f32, [wa, wb]: [f32; 2]| {
            (a * wa + b * wb) / (wa + wb).max(f32::MIN_POSITIVE)
        };
        let areas = [self.area, other.area];
        if self.color != other.color && areas != [0.0; 2] {
            self.color = [0, 1, 2].map(|c| mean(self.color[c], other.color[c], areas));
        }
        self.radius = rung(mean(self.radius, other.radius, [self.edge, other.edge]));
        self.area += other.area;
        self.edge += other.edge;
        self.members.extend(other.members);
    }
}

/// The nearest radius that a pen may have.
fn rung(radius: f32) -> f32 {
    let steps = (radius / MIN_RADIUS).max(1.0).ln() / LADDER.ln();
    MIN_RADIUS * LADDER.powf(steps.round())
}

/// Gives strokes of a window few pens, and says which share each.
fn share(strokes: &mut [Params], weights: &[f32], keep_colors: bool) -> Vec<Vec<usize>> {
    let mut order = Order::new(strokes);
    let pens = strokes.iter().zip(weights).enumerate();
    let mut pens: Vec<Option<Pen>> = pens.map(|(i, (p, &w))| Some(Pen::new(i, p, w))).collect();
    let may_share = |i: usize| strokes[i][OPACITY] == 1.0;
    let opaque: Vec<usize> = (0..strokes.len()).filter(|&i| may_share(i)).collect();
    let mut pairs = BinaryHeap::new();
    let put = |pairs: &mut BinaryHeap<_>, pens: &[Option<Pen>], i: usize, k: usize| {
        if let (Some(a), Some(b)) = (&pens[i], &pens[k])
            && (a.color == b.color || !keep_colors)
        {
            // Costs are not negative, so that their bits sort like their values.
            let members = (a.members.len(), b.members.len());
            pairs.push(Reverse((a.cost(b).to_bits(), i, k, members)));
        }
    };
    for (at, &i) in opaque.iter().enumerate() {
        opaque[at + 1..]
            .iter()
            .for_each(|&k| put(&mut pairs, &pens, i, k));
    }
    let mut excess = opaque.len() - (opaque.len() as f64 * PENS).ceil() as usize;
    while excess > 0
        && let Some(Reverse((_, i, k, members))) = pairs.pop()
    {
        let size =
            |pens: &[Option<Pen>], i: usize| pens[i].as_ref().map_or(0, |pen| pen.members.len());
        // Both have to be what they were when the cost was told.
        if (size(&pens, i), size(&pens, k)) != members || !order.may_join(i, k) {
            continue;
        }
        order.join(i, k);
        if let (Some(other), Some(pen)) = (pens[k].take(), pens[i].as_mut()) {
            pen.join(other);
        }
        excess -= 1;
        opaque
            .iter()
            .filter(|&&other| other != i)
            .for_each(|&other| put(&mut pairs, &pens, i.min(other), i.max(other)));
    }
    let draw_with = |pen: Pen| {
        for &i in &pen.members {
            let p = &mut strokes[i];
            p[RADIUS] = pen.radius;
            p[RED..OPACITY].copy_from_slice(&color(pen.color.map(quantum)));
        }
        pen.members
    };
    pens.into_iter().flatten().map(draw_with).collect()
}

/// Which strokes have to be drawn before which, those of one pen at once.
struct Order {
    /// For each stroke or pen, by its first stroke, a bit for each that comes later.
    later: Vec<Vec<u64>>,
    /// And for each that comes earlier.
    earlier: Vec<Vec<u64>>,
}

impl Order {
    fn new(strokes: &[Params]) -> Self {
        let count = strokes.len();
        // The decimals do not matter for what meets what.
        let written: Vec<_> = strokes
            .iter()
            .map(|p| Written::anywhere(&unpack(p), 2))
            .collect();
        let meet =
            |i: usize, k: usize| matches!((&written[i], &written[k]), (Ok(a), Ok(b)) if a.meets(b));
        let none = vec![0_u64; count.div_ceil(64)];
        let mut order = Self {
            later: vec![none.clone(); count],
            earlier: vec![none; count],
        };
        for i in (0..count).rev() {
            for k in (i + 1..count).filter(|&k| meet(i, k)) {
                let beyond = order.later[k].clone();
                unite(&mut order.later[i], &beyond);
                set(&mut order.later[i], k);
            }
        }
        for i in 0..count {
            for k in (i + 1..count).filter(|&k| is_set(&order.later[i], k)) {
                set(&mut order.earlier[k], i);
            }
        }
        order
    }

    /// Whether nothing has to be drawn between the two.
    fn may_join(&self, i: usize, k: usize) -> bool {
        let between = |from: usize, to: usize| {
            let bits = self.later[from].iter().zip(&self.earlier[to]);
            bits.fold(0, |any, (later, earlier)| any | (later & earlier)) != 0
        };
        !between(i, k) && !between(k, i)
    }

    /// Makes `k` a part of `i`.
    fn join(&mut self, i: usize, k: usize) {
        for of in [&mut self.later, &mut self.earlier] {
            let other = of[k].clone();
            unite(&mut of[i], &other);
            clear(&mut of[i], i);
            clear(&mut of[i], k);
        }
        let (later, earlier) = (self.later[i].clone(), self.earlier[i].clone());
        for j in 0..self.later.len() {
            clear(&mut self.later[j], k);
            clear(&mut self.earlier[j], k);
            if is_set(&earlier, j) {
                unite(&mut self.later[j], &later);
                set(&mut self.later[j], i);
            }
            if is_set(&later, j) {
                unite(&mut self.earlier[j], &earlier);
                set(&mut self.earlier[j], i);
            }
        }
    }
}

fn set(bits: &mut [u64], i: usize) {
    bits[i / 64] |= 1 << (i % 64);
}

fn clear(bits: &mut [u64], i: usize) {
    bits[i / 64] &= !(1 << (i % 64));
}

fn is_set(bits: &[u64], i: usize) -> bool {
    bits[i / 64] >> (i % 64) & 1 == 1
}

fn unite(bits: &mut [u64], others: &[u64]) {
    bits.iter_mut().zip(others).for_each(|(a, b)| *a |= b);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upright, at `x`, of a grey level.
    fn stroke(x: f32, level: f32) -> Params {
        [x, 10.0, x, 50.0, 2.0, level, level, level, 1.0]
    }

    fn levels(strokes: &[Params], keep_colors: bool) -> Vec<u8> {
        let mut strokes = strokes.to_vec();
        let worth = vec![100.0; strokes.len()];
        share(&mut strokes, &worth, keep_colors);
        strokes.iter().map(|p| quantum(p[RED])).collect()
    }

    #[test]
    fn strokes_that_look_alike_share_a_pen() {
        let strokes = [0.1, 0.5, 0.9, 0.52].map(|level| stroke(100.0 * level, level));
        let levels = levels(&strokes, false);
        assert_eq!((levels[1], levels[3]), (130, 130));
        assert_eq!((levels[0], levels[2]), (26, 230));
    }

    #[test]
    fn what_something_lies_between_does_not_share() {
        let strokes = [
            stroke(50.0, 0.5),
            stroke(51.0, 0.1),
            stroke(52.0, 0.52),
            stroke(90.0, 0.9),
        ];
        let levels = levels(&strokes, false);
        assert_ne!(levels[0], levels[2]);
    }

    #[test]
    fn colours_that_are_kept_are_kept() {
        let strokes = [0.1, 0.5, 0.9, 0.52].map(|level| stroke(100.0 * level, level));
        assert_eq!(levels(&strokes, true), [26, 128, 230, 133]);
    }

    #[test]
    fn widths_are_on_a_ladder() {
        assert_eq!(rung(MIN_RADIUS), MIN_RADIUS);
        assert!((rung(3.0) / 3.0 - 1.0).abs() < 0.06);
    }
}
