//! Numbers of an SVG as its text has them. The one door of `roxmltree` and `svgtypes`.
//!
//! *Parameters* are what has to be chosen of the shapes themselves, however they are written: 2 of a line, 4 of a
//! quadratic and 6 of a cubic curve, 7 of an arc; 3 of a circle, 4 of an ellipse or a line element, 6 of a rectangle,
//! 2 of a side of a polygon. Moves, colours and widths are free. *Numbers* are all that the file writes of shapes,
//! gradients, transforms, colours (3 each), widths and opacities; those of style sheets do not count.

use std::ops::Range;

use roxmltree::{Document, Node, ParsingOptions};
use svgtypes::{PathParser, PathSegment, PointsParser};

use strokefit::{Error, ErrorKind, Result};

/// Numbers of an SVG, without those of a rectangle that fills the page behind everything else.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Anatomy {
    /// Of all shapes.
    pub(super) parameters: usize,
    /// All of them.
    pub(super) numbers: usize,
    /// Those of shapes and of the widths of strokes; of the outline of a line whose width varies, those of that line and its widths.
    pub(super) line_numbers: usize,
    /// True if a rectangle fills the page behind everything else.
    pub(super) has_page: bool,
}

impl Anatomy {
    /// Numbers of SVG text.
    ///
    /// # Errors
    /// [`ErrorKind::Svg`] when the text is no XML.
    pub(super) fn of(svg: &str) -> Result<Self> {
        let document = parse(svg)?;
        let elements = document.descendants().filter(Node::is_element);
        let elements: Vec<_> = elements.collect();
        let first = elements.iter().position(|node| is_shape(*node));
        let page = first.filter(|&i| is_page(elements[i], document.root_element()));
        let counted = elements
            .iter()
            .enumerate()
            .filter(|(i, _)| Some(*i) != page);
        let mut anatomy = Self {
            has_page: page.is_some(),
            ..Self::default()
        };
        for (_, &node) in counted {
            anatomy.parameters += parameters(node);
            let line = line_numbers(node);
            for attribute in node.attributes().filter(|a| a.namespace().is_none()) {
                let name = attribute.name();
                let count = numbers(node.tag_name().name(), name, attribute.value());
                anatomy.numbers += count;
                let is_own = is_shape(node) && GEOMETRY.contains(&name) && line.is_none();
                if name == "stroke-width" || is_own {
                    anatomy.line_numbers += count;
                }
            }
            anatomy.line_numbers += line.unwrap_or_default();
        }
        Ok(anatomy)
    }
}

/// The SVG drawn without antialiasing.
///
/// # Errors
/// As [`Anatomy::of`].
pub(super) fn crisp(svg: &str) -> Result<String> {
    let document = parse(svg)?;
    let root = document.root_element();
    let mut text = svg.to_owned();
    if let Some(own) = root.attribute_node("shape-rendering") {
        text.replace_range(own.range(), "");
    }
    // After the root's name, which may have a prefix.
    let start = root.range().start;
    let name = text[start..].find(|c: char| c.is_whitespace() || "/>".contains(c));
    text.insert_str(
        start + name.unwrap_or_default(),
        " shape-rendering=\"crispEdges\"",
    );
    Ok(text)
}

/// The places in the text of the painted shapes, from back to front, but that of a rectangle that fills the page.
///
/// # Errors
/// As [`Anatomy::of`].
pub(super) fn elements(svg: &str) -> Result<Vec<Range<usize>>> {
    let document = parse(svg)?;
    Ok(painted(document.root_element())
        .iter()
        .map(Node::range)
        .collect())
}

/// The text with each of the painted shapes alone, from back to front, without a rectangle that fills the page.
///
/// # Errors
/// As [`Anatomy::of`].
pub(super) fn each_alone(svg: &str) -> Result<Vec<String>> {
    let document = parse(svg)?;
    let root = document.root_element();
    let all = painted_with_page(root);
    let mut gaps = Vec::new();
    let mut end = 0;
    for shape in &all {
        gaps.push(&svg[end..shape.range().start]);
        end = shape.range().end;
    }
    gaps.push(&svg[end..]);
    let alone = |i: usize| {
        let shape = &svg[all[i].range()];
        gaps[..=i].concat() + shape + &gaps[i + 1..].concat()
    };
    let first = all.len() - painted(root).len();
    Ok((first..all.len()).map(alone).collect())
}

/// The places in the text of an artist's things: the outermost groups and shapes, or all shapes if there is only one.
///
/// # Errors
/// As [`Anatomy::of`].
pub(super) fn things(svg: &str) -> Result<Vec<Range<usize>>> {
    let document = parse(svg)?;
    let shapes = painted(document.root_element());
    let mut parent = document.root_element();
    loop {
        let has_shapes = |node: &Node<'_, '_>| {
            shapes
                .iter()
                .any(|shape| shape.ancestors().any(|a| a == *node))
        };
        let children: Vec<Node<'_, '_>> = parent.children().filter(has_shapes).collect();
        match children[..] {
            [only] if !is_painted(only) => parent = only,
            _ => return Ok(children.iter().map(Node::range).collect()),
        }
    }
}

/// The painted shapes but a rectangle that fills the page.
fn painted<'a, 'input>(root: Node<'a, 'input>) -> Vec<Node<'a, 'input>> {
    let mut shapes = painted_with_page(root);
    if shapes.first().is_some_and(|first| is_page(*first, root)) {
        shapes.remove(0);
    }
    shapes
}

fn painted_with_page<'a, 'input>(root: Node<'a, 'input>) -> Vec<Node<'a, 'input>> {
    let is_drawn = |node: &Node<'_, '_>| {
        !node
            .ancestors()
            .any(|a| UNPAINTED.contains(&a.tag_name().name()))
    };
    let shapes = root
        .descendants()
        .filter(|node| is_painted(*node))
        .filter(is_drawn);
    shapes.collect()
}

/// Elements whose contents are painted where they are used.
const UNPAINTED: [&str; 6] = ["defs", "clipPath", "mask", "symbol", "pattern", "marker"];

fn is_painted(node: Node<'_, '_>) -> bool {
    is_shape(node) || node.tag_name().name() == "use"
}

fn parse(svg: &str) -> Result<Document<'_>> {
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(svg, options)
        .map_err(|e| Error::new(ErrorKind::Svg, format!("not an SVG that can be read: {e}")))
}

const SHAPES: [&str; 7] = [
    "path", "circle", "ellipse", "rect", "line", "polyline", "polygon",
];

/// The attributes of shapes that tell where they are.
const GEOMETRY: [&str; 15] = [
    "d", "points", "x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "x1", "y1", "x2", "y2",
];

fn is_shape(node: Node<'_, '_>) -> bool {
    SHAPES.contains(&node.tag_name().name())
}

/// True for a rectangle as large as the page, at its origin.
fn is_page(node: Node<'_, '_>, root: Node<'_, '_>) -> bool {
    let view: Vec<&str> = root
        .attribute("viewBox")
        .map(|view| view.split([' ', ',']).filter(|w| !w.is_empty()).collect())
        .unwrap_or_default();
    let at_origin = ["x", "y"].map(|name| node.attribute(name).is_none_or(|v| v == "0"));
    let fills = [("width", 2), ("height", 3)].map(|(name, i)| {
        let side = node.attribute(name);
        let whole = view.get(i).copied().or(root.attribute(name));
        side.is_some() && (side == Some("100%") || side == whole)
    });
    let plain = ["rx", "ry", "transform", "stroke"].map(|name| !node.has_attribute(name));
    let whole = at_origin.iter().chain(&fills).chain(&plain);
    node.tag_name().name() == "rect" && whole.copied().all(|holds| holds)
}

fn parameters(node: Node<'_, '_>) -> usize {
    let corners = || points(node.attribute("points").unwrap_or_default());
    match node.tag_name().name() {
        "path" => segments(node.attribute("d").unwrap_or_default())
            .map(|segment| match segment {
                PathSegment::MoveTo { .. } | PathSegment::ClosePath { .. } => 0,
                PathSegment::LineTo { .. }
                | PathSegment::HorizontalLineTo { .. }
                | PathSegment::VerticalLineTo { .. } => 2,
                PathSegment::Quadratic { .. } | PathSegment::SmoothQuadratic { .. } => 4,
                PathSegment::CurveTo { .. } | PathSegment::SmoothCurveTo { .. } => 6,
                PathSegment::EllipticalArc { .. } => 7,
            })
            .sum(),
        "circle" => 3,
        "ellipse" | "line" => 4,
        "rect" => 6,
        "polygon" => 2 * corners(),
        "polyline" => 2 * corners().saturating_sub(1),
        _ => 0,
    }
}

/// The namespace of the attributes with which we write the line that a path is the outline of.
const LINE: &str = "urn:strokefit:line";

/// Numbers of the line that a node is the outline of, and of its widths.
fn line_numbers(node: Node<'_, '_>) -> Option<usize> {
    let [data, widths] = ["line", "widths"].map(|name| node.attribute((LINE, name)));
    Some(segments(data?).map(written).sum::<usize>() + listed(widths?))
}

/// The segments before the first error, which are all that is drawn.
fn segments(data: &str) -> impl Iterator<Item = PathSegment> + '_ {
    PathParser::from(data).map_while(|segment| segment.ok())
}

fn points(list: &str) -> usize {
    PointsParser::from(list).count()
}

/// Numbers in an attribute of an `element`.
fn numbers(element: &str, name: &str, value: &str) -> usize {
    match name {
        "d" => segments(value).map(written).sum(),
        "points" => 2 * points(value),
        "style" => value
            .split(';')
            .filter_map(|declaration| declaration.split_once(':'))
            .map(|(name, value)| numbers(element, name.trim(), value.trim()))
            .sum(),
        "fill" | "stroke" | "stop-color" | "color" if is_color(value) => 3,
        // The page's own.
        "x" | "y" | "width" | "height" if element == "svg" => 0,
        "x" | "y" | "width" | "height" | "cx" | "cy" | "r" | "rx" | "ry" | "x1" | "y1" | "x2"
        | "y2" | "fx" | "fy" | "transform" | "gradientTransform" | "patternTransform"
        | "offset" | "opacity" | "fill-opacity" | "stroke-opacity" | "stop-opacity"
        | "stroke-width" | "stroke-miterlimit" | "stroke-dasharray" | "stroke-dashoffset" => {
            listed(value)
        }
        _ => 0,
    }
}

fn is_color(value: &str) -> bool {
    let names_another = ["none", "inherit", "currentColor"].contains(&value);
    !names_another && !value.starts_with("url(")
}

fn written(segment: PathSegment) -> usize {
    match segment {
        PathSegment::ClosePath { .. } => 0,
        PathSegment::HorizontalLineTo { .. } | PathSegment::VerticalLineTo { .. } => 1,
        PathSegment::MoveTo { .. }
        | PathSegment::LineTo { .. }
        | PathSegment::SmoothQuadratic { .. } => 2,
        PathSegment::Quadratic { .. } | PathSegment::SmoothCurveTo { .. } => 4,
        PathSegment::CurveTo { .. } => 6,
        PathSegment::EllipticalArc { .. } => 7,
    }
}

/// Numbers between words and signs, as in `matrix(1 0 0 .4 0 49)`.
fn listed(text: &str) -> usize {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || "+-.%".contains(c)));
    words
        .filter(|word| word.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)))
        .count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(body: &str) -> [usize; 2] {
        let svg = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9" viewBox="0 0 8 8">{body}</svg>"#
        );
        let anatomy = Anatomy::of(&svg).unwrap();
        [anatomy.parameters, anatomy.numbers]
    }

    fn path(data: &str) -> [usize; 2] {
        of(&format!(r#"<path d="{data}"/>"#))
    }

    #[test]
    fn each_command_has_its_numbers() {
        for (data, parameters, numbers) in [
            ("M1 2", 0, 2),
            ("M1 2L3 4", 2, 4),
            ("m1 2l3 4z", 2, 4),
            ("M1 2H3V4", 4, 4),
            ("M1 2h3v-4Z", 4, 4),
            ("M1 2C1 2 3 4 5 6", 6, 8),
            ("M1 2s3 4 5 6", 6, 6),
            ("M1 2Q3 4 5 6", 4, 6),
            ("M1 2q3 4 5 6t7 8T9 9", 12, 10),
            ("M1 2A3 3 0 0 1 5 6", 7, 9),
            ("M1 2a3 3 0 015 6", 7, 9),
        ] {
            assert_eq!(path(data), [parameters, numbers], "{data}");
        }
    }

    #[test]
    fn a_command_goes_on_without_its_letter() {
        assert_eq!(path("M1 2 3 4 5 6"), [4, 6]);
        assert_eq!(path("m0 0c1 1 2 2 3 3 4 4 5 5 6 6"), [12, 14]);
        assert_eq!(path("M0 0h1 2 3"), [6, 5]);
        assert_eq!(path("M.5.5-1-1a1 1 0 1012 3 1 1 0 0 1 4 5z"), [16, 18]);
        // Two rings, and nothing after an error.
        assert_eq!(path("M0 0h1v1zM2 2h1v1zL"), [8, 8]);
    }

    #[test]
    fn shapes_have_theirs() {
        for (body, parameters, numbers) in [
            (r#"<circle cx="1" cy="2" r="3"/>"#, 3, 3),
            (r#"<ellipse cx="1" cy="2" rx="3" ry="4"/>"#, 4, 4),
            (r#"<rect x="1" y="2" width="3" height="4" rx="1"/>"#, 6, 5),
            (r#"<line x1="1" x2="2" y1="3" y2="4"/>"#, 4, 4),
            (r#"<polygon points="1,2 3,4 5-6"/>"#, 6, 6),
            (r#"<polyline points="1 2 3 4 5 6"/>"#, 4, 6),
        ] {
            assert_eq!(of(body), [parameters, numbers], "{body}");
        }
    }

    #[test]
    fn colours_widths_and_gradients_are_numbers_alone() {
        let [parameters, numbers] = of(
            r##"<linearGradient id="a" x1="0" x2="50%" gradientTransform="matrix(1 0 0 .4 0 -49)"><stop offset=".1" stop-color="#fff"/><stop stop-opacity="0.5"/></linearGradient>
            <g fill="none" stroke="#102030" style="stroke-width:2px; fill-opacity:.5"><path fill="url(#a)" d="M0 0h1"/></g>"##,
        );
        assert_eq!((parameters, numbers), (2, 8 + 4 + 1 + 3 + 2 + 3));
    }

    #[test]
    fn an_outline_counts_as_its_line() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" xmlns:strokefit="urn:strokefit:line"><g stroke-width="3"><path fill="#102030" d="M1 2h9v9z" strokefit:line="M1 2Q3 4 5 6" strokefit:widths="1 2.5"/><circle r="2"/></g></svg>"##;
        assert_eq!(Anatomy::of(svg).unwrap().line_numbers, 1 + (2 + 4 + 2) + 1);
    }

    #[test]
    fn shapes_are_alone_in_their_groups() {
        let page = r#"<rect width="8" height="8"/>"#;
        let svg = format!(
            r#"<svg width="8" height="8"><g>{page}<path d="M0 0"/> <g fill="red"><path d="M1 1"/></g></g></svg>"#
        );
        let expected = [
            r#"<svg width="8" height="8"><g><path d="M0 0"/> <g fill="red"></g></g></svg>"#,
            r#"<svg width="8" height="8"><g> <g fill="red"><path d="M1 1"/></g></g></svg>"#,
        ];
        assert_eq!(each_alone(&svg).unwrap(), expected);
    }

    #[test]
    fn the_page_does_not_count() {
        let page = r##"<rect width="8" height="8" fill="#fff"/>"##;
        let hole = r##"<rect width="8" height="7" fill="#fff"/>"##;
        assert_eq!(of(page), [0, 0]);
        assert_eq!(of(&format!("<g>{page}{hole}</g>")), [6, 5]);
        assert_eq!(of(&format!("{hole}{page}")), [12, 10]);
    }

    #[test]
    fn the_root_is_made_crisp() {
        let root =
            r#"<?xml version="1.0"?><!-- <svg> --><svg xmlns="http://www.w3.org/2000/svg"/>"#;
        let found = crisp(root).unwrap();
        let expected = r#"<svg shape-rendering="crispEdges" xmlns="#;
        assert!(found.contains(expected), "{found}");
        assert!(parse(&crisp(&found).unwrap()).is_ok());
        assert!(crisp("<svg").is_err());
    }
}
