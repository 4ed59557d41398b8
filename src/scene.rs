//! The drawing: a [`Scene`] of [`Mark`]s, strokes and areas, back to front, grouped in [`Stage`]s.
//!
//! Coordinates are in px, with pixel centres at +0.5. Colours are sRGB-encoded, 0..1, and are composited in
//! that encoding, as SVG renderers do.

mod arc;
mod band;
mod canonical;
mod colors;
mod filled_loop;
mod grid;
mod ground;
mod likeness;
mod mark;
mod overlap;
mod path;
mod piece;
mod polyline;
mod quantize;
mod shade;
mod shape;
mod sweep;

pub use arc::Arc;
pub(crate) use arc::ArcNumbers;
pub use band::Band;
pub(crate) use colors::{distinct_colors, linear_light};
pub use grid::{MAX_PRECISION, MIN_WIDTH};
pub(crate) use grid::{UNITS_PER_PX, color, px, quantum, units};
pub use ground::Blurs;
pub(crate) use mark::counted;
pub use mark::{Area, Mark, Marks};
pub(crate) use overlap::{Bundles, Precedence};
pub(crate) use path::is_inside;
pub use path::{MAX_POINTS, Path};
pub use piece::{PathPiece, PathPoint, PointKind};
pub(crate) use polyline::{polyline, through};
pub(crate) use quantize::quantized_anywhere;
pub use quantize::{Dropped, Quantized};
pub use shade::{Axis, MAX_STOPS, Shade, ShadeStop};
pub use shape::{Shape, ShapeKind};

use crate::math::Point;

/// An sRGB-encoded colour, 0..1 per channel.
pub type Rgb = [f32; 3];

/// The ends and corners of a stroke.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Cap {
    /// Round ends and corners: the path is swept by a disc.
    #[default]
    Round,
    /// Square ends and mitred corners, as SVG's `stroke-linecap="butt"` and `stroke-linejoin="miter"` draw them.
    Butt,
}

/// One stroke: a path drawn with a pen, in one colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// The centre line, px.
    pub path: Path,
    /// Half the stroke width, px; the largest of the `radii` if there are any.
    pub radius: f64,
    /// Half the width at each vertex of the path, px; empty for a stroke of one width ([`Stroke::varying`]).
    pub radii: Vec<f64>,
    /// Its ends and corners.
    pub cap: Cap,
    /// sRGB-encoded colour, 0..1.
    pub color: Rgb,
    /// 0 (invisible) to 1 (opaque).
    pub opacity: f32,
}

/// Marks that were added together: a layer of the SVG.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stage {
    /// Back to front.
    pub marks: Vec<Mark>,
}

impl<M: Into<Mark>> FromIterator<M> for Stage {
    fn from_iter<I: IntoIterator<Item = M>>(marks: I) -> Self {
        Self {
            marks: marks.into_iter().map(Into::into).collect(),
        }
    }
}

/// A drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Width in px, at least 1.
    pub width: u32,
    /// Height in px, at least 1.
    pub height: u32,
    /// Width and height at which the drawing is shown, px, if it is of a reduced picture.
    pub page: Option<[u32; 2]>,
    /// The colour behind all marks; `None` if the drawing is transparent.
    pub background: Option<Rgb>,
    /// Areas on the background, behind all marks, which no fit changes: the gradient of the page if it has one ([`Area::page`]),
    /// and then, back to front, soft shadows and glows ([`Area::blurred`]) and the things that they are seen on.
    pub ground: Vec<Area>,
    /// Back to front.
    pub stages: Vec<Stage>,
}

impl Scene {
    /// A scene without marks.
    pub fn empty(width: u32, height: u32, background: Option<Rgb>) -> Self {
        Self {
            width,
            height,
            page: None,
            background,
            ground: Vec::new(),
            stages: Vec::new(),
        }
    }

    /// The scene with all points on the page: those beyond its border are on the border. Curves stay within their points.
    #[must_use]
    pub fn confined(self) -> Self {
        let [width, height] = [self.width, self.height].map(f64::from);
        let held = |p: Point| Point::new(p.x.clamp(0.0, width), p.y.clamp(0.0, height));
        self.with_marks(|mark| mark.map(held))
    }

    /// The scene with an area in the place of each stroke with square ends or whose width varies, which looks the same.
    #[must_use]
    pub fn filled(self) -> Self {
        self.with_marks(Mark::filled)
    }

    fn with_marks(mut self, f: impl Fn(Mark) -> Mark) -> Self {
        for stage in &mut self.stages {
            let marks = std::mem::take(&mut stage.marks).into_iter();
            stage.marks = marks.map(&f).collect();
        }
        self
    }

    /// All marks, back to front.
    pub fn marks(&self) -> impl Iterator<Item = &Mark> {
        self.stages.iter().flat_map(|stage| &stage.marks)
    }

    /// The marks that are strokes, back to front.
    pub fn strokes(&self) -> impl Iterator<Item = &Stroke> {
        self.marks().filter_map(Mark::as_stroke)
    }

    /// The marks that are areas, back to front.
    pub fn areas(&self) -> impl Iterator<Item = &Area> {
        self.marks().filter_map(Mark::as_area)
    }

    /// The numbers of areas and of strokes in words: "12 areas, 30 strokes".
    pub fn counted(&self) -> String {
        counted(self.areas().count(), self.strokes().count())
    }

    /// Number of marks.
    pub fn len(&self) -> usize {
        self.stages.iter().map(|stage| stage.marks.len()).sum()
    }

    /// Number of points of all marks together.
    pub fn points(&self) -> usize {
        self.marks().map(Mark::points).sum()
    }

    /// True if the scene has no mark.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
