//! Shared styles: nearly equal opaque strokes come to share a pen, a colour and a width, and everything else is fitted to
//! that.
//!
//! The smallest form of a file has one path for all strokes of a pen that can be drawn directly one after the other. So
//! strokes are [merged](super::merge) only if no other one has to be drawn between them.

use std::ops::Range;

use super::merge::{CONTRAST, Group, Rule, merge, outline};
use super::preferences::{DAMPING, preferences, set_colors};
use super::rounds::{self, Rounds};
use super::width_grid::WidthGrid;
use crate::error::Result;
use crate::fit::config::Colors;
use crate::fit::drawing::Drawing;
use crate::fit::phase::polish::PENS_ITERATIONS;
use crate::fit::run::session::Session;
use crate::render::{StrokeRef, Strokes};
use crate::scene::{Bundles, Mark, Precedence, Rgb, color, quantized_anywhere, quantum};

/// Rounds of fitting positions to pens, and colours of pens to positions. Half, twice: count −0.06, −0.02 dB; rate −0.07, −0.07; the bytes change by at most 1.4 %.
pub(super) const ROUNDS: Rounds = Rounds {
    count: 8,
    iterations: PENS_ITERATIONS,
    rate: 0.1,
};
/// Pens per opaque stroke. Fewer pens make fewer bytes and cost fidelity: 600 strokes on seven samples take 41 to 50 bytes each. At
/// equal bytes (24,000 on the same), 0.6 has 0.1 to 1 dB less, 0.8 from 0.7 dB less to 0.1 more, and 1.0 from 0.8 dB less to 0.3
/// more.
const SHARE: f64 = 0.7;
/// Most strokes that may share pens with each other. The time grows with the square, as all pairs are compared.
const WINDOW: usize = 1024;

/// Makes the strokes of each stage share pens if the file has the smallest form, unless they are lines. Strokes
/// keep the colours of a palette.
/// All strokes must be free.
pub(super) fn run(session: &mut Session<'_>) -> Result<()> {
    if !session.hands_out_pens() {
        return Ok(());
    }
    let keeps_colors = session.config.colors != Colors::Free;
    let rates = session.recipe.polish.rates.without_color().without_radius();
    let radii = session.radii.clone();
    let grid = WidthGrid::of(&radii);
    let mut pens = hand_out(&mut session.drawing, keeps_colors, grid);
    for round in 0..ROUNDS.count {
        rounds::run(session, ROUNDS, round, rates)?;
        if round + 1 == ROUNDS.count {
            // Strokes may have moved between those of a pen, so that pens are chosen once more: most drawings get up
            // to 6 % shorter, with the same fidelity.
            pens = hand_out(&mut session.drawing, keeps_colors, grid);
        }
        if !keeps_colors {
            tint(&mut session.drawing, &pens);
        }
    }
    Ok(())
}

/// Chooses the pens of all strokes, and returns the strokes of each pen.
fn hand_out(drawing: &mut Drawing, keeps_colors: bool, grid: WidthGrid<'_>) -> Vec<Vec<usize>> {
    let preferences = preferences(drawing, 0.0);
    let weights: Vec<f32> = preferences.iter().map(|w| w.weight).collect();
    // Stages are layers of the file, so no pen goes across them. Windows bound the pairs that are compared.
    let windows = windows(&drawing.stage_sizes(), WINDOW);
    let strokes = drawing.free();
    let mut pens = Vec::new();
    for window in windows {
        let members: Strokes = window.clone().map(|i| strokes.get(i)).collect();
        let mut shared = share(&members, &weights[window.clone()], keeps_colors, grid);
        let of_drawing = |pen: &mut Group| pen.members.iter_mut().for_each(|i| *i += window.start);
        shared.iter_mut().for_each(of_drawing);
        pens.extend(shared);
    }
    draw_with(&pens, drawing.free_mut());
    pens.into_iter().map(|pen| pen.members).collect()
}

/// Gives the members of each pen its radius and colour.
fn draw_with(pens: &[Group], strokes: &mut Strokes) {
    let mut pen_of = vec![None; strokes.len()];
    for pen in pens {
        pen.members.iter().for_each(|&i| pen_of[i] = Some(pen));
    }
    strokes.change(|i, mut stroke| {
        if let Some(pen) = pen_of[i] {
            stroke.style[0] = pen.radius;
            let color = color(pen.color.map(quantum));
            stroke.color_mut().copy_from_slice(&color);
        }
    });
}

/// Ranges of at most `most` strokes of one stage, within which strokes may share pens.
fn windows(stage_sizes: &[usize], most: usize) -> Vec<Range<usize>> {
    let mut windows = Vec::new();
    let mut start = 0;
    for size in stage_sizes {
        let end = start + size;
        windows.extend(
            (start..end)
                .step_by(most)
                .map(|at| at..(at + most).min(end)),
        );
        start = end;
    }
    windows
}

/// Gives each pen the weighted mean of the colours that suit its strokes best.
fn tint(drawing: &mut Drawing, pens: &[Vec<usize>]) {
    let mut preferences = preferences(drawing, DAMPING);
    for pen in pens {
        let weight: f32 = pen.iter().map(|&i| preferences[i].weight).sum();
        let mean = [0, 1, 2].map(|c| {
            let sum: f32 = pen
                .iter()
                .map(|&i| preferences[i].weight * preferences[i].color[c])
                .sum();
            sum / weight
        });
        if weight > 0.0 {
            let shared = color(mean.map(quantum));
            pen.iter().for_each(|&i| preferences[i].color = shared);
        }
    }
    let colors: Vec<Rgb> = preferences
        .iter()
        .map(|preference| preference.color)
        .collect();
    set_colors(drawing, &colors);
}

/// Chooses the pens of the strokes of a window.
fn share(
    strokes: &Strokes,
    weights: &[f32],
    keeps_colors: bool,
    grid: WidthGrid<'_>,
) -> Vec<Group> {
    let pen = |(i, (stroke, &color_weight)): (usize, (StrokeRef<'_>, &f32))| Group {
        members: vec![i],
        color: stroke.color(),
        color_weight,
        radius: match stroke.is_area() {
            true => 0.0,
            false => grid.nearest(stroke.radius()),
        },
        radius_weight: outline(stroke),
    };
    let pens = strokes.iter().zip(weights).enumerate().map(pen);
    // Only opaque strokes may become parts of one element; an area is one by itself.
    let may_share = |pen: &Group| {
        let stroke = strokes.get(pen.members[0]);
        stroke.opacity() == 1.0 && !stroke.is_area()
    };
    let (opaque, mut others): (Vec<Group>, Vec<Group>) = pens.partition(may_share);
    // Merge down to a share of the strokes, whatever that costs: the fit that follows repairs it.
    let kept = (opaque.len() as f64 * SHARE).ceil() as usize;
    let rule = Rule {
        merges: opaque.len() - kept,
        allowance: f32::INFINITY,
        contrast: CONTRAST,
        keeps_colors,
        reach: usize::MAX,
        grid,
    };
    // A merge is refused where another stroke has to be drawn between the two.
    let mut bundles = bundles(strokes);
    others.extend(merge(opaque, rule, |i, k| bundles.try_join(i, k)));
    others
}

/// The strokes, each a bundle of its own.
fn bundles(strokes: &Strokes) -> Bundles {
    // Which strokes meet does not depend on the decimals.
    let written = strokes
        .iter()
        .map(|stroke| quantized_anywhere(&stroke.to_mark(), 2));
    let written: Vec<Option<Mark>> = written.collect();
    Bundles::new(&Precedence::of_shapes(written.iter().map(Option::as_ref)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upright, at `x`, of a grey level.
    fn stroke(x: f32, level: f32) -> [f32; 9] {
        [x, 10.0, x, 50.0, 2.0, level, level, level, 1.0]
    }

    fn levels(strokes: &[[f32; 9]], keep_colors: bool) -> Vec<u8> {
        let mut strokes: Strokes = strokes.iter().collect();
        let contribution = vec![100.0; strokes.len()];
        let grid = WidthGrid::of(&[]);
        let pens = share(&strokes, &contribution, keep_colors, grid);
        draw_with(&pens, &mut strokes);
        strokes.iter().map(|s| quantum(s.color()[0])).collect()
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
}
