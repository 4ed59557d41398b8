//! Which true lines come back as one element each, and how far off its centre line and width are.
//!
//! A line is *whole* if one element covers more than [`COVERED`] of its ink, and more than [`ON_LINE`] of that element lies on the
//! line made 1 px wider on each side. Both are drawn alone, at twice the size of the picture, as pixels that are in or out.

use rayon::prelude::*;

use super::super::anatomy::each_alone;
use super::super::belonging::drawn;
use super::line::{Line, between, place};
use crate::report::ink::Found;
use crate::report::statistics::{mean, quantile};
use strokefit::Result;
use strokefit::image::Image;
use strokefit::math::Point;
use strokefit::scene::{Mark, Path, PathPoint, PointKind, Stroke};
use strokefit::svg;
use strokefit::verify::Size;

/// Share of a line's ink that one element covers if the line is whole.
const COVERED: f64 = 0.9;

/// Share of that element that lies on the line.
const ON_LINE: f64 = 0.85;

/// Pixels of masks for each px of the picture, along a side.
const PER_PX: usize = 2;

/// An element's pixels are those with at least half of its colour, if that is no lighter than this, 0..1: what is lighter is the
/// page again.
const LIGHTEST: f32 = 0.55;

/// Greatest distance of chords from centre lines, px.
const TOLERANCE_PX: f64 = 0.02;

/// The true lines of a picture, as pixels.
pub(super) struct Truth<'a> {
    lines: &'a [Line],
    size: [usize; 2],
    /// The ink of each line, and where it is 1 px wider on each side.
    masks: Vec<[Mask; 2]>,
}

/// Pixels that are in or out.
struct Mask {
    is_in: Vec<bool>,
    count: usize,
}

impl Mask {
    fn of(line: &Line, size: [usize; 2], wider_px: f64) -> Self {
        let mut is_in = vec![false; size[0] * size[1] * PER_PX * PER_PX];
        let covered = line.covered(size, PER_PX, wider_px);
        covered.iter().for_each(|i| is_in[*i] = true);
        Self {
            is_in,
            count: covered.len(),
        }
    }

    fn shared(&self, pixels: &[usize]) -> f64 {
        pixels.iter().filter(|i| self.is_in[**i]).count() as f64
    }
}

/// The elements of a file, back to front.
pub(super) struct Elements {
    size: [usize; 2],
    all: Vec<Element>,
}

struct Element {
    /// Its pixels, in order.
    pixels: Vec<usize>,
    /// Its centre line with half its width, px, if it has one.
    centre: Option<Line>,
}

impl Elements {
    /// The elements of SVG text of a picture of some size. Where our own reader does not know them, they have no centre lines.
    ///
    /// # Errors
    /// As [`drawn`].
    pub(super) fn of(text: &str, size: [usize; 2]) -> Result<Self> {
        let side = |px: usize| u32::try_from(px * PER_PX).unwrap_or(u32::MAX);
        let [width, height] = size.map(side);
        let pixels = |alone: &String| {
            let dark =
                |[r, g, b, alpha]: [f32; 4]| alpha >= 0.5 && (r + g + b) / 3.0 <= LIGHTEST * alpha;
            let pixels = drawn(alone, Size::Exact { width, height })?.into_iter();
            let pixels = pixels.enumerate().filter(|(_, pixel)| dark(*pixel));
            Ok(pixels.map(|(i, _)| i).collect())
        };
        let alone = each_alone(text)?;
        let pixels: Result<Vec<Vec<usize>>> = alone.par_iter().map(pixels).collect();
        let pixels = pixels?;
        let marks: Vec<Mark> =
            svg::read(text).map_or_else(|_| Vec::new(), |scene| scene.marks().cloned().collect());
        // What comes before the marks is on the page.
        let before = pixels.len().checked_sub(marks.len());
        let centre = |i: usize| {
            let mark = marks.get(i.checked_sub(before?)?)?;
            mark.as_stroke().map(centre_line)
        };
        let all = pixels.into_iter().enumerate().map(|(i, pixels)| Element {
            pixels,
            centre: centre(i),
        });
        Ok(Self {
            size,
            all: all.collect(),
        })
    }

    /// Each element in a colour of its own, on white.
    ///
    /// # Errors
    /// As [`Image::new`].
    pub(super) fn in_colors(&self) -> Result<Image> {
        let [width, height] = self.size.map(|px| px * PER_PX);
        let mut planes = [(); 3].map(|()| vec![1.0; width * height]);
        for (element, color) in self.all.iter().zip(COLORS.iter().cycle()) {
            for &i in &element.pixels {
                for (plane, level) in planes.iter_mut().zip(color) {
                    plane[i] = f32::from(*level) / 255.0;
                }
            }
        }
        Ok(Image::new(width, height, planes)?.halved())
    }
}

/// Colours of elements in turn: Okabe & Ito, "Color universal design", 2008, without the lightest.
const COLORS: [[u8; 3]; 7] = [
    [213, 94, 0],
    [0, 114, 178],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [0, 0, 0],
];

/// The centre line of a stroke, with half its width: linear along each piece of the path, and along all curves between two vertices.
fn centre_line(stroke: &Stroke) -> Line {
    let mut points = stroke.path.points().to_vec();
    let first = points.iter().position(PathPoint::is_on);
    if stroke.path.is_closed() {
        points.rotate_left(first.unwrap_or_default());
        points.push(points[0]);
    }
    let vertices: Vec<usize> = (0..points.len()).filter(|i| points[*i].is_on()).collect();
    let radius = |vertex: usize| match stroke.radii.len() {
        0 => stroke.radius,
        count => stroke.radii[vertex % count],
    };
    let mut samples = Vec::new();
    for (vertex, ends) in vertices.windows(2).enumerate() {
        let pieces = pieces(&points[ends[0]..=ends[1]]);
        let at = |share: f64| radius(vertex) + share * (radius(vertex + 1) - radius(vertex));
        for (i, piece) in pieces.iter().enumerate() {
            let [from, to] = [i, i + 1].map(|k| at(k as f64 / pieces.len() as f64));
            samples.extend(with_radii(&piece.flattened(TOLERANCE_PX), [from, to]));
        }
    }
    if samples.is_empty() {
        let points = stroke.path.flattened(TOLERANCE_PX);
        samples = with_radii(&points, [radius(0); 2]);
    }
    Line { samples }
}

/// The lines, curves and arcs from one vertex of a path to the next, each as a path.
fn pieces(run: &[PathPoint]) -> Vec<Path> {
    let [start, between @ .., end] = run else {
        return Vec::new();
    };
    let is_quad = between.iter().all(|p| p.kind == PointKind::Quad);
    let path = |points: Vec<PathPoint>| Path::new(points, false).ok();
    if between.is_empty() || !is_quad {
        return path(run.to_vec()).into_iter().collect();
    }
    // Curves meet halfway between their control points.
    let middles = between.windows(2).map(|p| p[0].at.midpoint(p[1].at));
    let joints: Vec<PathPoint> = [start.at]
        .into_iter()
        .chain(middles)
        .chain([end.at])
        .map(PathPoint::on)
        .collect();
    let curves = joints.windows(2).zip(between);
    curves
        .filter_map(|(ends, off)| path(vec![ends[0], *off, ends[1]]))
        .collect()
}

/// Points with a radius that changes evenly along them.
fn with_radii(points: &[Point], [from, to]: [f64; 2]) -> Vec<[f64; 3]> {
    let lengths = points.windows(2).map(|w| w[0].distance(w[1]));
    let ends = lengths.scan(0.0, |sum, length| {
        *sum += length;
        Some(*sum)
    });
    let along: Vec<f64> = [0.0].into_iter().chain(ends).collect();
    let whole = along.last().copied().unwrap_or_default();
    let share = |at: f64| at / whole.max(f64::MIN_POSITIVE);
    let points = points.iter().zip(along);
    points
        .map(|(p, at)| [p.x, p.y, from + share(at) * (to - from)])
        .collect()
}

impl<'a> Truth<'a> {
    /// The lines of a picture of some size.
    pub(super) fn of(lines: &'a [Line], size: [usize; 2]) -> Self {
        let masks = |line| [0.0, 1.0].map(|wider| Mask::of(line, size, wider));
        Self {
            lines,
            size,
            masks: lines.par_iter().map(masks).collect(),
        }
    }

    /// How much of the lines is found in the elements of a file.
    pub(super) fn found(&self, elements: &Elements) -> Found {
        debug_assert_eq!(self.size, elements.size);
        let mut recalls = Vec::new();
        let (mut centre_px, mut half_width_px) = (Vec::new(), Vec::new());
        let mut whole = 0;
        for (line, masks) in self.lines.iter().zip(&self.masks) {
            let best = elements
                .all
                .iter()
                .filter_map(|e| Some((recall(masks, e)?, e)));
            let best = best.max_by(|(a, _), (b, _)| a.total_cmp(b));
            recalls.push(best.map_or(0.0, |(recall, _)| recall));
            let Some((_, element)) = best.filter(|(recall, _)| *recall > COVERED) else {
                continue;
            };
            whole += 1;
            for &sample in element.centre.iter().flat_map(|_| &line.samples) {
                let nearest = element
                    .centre
                    .as_ref()
                    .map(|centre| nearest(centre, sample));
                if let Some([off, radius]) = nearest {
                    centre_px.push(off);
                    half_width_px.push((radius - sample[2]).abs());
                }
            }
        }
        let spread = |values: Vec<f64>| {
            let [median, p90] = [0.5, 0.9].map(|share| quantile(values.clone(), share));
            median.zip(p90).map(<[f64; 2]>::from)
        };
        Found {
            whole,
            elements: elements.all.len(),
            recall: mean(&recalls).unwrap_or_default(),
            centre_px: spread(centre_px),
            half_width_px: spread(half_width_px),
        }
    }
}

/// The share of a line's ink that an element covers; `None` if too little of the element lies on the line.
fn recall([ink, wider]: &[Mask; 2], element: &Element) -> Option<f64> {
    let on_line = wider.shared(&element.pixels) / element.pixels.len() as f64;
    (on_line > ON_LINE).then(|| ink.shared(&element.pixels) / ink.count.max(1) as f64)
}

/// The distance of a sample from a centre line, and half the width there, px.
fn nearest(centre: &Line, sample: [f64; 3]) -> [f64; 2] {
    let p = place(sample);
    let samples = &centre.samples;
    let last = samples.len() - 1;
    let at = |i: usize| {
        let [a, b] = [samples[i], samples[(i + 1).min(last)]];
        let axis = place(b) - place(a);
        let share = (p - place(a)).dot(axis) / axis.hypot2().max(f64::MIN_POSITIVE);
        let foot = between(a, b, share.clamp(0.0, 1.0));
        [p.distance(place(foot)), foot[2]]
    };
    let feet = (0..samples.len()).map(at);
    let nearest = feet.min_by(|a, b| a[0].total_cmp(&b[0]));
    nearest.unwrap_or([f64::NAN; 2])
}

#[cfg(test)]
mod tests {
    use super::super::kinds::KINDS;
    use super::*;
    use strokefit::scene::Scene;

    const SIZE: [usize; 2] = [200, 200];

    /// Lines as areas, each one path of discs a quarter of a px apart.
    fn outlined(lines: &[Line], [width, height]: [usize; 2]) -> String {
        let disc = |[x, y, r]: [f64; 3]| {
            let (left, d) = (x - r, 2.0 * r);
            format!("M{left} {y}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0z")
        };
        let path = |line: &Line| {
            let pairs = line.samples.windows(2);
            let dense = pairs.flat_map(|w| [0.0, 0.25, 0.5, 0.75].map(|t| between(w[0], w[1], t)));
            let discs: String = dense
                .chain(line.samples.last().copied())
                .map(disc)
                .collect();
            format!(r#"<path d="{discs}"/>"#)
        };
        let paths: String = lines.iter().map(path).collect();
        format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">{paths}</svg>"#
        )
    }

    fn halves(lines: &[Line]) -> Vec<Line> {
        let half = |line: &Line| {
            let (a, b) = line.samples.split_at(line.samples.len() / 2);
            [a, b].map(|samples| Line {
                samples: samples.to_vec(),
            })
        };
        lines.iter().flat_map(half).collect()
    }

    #[test]
    fn the_truth_is_whole_and_its_halves_are_not() {
        for kind in &KINDS {
            let (lines, size) = kind.drawing(1);
            let truth = Truth::of(&lines, size);
            let found =
                |lines: &[Line]| truth.found(&Elements::of(&outlined(lines, size), size).unwrap());
            let itself = found(&lines);
            assert_eq!(itself.whole, lines.len(), "{}", kind.name);
            assert!(itself.recall > 0.95, "{} {itself:?}", kind.name);
            let halved = found(&halves(&lines));
            assert_eq!(
                (halved.whole, halved.elements),
                (0, 2 * lines.len()),
                "{}",
                kind.name
            );
            let united = outlined(&lines, size).replace(r#""/><path d=""#, "");
            let united = truth.found(&Elements::of(&united, size).unwrap());
            assert_eq!((united.whole, united.elements), (0, 1), "{}", kind.name);
        }
    }

    #[test]
    fn a_centre_line_has_the_widths_of_its_stroke() {
        let points = [[0.0, 0.0], [4.0, 0.0], [8.0, 0.0], [12.0, 0.0], [14.0, 0.0]];
        let points = points.map(|[x, y]| Point::new(x, y));
        let mut points = points.map(PathPoint::on);
        points[1].kind = PointKind::Quad;
        points[2].kind = PointKind::Quad;
        let path = Path::new(points.to_vec(), false).unwrap();
        let stroke = Stroke::varying(path, vec![1.0, 5.0, 3.0], [0.0; 3], 1.0).unwrap();
        let centre = centre_line(&stroke);
        for [at, radius] in [
            [0.0, 1.0],
            [6.0, 3.0],
            [12.0, 5.0],
            [13.0, 4.0],
            [14.0, 3.0],
        ] {
            let [off, found] = nearest(&centre, [at, 1.0, 0.0]);
            assert!(
                (off - 1.0).abs() < 1e-9 && (found - radius).abs() < 1e-9,
                "{at} {found}"
            );
        }
    }

    #[test]
    fn lines_whose_width_varies_come_back_from_their_file() {
        let (lines, size) = KINDS[6].drawing(1);
        let stroke = |line: &Line| {
            let samples = || line.samples.iter().step_by(5);
            let points = samples().map(|s| PathPoint::on(place(*s))).collect();
            let path = Path::new(points, false).unwrap();
            let radii = samples().map(|s| s[2]).collect();
            Stroke::varying(path, radii, [0.0; 3], 1.0).unwrap()
        };
        let [width, height] = size.map(|px| u32::try_from(px).unwrap());
        let scene = Scene {
            stages: vec![lines.iter().map(stroke).collect()],
            ..Scene::empty(width, height, Some([1.0; 3]))
        };
        let text = svg::write(&scene, &svg::WriteOptions::default());
        let found = Truth::of(&lines, size).found(&Elements::of(&text, size).unwrap());
        assert_eq!((found.whole, found.elements), (3, 3));
        let [centre, half_width] = [found.centre_px, found.half_width_px].map(Option::unwrap);
        assert!(centre[1] < 0.05 && half_width[1] < 0.05, "{found:?}");
    }

    #[test]
    fn a_stroke_tells_how_far_off_it_is() {
        let line = |y: f64, r: f64| Line {
            samples: vec![[20.0, y, r], [100.0, y, r], [180.0, y, r]],
        };
        let lines = [line(40.5, 3.0), line(100.0, 4.0)];
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="200" height="200" viewBox="0 0 200 200"><rect width="200" height="200" fill="#ffffff"/><g id="stage-1" fill="none" stroke-linecap="round" stroke-linejoin="round"><path d="M20 40L180 40" stroke="#000000" stroke-width="5.5"/></g></svg>"##;
        let found = Truth::of(&lines, SIZE).found(&Elements::of(svg, SIZE).unwrap());
        assert_eq!((found.whole, found.elements), (1, 1));
        assert_eq!(found.centre_px, Some([0.5; 2]));
        assert_eq!(found.half_width_px, Some([0.25; 2]));
    }
}
