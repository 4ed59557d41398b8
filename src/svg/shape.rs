//! The elements of shapes: `<circle>`, `<ellipse>` and `<rect>`.

use super::dialect::Unit;
use crate::scene::WrittenShape;

/// Names of the elements, and of the attributes that say where they are. The last one of a rectangle may be absent.
const CIRCLE: (&str, [&str; 3]) = ("circle", ["cx", "cy", "r"]);
const ELLIPSE: (&str, [&str; 4]) = ("ellipse", ["cx", "cy", "rx", "ry"]);
const RECT: (&str, [&str; 5]) = ("rect", ["x", "y", "width", "height", "rx"]);

/// The attributes of the element of this name that say where it is; `None` if it is no shape.
pub(super) fn attributes(name: &str) -> Option<&'static [&'static str]> {
    let all: [(&str, &'static [&'static str]); 3] = [
        (CIRCLE.0, &CIRCLE.1),
        (ELLIPSE.0, &ELLIPSE.1),
        (RECT.0, &RECT.1),
    ];
    let mut all = all.into_iter();
    all.find(|(of, _)| *of == name)
        .map(|(_, attributes)| attributes)
}

/// Appends the beginning of the element of `shape`, with these `names`, up to its attributes of style.
pub(super) fn push(out: &mut String, shape: WrittenShape, names: &str, unit: Unit) {
    let mut element = |name: &str, attributes: &[&str], numbers: &[i64]| {
        *out += &format!("<{name}{names}");
        for (attribute, &number) in attributes.iter().zip(numbers) {
            *out += &format!(" {attribute}=\"");
            unit.push(out, number);
            out.push('"');
        }
    };
    match shape {
        WrittenShape::Circle([x, y], radius) => element(CIRCLE.0, &CIRCLE.1, &[x, y, radius]),
        WrittenShape::Ellipse([x, y], [rx, ry]) => element(ELLIPSE.0, &ELLIPSE.1, &[x, y, rx, ry]),
        WrittenShape::Rect([low, high], radius) => {
            let [width, height] = [0, 1].map(|axis| high[axis] - low[axis]);
            let numbers = [low[0], low[1], width, height, radius];
            let count = if radius > 0 { 5 } else { 4 };
            element(RECT.0, &RECT.1, &numbers[..count]);
        }
    }
}

/// The shape of the element of this name with these numbers, in the order of its [`attributes`].
pub(super) fn of(name: &str, numbers: &[i64]) -> Option<WrittenShape> {
    let shape = match (name, numbers) {
        ("circle", &[x, y, radius]) => WrittenShape::Circle([x, y], radius),
        ("ellipse", &[x, y, rx, ry]) => WrittenShape::Ellipse([x, y], [rx, ry]),
        ("rect", &[x, y, width, height, ref radius @ ..]) => {
            let radius = radius.first().copied();
            let corners = [[x, y], [x + width, y + height]];
            WrittenShape::Rect(corners, radius.unwrap_or(0))
        }
        _ => return None,
    };
    shape.is_solid().then_some(shape)
}
