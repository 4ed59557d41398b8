//! Forms: what a person draws as a circle, an ellipse or a rectangle is one, and lines that are nearly level or upright are
//! exactly so.
//!
//! Rings that are shapes, and alone, become areas of their own, and so do dots among areas. Of a ring that other areas
//! hide in part, what is seen decides. A few steps of descent fit all proposals as what they are, and those stay that add less
//! squared error than the bytes that they save are worth.

use std::f64::consts::FRAC_PI_4;

use kurbo::ParamCurve;

use super::occlusion::Occlusion;
use super::proposals::{Each, adopt, traced};
use crate::error::Result;
use crate::fit::drawing::{Drawing, Snapshot};
use crate::fit::edits::Edit;
use crate::fit::run::session::Session;
use crate::math::Point;
use crate::metrics::psnr_db;
use crate::render::StrokeRef;
use crate::scene::{Area, Band, Cap, Mark, Marks, Path, PathPoint, Shape, Stroke};

/// Farthest that a path is from the shape that it becomes, px.
const TOLERANCE_PX: f64 = 0.45;
/// Largest difference in height, or place across, of the ends of a line that is level or upright, px.
const LEVEL_PX: f64 = 0.25;
/// That difference in units of the length of the line.
const LEVEL_SLOPE: f64 = 0.05;
/// Most rings of an area that some of its rings leave, to be elements of their own, and of one that all of them leave. A QR code stays
/// one area. A guess.
const SPLIT_RINGS: [usize; 2] = [12, 24];
/// By how much a file with shapes may be less faithful in resvg, dB, if it is then below the second number. Rings of a pen lose 2 to
/// 5 dB there, which other renderers do not; many thin ones would have it disagree with our render.
const MOST_LOST_DB: [f64; 2] = [2.0, 34.0];

/// Makes shapes of areas and traced strokes that nearly are such, and then lines level and upright. All strokes must be free.
pub(super) fn run(session: &mut Session<'_>) -> Result<()> {
    let most = session.limit.min(session.task.most_marks);
    let room = most.saturating_sub(session.drawing.len());
    let shapes = shapes(session, room);
    let paths = session.drawing.snapshot();
    // 1. Circles, ellipses and rectangles. Trials judge them in our own render, so the file's render has the last word.
    if adopt(session, shapes, Each::MayLose) {
        refuse_losses(session, paths)?;
    }
    // 2. Square ends for strokes that cover as much with them.
    if session.config.marks() == Marks::Auto {
        let squared = squares(session);
        adopt(session, squared, Each::Gains);
    }
    // 3. Lines of what is left, level and upright.
    let straight = straight(session);
    adopt(session, straight, Each::MayLose);
    Ok(())
}

/// Makes bands, and lines whose width varies, areas that are filled, where the file is to have no strokes.
pub(super) fn fill_bands(drawing: &mut Drawing) {
    let filled = |(i, mark): (usize, StrokeRef<'_>)| {
        let mark = mark.to_mark();
        let is_filled = mark.is_butt() || mark.is_varying();
        is_filled.then(|| Edit::replacing(i, vec![mark.filled()], 0.0))
    };
    let filled: Vec<Edit> = drawing
        .free()
        .iter()
        .enumerate()
        .filter_map(filled)
        .collect();
    drawing.apply(&filled);
}

/// Returns to the drawing of `paths` if the file with shapes is much less faithful: resvg draws large circles of a pen up to a
/// quarter of a pixel off, and paths of many points better.
fn refuse_losses(session: &mut Session<'_>, paths: Snapshot) -> Result<()> {
    let [most_lost_db, enough_db] = MOST_LOST_DB;
    let shaped_db = psnr_db(session.render_file()?.mse());
    if shaped_db >= enough_db {
        return Ok(());
    }
    let shaped = session.drawing.snapshot();
    session.drawing.restore(paths);
    if psnr_db(session.render_file()?.mse()) - shaped_db <= most_lost_db {
        session.drawing.restore(shaped);
    }
    Ok(())
}

/// A path whose points are all nearer to its first one than this is a dot, px: no picture shows more.
const DOT_PX: f64 = 0.1;

/// For each traced mark the shapes that it is, and at most `room` more marks than before.
fn shapes(session: &Session<'_>, mut room: usize) -> Vec<Edit> {
    let has_areas = session.drawing.free().has_areas();
    let occlusion = Occlusion::of(&session.drawing);
    // An icon in one ink is one path by its artist, too.
    let is_whole = session.drawing.free().len() == 1;
    let has_bands = session.config.marks() == Marks::Auto;
    let shaped = |i: usize, mark: Mark, room: &mut usize| {
        let is_disc = |dot: &Stroke| has_areas && dot.cap == Cap::Round && is_dot(&dot.path);
        let marks = match mark {
            Mark::Stroke(stroke) if stroke.is_varying() => return None,
            Mark::Stroke(stroke) if is_disc(&stroke) => vec![disc(&stroke).into()],
            Mark::Stroke(stroke) if stroke.cap == Cap::Butt => return None,
            Mark::Stroke(mut stroke) => {
                stroke.path = like(&stroke.path)?.path();
                vec![stroke.into()]
            }
            Mark::Area(area) => parts(area, [is_whole, has_bands], |p| occlusion.is_seen(i, p))?,
        };
        // A ring of its own is a mark more, and there is a limit on marks.
        *room = room.checked_sub(marks.len() - 1)?;
        Some(marks)
    };
    traced(&session.drawing, |i, mark| shaped(i, mark, &mut room))
}

/// True if all points are in one place.
fn is_dot(path: &Path) -> bool {
    let (first, _) = path.ends();
    path.points().iter().all(|p| p.at.distance(first) < DOT_PX)
}

/// The area of a dot.
fn disc(dot: &Stroke) -> Area {
    let circle = Shape::Circle {
        center: dot.path.ends().0,
        radius: dot.radius,
    };
    Area::plain(vec![circle.path()], dot.color, dot.opacity)
}

/// For each traced stroke a band: its square ends cover as much as round ones that end later.
fn squares(session: &Session<'_>) -> Vec<Edit> {
    let squared = |_: usize, mark: Mark| {
        let is_even = |stroke: &&Stroke| stroke.cap == Cap::Round && !stroke.is_varying();
        let stroke = mark.as_stroke().filter(is_even)?;
        // A half disc covers ½πr², as much as a rectangle 2r wide and ¼πr long.
        let beyond = [FRAC_PI_4 * stroke.radius; 2];
        let width = 2.0 * stroke.radius;
        let band = Band::along(&stroke.path, width, beyond, [TOLERANCE_PX, 0.0])?;
        let band = Some(band).filter(Band::is_told)?;
        Some(vec![band.stroke(stroke).into()])
    };
    traced(&session.drawing, squared)
}

/// The shape that a path nearly is, unless it is that already.
fn like(path: &Path) -> Option<Shape> {
    let is_shape = !path.is_closed() || path.shape().is_some();
    Shape::like(path, TOLERANCE_PX).filter(|_| !is_shape)
}

/// The area as areas: one for each of its rings that is alone and a shape, and one of all others. An area of many rings
/// stays one, and so does one that is the whole drawing, unless all of its rings are shapes.
fn parts(
    area: Area,
    [is_whole, has_bands]: [bool; 2],
    is_seen: impl Fn(Point) -> bool,
) -> Option<Vec<Mark>> {
    let rings = &area.rings;
    let has_bands = has_bands && area.shade.is_none();
    let band = has_bands.then(|| Band::like(rings, TOLERANCE_PX));
    if let Some(band) = band.flatten() {
        return Some(vec![filled(band, &area)]);
    }
    // Rings that are shapes become marks of their own; all others stay one area, with its holes.
    let alone = forms_of(&area, has_bands, is_seen);
    let pairs = rings.iter().zip(&alone);
    let rest = pairs.filter(|(_, form)| form.is_none());
    let rest: Vec<Path> = rest.map(|(ring, _)| ring.clone()).collect();
    let is_all = rest.is_empty();
    let is_split = rings.len() <= SPLIT_RINGS[usize::from(is_all)] && (is_all || !is_whole);
    if !is_split || rest.len() == rings.len() {
        return None;
    }
    let rest = Some(rest).filter(|rest| !rest.is_empty());
    let rest = rest.map(|rings| {
        Mark::from(Area {
            rings,
            ..area.clone()
        })
    });
    Some(alone.into_iter().flatten().chain(rest).collect())
}

/// A band in the colour of an area.
fn filled(band: Band, area: &Area) -> Mark {
    let stroke = Stroke {
        path: band.line,
        radius: 0.5 * band.width,
        radii: Vec::new(),
        cap: Cap::Butt,
        color: area.color,
        opacity: area.opacity,
    };
    stroke.into()
}

/// For each ring of an area the shape or the line that it is, if it is alone.
fn forms_of(area: &Area, has_bands: bool, is_seen: impl Fn(Point) -> bool) -> Vec<Option<Mark>> {
    let rings = &area.rings;
    let is_alone = |i: usize| {
        let mut others = rings.iter().enumerate().filter(|&(k, _)| k != i);
        // A hole and the ring around it are one shape only together.
        others.all(|(_, other)| are_apart(&rings[i], other))
    };
    let formed = |(i, ring): (usize, &Path)| {
        let seen = || Shape::like_seen(ring, TOLERANCE_PX, &is_seen);
        // The hidden part of a border is bent by the marks that hide it, so the seen part is asked first.
        let shape = seen()
            .filter(|_| ring.shape().is_none())
            .or_else(|| like(ring));
        let shape = shape.map(|shape| {
            let rings = vec![shape.path()];
            Mark::from(Area {
                rings,
                ..area.clone()
            })
        });
        let band = || {
            let ring = std::slice::from_ref(ring);
            let band = has_bands.then(|| Band::like(ring, TOLERANCE_PX))??;
            Some(filled(band, area))
        };
        shape.or_else(band).filter(|_| is_alone(i))
    };
    rings.iter().enumerate().map(formed).collect()
}

/// True if neither of two rings lies in the other one. The rings of a traced area do not cross.
fn are_apart(a: &Path, b: &Path) -> bool {
    let lies_in = |inner: &Path, outer: &Path| {
        let start = inner.segments().next().map(|first| first.start());
        start.is_some_and(|p| kurbo::Shape::winding(&outer.bezier(), p) != 0)
    };
    !lies_in(a, b) && !lies_in(b, a)
}

/// For each traced mark that is no shape, its lines that are nearly level or upright exactly so.
fn straight(session: &Session<'_>) -> Vec<Edit> {
    let straightened = |_: usize, mark: Mark| {
        if mark.shape().is_some() {
            return None;
        }
        let mut new = mark.clone();
        match &mut new {
            Mark::Stroke(stroke) => stroke.path = leveled(&stroke.path),
            Mark::Area(area) => {
                let rings = area.rings.iter_mut();
                rings.for_each(|ring| *ring = leveled(ring));
            }
        }
        (new != mark).then(|| vec![new])
    };
    traced(&session.drawing, straightened)
}

/// The path with the ends of lines that are nearly level, or upright, at their mean height, or place across.
fn leveled(path: &Path) -> Path {
    let before: Vec<[f64; 2]> = path.points().iter().map(|p| [p.at.x, p.at.y]).collect();
    let (mut after, count) = (before.clone(), before.len());
    let is_on = |i: usize| path.points()[i].is_on();
    for axis in 0..2 {
        for i in 0..count {
            let next = (i + 1) % count;
            // A line is nearly level if its ends differ little in px, and little for its length: a short one may be slanted.
            let across = (before[next][axis] - before[i][axis]).abs();
            let along = (before[next][1 - axis] - before[i][1 - axis]).abs();
            let is_line = is_on(i) && is_on(next) && (path.is_closed() || next > 0);
            if is_line && across <= LEVEL_PX && across <= LEVEL_SLOPE * along {
                // The line before may have moved its end; then that place holds.
                let is_chain = i > 0 && after[i][axis] != before[i][axis];
                let mean = 0.5 * (after[i][axis] + after[next][axis]);
                let at = if is_chain { after[i][axis] } else { mean };
                (after[i][axis], after[next][axis]) = (at, at);
            }
        }
    }
    let points = path.points().iter().zip(after);
    let points = points.map(|(p, [x, y])| PathPoint {
        at: Point::new(x, y),
        ..*p
    });
    Path::of_points(points.collect(), path.is_closed())
}
