//! Elements of the SVG: strokes of one element, areas, and attributes that neighbours share.

use std::collections::BTreeMap;

use super::arrange::style_of;
use super::dialect::{self, Unit};
use super::gradient;
use super::layer::Written;
use super::names;
use super::options::Form;
use super::outline;
use super::path::{self, Kind};
use super::shape;
use super::sheet::Sheet;
use super::sweep;
use crate::scene::Path;

/// Names of marks and classes of elements, which forms with an element for each mark have.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Names<'a> {
    /// The number of the layer, if its marks have ids.
    pub(super) layer: Option<usize>,
    /// The classes that hold colours and widths, if there are any.
    pub(super) sheet: Option<&'a Sheet>,
}

impl Names<'_> {
    /// The attributes of the mark that is the `index`-th of its layer, and those that it needs no more.
    fn of(&self, mark: &Written, index: usize) -> (String, &'static [Attribute]) {
        let id = |layer: usize| format!(" id=\"{}-{layer}-{}\"", names::of_mark(mark), index + 1);
        let id = self.layer.map_or_else(String::new, id);
        let class = self
            .sheet
            .map_or_else(String::new, |sheet| sheet.class(mark));
        let shared: &[_] = match class.as_str() {
            "" => &[],
            _ => &[Attribute::Color, Attribute::Width],
        };
        (id + &class, shared)
    }
}

/// Appends the elements of `strokes`, in the smallest form with numbers in `unit`.
pub(super) fn push(
    out: &mut String,
    strokes: &[Written],
    form: Form,
    unit: Unit,
    names: Names<'_>,
) {
    let has_round = strokes.iter().any(Written::is_round);
    match form {
        Form::Plain | Form::Css | Form::Powerstroke => {
            for (i, stroke) in strokes.iter().enumerate() {
                let (attributes, shared) = names.of(stroke, i);
                let alone = std::slice::from_ref(stroke);
                push_path(out, alone, &attributes, shared, Style::Full { has_round });
                out.push('\n');
            }
        }
        Form::Smallest => {
            let width = usual_width(strokes);
            let style = Style::Short {
                width,
                unit,
                has_round,
            };
            push_runs(out, &split(strokes), &[], style);
        }
        Form::Outlines => strokes.iter().for_each(|stroke| outline::push(out, stroke)),
    }
}

/// Appends the element of one mark in full, with these `names`.
pub(super) fn push_alone(out: &mut String, mark: &Written, names: &str) {
    let style = Style::Full { has_round: true };
    push_path(out, std::slice::from_ref(mark), names, &[], style);
}

/// Bytes of an element of one stroke. In the smallest form, its width is assumed to be shared with neighbours; classes count
/// as the attributes in their place.
pub(super) fn bytes(stroke: &Written, form: Form, unit: Unit) -> usize {
    let mut out = String::new();
    let alone = std::slice::from_ref(stroke);
    match form {
        Form::Smallest => {
            let style = Style::Short {
                width: None,
                unit,
                has_round: true,
            };
            push_path(&mut out, alone, "", &[Attribute::Width], style);
        }
        form if stroke.mark.is_butt() && form != Form::Outlines => {
            push_alone(&mut out, stroke, "");
            out.push('\n');
        }
        form => push(&mut out, alone, form, unit, Names::default()),
    }
    out.len()
}

/// The attribute of a layer that, in the smallest form, holds the most common width of `strokes`, or nothing.
pub(super) fn layer_width(strokes: &[Written], form: Form, unit: Unit) -> String {
    let width = usual_width(strokes).filter(|_| form == Form::Smallest);
    width.map_or_else(String::new, |width| width_text(width, unit))
}

fn width_text(width: i64, unit: Unit) -> String {
    let mut out = String::from(" stroke-width=\"");
    unit.push(&mut out, width);
    out + "\""
}

/// The most common width in the smallest form, if more than one element has it.
fn usual_width(strokes: &[Written]) -> Option<i64> {
    let mut counts = BTreeMap::<i64, usize>::new();
    for element in split(strokes) {
        if !element[0].is_filled() {
            *counts.entry(element[0].width()).or_default() += 1;
        }
    }
    let (width, count) = counts.into_iter().max_by_key(|&(_, count)| count)?;
    (count > 1).then_some(width)
}

/// The strokes of each element in the smallest form.
fn split(strokes: &[Written]) -> Vec<&[Written]> {
    let mut elements = Vec::new();
    let mut rest = strokes;
    while !rest.is_empty() {
        let joins = |&k: &usize| joins(&rest[..k], &rest[k]);
        let length = 1 + (1..rest.len()).take_while(joins).count();
        let (element, later) = rest.split_at(length);
        elements.push(element);
        rest = later;
    }
    elements
}

/// True if `next` can join the element of `strokes` without changing the picture.
fn joins(strokes: &[Written], next: &Written) -> bool {
    let is_alike = strokes
        .last()
        .is_some_and(|last| style_of(last) == style_of(next));
    is_alike
        && !next.is_filled()
        && is_line(next)
        && strokes.iter().all(is_line)
        && (next.opacity() == u8::MAX
            || !strokes.iter().any(|stroke| stroke.mark.meets(&next.mark)))
}

/// True if other strokes can join the element of the mark.
fn is_line(mark: &Written) -> bool {
    mark.shape().is_none() && !mark.mark.is_butt()
}

/// An attribute that the marks of an element have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Attribute {
    Color,
    Width,
    Opacity,
}

impl Attribute {
    const ALL: [Self; 3] = [Self::Color, Self::Width, Self::Opacity];

    /// The attribute as text after a space; nothing if it equals the default.
    fn text(self, mark: &Written, style: Style) -> String {
        let paint = if mark.is_filled() { "fill" } else { "stroke" };
        match self {
            Self::Color if let Some(gradient) = gradient::paint(mark) => {
                format!(" {paint}=\"{gradient}\"")
            }
            Self::Color if style.is_full() => {
                format!(" {paint}=\"{}\"", dialect::hex(mark.color()))
            }
            Self::Color => format!(" {paint}=\"{}\"", dialect::short_hex(mark.color())),
            Self::Width if mark.is_filled() || style.layer_width() == Some(mark.width()) => {
                String::new()
            }
            Self::Width => width_text(mark.width(), style.unit()),
            Self::Opacity if mark.opacity() == u8::MAX => String::new(),
            Self::Opacity => format!(" {paint}-opacity=\"{}\"", dialect::opacity(mark.opacity())),
        }
    }
}

/// Style of writing attributes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Style {
    /// In full, colours with six digits, in a layer that has strokes with round ends or has none.
    Full { has_round: bool },
    /// As short as possible in a layer of this `width` with numbers in this `unit`.
    Short {
        width: Option<i64>,
        unit: Unit,
        has_round: bool,
    },
}

impl Style {
    fn is_full(self) -> bool {
        matches!(self, Self::Full { .. })
    }

    /// True if the layer has strokes with round ends.
    fn has_round(self) -> bool {
        match self {
            Self::Full { has_round } | Self::Short { has_round, .. } => has_round,
        }
    }

    fn layer_width(self) -> Option<i64> {
        match self {
            Self::Full { .. } => None,
            Self::Short { width, .. } => width,
        }
    }

    fn unit(self) -> Unit {
        match self {
            Self::Full { .. } => Unit::PX,
            Self::Short { unit, .. } => unit,
        }
    }
}

/// Appends the path of `strokes`, or the element of the only one's shape, with these `names` and the attributes that are not
/// `shared`, behind its gradient if it has one.
fn push_path(
    out: &mut String,
    strokes: &[Written],
    names: &str,
    shared: &[Attribute],
    style: Style,
) {
    let only = strokes.first().filter(|_| strokes.len() == 1);
    // In full, each element has a line of its own.
    let end = if style.is_full() { "\n" } else { "" };
    for mark in strokes {
        gradient::push_of(out, mark, end);
        sweep::push_effect(out, mark, end);
    }
    if let Some(shape) = only.and_then(Written::shape) {
        shape::push(out, shape, names, style.unit());
    } else {
        let kind = match only {
            Some(area) if area.is_filled() => Kind::Ring,
            _ => Kind::Line,
        };
        let paths = strokes.iter().flat_map(Written::paths);
        let d = path::data(paths, kind, style.unit());
        *out += &format!("<path{names} d=\"{d}\"");
    }
    let own = Attribute::ALL.iter().filter(|a| !shared.contains(a));
    for attribute in own {
        *out += &strokes
            .first()
            .map_or_else(String::new, |stroke| attribute.text(stroke, style));
    }
    out.push_str(only.filter(|_| style.has_round()).map_or("", ends));
    if let Some(mark) = only {
        sweep::push(out, mark, style.unit());
    }
    out.push_str("/>");
}

/// The attributes that give a band the ends and corners that other strokes of its layer do not have.
fn ends(mark: &Written) -> &'static str {
    let has_corners = mark.paths().iter().any(Path::has_joins);
    match mark.mark.is_butt() {
        false => "",
        true if has_corners => " stroke-linecap=\"butt\" stroke-linejoin=\"miter\"",
        true => " stroke-linecap=\"butt\"",
    }
}

/// Bytes of a group around elements, besides its attribute.
const GROUP_BYTES: usize = "<g></g>".len();

/// Appends `elements`. Where it is shorter, a group holds the attribute that most of them share.
fn push_runs(out: &mut String, elements: &[&[Written]], shared: &[Attribute], style: Style) {
    let mut rest = elements;
    while let Some((first, others)) = rest.split_first() {
        let Some((attribute, length)) = best_run(rest, shared, style) else {
            push_path(out, first, "", shared, style);
            rest = others;
            continue;
        };
        let (run, later) = rest.split_at(length);
        *out += &format!("<g{}>", attribute.text(&first[0], style));
        // Within the group, runs of the other attributes may be worth groups of their own.
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
        // A group writes the attribute once instead of `length` times, and has to save a byte beyond its own tags.
        let saved = (first.len() * (length - 1)).checked_sub(GROUP_BYTES + 1)?;
        Some((saved, (attribute, length)))
    };
    let free = Attribute::ALL.iter().filter(|a| !shared.contains(a));
    free.filter_map(|&attribute| saved(attribute))
        .max_by_key(|(saved, _)| *saved)
        .map(|(_, run)| run)
}
