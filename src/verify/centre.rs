//! The centre lines of an SVG's strokes, as usvg resolves them.

use resvg::tiny_skia::{PathSegment, Point as SkiaPoint};
use resvg::usvg::{Group, Node, Path};

use super::tree::parse;
use crate::error::Result;
use crate::math::Point;

/// Chords of a curve.
const CHORDS: u16 = 24;

/// The centre lines of one stroked element.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CentreLines {
    /// The lines of its subpaths, px; curves are chords.
    pub lines: Vec<Vec<Point>>,
    /// Ends, corners and control points.
    pub points: usize,
}

/// The centre lines of all strokes of SVG text, of `scale` px per unit of the SVG's own size, back to front.
///
/// # Errors
/// [`ErrorKind::Svg`](crate::ErrorKind::Svg) when the text is no SVG.
pub fn centre_lines(svg: &str, scale: f32) -> Result<Vec<CentreLines>> {
    let tree = parse(svg)?;
    let mut found = Vec::new();
    collect(tree.root(), scale, &mut found);
    Ok(found)
}

fn collect(group: &Group, scale: f32, found: &mut Vec<CentreLines>) {
    for node in group.children() {
        match node {
            Node::Group(group) => collect(group, scale, found),
            Node::Path(path) if path.stroke().is_some() => found.push(of(path, scale)),
            _ => {}
        }
    }
}

fn of(path: &Path, scale: f32) -> CentreLines {
    let transform = path.abs_transform();
    let place = |mut p: SkiaPoint| {
        transform.map_point(&mut p);
        Point::new(p.x * scale, p.y * scale)
    };
    let mut centre = CentreLines::default();
    let mut here = Point::new(0.0, 0.0);
    for segment in path.data().segments() {
        let curve: Vec<Point> = match segment {
            PathSegment::MoveTo(p) => {
                here = place(p);
                centre.lines.push(vec![here]);
                centre.points += 1;
                continue;
            }
            PathSegment::LineTo(p) => vec![here, place(p)],
            PathSegment::QuadTo(c, p) => vec![here, place(c), place(p)],
            PathSegment::CubicTo(c, d, p) => vec![here, place(c), place(d), place(p)],
            PathSegment::Close => {
                if let Some(line) = centre.lines.last_mut() {
                    line.extend(line.first().copied());
                }
                continue;
            }
        };
        centre.points += curve.len() - 1;
        let chords = if curve.len() == 2 { 1 } else { CHORDS };
        if let Some(line) = centre.lines.last_mut() {
            let share = |i: u16| f32::from(i) / f32::from(chords);
            line.extend((1..=chords).map(|i| at(&curve, share(i))));
        }
        here = curve[curve.len() - 1];
    }
    centre
}

/// The point at `t` of a Bézier curve, after de Casteljau.
fn at(points: &[Point], t: f32) -> Point {
    let mut points = points.to_vec();
    while points.len() > 1 {
        points = points
            .windows(2)
            .map(|w| w[0] + (w[1] - w[0]) * t)
            .collect();
    }
    points[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centre_lines_are_in_px_of_the_scale() {
        let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="12" height="12" viewBox="0 0 24 24">
            <path d="M2 4h8v6z" fill="none" stroke="red"/><path d="M0 0h3v3z"/>
            <g transform="translate(2 2)"><path d="M0 0Q4 0 4 4" fill="none" stroke="red"/></g></svg>"#;
        let found = centre_lines(svg, 4.0).unwrap();
        assert_eq!(found.len(), 2, "the filled path has no stroke");
        let triangle = [[4.0, 8.0], [20.0, 8.0], [20.0, 20.0], [4.0, 8.0]];
        assert_eq!(found[0].lines, [triangle.map(|[x, y]| Point::new(x, y))]);
        assert_eq!((found[0].points, found[1].points), (3, 3));
        let curve = &found[1].lines[0];
        assert_eq!(curve.len(), 25);
        assert_eq!(
            (curve[0], curve[24]),
            (Point::new(4.0, 4.0), Point::new(12.0, 12.0))
        );
        assert!((curve[12] - Point::new(10.0, 6.0)).norm() < 1e-5);
    }
}
