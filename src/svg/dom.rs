//! The text of an SVG as a tree: the one that the reader, the lint and a [`Document`](super::Document) walk.
//!
//! Each node knows its bytes in the text, so bytes that are not read can stay as they are. Values of attributes and texts are
//! as in the file: no entity is expanded. White space between elements, comments and the XML declaration are no nodes.

use std::borrow::Cow;
use std::ops::Range;

use quick_xml::events::attributes::Attributes;
use quick_xml::events::{BytesStart, Event};
use quick_xml::name::{Namespace, ResolveResult};
use quick_xml::reader::NsReader;

use super::dialect::SVG_NAMESPACE;
use crate::error::{Error, ErrorKind, Result};

/// Most nodes of a text. As many take some hundred MB; resvg stops at a quarter of them.
const MAX_NODES: usize = 4_000_000;

/// A text and its nodes, up to the first place that is not well-formed.
#[derive(Debug)]
pub(super) struct Dom<'a> {
    text: &'a str,
    /// In the order of the text: each element before its content. So nesting of any depth needs no recursion.
    items: Vec<Item<'a>>,
    /// The names and values of all attributes.
    attributes: Vec<(&'a str, &'a str)>,
    /// Positions of line ends.
    line_ends: Vec<usize>,
    fault: Option<Fault>,
}

/// The reason why a text is not well-formed.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) at: usize,
    pub(super) message: String,
}

#[derive(Debug)]
struct Item<'a> {
    content: Content<'a>,
    /// From the start tag to the end tag, and between them.
    bytes: Range<usize>,
    inside: Range<usize>,
    /// Index of the first item after this one and its content.
    next: usize,
}

/// The content of a node.
#[derive(Debug, Clone)]
pub(super) enum Content<'a> {
    Element {
        /// Without its prefix.
        name: &'a str,
        /// True if it is in SVG's namespace.
        is_svg: bool,
        attributes: Range<usize>,
    },
    /// Text, a CDATA section, or a reference to an entity.
    Text(&'a str),
    /// A processing instruction.
    Instruction,
    DocType,
}

/// A node of a tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node<'d> {
    dom: &'d Dom<'d>,
    item: &'d Item<'d>,
    index: usize,
}

impl<'a> Dom<'a> {
    /// The nodes of a text, up to the first place where it is not well-formed.
    pub(super) fn parse(text: &'a str) -> Self {
        let mut dom = Self {
            text,
            items: Vec::new(),
            attributes: Vec::new(),
            line_ends: text.match_indices('\n').map(|(at, _)| at).collect(),
            fault: None,
        };
        let mut open = Vec::new();
        dom.fault = dom.build(&mut open).err();
        // Elements that are cut off end with the text.
        let next = dom.items.len();
        // The tree stays usable up to the fault, so that a lint can report more than it.
        for index in open {
            let item = &mut dom.items[index];
            (item.inside.end, item.bytes.end, item.next) = (text.len(), text.len(), next);
        }
        dom
    }

    /// Appends all nodes. The elements that have no end yet are in `open`.
    fn build(&mut self, open: &mut Vec<usize>) -> Result<(), Fault> {
        let text = self.text;
        // The parser counts from after a byte order mark.
        let body = text.strip_prefix('\u{feff}').unwrap_or(text);
        let place = |at: u64| text.len() - body.len() + usize::try_from(at).unwrap_or(body.len());
        let mut xml = NsReader::from_str(body);
        loop {
            // Positions before and after an event are the bytes of its node.
            let start = place(xml.buffer_position());
            let (namespace, event) = match xml.read_resolved_event() {
                Ok(resolved) => resolved,
                Err(error) => return Err(Fault::new(place(xml.error_position()), error)),
            };
            // By namespace rather than by prefix: `x:svg` is SVG if the file binds x to it.
            let is_svg = namespace == ResolveResult::Bound(Namespace(SVG_NAMESPACE));
            let end = place(xml.buffer_position());
            match event {
                Event::Start(tag) => {
                    self.open(&tag, start..end, is_svg)?;
                    open.push(self.items.len() - 1);
                }
                Event::Empty(tag) => self.open(&tag, start..end, is_svg)?,
                Event::End(_) => {
                    let next = self.items.len();
                    // Items so far are the element and all in it, so the next item is the first one after it.
                    if let Some(item) = open.pop().and_then(|at| self.items.get_mut(at)) {
                        (item.inside.end, item.bytes.end, item.next) = (start, end, next);
                    }
                }
                Event::Text(part) if part.trim().is_empty() => {}
                Event::Text(_) | Event::GeneralRef(_) => {
                    let content = text.get(start..end).unwrap_or_default();
                    self.push(Content::Text(content), start..end)?;
                }
                Event::CData(part) => {
                    // The text lies between the delimiters.
                    let from = start + "<![CDATA[".len();
                    let content = text.get(from..from + part.len()).unwrap_or_default();
                    self.push(Content::Text(content), start..end)?;
                }
                Event::PI(_) => self.push(Content::Instruction, start..end)?,
                Event::DocType(_) => self.push(Content::DocType, start..end)?,
                Event::Comment(_) | Event::Decl(_) => {}
                Event::Eof => break,
            }
        }
        // The parser accepts an end of file inside an element, which is a fault here.
        match open.last() {
            Some(&index) => {
                let name = self.node(index).map_or("", Node::name);
                Err(Fault::new(
                    text.trim_end().len(),
                    format!("the file ends before </{name}>"),
                ))
            }
            None => Ok(()),
        }
    }

    /// Appends the element of a tag.
    fn open(
        &mut self,
        tag: &BytesStart<'_>,
        bytes: Range<usize>,
        is_svg: bool,
    ) -> Result<(), Fault> {
        // From the text itself, so that names and values live as long as it does.
        let from = bytes.start + "<".len();
        let inner = self.text.get(from..from + tag.len()).unwrap_or_default();
        let name = inner.get(..tag.name().as_ref().len()).unwrap_or_default();
        let first = self.attributes.len();
        for attribute in Attributes::new(inner, name.len()) {
            let attribute = attribute.map_err(|error| Fault::new(bytes.start, error))?;
            // Always borrowed: attributes of a `str` are slices of it.
            if let Cow::Borrowed(value) = attribute.value {
                self.attributes.push((attribute.key.into_inner(), value));
            }
        }
        let content = Content::Element {
            name: name.rsplit(':').next().unwrap_or(name),
            is_svg,
            attributes: first..self.attributes.len(),
        };
        self.push(content, bytes)
    }

    fn push(&mut self, content: Content<'a>, bytes: Range<usize>) -> Result<(), Fault> {
        let next = self.items.len() + 1;
        if next > MAX_NODES {
            let message = format!("the file has more than {MAX_NODES} elements and texts");
            return Err(Fault::new(bytes.start, message));
        }
        // An empty place after the tag, until an end tag says more.
        let inside = bytes.end..bytes.end;
        self.items.push(Item {
            content,
            bytes,
            inside,
            next,
        });
        Ok(())
    }

    fn node(&self, index: usize) -> Option<Node<'_>> {
        let (dom, item) = (self, self.items.get(index)?);
        Some(Node { dom, item, index })
    }

    /// All nodes, in the order of the text.
    pub(super) fn nodes(&self) -> impl Iterator<Item = Node<'_>> {
        (0..self.items.len()).filter_map(|index| self.node(index))
    }

    /// The nodes that are in no element.
    pub(super) fn top(&self) -> impl Iterator<Item = Node<'_>> {
        self.siblings(0..self.items.len())
    }

    fn siblings(&self, range: Range<usize>) -> impl Iterator<Item = Node<'_>> {
        // From one sibling to the next in one step, past all that is inside.
        let first = self.node(range.start);
        let next = move |node: &Node<'_>| self.node(node.item.next);
        std::iter::successors(first, next).take_while(move |node| node.index < range.end)
    }

    /// The reason why there are not all nodes, if so.
    pub(super) fn fault(&self) -> Option<&Fault> {
        self.fault.as_ref()
    }

    /// The root of an SVG.
    ///
    /// # Errors
    /// [`ErrorKind::Svg`] when the text is not well-formed, or has no `<svg>`.
    pub(super) fn root(&self) -> Result<Node<'_>> {
        if let Some(Fault { at, message }) = &self.fault {
            let remedy = "correct it, or get a complete copy";
            return Err(self.refused(*at, format!("not well-formed XML: {message}: {remedy}")));
        }
        let root = self.top().find(Node::is_element);
        match root.map(|root| (root, root.name())) {
            Some((root, "svg")) => Ok(root),
            Some((root, name)) => Err(root.refused(format!(
                "the root element is <{name}>, not <svg>: give an SVG file"
            ))),
            None => Err(self.refused(0, "there is no <svg> element: give an SVG file")),
        }
    }

    /// The line of a place in the text, from 1.
    pub(super) fn line(&self, at: usize) -> usize {
        1 + self.line_ends.partition_point(|&end| end < at)
    }

    fn refused(&self, at: usize, why: impl std::fmt::Display) -> Error {
        Error::new(ErrorKind::Svg, format!("SVG line {}: {why}", self.line(at)))
    }
}

impl Fault {
    fn new(at: usize, message: impl ToString) -> Self {
        let message = message.to_string();
        Self { at, message }
    }
}

impl<'d> Node<'d> {
    pub(super) fn content(&self) -> &'d Content<'d> {
        &self.item.content
    }

    pub(super) fn is_element(&self) -> bool {
        matches!(self.content(), Content::Element { .. })
    }

    /// The name of an element without its prefix, empty for other nodes.
    pub(super) fn name(self) -> &'d str {
        match self.content() {
            Content::Element { name, .. } => name,
            _ => "",
        }
    }

    /// True for an element of SVG.
    pub(super) fn is_svg(&self) -> bool {
        matches!(self.content(), Content::Element { is_svg: true, .. })
    }

    /// The names of attributes with their prefixes, and their values.
    pub(super) fn attributes(&self) -> &'d [(&'d str, &'d str)] {
        match self.content() {
            Content::Element { attributes, .. } => &self.dom.attributes[attributes.clone()],
            _ => &[],
        }
    }

    pub(super) fn get(&self, key: &str) -> Option<&'d str> {
        let mut attributes = self.attributes().iter();
        attributes.find(|(k, _)| *k == key).map(|(_, value)| *value)
    }

    pub(super) fn children(&self) -> impl Iterator<Item = Node<'d>> + use<'d> {
        self.dom.siblings(self.index + 1..self.item.next)
    }

    /// All the nodes in this one, in the order of the text.
    pub(super) fn descendants(&self) -> impl Iterator<Item = Node<'d>> + use<'d> {
        let dom = self.dom;
        (self.index + 1..self.item.next).filter_map(|index| dom.node(index))
    }

    /// The texts that it has.
    pub(super) fn text(&self) -> String {
        let text = |node: Node<'d>| match node.content() {
            Content::Text(text) => *text,
            _ => "",
        };
        self.children().map(text).collect()
    }

    /// Its place in the text.
    pub(super) fn bytes(&self) -> Range<usize> {
        self.item.bytes.clone()
    }

    /// The place of its content.
    pub(super) fn inside(&self) -> Range<usize> {
        self.item.inside.clone()
    }

    /// Its text, tags included.
    pub(super) fn raw(&self) -> &'d str {
        &self.dom.text[self.bytes()]
    }

    /// An error on its line.
    pub(super) fn refused(&self, why: impl std::fmt::Display) -> Error {
        self.dom.refused(self.item.bytes.start, why)
    }
}

/// The beginning of a text, for a message.
pub(super) fn short(text: &str) -> String {
    let mut start: String = text.chars().take(40).collect();
    if start.len() < text.len() {
        start.push('…');
    }
    start
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_know_their_bytes_and_lines() {
        let text = "<!-- </svg> -->\n<x:svg xmlns:x='http://www.w3.org/2000/svg' b=\"&lt;\">\n<g/><![CDATA[<]]>t<p c='1'>é</p>\n</x:svg >";
        let dom = Dom::parse(text);
        let root = dom.root().unwrap();
        assert_eq!((root.is_svg(), root.get("b")), (true, Some("&lt;")));
        assert_eq!(&text[root.inside().end..root.bytes().end], "</x:svg >");
        let children: Vec<_> = root.children().map(|child| child.raw()).collect();
        assert_eq!(children, ["<g/>", "<![CDATA[<]]>", "t", "<p c='1'>é</p>"]);
        assert_eq!(
            (root.text().as_str(), root.descendants().count()),
            ("<t", 5)
        );
        let last = root.children().last().unwrap();
        assert_eq!(
            (&text[last.inside()], dom.line(last.bytes().start)),
            ("é", 3)
        );
    }

    #[test]
    fn nodes_before_a_fault_are_there() {
        for (text, nodes) in [
            ("<svg><g/></p>", 2),
            ("<svg><g><p/>", 3),
            ("<svg><g a='1' a='2'/></svg>", 1),
            ("<svg><", 1),
            ("<svg", 0),
        ] {
            let dom = Dom::parse(text);
            assert_eq!(
                (dom.nodes().count(), dom.fault().is_some()),
                (nodes, true),
                "{text}"
            );
            assert!(dom.root().is_err(), "{text}");
        }
    }

    #[test]
    fn any_depth_and_a_byte_order_mark_are_no_matter() {
        let deep = "<g>".repeat(60_000) + &"</g>".repeat(60_000);
        assert_eq!(Dom::parse(&deep).nodes().count(), 60_000);
        let dom = Dom::parse("\u{feff}<svg><g a='1'/></svg>");
        let child = dom.root().unwrap().children().next().unwrap();
        assert_eq!((child.raw(), child.get("a")), ("<g a='1'/>", Some("1")));
    }
}
