//! The stroke of an element, with inherited properties: finds thin strokes and strokes of zero length.

use super::element::Element;
use super::number;
use super::path;

/// Widest stroke, px, that some renderers draw as a hairline (1 px included).
const HAIRLINE_PX: f64 = 1.0;

/// The stroke style that children of an element inherit.
#[derive(Debug, Clone, Copy)]
pub(super) struct StrokeStyle {
    /// True if a stroke is painted.
    painted: bool,
    /// Width in the element's units.
    width: f64,
    /// px per unit.
    scale: f64,
    /// True if the element is drawn in place, and is not a definition.
    pub(super) drawn: bool,
}

impl StrokeStyle {
    /// The style at the root of a page with `scale` px per unit.
    pub(super) fn page(scale: f64) -> Self {
        Self {
            painted: false,
            width: 1.0,
            scale,
            drawn: true,
        }
    }

    /// The style within `element`.
    pub(super) fn within(self, element: &Element) -> Self {
        let painted = match element.property("stroke") {
            Some("inherit") | None => self.painted,
            Some(paint) => !matches!(paint, "none" | "transparent"),
        };
        let width = element.property("stroke-width").and_then(number::length_px);
        let scale = element
            .get("transform")
            .map_or(1.0, number::transform_scale);
        let definition = matches!(
            element.name.as_str(),
            "clipPath" | "defs" | "mask" | "symbol"
        );
        Self {
            painted,
            width: width.unwrap_or(self.width),
            scale: self.scale * scale,
            drawn: self.drawn && !definition,
        }
    }

    /// Width on the page, px, if it is one that renderers draw differently.
    pub(super) fn hairline_px(self, element: &Element) -> Option<f64> {
        let width_px = self.width * self.scale;
        let thin = width_px > 0.0 && width_px <= HAIRLINE_PX;
        (self.strokes(element) && thin).then_some(width_px)
    }

    /// True if the element has a stroke of zero length.
    pub(super) fn has_zero_length(self, element: &Element) -> bool {
        self.strokes(element) && is_point(element)
    }

    fn strokes(self, element: &Element) -> bool {
        const SHAPES: [&str; 7] = [
            "circle", "ellipse", "line", "path", "polygon", "polyline", "rect",
        ];
        self.drawn && self.painted && SHAPES.contains(&element.name.as_str())
    }
}

fn is_point(element: &Element) -> bool {
    let value = |key| element.get(key).and_then(number::length_px).unwrap_or(0.0);
    match element.name.as_str() {
        "path" => element.get("d").is_some_and(path::has_zero_length),
        "line" => value("x1") == value("x2") && value("y1") == value("y2"),
        "polyline" | "polygon" => {
            let points = element.get("points").unwrap_or_default();
            path::has_zero_length(&format!("M{points}"))
        }
        _ => false,
    }
}
