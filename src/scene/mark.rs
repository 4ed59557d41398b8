//! Marks: what a scene is made of.

use kurbo::Line;

use super::{Cap, Path, Rgb, Shade, Shape, Stroke};
use crate::math::Point;

/// One element of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A path drawn with a pen.
    Stroke(Stroke),
    /// Filled rings.
    Area(Area),
}

/// The kinds of marks that a drawing may have.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Marks {
    /// Areas for what is filled, strokes for lines and for the rest. With --pens or --bytes, strokes
    #[default]
    Auto,
    /// Strokes alone, for plotters and embroidery
    Strokes,
    /// Areas alone, for cutters
    Areas,
}

/// Closed paths, filled where they wind around a point (SVG's nonzero rule), in one colour or a gradient.
#[derive(Debug, Clone, PartialEq)]
pub struct Area {
    /// The outlines, px: at least one, each closed, on pixel centres at +0.5.
    pub rings: Vec<Path>,
    /// sRGB-encoded colour, 0..1; of an area with a shade the mean of that.
    pub color: Rgb,
    /// 0 (invisible) to 1 (opaque).
    pub opacity: f32,
    /// The gradient that it is filled with instead of its colour.
    pub shade: Option<Shade>,
    /// Standard deviation of its Gaussian blur, px. Areas of a scene's ground alone are blurred.
    pub blur: f32,
}

impl Area {
    /// An area of one colour, with sharp edges.
    pub fn plain(rings: Vec<Path>, color: Rgb, opacity: f32) -> Self {
        Self {
            rings,
            color,
            opacity,
            shade: None,
            blur: 0.0,
        }
    }

    /// Colour and opacity at a place.
    pub fn ink(&self, at: Point) -> (Rgb, f32) {
        let shade = self.shade.as_ref().map(|shade| shade.at(at));
        let (color, opacity) = shade.unwrap_or((self.color, 1.0));
        (color, self.opacity * opacity)
    }
}

impl Mark {
    /// sRGB-encoded colour, 0..1.
    pub fn color(&self) -> Rgb {
        match self {
            Self::Stroke(stroke) => stroke.color,
            Self::Area(area) => area.color,
        }
    }

    /// 0 (invisible) to 1 (opaque).
    pub fn opacity(&self) -> f32 {
        match self {
            Self::Stroke(stroke) => stroke.opacity,
            Self::Area(area) => area.opacity,
        }
    }

    /// Colour and opacity at a place.
    pub fn ink(&self, at: Point) -> (Rgb, f32) {
        match self {
            Self::Stroke(stroke) => (stroke.color, stroke.opacity),
            Self::Area(area) => area.ink(at),
        }
    }

    /// The centre line of a stroke, or the rings of an area.
    pub fn paths(&self) -> &[Path] {
        match self {
            Self::Stroke(stroke) => std::slice::from_ref(&stroke.path),
            Self::Area(area) => &area.rings,
        }
    }

    /// The paths as lines that are at most `tolerance` px away from them. A dot is a line without length.
    pub(crate) fn lines(&self, tolerance: f64) -> Vec<Line> {
        let paths = self.paths().iter();
        paths.flat_map(|path| path.lines(tolerance)).collect()
    }

    /// Half the width of a stroke, px, the largest one if it varies; 0 for an area.
    pub fn radius(&self) -> f64 {
        match self {
            Self::Stroke(stroke) => stroke.radius,
            Self::Area(_) => 0.0,
        }
    }

    /// Number of points of all paths together.
    pub fn points(&self) -> usize {
        self.paths().iter().map(|path| path.points().len()).sum()
    }

    /// The circle, ellipse or rectangle that its only path is.
    pub fn shape(&self) -> Option<Shape> {
        match self.paths() {
            [path] => path.shape(),
            _ => None,
        }
    }

    /// True if it is an area.
    pub fn is_area(&self) -> bool {
        self.as_area().is_some()
    }

    /// True if it is a stroke with square ends and mitred corners.
    pub fn is_butt(&self) -> bool {
        self.as_stroke()
            .is_some_and(|stroke| stroke.cap == Cap::Butt)
    }

    /// True if it is a stroke whose width varies.
    pub fn is_varying(&self) -> bool {
        self.as_stroke().is_some_and(Stroke::is_varying)
    }

    /// The gradient of an area that has one.
    pub fn shade(&self) -> Option<&Shade> {
        self.as_area()?.shade.as_ref()
    }

    /// The stroke, unless the mark is an area.
    pub fn as_stroke(&self) -> Option<&Stroke> {
        match self {
            Self::Stroke(stroke) => Some(stroke),
            Self::Area(_) => None,
        }
    }

    /// The area, unless the mark is a stroke.
    pub fn as_area(&self) -> Option<&Area> {
        match self {
            Self::Stroke(_) => None,
            Self::Area(area) => Some(area),
        }
    }

    /// This mark with `f` applied to every point. A gradient stays where it is.
    #[must_use]
    pub fn map(self, f: impl Fn(Point) -> Point) -> Self {
        match self {
            Self::Stroke(stroke) => Self::Stroke(Stroke {
                path: stroke.path.map(f),
                ..stroke
            }),
            Self::Area(area) => Self::Area(Area {
                rings: area.rings.into_iter().map(|ring| ring.map(&f)).collect(),
                ..area
            }),
        }
    }

    /// True if every number of the mark is finite.
    pub fn is_finite(&self) -> bool {
        let mut points = self.paths().iter().flat_map(Path::points);
        let [red, green, blue] = self.color();
        points.all(|p| p.at.is_finite())
            && self.radius().is_finite()
            && self
                .as_stroke()
                .is_none_or(|stroke| stroke.radii.iter().all(|r| r.is_finite()))
            && [red, green, blue, self.opacity()]
                .iter()
                .all(|v| v.is_finite())
    }
}

/// Numbers of areas and strokes in words: "12 areas, 30 strokes". Areas go without saying where there are none.
pub(crate) fn counted(areas: usize, strokes: usize) -> String {
    let count = |count: usize, name: &str| match count {
        1 => format!("1 {name}"),
        count => format!("{count} {name}s"),
    };
    match (areas, strokes) {
        (0, strokes) => count(strokes, "stroke"),
        (areas, 0) => count(areas, "area"),
        (areas, strokes) => format!("{}, {}", count(areas, "area"), count(strokes, "stroke")),
    }
}

impl From<Stroke> for Mark {
    fn from(stroke: Stroke) -> Self {
        Self::Stroke(stroke)
    }
}

impl From<Area> for Mark {
    fn from(area: Area) -> Self {
        Self::Area(area)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Axis, PathPoint, Scene, ShadeStop, Stage};

    #[test]
    fn points_are_held_on_the_page_and_a_gradient_stays() {
        let stop = |offset| ShadeStop {
            offset,
            color: [offset; 3],
            opacity: 1.0,
        };
        // Its axis ends beyond the page, like the axis of a shape that the border cuts off.
        let axis = Axis::Linear {
            from: (-5.0, 2.0).into(),
            to: (30.0, 2.0).into(),
        };
        let shade = Shade::new(axis, &[stop(0.0), stop(1.0)]).unwrap();
        let corners = [(-3.0, 1.0), (25.0, 1.0), (8.0, 7.0)];
        let points = corners.map(|at: (f64, f64)| PathPoint::on(at.into()));
        let area = Area {
            shade: Some(shade.clone()),
            ..Area::plain(vec![Path::new(points.into(), true).unwrap()], [0.5; 3], 1.0)
        };
        let scene = Scene {
            stages: vec![Stage::from_iter([area])],
            ..Scene::empty(20, 10, None)
        };
        let confined = scene.confined();
        let area = confined.areas().next().unwrap();
        let xs: Vec<f64> = area.rings[0].points().iter().map(|p| p.at.x).collect();
        assert_eq!(xs, [0.0, 20.0, 8.0]);
        assert_eq!(area.shade, Some(shade));
    }
}
