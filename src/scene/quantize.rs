//! Rounds marks to what the SVG can hold: a fixed number of decimals, and 8-bit colour and opacity.
//!
//! A rounded mark is a mark like any other, whose numbers are exactly those of the file, so that reading a written file
//! gives the quantised scene to the bit.

use serde::{Deserialize, Serialize};

use kurbo::Rect;

use super::grid::{Grid, MAX_COORDINATE, MAX_PRECISION, MIN_WIDTH, color, quantum};
use super::path::bounds;
use super::{Area, Cap, Mark, Path, PathPoint, Rgb, Scene, Shade, Shape, Stroke};
use crate::math::Point;

/// A scene rounded to the numbers that its SVG holds, with counts of the marks that were dropped.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantized {
    /// The rounded scene. None of its stages is empty.
    pub scene: Scene,
    /// For each of its stages, the index in the original scene.
    pub origins: Vec<usize>,
    /// Counts of marks and points that are not written.
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
    /// The scene rounded to what its SVG with `precision` decimals (at most [`MAX_PRECISION`]) holds.
    ///
    /// Coordinates and widths are rounded, widths kept at [`MIN_WIDTH`] or more; colours and
    /// opacities become multiples of 1/255; a path shorter than the precision becomes a dot; a closed path that its pen
    /// fills becomes an open one that ends where it starts; rings without an inside go; a stroke with square ends that SVG
    /// would draw otherwise becomes an area; one whose width varies has a radius of 0 at its ends alone, and is like any other once all
    /// of its widths are equal; cubic curves of strokes that bend more tightly than
    /// their pen become quadratic ones. Off-points are
    /// rounded so that the file also holds the on-points that they imply.
    /// [`Dropped`] counts what is left out. Stages without marks are left out as well.
    pub fn quantized(&self, precision: u8) -> Quantized {
        let mut quantized = Quantized {
            scene: Self {
                background: self.background.map(quantized_color),
                ground: self.ground.clone(),
                stages: Vec::new(),
                ..*self
            },
            origins: Vec::new(),
            dropped: Dropped::default(),
        };
        for (origin, stage) in self.stages.iter().enumerate() {
            let dropped = &mut quantized.dropped;
            let rounded = stage.marks.iter().filter_map(|mark| {
                let rounded = self.rounded(mark, precision);
                let rounded = rounded.map_err(|reason| dropped.count(reason)).ok()?;
                // A curve that turns back sharply gets points, as it is written as two lines.
                if rounded.shape().is_none() && !mark.is_butt() {
                    dropped.points += mark.points().saturating_sub(rounded.points());
                }
                Some(rounded)
            });
            let marks: Vec<Mark> = rounded.collect();
            if !marks.is_empty() {
                quantized.scene.stages.push(marks.into_iter().collect());
                quantized.origins.push(origin);
            }
        }
        quantized
    }

    /// The mark as the file of this scene with `precision` decimals has it; `None` if it is not written.
    pub(crate) fn quantized_mark(&self, mark: &Mark, precision: u8) -> Option<Mark> {
        self.rounded(mark, precision).ok()
    }

    fn rounded(&self, mark: &Mark, precision: u8) -> Result<Mark, Unwritable> {
        let rounded = rounded(mark, precision)?;
        let page = Rect::new(0.0, 0.0, self.width.into(), self.height.into());
        // The rounded mark decides, since that's what a viewer draws.
        let is_on_page = rounded.extent().intersect(page).area() > 0.0;
        is_on_page.then_some(rounded).ok_or(Unwritable::OffPage)
    }
}

impl Mark {
    /// Farthest that it reaches beyond its paths, px: the corners of a band reach farther than its sides.
    pub(crate) fn reach(&self) -> f64 {
        let radii = if self.is_butt() { 4.0 } else { 1.0 };
        radii * self.radius()
    }

    /// A box around all that it may cover, px.
    pub(crate) fn extent(&self) -> Rect {
        let reach = self.reach();
        self.bounds().inflate(reach, reach)
    }

    /// The box around its paths, px: that of points that have them in their hull.
    pub(crate) fn bounds(&self) -> Rect {
        bounds(self.paths().iter().flat_map(Path::hull))
    }
}

/// The mark as a file with `precision` decimals has it, whatever its place; `None` if it is not written.
pub(crate) fn quantized_anywhere(mark: &Mark, precision: u8) -> Option<Mark> {
    rounded(mark, precision).ok()
}

/// The mark rounded to `precision` decimals, or the reason why it would be invisible.
fn rounded(mark: &Mark, precision: u8) -> Result<Mark, Unwritable> {
    // Refuse first: rounding needs finite numbers within the range where decimals are exact.
    check(mark)?;
    let grid = Grid::new(precision);
    if let Mark::Stroke(stroke) = mark
        && stroke.is_varying()
    {
        return sweep(stroke, &grid).map(Mark::from);
    }
    // A stroke with square ends stays one if SVG draws it alike; otherwise its outline is written as an area.
    if let Some(band) = mark.as_stroke().and_then(|stroke| band(stroke, &grid)) {
        return Ok(band.into());
    }
    match mark.clone().filled() {
        Mark::Stroke(stroke) => Ok(round(&stroke, &grid).into()),
        // The outline of a wide stroke may be out of range where its line is not.
        Mark::Area(filled) if !mark.is_area() && is_far(&filled.rings) => Err(Unwritable::OffPage),
        Mark::Area(filled) => area(&filled, &grid).map(Mark::from),
    }
}

/// A rounded stroke with round ends.
fn round(stroke: &Stroke, grid: &Grid) -> Stroke {
    // SVG holds widths, so the width is rounded, and the radius is half of it. The least width is rounded up, onto the grid.
    let width = grid.round(2.0 * stroke.radius).max(grid.above(MIN_WIDTH));
    let rounded = stroke.path.rounded(grid);
    let rounded = rounded.with_quads_for_bends(0.5 * width, grid);
    let shaped = shaped(&stroke.path, rounded.clone(), grid);
    // A loop that its pen fills is written open, so it is no shape any more.
    let path = match shaped.clone().opened_if_filled(width).is_closed() {
        true => shaped,
        false => rounded.opened_if_filled(width),
    };
    Stroke {
        path,
        radius: 0.5 * width,
        radii: Vec::new(),
        cap: Cap::Round,
        color: quantized_color(stroke.color),
        opacity: quantized_opacity(stroke.opacity),
    }
}

/// A rounded stroke whose width varies, or of one width if it has become that.
fn sweep(stroke: &Stroke, grid: &Grid) -> Result<Stroke, Unwritable> {
    let (path, radii) = stroke.rounded_line(grid);
    let last = radii.len().wrapping_sub(1);
    let width = |(i, radius): (usize, f64)| {
        // A line may have a tip, but no gap.
        let is_end = !path.is_closed() && [0, last].contains(&i);
        let least = if is_end { 0.0 } else { grid.step() };
        grid.round(2.0 * radius).max(least)
    };
    let widths: Vec<f64> = radii.into_iter().enumerate().map(width).collect();
    let most = widths.iter().copied().fold(0.0, f64::max);
    if most == 0.0 {
        return Err(Unwritable::Invisible);
    }
    let plain = Stroke {
        path,
        radius: 0.5 * most,
        radii: Vec::new(),
        color: quantized_color(stroke.color),
        opacity: quantized_opacity(stroke.opacity),
        ..*stroke
    };
    let is_even = widths.iter().all(|width| *width == most) && most >= MIN_WIDTH;
    if is_even || plain.path.points().len() == 1 {
        return Ok(round(&plain, grid));
    }
    let rounded = Stroke {
        radii: widths.iter().map(|width| 0.5 * width).collect(),
        ..plain
    };
    match &rounded.outline(grid)[..] {
        [] => Err(Unwritable::Invisible),
        outline if is_far(outline) => Err(Unwritable::OffPage),
        _ => Ok(rounded),
    }
}

impl Stroke {
    /// The rings that a file with `precision` decimals has for a rounded stroke whose width varies; none for any other.
    pub(crate) fn written_outline(&self, precision: u8) -> Vec<Path> {
        match self.is_varying() {
            true => self.outline(&Grid::new(precision)),
            false => Vec::new(),
        }
    }

    /// True if a file has these rings for it with any number of decimals.
    pub(crate) fn has_outline(&self, rings: &[Path]) -> bool {
        let outline = self.swept();
        (0..=MAX_PRECISION).any(|precision| on_grid(&outline, &Grid::new(precision)) == rings)
    }

    fn outline(&self, grid: &Grid) -> Vec<Path> {
        on_grid(&self.swept(), grid)
    }

    /// The rounded path of a stroke whose width varies, and the radius at each of its vertices.
    fn rounded_line(&self, grid: &Grid) -> (Path, Vec<f64>) {
        let is_on = |p: &&PathPoint| p.is_on();
        let mut points = self.path.points().to_vec();
        let first = points.iter().position(PathPoint::is_on).unwrap_or(0);
        // 1. Round. A vertex halfway between two control points would be implied and lose its radius: it moves by a step.
        let (path, vertices) = loop {
            let given = Path::of_points(points.clone(), self.path.is_closed());
            let path = given.rounded(grid);
            let is_kept = |at: Point| path.points().iter().filter(is_on).any(|p| p.at == at);
            let is_lost = |p: &PathPoint| p.is_on() && !is_kept(grid.point(p.at));
            let lost = points.iter().position(is_lost);
            match lost {
                Some(i) => points[i].at.x = grid.point(points[i].at).x + grid.step(),
                None => {
                    points.rotate_left(first);
                    let vertices = points.iter().filter(is_on).map(|p| grid.point(p.at));
                    break (path, vertices.collect::<Vec<Point>>());
                }
            }
        };
        // 2. Each vertex of the rounded path has the largest radius of those that it was, or else one between its neighbours'.
        let mut given = vertices
            .into_iter()
            .zip(self.radii.iter().copied())
            .peekable();
        let mut radii: Vec<Option<f64>> = Vec::new();
        let places: Vec<Point> = path.points().iter().filter(is_on).map(|p| p.at).collect();
        for (i, at) in places.iter().enumerate() {
            let mut own = None;
            while let Some((_, radius)) = given.next_if(|(place, _)| place == at) {
                own = Some(radius.max(own.unwrap_or(0.0)));
            }
            // Those that are not in the path any more are in one place with another one.
            let is_in = |place: Point| places[i + 1..].contains(&place);
            if own.is_some() {
                while given.next_if(|(place, _)| !is_in(*place)).is_some() {}
            }
            radii.push(own);
        }
        (path, between(&places, &radii))
    }
}

/// The radii of places, where those that have none get one between those before and after them, by the lengths to these.
fn between(places: &[Point], radii: &[Option<f64>]) -> Vec<f64> {
    let count = radii.len();
    let first = radii.iter().flatten().next().copied().unwrap_or(0.0);
    let radius = |i: usize| {
        let before = (0..=i).rev().find(|&k| radii[k].is_some());
        let after = (i..count).find(|&k| radii[k].is_some());
        let length = |from: usize, to: usize| {
            let steps = (from..to).map(|k| (places[(k + 1) % count] - places[k]).hypot2().sqrt());
            steps.sum::<f64>()
        };
        // A closed path comes back to its first vertex.
        let (from, to) = (before.unwrap_or(0), after.unwrap_or(count));
        let [start, end] = [before, after].map(|k| k.and_then(|k| radii[k]).unwrap_or(first));
        let share = length(from, i) / length(from, to).max(f64::MIN_POSITIVE);
        (1.0 - share) * start + share * end
    };
    (0..count).map(radius).collect()
}

/// The rounded rings of an area that have an inside.
fn on_grid(rings: &[Path], grid: &Grid) -> Vec<Path> {
    let rounded = rings.iter().map(|ring| ring.rounded(grid));
    rounded.filter(Path::encloses).collect()
}

/// A rounded stroke with square ends, unless SVG would draw it otherwise.
fn band(stroke: &Stroke, grid: &Grid) -> Option<Stroke> {
    let rounded = Stroke {
        path: stroke.path.rounded(grid),
        radius: 0.5 * grid.round(2.0 * stroke.radius),
        radii: Vec::new(),
        cap: stroke.cap,
        color: quantized_color(stroke.color),
        opacity: quantized_opacity(stroke.opacity),
    };
    rounded.band()?.is_sound().then_some(rounded)
}

/// A rounded area with its rings that have an inside.
pub(super) fn area(area: &Area, grid: &Grid) -> Result<Area, Unwritable> {
    // Elements such as `<circle>` have one outline: a ring of several can't be one.
    let is_alone = area.rings.len() == 1;
    let rings = area.rings.iter().map(|ring| {
        let rounded = ring.rounded(grid);
        if is_alone {
            shaped(ring, rounded, grid)
        } else {
            rounded
        }
    });
    // Rounding may have flattened a ring into a line, which fills nothing.
    let rings: Vec<Path> = rings
        .filter(|ring| ring.shape().is_some() || ring.encloses())
        .collect();
    if rings.is_empty() {
        return Err(Unwritable::Invisible);
    }
    let color_of = |shade: &Shade| color(shade.mean());
    let shade = area.shade.clone();
    Ok(Area {
        rings: match &rings[..] {
            // Of several rings one may be left.
            [ring] => vec![shaped(ring, ring.clone(), grid)],
            _ => rings,
        },
        color: shade
            .as_ref()
            .map_or_else(|| quantized_color(area.color), color_of),
        opacity: quantized_opacity(area.opacity),
        shade,
        blur: 0.0,
    })
}

/// The path of the element of a shape that a path is, or became as it was rounded; otherwise the rounded path.
fn shaped(path: &Path, rounded: Path, grid: &Grid) -> Path {
    // Round the numbers of the shape, not its points: rounded points of a circle are no circle any more.
    let shape = path.shape().and_then(|shape| shape.rounded(grid));
    let shape = shape.or_else(|| rounded.rectangle());
    shape.map_or(rounded, Shape::path)
}

/// Refuses marks that are invisible at any precision.
fn check(mark: &Mark) -> Result<(), Unwritable> {
    let radius = mark.radius();
    let is_thin = !mark.is_area() && radius <= 0.0;
    // NaN first: every comparison below would be false for it.
    if !mark.is_finite() {
        Err(Unwritable::NonFinite)
    } else if is_thin || quantum(mark.opacity()) == 0 {
        Err(Unwritable::Invisible)
    } else if radius > MAX_COORDINATE || is_far(mark.paths()) {
        Err(Unwritable::OffPage)
    } else {
        Ok(())
    }
}

/// True if a number of the paths is beyond the limit of the file.
fn is_far(paths: &[Path]) -> bool {
    let far = |p: Point| p.x.abs() > MAX_COORDINATE || p.y.abs() > MAX_COORDINATE;
    paths.iter().flat_map(Path::hull).any(far)
}

fn quantized_color(rgb: Rgb) -> Rgb {
    color(rgb.map(quantum))
}

fn quantized_opacity(opacity: f32) -> f32 {
    f32::from(quantum(opacity)) / 255.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Stage;

    fn stroke(path: Path) -> Stroke {
        Stroke {
            path,
            radius: 2.0,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [0.2, 0.5, 1.0],
            opacity: 1.0,
        }
    }

    fn capsule([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> Stroke {
        stroke(Path::line(Point::new(ax, ay), Point::new(bx, by)))
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
            capsule([f64::NAN, 1.0], [5.0, 3.0]),
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
    fn every_vertex_of_a_line_keeps_its_radius() {
        let on = |x: f64, y: f64| PathPoint::on((x, y).into());
        let off = |x: f64, y: f64| PathPoint::off((x, y).into());
        let varying = |points: &[PathPoint], is_closed: bool, radii: &[f64]| {
            let path = Path::new(points.to_vec(), is_closed).unwrap();
            let stroke = Stroke::varying(path, radii.to_vec(), [0.0; 3], 1.0).unwrap();
            quantized(stroke, 1).unwrap()
        };
        // A vertex halfway between control points would be implied.
        let points = [
            on(1.0, 1.0),
            off(3.0, 1.0),
            on(5.0, 3.0),
            off(7.0, 5.0),
            on(9.0, 5.0),
        ];
        let line = varying(&points, false, &[0.02, 1.33, 0.0]);
        assert_eq!(line.radii, [0.0, 1.35, 0.0]);
        assert_eq!(line.path.points()[2].at, Point::new(5.1, 3.0));
        // Two vertices that become one have the larger radius, and inside a line none has no width.
        let points = [
            on(1.0, 1.0),
            on(5.0, 3.01),
            on(5.01, 3.0),
            on(7.0, 4.0),
            on(9.0, 5.5),
        ];
        let line = varying(&points, false, &[1.0, 1.5, 2.0, 0.0, 1.0]);
        assert_eq!(line.radii, [1.0, 2.0, 0.05, 1.0]);
        // Equal widths are one.
        assert!(!varying(&points[..2], false, &[1.0, 1.01]).is_varying());
        // Half of a circle is written as two arcs, and the radius runs on.
        let points = [
            on(5.0, 5.0),
            PathPoint::arc((8.02, 8.01).into()),
            on(11.03, 5.0),
        ];
        let line = varying(&points, false, &[1.0, 2.0]);
        let ends = [line.radii[0], line.radii[line.radii.len() - 1]];
        assert_eq!(ends, [1.0, 2.0]);
        assert!(line.radii.is_sorted(), "{line:?}");
        // A closed line has no ends, so that no radius is 0.
        let points = [on(2.0, 2.0), on(9.0, 2.0), on(9.0, 8.0)];
        assert_eq!(
            varying(&points, true, &[0.0, 1.0, 2.0]).radii,
            [0.05, 1.0, 2.0]
        );
    }

    #[test]
    fn what_reaches_into_the_page_is_kept() {
        assert!(quantized(capsule([-9.0, 5.0], [-1.9, 5.0]), 2).is_some());
        assert!(quantized(capsule([-100.0, 5.0], [100.0, 5.0]), 2).is_some());
    }
}
