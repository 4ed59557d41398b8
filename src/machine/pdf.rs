//! PDF: one page with a layer for each stage of the drawing (ISO 32000-1; layers are its optional content). This file alone uses
//! the `pdf-writer` crate.

use std::collections::BTreeSet;

use kurbo::{ParamCurve, PathSeg};
use pdf_writer::types::{FunctionShadingType, LineCapStyle, LineJoinStyle, MaskType};
use pdf_writer::writers::{ExtGraphicsState, Resources};
use pdf_writer::{Content, Dict, Filter, Finish, Name, Pdf, Rect, Ref, Settings, TextStr};

use super::Sheet;
use crate::math::{self, Point};
use crate::render;
use crate::report::deflated;
use crate::scene::{Area, Axis, Cap, Mark, Path, Rgb, Shade, ShadeStop, quantum};

/// The bytes of a PDF of the drawing. Colours are those of the screen (`DeviceRGB`), curves are exact, and lengths are those
/// of the page.
pub fn pdf(sheet: &Sheet<'_>) -> Vec<u8> {
    let scene = sheet.scene;
    let [width, height] = [scene.width, scene.height].map(|side| side as f32);
    let mut file = File::new([width, height]);
    // PDF's y axis goes up.
    let scale = sheet.pt() as f32;
    let upright = [scale, 0.0, 0.0, -scale, 0.0, scale * height];
    let head = file.content.transform(upright.map(short));
    head.set_line_cap(LineCapStyle::RoundCap);
    head.set_line_join(LineJoinStyle::RoundJoin);
    if let Some(color) = scene.background {
        file.fill_page(color);
    }
    for area in &scene.ground {
        match area.blur > 0.0 {
            true => file.shadow(area, [scene.width, scene.height]),
            false => file.mark(&Mark::Area(area.clone())),
        }
    }
    for stage in &scene.stages {
        file.layer(&stage.marks);
    }
    file.finish(short(scale))
}

/// Length of a sudden change of colour, as a share of the axis.
const STEP: f32 = 1e-4;

/// A file whose page is being drawn.
struct File {
    pdf: Pdf,
    /// The next object.
    next: Ref,
    /// The page's operators.
    content: Content,
    /// The page in px.
    page: [f32; 2],
    /// Opacities of marks, each a graphics state.
    opacities: BTreeSet<u8>,
    /// Layers, gradients and soft masks by the names that the content has for them.
    layers: Vec<(String, Ref)>,
    shadings: Vec<(String, Ref)>,
    masks: Vec<(String, Ref)>,
}

impl File {
    fn new(page: [f32; 2]) -> Self {
        let mut pdf = Pdf::with_settings(Settings { pretty: false });
        pdf.set_version(1, 5);
        Self {
            pdf,
            next: Ref::new(1),
            content: Content::new(),
            page,
            opacities: BTreeSet::new(),
            layers: Vec::new(),
            shadings: Vec::new(),
            masks: Vec::new(),
        }
    }

    /// Fills the page with a colour.
    fn fill_page(&mut self, color: Rgb) {
        let ([r, g, b], [width, height]) = (channels(color.map(quantum)), self.page);
        self.content.set_fill_rgb(r, g, b);
        self.content.rect(0.0, 0.0, width, height).fill_nonzero();
    }

    /// Draws a gradient on all that is not clipped away, and restores the graphics state.
    fn shade(&mut self, shade: &Shade) {
        // A PDF shading has no opacity: opacities are a second shading, in greys, which masks the first.
        let shading = self.shading(shade, true);
        let opacity = self.shading(shade, false);
        let mut content = Content::new();
        content.shading(Name(b"Mask"));
        self.mask(&content.finish(), |resources| {
            resources.shadings().pair(Name(b"Mask"), opacity);
        });
        let name = format!("Shade{}", self.shadings.len());
        self.content.shading(Name(name.as_bytes())).restore_state();
        self.shadings.push((name, shading));
    }

    /// The colours of a gradient, or its opacities as greys.
    fn shading(&mut self, shade: &Shade, is_color: bool) -> Ref {
        let value = |stop: &ShadeStop| match is_color {
            true => channels(stop.color.map(quantum)).to_vec(),
            false => vec![level(quantum(stop.opacity))],
        };
        let function = self.function(shade.stops(), value);
        let id = self.next.bump();
        let mut shading = self.pdf.function_shading(id);
        let space = shading.color_space();
        if is_color {
            space.device_rgb();
        } else {
            space.device_gray();
        }
        match shade.axis() {
            Axis::Linear { from, to } => {
                shading.shading_type(FunctionShadingType::Axial);
                shading.coords([from.x, from.y, to.x, to.y].map(|px| px as f32));
            }
            Axis::Radial { center, radius } => {
                let [x, y, r] = [center.x, center.y, radius].map(|px| px as f32);
                shading.shading_type(FunctionShadingType::Radial);
                shading.coords([x, y, 0.0, x, y, r]);
            }
        }
        shading.extend([true, true]).function(function);
        id
    }

    /// The values between stops, which change linearly.
    fn function(&mut self, stops: &[ShadeStop], value: impl Fn(&ShadeStop) -> Vec<f32>) -> Ref {
        let offset = |stop: &ShadeStop| stop.offset;
        // The first and the last colour go on to the ends of the axis, as in SVG.
        let first = stops.first().map(|stop| (0.0, value(stop)));
        let last = stops.last().map(|stop| (1.0, value(stop)));
        let between = stops.iter().map(|stop| (offset(stop), value(stop)));
        let mut knots: Vec<(f32, Vec<f32>)> =
            first.into_iter().chain(between).chain(last).collect();
        knots.dedup_by(|next, kept| next.0 <= kept.0 && next.1 == kept.1);
        // Every step of a stitching function has a length.
        for i in 1..knots.len() {
            knots[i].0 = knots[i].0.max(knots[i - 1].0 + STEP);
        }
        let mut steps = Vec::new();
        for ends in knots.windows(2) {
            let id = self.next.bump();
            let [from, to] = [&ends[0].1, &ends[1].1].map(|values| values.iter().copied());
            let mut step = self.pdf.exponential_function(id);
            step.domain([0.0, 1.0]).c0(from).c1(to).n(1.0);
            steps.push(id);
        }
        // A stitching function lists only the bounds between its steps.
        let inner = knots.iter().skip(1).take(steps.len().saturating_sub(1));
        let id = self.next.bump();
        let mut whole = self.pdf.stitching_function(id);
        whole.domain([0.0, 1.0]).bounds(inner.map(|knot| knot.0));
        whole.encode(steps.iter().flat_map(|_| [0.0, 1.0]));
        whole.functions(steps);
        id
    }

    /// Draws a shadow: PDF has no blur, so that its coverage is an image, which masks its colour. Restores the graphics state.
    fn shadow(&mut self, shadow: &Area, [width, height]: [u32; 2]) {
        self.content.save_state();
        let coverage = render::coverage(shadow, width as usize, height as usize).into_iter();
        let levels = coverage.map(|covered| (255.0 * shadow.opacity * covered + 0.5) as u8);
        let levels = deflated(&levels.collect::<Vec<_>>());
        let id = self.next.bump();
        let mut image = self.pdf.image_xobject(id, &levels);
        image.filter(Filter::FlateDecode);
        image.width(width as i32).height(height as i32);
        image.color_space().device_gray();
        image.bits_per_component(8).interpolate(true);
        image.finish();
        // An image fills a square whose y axis goes up.
        let mut content = Content::new();
        let [width, height] = self.page;
        content.transform([width, 0.0, 0.0, -height, 0.0, height]);
        content.x_object(Name(b"Image"));
        self.mask(&content.finish(), |resources| {
            resources.x_objects().pair(Name(b"Image"), id);
        });
        self.fill_page(shadow.color);
        self.content.restore_state();
    }

    /// Masks all that follows by the luminosity of `content`, which uses the `resources`.
    fn mask(&mut self, content: &[u8], resources: impl FnOnce(&mut Resources<'_>)) {
        let content = deflated(content);
        let id = self.next.bump();
        let mut form = self.pdf.form_xobject(id, &content);
        let [width, height] = self.page;
        form.filter(Filter::FlateDecode);
        form.bbox(Rect::new(0.0, 0.0, width, height));
        form.group().transparency().color_space().device_gray();
        resources(&mut form.resources());
        form.finish();
        let state = self.next.bump();
        let mut graphics = self.pdf.ext_graphics(state);
        graphics.soft_mask().subtype(MaskType::Luminosity).group(id);
        let name = format!("Mask{}", self.masks.len());
        self.content.set_parameters(Name(name.as_bytes()));
        self.masks.push((name, state));
    }

    /// Draws the marks of a stage as a layer.
    fn layer(&mut self, marks: &[Mark]) {
        let id = self.next.bump();
        let number = self.layers.len() + 1;
        let (name, title) = (format!("L{number}"), format!("Layer {number}"));
        let mut layer = self.pdf.indirect(id).dict();
        layer.pair(Name(b"Type"), Name(b"OCG"));
        layer.pair(Name(b"Name"), TextStr(&title));
        layer.finish();
        let content = &mut self.content;
        let begun = content.begin_marked_content_with_properties(Name(b"OC"));
        begun.properties_named(Name(name.as_bytes()));
        self.layers.push((name, id));
        marks.iter().for_each(|mark| self.mark(mark));
        self.content.end_marked_content();
    }

    /// Draws a mark.
    fn mark(&mut self, mark: &Mark) {
        // PDF has no lines whose width varies.
        if mark.is_varying() {
            return self.mark(&mark.clone().filled());
        }
        let opacity = quantum(mark.opacity());
        self.opacities.insert(opacity);
        let [r, g, b] = channels(mark.color().map(quantum));
        let content = &mut self.content;
        content.set_parameters(Name(format!("O{opacity}").as_bytes()));
        match mark {
            Mark::Stroke(stroke) => {
                let width = short(2.0 * stroke.radius as f32);
                content.set_stroke_rgb(r, g, b).save_state();
                if stroke.cap == Cap::Butt {
                    // Mitred corners do not reach farther than in SVG.
                    content.set_line_cap(LineCapStyle::ButtCap);
                    content.set_line_join(LineJoinStyle::MiterJoin);
                    content.set_miter_limit(4.0);
                }
                content.set_line_width(width);
                push(content, &stroke.path);
                content.stroke().restore_state();
            }
            Mark::Area(area) => {
                content.set_fill_rgb(r, g, b).save_state();
                area.rings.iter().for_each(|ring| push(content, ring));
                if let Some(shade) = mark.shade() {
                    // A shading fills all that is visible, so the area clips it; `shade` restores the state saved above.
                    content.clip_nonzero().end_path();
                    self.shade(shade);
                } else {
                    content.fill_nonzero().restore_state();
                }
            }
        }
    }

    /// The bytes of the file, whose page has so many points for a px.
    fn finish(mut self, scale: f32) -> Vec<u8> {
        let [root, pages, only, content] = [(); 4].map(|()| self.next.bump());
        let data = deflated(&self.content.finish());
        self.pdf.stream(content, &data).filter(Filter::FlateDecode);
        self.pdf.pages(pages).kids([only]).count(1);
        let mut page = self.pdf.page(only);
        let [width, height] = self.page.map(|side| short(side * scale));
        page.media_box(Rect::new(0.0, 0.0, width, height));
        page.parent(pages).contents(content);
        page.group().transparency().color_space().device_rgb();
        let mut resources = page.resources();
        let mut states = resources.ext_g_states();
        for &opacity in &self.opacities {
            let state = states.insert(Name(format!("O{opacity}").as_bytes()));
            let mut state = state.start::<ExtGraphicsState<'_>>();
            state.non_stroking_alpha(level(opacity));
            state.stroking_alpha(level(opacity));
        }
        name(states, &self.masks);
        name(resources.shadings(), &self.shadings);
        name(resources.insert(Name(b"Properties")).dict(), &self.layers);
        resources.finish();
        page.finish();
        let mut catalog = self.pdf.catalog(root);
        catalog.pages(pages);
        let layers = || self.layers.iter().map(|(_, id)| *id);
        let mut optional = catalog.insert(Name(b"OCProperties")).dict();
        optional.insert(Name(b"OCGs")).array().items(layers());
        let mut shown = optional.insert(Name(b"D")).dict();
        for list in [Name(b"Order"), Name(b"ON")] {
            shown.insert(list).array().items(layers());
        }
        shown.finish();
        optional.finish();
        catalog.finish();
        let mut bytes = self.pdf.finish();
        bytes.push(b'\n');
        bytes
    }
}

/// Lists named objects among the resources of the page.
fn name(mut resources: Dict<'_>, objects: &[(String, Ref)]) {
    for (name, id) in objects {
        resources.pair(Name(name.as_bytes()), *id);
    }
}

/// Appends the operators of a path.
fn push(content: &mut Content, path: &Path) {
    if let [dot] = path.points() {
        // A subpath of no length with round caps is a disc.
        let [x, y] = math::xy(dot.at).map(short);
        content.move_to(x, y).line_to(x, y);
    }
    let at = |p: Point| math::xy(p).map(short);
    for (i, segment) in path.segments().enumerate() {
        if i == 0 {
            let [x, y] = at(segment.start());
            content.move_to(x, y);
        }
        // PDF has cubic curves alone; a quadratic one is a cubic one exactly.
        let cubic = segment.to_cubic();
        let [[x1, y1], [x2, y2], [x, y]] = [cubic.p1, cubic.p2, cubic.p3].map(at);
        match segment {
            PathSeg::Line(_) => content.line_to(x, y),
            _ => content.cubic_to(x1, y1, x2, y2, x, y),
        };
    }
    if path.is_closed() {
        content.close_path();
    }
}

/// Channels of 8 bits as PDF counts them.
fn channels(color: [u8; 3]) -> [f32; 3] {
    color.map(level)
}

fn level(level: u8) -> f32 {
    short(f32::from(level) / 255.0)
}

/// A number with at most 4 decimals.
fn short(value: f32) -> f32 {
    (f64::from(value) * 1e4).round() as f32 / 1e4
}
