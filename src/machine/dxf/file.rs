//! The sections of a DXF, as pairs of a group code and a value.

use std::fmt::{Display, Write};

use kurbo::Point;

use super::arcs::Vertex;

/// All but the layers of colours and the entities, a pair a line; {} is an empty value.
const TEMPLATE: &str = include_str!("template.txt");

/// Handles of the block that entities are in, of the first entity, and of the first layer.
const MODEL_SPACE: &str = "1F";
const FIRST_ENTITY: u32 = 0x100;
const FIRST_LAYER: u32 = 0x1_0000;

/// The name of the layer of a colour.
pub(super) fn layer([r, g, b]: [u8; 3]) -> String {
    format!("{r:02x}{g:02x}{b:02x}")
}

/// The entities of a file.
pub(super) struct File {
    text: String,
    /// Handle of the last one.
    handle: u32,
}

impl File {
    pub(super) fn new() -> Self {
        Self {
            text: String::new(),
            handle: FIRST_ENTITY,
        }
    }

    /// The text of the file for a page whose sides, in mm, are those of a point, with a layer for each colour.
    pub(super) fn finish(self, page: Point, colors: &[[u8; 3]]) -> String {
        let mut whole = Self::new();
        for line in TEMPLATE.lines() {
            match line.split_once(' ') {
                Some((code, value)) => {
                    let value = value
                        .replace("{width}", &number(page.x))
                        .replace("{height}", &number(page.y))
                        .replace("{count}", &(colors.len() + 1).to_string())
                        .replace("{}", "");
                    whole.pair(&code, &value);
                }
                None if line == "LAYERS" => whole.layers(colors),
                None => whole.text += &self.text,
            }
        }
        whole.text
    }

    /// The records of the layers of colours.
    fn layers(&mut self, colors: &[[u8; 3]]) {
        for (color, handle) in colors.iter().zip(FIRST_LAYER..) {
            let (handle, name) = (format!("{handle:X}"), layer(*color));
            let [r, g, b] = color.map(u32::from);
            self.object("LAYER", &handle, "2", "AcDbSymbolTableRecord");
            self.pairs(&[(100, "AcDbLayerTableRecord"), (2, &name), (70, "0")]);
            self.pair(&62, &index(*color));
            // Readers of later versions take the true colour.
            self.pair(&420, &(r << 16 | g << 8 | b));
            self.pair(&6, &"Continuous");
        }
    }

    /// A straight line.
    pub(super) fn line(&mut self, layer: &str, a: Point, b: Point) {
        self.entity("LINE", layer, "AcDbLine");
        self.place(10, a);
        self.place(11, b);
    }

    /// A point.
    pub(super) fn point(&mut self, layer: &str, at: Point) {
        self.entity("POINT", layer, "AcDbPoint");
        self.place(10, at);
    }

    /// A circle.
    pub(super) fn circle(&mut self, layer: &str, center: Point, radius: f64) {
        self.entity("CIRCLE", layer, "AcDbCircle");
        self.place(10, center);
        self.pair(&40, &number(radius));
    }

    /// Lines and arcs.
    pub(super) fn polyline(&mut self, layer: &str, vertices: &[Vertex], closed: bool) {
        self.entity("LWPOLYLINE", layer, "AcDbPolyline");
        self.pair(&90, &vertices.len());
        self.pair(&70, &u8::from(closed));
        for vertex in vertices {
            self.pair(&10, &number(vertex.at.x));
            self.pair(&20, &number(vertex.at.y));
            if vertex.bulge != 0.0 {
                self.pair(&42, &format!("{:.6}", vertex.bulge));
            }
        }
    }

    #[inline(never)]
    fn object(&mut self, kind: &str, handle: &str, owner: &str, class: &str) {
        self.pairs(&[(0, kind), (5, handle), (330, owner), (100, class)]);
    }

    /// The head of an entity of the drawing.
    fn entity(&mut self, kind: &str, layer: &str, class: &str) {
        self.handle += 1;
        let mut handle = format!("{:X}", self.handle);
        // Layers have the handles in between.
        if self.handle >= FIRST_LAYER {
            handle = format!("{:X}", self.handle + FIRST_LAYER);
        }
        self.object(kind, &handle, MODEL_SPACE, "AcDbEntity");
        self.pairs(&[(8, layer), (100, class)]);
    }

    /// A place of three coordinates, the first with this code.
    #[inline(never)]
    fn place(&mut self, code: i32, Point { x, y }: Point) {
        self.pair(&code, &number(x));
        self.pair(&(code + 10), &number(y));
        self.pair(&(code + 20), &"0.0");
    }

    #[inline(never)]
    fn pairs(&mut self, pairs: &[(i32, &str)]) {
        for (code, value) in pairs {
            self.pair(code, value);
        }
    }

    // A page downloads this once, and not at every pair.
    #[inline(never)]
    fn pair(&mut self, code: &dyn Display, value: &dyn Display) {
        let _ = writeln!(self.text, "{code}\n{value}");
    }
}

/// A length in mm.
#[inline(never)]
fn number(mm: f64) -> String {
    format!("{mm:.4}")
}

/// The index of AutoCAD's colour that is nearest among its plain ones, for readers that know no other.
fn index(color: [u8; 3]) -> u8 {
    const PLAIN: [([u8; 3], u8); 9] = [
        ([255, 0, 0], 1),
        ([255, 255, 0], 2),
        ([0, 255, 0], 3),
        ([0, 255, 255], 4),
        ([0, 0, 255], 5),
        ([255, 0, 255], 6),
        // White on black, black on white.
        ([0, 0, 0], 7),
        ([128, 128, 128], 8),
        ([192, 192, 192], 9),
    ];
    let away2 = |other: [u8; 3]| -> i32 {
        let away = |k: usize| i32::from(color[k]) - i32::from(other[k]);
        (0..3).map(|k| away(k) * away(k)).sum()
    };
    PLAIN
        .iter()
        .min_by_key(|(plain, _)| away2(*plain))
        .map_or(7, |(_, index)| *index)
}
