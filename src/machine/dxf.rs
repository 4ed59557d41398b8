//! DXF: lines, circles and polylines with arcs in millimetres, on a layer for each colour (AutoCAD 2004).
//!
//! Strokes of any kind are their centre lines, areas are their rings, circles are circles, and dots are points. Arcs are arcs, and curves
//! are pairs of arcs that meet without a corner, as cutters and routers read them; the format has no compound paths and no opacity.

mod arcs;
mod file;

use kurbo::QuadBez;

use super::Sheet;
use crate::math::Point;
use crate::scene::{Path, PathPiece, Shape, distinct_colors, quantum};
use arcs::{DEEPEST, Vertex};
use file::File;

/// Farthest that arcs are from their curve, mm.
const TOLERANCE: f64 = 0.01;

/// The text of a DXF of the drawing.
pub fn dxf(sheet: &Sheet<'_>) -> String {
    let scene = sheet.scene.without_shadows();
    let colors = distinct_colors(scene.marks().map(|mark| mark.color().map(quantum)));
    let [width, height] = [sheet.scene.width, sheet.scene.height].map(f64::from);
    let page = Point::new(width * sheet.mm(), height * sheet.mm());
    let mut file = File::new();
    for mark in scene.marks() {
        let layer = file::layer(mark.color().map(quantum));
        for path in mark.paths() {
            push(&mut file, &layer, path, sheet);
        }
    }
    file.finish(page, &colors)
}

/// Appends a path.
fn push(file: &mut File, layer: &str, path: &Path, sheet: &Sheet<'_>) {
    let height = f64::from(sheet.scene.height);
    // Its y axis goes up.
    let at = |p: Point| Point::new(p.x * sheet.mm(), (height - p.y) * sheet.mm());
    if let [dot] = path.points() {
        return file.point(layer, at(dot.at));
    }
    if let Some(Shape::Circle { center, radius }) = path.shape() {
        return file.circle(layer, at(center), radius * sheet.mm());
    }
    let pieces: Vec<PathPiece> = path.pieces().collect();
    // Simple entities first: every reader knows lines, circles and points, and an operator can edit them.
    if let [PathPiece::Line(line)] = pieces[..] {
        return file.line(layer, at(line.p0), at(line.p1));
    }
    let mut vertices: Vec<Vertex> = Vec::new();
    for piece in &pieces {
        push_piece(&mut vertices, piece, sheet.mm(), at);
    }
    // A closed polyline goes back to its first vertex by itself.
    if !path.is_closed() {
        let end = pieces.last().map(|last| at(last.end()));
        vertices.extend(end.map(|at| Vertex { at, bulge: 0.0 }));
    }
    file.polyline(layer, &vertices, path.is_closed());
}

/// Appends the vertices of a piece without its end. A px is so many `mm`, and `at` gives the place in the file.
fn push_piece(vertices: &mut Vec<Vertex>, piece: &PathPiece, mm: f64, at: impl Fn(Point) -> Point) {
    let mut push_curve = |curve: QuadBez, tolerance: f64| {
        let curve = QuadBez::new(at(curve.p0), at(curve.p1), at(curve.p2));
        arcs::push(vertices, curve, tolerance, DEEPEST);
    };
    match piece {
        PathPiece::Quad(curve) => push_curve(*curve, TOLERANCE),
        PathPiece::Cubic(_) => {
            // Half of the tolerance for the quadratic curves, half for their arcs.
            let half = 0.5 * TOLERANCE;
            let quads = piece.quads(half / mm).into_iter();
            quads.for_each(|quad| push_curve(quad, half));
        }
        PathPiece::Line(line) => vertices.push(Vertex {
            at: at(line.p0),
            bulge: 0.0,
        }),
        // Both bulges are tangents of a quarter of the sweep. That of a path is positive clockwise on the page; that of a DXF is
        // positive counter-clockwise, seen with y up, and the flip of y does not change what is seen.
        PathPiece::Arc(arc) => vertices.push(Vertex {
            at: at(arc.from),
            bulge: -arc.bulge(),
        }),
    }
}
