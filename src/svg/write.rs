//! Writes a scene as SVG text.

use super::arrange;
use super::dialect::{self, Unit};
use super::element::{self, Names};
use super::gradient;
use super::layer::{Layer, LayerKind, Written};
use super::names;
use super::options::{Form, Order, WriteOptions};
use super::sheet::{BACKGROUND, Sheet};
use crate::scene::{Mark, Path, Scene, counted, quantized_anywhere, quantum};

/// The scene as SVG text: rounded by [`Scene::quantized`], without the strokes that this drops, and in the order
/// given by [`arrange`](super::arrange()).
pub fn write(scene: &Scene, options: &WriteOptions) -> String {
    let layers = arrange::layers(scene, options);
    let sheet = (options.form == Form::Css).then(|| {
        let background = scene.background.map(|color| color.map(quantum));
        Sheet::of(background, layers.iter().flat_map(|layer| &layer.strokes))
    });
    let mut out = head(scene, options, sheet.as_ref());
    out.push_str(&numbered(layers, options, 1, sheet.as_ref()));
    out.push_str("</svg>\n");
    out
}

/// Only the layers of the scene, for a document of the scene's size. Their numbers start at `first`. The
/// document must declare `xmlns:inkscape` around them.
pub fn layers(scene: &Scene, options: &WriteOptions, first: usize) -> String {
    numbered(arrange::layers(scene, options), options, first, None)
}

/// The text of layers with numbers from `first`.
fn numbered(
    layers: Vec<Layer>,
    options: &WriteOptions,
    first: usize,
    sheet: Option<&Sheet>,
) -> String {
    let mut out = String::new();
    for (index, mut layer) in layers.into_iter().enumerate() {
        let number = first + index;
        let has_powerstrokes = options.form == Form::Powerstroke;
        let named = layer.strokes.iter_mut().filter(|mark| {
            mark.mark.shade().is_some() || has_powerstrokes && mark.line().is_some()
        });
        for (k, mark) in named.enumerate() {
            mark.place = [number, k + 1];
        }
        out.push_str(&shortest(number, &layer, options, sheet));
    }
    out
}

/// Bytes that the mark takes in a file; 0 if it would be dropped at any place. In the smallest form this
/// depends on its neighbours; the width then counts as shared, and the colour as the mark's own.
pub fn mark_bytes(mark: &Mark, options: &WriteOptions) -> usize {
    quantized_anywhere(mark, options.precision).map_or(0, |mark| {
        let written = Written::rounded(mark, options.precision);
        element::bytes(&written, options.form, options.unit())
    })
}

fn head(scene: &Scene, options: &WriteOptions, sheet: Option<&Sheet>) -> String {
    let Scene { width, height, .. } = *scene;
    let (svg, inkscape) = (dialect::SVG_NAMESPACE, dialect::INKSCAPE_NAMESPACE);
    let (page_width, page_height) = match (options.width, scene.page) {
        (Some(length), _) => (length.to_string(), length.scaled(height, width).to_string()),
        (None, Some([width, height])) => (width.to_string(), height.to_string()),
        (None, None) => (width.to_string(), height.to_string()),
    };
    let mut out = format!(
        "<svg xmlns=\"{svg}\" xmlns:inkscape=\"{inkscape}\" \
         width=\"{page_width}\" height=\"{page_height}\" viewBox=\"0 0 {width} {height}\">\n"
    );
    if let Some(sheet) = sheet {
        out += &sheet.text();
    }
    if let Some(color) = scene.background {
        let paint = match sheet {
            Some(_) => format!("class=\"{BACKGROUND}\""),
            None => format!("fill=\"{}\"", dialect::hex(color.map(quantum))),
        };
        out += &format!("<rect width=\"{width}\" height=\"{height}\" {paint}/>\n");
    }
    push_ground(&mut out, scene);
    out
}

/// Appends the areas of the ground, in px, each after what it refers to.
fn push_ground(out: &mut String, scene: &Scene) {
    let Scene { width, height, .. } = *scene;
    let (id, shadow, blur) = (dialect::SHADE_ID, dialect::SHADOW_ID, dialect::BLUR_ID);
    let [mut shadows, mut surfaces] = [0, 0];
    for area in &scene.ground {
        let mut mark = Written::from(Mark::from(area.clone()));
        match &area.shade {
            Some(shade) if area.is_page([width, height]) => {
                gradient::push(out, shade, id);
                *out +=
                    &format!("\n<rect width=\"{width}\" height=\"{height}\" fill=\"url(#{id})\"/>");
            }
            None if area.blur > 0.0 => {
                shadows += 1;
                gradient::push_blur(out, area, shadows);
                let names = format!(" id=\"{shadow}-{shadows}\" filter=\"url(#{blur}-{shadows})\"");
                element::push_alone(out, &mark, &names);
            }
            _ => {
                surfaces += 1;
                // Layers have numbers from 1.
                mark.place = [0, surfaces];
                let names = format!(" id=\"{}-{surfaces}\"", dialect::SURFACE_ID);
                element::push_alone(out, &mark, &names);
            }
        }
        out.push('\n');
    }
}

/// The layer with numbers in px, or in the unit that makes them shortest, if this saves more than the attribute costs.
fn shortest(number: usize, layer: &Layer, options: &WriteOptions, sheet: Option<&Sheet>) -> String {
    let text = |unit| text(number, layer, options, unit, sheet);
    let in_px = text(Unit::PX);
    // The axis of a gradient is in px.
    let has_shades = layer.strokes.iter().any(|mark| mark.mark.shade().is_some());
    if options.unit() == Unit::PX || has_shades {
        return in_px;
    }
    Some(text(options.unit()))
        .filter(|other| other.len() < in_px.len())
        .unwrap_or(in_px)
}

fn text(
    number: usize,
    layer: &Layer,
    options: &WriteOptions,
    unit: Unit,
    sheet: Option<&Sheet>,
) -> String {
    let form = options.form;
    // Plotter software reads the leading digits of a label as the layer number, so `#102030` would become layer 102030.
    let count_first = match options.order {
        Order::Travel => format!("{number} "),
        Order::Fitted => String::new(),
    };
    let (kind, label) = match layer.kind {
        LayerKind::Color(color, 0) => ("color", format!("{count_first}{}", dialect::hex(color))),
        LayerKind::Color(color, repeats) => {
            let label = format!("{count_first}{} ({})", dialect::hex(color), repeats + 1);
            ("color", label)
        }
        LayerKind::Object(Some(color)) => (
            "object",
            format!("{count_first}Thing {number}, {}", names::of_color(color)),
        ),
        LayerKind::Object(None) => ("object", format!("{count_first}Marks {number}")),
        LayerKind::Stage => ("stage", format!("Stage {number}")),
    };
    let id = format!("{kind}-{number}");
    let namespace = match layer.strokes.iter().any(|mark| mark.line().is_some()) {
        true if form != Form::Outlines => {
            format!(" xmlns:strokefit=\"{}\"", dialect::LINE_NAMESPACE)
        }
        _ => String::new(),
    };
    let transform = match unit {
        Unit::PX => String::new(),
        _ => format!(" transform=\"{}\"", unit.transform()),
    };
    let mut out = format!(
        "<g id=\"{id}\" inkscape:groupmode=\"layer\" inkscape:label=\"{label}\"{namespace}{}{transform}{}>\n\
         <title>{label}: {}</title>\n",
        style_attributes(layer, form),
        element::layer_width(&layer.strokes, form, unit),
        counts(layer),
    );
    let names = Names {
        layer: matches!(layer.kind, LayerKind::Object(_)).then_some(number),
        sheet,
    };
    element::push(&mut out, &layer.strokes, form, unit, names);
    if !out.ends_with('\n') {
        out.push('\n');
    }
    out + "</g>\n"
}

/// The numbers of areas and strokes of a layer in words.
fn counts(layer: &Layer) -> String {
    let areas = layer
        .strokes
        .iter()
        .filter(|mark| mark.mark.is_area())
        .count();
    counted(areas, layer.strokes.len() - areas)
}

/// The attributes of a layer that turn its paths without a fill into strokes: with round ends, unless it has bands alone.
fn style_attributes(layer: &Layer, form: Form) -> &'static str {
    let round = || layer.strokes.iter().filter(|mark| mark.is_round());
    let mut paths = round().flat_map(Written::paths);
    if form == Form::Outlines || layer.strokes.iter().all(Written::is_filled) {
        ""
    } else if round().next().is_none() {
        " fill=\"none\""
    } else if paths.any(Path::has_joins) {
        " fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\""
    } else {
        " fill=\"none\" stroke-linecap=\"round\""
    }
}
