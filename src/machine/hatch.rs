//! Hatching: areas filled with lines of a pen.

use super::visible;
use crate::error::{Error, ErrorKind, Result};
use crate::math::{self, Point};
use crate::scene::{Area, Cap, Mark, Path, Scene, Stage, Stroke, color, quantum};
use crate::svg::Length;

/// Farthest that the chords of a border are from its curves, px.
const TOLERANCE: f64 = 0.02;

/// Lines that fill areas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hatch {
    /// Distance of the lines.
    pub spacing: Length,
    /// Their direction, degrees counterclockwise from horizontal.
    pub degrees: f64,
}

impl std::str::FromStr for Hatch {
    type Err = Error;

    /// A length, and an angle after a colon: `0.5mm` or `0.5mm:45`.
    fn from_str(text: &str) -> Result<Self> {
        let (spacing, degrees) = text.split_once(':').unwrap_or((text, "45"));
        let refused = || {
            let message = format!(
                "'{text}' is not a hatching: give the distance of its lines, and their angle if it is not 45°, such as 0.5mm or 0.5mm:30"
            );
            Error::new(ErrorKind::Config, message)
        };
        let degrees: f64 = degrees.parse().map_err(|_| refused())?;
        let spacing = Length::parse(spacing).ok_or_else(refused)?;
        (degrees.abs() <= 360.0)
            .then_some(Self { spacing, degrees })
            .ok_or_else(refused)
    }
}

/// The scene with the visible parts of its areas filled with lines `spacing` px apart, of a `pen` that is so many px wide:
/// one along their borders, and straight ones at an angle. Strokes stay, and lie on top; one whose width varies is filled if it is
/// wider than the pen anywhere, and is drawn along its middle if not. The background is paper, which stays bare; so does an area of
/// its colour.
///
/// # Errors
/// As [`cut_out`](super::cut_out).
pub fn hatched(scene: &Scene, spacing: f64, pen: f64, degrees: f64) -> Result<Scene> {
    let mut scene = scene.without_shadows();
    let marks = scene.stages.iter_mut().flat_map(|stage| &mut stage.marks);
    for mark in marks {
        match mark {
            Mark::Stroke(stroke) if stroke.is_varying() && 2.0 * stroke.radius <= pen => {
                (stroke.radius, stroke.radii) = (0.5 * pen, Vec::new());
            }
            mark => *mark = mark.clone().filled(),
        }
    }
    let scene = &scene;
    let paper = scene.background.map(|c| c.map(quantum));
    let mut stages = Vec::new();
    for area in areas(scene)? {
        if Some(area.color.map(quantum)) != paper {
            let lines = filled(&area, spacing, pen, degrees)?;
            stages.push(Stage::from_iter(lines));
        }
    }
    let strokes = scene.strokes().cloned();
    stages.push(Stage::from_iter(strokes));
    stages.retain(|stage| !stage.marks.is_empty());
    Ok(Scene {
        stages,
        ground: Vec::new(),
        ..*scene
    })
}

/// The visible parts of the areas, which areas and strokes on top hide, by colour.
fn areas(scene: &Scene) -> Result<Vec<Area>> {
    // Strokes hide marks below, but aren't hatched: they get a colour that no area has.
    let mut taken: Vec<[u8; 3]> = scene.areas().map(|area| area.color.map(quantum)).collect();
    taken.extend(scene.background.map(|c| c.map(quantum)));
    let free = (0..=u8::MAX).map(|level| [level, 0, 255 - level]);
    let free = free.into_iter().find(|c| !taken.contains(c));
    let free = free.unwrap_or_default();
    let hidden = |mark: &Mark| match mark {
        Mark::Stroke(stroke) => Mark::Stroke(Stroke {
            color: color(free),
            ..stroke.clone()
        }),
        Mark::Area(_) => mark.clone(),
    };
    let stage = |stage: &Stage| stage.marks.iter().map(hidden).collect();
    let marked = Scene {
        stages: scene.stages.iter().map(stage).collect(),
        background: scene.background,
        ground: Vec::new(),
        ..*scene
    };
    let mut areas = visible::areas(&marked)?;
    areas.retain(|area| area.color.map(quantum) != free);
    Ok(areas)
}

/// Distances of the pen from the border, in units of its radius. Parts that the pen does not reach at one of
/// them, because they are thinner than the pen, are drawn at the next. The steps are a guess.
const DISTANCES: [f64; 5] = [1.0, 0.7, 0.45, 0.25, 0.1];

/// Smaller pieces that the pen does not reach are left out, in units of its width squared. They lie in corners. A guess.
const SMALLEST: f64 = 0.4;

/// The lines that fill an area.
fn filled(area: &Area, spacing: f64, pen: f64, degrees: f64) -> Result<Vec<Stroke>> {
    let radius = pen / 2.0;
    let mut paths = Vec::new();
    let mut rest = area.rings.clone();
    for (step, distance) in DISTANCES.into_iter().enumerate() {
        // The pen's middle runs along the inset border, so that its outer edge meets the border itself.
        let inner = visible::inset(&rest, distance * radius)?;
        paths.extend(inner.iter().cloned());
        if step == 0 {
            paths.extend(lines(&inner, spacing, degrees));
        }
        // Parts that the pen doesn't reach from there are drawn nearer to the border in the next step.
        rest = visible::around(&rest, &inner, radius)?;
        rest.retain(|ring| visible::enclosed(ring) > SMALLEST * pen * pen);
        if rest.is_empty() {
            break;
        }
    }
    let stroke = |path| Stroke {
        path,
        radius,
        radii: Vec::new(),
        cap: Cap::Round,
        color: area.color,
        opacity: 1.0,
    };
    Ok(paths.into_iter().map(stroke).collect())
}

/// Straight lines at an angle within rings.
fn lines(rings: &[Path], spacing: f64, degrees: f64) -> Vec<Path> {
    // Turn the rings so that hatch lines are rows of constant v. The angle is negative because y points down.
    let (sin, cos) = math::sin_cos(-degrees.to_radians());
    let turned = |p: Point| [p.x * cos + p.y * sin, p.y * cos - p.x * sin];
    let back = |[u, v]: [f64; 2]| Point::new(u * cos - v * sin, u * sin + v * cos);
    let sides: Vec<[[f64; 2]; 2]> = rings
        .iter()
        .flat_map(|ring| {
            let corners = ring.flattened(TOLERANCE);
            let next = corners.iter().cycle().skip(1);
            let sides = corners.iter().zip(next);
            sides
                .map(|(a, b)| [turned(*a), turned(*b)])
                .collect::<Vec<_>>()
        })
        .collect();
    let ends = || sides.iter().flatten().map(|p| p[1]);
    let (low, high) = (
        ends().fold(f64::INFINITY, f64::min),
        ends().fold(f64::NEG_INFINITY, f64::max),
    );
    let mut found = Vec::new();
    // The lines of all areas are at multiples of the distance, so that the lines of neighbours meet.
    let (first, last) = ((low / spacing).ceil(), (high / spacing).floor());
    let rows = if first <= last {
        (last - first) as usize + 1
    } else {
        0
    };
    for row in 0..rows {
        let v = (first + row as f64) * spacing;
        // Sorted, the borders that a row crosses lead in and out by turns, around holes too.
        let mut cuts = cuts(&sides, v);
        cuts.sort_by(f64::total_cmp);
        let pairs = cuts.as_chunks::<2>().0.iter();
        let mut lines: Vec<_> = pairs
            .filter(|[from, to]| to - from > TOLERANCE)
            .map(|&[from, to]| match row % 2 {
                0 => Path::line(back([from, v]), back([to, v])),
                // Every other row goes back, so that the pen travels less.
                _ => Path::line(back([to, v]), back([from, v])),
            })
            .collect();
        if row % 2 == 1 {
            lines.reverse();
        }
        found.extend(lines);
    }
    found
}

/// Where sides cross the row at `v`.
fn cuts(sides: &[[[f64; 2]; 2]], v: f64) -> Vec<f64> {
    // Half open: a corner on the row belongs to one of its two sides, so that the number of cuts is even.
    let crossing = |[a, b]: &&[[f64; 2]; 2]| (a[1] <= v) != (b[1] <= v);
    let at = |[a, b]: &[[f64; 2]; 2]| a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    sides.iter().filter(crossing).map(at).collect()
}
