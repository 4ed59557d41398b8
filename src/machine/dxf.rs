//! DXF: lines, circles and polylines with arcs in millimetres, on a layer for each colour (AutoCAD 2004).
//!
//! Strokes and bands are their centre lines, areas are their rings, circles are circles, and dots are points. Quadratic curves are
//! pairs of arcs that meet without a corner, as cutters and routers read them; the format has no compound paths and no opacity.

mod arcs;
mod file;

use super::sheet::Sheet;
use crate::scene::{Path, Piece, Shape, distinct_colors, quantum};
use arcs::Vertex;
use file::File;

/// Farthest that arcs are from their curve, mm.
const TOLERANCE: f64 = 0.01;

/// The text of a DXF of the drawing.
pub fn dxf(sheet: &Sheet<'_>) -> String {
    let colors = distinct_colors(sheet.scene.marks().map(|mark| mark.color().map(quantum)));
    let page = [sheet.scene.width, sheet.scene.height].map(|side| f64::from(side) * sheet.mm());
    let mut file = File::new(page, &colors);
    for mark in sheet.scene.marks() {
        let layer = file::layer(mark.color().map(quantum));
        let band = mark.band();
        let middle = band.as_ref().map(|band| std::slice::from_ref(&band.line));
        for path in middle.unwrap_or(mark.paths()) {
            push(&mut file, &layer, path, sheet);
        }
    }
    file.finish()
}

/// Appends a path.
fn push(file: &mut File, layer: &str, path: &Path, sheet: &Sheet<'_>) {
    let height = f64::from(sheet.scene.height);
    // Its y axis goes up.
    let at =
        |p: crate::math::Point| [f64::from(p.x), height - f64::from(p.y)].map(|px| px * sheet.mm());
    if let [dot] = path.points() {
        return file.point(layer, at(dot.at));
    }
    if let Some(Shape::Circle { center, radius }) = Shape::of(path) {
        return file.circle(layer, at(center), f64::from(radius) * sheet.mm());
    }
    let mut pieces = path.pieces();
    if let (Some(Piece::Line([a, b])), None) = (pieces.next(), pieces.next()) {
        return file.line(layer, at(a), at(b));
    }
    let mut vertices: Vec<Vertex> = Vec::new();
    let mut end = None;
    for piece in path.pieces() {
        match piece {
            Piece::Line([a, _]) => vertices.push(Vertex {
                at: at(a),
                bulge: 0.0,
            }),
            Piece::Curve(points) => arcs::push(&mut vertices, points.map(at), TOLERANCE),
        }
        end = Some(at(piece.end()));
    }
    if !path.is_closed() {
        vertices.extend(end.map(|at| Vertex { at, bulge: 0.0 }));
    }
    file.polyline(layer, &vertices, path.is_closed());
}
