//! Any SVG as a page to draw on: its text is kept byte for byte, and layers are put before the end of its
//! root element.
//!
//! The layers stand in a group of their own, which declares its namespaces, undoes the `viewBox` by a
//! `transform`, and resets what strokes inherit: the root may have a prefix, another unit and a stroke
//! opacity, and the strokes are none the wiser. The group bears the size of the picture as
//! `data-strokefit`, by which it is found again. A drawing of ours needs no such group.

use std::ops::Range;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::dialect::{INKSCAPE_NAMESPACE, SVG_NAMESPACE};
use super::{Length, WriteOptions, layers, read};
use crate::error::{Error, ErrorKind, Result};
use crate::scene::Scene;

/// Properties that strokes inherit and do not state themselves. As a style they overrule what the
/// document's style sheets say of groups.
const RESET: &str = "stroke-opacity:1;stroke-dasharray:none;marker:none;paint-order:normal;\
                     shape-rendering:auto;visibility:visible";

/// What the ids of our layers begin with.
const LAYERS: [&str; 2] = ["stage-", "color-"];

/// The attribute of the group of layers: width and height of the picture, px.
const MARK: &str = "data-strokefit";

/// How px of a picture lie in the coordinates of a root element: `[a b c d e f]` of an SVG matrix.
pub type Placement = [f64; 6];

const IDENTITY: Placement = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];

/// An SVG that strokes are laid on.
#[derive(Debug, Clone)]
pub struct Document {
    text: String,
    outline: Outline,
    /// Whether the layers stand as those of our own drawings do.
    is_ours: bool,
    placement: Placement,
    /// Ids that the document does not have: of a stroke to try, and of the group of layers.
    probe: String,
    group: String,
}

impl Document {
    /// The document of an SVG's text.
    ///
    /// # Errors
    /// [`ErrorKind::Svg`] when the text is not well-formed XML or its root does not tell its size.
    pub fn parse(mut text: String) -> Result<Self> {
        let refused = |message| Error::new(ErrorKind::Svg, message);
        let mut outline = Outline::of(&text).map_err(refused)?;
        outline.fill(&mut text);
        Ok(Self {
            is_ours: read(&text).is_ok(),
            probe: unused(&text, "strokefit-probe"),
            group: unused(&text, "strokefit"),
            text,
            outline,
            placement: IDENTITY,
        })
    }

    /// The text as it was given; only a root element without content has been given an end tag.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// How many elements there are within the root.
    pub fn elements(&self) -> usize {
        self.outline.elements
    }

    /// How many of them are text, which is drawn with fonts.
    pub fn texts(&self) -> usize {
        self.outline.texts
    }

    /// How many of them are in other files.
    pub fn references(&self) -> usize {
        self.outline.references
    }

    /// The document without the strokes that have been laid on it, and these, in px of their picture.
    /// `None` where there are none, or they are not as they were written, or something lies on them.
    pub(crate) fn split(&self) -> Option<(Self, Scene)> {
        let group = self.outline.group.as_ref()?;
        let (head, tail) = (&self.text[..group.start], &self.text[self.outline.end..]);
        let document = Self::parse([head, tail].concat()).ok()?;
        let scene = group.scene(&self.text, document.outline.stages)?;
        Some((document, scene))
    }

    /// Says how px of the picture lie in the coordinates of the root.
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

    /// The document with one stroke where layers go, of width 2 and colour #010203.
    pub(crate) fn probed(&self) -> String {
        let probe = &self.probe;
        let layer = format!(
            "<g fill=\"none\" stroke-linecap=\"round\"><path id=\"{probe}\" d=\"M0 0L8 8\" \
             stroke=\"#010203\" stroke-width=\"2\"/></g>\n"
        );
        self.with(&layer, [1, 1])
    }

    /// The document with the stages of `scene`, in px of the picture, as layers on top; as it was if the
    /// scene has no stroke. Layers are numbered on from those that there are.
    pub fn with_layers(&self, scene: &Scene, options: &WriteOptions) -> String {
        if scene.is_empty() {
            return self.text.clone();
        }
        let layers = layers(scene, options, self.outline.stages + 1);
        self.with(&layers, [scene.width, scene.height])
    }

    fn with(&self, layers: &str, [width, height]: [u32; 2]) -> String {
        let (head, tail) = self.text.split_at(self.outline.end);
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
             {MARK}=\"{width} {height}\"{transform} style=\"{RESET}\">\n{layers}</g>\n{tail}",
            self.group
        )
    }
}

/// What has to be known of a text to put layers into it.
#[derive(Debug, Clone, Default)]
struct Outline {
    /// Where the end tag of the root element begins.
    end: usize,
    /// Elements within the root.
    elements: usize,
    /// `text` elements among them.
    texts: usize,
    /// Elements among them that show something of another file.
    references: usize,
    /// The highest number of a layer named as ours are.
    stages: usize,
    /// Layers of ours, up to the end of the root.
    group: Option<Group>,
    /// The name of the root element if it has no end tag.
    hollow: Option<String>,
}

/// A group of layers of ours.
#[derive(Debug, Clone)]
struct Group {
    /// Width and height of the picture, px.
    size: String,
    start: usize,
    inside: Range<usize>,
    end: usize,
}

impl Outline {
    fn of(text: &str) -> Result<Self, String> {
        let mut xml = Reader::from_str(text);
        let (mut outline, mut depth) = (Self::default(), 0_usize);
        loop {
            let start = position(&xml);
            let event = xml.read_event();
            let event = event.map_err(|e| format!("not well-formed XML: {e}"))?;
            let place = start..position(&xml);
            match event {
                Event::Start(tag) => {
                    outline.open(&tag, depth, place)?;
                    depth += 1;
                }
                Event::Empty(tag) => {
                    outline.open(&tag, depth, place.clone())?;
                    if depth == 0 {
                        outline.end = place.end - "/>".len();
                        outline.hollow = Some(tag.name().as_ref().to_owned());
                    }
                }
                Event::End(_) => {
                    depth -= 1;
                    outline.close(depth, place);
                }
                Event::Eof if depth > 0 => {
                    return Err("the file ends within an element: get a complete copy".into());
                }
                Event::Eof if outline.end == 0 => {
                    return Err("there is no <svg> element: give an SVG file".into());
                }
                Event::Eof => return Ok(outline.on_top(text)),
                _ => {}
            }
        }
    }

    fn open(&mut self, tag: &BytesStart<'_>, depth: usize, at: Range<usize>) -> Result<(), String> {
        if depth == 0 {
            return check_root(tag);
        }
        self.elements += 1;
        self.texts += usize::from(tag.local_name().as_ref() == "text");
        self.references += usize::from(refers_outside(tag));
        let id = attribute(tag, "id").unwrap_or_default();
        let number = LAYERS.iter().find_map(|name| id.strip_prefix(name));
        let number = number.and_then(|number| number.parse().ok());
        self.stages = self.stages.max(number.unwrap_or(0));
        if depth == 1 {
            self.group = attribute(tag, MARK).map(|size| Group {
                size,
                start: at.start,
                inside: at.end..at.end,
                end: at.end,
            });
        }
        Ok(())
    }

    /// Takes note of the end tag of an element at `depth`.
    fn close(&mut self, depth: usize, at: Range<usize>) {
        match (depth, &mut self.group) {
            (0, _) => self.end = at.start,
            (1, Some(group)) => (group.inside.end, group.end) = (at.start, at.end),
            _ => {}
        }
    }

    /// Forgets the group unless nothing follows it but the end of its line.
    fn on_top(mut self, text: &str) -> Self {
        let end = self.end;
        self.group = self
            .group
            .filter(|group| text.get(group.end..end) == Some("\n"));
        self
    }

    /// Gives a root element without an end tag one.
    fn fill(&mut self, text: &mut String) {
        if let Some(name) = self.hollow.take() {
            text.replace_range(self.end..self.end + "/>".len(), &format!("></{name}>"));
            self.end += ">".len();
        }
    }
}

impl Group {
    /// The layers in the group, numbered from `before` on.
    fn scene(&self, text: &str, before: usize) -> Option<Scene> {
        let (width, height) = self.size.split_once(' ')?;
        let mut layers = text[self.inside.clone()].to_owned();
        for number in 1..=layers.matches("<g id=").count() {
            for name in LAYERS {
                let id = |number: usize| format!("<g id=\"{name}{number}\"");
                layers = layers.replacen(&id(before + number), &id(number), 1);
            }
        }
        let head = format!(
            "<svg xmlns=\"{SVG_NAMESPACE}\" xmlns:inkscape=\"{INKSCAPE_NAMESPACE}\" \
             width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">"
        );
        read(&format!("{head}{layers}</svg>")).ok()
    }
}

/// The width that the root of an SVG gives its page, if it has a unit.
pub fn page_width(text: &str) -> Option<Length> {
    let mut xml = Reader::from_str(text);
    loop {
        match xml.read_event().ok()? {
            Event::Start(root) | Event::Empty(root) => {
                return Length::parse(&attribute(&root, "width")?);
            }
            Event::Eof => return None,
            _ => {}
        }
    }
}

/// An id like `name` that the text does not have.
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

/// How far the text has been read.
fn position(xml: &Reader<&[u8]>) -> usize {
    usize::try_from(xml.buffer_position()).unwrap_or(usize::MAX)
}

/// Refuses what is no SVG, and a root whose size depends on what is drawn in it: layers would change it.
fn check_root(root: &BytesStart<'_>) -> Result<(), String> {
    let name = root.local_name();
    if name.as_ref() != "svg" {
        let name = name.as_ref();
        return Err(format!(
            "the root element is <{name}>, not <svg>: give an SVG file"
        ));
    }
    let is_absolute = |key| attribute(root, key).is_some_and(|length| is_absolute(&length));
    if attribute(root, "viewBox").is_some() || (is_absolute("width") && is_absolute("height")) {
        return Ok(());
    }
    Err("the root element has neither a viewBox nor a width and height in px: add one".into())
}

/// Whether a length is a number with one of the units of SVG that do not depend on what is around.
fn is_absolute(length: &str) -> bool {
    let length = length.trim();
    let number = length.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let units = ["", "px", "pt", "pc", "mm", "cm", "in"];
    number.parse::<f64>().is_ok() && units.contains(&&length[number.len()..])
}

/// Whether the element shows something that is in another file.
fn refers_outside(tag: &BytesStart<'_>) -> bool {
    let shows = ["image", "use", "feImage"].contains(&tag.local_name().as_ref());
    let target = || attribute(tag, "href").or_else(|| attribute(tag, "xlink:href"));
    shows && target().is_some_and(|target| !target.starts_with('#') && !target.starts_with("data:"))
}

fn attribute(tag: &BytesStart<'_>, key: &str) -> Option<String> {
    let found = tag.attributes().flatten().find(|a| a.key.as_ref() == key)?;
    Some(found.value.into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Shape, Stage, Stroke};

    const SVG: &str = "xmlns=\"http://www.w3.org/2000/svg\"";

    fn document(text: &str) -> Document {
        Document::parse(text.into()).unwrap()
    }

    fn scene() -> Scene {
        let stroke = Stroke {
            shape: Shape::capsule([1.0, 1.0].into(), [5.0, 5.0].into()),
            radius: 1.0,
            color: [1.0, 0.0, 0.0],
            opacity: 1.0,
        };
        Scene {
            stages: vec![Stage {
                strokes: vec![stroke],
            }],
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
        let own = super::super::write(&scene(), &WriteOptions::default());
        let drawn = document(&own).with_layers(&scene(), &WriteOptions::default());
        assert_eq!(
            read(&drawn).unwrap().stages,
            [scene().stages, scene().stages].concat()
        );
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
            ("<svg viewBox=\"0 0 1 1\"><g>", "ends within"),
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
