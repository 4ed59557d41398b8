//! The sections of a DXF, as pairs of a group code and a value.

use std::fmt::{Display, Write};

use kurbo::Point;

use super::arcs::Vertex;

/// A file whose entities are still to come.
pub(super) struct File {
    text: String,
    /// Handle of the last object.
    handle: u32,
}

/// Handles of the objects that others refer to: tables, block records, blocks and dictionaries. Entities follow.
const MODEL_SPACE: &str = "1F";
const PAPER_SPACE: &str = "1B";
const FIRST_ENTITY: u32 = 0x100;

/// The name of the layer of a colour.
pub(super) fn layer([r, g, b]: [u8; 3]) -> String {
    format!("{r:02x}{g:02x}{b:02x}")
}

impl File {
    /// A file for a page whose sides, in mm, are those of a point, with a layer for each colour.
    pub(super) fn new(page: Point, colors: &[[u8; 3]]) -> Self {
        let mut file = Self {
            text: String::new(),
            handle: FIRST_ENTITY,
        };
        file.header(page);
        file.section("TABLES");
        file.tables(colors);
        file.end_section();
        file.section("BLOCKS");
        file.block("20", "21", MODEL_SPACE, "*Model_Space");
        file.block("1C", "1D", PAPER_SPACE, "*Paper_Space");
        file.end_section();
        file.section("ENTITIES");
        file
    }

    /// The text of the file.
    pub(super) fn finish(mut self) -> String {
        self.end_section();
        self.section("OBJECTS");
        self.object("DICTIONARY", "C", "0", "AcDbDictionary");
        self.pairs(&[(281, "1"), (3, "ACAD_GROUP"), (350, "D")]);
        self.object("DICTIONARY", "D", "C", "AcDbDictionary");
        self.pair(281, &1);
        self.end_section();
        self.pair(0, &"EOF");
        self.text
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
        self.pair(40, &number(radius));
    }

    /// Lines and arcs.
    pub(super) fn polyline(&mut self, layer: &str, vertices: &[Vertex], closed: bool) {
        self.entity("LWPOLYLINE", layer, "AcDbPolyline");
        self.pair(90, &vertices.len());
        self.pair(70, &u8::from(closed));
        for vertex in vertices {
            self.pair(10, &number(vertex.at.x));
            self.pair(20, &number(vertex.at.y));
            if vertex.bulge != 0.0 {
                self.pair(42, &format!("{:.6}", vertex.bulge));
            }
        }
    }

    fn header(&mut self, page: Point) {
        self.section("HEADER");
        let variable = |file: &mut Self, name: &str, code: i32, value: &str| {
            file.pair(9, &name);
            file.pair(code, &value);
        };
        variable(self, "$ACADVER", 1, "AC1018");
        variable(self, "$HANDSEED", 5, "FFFFFF");
        // Millimetres.
        variable(self, "$INSUNITS", 70, "4");
        variable(self, "$MEASUREMENT", 70, "1");
        for (name, at) in [("$EXTMIN", Point::ZERO), ("$EXTMAX", page)] {
            self.pair(9, &name);
            self.place(10, at);
        }
        self.end_section();
    }

    fn tables(&mut self, colors: &[[u8; 3]]) {
        self.table("VPORT", "8", 0);
        self.end_table();
        self.table("LTYPE", "5", 3);
        for (handle, name) in [("14", "ByBlock"), ("15", "ByLayer"), ("16", "Continuous")] {
            self.record("LTYPE", handle, "5", "AcDbLinetypeTableRecord", name);
            self.pairs(&[(3, ""), (72, "65"), (73, "0"), (40, "0.0")]);
        }
        self.end_table();
        self.table("LAYER", "2", colors.len() + 1);
        self.record("LAYER", "10", "2", "AcDbLayerTableRecord", "0");
        self.pairs(&[(62, "7"), (6, "Continuous")]);
        for (color, handle) in colors.iter().zip(0x1_0000..) {
            let handle = format!("{handle:X}");
            self.record(
                "LAYER",
                &handle,
                "2",
                "AcDbLayerTableRecord",
                &layer(*color),
            );
            self.pair(62, &index(*color));
            // Readers of later versions take the true colour.
            let [r, g, b] = color.map(u32::from);
            self.pair(420, &(r << 16 | g << 8 | b));
            self.pair(6, &"Continuous");
        }
        self.end_table();
        self.table("STYLE", "3", 1);
        self.record("STYLE", "11", "3", "AcDbTextStyleTableRecord", "Standard");
        self.pairs(&[
            (40, "0.0"),
            (41, "1.0"),
            (50, "0.0"),
            (71, "0"),
            (42, "2.5"),
            (3, "txt"),
            (4, ""),
        ]);
        self.end_table();
        for (table, handle) in [("VIEW", "6"), ("UCS", "7")] {
            self.table(table, handle, 0);
            self.end_table();
        }
        self.table("APPID", "9", 1);
        self.record("APPID", "12", "9", "AcDbRegAppTableRecord", "ACAD");
        self.end_table();
        self.table("DIMSTYLE", "A", 0);
        self.pair(100, &"AcDbDimStyleTable");
        self.end_table();
        self.table("BLOCK_RECORD", "1", 2);
        for (handle, name) in [(MODEL_SPACE, "*Model_Space"), (PAPER_SPACE, "*Paper_Space")] {
            self.object("BLOCK_RECORD", handle, "1", "AcDbSymbolTableRecord");
            self.pair(100, &"AcDbBlockTableRecord");
            self.pair(2, &name);
        }
        self.end_table();
    }

    fn table(&mut self, name: &str, handle: &str, entries: usize) {
        self.pair(0, &"TABLE");
        self.pair(2, &name);
        self.pairs(&[(5, handle), (330, "0"), (100, "AcDbSymbolTable")]);
        self.pair(70, &entries);
    }

    fn end_table(&mut self) {
        self.pair(0, &"ENDTAB");
    }

    /// A record of a table.
    fn record(&mut self, kind: &str, handle: &str, owner: &str, class: &str, name: &str) {
        self.object(kind, handle, owner, "AcDbSymbolTableRecord");
        self.pairs(&[(100, class), (2, name), (70, "0")]);
    }

    fn block(&mut self, begin: &str, end: &str, owner: &str, name: &str) {
        self.object("BLOCK", begin, owner, "AcDbEntity");
        self.pairs(&[(8, "0"), (100, "AcDbBlockBegin"), (2, name), (70, "0")]);
        self.place(10, Point::ZERO);
        self.pairs(&[(3, name), (1, "")]);
        self.object("ENDBLK", end, owner, "AcDbEntity");
        self.pairs(&[(8, "0"), (100, "AcDbBlockEnd")]);
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
        if self.handle >= 0x1_0000 {
            handle = format!("{:X}", self.handle + 0x1_0000);
        }
        self.object(kind, &handle, MODEL_SPACE, "AcDbEntity");
        self.pairs(&[(8, layer), (100, class)]);
    }

    fn section(&mut self, name: &str) {
        self.pairs(&[(0, "SECTION"), (2, name)]);
    }

    fn end_section(&mut self) {
        self.pair(0, &"ENDSEC");
    }

    /// A place of three coordinates, the first with this code.
    #[inline(never)]
    fn place(&mut self, code: i32, Point { x, y }: Point) {
        self.pair(code, &number(x));
        self.pair(code + 10, &number(y));
        self.pair(code + 20, &"0.0");
    }

    #[inline(never)]
    fn pairs(&mut self, pairs: &[(i32, &str)]) {
        for (code, value) in pairs {
            self.pair(*code, value);
        }
    }

    // A page downloads this once, and not at every pair.
    #[inline(never)]
    fn pair(&mut self, code: i32, value: &dyn Display) {
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
