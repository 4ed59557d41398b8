//! Shared widths and colours: nearly equal strokes of a drawing of lines get one width and one colour, as if drawn with one
//! pen, so that an editor selects them together. Nearly opaque strokes become opaque.
//!
//! Widths and then colours are [merged](super::merge) until the sum of what this adds reaches a share of the drawing's
//! squared error. Shared numbers stay shared while the strokes settle.

use std::ops::Range;

use super::merge::{Group, Rule, merge, outline};
use super::preferences::preferences;
use super::width_grid::WidthGrid;
use crate::fit::config::{Colors, Config};
use crate::fit::descent::ties::Ties;
use crate::fit::drawing::Drawing;
use crate::fit::recipe::Recipe;
use crate::math;
use crate::render::STYLE;
use crate::scene::quantum;

/// Changes strokes for a squared error of at most this, as far as that can be told in advance, and ties what it has changed.
type Step = fn(&mut Drawing, &Recipe, f32) -> Ties;

/// Makes strokes of a drawing that was traced opaque, and share widths and colours, as far as these are not given. Returns
/// what is to stay so. All strokes must be free.
pub(super) fn run(drawing: &mut Drawing, config: &Config, recipe: &Recipe) -> Ties {
    let mut ties = Ties::default();
    if !drawing.is_of_lines(recipe) {
        return ties;
    }
    let (any_color, any_width) = (config.colors == Colors::Free, config.pens.is_none());
    let steps: [(Step, bool); 3] = [
        (make_opaque, any_color && any_width),
        (share_widths, any_width),
        (share_colors, any_color),
    ];
    for (step, _) in steps.into_iter().filter(|(_, is_allowed)| *is_allowed) {
        ties.extend(backtrack(drawing, recipe, step));
    }
    ties
}

/// Backtracking line search: takes a step that adds little squared error, as far as is allowed or, since strokes that
/// overlap add more than the sum of what each adds alone, less far.
fn backtrack(drawing: &mut Drawing, recipe: &Recipe, step: Step) -> Ties {
    let (before, error) = (drawing.memento(), drawing.mse());
    let values = (3 * drawing.pixels()) as f64;
    for trial in 0..recipe.sharing.trials {
        let allowance = recipe.sharing.error * error * values * math::powi(0.25, trial);
        let ties = step(drawing, recipe, allowance as f32);
        if drawing.mse() <= (1.0 + recipe.sharing.error) * error {
            return ties;
        }
        drawing.revert(before.clone());
    }
    Ties::default()
}

/// Makes nearly opaque strokes opaque. A thin one gets thinner by as much, so that it has as much ink; a wider one gets
/// the colour that it has on the page.
fn make_opaque(drawing: &mut Drawing, recipe: &Recipe, allowance: f32) -> Ties {
    let sharing = recipe.sharing;
    let shown = preferences(drawing, 0.0, recipe.coloring.min_shown);
    let strokes = drawing.free().iter().zip(&shown).enumerate();
    let mut costs: Vec<(f32, usize)> = strokes
        .filter(|(_, (stroke, _))| stroke.opacity() >= sharing.nearly_opaque)
        .map(|(i, (stroke, shown))| {
            let clear = 1.0 - stroke.opacity();
            (sharing.off_page * shown.weight * math::powi(clear, 2), i)
        })
        .collect();
    // The cheapest ones, for as much error as is allowed.
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = allowance;
    let affordable = costs.into_iter().take_while(|(cost, _)| {
        left -= cost;
        left >= 0.0
    });
    let mut becomes = vec![false; drawing.free().len()];
    affordable.for_each(|(_, i)| becomes[i] = true);
    // As much ink as before, or the colour that it has on the page.
    let (bounds, page) = (drawing.bounds, drawing.background());
    drawing.free_mut().change(|i, stroke| {
        let is_area = stroke.is_area;
        if becomes[i] {
            let [radius, color @ .., opacity] = stroke.style;
            if *radius < sharing.thin && !is_area {
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

/// Merges neighbours in the order of widths: a width between two others is cheaper to merge with one of them than they are
/// with each other.
fn share_widths(drawing: &mut Drawing, recipe: &Recipe, allowance: f32) -> Ties {
    let strokes = drawing.free().iter().enumerate();
    let mut groups: Vec<Group> = strokes
        .filter(|(_, stroke)| !stroke.is_area())
        .map(|(i, stroke)| Group {
            members: vec![i],
            color: [0.0; 3],
            color_weight: 0.0,
            radius: stroke.radius(),
            radius_weight: recipe.pens.contrast * outline(stroke),
        })
        .collect();
    groups.sort_by(|a, b| a.radius.total_cmp(&b.radius));
    let groups = merge(groups, rule(allowance, 1), |_, _| true);
    let radii = shared(&groups, drawing, |group| group.radius);
    drawing.free_mut().change(|i, stroke| {
        if let Some(radius) = radii[i] {
            stroke.style[0] = radius;
        }
    });
    tied(&groups, drawing, 0..1)
}

fn share_colors(drawing: &mut Drawing, recipe: &Recipe, allowance: f32) -> Ties {
    let shown = preferences(drawing, 0.0, recipe.coloring.min_shown);
    let mut groups: Vec<Group> = Vec::new();
    for (i, (stroke, shown)) in drawing.free().iter().zip(&shown).enumerate() {
        let group = Group {
            members: vec![i],
            color: stroke.color(),
            color_weight: shown.weight,
            radius: 0.0,
            radius_weight: 0.0,
        };
        // Colours that are equal in the file are merged first, so that few groups are compared.
        let alike = |other: &&mut Group| other.color.map(quantum) == group.color.map(quantum);
        match groups.iter_mut().find(alike) {
            Some(other) => other.join(group, WidthGrid::Any),
            None => groups.push(group),
        }
    }
    let groups = merge(groups, rule(allowance, usize::MAX), |_, _| true);
    let colors = shared(&groups, drawing, |group| group.color);
    drawing.free_mut().change(|i, mut stroke| {
        if let Some(color) = colors[i] {
            stroke.color_mut().copy_from_slice(&color);
        }
    });
    tied(&groups, drawing, 1..4)
}

/// Groups are merged for a squared error of at most `allowance`.
fn rule(allowance: f32, reach: usize) -> Rule<'static> {
    Rule {
        merges: usize::MAX,
        allowance,
        contrast: 1.0,
        keeps_colors: false,
        reach,
        grid: WidthGrid::Any,
    }
}

/// For each stroke that shares, `what` it shares with its group.
fn shared<T: Copy>(groups: &[Group], drawing: &Drawing, what: fn(&Group) -> T) -> Vec<Option<T>> {
    let mut shared = vec![None; drawing.free().len()];
    for group in groups.iter().filter(|group| group.members.len() > 1) {
        let members = group.members.iter();
        members.for_each(|&i| shared[i] = Some(what(group)));
    }
    shared
}

/// Ties these numbers of the style of each group's strokes.
fn tied(groups: &[Group], drawing: &Drawing, numbers: Range<usize>) -> Ties {
    let strokes = drawing.free();
    let mut ties = Ties::default();
    for (group, number) in groups
        .iter()
        .flat_map(|group| numbers.clone().map(move |number| (group, number)))
    {
        let place = |&i: &usize| strokes.range(i).end - STYLE + number;
        ties.tie(group.members.iter().map(place).collect());
    }
    ties
}
