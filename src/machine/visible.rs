//! Visible parts of marks that lie on each other: for each colour, the places where it is on top.
//!
//! One sweep over the outlines of all marks finds the pieces of the plane and, for each, how often every outline winds
//! around it. The parts of all colours are made of the same pieces, so that they share their borders.

use std::collections::BTreeMap;
use std::ops::{Add, AddAssign};
use std::panic::{self, AssertUnwindSafe};

use kurbo::{BezPath, CubicBez, PathEl, Point, Shape};
use linesweeper::topology::{Topology, WindingNumber};

use super::oklab::perceptual_distance;
use crate::error::{Error, ErrorKind, Result};
use crate::outline;
use crate::scene::{
    Area, Cap, Mark, Path, PathPiece, PathPoint, Scene, Stage, Stroke, color, distinct_colors,
    quantum,
};

/// Farthest that borders may be moved where outlines touch, px. Files hold a hundredth.
const NEAR: f64 = 1e-4;

/// Largest distance of quadratic curves from a cubic one that they stand for, px: a tenth of what files hold.
const QUADS: f64 = 1e-3;

/// Smaller pieces are traces of rounding, px².
const SMALLEST: f64 = 2e-3;

/// Colours that are nearer to each other in Oklab are hardly told apart: what CSS Color 4 takes where it maps gamuts.
const JUST_NOTICEABLE: f32 = 0.02;

/// Cut-outs, for cutters and for one sheet of foil per colour: the visible parts of the scene as one area per colour, which do not
/// overlap and share their borders. Colours that the eye hardly tells apart are one. The background is an area as well, if there is
/// one; so the scene has none.
///
/// # Errors
/// [`ErrorKind::Config`](crate::ErrorKind::Config) when a mark is translucent, and
/// [`ErrorKind::Svg`](crate::ErrorKind::Svg) when the outlines cannot be told apart.
pub fn cut_out(scene: &Scene) -> Result<Scene> {
    let scene = &scene.without_shadows();
    let mut marks = outlines(scene)?;
    unite_alike(&mut marks);
    let areas = areas_of(scene, &marks)?.into_iter();
    let areas = areas.filter(|area| !area.rings.is_empty());
    let cut = Scene {
        background: None,
        ground: Vec::new(),
        stages: areas.map(|area| Stage::from_iter([area])).collect(),
        ..*scene
    };
    Ok(cut.confined())
}

/// The visible parts of a scene's marks on its page as an area for each colour, in the order in which colours first come. Their
/// rings do not cross, and holes go the other way round. An area without rings is of a colour that is hidden. The background
/// is the lowest mark.
///
/// # Errors
/// [`ErrorKind::Config`] when a mark is translucent, since then two colours are seen at a place;
/// [`ErrorKind::Svg`] when the sweep fails.
pub(super) fn areas(scene: &Scene) -> Result<Vec<Area>> {
    areas_of(scene, &outlines(scene)?)
}

/// The visible parts of outlines with their colours, back to front.
fn areas_of(scene: &Scene, marks: &[([u8; 3], BezPath)]) -> Result<Vec<Area>> {
    let colors = distinct_colors(marks.iter().map(|(color, _)| *color));
    swept(|| seen(&page(scene), marks, &colors))
}

/// Gives marks the colour of larger ones that they are hardly told apart from.
fn unite_alike(marks: &mut [([u8; 3], BezPath)]) {
    // 1. The size of each colour.
    let colors = distinct_colors(marks.iter().map(|(color, _)| *color));
    let areas: Vec<f64> = marks.iter().map(|(_, path)| path.area().abs()).collect();
    let sized = colors.into_iter().map(|color| {
        let own = marks.iter().zip(&areas).filter(|(mark, _)| mark.0 == color);
        (own.map(|(_, area)| area).sum(), color)
    });
    let mut sized: Vec<(f64, [u8; 3])> = sized.collect();
    // 2. From large to small, those that are told apart from all larger ones.
    let is_alike = |a: [u8; 3], b: [u8; 3]| perceptual_distance(a, b) < JUST_NOTICEABLE;
    let mut kept: Vec<[u8; 3]> = Vec::new();
    while let Some(i) = (0..sized.len()).max_by(|&i, &k| sized[i].0.total_cmp(&sized[k].0)) {
        let (_, color) = sized.swap_remove(i);
        if !kept.iter().any(|&larger| is_alike(larger, color)) {
            kept.push(color);
        }
    }
    // 3. The others become what they are like.
    for (color, _) in marks {
        let alike = kept.iter().find(|&&larger| is_alike(larger, *color));
        *color = alike.copied().unwrap_or(*color);
    }
}

/// The parts within some rings that are farther than `reach` px from these.
pub(super) fn inset(rings: &[Path], reach: f64) -> Result<Vec<Path>> {
    without(rings, &[band(rings, reach)])
}

/// The parts within some rings that are farther than `reach` px from all within `inner` ones.
pub(super) fn around(rings: &[Path], inner: &[Path], reach: f64) -> Result<Vec<Path>> {
    without(rings, &[band(inner, reach), bezier(inner)])
}

/// All places within `reach` px of the rings.
fn band(rings: &[Path], reach: f64) -> BezPath {
    let stroke = |ring: &Path| Stroke {
        path: ring.clone(),
        radius: reach,
        radii: Vec::new(),
        cap: Cap::Round,
        color: [0.0; 3],
        opacity: 1.0,
    };
    let outlines = rings.iter();
    let outlines = outlines.map(|ring| outline::of_mark(&stroke(ring).into()).rings);
    bezier(&outlines.flatten().collect::<Vec<_>>())
}

fn bezier(rings: &[Path]) -> BezPath {
    rings.iter().flat_map(Path::bezier).collect()
}

/// The parts within some rings that are within none of the others.
fn without(rings: &[Path], others: &[BezPath]) -> Result<Vec<Path>> {
    let own = bezier(rings);
    // A page around all of the rings, so that nothing is cut off.
    let page = own.bounding_box().inflate(1.0, 1.0).to_path(NEAR);
    let others = others.iter().map(|other| ([1; 3], other.clone()));
    let marks: Vec<_> = [([0; 3], own)].into_iter().chain(others).collect();
    let mut parts = swept(|| seen(&page, &marks, &[[0; 3]]))?;
    Ok(parts.pop().map_or_else(Vec::new, |area| area.rings))
}

/// The area that a ring encloses, px².
pub(super) fn enclosed(ring: &Path) -> f64 {
    bezier(std::slice::from_ref(ring)).area().abs()
}

/// The outline of the page.
fn page(scene: &Scene) -> BezPath {
    kurbo::Rect::new(0.0, 0.0, scene.width.into(), scene.height.into()).to_path(NEAR)
}

/// The outlines of all marks with their colours, back to front.
fn outlines(scene: &Scene) -> Result<Vec<([u8; 3], BezPath)>> {
    let background = scene.background.map(|c| (c.map(quantum), page(scene)));
    let outline = |mark: &Mark| {
        let is_see_through = mark.shade().is_some_and(|shade| !shade.is_opaque());
        if quantum(mark.opacity()) < u8::MAX || is_see_through {
            let message = "translucent marks show two colours at a place, which cannot be cut out: draw with --opaque";
            return Err(Error::new(ErrorKind::Config, message));
        }
        Ok((
            mark.color().map(quantum),
            bezier(&outline::of_mark(mark).rings),
        ))
    };
    let marks = scene.marks().map(outline);
    background.map(Ok).into_iter().chain(marks).collect()
}

/// The result of a sweep. A panic in it is an error like any other.
fn swept(sweep: impl FnOnce() -> Option<Vec<Area>>) -> Result<Vec<Area>> {
    let found = panic::catch_unwind(AssertUnwindSafe(sweep)).ok().flatten();
    let message = "the outlines cannot be told apart: draw with fewer marks, or another --seed";
    found.ok_or_else(|| Error::new(ErrorKind::Svg, message))
}

/// The visible parts of these colours.
fn seen(page: &BezPath, marks: &[([u8; 3], BezPath)], colors: &[[u8; 3]]) -> Option<Vec<Area>> {
    let tagged = marks.iter().zip(1..).map(|((_, path), mark)| (path, mark));
    let tagged = tagged.chain([(page, PAGE)]);
    let topology = Topology::<Windings>::from_paths(tagged, NEAR).ok()?;
    let area = |own: &[u8; 3]| {
        let is_seen = |windings: &Windings| {
            // A place has the colour of the mark on top, whose tag is the largest.
            let top = windings.top().and_then(|mark| marks.get(mark as usize - 1));
            windings.is_on_page() && top.is_some_and(|(color, _)| color == own)
        };
        let contours = topology.contours(is_seen);
        let large = contours
            .contours()
            .filter(|contour| contour.path.area().abs() > SMALLEST);
        let rings = large.filter_map(|contour| ring(&contour.path));
        Area::plain(rings.collect(), color(*own), 1.0)
    };
    Some(colors.iter().map(area).collect())
}

/// A closed path of lines and curves; `None` if it has no inside.
fn ring(path: &BezPath) -> Option<Path> {
    let mut points: Vec<PathPoint> = Vec::new();
    let mut last = Point::ZERO;
    for element in path.elements() {
        match *element {
            PathEl::MoveTo(p) | PathEl::LineTo(p) => points.push(PathPoint::on(p)),
            PathEl::QuadTo(knee, p) => points.extend([PathPoint::off(knee), PathPoint::on(p)]),
            PathEl::CurveTo(c, d, p) => {
                // The sweep makes cubic curves of all. Most are parts of quadratic ones, and become one again.
                for quad in PathPiece::Cubic(CubicBez::new(last, c, d, p)).quads(QUADS) {
                    points.extend([PathPoint::off(quad.p1), PathPoint::on(quad.p2)]);
                }
            }
            PathEl::ClosePath => {}
        }
        last = element.end_point().unwrap_or(last);
    }
    // The last point is the first one again.
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    Path::new(points, true).ok()
}

/// The tag of the page's outline; marks have higher ones.
const PAGE: u32 = 0;

/// Numbers of times that outlines wind around a place: those that do, by their tags.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Windings(BTreeMap<u32, i32>);

impl Windings {
    fn is_on_page(&self) -> bool {
        self.0.contains_key(&PAGE)
    }

    /// The tag of the mark on top.
    fn top(&self) -> Option<u32> {
        let (&tag, _) = self.0.last_key_value()?;
        (tag > PAGE).then_some(tag)
    }
}

impl AddAssign for Windings {
    fn add_assign(&mut self, other: Self) {
        for (tag, turns) in other.0 {
            *self.0.entry(tag).or_default() += turns;
        }
        // Outlines that don't wind around a place are left out, so the largest tag is a mark that covers it.
        self.0.retain(|_, turns| *turns != 0);
    }
}

impl Add for Windings {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl WindingNumber for Windings {
    type Tag = u32;

    fn single(tag: u32, positive: bool) -> Self {
        Self([(tag, if positive { 1 } else { -1 })].into())
    }

    fn of_tag(&self, tag: u32) -> Self {
        Self(
            self.0
                .get_key_value(&tag)
                .map(|(k, v)| (*k, *v))
                .into_iter()
                .collect(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;
    use kurbo::{Line, ParamCurve, ParamCurveNearest};

    /// Places on a piece, which go from its start to its end in so many steps.
    fn samples(piece: PathPiece, steps: u32) -> Vec<Point> {
        let share = |step: u32| f64::from(step) / f64::from(steps);
        let at = |t: f64| match piece {
            PathPiece::Line(line) => line.eval(t),
            PathPiece::Quad(curve) => curve.eval(t),
            PathPiece::Cubic(curve) => curve.eval(t),
            PathPiece::Arc(arc) => {
                let (sin, cos) = math::sin_cos(t * arc.sweep());
                let leg = arc.from - arc.center();
                let turned = (leg.x * cos - leg.y * sin, leg.x * sin + leg.y * cos);
                arc.center() + kurbo::Vec2::from(turned)
            }
        };
        (0..=steps).map(share).map(at).collect()
    }

    /// Farthest that one of some places is from all lines, px.
    fn farthest(places: impl Iterator<Item = Point>, lines: &[Line]) -> f64 {
        let away = |p: Point| {
            let all = lines.iter().map(|line| line.nearest(p, 0.0).distance_sq);
            all.fold(f64::INFINITY, f64::min).sqrt()
        };
        places.map(away).fold(0.0, f64::max)
    }

    #[test]
    fn colours_that_are_hardly_told_apart_are_cut_out_as_one() {
        let square = |x: f64, side: f64| {
            let corners = [[x, 0.0], [x + side, 0.0], [x + side, side], [x, side]];
            Path::new(
                corners
                    .map(|[x, y]| PathPoint::on(Point::new(x, y)))
                    .to_vec(),
                true,
            )
            .unwrap()
        };
        // As antialiasing and compression leave them; the last one is another colour.
        let colors = [[43, 11, 5], [41, 11, 3], [60, 30, 20]];
        let marks = [square(0.0, 20.0), square(20.0, 30.0), square(60.0, 10.0)];
        let marks = marks.into_iter().zip(colors.map(color));
        let marks = marks.map(|(ring, color)| Area::plain(vec![ring], color, 1.0));
        let scene = Scene {
            stages: vec![Stage::from_iter(marks)],
            ..Scene::empty(80, 40, None)
        };
        let cut = cut_out(&scene).unwrap();
        let cut: Vec<_> = cut
            .marks()
            .map(|mark| (mark.color().map(quantum), mark.paths().len()))
            .collect();
        // The colour of the larger one, and one outline around both.
        assert_eq!(cut, [([41, 11, 3], 1), ([60, 30, 20], 1)]);
    }

    #[test]
    fn cut_outs_are_within_a_hundredth_of_a_px_of_curves_and_arcs() {
        for size in [20.0, 300.0, 2000.0] {
            let at = |x: f64, y: f64| Point::new(x * size, y * size);
            let points = vec![
                PathPoint::on(at(0.2, 0.4)),
                PathPoint::arc(at(0.5, 0.05)),
                PathPoint::on(at(0.8, 0.4)),
                PathPoint::cubic(at(1.0, 0.7)),
                PathPoint::cubic(at(0.5, 0.5)),
                PathPoint::on(at(0.6, 0.9)),
                PathPoint::off(at(0.4, 0.95)),
                PathPoint::on(at(0.3, 0.8)),
                PathPoint::arc(at(0.28, 0.7)),
                PathPoint::on(at(0.1, 0.6)),
            ];
            let ring = Path::new(points, true).unwrap();
            let side = size as u32;
            let scene = Scene {
                stages: vec![Stage::from_iter([Area::plain(
                    vec![ring.clone()],
                    [0.0; 3],
                    1.0,
                )])],
                ..Scene::empty(side, side, None)
            };
            let cut = cut_out(&scene).unwrap();
            let cut: Vec<Path> = cut.marks().flat_map(Mark::paths).cloned().collect();
            let given: Vec<Point> = ring.pieces().flat_map(|p| samples(p, 2000)).collect();
            let chords = given.windows(2).map(|ends| Line::new(ends[0], ends[1]));
            let back = farthest(
                cut.iter().flat_map(|ring| ring.flattened(1e-3)),
                &chords.collect::<Vec<_>>(),
            );
            let lines: Vec<Line> = cut.iter().flat_map(|ring| ring.lines(1e-4)).collect();
            let there = farthest(given.into_iter().step_by(10), &lines);
            assert!(there < 0.01 && back < 0.01, "{size}: {there} {back}");
        }
    }
}
