//! Shared widths and colours: nearly equal strokes of a drawing of lines get one width and one colour, as if drawn with one
//! pen, so that an editor selects them together. Nearly opaque strokes become opaque.
//!
//! Widths and then colours are [merged](super::merge) until the sum of what this adds reaches a share of the drawing's
//! squared error. Shared numbers stay shared while the strokes settle.

use std::ops::Range;

use super::merge::{CONTRAST, Group, Rule, merge, outline};
use super::preferences::preferences;
use super::width_grid::WidthGrid;
use crate::fit::config::{Colors, Config};
use crate::fit::descent::ties::Ties;
use crate::fit::drawing::Drawing;
use crate::fit::edits::{Change, Edit, TRIALS, apply_priced};
use crate::math;
use crate::render::{STYLE, StrokeMut, Strokes};
use crate::scene::quantum;

/// Growth of the squared error that is allowed to each of three steps (opaque strokes, few widths, few colours), in units of that of
/// the drawing, before the drawing is settled. A guess, as are the other numbers.
const ERROR: f64 = 0.1;
/// The least opacity of a stroke that may become opaque. Less is meant to let through what is behind.
const NEARLY_OPAQUE: f32 = 0.8;
/// Share of a stroke that lies on other strokes rather than on the page.
const OFF_PAGE: f32 = 0.1;
/// A stroke of a smaller radius, px, covers few pixels in full, so that width and opacity look alike.
const THIN: f32 = 1.0;

/// Proposes edits that add at most this squared error, estimated in advance.
type Step = fn(&mut Drawing, f32) -> Vec<Edit>;

/// Makes strokes of a drawing that was traced opaque, and share widths and colours unless these are given. Returns
/// the ties that keep them so. All strokes must be free.
pub(super) fn run(drawing: &mut Drawing, config: &Config) -> Ties {
    let mut ties = Ties::default();
    if !drawing.is_of_lines() {
        return ties;
    }
    let (any_color, any_width) = (config.colors == Colors::Free, config.pens.is_none());
    // Each step, the numbers of a style that it changes, and whether it is allowed.
    let steps: [(Step, Range<usize>, bool); 3] = [
        (opaque, 4..5, any_color && any_width),
        (shared_widths, 0..1, any_width),
        (shared_colors, 1..4, any_color),
    ];
    for (step, numbers, _) in steps.into_iter().filter(|(_, _, is_allowed)| *is_allowed) {
        // Measured anew before each step, since every step adds some of its own.
        let values = (3 * drawing.pixels()) as f64;
        let allowance = (ERROR * drawing.mse() * values) as f32;
        let mut edits = step(drawing, allowance);
        // Divided equally among the edits; a trial of several compares what they add with the sum of their parts.
        let each = allowance / edits.len() as f32;
        edits.iter_mut().for_each(|edit| edit.price = each);
        for edit in apply_priced(drawing, edits, TRIALS).made {
            for number in numbers.clone() {
                let places = edit.changes.iter();
                let places = places.map(|(i, _)| drawing.free().range(*i).end - STYLE + number);
                ties.tie(places.collect());
            }
        }
    }
    ties
}

/// The edit of these strokes that gives each this style.
fn restyled(strokes: &Strokes, members: &[usize], style: impl Fn(StrokeMut<'_>)) -> Edit {
    let change = |&i: &usize| {
        let mut one = Strokes::from_iter([strokes.get(i)]);
        one.change(|_, stroke| style(stroke));
        (i, Change::Marks(vec![one.get(0).to_mark()]))
    };
    Edit {
        changes: members.iter().map(change).collect(),
        gain: 0.0,
        price: 0.0,
        growth: 0,
        is_tried: true,
    }
}

/// Makes nearly opaque strokes opaque. A thin one gets thinner by as much, so that it has as much ink; a wider one gets
/// the colour that it has on the page.
fn opaque(drawing: &mut Drawing, allowance: f32) -> Vec<Edit> {
    let shown = preferences(drawing, 0.0);
    let strokes = drawing.free().iter().zip(&shown).enumerate();
    let mut costs: Vec<(f32, usize)> = strokes
        .filter(|(_, (stroke, _))| stroke.opacity() >= NEARLY_OPAQUE)
        .map(|(i, (stroke, shown))| {
            let clear = 1.0 - stroke.opacity();
            // With opacity α, opaque paint changes a pixel by (1 − α) of its contrast, and the squared error by its square.
            (OFF_PAGE * shown.weight * math::powi(clear, 2), i)
        })
        .collect();
    // The cheapest ones, for as much error as is allowed.
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = allowance;
    let affordable = costs.into_iter().take_while(|(cost, _)| {
        left -= cost;
        left >= 0.0
    });
    // As much ink as before, or the colour that it has on the page.
    let (bounds, page) = (drawing.bounds, drawing.background());
    let becomes = |stroke: StrokeMut<'_>| {
        let is_area = stroke.is_area;
        let [radius, color @ .., opacity] = &mut *stroke.style;
        if *radius < THIN && !is_area {
            // Width · opacity is the ink of a line thinner than a pixel or two.
            *radius *= *opacity;
        } else if let Some(page) = page {
            let mixed = color.iter_mut().zip(page);
            mixed.for_each(|(c, page)| *c = page + *opacity * (*c - page));
        }
        *opacity = 1.0;
        bounds.apply(stroke);
    };
    let edit = |(_, i)| restyled(drawing.free(), &[i], becomes);
    affordable.map(edit).collect()
}

/// Merges neighbours in the order of widths: a width between two others is cheaper to merge with one of them than they are
/// with each other.
fn shared_widths(drawing: &mut Drawing, allowance: f32) -> Vec<Edit> {
    let strokes = drawing.free().iter().enumerate();
    let mut groups: Vec<Group> = strokes
        .filter(|(_, stroke)| !stroke.is_area())
        .map(|(i, stroke)| Group {
            members: vec![i],
            color: [0.0; 3],
            color_weight: 0.0,
            radius: stroke.radius(),
            radius_weight: CONTRAST * outline(stroke),
        })
        .collect();
    // With a reach of one neighbour, the queue has a pair per group instead of a pair per two groups.
    groups.sort_by(|a, b| a.radius.total_cmp(&b.radius));
    let groups = merge(groups, rule(allowance, 1), |_, _| true);
    shared(drawing, &groups, |group, stroke| {
        stroke.style[0] = group.radius
    })
}

fn shared_colors(drawing: &mut Drawing, allowance: f32) -> Vec<Edit> {
    let shown = preferences(drawing, 0.0);
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
    shared(drawing, &groups, |group, mut stroke| {
        stroke.color_mut().copy_from_slice(&group.color);
    })
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

/// An edit for each group of several strokes, which get `what` they share.
fn shared(drawing: &Drawing, groups: &[Group], what: fn(&Group, StrokeMut<'_>)) -> Vec<Edit> {
    let groups = groups.iter().filter(|group| group.members.len() > 1);
    let edit =
        |group: &Group| restyled(drawing.free(), &group.members, |stroke| what(group, stroke));
    groups.map(edit).collect()
}
