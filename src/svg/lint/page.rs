//! A file as the rules see it: elements with their properties, strokes as they are inherited, style sheets, references.

use svgtypes::{Length, LengthUnit, NumberListParser};

use super::values;
use crate::svg::dialect;
use crate::svg::dom::{Dom, Node, short};
use crate::svg::sheet::{self, Rules};

/// Depth of elements at which readers built on libxml2 stop.
const LIBXML2_LEVELS: usize = 256;

/// The elements with strokes.
const SHAPES: [&str; 7] = [
    "circle", "ellipse", "line", "path", "polygon", "polyline", "rect",
];

/// A style sheet: its text, and its rules if all are for classes.
pub(super) struct Sheet<'d> {
    pub(super) node: Node<'d>,
    pub(super) text: String,
    pub(super) rules: Option<Rules>,
}

/// The style sheets of a file.
pub(super) fn sheets<'d>(dom: &'d Dom<'d>) -> Vec<Sheet<'d>> {
    let styles = dom
        .nodes()
        .filter(|node| node.is_svg() && node.name() == "style");
    let sheet = |node: Node<'d>| {
        let text = node.text();
        let rules = sheet::parse(&text);
        Sheet { node, text, rules }
    };
    styles
        .map(sheet)
        .filter(|sheet| !sheet.text.is_empty())
        .collect()
}

/// A file, with its elements of SVG in the order of the text.
pub(super) struct Page<'d> {
    pub(super) text: &'d str,
    pub(super) dom: &'d Dom<'d>,
    pub(super) sheets: &'d [Sheet<'d>],
    pub(super) elements: Vec<Element<'d>>,
    /// Elements that are deeper than [`LIBXML2_LEVELS`], elements of other namespaces included.
    pub(super) deep: Vec<Node<'d>>,
}

impl<'d> Page<'d> {
    pub(super) fn of(text: &'d str, dom: &'d Dom<'d>, sheets: &'d [Sheet<'d>]) -> Self {
        let mut page = Self {
            text,
            dom,
            sheets,
            elements: Vec::new(),
            deep: Vec::new(),
        };
        // A stack of open elements, each with its end and the stroke that its content inherits. Nodes come in the order of the
        // text, so elements that end before a node are closed.
        let mut open: Vec<(usize, Stroke)> = Vec::new();
        for node in dom.nodes().filter(Node::is_element) {
            while open.pop_if(|(end, _)| *end <= node.bytes().start).is_some() {}
            page.deep
                .extend((open.len() >= LIBXML2_LEVELS).then_some(node));
            let mut element = Element::new(node, sheets);
            let outer = open.last().map(|(_, stroke)| *stroke);
            element.stroke = outer.unwrap_or_else(|| Stroke::on(node)).within(&element);
            open.push((node.bytes().end, element.stroke));
            if node.is_svg() {
                page.elements.push(element);
            }
        }
        page
    }

    pub(super) fn root(&self) -> Option<Node<'d>> {
        self.dom.top().find(Node::is_element)
    }

    /// All that the file refers to, and from where. People follow links; renderers do not.
    pub(super) fn targets(&self) -> Vec<(usize, String)> {
        let mut targets = Vec::new();
        for Element { node, .. } in &self.elements {
            let at = node.bytes().start;
            for &(key, value) in node.attributes() {
                let is_href = node.name() != "a" && key.rsplit(':').next() == Some("href");
                targets.extend(is_href.then(|| (at, value.trim().to_owned())));
                targets.extend(values::urls(value).map(|target| (at, target)));
            }
        }
        for Sheet { node, text, .. } in self.sheets {
            let at = node.bytes().start;
            targets.extend(values::urls(text).map(|target| (at, target)));
        }
        targets
    }
}

/// An element with its attributes and properties.
pub(super) struct Element<'d> {
    pub(super) node: Node<'d>,
    /// The properties of its classes.
    classed: Vec<(&'d str, &'d str)>,
    pub(super) stroke: Stroke,
}

impl<'d> Element<'d> {
    fn new(node: Node<'d>, sheets: &'d [Sheet<'d>]) -> Self {
        let classes = node
            .get("class")
            .unwrap_or_default()
            .split_ascii_whitespace();
        let rules = sheets.iter().filter_map(|sheet| sheet.rules.as_ref());
        let properties =
            classes.flat_map(|class| rules.clone().filter_map(move |rules| rules.get(class)));
        let properties = properties
            .flatten()
            .map(|(key, value)| (key.as_str(), value.as_str()));
        Self {
            node,
            classed: properties.collect(),
            stroke: Stroke::default(),
        }
    }

    pub(super) fn name(&self) -> &'d str {
        self.node.name()
    }

    pub(super) fn get(&self, key: &str) -> Option<&'d str> {
        self.node.get(key).map(str::trim)
    }

    /// A property. As in CSS, `style="…"` overrides classes, and these override the attribute.
    pub(super) fn property(&self, key: &str) -> Option<&'d str> {
        let styled = self.styles().filter(|(k, _)| *k == key).last();
        styled.map(|(_, value)| value).or_else(|| self.get(key))
    }

    /// The properties of its classes and in `style="…"`.
    fn styles(&self) -> impl Iterator<Item = (&'d str, &'d str)> {
        let style = self.get("style").unwrap_or_default();
        let own = style.split(';').filter_map(|pair| pair.split_once(':'));
        let all = self.classed.iter().copied().chain(own);
        all.map(|(key, value)| {
            let value = value.trim().trim_end_matches("!important");
            (key.trim(), value.trim_end())
        })
    }

    /// Names and values of attributes and properties.
    pub(super) fn values(&self) -> impl Iterator<Item = (&'d str, &'d str)> {
        self.node.attributes().iter().copied().chain(self.styles())
    }

    /// Its name with `key="value"`, for a message.
    pub(super) fn quote(&self, key: &str) -> String {
        let value = self.property(key).unwrap_or_default();
        format!("<{}> with {key}=\"{}\"", self.name(), short(value))
    }

    /// The width of its stroke on the page, px, if it is drawn with one.
    pub(super) fn stroke_px(&self) -> Option<f64> {
        let Stroke {
            width,
            scale,
            is_painted,
            is_drawn,
        } = self.stroke;
        let has_stroke = is_drawn && is_painted && SHAPES.contains(&self.name());
        has_stroke.then_some(width * scale)
    }
}

/// How strokes are drawn in an element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke {
    is_painted: bool,
    /// False in a definition.
    is_drawn: bool,
    /// In units of the element.
    width: f64,
    /// px per unit.
    scale: f64,
}

impl Default for Stroke {
    fn default() -> Self {
        Self {
            is_painted: false,
            is_drawn: true,
            width: 1.0,
            scale: 1.0,
        }
    }
}

impl Stroke {
    /// Those on the page of this root. The printer or the user decides how many px a page in mm has.
    fn on(root: Node<'_>) -> Self {
        let size = Size::of(root);
        let units = size.view.map(|[_, _, width, _]| width);
        let units = units.filter(|&width| width > 0.0 && size.is_in_px);
        Self {
            scale: size.width.zip(units).map_or(1.0, |(px, units)| px / units),
            ..Self::default()
        }
    }

    fn within(self, element: &Element<'_>) -> Self {
        let is_painted = match element.property("stroke") {
            Some("inherit") | None => self.is_painted,
            Some(paint) => !matches!(paint, "none" | "transparent"),
        };
        let width = element
            .property("stroke-width")
            .and_then(dialect::length_px);
        let scale = element
            .get("transform")
            .map_or(1.0, values::transform_scale);
        let is_definition = ["clipPath", "defs", "mask", "symbol"].contains(&element.name());
        Self {
            is_painted,
            is_drawn: self.is_drawn && !is_definition,
            width: width.unwrap_or(self.width),
            scale: self.scale * scale,
        }
    }
}

/// The size of a page, as its root states it.
pub(super) struct Size {
    /// In px.
    pub(super) width: Option<f64>,
    pub(super) height: Option<f64>,
    pub(super) view: Option<[f64; 4]>,
    /// True if both sides have a unit, as with `--width`.
    pub(super) has_units: bool,
    /// True if the width is in px.
    is_in_px: bool,
}

impl Size {
    pub(super) fn of(root: Node<'_>) -> Self {
        let side = |key| root.get(key).and_then(dialect::length_px);
        let unit = |key| {
            root.get(key)?
                .trim()
                .parse()
                .ok()
                .map(|length: Length| length.unit)
        };
        let units = [unit("width"), unit("height")];
        let view = root.get("viewBox").map(NumberListParser::from);
        let view = view.and_then(|numbers| numbers.collect::<Result<Vec<_>, _>>().ok());
        Self {
            width: side("width"),
            height: side("height"),
            view: view.and_then(|numbers| numbers.try_into().ok()),
            has_units: units
                .iter()
                .all(|unit| unit.is_some_and(|unit| unit != LengthUnit::None)),
            is_in_px: matches!(units[0], Some(LengthUnit::None | LengthUnit::Px)),
        }
    }
}
