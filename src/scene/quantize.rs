//! Rounds marks to what the SVG can hold: a fixed number of decimals, and 8-bit colour and opacity.
//!
//! [`Written`] is a mark in exactly these integers. Quantising, writing and reading all go through it, so
//! reading a written file gives the quantised scene to the bit.

use serde::{Deserialize, Serialize};

use super::grid::{Grid, MIN_WIDTH, UNITS_PER_PX, color, quantum};
use super::written_path::{WrittenPath, WrittenPoint, spacing, step};
use super::written_shape::WrittenShape;
use super::{Area, Band, Mark, Path, PathPoint, Rgb, Scene, Shade, Stage, Stroke};

/// Largest absolute value of a coordinate, px. All decimals up to here are exact.
const MAX_COORDINATE: f32 = 1e9;

/// A scene rounded to what its SVG holds, and what was dropped.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantized {
    /// The rounded scene. None of its stages is empty.
    pub scene: Scene,
    /// For each of its stages, the index in the original scene.
    pub origins: Vec<usize>,
    /// Counts of what is not written.
    pub dropped: Dropped,
}

/// Number of marks that are not written, by reason, and of points.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Dropped {
    /// Marks with NaN or infinite parameters.
    pub non_finite: usize,
    /// Strokes without width, areas without an inside, and marks with an opacity that rounds to 0, or that a fit found to
    /// change no pixel.
    pub invisible: usize,
    /// Marks with a bounding box off the page, or with a coordinate beyond the limit of the file.
    pub off_page: usize,
    /// Points of marks that are written: those that coincide with their neighbours once they are rounded, or that
    /// others imply.
    #[serde(default)]
    pub points: usize,
}

impl Dropped {
    /// The sum of all marks.
    pub fn total(self) -> usize {
        self.non_finite + self.invisible + self.off_page
    }

    fn count(&mut self, reason: Unwritable) {
        *match reason {
            Unwritable::NonFinite => &mut self.non_finite,
            Unwritable::Invisible => &mut self.invisible,
            Unwritable::OffPage => &mut self.off_page,
        } += 1;
    }
}

/// Why a mark cannot be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unwritable {
    NonFinite,
    Invisible,
    OffPage,
}

impl Scene {
    /// The scene rounded to what its SVG with `precision` decimals (at most [`MAX_PRECISION`](super::MAX_PRECISION)) holds.
    ///
    /// Coordinates and widths are rounded, widths kept at [`MIN_WIDTH`] or more; colours and
    /// opacities become multiples of 1/255; a path shorter than the precision becomes a dot; a closed path that its pen
    /// fills becomes an open one that ends where it starts; rings without an inside go. Off-points are
    /// rounded so that the file also holds the on-points that they imply.
    /// [`Dropped`] counts what is left out. Stages without marks are left out as well.
    pub fn quantized(&self, precision: u8) -> Quantized {
        let mut quantized = Quantized {
            scene: Self {
                background: self.background.map(quantized_color),
                shade: self.shade.clone(),
                shadows: self.shadows.clone(),
                stages: Vec::new(),
                ..*self
            },
            origins: Vec::new(),
            dropped: Dropped::default(),
        };
        for (origin, stage) in self.stages.iter().enumerate() {
            let marks = self.written(stage, precision, &mut quantized.dropped);
            if !marks.is_empty() {
                let stage = marks.iter().map(Written::mark).collect();
                quantized.scene.stages.push(stage);
                quantized.origins.push(origin);
            }
        }
        quantized
    }

    /// The mark as the file of this scene with `precision` decimals has it; `None` if it is not written.
    pub(crate) fn quantized_mark(&self, mark: &Mark, precision: u8) -> Option<Mark> {
        let written = Written::new(mark, self, precision).ok()?;
        Some(written.mark())
    }

    /// The marks of `stage` that can be written; the others are counted.
    fn written(&self, stage: &Stage, precision: u8, dropped: &mut Dropped) -> Vec<Written> {
        let written = |mark: &Mark| {
            let written = Written::new(mark, self, precision);
            let written = written.map_err(|reason| dropped.count(reason)).ok()?;
            // A curve that turns back sharply gets points, as it is written as two lines.
            let (before, after) = (mark.points(), written.points().count());
            if written.shape.is_none() && !written.is_band {
                dropped.points += before.saturating_sub(after);
            }
            Some(written)
        };
        stage.marks.iter().filter_map(written).collect()
    }
}

/// A mark as the integers of its SVG element.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Written {
    /// The centre line of a stroke or band, or the rings of an area; at least one.
    pub(crate) paths: Vec<WrittenPath>,
    /// The shape of the only path, if it is one.
    pub(crate) shape: Option<WrittenShape>,
    /// Width of a stroke in units of 1/[`UNITS_PER_PX`] px; 0 for an area that is no band.
    pub(crate) width: i64,
    /// True for a band, which is written as a stroke with square ends.
    pub(crate) is_band: bool,
    /// 8-bit red, green and blue.
    pub(crate) color: [u8; 3],
    /// Opacity in 1/255, never 0.
    pub(crate) opacity: u8,
    /// The gradient of an area that has one; its colour then is the mean of that.
    pub(crate) shade: Option<WrittenShade>,
}

/// A gradient of an area, and the name that it has in its file.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct WrittenShade {
    pub(crate) shade: Shade,
    /// The numbers of its layer and of the shade in it, from 1; 0 if it has no place in a file yet.
    pub(crate) place: [usize; 2],
}

impl From<Shade> for WrittenShade {
    fn from(shade: Shade) -> Self {
        Self {
            shade,
            place: [0; 2],
        }
    }
}

impl Written {
    /// The mark rounded to `precision` decimals, or the reason why it would be invisible on the page of
    /// `scene`.
    pub(crate) fn new(mark: &Mark, scene: &Scene, precision: u8) -> Result<Self, Unwritable> {
        let written = Self::anywhere(mark, precision)?;
        if written.touches(scene.width, scene.height) {
            Ok(written)
        } else {
            Err(Unwritable::OffPage)
        }
    }

    /// The mark rounded to `precision` decimals, whatever its place.
    pub(crate) fn anywhere(mark: &Mark, precision: u8) -> Result<Self, Unwritable> {
        check(mark)?;
        let grid = Grid::new(precision);
        if let Some(band) = Self::band(mark, &grid) {
            return Ok(band);
        }
        let rounded = Self::round_or_filled(mark, precision)?;
        // An area may become a band only as it is rounded.
        let band = rounded
            .is_area()
            .then(|| Self::band(&rounded.mark(), &grid));
        Ok(band.flatten().unwrap_or(rounded))
    }

    /// The rounded mark as a stroke with round ends or an area, even if it is a band.
    pub(crate) fn round_or_filled(mark: &Mark, precision: u8) -> Result<Self, Unwritable> {
        check(mark)?;
        let grid = Grid::new(precision);
        let width = mark.as_stroke().map_or(0, |stroke| {
            let width = grid.units(2.0 * f64::from(stroke.radius));
            width.max(grid.units_above(MIN_WIDTH))
        });
        let (paths, shape) = geometry(mark, &grid, width);
        if paths.is_empty() {
            return Err(Unwritable::Invisible);
        }
        let shade = mark.shade();
        Ok(Self {
            paths,
            shape,
            width,
            is_band: false,
            color: shade.map_or_else(|| mark.color().map(quantum), Shade::mean),
            opacity: quantum(mark.opacity()),
            shade: shade.cloned().map(WrittenShade::from),
        })
    }

    /// The mark as a band, if it is one and stays that as it is rounded.
    fn band(mark: &Mark, grid: &Grid) -> Option<Self> {
        let written = |area: &Area| {
            let band = area.band()?;
            let spacing = area.rings.iter().map(spacing).fold(0.0, f32::max);
            // Points in `f32` tell a band by a few units in their last place.
            let grid = grid.coarser(step(8.0 * spacing, grid));
            Some(Self {
                paths: vec![WrittenPath::rounded(&band.line, &grid)],
                shape: None,
                width: grid.units(band.width.into()),
                is_band: true,
                color: mark.color().map(quantum),
                opacity: quantum(mark.opacity()),
                shade: None,
            })
        };
        let rounded = written(mark.as_area()?)?;
        let again = written(rounded.mark().as_area()?)?;
        (again == rounded).then_some(rounded)
    }

    /// True if the mark is an area that is no band.
    pub(crate) fn is_area(&self) -> bool {
        self.width == 0
    }

    /// True if the mark is a stroke with round ends.
    pub(crate) fn is_round(&self) -> bool {
        !self.is_area() && !self.is_band
    }

    /// The points of all paths.
    pub(crate) fn points(&self) -> impl Iterator<Item = &WrittenPoint> {
        self.paths.iter().flat_map(WrittenPath::points)
    }

    /// The segments of polylines at most `tolerance` px away from the paths.
    pub(crate) fn segments(&self, tolerance: f64) -> Vec<[[i64; 2]; 2]> {
        let paths = self.paths.iter();
        paths.flat_map(|path| path.segments(tolerance)).collect()
    }

    /// Farthest that it reaches beyond its paths, in units: the corners of a band reach farther than its sides.
    pub(crate) fn reach(&self) -> i64 {
        let halves = if self.is_band { 4 } else { 1 };
        halves * self.width / 2
    }

    /// True if the bounding box reaches into a page of this size.
    fn touches(&self, width: u32, height: u32) -> bool {
        let reach = self.reach();
        [width, height].iter().enumerate().all(|(axis, &side)| {
            let along = || self.points().map(|p| p.at[axis]);
            let far_end = along().max().unwrap_or(0) + reach;
            let near_end = along().min().unwrap_or(0) - reach;
            far_end > 0 && near_end < i64::from(side) * UNITS_PER_PX
        })
    }

    /// Half the width, px.
    fn radius(&self) -> f32 {
        (self.width as f64 / (2 * UNITS_PER_PX) as f64) as f32
    }

    /// The band of this mark's width along a line.
    fn band_along(&self, line: Path) -> Band {
        Band {
            line,
            width: 2.0 * self.radius(),
        }
    }

    /// True unless it is a band that SVG would draw otherwise than as its rings.
    pub(crate) fn is_sound(&self) -> bool {
        !self.is_band
            || self
                .paths
                .iter()
                .all(|path| self.band_along(path.path()).is_sound())
    }

    /// The rounded mark.
    pub(crate) fn mark(&self) -> Mark {
        let (color, opacity) = (color(self.color), f32::from(self.opacity) / 255.0);
        let mut paths: Vec<Path> = match self.shape {
            Some(shape) => vec![shape.ring()],
            None => self.paths.iter().map(WrittenPath::path).collect(),
        };
        match paths.pop() {
            Some(path) if !self.is_area() && !self.is_band => Mark::Stroke(Stroke {
                path,
                radius: self.radius(),
                color,
                opacity,
            }),
            last => Mark::Area(Area {
                rings: match last {
                    Some(line) if self.is_band => self.band_along(line).rings(),
                    last => paths.into_iter().chain(last).collect(),
                },
                color,
                opacity,
                shade: self.shade.as_ref().map(|named| named.shade.clone()),
            }),
        }
    }
}

/// The rounded paths, of an area those that have an inside; and the shape of the only one, unless a pen of this `width`
/// fills it.
fn geometry(mark: &Mark, grid: &Grid, width: i64) -> (Vec<WrittenPath>, Option<WrittenShape>) {
    let rounded = mark.paths().iter();
    let mut paths: Vec<(&Path, WrittenPath)> = rounded
        .map(|path| (path, WrittenPath::rounded(path, grid)))
        .collect();
    // The rounded points of a shape may enclose nothing where the shape, with rounded radii, does.
    let is_shape =
        |path: &Path| mark.paths().len() == 1 && WrittenShape::rounded(path, grid).is_some();
    paths.retain(|(path, rounded)| width > 0 || rounded.encloses() || is_shape(path));
    if let [(path, rounded)] = &paths[..] {
        // A path may become a rectangle only as it is rounded.
        let shape = WrittenShape::rounded(path, grid);
        let shape = shape.or_else(|| WrittenShape::rounded(&rounded.path(), grid));
        if let Some((shape, ring)) = shape.map(|shape| (shape, shape.path()))
            && (width == 0 || ring.clone().opened_if_filled(width).is_closed())
        {
            return (vec![ring], Some(shape));
        }
    }
    let paths = paths.into_iter().map(|(_, rounded)| match mark {
        Mark::Stroke(_) => rounded.opened_if_filled(width),
        Mark::Area(_) => rounded,
    });
    (paths.collect(), None)
}

/// Refuses marks that are invisible at any precision.
fn check(mark: &Mark) -> Result<(), Unwritable> {
    let far = |p: &PathPoint| p.at.x.abs() > MAX_COORDINATE || p.at.y.abs() > MAX_COORDINATE;
    let radius = mark.radius();
    let is_thin = mark.as_stroke().is_some() && radius <= 0.0;
    if !mark.is_finite() {
        Err(Unwritable::NonFinite)
    } else if is_thin || quantum(mark.opacity()) == 0 {
        Err(Unwritable::Invisible)
    } else if radius > MAX_COORDINATE || mark.paths().iter().flat_map(Path::points).any(far) {
        Err(Unwritable::OffPage)
    } else {
        Ok(())
    }
}

fn quantized_color(rgb: Rgb) -> Rgb {
    color(rgb.map(quantum))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Point;
    use crate::scene::Path;

    fn stroke(path: Path) -> Stroke {
        Stroke {
            path,
            radius: 2.0,
            color: [0.2, 0.5, 1.0],
            opacity: 1.0,
        }
    }

    fn capsule(a: [f32; 2], b: [f32; 2]) -> Stroke {
        stroke(Path::line(a.into(), b.into()))
    }

    fn scene(strokes: Vec<Stroke>) -> Scene {
        Scene {
            stages: vec![Stage::from_iter(strokes)],
            ..Scene::empty(20, 10, None)
        }
    }

    fn quantized(stroke: Stroke, precision: u8) -> Option<Stroke> {
        scene(vec![stroke])
            .quantized(precision)
            .scene
            .strokes()
            .next()
            .cloned()
    }

    #[test]
    fn coordinates_and_widths_are_rounded() {
        let mut s = capsule([1.2345, 2.0], [-0.004, 3.999]);
        s.radius = 1.114;
        let q = quantized(s, 2).unwrap();
        assert_eq!(q.path, capsule([1.23, 2.0], [0.0, 4.0]).path);
        assert_eq!(q.radius, 1.115, "the width 2.228 becomes 2.23");
    }

    #[test]
    fn no_width_is_rounded_to_a_hairline() {
        let thin = Stroke {
            radius: 0.1,
            ..capsule([1.0, 1.0], [5.0, 5.0])
        };
        let radii =
            [0, 1, 2, 3, 9].map(|precision| quantized(thin.clone(), precision).unwrap().radius);
        assert_eq!(radii, [1.0, 0.55, 0.51, 0.51, 0.51]);
    }

    #[test]
    fn a_shape_shorter_than_the_precision_becomes_a_dot() {
        let q = quantized(capsule([1.001, 2.0], [1.004, 2.003]), 2).unwrap();
        assert_eq!(q.path, Path::dot(Point::new(1.0, 2.0)));
    }

    #[test]
    fn colours_and_opacity_become_multiples_of_1_in_255() {
        let mut s = capsule([1.0, 1.0], [5.0, 5.0]);
        s.color = [0.5, -3.0, 9.0];
        s.opacity = 0.3;
        let q = quantized(s, 2).unwrap();
        assert_eq!(
            (q.color, q.opacity),
            ([128.0 / 255.0, 0.0, 1.0], 77.0 / 255.0)
        );
        let background = Scene::empty(1, 1, Some([0.5; 3]))
            .quantized(2)
            .scene
            .background;
        assert_eq!(background, Some([128.0 / 255.0; 3]));
    }

    #[test]
    fn what_cannot_be_seen_is_dropped_and_counted() {
        let seen = capsule([1.0, 1.0], [5.0, 5.0]);
        let strokes = vec![
            seen.clone(),
            Stroke {
                opacity: 0.001,
                ..seen.clone()
            },
            Stroke {
                opacity: f32::NAN,
                ..seen.clone()
            },
            Stroke {
                radius: 0.0,
                ..seen.clone()
            },
            Stroke {
                color: [f32::INFINITY; 3],
                ..seen
            },
            capsule([-9.0, 5.0], [-2.5, 5.0]),
            capsule([5.0, 12.5], [9.0, 12.5]),
            capsule([5.0, 1.0], [5.0, 3e9]),
            capsule([f32::NAN, 1.0], [5.0, 3.0]),
        ];
        let Quantized { scene, dropped, .. } = scene(strokes).quantized(2);
        let expected = Dropped {
            non_finite: 3,
            invisible: 2,
            off_page: 3,
            points: 0,
        };
        assert_eq!((scene.len(), dropped), (1, expected));
        assert_eq!(dropped.total(), 8);
    }

    #[test]
    fn stages_without_strokes_are_none() {
        let seen = capsule([1.0, 1.0], [5.0, 5.0]);
        let away = capsule([-9.0, 5.0], [-2.5, 5.0]);
        let stages = [
            vec![],
            vec![seen.clone()],
            vec![away.clone()],
            vec![away, seen.clone(), seen],
        ]
        .map(Stage::from_iter)
        .to_vec();
        let scene = Scene {
            stages,
            ..scene(vec![])
        };
        let quantized = scene.quantized(2);
        let sizes: Vec<_> = quantized
            .scene
            .stages
            .iter()
            .map(|s| s.marks.len())
            .collect();
        assert_eq!((sizes, quantized.origins), (vec![1, 2], vec![1, 3]));
    }

    #[test]
    fn what_reaches_into_the_page_is_kept() {
        assert!(quantized(capsule([-9.0, 5.0], [-1.9, 5.0]), 2).is_some());
        assert!(quantized(capsule([-100.0, 5.0], [100.0, 5.0]), 2).is_some());
    }
}
