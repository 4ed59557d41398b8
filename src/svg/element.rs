//! Elements of the SVG: which strokes share one, and which attributes neighbours share.

use std::collections::BTreeMap;

use super::arrange::look;
use super::dialect::{self, Unit};
use super::options::Form;
use super::{outline, path};
use crate::scene::Written;

/// Appends the elements of `strokes`, in the smallest form with numbers in `unit`.
pub(super) fn push(out: &mut String, strokes: &[Written], form: Form, unit: Unit) {
    match form {
        Form::Elements | Form::Plain => {
            for element in split(strokes, form) {
                push_path(out, element, &[], Style::Full);
                out.push('\n');
            }
        }
        Form::Smallest => {
            let width = usual_width(strokes, form);
            let style = Style::Short { width, unit };
            push_runs(out, &split(strokes, form), &[], style);
        }
        Form::Outlines => strokes.iter().for_each(|stroke| outline::push(out, stroke)),
    }
}

/// Bytes of an element of one stroke. In the smallest form, its width is assumed to be shared with neighbours.
pub(super) fn bytes(stroke: &Written, form: Form, unit: Unit) -> usize {
    let mut out = String::new();
    let alone = std::slice::from_ref(stroke);
    match form {
        Form::Smallest => {
            let style = Style::Short { width: None, unit };
            push_path(&mut out, alone, &[Attribute::Width], style);
        }
        form => push(&mut out, alone, form, unit),
    }
    out.len()
}

/// The attribute of a layer that holds the most common width of `strokes`, or nothing.
pub(super) fn layer_width(strokes: &[Written], form: Form, unit: Unit) -> String {
    usual_width(strokes, form).map_or_else(String::new, |width| width_text(width, unit))
}

fn width_text(width: i64, unit: Unit) -> String {
    let mut out = String::from(" stroke-width=\"");
    unit.push(&mut out, width);
    out + "\""
}

/// In the smallest form, the most common width, if more than one element has it.
fn usual_width(strokes: &[Written], form: Form) -> Option<i64> {
    let mut counts = BTreeMap::<i64, usize>::new();
    for element in split(strokes, form)
        .iter()
        .filter(|_| form == Form::Smallest)
    {
        *counts.entry(element[0].width).or_default() += 1;
    }
    let (width, count) = counts.into_iter().max_by_key(|&(_, count)| count)?;
    (count > 1).then_some(width)
}

/// Whether a stroke of the path begins at the end of the previous one.
pub(super) fn has_corner(strokes: &[Written], form: Form) -> bool {
    split(strokes, form)
        .iter()
        .any(|element| element.windows(2).any(|w| is_chain(&w[0], &w[1])))
}

/// The strokes of each element.
fn split(strokes: &[Written], form: Form) -> Vec<&[Written]> {
    let mut elements = Vec::new();
    let mut rest = strokes;
    while !rest.is_empty() {
        let joins = |&k: &usize| joins(&rest[..k], &rest[k], form);
        let length = 1 + (1..rest.len()).take_while(joins).count();
        let (element, later) = rest.split_at(length);
        elements.push(element);
        rest = later;
    }
    elements
}

/// Whether `next` can join the path of `strokes` without changing the picture.
fn joins(strokes: &[Written], next: &Written, form: Form) -> bool {
    let Some(last) = strokes.last().filter(|last| look(last) == look(next)) else {
        return false;
    };
    let opaque = next.opacity == u8::MAX;
    match form {
        Form::Plain => opaque && is_chain(last, next),
        Form::Smallest => opaque || !strokes.iter().any(|stroke| stroke.meets(next)),
        Form::Elements | Form::Outlines => false,
    }
}

/// Whether `next` begins where `last` ends.
fn is_chain(last: &Written, next: &Written) -> bool {
    let lines = [last, next].iter().all(|stroke| stroke.points.len() > 1);
    lines && last.points.last() == next.points.first()
}

/// An attribute that the strokes of a path have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Attribute {
    Color,
    Width,
    Opacity,
}

impl Attribute {
    const ALL: [Self; 3] = [Self::Color, Self::Width, Self::Opacity];

    /// The attribute as text after a space; nothing if it equals the default.
    fn text(self, stroke: &Written, style: Style) -> String {
        match self {
            Self::Color if style == Style::Full => {
                format!(" stroke=\"{}\"", dialect::hex(stroke.color))
            }
            Self::Color => format!(" stroke=\"{}\"", dialect::short_hex(stroke.color)),
            Self::Width if style.layer_width() == Some(stroke.width) => String::new(),
            Self::Width => width_text(stroke.width, style.unit()),
            Self::Opacity if stroke.opacity == u8::MAX => String::new(),
            Self::Opacity => format!(" stroke-opacity=\"{}\"", dialect::opacity(stroke.opacity)),
        }
    }
}

/// How attributes are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Style {
    /// In full, colours with six digits.
    Full,
    /// As short as possible in a layer of this `width` with numbers in this `unit`.
    Short { width: Option<i64>, unit: Unit },
}

impl Style {
    fn layer_width(self) -> Option<i64> {
        match self {
            Self::Full => None,
            Self::Short { width, .. } => width,
        }
    }

    fn unit(self) -> Unit {
        match self {
            Self::Full => Unit::PX,
            Self::Short { unit, .. } => unit,
        }
    }
}

/// Appends the path of `strokes` with the attributes that are not `shared`.
fn push_path(out: &mut String, strokes: &[Written], shared: &[Attribute], style: Style) {
    let lines = strokes.iter().map(|stroke| stroke.points.as_slice());
    let d = path::data(lines, style.unit());
    *out += &format!("<path d=\"{d}\"");
    let own = Attribute::ALL.iter().filter(|a| !shared.contains(a));
    for attribute in own {
        *out += &strokes
            .first()
            .map_or_else(String::new, |stroke| attribute.text(stroke, style));
    }
    out.push_str("/>");
}

/// Bytes of a group around elements, besides its attribute.
const GROUP_BYTES: usize = "<g></g>".len();

/// Appends `elements`. Where it is shorter, a group holds the attribute that most of them share.
fn push_runs(out: &mut String, elements: &[&[Written]], shared: &[Attribute], style: Style) {
    let mut rest = elements;
    while let Some((first, others)) = rest.split_first() {
        let Some((attribute, length)) = best_run(rest, shared, style) else {
            push_path(out, first, shared, style);
            rest = others;
            continue;
        };
        let (run, later) = rest.split_at(length);
        *out += &format!("<g{}>", attribute.text(&first[0], style));
        push_runs(out, run, &[shared, &[attribute]].concat(), style);
        out.push_str("</g>");
        rest = later;
    }
}

/// The attribute that saves most bytes on a group around the first elements, and how many of them share it.
fn best_run(
    elements: &[&[Written]],
    shared: &[Attribute],
    style: Style,
) -> Option<(Attribute, usize)> {
    let saved = |attribute: Attribute| {
        let text = |element: &&[Written]| attribute.text(&element[0], style);
        let first = text(elements.first()?);
        let length = elements.iter().take_while(|e| text(e) == first).count();
        let saved = (first.len() * (length - 1)).checked_sub(GROUP_BYTES + 1)?;
        Some((saved, (attribute, length)))
    };
    let free = Attribute::ALL.iter().filter(|a| !shared.contains(a));
    free.filter_map(|&attribute| saved(attribute))
        .max_by_key(|(saved, _)| *saved)
        .map(|(_, run)| run)
}
