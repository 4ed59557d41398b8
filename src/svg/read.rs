//! Reads SVG text of strokefit's own dialect as a scene. The reader is strict: whatever is not part of the
//! dialect is an error, so a file never silently gives a scene that looks different from the file.
//!
//! Properties are inherited as SVG says. So a mark has one look, wherever in the groups around it that is written.

mod element;
mod ground;

use super::dialect::{self, LINE, Unit, WIDTHS};
use super::dom::{Content, Dom, Node, short};
use super::options::Length;
use super::path::{self, Kind};
use super::shape;
use super::sheet::{self, Rules};
use crate::error::{Error, Result};
use crate::scene::{
    Area, Cap, MAX_POINTS, Mark, Path, Scene, Shade, Shape, Stage, Stroke, color as rgb, px,
};
use element::Element;

/// Most groups within groups; the writer makes less.
const MAX_LEVELS: usize = 8;

/// The element of Inkscape's live effects.
const EFFECT: &str = "path-effect";

/// The properties of layers and groups, which their marks inherit.
const INHERITED: [&str; 7] = [
    "stroke",
    "stroke-width",
    "stroke-opacity",
    "stroke-linecap",
    "stroke-linejoin",
    "fill",
    "fill-opacity",
];

/// Reads text that [`write`](super::write()) wrote, in any form. Outlines are read as areas.
///
/// It ignores comments, white space and attributes with a prefix (`inkscape:label`).
///
/// # Errors
/// [`ErrorKind::Svg`](crate::ErrorKind::Svg) when the text is not well-formed XML, not SVG, or outside the dialect; the
/// message names the line.
pub fn read(text: &str) -> Result<Scene> {
    scene(&Dom::parse(text))
}

/// The scene of a whole file.
pub(super) fn scene(dom: &Dom<'_>) -> Result<Scene> {
    let root = dom.root()?;
    let mut others = dom.top().filter(|node| node.bytes() != root.bytes());
    if let Some(other) = others.find(|node| !matches!(node.content(), Content::Instruction)) {
        return Err(other.refused("something follows </svg>, or comes before <svg>: remove it"));
    }
    let mut reader = Reader::default();
    let mut scene = page(&reader.element(root)?)?;
    // Style sheet, background, gradient of the page, shadows and what they fall on, layers: each may be absent, and none comes later.
    let mut children = elements(root)?.into_iter().peekable();
    if let Some(node) = children.next_if(|node| node.name() == "style") {
        reader.rules = style_sheet(&reader.element(node)?)?;
    }
    // A rectangle below shadows has an id.
    let is_background = |node: &Node<'_>| node.name() == "rect" && node.get("id").is_none();
    if let Some(node) = children.next_if(is_background) {
        let rect = reader.leaf(node)?;
        rect.expect_page(&scene)?;
        scene.background = Some(rect.get("fill", dialect::channels).map(rgb)?);
    }
    if let Some(node) = children.next_if(ground::is_of_page) {
        let page = reader.page_gradient(node, children.next(), &scene)?;
        scene.ground.push(page);
    }
    let group = reader.element(root)?;
    let [mut shadows, mut surfaces] = [0, 0];
    while let Some(node) = children.next_if(ground::is_in_ground) {
        scene.ground.push(if node.name() == "filter" {
            shadows += 1;
            reader.shadow(node, children.next(), shadows)?
        } else {
            surfaces += 1;
            let gradient = ground::is_gradient(&node).then_some(node);
            let element = match gradient {
                Some(gradient) => ground::filled(gradient, children.next())?,
                None => node,
            };
            reader.surface(gradient, element, &group, surfaces)?
        });
    }
    scene.stages = reader.layers(children, 1)?;
    Ok(scene)
}

/// The scene of this size whose layers are in `group`, with numbers from `first`.
pub(super) fn layers(group: Node<'_>, [width, height]: [u32; 2], first: usize) -> Result<Scene> {
    Ok(Scene {
        stages: Reader::default().layers(elements(group)?, first)?,
        ..Scene::empty(width, height, None)
    })
}

/// The elements in one that holds nothing else.
fn elements(parent: Node<'_>) -> Result<Vec<Node<'_>>> {
    let nodes = parent.children();
    let nodes = nodes.filter(|node| !matches!(node.content(), Content::Instruction));
    let elements = nodes.map(|node| match node.is_element() {
        true => Ok(node),
        false => Err(node.refused("text or a document type is not part of the dialect: remove it")),
    });
    elements.collect()
}

/// An empty scene of the picture's size, which the `viewBox` has, and of the page's if that is larger.
fn page(root: &Element<'_>) -> Result<Scene> {
    root.only(&["width", "height", "viewBox"])?;
    let side = |text: &str| text.parse::<u32>().ok().filter(|&side| side > 0);
    let (width, height) = root.get("viewBox", |text| {
        let (width, height) = text.strip_prefix("0 0 ")?.split_once(' ')?;
        Some((side(width)?, side(height)?))
    })?;
    let mut scene = Scene::empty(width, height, None);
    if let Some(length) = root.find("width").and_then(Length::parse) {
        root.expect("height", &length.scaled(height, width).to_string())?;
        return Ok(scene);
    }
    let sides = ["width", "height"].map(|key| root.find(key).and_then(side));
    match sides {
        [Some(w), Some(h)] if w > width && h > height => scene.page = Some([w, h]),
        _ => {
            root.expect("width", &width.to_string())?;
            root.expect("height", &height.to_string())?;
        }
    }
    Ok(scene)
}

/// The classes of a style sheet.
fn style_sheet(style: &Element<'_>) -> Result<Rules> {
    style.only(&[])?;
    if style.node.children().any(|node| node.is_element()) {
        return Err(style.refused("has more than text: give rules for classes"));
    }
    let rules = sheet::parse(&style.node.text());
    let mut keys = rules.iter().flat_map(Rules::values).flatten();
    let is_known = keys.all(|(key, _)| dialect::PAINT.contains(&key.as_str()));
    rules.filter(|_| is_known).ok_or_else(|| {
        let allowed = dialect::PAINT.join(", ");
        style.refused(format!(
            "has a rule that is not part of the dialect: give classes with {allowed}"
        ))
    })
}

/// Reads elements, given the classes of the file.
#[derive(Default)]
struct Reader {
    rules: Rules,
}

impl Reader {
    fn element<'r>(&'r self, node: Node<'r>) -> Result<Element<'r>> {
        Element::new(node, &self.rules)
    }

    /// An element without children; text in it has no meaning.
    fn leaf<'r>(&'r self, node: Node<'r>) -> Result<Element<'r>> {
        let element = self.element(node)?;
        let is_text = |child: Node<'_>| matches!(child.content(), Content::Text(_));
        match node.children().all(is_text) {
            true => Ok(element),
            false => Err(element.refused("has children: remove them")),
        }
    }

    fn layers<'r>(
        &self,
        nodes: impl IntoIterator<Item = Node<'r>>,
        first: usize,
    ) -> Result<Vec<Stage>> {
        let nodes = nodes.into_iter().zip(first..);
        nodes
            .map(|(node, number)| self.stage(node, number))
            .collect()
    }

    fn stage(&self, node: Node<'_>, number: usize) -> Result<Stage> {
        if node.name() != "g" {
            return Err(unexpected(node));
        }
        let group = self.element(node)?.within(&[], &["id", "transform"])?;
        let ids = ["stage", "color", "object"].map(|kind| format!("{kind}-{number}"));
        if !ids.iter().any(|id| group.find("id") == Some(id)) {
            group.expect("id", &ids[0])?;
        }
        let unit = group.either("transform", Unit::of_transform)?;
        let mut stage = Stage::default();
        let unit = unit.unwrap_or(Unit::PX);
        self.marks(&group, unit, MAX_LEVELS, &mut stage.marks)?;
        Ok(stage)
    }

    /// Adds the marks in a group that may have so many `levels` of groups in it.
    fn marks(
        &self,
        group: &Element<'_>,
        unit: Unit,
        levels: usize,
        marks: &mut Vec<Mark>,
    ) -> Result<()> {
        let mut children = elements(group.node)?.into_iter();
        while let Some(node) = children.next() {
            match node.name() {
                "title" => drop(self.leaf(node)?),
                // Live effects, which draw nothing by themselves.
                "defs" if node.children().all(|child| child.name() == EFFECT) => {}
                "g" if levels > 0 => {
                    let inner = self.element(node)?.within(&group.inherited(), &[])?;
                    self.marks(&inner, unit, levels - 1, marks)?;
                }
                _ if ground::is_gradient(&node) => {
                    let gradient = self.gradient(node)?;
                    let mark = self.mark(ground::filled(node, children.next())?, group, &[])?;
                    marks.extend(painted(&mark, unit, Some(gradient))?);
                }
                _ => marks.extend(painted(&self.mark(node, group, &[])?, unit, None)?),
            }
        }
        Ok(())
    }

    /// The element of a mark in a group, which may have the attributes `also`.
    fn mark<'r>(
        &'r self,
        node: Node<'r>,
        group: &Element<'r>,
        also: &[&str],
    ) -> Result<Element<'r>> {
        let path = (node.name() == "path").then_some(&["d"][..]);
        let places = path.or_else(|| shape::attributes(node.name()));
        let places = places.ok_or_else(|| unexpected(node))?;
        let own = [places, &["id"], also].concat();
        self.leaf(node)?.within(&group.inherited(), &own)
    }
}

/// The strokes of an element, or the area. A `gradient` with its id is the fill of an area.
fn painted(
    element: &Element<'_>,
    unit: Unit,
    gradient: Option<(String, Shade)>,
) -> Result<Vec<Mark>> {
    // Without a fill, SVG fills with black.
    let fill = element.find("fill").unwrap_or("black");
    let has = |paint: Option<&str>| paint.is_some_and(|paint| paint != "none");
    match (has(Some(fill)), has(element.find("stroke")), gradient) {
        (true, true, _) => Err(element.refused("has both a fill and a stroke: make it two")),
        (true, false, Some((id, shade))) => {
            element.expect("fill", &format!("url(#{id})"))?;
            Ok(vec![area(element, unit, shade.mean(), Some(shade))?])
        }
        (true, false, None) => {
            let color = element.get("fill", dialect::channels)?;
            Ok(vec![line(
                element,
                unit,
                area(element, unit, color, None)?,
            )?])
        }
        (false, true, None) => strokes(element, unit),
        (false, ..) => Err(element.refused("has no stroke and no fill: remove it")),
    }
}

fn area(element: &Element<'_>, unit: Unit, color: [u8; 3], shade: Option<Shade>) -> Result<Mark> {
    let shape = shape(element, unit)?;
    let rings = |d: &str| path::parse(d, Kind::Ring, unit);
    let rings = shape.map_or_else(|| element.get("d", rings), |shape| Ok(vec![shape.path()]))?;
    check_counts(element, &rings, "ring")?;
    let opacity = element.either("fill-opacity", dialect::opacity_quantum)?;
    let opacity = f32::from(opacity.unwrap_or(u8::MAX)) / 255.0;
    let plain = Area::plain(rings, rgb(color), opacity);
    Ok(Area { shade, ..plain }.into())
}

/// The stroke whose outline an area is, if its element says so. One that was edited is the area that is seen.
fn line(element: &Element<'_>, unit: Unit, mark: Mark) -> Result<Mark> {
    let [line, widths] = [LINE, WIDTHS].map(|key| element.node.get(key));
    let refused = |why: String| element.refused(format!("{why}: remove {LINE} and {WIDTHS}"));
    let (line, widths) = match (line, widths) {
        (None, None) => return Ok(mark),
        (Some(line), Some(widths)) => (line, widths),
        _ => {
            return Err(refused(
                "has a line without widths, or widths without a line".into(),
            ));
        }
    };
    let Mark::Area(area) = &mark else {
        return Ok(mark);
    };
    let lines = path::parse(line, Kind::Line, unit).unwrap_or_default();
    let Ok([path]) = <[Path; 1]>::try_from(lines) else {
        let why = format!(
            "has {LINE}=\"{}\", which is not one line of the dialect",
            short(line)
        );
        return Err(refused(why));
    };
    let radius = |text: &str| Some(0.5 * px(unit.parse(text).filter(|&width| width >= 0)?));
    let radii: Option<Vec<f64>> = widths.split_ascii_whitespace().map(radius).collect();
    let Some(radii) = radii else {
        let why = format!(
            "has {WIDTHS}=\"{}\", which are not widths of 0 or more",
            short(widths)
        );
        return Err(refused(why));
    };
    check_counts(element, std::slice::from_ref(&path), "line")?;
    let stroke = Stroke::varying(path, radii, area.color, area.opacity);
    let stroke =
        stroke.map_err(|error| refused(format!("has widths that no line has ({error})")))?;
    Ok(match stroke.has_outline(&area.rings) {
        true => stroke.into(),
        false => mark,
    })
}

fn strokes(element: &Element<'_>, unit: Unit) -> Result<Vec<Mark>> {
    let shape = shape(element, unit)?;
    let lines = |d: &str| path::parse(d, Kind::Line, unit);
    let paths = shape.map_or_else(|| element.get("d", lines), |shape| Ok(vec![shape.path()]))?;
    check_counts(element, &paths, "stroke")?;
    let ends = |text: &str| ["butt", "round"].iter().position(|cap| *cap == text);
    // SVG's defaults are square ends and mitres. A band needs both, a stroke with round ends neither.
    let is_band = element.either("stroke-linecap", ends)?.unwrap_or(0) == 0;
    let join = if is_band { "miter" } else { "round" };
    if element.find("stroke-linejoin").unwrap_or("miter") != join
        && paths.iter().any(Path::has_joins)
    {
        let why = format!("has a corner, but not stroke-linejoin=\"{join}\": give it that");
        return Err(element.refused(why));
    }
    let width = |text: &str| unit.parse(text).filter(|&width| width > 0);
    let (width, color) = (
        element.get("stroke-width", width)?,
        element.get("stroke", dialect::channels)?,
    );
    let opacity = element.either("stroke-opacity", dialect::opacity_quantum)?;
    let stroke = |path| Stroke {
        path,
        radius: 0.5 * px(width),
        radii: Vec::new(),
        cap: if is_band { Cap::Butt } else { Cap::Round },
        color: rgb(color),
        opacity: f32::from(opacity.unwrap_or(u8::MAX)) / 255.0,
    };
    let strokes: Vec<Stroke> = paths.into_iter().map(stroke).collect();
    // SVG cuts off the mitre of a sharp corner, and a band keeps it: the scene would look different from the file.
    let is_sound = |stroke: &Stroke| stroke.band().is_none_or(|band| band.is_sound());
    match strokes.iter().all(is_sound) {
        true => Ok(strokes.into_iter().map(Mark::from).collect()),
        false => Err(element.refused(
            "with square ends has a corner that is too sharp, or a line too short for its width: make it an area",
        )),
    }
}

/// The shape of an element that has one.
fn shape(element: &Element<'_>, unit: Unit) -> Result<Option<Shape>> {
    let Some(attributes) = shape::attributes(element.node.name()) else {
        return Ok(None);
    };
    // Sharp corners need no radius.
    let given = attributes.iter();
    let given = given.filter(|key| **key != "rx" || element.find(key).is_some());
    let number = |key: &&str| element.get(key, |text| unit.parse(text));
    let numbers: Vec<i64> = given.map(number).collect::<Result<_>>()?;
    let shape = shape::of(element.node.name(), &numbers);
    let refused = || element.refused("has sides or radii that the dialect has no room for");
    shape.ok_or_else(refused).map(Some)
}

/// Refuses paths of too many points.
fn check_counts(element: &Element<'_>, paths: &[Path], kind: &str) -> Result<()> {
    let counts = paths.iter().map(|path| path.points().len());
    match counts.max().filter(|&count| count > MAX_POINTS) {
        Some(count) => Err(element.refused(format!(
            "has a {kind} of {count} points: split it, so that each part has at most {MAX_POINTS}"
        ))),
        None => Ok(()),
    }
}

fn unexpected(node: Node<'_>) -> Error {
    let name = short(node.name());
    node.refused(format!(
        "<{name}> is not part of the dialect at this place: give a file that strokefit wrote"
    ))
}
