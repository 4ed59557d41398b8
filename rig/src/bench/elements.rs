//! The painted elements of an SVG, as usvg resolves them: centre lines of strokes, and outlines of filled areas. The one door
//! of `resvg`.

use resvg::tiny_skia::{PathSegment, Point as SkiaPoint};
use resvg::usvg::{Group, Node, Options, Paint, Path, Tree};

use strokefit::math::Point;
use strokefit::{Error, ErrorKind, Result};

/// Chords of a curve.
const CHORDS: u16 = 24;

/// An element with a stroke, or else one that is filled.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Element {
    /// Centre lines where it has a stroke, else outlines: one for each subpath, px; curves are chords.
    pub(super) lines: Vec<Vec<Point>>,
    /// Ends, corners and control points.
    pub(super) points: usize,
    /// Where its segments begin and end, px.
    pub(super) nodes: Vec<Point>,
    /// The stroke's width, px; `None` without a stroke.
    pub(super) width_px: Option<f32>,
    /// True if it is filled.
    pub(super) filled: bool,
    /// 8-bit sRGB of the stroke; `None` without one, and where it is a gradient or a pattern.
    pub(super) color: Option<[u8; 3]>,
}

/// All painted elements of SVG text whose longer side has `longer_px` px, back to front.
///
/// # Errors
/// [`ErrorKind::Svg`] when the text is no SVG.
pub(super) fn elements(svg: &str, longer_px: f32) -> Result<Vec<Element>> {
    let tree = Tree::from_str(svg, &Options::default()).map_err(|e| {
        let message = format!("not an SVG that resvg can read: {e}");
        Error::new(ErrorKind::Svg, message)
    })?;
    let scale = longer_px / tree.size().width().max(tree.size().height());
    let mut found = Vec::new();
    collect(tree.root(), scale, &mut found);
    Ok(found)
}

fn collect(group: &Group, scale: f32, found: &mut Vec<Element>) {
    for node in group.children() {
        match node {
            Node::Group(group) => collect(group, scale, found),
            Node::Path(path) if path.stroke().is_some() || path.fill().is_some() => {
                found.push(of(path, scale));
            }
            _ => {}
        }
    }
}

fn of(path: &Path, scale: f32) -> Element {
    let transform = path.abs_transform();
    // A stroke that is scaled unevenly has no single width: the geometric mean keeps its area.
    let (sx, sy) = transform.get_scale();
    let stroke = path.stroke();
    let mut element = Element {
        filled: path.fill().is_some(),
        width_px: stroke.map(|stroke| stroke.width().get() * (sx * sy).abs().sqrt() * scale),
        color: stroke.and_then(|stroke| match stroke.paint() {
            Paint::Color(color) => Some([color.red, color.green, color.blue]),
            _ => None,
        }),
        ..Element::default()
    };
    let place = |mut p: SkiaPoint| {
        transform.map_point(&mut p);
        Point::new(f64::from(p.x * scale), f64::from(p.y * scale))
    };
    let mut here = Point::new(0.0, 0.0);
    for segment in path.data().segments() {
        let curve: Vec<Point> = match segment {
            PathSegment::MoveTo(p) => {
                here = place(p);
                element.lines.push(vec![here]);
                element.points += 1;
                element.nodes.push(here);
                continue;
            }
            PathSegment::LineTo(p) => vec![here, place(p)],
            PathSegment::QuadTo(c, p) => vec![here, place(c), place(p)],
            PathSegment::CubicTo(c, d, p) => vec![here, place(c), place(d), place(p)],
            PathSegment::Close => {
                if let Some(line) = element.lines.last_mut() {
                    line.extend(line.first().copied());
                }
                continue;
            }
        };
        element.points += curve.len() - 1;
        let chords = if curve.len() == 2 { 1 } else { CHORDS };
        if let Some(line) = element.lines.last_mut() {
            let share = |i: u16| f64::from(i) / f64::from(chords);
            line.extend((1..=chords).map(|i| at(&curve, share(i))));
        }
        here = curve[curve.len() - 1];
        element.nodes.push(here);
    }
    element
}

/// The point at `t` of a Bézier curve, after de Casteljau.
fn at(points: &[Point], t: f64) -> Point {
    let mut points = points.to_vec();
    while points.len() > 1 {
        points = points.windows(2).map(|w| w[0].lerp(w[1], t)).collect();
    }
    points[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRAWING: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="12" height="12" viewBox="0 0 24 24">
        <path d="M2 4h8v6z" fill="none" stroke="red"/><path d="M0 0h3v3z"/>
        <g transform="translate(2 2)"><path d="M0 0Q4 0 4 4" fill="none" stroke="#0000ff" stroke-width="3"/></g></svg>"##;

    #[test]
    fn centre_lines_are_in_px_of_the_picture() {
        let found = elements(DRAWING, 48.0).unwrap();
        let triangle = [[4.0, 8.0], [20.0, 8.0], [20.0, 20.0], [4.0, 8.0]];
        assert_eq!(found[0].lines, [triangle.map(|[x, y]| Point::new(x, y))]);
        assert_eq!((found[0].points, found[2].points), (3, 3));
        let curve = &found[2].lines[0];
        assert_eq!(curve.len(), 25);
        assert_eq!(
            (curve[0], curve[24]),
            (Point::new(4.0, 4.0), Point::new(12.0, 12.0))
        );
        assert_eq!(found[2].nodes, [curve[0], curve[24]]);
        assert!((curve[12] - Point::new(10.0, 6.0)).hypot() < 1e-5);
    }

    #[test]
    fn a_filled_element_has_neither_width_nor_colour_of_a_stroke() {
        let found = elements(DRAWING, 48.0).unwrap();
        let looks = found.iter().map(|e| (e.width_px, e.color, e.filled));
        let looks: Vec<_> = looks.collect();
        let expected = [
            (Some(2.0), Some([255, 0, 0]), false),
            (None, None, true),
            (Some(6.0), Some([0, 0, 255]), false),
        ];
        assert_eq!(looks, expected);
    }
}
