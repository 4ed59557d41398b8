//! The elements of shapes: `<circle>`, `<ellipse>` and `<rect>`.

use super::dialect::Unit;
use crate::math::Point;
use crate::scene::{Shape, px, units};

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
pub(super) fn push(out: &mut String, shape: Shape, names: &str, unit: Unit) {
    let mut element = |name: &str, attributes: &[&str], numbers: &[f64]| {
        *out += &format!("<{name}{names}");
        for (attribute, &number) in attributes.iter().zip(numbers) {
            *out += &format!(" {attribute}=\"");
            unit.push(out, units(number));
            out.push('"');
        }
    };
    match shape {
        Shape::Circle { center, radius } => {
            element(CIRCLE.0, &CIRCLE.1, &[center.x, center.y, radius]);
        }
        Shape::Ellipse { center, radii } => {
            element(
                ELLIPSE.0,
                &ELLIPSE.1,
                &[center.x, center.y, radii[0], radii[1]],
            );
        }
        Shape::Rect { low, high, radius } => {
            let side = high - low;
            let numbers = [low.x, low.y, side.x, side.y, radius];
            // Without `rx` a rectangle has sharp corners.
            let count = if radius > 0.0 { 5 } else { 4 };
            element(RECT.0, &RECT.1, &numbers[..count]);
        }
    }
}

/// The shape of the element of this name with these numbers, in the order of its [`attributes`].
pub(super) fn of(name: &str, numbers: &[i64]) -> Option<Shape> {
    let point = |x: i64, y: i64| Point::new(px(x), px(y));
    let shape = match (name, numbers) {
        ("circle", &[x, y, radius]) => Shape::circle(point(x, y), px(radius)),
        ("ellipse", &[x, y, rx, ry]) => Shape::ellipse(point(x, y), [px(rx), px(ry)]),
        ("rect", &[x, y, width, height, ref radius @ ..]) => {
            let corners = [point(x, y), point(x + width, y + height)];
            Shape::rect(corners, px(radius.first().copied().unwrap_or(0)))
        }
        _ => return None,
    };
    shape.is_solid().then_some(shape)
}
