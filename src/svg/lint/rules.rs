//! The rules of the lint: what each finds, what it leads to, and the remedy.

use std::collections::BTreeMap;

use super::Severity::{self, Error, Note, Warning};
use super::page::{Element, Page, Sheet, Size};
use super::values;
use crate::svg::dialect;
use crate::svg::dom::{Content, Node, short};
use Check::{Any, Each, Value, Whole};

/// One kind of problem that a file can have.
pub(super) struct Rule {
    pub(super) name: &'static str,
    pub(super) severity: Severity,
    pub(super) why: &'static str,
    pub(super) remedy: &'static str,
    check: Check,
}

/// How a rule finds its places.
enum Check {
    /// By an element in the root. Each name is a finding of its own.
    Each(fn(&Element<'_>) -> bool),
    /// By the name and the value of an attribute or property. All places are one finding.
    Value(fn(&str, &str) -> bool),
    /// By what an element has. All places are one finding.
    Any(fn(&Element<'_>) -> Option<String>),
    /// In the whole file. Each text is a finding of its own.
    Whole(fn(&Page<'_>) -> Vec<Found>),
}

/// A place in the text, and what is there.
pub(super) type Found = (usize, String);

impl Rule {
    /// True if each text that is found is a finding of its own.
    pub(super) fn is_each(&self) -> bool {
        matches!(self.check, Each(_) | Whole(_))
    }

    /// All places, in the order of the text.
    pub(super) fn places(&self, page: &Page<'_>) -> Vec<Found> {
        if let Whole(check) = self.check {
            return check(page);
        }
        let root = page.root().map(|root| root.bytes().start);
        let mut found = Vec::new();
        for element in &page.elements {
            let at = element.node.bytes().start;
            match self.check {
                Each(check) if Some(at) != root && check(element) => {
                    found.push(named(element.node))
                }
                Value(check) => {
                    let values = element.values().filter(|(key, value)| check(key, value));
                    found.extend(values.map(|(key, _)| (at, element.quote(key))));
                }
                Any(check) => found.extend(check(element).map(|what| (at, what))),
                Each(_) | Whole(_) => {}
            }
        }
        found
    }
}

/// Name of the rule about references to other files.
pub(super) const EXTERNAL: &str = "external-reference";

/// File size at which readers built on libxml2 stop, bytes.
const LIBXML2_BYTES: usize = 10_000_000;

/// Widest stroke, px, that some renderers draw as a hairline: 1 px included, also where a rotation rounds it up.
const HAIRLINE_PX: f64 = 1.0 + 1e-9;

/// Largest relative difference of the aspect ratios of page and `viewBox`: files write sides with a few decimals.
const ASPECT_TOLERANCE: f64 = 1e-3;

/// Attributes that hold colours.
#[rustfmt::skip]
const COLORED: [&str; 6] = ["color", "fill", "flood-color", "lighting-color", "stop-color", "stroke"];

/// Attributes that hold numbers.
#[rustfmt::skip]
const NUMERIC: [&str; 24] = [
    "cx", "cy", "d", "fill-opacity", "height", "offset", "opacity", "points", "r", "rx", "ry",
    "stop-opacity", "stroke-dasharray", "stroke-opacity", "stroke-width", "transform",
    "viewBox", "width", "x", "x1", "x2", "y", "y1", "y2",
];

/// Elements that all renderers draw alike, although they are not of the dialect.
const SHAPES: [&str; 3] = ["line", "polygon", "polyline"];

/// Elements of the dialect, elements that neither draw anything nor affect the drawing, and those with rules of their own.
#[rustfmt::skip]
const PLAIN: [&str; 16] = [
    "circle", "defs", "desc", "ellipse", "g", "metadata", "path", "rect", "script", "stop", "style", "svg", "text",
    "textPath", "title", "tspan",
];

/// All rules.
pub(super) const RULES: [Rule; 23] = [
    Rule {
        name: "not-xml",
        severity: Error,
        why: "no program reads beyond this place",
        remedy: "correct the XML, or get a complete copy",
        check: Whole(|page| {
            Vec::from_iter(
                page.dom
                    .fault()
                    .map(|fault| (fault.at, short(&fault.message))),
            )
        }),
    },
    Rule {
        name: "namespace",
        severity: Error,
        why: "programs draw nothing of it",
        remedy: "write xmlns=\"http://www.w3.org/2000/svg\" on the root, with http",
        check: Whole(|page| Vec::from_iter(page.root().filter(|root| !is_page(root)).map(named))),
    },
    Rule {
        name: EXTERNAL,
        severity: Error,
        why: "it is drawn only where that file or address can be reached",
        remedy: "embed it as data:, or remove it",
        check: Whole(external),
    },
    Rule {
        name: "missing-id",
        severity: Error,
        why: "no element has this id; some programs then draw nothing, others ignore the reference",
        remedy: "give this id to the intended element",
        check: Whole(missing_ids),
    },
    Rule {
        name: "duplicate-id",
        severity: Warning,
        why: "programs differ in which of these elements they use",
        remedy: "make every id unique",
        check: Whole(duplicate_ids),
    },
    Rule {
        name: "layer-id",
        severity: Note,
        why: "editors give the layer a new id at every save",
        remedy: "give the group an id that starts with a letter",
        check: Any(|e| {
            let is_layer = e.get("inkscape:groupmode") == Some("layer");
            (is_layer && e.get("id").is_none()).then(|| "a layer without an id".into())
        }),
    },
    Rule {
        name: "id-start",
        severity: Note,
        why: "style sheets and some programs cannot name such an id",
        remedy: "start ids with a letter",
        check: Value(|key, id| key == "id" && !id.trim().starts_with(char::is_alphabetic)),
    },
    Rule {
        name: "page-size",
        severity: Warning,
        why: "programs differ in the size of the page",
        remedy: "give a width and height, and a viewBox=\"0 0 W H\" of the same aspect ratio",
        check: Whole(|page| Vec::from_iter(size(page, false))),
    },
    Rule {
        name: "page-scale",
        severity: Note,
        why: "one unit of the file is not one px of the page",
        remedy: "nothing, if this is intended; otherwise use the same numbers in width, height and viewBox=\"0 0 W H\"",
        check: Whole(|page| Vec::from_iter(size(page, true))),
    },
    Rule {
        name: "zero-length",
        severity: Warning,
        why: "many programs drop it, although the specification makes it a dot if it has round caps",
        remedy: "use a segment of length 0.01, or a circle",
        check: Any(|e| Some(e.quote(e.stroke_px().and(zero_length(e))?))),
    },
    Rule {
        name: "thin-stroke",
        severity: Warning,
        why: "at widths up to 1 px, resvg and browsers draw a tenth less ink than Cairo",
        remedy: "use a width of at least 1.02 px and a lower opacity",
        check: Any(|e| {
            let px = e.stroke_px().filter(|&px| px > 0.0 && px <= HAIRLINE_PX)?;
            Some(format!("<{}> with a stroke {px:.3} px wide", e.name()))
        }),
    },
    Rule {
        name: "color-alpha",
        severity: Warning,
        why: "Inkscape draws it opaque, and CairoSVG #rrggbbaa",
        remedy: "write #rrggbb and stroke-opacity or fill-opacity",
        check: Value(|key, value| COLORED.contains(&key) && values::has_alpha(value)),
    },
    Rule {
        name: "group-opacity",
        severity: Warning,
        why: "it needs a picture of its own for blending, which is slow, and some importers ignore it",
        remedy: "write stroke-opacity or fill-opacity on each element",
        check: Value(|key, value| {
            key == "opacity" && dialect::length_px(value).is_some_and(|opacity| opacity < 1.0)
        }),
    },
    Rule {
        name: "leading-dot",
        severity: Note,
        why: "some readers, Android's among them, fail on a number without a leading digit",
        remedy: "write 0.5, not .5",
        check: Value(|key, value| NUMERIC.contains(&key) && values::has_leading_dot(value)),
    },
    Rule {
        name: "script",
        severity: Warning,
        why: "only browsers run it, and only if the file is opened directly",
        remedy: "remove it",
        check: Any(script),
    },
    Rule {
        name: "feature",
        severity: Warning,
        why: "programs draw it differently, or not at all",
        remedy: "draw it with paths, or expect differences",
        check: Each(is_feature),
    },
    Rule {
        name: "text",
        severity: Warning,
        why: "it looks different with the fonts of each machine, and resvg loads no fonts here",
        remedy: "convert it to paths",
        check: Each(|e| e.name() == "text"),
    },
    Rule {
        name: "style-sheet",
        severity: Warning,
        why: "many importers ignore style sheets, and so does this lint",
        remedy: "put the properties on the elements",
        check: Whole(|page| sheets(page, |sheet| sheet.rules.is_none())),
    },
    Rule {
        name: "style-classes",
        severity: Note,
        why: "editors and browsers draw it alike, but many importers ignore style sheets and fill all black",
        remedy: "nothing, unless such a program is to read the file; then put the properties on the elements",
        check: Whole(|page| sheets(page, |sheet| sheet.rules.is_some())),
    },
    Rule {
        name: "doctype",
        severity: Note,
        why: "strict readers refuse document types and their entities",
        remedy: "remove it and expand the entities",
        check: Whole(doctypes),
    },
    Rule {
        name: "dialect",
        severity: Note,
        why: "all programs draw it alike, but strokefit never writes such an element",
        remedy: "nothing, unless strokefit should read the file as strokes",
        check: Each(|e| SHAPES.contains(&e.name())),
    },
    Rule {
        name: "large-file",
        severity: Error,
        why: "programs built on libxml2 stop at 10 MB",
        remedy: "use fewer strokes or decimals",
        check: Whole(large),
    },
    Rule {
        name: "deep",
        severity: Error,
        why: "programs built on libxml2 stop at 256 levels",
        remedy: "remove levels of groups",
        check: Whole(|page| page.deep.iter().copied().map(named).collect()),
    },
];

/// The name of an element, and its place.
fn named(node: Node<'_>) -> Found {
    (node.bytes().start, format!("<{}>", short(node.name())))
}

fn is_page(root: &Node<'_>) -> bool {
    root.is_svg() && root.name() == "svg"
}

fn sheets(page: &Page<'_>, is_found: impl Fn(&Sheet<'_>) -> bool) -> Vec<Found> {
    let found = page.sheets.iter().filter(|sheet| is_found(sheet));
    found.map(|sheet| named(sheet.node)).collect()
}

/// The places of each id.
fn ids<'d>(page: &Page<'d>) -> BTreeMap<&'d str, Vec<usize>> {
    let mut ids: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for element in &page.elements {
        let places = element.get("id").map(|id| ids.entry(id).or_default());
        places
            .into_iter()
            .for_each(|places| places.push(element.node.bytes().start));
    }
    ids
}

fn missing_ids(page: &Page<'_>) -> Vec<Found> {
    let ids = ids(page);
    let wanted = page.targets().into_iter().filter_map(|(at, target)| {
        let id = target
            .strip_prefix('#')
            .filter(|id| !ids.contains_key(id))?;
        Some((at, format!("\"#{}\"", short(id))))
    });
    wanted.collect()
}

fn duplicate_ids(page: &Page<'_>) -> Vec<Found> {
    let ids = ids(page).into_iter().filter(|(_, places)| places.len() > 1);
    let found = |id: &str| format!("id=\"{}\"", short(id));
    ids.flat_map(|(id, places)| places.into_iter().map(move |at| (at, found(id))))
        .collect()
}

/// All that is in other files: targets of references, imports of style sheets, style sheets and entities.
fn external(page: &Page<'_>) -> Vec<Found> {
    let mut found = Vec::new();
    for (at, target) in page.targets() {
        if !(target.is_empty() || target.starts_with('#') || values::is_embedded(&target)) {
            found.push((at, format!("\"{}\"", short(&target))));
        }
    }
    for sheet in page
        .sheets
        .iter()
        .filter(|sheet| sheet.text.contains("@import"))
    {
        found.push((sheet.node.bytes().start, "@import in a style sheet".into()));
    }
    for node in page.dom.nodes() {
        let names_file = |entity: &str| entity.contains("SYSTEM") || entity.contains("PUBLIC");
        let what = match node.content() {
            Content::Instruction if node.raw().starts_with("<?xml-stylesheet") => short(node.raw()),
            Content::DocType if node.raw().split("<!ENTITY").skip(1).any(names_file) => {
                "an entity in another file".into()
            }
            _ => continue,
        };
        found.push((node.bytes().start, what));
    }
    found.sort();
    found
}

/// A script: an element, or an attribute such as `onload`, which the root has most often.
fn script(element: &Element<'_>) -> Option<String> {
    let is_handler = |key: &str| key.len() > 4 && key.starts_with("on");
    let handler = element.values().find(|(key, _)| is_handler(key));
    let handler = handler.map(|(key, _)| element.quote(key));
    handler.or_else(|| (element.name() == "script").then(|| "<script>".into()))
}

fn doctypes(page: &Page<'_>) -> Vec<Found> {
    let nodes = page.dom.nodes();
    let types = nodes.filter(|node| matches!(node.content(), Content::DocType));
    types
        .map(|node| (node.bytes().start, "<!DOCTYPE …>".into()))
        .collect()
}

fn large(page: &Page<'_>) -> Vec<Found> {
    let bytes = page.text.len();
    let found = || (0, format!("{bytes} bytes"));
    Vec::from_iter((bytes > LIBXML2_BYTES).then(found))
}

/// The page, unless it has as many px as its `viewBox` has units. Its aspect ratio `fits`, or it does not.
fn size(page: &Page<'_>, fits: bool) -> Option<Found> {
    let root = page.root().filter(is_page)?;
    let (size, at) = (Size::of(root), root.bytes().start);
    let Some([x, y, w, h]) = size.view else {
        let found = || (at, "<svg> without a viewBox of four numbers".into());
        return (!fits).then(found);
    };
    let px = size.width.zip(size.height);
    let is_close = |width, height| f64::abs(width * h - height * w) <= ASPECT_TOLERANCE * width * h;
    let is_fitting = px.is_some_and(|(width, height)| is_close(width, height));
    let is_equal = size.has_units || px == Some((w, h));
    if is_fitting != fits || (fits && is_equal && (x, y) == (0.0, 0.0)) {
        return None;
    }
    let shown = |key| short(root.get(key).unwrap_or("none"));
    let [width, height, view] = ["width", "height", "viewBox"].map(shown);
    let found = format!("<svg> of width {width}, height {height}, viewBox {view}");
    Some((at, found))
}

/// The attribute with the geometry of an element, if its stroke has zero length.
fn zero_length(element: &Element<'_>) -> Option<&'static str> {
    let value = |key| element.get(key).and_then(dialect::length_px).unwrap_or(0.0);
    let (key, is_point) = match element.name() {
        "path" => ("d", values::has_zero_length(element.get("d")?)),
        "line" => (
            "x1",
            value("x1") == value("x2") && value("y1") == value("y2"),
        ),
        "polyline" | "polygon" => (
            "points",
            values::has_zero_length(&format!("M{}", element.get("points")?)),
        ),
        _ => return None,
    };
    is_point.then_some(key)
}

/// True if programs draw an element differently. Gradients and filters of the dialect they draw alike.
fn is_feature(element: &Element<'_>) -> bool {
    const GRADIENT: [&str; 9] = [
        "id",
        "gradientUnits",
        "x1",
        "y1",
        "x2",
        "y2",
        "cx",
        "cy",
        "r",
    ];
    let has_only = |keys: &[&str]| {
        element
            .node
            .attributes()
            .iter()
            .all(|(key, _)| keys.contains(key))
    };
    let has = |&(key, value): &(&str, &str)| element.get(key) == Some(value);
    let is_plain = match element.name() {
        dialect::LINEAR | dialect::RADIAL => {
            has(&("gradientUnits", "userSpaceOnUse")) && has_only(&GRADIENT)
        }
        "filter" => {
            let names = dialect::FILTER.map(|(key, _)| key);
            let known = [&["id"], &names[..], &dialect::FILTER_PLACE].concat();
            dialect::FILTER.iter().all(has) && has_only(&known)
        }
        "feGaussianBlur" => has_only(&[dialect::GAUSSIAN.1]),
        name => PLAIN.contains(&name) || SHAPES.contains(&name),
    };
    !is_plain
}
