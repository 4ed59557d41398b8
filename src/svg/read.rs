//! SVG text of our own dialect as a scene. Strict: what the dialect does not say is an error, so
//! that nothing is silently drawn otherwise than the file's other readers draw it.

use quick_xml::events::{BytesStart, Event};
use quick_xml::name::{Namespace, ResolveResult};
use quick_xml::reader::NsReader;

use super::dialect;
use crate::error::{Error, ErrorKind, Result};
use crate::scene::{Rgb, Scene, Stage, Stroke, Written, color};

/// Reads what [`write`](super::write) wrote.
///
/// Comments, white space and attributes with a prefix (`inkscape:label`) do not matter.
///
/// # Errors
/// [`ErrorKind::Svg`] when the text is not well-formed XML, not SVG, or outside the dialect; the
/// message names the line.
pub fn read(text: &str) -> Result<Scene> {
    let mut parser = Parser::new(text);
    parser.document().map_err(|message| {
        let line = parser.line();
        Error::new(ErrorKind::Svg, format!("SVG line {line}: {message}"))
    })
}

/// What is wrong, without the place.
type Parsed<T> = Result<T, String>;

struct Parser<'a> {
    text: &'a str,
    xml: NsReader<&'a [u8]>,
}

/// An element or the end of one.
enum Tag {
    Open(Element),
    Close,
    End,
}

struct Element {
    name: String,
    attributes: Vec<(String, String)>,
}

impl<'a> Parser<'a> {
    fn new(text: &'a str) -> Self {
        let mut xml = NsReader::from_str(text);
        xml.config_mut().expand_empty_elements = true;
        Self { text, xml }
    }

    /// The line of the last thing read, from 1.
    fn line(&self) -> usize {
        let at = usize::try_from(self.xml.error_position().max(self.xml.buffer_position()))
            .unwrap_or(usize::MAX);
        let before = self.text.as_bytes().iter().take(at.saturating_sub(1));
        1 + before.filter(|&&b| b == b'\n').count()
    }

    fn document(&mut self) -> Parsed<Scene> {
        let scene = match self.next()? {
            Tag::Open(root) if root.name == "svg" => self.page(&root)?,
            Tag::Open(other) => {
                return Err(format!("the root element is <{}>, not <svg>", other.name));
            }
            Tag::Close | Tag::End => {
                return Err("there is no <svg> element: give an SVG file".into());
            }
        };
        match self.next()? {
            Tag::End => Ok(scene),
            Tag::Open(_) | Tag::Close => Err("something follows </svg>: remove it".into()),
        }
    }

    fn page(&mut self, root: &Element) -> Parsed<Scene> {
        let (width, height) = page_size(root)?;
        let mut scene = Scene::empty(width, height, None);
        loop {
            match self.next()? {
                Tag::Open(e)
                    if e.name == "rect"
                        && scene.background.is_none()
                        && scene.stages.is_empty() =>
                {
                    scene.background = Some(background(&e, width, height)?);
                    self.close(&e)?;
                }
                Tag::Open(e) if e.name == "g" => {
                    let number = scene.stages.len() + 1;
                    scene.stages.push(self.stage(&e, number)?);
                }
                Tag::Open(e) => return Err(unexpected(&e)),
                Tag::Close => return Ok(scene),
                Tag::End => return Err("the file ends before </svg>: get a complete copy".into()),
            }
        }
    }

    fn stage(&mut self, group: &Element, number: usize) -> Parsed<Stage> {
        group.only(&["id", "fill", "stroke-linecap"])?;
        group.expect("id", &format!("stage-{number}"))?;
        group.expect("fill", "none")?;
        group.expect("stroke-linecap", "round")?;
        let mut stage = Stage::default();
        loop {
            match self.next()? {
                Tag::Open(e) if e.name == "path" => {
                    stage.strokes.push(stroke(&e)?);
                    self.close(&e)?;
                }
                Tag::Open(e) if e.name == "title" => self.close(&e)?,
                Tag::Open(e) => return Err(unexpected(&e)),
                Tag::Close => return Ok(stage),
                Tag::End => return Err("the file ends before </g>: get a complete copy".into()),
            }
        }
    }

    /// Passes over the text in `element` to its end.
    fn close(&mut self, element: &Element) -> Parsed<()> {
        loop {
            match self.xml.read_event().map_err(|e| malformed(&e))? {
                Event::End(_) => return Ok(()),
                Event::Text(_) | Event::GeneralRef(_) | Event::Comment(_) => {}
                Event::Eof => {
                    return Err(format!(
                        "the file ends before </{}>: get a complete copy",
                        element.name
                    ));
                }
                _ => return Err(format!("<{}> has children: remove them", element.name)),
            }
        }
    }

    fn next(&mut self) -> Parsed<Tag> {
        loop {
            let (namespace, event) = self.xml.read_resolved_event().map_err(|e| malformed(&e))?;
            match event {
                Event::Start(tag) => {
                    check_namespace(&namespace, &tag)?;
                    return Element::new(&tag).map(Tag::Open);
                }
                Event::End(_) => return Ok(Tag::Close),
                Event::Eof => return Ok(Tag::End),
                Event::Text(text) if text.trim().is_empty() => {}
                Event::Comment(_) | Event::Decl(_) | Event::PI(_) => {}
                _ => return Err("text or a document type, which the dialect does not have".into()),
            }
        }
    }
}

impl Element {
    fn new(tag: &BytesStart<'_>) -> Parsed<Self> {
        let mut attributes = Vec::new();
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|e| format!("not well-formed XML: {e}"))?;
            let key = attribute.key.as_ref();
            if key != "xmlns" && !key.contains(':') {
                attributes.push((key.to_owned(), attribute.value.into_owned()));
            }
        }
        Ok(Self {
            name: tag.local_name().as_ref().to_owned(),
            attributes,
        })
    }

    fn get(&self, key: &str) -> Parsed<&str> {
        self.find(key)
            .ok_or_else(|| format!("<{}> has no {key}", self.name))
    }

    fn find(&self, key: &str) -> Option<&str> {
        self.attributes
            .iter()
            .find(|(k, _)| k == key)
            .map(|(_, v)| v.as_str())
    }

    /// The attribute as `parse` understands it.
    fn parsed<T>(&self, key: &str, parse: impl Fn(&str) -> Option<T>) -> Parsed<T> {
        let text = self.get(key)?;
        parse(text).ok_or_else(|| {
            format!(
                "<{}> has {key}=\"{}\", which the dialect does not have",
                self.name,
                short(text)
            )
        })
    }

    fn expect(&self, key: &str, value: &str) -> Parsed<()> {
        self.parsed(key, |text| (text == value).then_some(()))
            .map_err(|e| format!("{e} (expected \"{value}\")"))
    }

    /// Refuses attributes that would change the drawing in ways the scene cannot say.
    fn only(&self, keys: &[&str]) -> Parsed<()> {
        match self
            .attributes
            .iter()
            .find(|(key, _)| !keys.contains(&key.as_str()))
        {
            Some((key, _)) => Err(format!(
                "<{}> has the attribute {key}, which the dialect does not have",
                self.name
            )),
            None => Ok(()),
        }
    }
}

fn page_size(root: &Element) -> Parsed<(u32, u32)> {
    root.only(&["width", "height", "viewBox"])?;
    let side = |text: &str| text.parse::<u32>().ok().filter(|&side| side > 0);
    let (width, height) = (root.parsed("width", side)?, root.parsed("height", side)?);
    root.expect("viewBox", &format!("0 0 {width} {height}"))?;
    Ok((width, height))
}

fn background(rect: &Element, width: u32, height: u32) -> Parsed<Rgb> {
    rect.only(&["width", "height", "fill"])?;
    rect.expect("width", &width.to_string())?;
    rect.expect("height", &height.to_string())?;
    rect.parsed("fill", dialect::channels).map(color)
}

fn stroke(path: &Element) -> Parsed<Stroke> {
    path.only(&["d", "stroke", "stroke-width", "stroke-opacity"])?;
    let width = |text: &str| dialect::number(text).filter(|&width| width > 0);
    let opacity = match path.find("stroke-opacity") {
        Some(_) => path.parsed("stroke-opacity", dialect::opacity_quantum)?,
        None => u8::MAX,
    };
    let written = Written {
        points: path.parsed("d", dialect::points)?,
        width: path.parsed("stroke-width", width)?,
        color: path.parsed("stroke", dialect::channels)?,
        opacity,
    };
    Ok(written.stroke())
}

fn check_namespace(namespace: &ResolveResult<'_>, tag: &BytesStart<'_>) -> Parsed<()> {
    let name = tag.local_name();
    let name = name.as_ref();
    let svg = dialect::SVG_NAMESPACE;
    match namespace {
        ResolveResult::Bound(Namespace(found)) if *found == svg => Ok(()),
        ResolveResult::Bound(Namespace(found)) => Err(format!(
            "<{name}> is in the namespace \"{}\", not \"{svg}\"",
            short(found)
        )),
        ResolveResult::Unbound => Err(format!(
            "<{name}> is in no namespace: add xmlns=\"{svg}\" to the root"
        )),
        ResolveResult::Unknown(prefix) => {
            Err(format!("the prefix \"{}\" is not declared", short(prefix)))
        }
    }
}

fn unexpected(element: &Element) -> String {
    format!(
        "<{}> is not of the dialect here: give a file as strokefit writes it",
        short(&element.name)
    )
}

fn malformed(error: &quick_xml::Error) -> String {
    format!("not well-formed XML: {error}")
}

/// The beginning of a text, for a message.
fn short(text: &str) -> String {
    let mut start: String = text.chars().take(40).collect();
    if start.len() < text.len() {
        start.push('…');
    }
    start
}
