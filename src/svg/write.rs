//! A scene as SVG text.

use super::dialect;
use crate::scene::{Scene, Stage, Stroke, Written, quantum};

/// How to write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WriteOptions {
    /// Decimals of coordinates and widths, 0..=6; more are taken as 6.
    pub precision: u8,
}

impl Default for WriteOptions {
    /// Two decimals: a hundredth of a px is finer than any rasteriser's grid.
    fn default() -> Self {
        Self { precision: 2 }
    }
}

/// The scene as SVG text, as [`Scene::quantized`] would round it; what that drops is not written.
pub fn write(scene: &Scene, options: &WriteOptions) -> String {
    let mut out = head(scene);
    out.push_str(&layers(scene, options, 1));
    out.push_str("</svg>\n");
    out
}

/// The layers of the scene alone, a line each for head, title, strokes and end, to be put into a document of
/// the scene's size. They are numbered from `first`; `xmlns:inkscape` must be declared around them.
pub fn layers(scene: &Scene, options: &WriteOptions, first: usize) -> String {
    let mut out = String::new();
    for (index, stage) in scene.stages.iter().enumerate() {
        push_stage(&mut out, first + index, stage, scene, options);
    }
    out
}

/// Bytes that the stroke takes in a file, 0 when it would be dropped wherever it lay.
pub fn stroke_bytes(stroke: &Stroke, options: &WriteOptions) -> usize {
    let mut out = String::new();
    if let Some(written) = Written::anywhere(stroke, options.precision) {
        push_stroke(&mut out, &written);
    }
    out.len()
}

fn head(scene: &Scene) -> String {
    let Scene { width, height, .. } = *scene;
    let (svg, inkscape) = (dialect::SVG_NAMESPACE, dialect::INKSCAPE_NAMESPACE);
    let mut out = format!(
        "<svg xmlns=\"{svg}\" xmlns:inkscape=\"{inkscape}\" \
         width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n"
    );
    if let Some(color) = scene.background {
        let fill = dialect::hex(color.map(quantum));
        out += &format!("<rect width=\"{width}\" height=\"{height}\" fill=\"{fill}\"/>\n");
    }
    out
}

fn push_stage(
    out: &mut String,
    number: usize,
    stage: &Stage,
    scene: &Scene,
    options: &WriteOptions,
) {
    let strokes: Vec<_> = stage
        .strokes
        .iter()
        .filter_map(|stroke| Written::new(stroke, scene, options.precision))
        .collect();
    let count = strokes.len();
    let plural = if count == 1 { "" } else { "s" };
    *out += &format!(
        "<g id=\"stage-{number}\" inkscape:groupmode=\"layer\" inkscape:label=\"Stage {number}\" \
         fill=\"none\" stroke-linecap=\"round\">\n<title>Stage {number}: {count} stroke{plural}</title>\n"
    );
    for stroke in &strokes {
        push_stroke(out, stroke);
    }
    out.push_str("</g>\n");
}

fn push_stroke(out: &mut String, stroke: &Written) {
    out.push_str("<path d=\"");
    out.push_str(&dialect::path_data(&stroke.points));
    out.push_str("\" stroke=\"");
    out.push_str(&dialect::hex(stroke.color));
    out.push_str("\" stroke-width=\"");
    dialect::push_number(out, stroke.width);
    if stroke.opacity < u8::MAX {
        out.push_str("\" stroke-opacity=\"");
        out.push_str(&dialect::opacity(stroke.opacity));
    }
    out.push_str("\"/>\n");
}
