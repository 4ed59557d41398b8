//! The facts about an SVG's text that layers need: the end of its root, and the layers that it has.

use std::ops::Range;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::scene::Scene;
use crate::svg::dialect::{INKSCAPE_NAMESPACE, SVG_NAMESPACE};
use crate::svg::{Length, read};

/// The ids of our layers begin with this.
const LAYERS: [&str; 3] = ["stage-", "color-", "object-"];

/// The attribute of the group of layers: width and height of the picture, px.
pub(super) const MARK: &str = "data-strokefit";

/// The facts about a text that are needed to insert layers.
#[derive(Debug, Clone, Default)]
pub(super) struct Outline {
    /// Position of the end tag of the root element.
    pub(super) end: usize,
    /// Elements within the root.
    pub(super) elements: usize,
    /// `text` elements among them.
    pub(super) texts: usize,
    /// Elements among them that show something of another file.
    pub(super) references: usize,
    /// The highest number of a layer with a name like ours.
    pub(super) stages: usize,
    /// Our layers, if nothing follows them in the root.
    pub(super) group: Option<LayerGroup>,
    /// The name of the root element if it has no end tag.
    hollow: Option<String>,
}

/// A group of layers of ours.
#[derive(Debug, Clone)]
pub(super) struct LayerGroup {
    /// Width and height of the picture, px.
    size: String,
    pub(super) start: usize,
    inside: Range<usize>,
    end: usize,
}

impl Outline {
    pub(super) fn of(text: &str) -> Result<Self, String> {
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
            self.group = attribute(tag, MARK).map(|size| LayerGroup {
                size,
                start: at.start,
                inside: at.end..at.end,
                end: at.end,
            });
        }
        Ok(())
    }

    /// Handles the end tag of an element at `depth`.
    fn close(&mut self, depth: usize, at: Range<usize>) {
        match (depth, &mut self.group) {
            (0, _) => self.end = at.start,
            (1, Some(group)) => (group.inside.end, group.end) = (at.start, at.end),
            _ => {}
        }
    }

    /// Forgets the group if anything follows it besides the end of its line.
    fn on_top(mut self, text: &str) -> Self {
        let end = self.end;
        self.group = self
            .group
            .filter(|group| text.get(group.end..end) == Some("\n"));
        self
    }

    /// Adds an end tag to a root element without one.
    pub(super) fn fill(&mut self, text: &mut String) {
        if let Some(name) = self.hollow.take() {
            text.replace_range(self.end..self.end + "/>".len(), &format!("></{name}>"));
            self.end += ">".len();
        }
    }
}

impl LayerGroup {
    /// The layers in the group, with numbers after `before`.
    pub(super) fn scene(&self, text: &str, before: usize) -> Option<Scene> {
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

/// The width of the page in the root of an SVG, if it has a unit.
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

/// Position up to which the text was read.
fn position(xml: &Reader<&[u8]>) -> usize {
    usize::try_from(xml.buffer_position()).unwrap_or(usize::MAX)
}

/// Refuses text that is not SVG, and a root whose size depends on its content, because layers would change it.
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

/// True if a length is a number with an absolute unit of SVG.
fn is_absolute(length: &str) -> bool {
    let length = length.trim();
    let number = length.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let units = ["", "px", "pt", "pc", "mm", "cm", "in"];
    number.parse::<f64>().is_ok() && units.contains(&&length[number.len()..])
}

/// True if the element shows something of another file.
fn refers_outside(tag: &BytesStart<'_>) -> bool {
    let shows = ["image", "use", "feImage"].contains(&tag.local_name().as_ref());
    let target = || attribute(tag, "href").or_else(|| attribute(tag, "xlink:href"));
    shows && target().is_some_and(|target| !target.starts_with('#') && !target.starts_with("data:"))
}

fn attribute(tag: &BytesStart<'_>, key: &str) -> Option<String> {
    let found = tag.attributes().flatten().find(|a| a.key.as_ref() == key)?;
    Some(found.value.into_owned())
}
