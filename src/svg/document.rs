//! Adds layers to any SVG: its text stays byte for byte, and the layers go before the end of its root element.
//!
//! The layers are in a group of their own. The group declares its namespaces, undoes the `viewBox` by a
//! `transform`, and resets the properties that marks would inherit; so a prefix, another unit or a
//! stroke opacity on the root does not affect them. The attribute `data-strokefit` holds the size of the
//! picture and marks the group, so that it can be found again. A drawing by strokefit needs no such group.

use super::dialect::{self, INKSCAPE_NAMESPACE, SVG_NAMESPACE};
use super::dom::{Dom, Node};
use super::{Form, Length, WriteOptions, layers, read};
use crate::error::Result;
use crate::scene::{Mark, Scene};

/// The ids of our layers begin with this.
const LAYERS: [&str; 3] = ["stage-", "color-", "object-"];

/// The attribute of the group of layers: width and height of the picture, px.
const MARK: &str = "data-strokefit";

/// Properties that marks inherit and do not set themselves. As a style they override rules for groups in
/// the document's style sheets.
const RESET: &str = "stroke-opacity:1;stroke-dasharray:none;marker:none;paint-order:normal;\
                     shape-rendering:auto;visibility:visible";

/// More of them, which bands inherit.
const RESET_BANDS: &str = ";stroke-linecap:butt;stroke-linejoin:miter;stroke-miterlimit:4";

/// More of them, which only filled marks inherit.
const RESET_FILL: &str = ";fill-opacity:1;fill-rule:nonzero;stroke:none";

/// Maps px of a picture to the coordinates of a root element: `[a b c d e f]` of an SVG matrix.
pub type Placement = [f64; 6];

const IDENTITY: Placement = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];

/// An SVG to which marks are added.
#[derive(Debug, Clone)]
pub struct Document {
    text: String,
    /// Position of the end tag of the root element.
    end: usize,
    elements: usize,
    texts: usize,
    references: usize,
    /// The highest number of a layer with a name like ours.
    stages: usize,
    /// True if the layers need no group of their own, as in strokefit's drawings.
    is_ours: bool,
    placement: Placement,
    /// Ids that are new in the document: of a stroke to probe, and of the group of layers.
    probe: String,
    group: String,
}

impl Document {
    /// Reads the document from an SVG's text.
    ///
    /// # Errors
    /// [`ErrorKind::Svg`](crate::ErrorKind::Svg) when the text is not well-formed XML or its root has no size.
    pub fn parse(mut text: String) -> Result<Self> {
        let dom = Dom::parse(&text);
        let root = dom.root()?;
        check_size(root)?;
        let inner = || root.descendants().filter(Node::is_element);
        let ids = inner().filter_map(|element| element.get("id"));
        let mut document = Self {
            end: root.inside().end,
            elements: inner().count(),
            texts: inner().filter(|element| element.name() == "text").count(),
            references: inner().filter(refers_outside).count(),
            stages: ids.filter_map(layer_number).max().unwrap_or(0),
            // A file of our own dialect has no rules that could restyle our layers.
            is_ours: read::scene(&dom).is_ok(),
            placement: IDENTITY,
            probe: unused(&text, "strokefit-probe"),
            group: unused(&text, "strokefit"),
            text: String::new(),
        };
        // A root of one tag gets an end tag.
        if root.raw().ends_with("/>") && root.inside().is_empty() {
            // `<svg …/>` becomes `<svg …></svg>`, with its own name and prefix; layers go between the two tags.
            let tag = root.bytes().end - "/>".len();
            let name = root.raw().trim_start_matches('<');
            let name = name
                .split(|c: char| c.is_ascii_whitespace() || c == '/')
                .next();
            let end = format!("></{}>", name.unwrap_or_default());
            text.replace_range(tag..tag + "/>".len(), &end);
            document.end = tag + ">".len();
        }
        document.text = text;
        Ok(document)
    }

    /// The text as it was given, except that a root element without content gets an end tag.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Number of elements within the root.
    pub fn elements(&self) -> usize {
        self.elements
    }

    /// Number of text elements, which need fonts.
    pub fn texts(&self) -> usize {
        self.texts
    }

    /// Number of elements that show something of another file.
    pub fn references(&self) -> usize {
        self.references
    }

    /// The document without the marks that strokefit added, and these marks, in px of their picture. `None`
    /// if there are none, if they were changed, or if something lies above them.
    pub(crate) fn split(&self) -> Option<(Self, Scene)> {
        let dom = Dom::parse(&self.text);
        let group = dom.root().ok()?.children().last()?;
        let size = group.get(MARK)?.split_once(' ')?;
        let size = [size.0.parse().ok()?, size.1.parse().ok()?];
        // Only the end of its line may follow.
        let above = self.text.get(group.bytes().end..self.end);
        above.filter(|above| *above == "\n")?;
        let (head, tail) = (&self.text[..group.bytes().start], &self.text[self.end..]);
        let document = Self::parse([head, tail].concat()).ok()?;
        let scene = read::layers(group, size, document.stages + 1).ok()?;
        Some((document, scene))
    }

    /// Sets how px of the picture map to the coordinates of the root.
    pub(crate) fn place(&mut self, placement: Placement) {
        let close = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-5;
        if !placement.iter().zip(&IDENTITY).all(close) {
            self.placement = placement;
        }
    }

    /// The id of the stroke in [`probed`](Self::probed).
    pub(crate) fn probe(&self) -> &str {
        &self.probe
    }

    /// The document with a single stroke in the place of the layers, of width 2 and colour #010203.
    pub(crate) fn probed(&self) -> String {
        let probe = &self.probe;
        let layer = format!(
            "<g fill=\"none\" stroke-linecap=\"round\"><path id=\"{probe}\" d=\"M0 0L8 8\" \
             stroke=\"#010203\" stroke-width=\"2\"/></g>\n"
        );
        self.with(&layer, [1, 1], "")
    }

    /// The document with the stages of `scene`, in px of the picture, as layers on top. It is unchanged if the
    /// scene has no mark. The numbers of layers go on from the document's.
    pub fn with_layers(&self, scene: &Scene, options: &WriteOptions) -> String {
        if scene.is_empty() {
            return self.text.clone();
        }
        let layers = layers(scene, options, self.stages + 1);
        let is_filled = |mark: &Mark| mark.is_area() || mark.is_varying();
        let has_fill = options.form == Form::Outlines || scene.marks().any(is_filled);
        let fill = if has_fill { RESET_FILL } else { "" };
        let has_bands = scene.marks().any(Mark::is_butt);
        let bands = if has_bands { RESET_BANDS } else { "" };
        let reset = [fill, bands].concat();
        self.with(&layers, [scene.width, scene.height], &reset)
    }

    /// The document with `layers` of a picture of this size, which also need the properties `reset`.
    fn with(&self, layers: &str, [width, height]: [u32; 2], reset: &str) -> String {
        // By position in the text, so that every other byte stays as it is.
        let (head, tail) = self.text.split_at(self.end);
        if self.is_ours && self.placement == IDENTITY {
            return format!("{head}{layers}{tail}");
        }
        let transform = match self.placement {
            IDENTITY => String::new(),
            [a, b, c, d, e, f] => format!(" transform=\"matrix({a} {b} {c} {d} {e} {f})\""),
        };
        format!(
            "{head}<g xmlns=\"{SVG_NAMESPACE}\" xmlns:inkscape=\"{INKSCAPE_NAMESPACE}\" \
             id=\"{}\" inkscape:groupmode=\"layer\" inkscape:label=\"strokefit\" \
             {MARK}=\"{width} {height}\"{transform} style=\"{RESET}{reset}\">\n{layers}</g>\n{tail}",
            self.group
        )
    }
}

/// The width of the page in the root of an SVG, if it has a unit.
pub fn page_width(text: &str) -> Option<Length> {
    let dom = Dom::parse(text);
    let root = dom.nodes().find(Node::is_element)?;
    Length::parse(root.get("width")?)
}

/// Refuses a root whose size depends on its content, because layers would change it.
fn check_size(root: Node<'_>) -> Result<()> {
    let length = |key| root.get(key).and_then(dialect::length_px);
    if root.get("viewBox").is_some() || length("width").and(length("height")).is_some() {
        return Ok(());
    }
    let why = "the root element has neither a viewBox nor a width and height in px: add one";
    Err(root.refused(why))
}

/// The number in the id of a layer like ours.
fn layer_number(id: &str) -> Option<usize> {
    let number = LAYERS.iter().find_map(|name| id.strip_prefix(name));
    number?.parse().ok()
}

/// True if the element shows something of another file.
fn refers_outside(element: &Node<'_>) -> bool {
    let target = element.get("href").or_else(|| element.get("xlink:href"));
    let is_outside = |target: &str| !target.starts_with('#') && !target.starts_with("data:");
    ["image", "use", "feImage"].contains(&element.name()) && target.is_some_and(is_outside)
}

/// An id like `name` that is new in the text.
fn unused(text: &str, name: &str) -> String {
    let is_used =
        |id: &str| text.contains(&format!("\"{id}\"")) || text.contains(&format!("'{id}'"));
    let mut id = name.to_owned();
    let mut number = 1;
    while is_used(&id) {
        number += 1;
        id = format!("{name}-{number}");
    }
    id
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Area, Cap, Path, PathPoint, Stage, Stroke};
    use crate::svg::Group;
    use crate::verify::{self, Size};

    const SVG: &str = "xmlns=\"http://www.w3.org/2000/svg\"";

    fn document(text: &str) -> Document {
        Document::parse(text.into()).unwrap()
    }

    fn scene() -> Scene {
        let stroke = Stroke {
            path: Path::line((1.0, 1.0).into(), (5.0, 5.0).into()),
            radius: 1.0,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [1.0, 0.0, 0.0],
            opacity: 1.0,
        };
        Scene {
            stages: vec![Stage::from_iter([stroke])],
            ..Scene::empty(10, 10, None)
        }
    }

    #[test]
    fn the_text_stays_around_the_layers() {
        let text = "<?xml version=\"1.0\"?>\n<!-- </svg> -->\n\
                    <x:svg viewBox=\"0 0 10 10\" xmlns:x=\"a\"><x:g id='stage-4'/>\
                    <![CDATA[</x:svg>]]>\n</x:svg >\n<!-- after -->\n";
        let drawn = document(text).with_layers(&scene(), &WriteOptions::default());
        let (head, tail) = text.split_at(text.find("</x:svg >").unwrap());
        assert!(drawn.starts_with(head) && drawn.ends_with(tail), "{drawn}");
        assert!(drawn.contains("<g id=\"stage-5\""), "{drawn}");
    }

    #[test]
    fn without_strokes_nothing_changes() {
        let text = format!("<svg {SVG} width=\"3mm\" height=\"3mm\">  </svg>");
        let empty = Scene::empty(10, 10, None);
        let drawn = document(&text).with_layers(&empty, &WriteOptions::default());
        assert_eq!(drawn, text);
    }

    #[test]
    fn a_root_without_content_gets_an_end() {
        let document = document(&format!("<svg {SVG} viewBox=\"0 0 1 1\"/>\n"));
        assert_eq!(
            document.text(),
            format!("<svg {SVG} viewBox=\"0 0 1 1\"></svg>\n")
        );
    }

    #[test]
    fn a_drawing_of_ours_stays_one() {
        for (group, form) in [
            (Group::Stage, Form::Plain),
            (Group::Color, Form::Smallest),
            (Group::Object, Form::Css),
        ] {
            let options = WriteOptions {
                group,
                form,
                ..WriteOptions::default()
            };
            let own = super::super::write(&scene(), &options);
            let drawn = document(&own).with_layers(&scene(), &options);
            let stages = [scene().stages, scene().stages].concat();
            assert_eq!(read(&drawn).unwrap().stages, stages, "{drawn}");
        }
    }

    #[test]
    fn strokes_laid_on_a_document_are_found_again() {
        let text = format!("<svg {SVG} viewBox=\"0 0 5 5\"><g id=\"stage-7\"/></svg>");
        let page = document(&text);
        let mut two = scene();
        two.stages.extend(scene().stages);
        let drawn = page.with_layers(&two, &WriteOptions::default());
        let (below, strokes) = document(&drawn).split().unwrap();
        assert_eq!((below.text(), strokes), (text.as_str(), two));
    }

    /// A frame: an area with a hole, as long as both rings turn in their ways and the rule is nonzero.
    fn frame() -> Area {
        let ring = |corners: [[f64; 2]; 4]| {
            let points = corners.map(|[x, y]| PathPoint::on((x, y).into()));
            Path::new(points.into(), true).unwrap()
        };
        let outer = ring([[1.0, 1.0], [9.0, 1.0], [9.0, 9.0], [1.0, 9.0]]);
        let inner = ring([[3.0, 3.0], [3.0, 7.0], [7.0, 7.0], [7.0, 3.0]]);
        let twice = ring([[1.0, 1.0], [5.0, 1.0], [5.0, 3.0], [1.0, 3.0]]);
        Area::plain(vec![outer, inner, twice], [0.2, 0.4, 0.6], 1.0)
    }

    #[test]
    fn what_a_document_says_of_fills_and_strokes_does_not_change_marks() {
        let text = format!(
            "<svg {SVG} viewBox=\"0 0 10 10\" fill-rule=\"evenodd\" fill-opacity=\"0.3\" \
             stroke=\"#0f0\" stroke-width=\"3\"></svg>"
        );
        let bare = format!("<svg {SVG} viewBox=\"0 0 10 10\"></svg>");
        let mut scene = scene();
        scene.stages[0].marks.push(frame().into());
        let drawn = |form, text: &str| {
            let options = WriteOptions {
                form,
                ..WriteOptions::default()
            };
            let text = document(text).with_layers(&scene, &options);
            verify::render(&text, Size::Scale(4.0), Some([1.0; 3])).unwrap()
        };
        for form in Form::ALL {
            assert!(drawn(form, &text) == drawn(form, &bare), "{form:?}");
        }
        let laid = document(&text).with_layers(&scene, &WriteOptions::default());
        let (below, marks) = document(&laid).split().unwrap();
        assert_eq!((below.text(), marks), (text.as_str(), scene));
    }

    #[test]
    fn strokes_that_were_edited_or_covered_are_not_taken_up() {
        let page = document(&format!("<svg {SVG} viewBox=\"0 0 5 5\"></svg>"));
        let drawn = page.with_layers(&scene(), &WriteOptions::default());
        for changed in [
            drawn.replace("</svg>", "<rect/></svg>"),
            drawn.replace("stroke-width", "class=\"a\" stroke-width"),
            drawn.replace("10 10", "10"),
        ] {
            assert_ne!(changed, drawn);
            assert!(document(&changed).split().is_none(), "{changed}");
        }
    }

    #[test]
    fn what_cannot_be_seen_is_counted() {
        let page = document(&format!(
            "<svg {SVG} viewBox=\"0 0 5 5\"><text>a</text><image href=\"a.png\"/>\
             <image xlink:href=\"data:image/png;base64,\"/><use href=\"#a\"/><a href=\"a.html\"/></svg>"
        ));
        assert_eq!(
            (page.elements(), page.texts(), page.references()),
            (5, 1, 1)
        );
    }

    #[test]
    fn what_has_no_root_end_or_size_is_refused() {
        for (text, why) in [
            ("", "no <svg>"),
            ("<!-- nothing -->", "no <svg>"),
            ("<svg viewBox=\"0 0 1 1\"><g>", "ends before </g>"),
            ("<svg viewBox=\"0 0 1 1\"><g></svg>", "not well-formed"),
            (
                "<svg width=\"4\" height=\"100%\"></svg>",
                "neither a viewBox",
            ),
        ] {
            let error = Document::parse(text.into()).unwrap_err();
            assert!(error.to_string().contains(why), "{text}: {error}");
        }
    }
}
