//! Walks through the text, element by element, and applies each rule.

use quick_xml::events::{BytesStart, Event};
use quick_xml::name::{Namespace, ResolveResult};
use quick_xml::reader::NsReader;

use super::element::{Element, short};
use super::number;
use super::reference::References;
use super::rules::{self, Rule};
use super::stroke::StrokeStyle;
use super::{Findings, element};
use crate::svg::dialect::{self, SVG_NAMESPACE};
use crate::svg::sheet::{self, Rules};

/// Depth of elements at which readers built on libxml2 stop.
const LIBXML2_LEVELS: usize = 256;

/// Largest relative difference of the aspect ratios of page and `viewBox`.
const ASPECT_TOLERANCE: f64 = 1e-3;

/// Attributes that hold colours.
const COLORED: [&str; 6] = [
    "color",
    "fill",
    "flood-color",
    "lighting-color",
    "stop-color",
    "stroke",
];

/// Attributes that hold numbers.
const NUMERIC: [&str; 24] = [
    "cx",
    "cy",
    "d",
    "fill-opacity",
    "height",
    "offset",
    "opacity",
    "points",
    "r",
    "rx",
    "ry",
    "stop-opacity",
    "stroke-dasharray",
    "stroke-opacity",
    "stroke-width",
    "transform",
    "viewBox",
    "width",
    "x",
    "x1",
    "x2",
    "y",
    "y1",
    "y2",
];

/// Elements of the dialect, and elements that neither draw anything nor affect the drawing.
const PLAIN: [&str; 10] = [
    "circle", "defs", "desc", "ellipse", "g", "metadata", "path", "rect", "svg", "title",
];

/// Elements that all renderers draw alike.
const SHAPES: [&str; 3] = ["line", "polygon", "polyline"];

/// Walks through the whole text.
pub(super) fn walk(text: &str, findings: &mut Findings) {
    let mut walk = Walk::new(text, findings);
    if let Err(message) = walk.document() {
        let line = walk.line;
        walk.findings.add(&rules::NOT_XML, line, short(&message));
    }
    let Walk {
        references,
        findings,
        ..
    } = walk;
    references.judge(findings);
}

struct Walk<'a, 'b> {
    text: &'a str,
    xml: NsReader<&'a [u8]>,
    /// Line on which the current event begins, from 1.
    line: usize,
    /// Bytes before that line's event.
    at: usize,
    /// One for each open element.
    styles: Vec<StrokeStyle>,
    references: References,
    /// True if the text is a style sheet.
    in_style: bool,
    /// Those of the style sheets so far.
    rules: Rules,
    findings: &'b mut Findings,
}

impl<'a, 'b> Walk<'a, 'b> {
    fn new(text: &'a str, findings: &'b mut Findings) -> Self {
        let mut xml = NsReader::from_str(text);
        xml.config_mut().expand_empty_elements = true;
        Self {
            text,
            xml,
            line: 1,
            at: 0,
            styles: Vec::new(),
            references: References::default(),
            in_style: false,
            rules: Rules::new(),
            findings,
        }
    }

    fn document(&mut self) -> Result<(), String> {
        loop {
            self.advance();
            let outcome = self.xml.read_resolved_event();
            let (namespace, event) = outcome.map_err(|e| e.to_string())?;
            match event {
                Event::Start(tag) => {
                    let known = matches!(&namespace, ResolveResult::Bound(Namespace(n)) if *n == SVG_NAMESPACE);
                    self.open(&tag.into_owned(), known)?;
                }
                Event::End(_) => {
                    self.in_style = false;
                    self.styles.pop();
                }
                Event::DocType(_) => self.doctype(),
                Event::PI(_) => self.instruction(),
                Event::Text(_) | Event::CData(_) => self.characters(),
                Event::Eof if self.styles.is_empty() => return Ok(()),
                Event::Eof => return Err("the file ends before its last element".into()),
                _ => {}
            }
        }
    }

    /// The next event begins where the last one ended.
    fn advance(&mut self) {
        let to = self.here();
        let passed = self.text.as_bytes().get(self.at..to).unwrap_or_default();
        self.line += passed.iter().filter(|&&b| b == b'\n').count();
        self.at = to;
    }

    fn here(&self) -> usize {
        usize::try_from(self.xml.buffer_position()).unwrap_or(usize::MAX)
    }

    /// The text of the event that was just read.
    fn raw(&self) -> &'a str {
        self.text.get(self.at..self.here()).unwrap_or_default()
    }

    fn instruction(&mut self) {
        let raw = self.raw();
        if raw.starts_with("<?xml-stylesheet") {
            self.findings
                .add_each(&rules::EXTERNAL, self.line, short(raw));
        }
    }

    fn characters(&mut self) {
        if !self.in_style {
            return;
        }
        let raw = self.raw();
        self.references.note_css(raw, self.line, self.findings);
        let rule = match sheet::parse(raw) {
            Some(rules) => {
                for (class, properties) in rules {
                    self.rules.entry(class).or_default().extend(properties);
                }
                &rules::STYLE_CLASSES
            }
            None => &rules::STYLE_SHEET,
        };
        self.findings.add_each(rule, self.line, "<style>".into());
    }

    fn doctype(&mut self) {
        let raw = self.raw();
        self.findings
            .add(&rules::DOCTYPE, self.line, "<!DOCTYPE …>");
        let mut entities = raw.split("<!ENTITY").skip(1);
        if entities.any(|entity| entity.contains("SYSTEM") || entity.contains("PUBLIC")) {
            self.findings.add_each(
                &rules::EXTERNAL,
                self.line,
                "an entity in another file".into(),
            );
        }
    }

    fn open(&mut self, tag: &BytesStart<'_>, is_svg: bool) -> Result<(), String> {
        let element = Element::new(tag, &self.rules)?;
        let is_root = self.styles.is_empty();
        let style = match self.styles.last() {
            None if is_svg && element.name == "svg" => self.page(&element),
            None => {
                self.findings.add(
                    &rules::NAMESPACE,
                    self.line,
                    format!("<{}>", short(&element.name)),
                );
                StrokeStyle::page(1.0)
            }
            Some(style) => style.within(&element),
        };
        self.styles.push(style);
        self.in_style = is_svg && element.name == "style";
        if self.styles.len() > LIBXML2_LEVELS {
            self.findings.add(
                &rules::DEEP,
                self.line,
                format!("<{}>", short(&element.name)),
            );
        }
        if is_svg {
            self.check_style(&element, style, is_root);
        }
        Ok(())
    }

    /// Checks the size of the page and returns the stroke style at its root.
    fn page(&mut self, root: &Element) -> StrokeStyle {
        let view = root.get("viewBox").map(number::all);
        let side = |key| root.get(key).and_then(number::length_px);
        let (width, height) = (side("width"), side("height"));
        let Some(&[x, y, w, h]) = view.as_deref() else {
            let found = "<svg> without a viewBox of four numbers";
            self.findings.add(&rules::PAGE_SIZE, self.line, found);
            return StrokeStyle::page(1.0);
        };
        let unit = |key| root.get(key).and_then(number::unit).unwrap_or_default();
        let units = [unit("width"), unit("height")];
        let is_stated = units.iter().all(|unit| !unit.is_empty());
        if let Some(rule) = size_rule(width.zip(height), (w, h), (x, y), is_stated) {
            let size = |key| short(root.get(key).unwrap_or("none"));
            let (width, height, view) = (size("width"), size("height"), size("viewBox"));
            let found = format!("<svg> of width {width}, height {height}, viewBox {view}");
            self.findings.add(rule, self.line, found);
        }
        // The printer or the user decides how many px a page in mm has.
        let in_px = is_px(units[0]);
        let scale = width.filter(|_| w > 0.0 && in_px);
        StrokeStyle::page(scale.map_or(1.0, |width| width / w)).within(root)
    }

    fn check_style(&mut self, element: &Element, style: StrokeStyle, is_root: bool) {
        self.references.note(element, self.line, self.findings);
        if !is_root {
            self.look_at_kind(element);
        }
        self.look_at_stroke(element, style);
        self.look_at_values(element);
    }

    fn look_at_kind(&mut self, element: &Element) {
        if let Some(rule) = kind(element) {
            let found = format!("<{}>", short(&element.name));
            self.findings.add_each(rule, self.line, found);
        }
    }

    fn look_at_stroke(&mut self, element: &Element, style: StrokeStyle) {
        if style.has_zero_length(element) {
            let found = element::quote_shape(element);
            self.findings.add(&rules::ZERO_LENGTH, self.line, found);
        }
        if let Some(width_px) = style.hairline_px(element) {
            let found = format!("<{}> with a stroke {width_px:.3} px wide", element.name);
            self.findings.add(&rules::THIN_STROKE, self.line, found);
        }
    }

    fn look_at_values(&mut self, element: &Element) {
        let mut faults = Vec::new();
        for (key, value) in element.attributes().chain(element.styles()) {
            faults.extend(value_rule(key, value).map(|rule| (rule, element.quote(key))));
        }
        for (rule, found) in faults {
            self.findings.add(rule, self.line, found);
        }
    }
}

/// True if lengths in `unit` are px of the page.
fn is_px(unit: &str) -> bool {
    matches!(unit, "" | "px")
}

/// Compares the page's size in px, if it has one, with its `viewBox`. A size that `is_stated` with a unit, as
/// `--width` does, is meant to differ from it.
fn size_rule(
    size: Option<(f64, f64)>,
    view: (f64, f64),
    origin: (f64, f64),
    is_stated: bool,
) -> Option<&'static Rule> {
    let Some((width, height)) = size else {
        return Some(&rules::PAGE_SIZE);
    };
    // Files write sides with a few decimals.
    let misses = (width * view.1 - height * view.0).abs() > ASPECT_TOLERANCE * width * view.1;
    if misses {
        return Some(&rules::PAGE_SIZE);
    }
    let is_scaled = (width, height) != view && !is_stated;
    (is_scaled || origin != (0.0, 0.0)).then_some(&rules::PAGE_SCALE)
}

/// The rule that an attribute's value breaks.
fn value_rule(key: &str, value: &str) -> Option<&'static Rule> {
    if key.len() > 4 && key.starts_with("on") {
        Some(&rules::SCRIPT)
    } else if COLORED.contains(&key) && has_alpha(value) {
        Some(&rules::COLOR_ALPHA)
    } else if key == "opacity" && number::length_px(value).is_some_and(|opacity| opacity < 1.0) {
        Some(&rules::GROUP_OPACITY)
    } else if NUMERIC.contains(&key) && number::has_leading_dot(value) {
        Some(&rules::LEADING_DOT)
    } else {
        None
    }
}

/// The rule that an element breaks by its presence.
fn kind(element: &Element) -> Option<&'static Rule> {
    match element.name.as_str() {
        "script" => Some(&rules::SCRIPT),
        // Its text is looked at.
        "style" => None,
        "text" => Some(&rules::TEXT),
        "tspan" | "textPath" | "stop" => None,
        "linearGradient" | "radialGradient" if is_plain_gradient(element) => None,
        "filter" if is_plain_filter(element) => None,
        "feGaussianBlur" if element.attributes().all(|(key, _)| key == "stdDeviation") => None,
        name if PLAIN.contains(&name) => None,
        name if SHAPES.contains(&name) => Some(&rules::DIALECT),
        _ => Some(&rules::FEATURE),
    }
}

/// True if a gradient is of the kind that all programs draw alike: in px, and without a transform, a focus or a heir.
fn is_plain_gradient(gradient: &Element) -> bool {
    const ATTRIBUTES: [&str; 8] = ["id", "gradientUnits", "x1", "y1", "x2", "y2", "cx", "cy"];
    let is_plain = |(key, _): (&str, &str)| key == "r" || ATTRIBUTES.contains(&key);
    gradient.get("gradientUnits") == Some("userSpaceOnUse") && gradient.attributes().all(is_plain)
}

/// True if a filter is of the kind that all programs draw alike: on a part of the page in px, and in the colours of the page.
fn is_plain_filter(filter: &Element) -> bool {
    let known = dialect::FILTER
        .iter()
        .all(|(key, value)| filter.get(key) == Some(*value));
    let names = dialect::FILTER.map(|(key, _)| key);
    let is_plain =
        |key: &str| key == "id" || names.contains(&key) || dialect::FILTER_PLACE.contains(&key);
    known && filter.attributes().all(|(key, _)| is_plain(key))
}

/// True if a value is a colour with alpha.
fn has_alpha(value: &str) -> bool {
    let value = value.trim();
    let hex = value
        .strip_prefix('#')
        .filter(|h| h.bytes().all(|b| b.is_ascii_hexdigit()));
    hex.is_some_and(|h| h.len() == 4 || h.len() == 8)
        || value.starts_with("rgba(")
        || value.starts_with("hsla(")
}
