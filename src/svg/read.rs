//! Reads SVG text of strokefit's own dialect as a scene. The reader is strict: whatever is not part of the
//! dialect is an error, so a file never silently gives a scene that looks different from the file.

mod element;
mod shade;
mod shadow;

use quick_xml::events::{BytesStart, Event};
use quick_xml::name::{Namespace, ResolveResult};
use quick_xml::reader::NsReader;

use super::dialect::{self, Unit};
use super::options::Length;
use super::path::{self, Kind};
use super::shape;
use super::sheet::{self, Rules};
use crate::error::{Error, ErrorKind, Result};
use crate::scene::{
    MAX_POINTS, Mark, Rgb, Scene, Shade, Stage, Written, WrittenPath, WrittenShade, WrittenShape,
    color,
};
use element::{ENDS, Element, short};

/// Reads text that [`write`](super::write()) wrote, in any form except outlines.
///
/// It ignores comments, white space and attributes with a prefix (`inkscape:label`).
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

/// The problem, without its place.
type Parsed<T> = Result<T, String>;

struct Parser<'a> {
    text: &'a str,
    xml: NsReader<&'a [u8]>,
    /// Those of the style sheet, once it was read.
    rules: Rules,
}

/// An element or the end of one.
enum Tag {
    Open(Element),
    Close,
    End,
}

impl<'a> Parser<'a> {
    fn new(text: &'a str) -> Self {
        let mut xml = NsReader::from_str(text);
        xml.config_mut().expand_empty_elements = true;
        let rules = Rules::new();
        Self { text, xml, rules }
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
                return Err(format!(
                    "the root element is <{}>, not <svg>: give an SVG file",
                    other.name
                ));
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
        let (width, height, page) = page_size(root)?;
        let mut scene = Scene {
            page,
            ..Scene::empty(width, height, None)
        };
        loop {
            match self.next()? {
                Tag::Open(e) if e.name == "style" && is_bare(&scene) && self.rules.is_empty() => {
                    self.rules = self.style_sheet(&e)?;
                }
                Tag::Open(e) if e.name == "rect" && is_bare(&scene) => {
                    scene.background = Some(background(&e, width, height)?);
                    self.close(&e)?;
                }
                Tag::Open(e)
                    if shade::begins_with(&e) && !scene.has_ground() && scene.stages.is_empty() =>
                {
                    scene.shade = Some(self.shade(&e, width, height)?);
                }
                Tag::Open(e) if shadow::begins_with(&e) && scene.stages.is_empty() => {
                    let number = scene.shadows.len() + 1;
                    scene.shadows.push(self.shadow(&e, number)?);
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

    /// The classes of a style sheet, up to its end.
    fn style_sheet(&mut self, element: &Element) -> Parsed<Rules> {
        element.only(&[])?;
        let mut text = String::new();
        loop {
            match self.xml.read_event().map_err(|e| malformed(&e))? {
                Event::End(_) => break,
                Event::Text(part) => text += &part,
                Event::CData(part) => text += &part,
                _ => return Err("<style> has more than text: give rules for classes".into()),
            }
        }
        let rules = sheet::parse(&text);
        let mut keys = rules.iter().flat_map(Rules::values).flatten();
        let is_known = keys.all(|(key, _)| dialect::PAINT.contains(&key.as_str()));
        rules.filter(|_| is_known).ok_or_else(|| {
            let allowed = dialect::PAINT.join(", ");
            format!("<style> has a rule that is not part of the dialect that strokefit reads: give classes with {allowed}")
        })
    }

    fn stage(&mut self, group: &Element, number: usize) -> Parsed<Stage> {
        group.only(&[
            "id",
            "fill",
            "stroke-linecap",
            "stroke-linejoin",
            "stroke-width",
            "transform",
        ])?;
        let ids = ["stage", "color", "object"].map(|kind| format!("{kind}-{number}"));
        if !ids.iter().any(|id| group.find("id") == Some(id)) {
            group.expect("id", &ids[0])?;
        }
        // A layer of areas alone needs no style.
        let has_strokes = ["fill", "stroke-linecap", "stroke-linejoin", "stroke-width"]
            .iter()
            .any(|key| group.find(key).is_some());
        if has_strokes {
            group.expect("fill", "none")?;
        }
        let has_round = group.find("stroke-linecap").is_some();
        let has_join = group.find("stroke-linejoin").is_some();
        if has_round || has_join {
            group.expect("stroke-linecap", "round")?;
        }
        if has_join {
            group.expect("stroke-linejoin", "round")?;
        }
        let mut stage = Stage::default();
        let unit = group.either("transform", None, Unit::of_transform)?;
        let unit = unit.unwrap_or(Unit::PX);
        let style = Style {
            layer_width: group.either("stroke-width", None, |text| width(text, unit))?,
            ..Style::new(unit, [has_strokes, has_round, has_join])
        };
        self.marks(&style, &mut stage)?;
        Ok(stage)
    }

    /// Adds the marks up to the end of a group.
    fn marks(&mut self, style: &Style, stage: &mut Stage) -> Parsed<()> {
        loop {
            match self.next()? {
                Tag::Open(e) if let Some(own) = e.places() => {
                    stage.marks.extend(style.of(&e, &own)?.marks(&e)?);
                    self.close(&e)?;
                }
                Tag::Open(e) if shade::begins_with(&e) => {
                    stage.marks.push(self.shaded_area(&e, style)?);
                }
                // Each group must set an attribute that is not set yet, which bounds their depth.
                Tag::Open(e) if e.name == "g" => self.marks(&style.of(&e, &[])?, stage)?,
                Tag::Open(e) if e.name == "title" => self.close(&e)?,
                Tag::Open(e) => return Err(unexpected(&e)),
                Tag::Close => return Ok(()),
                Tag::End => return Err("the file ends before </g>: get a complete copy".into()),
            }
        }
    }

    /// Skips the text in `element` up to its end.
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
                    return Element::new(&tag, &self.rules).map(Tag::Open);
                }
                Event::End(_) => return Ok(Tag::Close),
                Event::Eof => return Ok(Tag::End),
                Event::Text(text) if text.trim().is_empty() => {}
                Event::Comment(_) | Event::Decl(_) | Event::PI(_) => {}
                _ => {
                    return Err(
                        "text or a document type is not part of the dialect that strokefit reads"
                            .into(),
                    );
                }
            }
        }
    }
}

/// Width and height of the picture in px, from the `viewBox`, and those of the page if that is larger.
fn page_size(root: &Element) -> Parsed<(u32, u32, Option<[u32; 2]>)> {
    root.only(&["width", "height", "viewBox"])?;
    let (width, height) = root.parsed("viewBox", |text| {
        let (width, height) = text.strip_prefix("0 0 ")?.split_once(' ')?;
        let side = |text: &str| text.parse::<u32>().ok().filter(|&side| side > 0);
        Some((side(width)?, side(height)?))
    })?;
    match root.find("width").and_then(Length::parse) {
        Some(length) => root.expect("height", &length.scaled(height, width).to_string())?,
        None => {
            let side = |name| root.find(name).and_then(|text| text.parse::<u32>().ok());
            let page = side("width").zip(side("height"));
            if let Some((w, h)) = page.filter(|&(w, h)| w > width && h > height) {
                return Ok((width, height, Some([w, h])));
            }
            root.expect("width", &width.to_string())?;
            root.expect("height", &height.to_string())?;
        }
    }
    Ok((width, height, None))
}

/// True if nothing of the drawing has been read.
fn is_bare(scene: &Scene) -> bool {
    scene.background.is_none() && !scene.has_ground() && scene.stages.is_empty()
}

/// Checks that a rectangle is the page, and has nothing else but a fill.
fn sides(rect: &Element, width: u32, height: u32) -> Parsed<()> {
    rect.only(&["width", "height", "fill"])?;
    rect.expect("width", &width.to_string())?;
    rect.expect("height", &height.to_string())
}

fn background(rect: &Element, width: u32, height: u32) -> Parsed<Rgb> {
    sides(rect, width, height)?;
    rect.parsed("fill", dialect::channels).map(color)
}

/// The attributes that groups set for the marks in them.
#[derive(Debug, Clone)]
struct Style {
    color: Option<[u8; 3]>,
    width: Option<i64>,
    opacity: Option<u8>,
    fill: Option<[u8; 3]>,
    fill_opacity: Option<u8>,
    /// True if the layer says that its paths are strokes.
    has_strokes: bool,
    /// True if the ends of strokes are round, unless they have square ones of their own.
    has_round: bool,
    /// The default width.
    layer_width: Option<i64>,
    /// The unit of their numbers.
    unit: Unit,
    /// True if corners are round.
    has_join: bool,
}

fn width(text: &str, unit: Unit) -> Option<i64> {
    unit.parse(text).filter(|&width| width > 0)
}

impl Style {
    fn new(unit: Unit, [has_strokes, has_round, has_join]: [bool; 3]) -> Self {
        Self {
            color: None,
            width: None,
            opacity: None,
            fill: None,
            fill_opacity: None,
            has_strokes,
            has_round,
            layer_width: None,
            unit,
            has_join,
        }
    }

    /// These attributes and those of `element` combined. `element` may set only what is not set yet, and `own`.
    fn of(&self, element: &Element, own: &[&str]) -> Parsed<Self> {
        let is_free = [
            self.color.is_none(),
            self.width.is_none(),
            self.opacity.is_none(),
            self.fill.is_none(),
            self.fill_opacity.is_none(),
        ];
        let free = dialect::PAINT.into_iter().zip(is_free);
        let free: Vec<_> = free.filter(|(_, free)| *free).map(|(key, _)| key).collect();
        element.only(&[own, free.as_slice()].concat())?;
        if own.is_empty() && element.attributes.is_empty() {
            return Err("<g> has no attribute: remove it".into());
        }
        Ok(Self {
            color: element.either("stroke", self.color, dialect::channels)?,
            width: element.either("stroke-width", self.width, |text| width(text, self.unit))?,
            opacity: element.either("stroke-opacity", self.opacity, dialect::opacity_quantum)?,
            fill: element.either("fill", self.fill, dialect::channels)?,
            fill_opacity: element.either(
                "fill-opacity",
                self.fill_opacity,
                dialect::opacity_quantum,
            )?,
            ..*self
        })
    }

    /// The strokes of a path with this style, or the area.
    fn marks(&self, path: &Element) -> Parsed<Vec<Mark>> {
        match self.fill {
            Some(_) if self.has_stroke() => Err(format!(
                "<{}> has both a fill and a stroke: make it two",
                path.name
            )),
            Some(_) if is_band(path)? => Err("<path> has a fill and the ends of a stroke".into()),
            Some(color) => self.area(path, color, None).map(|area| vec![area]),
            None => self.strokes(path),
        }
    }

    /// True if marks have a colour or a width already.
    fn is_painted(&self) -> bool {
        self.fill.is_some() || self.has_stroke()
    }

    fn has_stroke(&self) -> bool {
        self.color.is_some() || self.width.is_some() || self.opacity.is_some()
    }

    /// The shape of an element that has one.
    fn shape(&self, element: &Element) -> Parsed<Option<WrittenShape>> {
        let Some(attributes) = shape::attributes(&element.name) else {
            return Ok(None);
        };
        // Sharp corners need no radius.
        let given = attributes
            .iter()
            .filter(|key| **key != "rx" || element.find(key).is_some());
        let number = |key: &&str| element.parsed(key, |text| self.unit.parse(text));
        let numbers: Vec<i64> = given.map(number).collect::<Parsed<_>>()?;
        let shape = shape::of(&element.name, &numbers);
        let refused = || {
            format!(
                "<{}> has sides or radii that the dialect has no room for",
                element.name
            )
        };
        shape.ok_or_else(refused).map(Some)
    }

    fn area(&self, path: &Element, color: [u8; 3], shade: Option<Shade>) -> Parsed<Mark> {
        let shape = self.shape(path)?;
        let paths = match shape {
            Some(_) => Vec::new(),
            None => path.parsed("d", |d| path::parse(d, Kind::Ring, self.unit))?,
        };
        check_counts(&paths, "ring")?;
        let written = Written {
            paths,
            shape,
            width: 0,
            is_band: false,
            color,
            opacity: self.fill_opacity.unwrap_or(u8::MAX),
            shade: shade.map(WrittenShade::from),
        };
        Ok(written.mark())
    }

    fn strokes(&self, path: &Element) -> Parsed<Vec<Mark>> {
        let shape = self.shape(path)?;
        let paths = match shape {
            Some(shape) => vec![shape.path()],
            None => path.parsed("d", |d| path::parse(d, Kind::Line, self.unit))?,
        };
        let missing = |key: &str| format!("<{}> has no {key}", path.name);
        let width = self.width.or(self.layer_width);
        let width = width.ok_or_else(|| missing("stroke-width"))?;
        let color = self.color.ok_or_else(|| missing("stroke"))?;
        if !self.has_strokes {
            return Err("<path> is a stroke, but its layer has no fill=\"none\"".into());
        }
        let has_square = is_band(path)?;
        let is_band = has_square || !self.has_round;
        let has_join = match has_square {
            true => path.find(ENDS[1]).is_some(),
            false => self.has_join || is_band,
        };
        if !has_join && paths.iter().any(WrittenPath::has_joins) {
            let whose = if is_band { "it" } else { "its layer" };
            return Err(format!(
                "<path> has a corner, but {whose} has no stroke-linejoin"
            ));
        }
        check_counts(&paths, "stroke")?;
        let opacity = self.opacity.unwrap_or(u8::MAX);
        let stroke = |path| Written {
            paths: vec![path],
            shape,
            width,
            is_band,
            color,
            opacity,
            shade: None,
        };
        let marks: Vec<Written> = paths.into_iter().map(stroke).collect();
        match marks.iter().all(Written::is_sound) {
            true => Ok(marks.iter().map(Written::mark).collect()),
            false => Err("<path> with square ends has a corner that is too sharp, or a line too short for its width: \
                          make it an area"
                .into()),
        }
    }
}

/// True if a path has square ends and mitred corners instead of those of its layer.
fn is_band(path: &Element) -> Parsed<bool> {
    let given = ENDS.map(|key| path.find(key).is_some());
    if given == [false; 2] {
        return Ok(false);
    }
    path.expect(ENDS[0], "butt")?;
    if given[1] {
        path.expect(ENDS[1], "miter")?;
    }
    Ok(true)
}

/// Refuses paths of too many points.
fn check_counts(paths: &[WrittenPath], kind: &str) -> Parsed<()> {
    let counts = paths.iter().map(|p| p.points().len());
    match counts.max().filter(|&count| count > MAX_POINTS) {
        Some(count) => Err(format!(
            "<path> has a {kind} of {count} points: split it, so that each part has at most {MAX_POINTS}"
        )),
        None => Ok(()),
    }
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
        "<{}> is not part of the dialect at this place: give a file that strokefit wrote",
        short(&element.name)
    )
}

fn malformed(error: &quick_xml::Error) -> String {
    format!("not well-formed XML: {error}")
}
