//! Shared widths and colours: nearly equal strokes of a drawing of lines get one width and one colour, as if drawn with one
//! pen, so that an editor selects them together. Nearly opaque strokes become opaque.
//!
//! Greedy agglomeration: it merges, again and again, the two groups of strokes whose common width or colour adds the least
//! squared error, until the sum reaches a share of the drawing's error. Shared numbers stay shared while the strokes settle.

use std::f32::consts::TAU;
use std::ops::Range;

use super::preferences::preferences;
use crate::fit::config::Colors;
use crate::fit::drawing::Drawing;
use crate::fit::recipe::Recipe;
use crate::fit::session::Session;
use crate::fit::ties::Ties;
use crate::math;
use crate::render::{LOOK, StrokeRef};
use crate::scene::quantum;
use crate::svg::Form;

/// Most strokes that are compared for their colours; drawings of more are not of a few pens.
const MOST: usize = 600;

/// Most times that less is merged because too much was.
const TRIALS: i32 = 5;

/// The least opacity of a stroke that may become opaque. Less is meant to let through what is behind.
const NEARLY_OPAQUE: f32 = 0.8;

/// How much of a stroke, at a guess, lies on other strokes rather than on the page.
const OFF_PAGE: f32 = 0.1;

/// A stroke of a smaller radius, px, covers few pixels in full, so that width and opacity look alike.
const THIN: f32 = 1.0;

/// Changes strokes for a squared error of at most this, as far as that can be told in advance, and ties what it has changed.
type Step = fn(&mut Drawing, &Recipe, f32) -> Ties;

/// Makes strokes of a drawing that was traced opaque, and share widths and colours, as far as these are not given. All
/// strokes must be free.
pub(super) fn run(session: &mut Session<'_>) -> Ties {
    let (drawing, recipe) = (&mut session.drawing, &session.recipe);
    let mut ties = Ties::default();
    let is_of_lines = drawing.counters.traced_until > 0 && drawing.free().len() <= MOST;
    if !is_of_lines || session.config.file.form == Form::Smallest {
        return ties;
    }
    let (any_color, any_width) = (
        session.config.colors == Colors::Free,
        session.radii.is_empty(),
    );
    let steps: [(Step, bool); 3] = [
        (make_opaque, any_color && any_width),
        (share_widths, any_width),
        (share_colors, any_color),
    ];
    for (step, _) in steps.into_iter().filter(|(_, is_allowed)| *is_allowed) {
        ties.extend(carefully(drawing, recipe, step));
    }
    ties
}

/// Takes a step that adds little squared error: as far as is allowed, or less far, since strokes that overlap add more
/// than the sum of what each adds alone.
fn carefully(drawing: &mut Drawing, recipe: &Recipe, step: Step) -> Ties {
    let (before, error) = (drawing.memento(), drawing.mse());
    let values = (3 * drawing.pixels()) as f64;
    for trial in 0..TRIALS {
        let allowance = recipe.sharing.error * error * values * math::powi(0.25, trial);
        let ties = step(drawing, recipe, allowance as f32);
        if drawing.mse() <= (1.0 + recipe.sharing.error) * error {
            return ties;
        }
        drawing.revert(before.clone());
    }
    Ties::default()
}

/// Strokes that share a width or a colour.
#[derive(Debug, Clone)]
struct Group {
    members: Vec<usize>,
    /// The radius and two zeros, or the colour.
    mean: [f32; 3],
    /// Growth of the squared error with the squared distance from the mean.
    weight: f32,
}

impl Group {
    /// The squared error that one mean for both would add.
    fn cost(&self, other: &Self) -> f32 {
        let both = self.weight * other.weight / (self.weight + other.weight).max(f32::MIN_POSITIVE);
        let steps = self.mean.iter().zip(other.mean);
        both * steps.map(|(a, b)| (a - b) * (a - b)).sum::<f32>()
    }

    fn join(&mut self, other: Self) {
        let weight = self.weight + other.weight;
        if weight > 0.0 && self.mean != other.mean {
            let mean = self.mean.iter_mut().zip(other.mean);
            mean.for_each(|(a, b)| *a = (*a * self.weight + b * other.weight) / weight);
        }
        self.weight = weight;
        self.members.extend(other.members);
    }
}

/// Makes nearly opaque strokes opaque. A thin one gets thinner by as much, so that it has as much ink; a wider one gets
/// the colour that it has on the page.
fn make_opaque(drawing: &mut Drawing, recipe: &Recipe, allowance: f32) -> Ties {
    let shown = preferences(drawing, 0.0, recipe.coloring.min_shown);
    let strokes = drawing.free().iter().zip(&shown).enumerate();
    let mut costs: Vec<(f32, usize)> = strokes
        .filter(|(_, (stroke, _))| stroke.opacity() >= NEARLY_OPAQUE)
        .map(|(i, (stroke, shown))| {
            (
                OFF_PAGE * shown.weight * math::powi(1.0 - stroke.opacity(), 2),
                i,
            )
        })
        .collect();
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = allowance;
    let affordable = costs.into_iter().take_while(|(cost, _)| {
        left -= cost;
        left >= 0.0
    });
    let mut becomes = vec![false; drawing.free().len()];
    affordable.for_each(|(_, i)| becomes[i] = true);
    let (bounds, page) = (drawing.bounds, drawing.background());
    drawing.free_mut().change(|i, stroke| {
        if becomes[i] {
            let [radius, color @ .., opacity] = stroke.look;
            if *radius < THIN {
                *radius *= *opacity;
            } else if let Some(page) = page {
                let mixed = color.iter_mut().zip(page);
                mixed.for_each(|(c, page)| *c = page + *opacity * (*c - page));
            }
            *opacity = 1.0;
            bounds.apply(stroke);
        }
    });
    let mut ties = Ties::default();
    for i in (0..becomes.len()).filter(|&i| becomes[i]) {
        ties.fix(drawing.free().range(i).end - 1);
    }
    ties
}

fn share_widths(drawing: &mut Drawing, recipe: &Recipe, allowance: f32) -> Ties {
    let groups = widths(drawing, recipe.pens.contrast, allowance);
    let mean = means(&groups, drawing);
    drawing.free_mut().change(|i, stroke| {
        if let Some([radius, ..]) = mean[i] {
            stroke.look[0] = radius;
        }
    });
    tied(&groups, drawing, 0..1)
}

fn share_colors(drawing: &mut Drawing, recipe: &Recipe, allowance: f32) -> Ties {
    let groups = colors(drawing, recipe.coloring.min_shown, allowance);
    let mean = means(&groups, drawing);
    drawing.free_mut().change(|i, mut stroke| {
        if let Some(color) = mean[i] {
            stroke.color_mut().copy_from_slice(&color);
        }
    });
    tied(&groups, drawing, 1..4)
}

/// For each stroke, the mean of the group that it shares.
fn means(groups: &[Group], drawing: &Drawing) -> Vec<Option<[f32; 3]>> {
    let mut means = vec![None; drawing.free().len()];
    for group in groups.iter().filter(|group| group.members.len() > 1) {
        let members = group.members.iter();
        members.for_each(|&i| means[i] = Some(group.mean));
    }
    means
}

/// Ties these numbers of the look of each group's strokes.
fn tied(groups: &[Group], drawing: &Drawing, numbers: Range<usize>) -> Ties {
    let strokes = drawing.free();
    let mut ties = Ties::default();
    for (group, number) in groups
        .iter()
        .flat_map(|group| numbers.clone().map(move |number| (group, number)))
    {
        let place = |&i: &usize| strokes.range(i).end - LOOK + number;
        ties.tie(group.members.iter().map(place).collect());
    }
    ties
}

/// The strokes by their widths, merged for a squared error of at most `allowance`.
fn widths(drawing: &Drawing, contrast: f32, allowance: f32) -> Vec<Group> {
    let strokes = drawing.free().iter().enumerate();
    let mut groups: Vec<Group> = strokes
        .map(|(i, stroke)| Group {
            members: vec![i],
            mean: [stroke.radius(), 0.0, 0.0],
            weight: contrast * outline(stroke),
        })
        .collect();
    groups.sort_by(|a, b| a.mean[0].total_cmp(&b.mean[0]));
    let mut left = allowance;
    // Of numbers on a line, neighbours are the cheapest to merge.
    while let Some((cost, i)) = groups
        .windows(2)
        .enumerate()
        .map(|(i, pair)| (pair[0].cost(&pair[1]), i))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(cost, _)| *cost <= left)
    {
        left -= cost;
        let other = groups.remove(i + 1);
        groups[i].join(other);
    }
    groups
}

/// The strokes by their colours, merged for a squared error of at most `allowance`.
fn colors(drawing: &mut Drawing, min_shown: f32, allowance: f32) -> Vec<Group> {
    let shown = preferences(drawing, 0.0, min_shown);
    let mut groups: Vec<Group> = Vec::new();
    for (i, (stroke, shown)) in drawing.free().iter().zip(&shown).enumerate() {
        let group = Group {
            members: vec![i],
            mean: stroke.color(),
            weight: shown.weight,
        };
        // What is equal in the file is merged first, so that few groups are compared.
        let alike = |other: &&mut Group| other.mean.map(quantum) == group.mean.map(quantum);
        match groups.iter_mut().find(alike) {
            Some(other) => other.join(group),
            None => groups.push(group),
        }
    }
    let mut left = allowance;
    while let Some((cost, i, k)) = cheapest(&groups).filter(|(cost, ..)| *cost <= left) {
        left -= cost;
        let other = groups.remove(k);
        groups[i].join(other);
    }
    groups
}

/// The cost of the cheapest pair to merge, and its places.
fn cheapest(groups: &[Group]) -> Option<(f32, usize, usize)> {
    let pairs = groups.iter().enumerate().flat_map(|(i, group)| {
        let others = groups.iter().enumerate().skip(i + 1);
        others.map(move |(k, other)| (group.cost(other), i, k))
    });
    pairs.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Length of a stroke's outline, px.
fn outline(stroke: StrokeRef<'_>) -> f32 {
    2.0 * stroke.length() + TAU * stroke.radius()
}
