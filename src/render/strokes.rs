//! Strokes as the renderer and the optimiser see them: numbers in a row.

use serde::{Deserialize, Serialize};

use super::paint::Paint;
use crate::math;
use crate::scene::{Area, Band, Cap, Mark, Path, PathPoint, PointKind, Rgb, ShapeKind, Stroke};

/// Numbers of a capsule, in the order of the constants below.
pub const PARAMS: usize = 9;

/// x of the first end, px.
pub const AX: usize = 0;
/// y of the first end, px.
pub const AY: usize = 1;
/// x of the second end, px; equal to the first for a dot.
pub const BX: usize = 2;
/// y of the second end, px.
pub const BY: usize = 3;
/// Half the stroke width, px.
pub const RADIUS: usize = 4;
/// Red; green and blue follow. sRGB-encoded, 0..1.
pub const RED: usize = 5;
/// 0..1.
pub const OPACITY: usize = 8;

/// Largest distance between a curve and the segments that are drawn in its place, px, for a stroke of this opacity.
///
/// An outline in the wrong place changes the picture less, the more translucent the stroke is. So its segments may be
/// longer, and there are fewer of them. 0.08 px for all strokes: +0.01 dB on five photographs at 1.13 of the time.
pub(super) fn flatness(opacity: f32) -> f32 {
    (0.08 / (opacity * opacity)).min(0.5)
}

/// Most segments of one curve, so that one of more than some 1,300 px may be off by more. An arc has as many for each quarter.
pub(super) const MAX_STEPS: usize = 64;

/// Number of segments that keep within `flatness` of a quadratic curve, px, from the length of its second difference `a − 2b + c`.
///
/// A curve is at most a quarter of that from its chord, and each halving of the step quarters the distance. The hair that
/// is taken off keeps curves in round numbers, whose ratio is a whole number, from hanging on rounding.
pub(super) fn steps(bend: f64, flatness: f64) -> usize {
    steps_at_most(MAX_STEPS, bend, flatness)
}

/// As [`steps`], with another limit.
pub(super) fn steps_at_most(most: usize, bend: f64, flatness: f64) -> usize {
    let steps = (bend / (4.0 * flatness)).sqrt() - 1e-3;
    // `ceil` is a call where the target has no instruction for it.
    let whole = (steps as usize).min(most);
    (whole + usize::from(steps > whole as f64)).clamp(1, most)
}

/// The numbers of a capsule: the strokes that seeding proposes.
pub type Params = [f32; PARAMS];

/// Numbers of a stroke besides its points: radius, red, green, blue, opacity.
pub const STYLE: usize = 5;

/// Strokes, back to front, as one row of numbers.
///
/// Each stroke has the x and y of its points, px, and then its *style*: radius (px), red, green, blue and opacity. So the
/// numbers of a stroke of two points are laid out as [`Params`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Strokes {
    numbers: Vec<f32>,
    /// The kinds of the points of all strokes.
    kinds: Vec<PointKind>,
    /// The rings of all areas: each by the index behind its last point, counted from the first point of its area.
    rings: Vec<u32>,
    /// The gradients of the areas that have one.
    paints: Vec<Paint>,
    /// The lines of the areas that are the outline of one whose width varies.
    sweeps: Vec<Sweep>,
    outlines: Vec<Outline>,
}

/// Meaning of the numbers of a stroke.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Outline {
    /// The index after its last point, among the points of all strokes.
    end: u32,
    /// The index after its last ring, among the rings of all areas.
    rings_end: u32,
    /// The index after its paint, or after the last one before it.
    paints_end: u32,
    /// The index after its line, or after the last one before it.
    sweeps_end: u32,
    closed: bool,
    form: Option<Form>,
}

/// The line and the radii, px, of a stroke whose width varies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sweep {
    points: Vec<[f64; 2]>,
    kinds: Vec<PointKind>,
    closed: bool,
    radii: Vec<f64>,
}

impl Sweep {
    fn of(stroke: &Stroke) -> Self {
        let points = stroke.path.points();
        Self {
            points: points.iter().map(|p| [p.at.x, p.at.y]).collect(),
            kinds: points.iter().map(|p| p.kind).collect(),
            closed: stroke.path.is_closed(),
            radii: stroke.radii.clone(),
        }
    }

    /// Multiplies all lengths.
    pub fn scale(&mut self, factor: f64) {
        let lengths = self.points.as_flattened_mut().iter_mut();
        lengths.chain(&mut self.radii).for_each(|l| *l *= factor);
    }

    fn stroke(&self, color: Rgb, opacity: f32) -> Stroke {
        let points = self.points.iter().zip(&self.kinds);
        let points = points.map(|(&at, &kind)| PathPoint {
            at: (at[0], at[1]).into(),
            kind,
        });
        Stroke {
            path: Path::of_points(points.collect(), self.closed),
            radius: self.radii.iter().copied().fold(0.0, f64::max),
            radii: self.radii.clone(),
            cap: Cap::Round,
            color,
            opacity,
        }
    }
}

/// Numbers that all points of a mark follow from, where they are no path like any other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Form {
    /// The sides and radii of a shape, which is the only path.
    Shape(ShapeKind),
    /// The line and the width of a stroke with square ends, whose outline is rings to be filled.
    Band,
    /// The line and the radii of a stroke whose width varies. Its outline is rings to be filled, which stay as they are.
    Sweep,
}

/// One of [`Strokes`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrokeRef<'a> {
    /// The points of its path, px.
    pub points: &'a [[f32; 2]],
    /// The kind of each point.
    pub kinds: &'a [PointKind],
    /// True if the last point is joined to the first.
    pub closed: bool,
    /// For an area, the index behind the last point of each of its rings; none for a stroke.
    pub rings: &'a [u32],
    /// Numbers that all points follow from.
    pub form: Option<Form>,
    /// Radius, red, green, blue, opacity. The radius of an area is 0.
    pub style: &'a [f32; STYLE],
    /// The gradient that an area is filled with instead of its colour.
    pub paint: Option<&'a Paint>,
    /// The line whose outline its points are, if its form says so.
    pub sweep: Option<&'a Sweep>,
}

/// One of [`Strokes`], to be changed.
#[derive(Debug)]
pub struct StrokeMut<'a> {
    /// The points of its path, px.
    pub points: &'a mut [[f32; 2]],
    /// Radius, red, green, blue, opacity.
    pub style: &'a mut [f32; STYLE],
    /// True if the points are rings to be filled, so that the radius has to stay 0.
    pub is_area: bool,
    /// The gradient that an area is filled with instead of its colour.
    pub paint: Option<&'a mut Paint>,
    /// The line whose outline the points are, if its form says so. They stay where they are.
    pub sweep: Option<&'a mut Sweep>,
}

impl<'a> StrokeRef<'a> {
    /// True if the points are rings to be filled, and not the centre line of a stroke.
    pub fn is_area(&self) -> bool {
        !self.rings.is_empty()
    }

    /// The paths that the points form: one for each ring of an area, or one. Each comes with the index of its first point.
    pub fn paths(&self) -> impl Iterator<Item = (usize, StrokeRef<'a>)> + use<'a> {
        let whole = *self;
        let ends = whole.rings.iter().map(|&end| end as usize);
        let path = move |(start, end): (usize, usize)| {
            let path = StrokeRef {
                points: &whole.points[start..end],
                kinds: &whole.kinds[start..end],
                closed: whole.closed || whole.is_area(),
                rings: &[],
                ..whole
            };
            (start, path)
        };
        // Each ring ends where the next one starts. A stroke is one path of all points.
        let only = (!whole.is_area()).then_some(whole.points.len());
        let ends = ends.chain(only);
        ends.scan(0, |start, end| Some((std::mem::replace(start, end), end)))
            .map(path)
    }

    /// Half the stroke width, px.
    pub fn radius(&self) -> f32 {
        self.style[0]
    }

    /// sRGB-encoded, 0..1.
    pub fn color(&self) -> Rgb {
        let [_, red, green, blue, _] = *self.style;
        [red, green, blue]
    }

    /// 0..1.
    pub fn opacity(&self) -> f32 {
        self.style[4]
    }

    /// Largest distance between a curve of the path and the segments that the renderer draws in its place, px.
    pub fn flatness(&self) -> f32 {
        flatness(self.opacity())
    }

    /// Length of the lines through the points in their order, px.
    pub fn length(&self) -> f32 {
        let steps = self.points.windows(2);
        steps
            .map(|step| math::hypot(step[1][0] - step[0][0], step[1][1] - step[0][1]))
            .sum()
    }

    /// True if the path has no curve.
    pub fn is_straight(&self) -> bool {
        self.kinds.iter().all(|kind| *kind == PointKind::On)
    }

    /// True if the path has cubic curves or arcs.
    pub fn is_mixed(&self) -> bool {
        !self.kinds.iter().all(|kind| kind.is_quadratic())
    }

    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        // 0 times a number is 0, and NaN if the number is not finite; so there is nothing to branch on.
        let zero = |sum: f32, v: &f32| sum + 0.0 * v;
        let points = self.points.as_flattened().iter().fold(0.0, zero);
        self.style.iter().fold(points, zero) == 0.0
    }

    /// The band whose rings the points are, if they are such.
    pub fn band(&self) -> Option<Band> {
        let is_closed = self.rings.len() > 1;
        let near = || Band::near(self.points, self.kinds, is_closed);
        (self.form == Some(Form::Band)).then(near)?
    }

    /// The stroke or area as a part of a scene.
    pub fn to_mark(&self) -> Mark {
        if !self.is_area() {
            return self.to_stroke().into();
        }
        if let Some(band) = self.band() {
            let (path, radius) = (band.line, 0.5 * band.width);
            let stroke = Stroke {
                path,
                radius,
                radii: Vec::new(),
                cap: Cap::Butt,
                color: self.color(),
                opacity: self.opacity(),
            };
            return stroke.into();
        }
        if let Some(sweep) = self.sweep.filter(|_| self.form == Some(Form::Sweep)) {
            return sweep.stroke(self.color(), self.opacity()).into();
        }
        let rings = self.paths().map(|(_, ring)| ring.to_path()).collect();
        let area = Area {
            shade: self.paint.map(|paint| paint.shade.clone()),
            ..Area::plain(rings, self.color(), self.opacity())
        };
        area.into()
    }

    /// The stroke as a part of a scene; of an area, all of its points as one centre line.
    pub fn to_stroke(&self) -> Stroke {
        Stroke {
            path: self.to_path(),
            radius: self.radius().into(),
            radii: Vec::new(),
            cap: Cap::Round,
            color: self.color(),
            opacity: self.opacity(),
        }
    }

    fn to_path(self) -> Path {
        if let Some(Form::Shape(kind)) = self.form
            && let Some(shape) = kind.nearest(self.points)
        {
            return shape.path();
        }
        let points = self.points.iter().zip(self.kinds);
        let points = points.map(|(&at, &kind)| PathPoint {
            at: math::point(at),
            kind,
        });
        Path::of_points(points.collect(), self.closed)
    }
}

impl StrokeMut<'_> {
    /// The colour, to be changed.
    pub fn color_mut(&mut self) -> &mut [f32] {
        &mut self.style[1..4]
    }
}

impl Strokes {
    /// No strokes.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of strokes.
    pub fn len(&self) -> usize {
        self.outlines.len()
    }

    /// True if there is no stroke.
    pub fn is_empty(&self) -> bool {
        self.outlines.is_empty()
    }

    /// True if one of them is an area.
    pub fn has_areas(&self) -> bool {
        !self.rings.is_empty()
    }

    /// Number of points, of all strokes together.
    pub fn points(&self) -> usize {
        self.kinds.len()
    }

    /// All numbers, stroke after stroke.
    pub fn numbers(&self) -> &[f32] {
        &self.numbers
    }

    /// All numbers, to be changed.
    pub fn numbers_mut(&mut self) -> &mut [f32] {
        &mut self.numbers
    }

    /// The index of the first point of stroke `i`, among the points of all strokes.
    fn first_point(&self, i: usize) -> usize {
        i.checked_sub(1)
            .map_or(0, |before| self.outlines[before].end as usize)
    }

    /// The index of the first ring of stroke `i`, among the rings of all areas.
    fn first_ring(&self, i: usize) -> usize {
        i.checked_sub(1)
            .map_or(0, |before| self.outlines[before].rings_end as usize)
    }

    /// The index of the paint of stroke `i`, or of the next one.
    fn first_paint(&self, i: usize) -> usize {
        i.checked_sub(1)
            .map_or(0, |before| self.outlines[before].paints_end as usize)
    }

    /// The index of the line of stroke `i` among those whose width varies, or of the next one.
    fn first_sweep(&self, i: usize) -> usize {
        i.checked_sub(1)
            .map_or(0, |before| self.outlines[before].sweeps_end as usize)
    }

    /// Where the numbers of stroke `i` are.
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        // Two numbers for each point and a style for each stroke before it.
        let start = 2 * self.first_point(i) + STYLE * i;
        start..2 * self.outlines[i].end as usize + STYLE * (i + 1)
    }

    /// Stroke `i`, counted from the back.
    ///
    /// # Panics
    /// When there are not as many.
    pub fn get(&self, i: usize) -> StrokeRef<'_> {
        let Outline {
            end,
            rings_end,
            paints_end,
            sweeps_end,
            closed,
            form,
        } = self.outlines[i];
        let (points, style) = self.numbers[self.range(i)]
            .split_last_chunk()
            .unwrap_or((&[], &NO_STYLE));
        StrokeRef {
            points: points.as_chunks().0,
            kinds: &self.kinds[self.first_point(i)..end as usize],
            closed,
            rings: &self.rings[self.first_ring(i)..rings_end as usize],
            form,
            style,
            paint: self.paints[self.first_paint(i)..paints_end as usize].first(),
            sweep: self.sweeps[self.first_sweep(i)..sweeps_end as usize].first(),
        }
    }

    /// Calls `change` with every stroke.
    pub fn change(&mut self, mut change: impl FnMut(usize, StrokeMut<'_>)) {
        for i in 0..self.len() {
            let range = self.range(i);
            let is_area = self.first_ring(i) < self.outlines[i].rings_end as usize;
            let paint = self.first_paint(i)..self.outlines[i].paints_end as usize;
            let sweep = self.first_sweep(i)..self.outlines[i].sweeps_end as usize;
            if let Some((points, style)) = self.numbers[range].split_last_chunk_mut() {
                let points = points.as_chunks_mut().0;
                let stroke = StrokeMut {
                    points,
                    style,
                    is_area,
                    paint: self.paints[paint].first_mut(),
                    sweep: self.sweeps[sweep].first_mut(),
                };
                change(i, stroke);
            }
        }
    }

    /// Replaces the gradients of areas by their colours.
    pub fn flatten_paints(&mut self) {
        self.paints.clear();
        let outlines = self.outlines.iter_mut();
        // Without paints, every stroke's range of them is 0..0.
        outlines.for_each(|outline| outline.paints_end = 0);
    }

    /// The strokes, back to front.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = StrokeRef<'_>> {
        (0..self.len()).map(|i| self.get(i))
    }

    /// Adds a stroke on top.
    pub fn push(&mut self, stroke: StrokeRef<'_>) {
        self.numbers.extend(stroke.points.as_flattened());
        self.numbers.extend(stroke.style);
        self.kinds.extend(stroke.kinds);
        self.rings.extend(stroke.rings);
        self.paints.extend(stroke.paint.cloned());
        // Points of another form are no outline of the line any more.
        let sweep = stroke.sweep.filter(|_| stroke.form == Some(Form::Sweep));
        self.sweeps.extend(sweep.cloned());
        self.outlines.push(Outline {
            end: self.kinds.len() as u32,
            rings_end: self.rings.len() as u32,
            paints_end: self.paints.len() as u32,
            sweeps_end: self.sweeps.len() as u32,
            closed: stroke.closed,
            form: stroke.form,
        });
    }

    /// Adds a capsule on top.
    pub fn push_capsule(&mut self, capsule: &Params) {
        if let Some((points, style)) = capsule.split_last_chunk() {
            self.push(StrokeRef {
                points: points.as_chunks().0,
                kinds: &[PointKind::On; 2],
                closed: false,
                rings: &[],
                form: None,
                style,
                paint: None,
                sweep: None,
            });
        }
    }

    /// Adds a stroke of a scene on top.
    pub fn push_stroke(&mut self, stroke: &Stroke) {
        self.push_mark(&Mark::Stroke(stroke.clone()));
    }

    /// Adds a stroke or an area of a scene on top.
    pub fn push_mark(&mut self, mark: &Mark) {
        let form = mark.shape().map(|shape| Form::Shape(shape.kind()));
        match mark {
            // The kernel's capsules have round ends, so a stroke with square ends becomes the area within its outline.
            Mark::Stroke(stroke) if stroke.cap == Cap::Butt => {
                if let Mark::Area(rings) = mark.clone().filled() {
                    self.push_area(&rings, Some(Form::Band), None);
                }
            }
            Mark::Stroke(stroke) if stroke.is_varying() => {
                if let Mark::Area(rings) = mark.clone().filled() {
                    let sweep = Sweep::of(stroke);
                    self.push_area(&rings, Some(Form::Sweep), Some(&sweep));
                }
            }
            Mark::Stroke(stroke) => {
                let style = (stroke.radius as f32, stroke.color, stroke.opacity);
                self.push_paths(mark.paths(), &[], form, style, (None, None));
            }
            Mark::Area(area) => self.push_area(area, form, None),
        }
    }

    fn push_area(&mut self, area: &Area, form: Option<Form>, sweep: Option<&Sweep>) {
        // All rings share one list of points, so a ring is the index behind its last point.
        let ends = area.rings.iter().scan(0, |end, ring| {
            *end += ring.points().len() as u32;
            Some(*end)
        });
        let ends: Vec<u32> = ends.collect();
        let paint = area.shade.clone().map(|shade| Paint { shade, scale: 1.0 });
        let style = (0.0, area.color, area.opacity);
        let rest = (paint.as_ref(), sweep);
        self.push_paths(&area.rings, &ends, form, style, rest);
    }

    fn push_paths(
        &mut self,
        paths: &[Path],
        rings: &[u32],
        form: Option<Form>,
        (radius, [red, green, blue], opacity): (f32, Rgb, f32),
        (paint, sweep): (Option<&Paint>, Option<&Sweep>),
    ) {
        let points = || paths.iter().flat_map(Path::points);
        let places: Vec<[f32; 2]> = points().map(|p| math::xy(p.at)).collect();
        let kinds: Vec<PointKind> = points().map(|p| p.kind).collect();
        self.push(StrokeRef {
            points: &places,
            kinds: &kinds,
            closed: paths.first().is_some_and(Path::is_closed),
            rings,
            form,
            style: &[radius, red, green, blue, opacity],
            paint,
            sweep,
        });
    }

    /// Adds all of `others` on top, and leaves none there.
    pub fn append(&mut self, others: &mut Self) {
        let (points, rings) = (self.kinds.len() as u32, self.rings.len() as u32);
        let (paints, sweeps) = (self.paints.len() as u32, self.sweeps.len() as u32);
        self.numbers.append(&mut others.numbers);
        self.kinds.append(&mut others.kinds);
        self.rings.append(&mut others.rings);
        self.paints.append(&mut others.paints);
        self.sweeps.append(&mut others.sweeps);
        // Indices of `others` count from their own start.
        let outlines = others.outlines.drain(..);
        self.outlines.extend(outlines.map(|outline| Outline {
            end: outline.end + points,
            rings_end: outline.rings_end + rings,
            paints_end: outline.paints_end + paints,
            sweeps_end: outline.sweeps_end + sweeps,
            ..outline
        }));
    }

    /// Takes away the strokes from number `at` on.
    #[must_use]
    pub fn split_off(&mut self, at: usize) -> Self {
        let at = at.min(self.len());
        let (first, first_ring) = (self.first_point(at), self.first_ring(at));
        let (first_paint, first_sweep) = (self.first_paint(at), self.first_sweep(at));
        // The indices of the part split off have to count from its own start.
        let outlines = self.outlines.split_off(at).into_iter();
        Self {
            numbers: self.numbers.split_off(2 * first + STYLE * at),
            kinds: self.kinds.split_off(first),
            rings: self.rings.split_off(first_ring),
            paints: self.paints.split_off(first_paint),
            sweeps: self.sweeps.split_off(first_sweep),
            outlines: outlines
                .map(|outline| Outline {
                    end: outline.end - first as u32,
                    rings_end: outline.rings_end - first_ring as u32,
                    paints_end: outline.paints_end - first_paint as u32,
                    sweeps_end: outline.sweeps_end - first_sweep as u32,
                    ..outline
                })
                .collect(),
        }
    }

    /// Keeps the strokes for which `keep` is true.
    pub fn retain(&mut self, keep: &[bool]) {
        let kept = self.iter().zip(keep).filter(|(_, keep)| **keep);
        *self = kept.map(|(stroke, _)| stroke).collect();
    }
}

/// Look of a stroke without numbers.
static NO_STYLE: [f32; STYLE] = [0.0; STYLE];

impl<'a> FromIterator<StrokeRef<'a>> for Strokes {
    fn from_iter<I: IntoIterator<Item = StrokeRef<'a>>>(strokes: I) -> Self {
        let mut all = Self::new();
        strokes.into_iter().for_each(|stroke| all.push(stroke));
        all
    }
}

impl<'a> FromIterator<&'a Params> for Strokes {
    fn from_iter<I: IntoIterator<Item = &'a Params>>(capsules: I) -> Self {
        let mut all = Self::new();
        capsules.into_iter().for_each(|p| all.push_capsule(p));
        all
    }
}

impl FromIterator<Params> for Strokes {
    fn from_iter<I: IntoIterator<Item = Params>>(capsules: I) -> Self {
        let mut all = Self::new();
        capsules.into_iter().for_each(|p| all.push_capsule(&p));
        all
    }
}

impl<'a> FromIterator<&'a Stroke> for Strokes {
    fn from_iter<I: IntoIterator<Item = &'a Stroke>>(strokes: I) -> Self {
        let mut all = Self::new();
        strokes
            .into_iter()
            .for_each(|stroke| all.push_stroke(stroke));
        all
    }
}

impl<'a> FromIterator<&'a Mark> for Strokes {
    fn from_iter<I: IntoIterator<Item = &'a Mark>>(marks: I) -> Self {
        let mut all = Self::new();
        marks.into_iter().for_each(|mark| all.push_mark(mark));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line whose width varies, from a place on.
    fn varying(x: f64) -> Stroke {
        let points = [(x, 2.0), (x + 9.0, 5.0), (x + 14.0, 3.0)];
        let points = points.map(|p| PathPoint::on(p.into()));
        let path = Path::new(points.into(), false).unwrap();
        Stroke::varying(path, vec![0.0, 2.0, 1.0], [0.2; 3], 1.0).unwrap()
    }

    #[test]
    fn a_line_whose_width_varies_is_its_outline_and_comes_back() {
        let dot = Stroke {
            path: Path::dot((4.0, 4.0).into()),
            radii: Vec::new(),
            ..varying(0.0)
        };
        let all = [
            dot.clone(),
            varying(1.0),
            dot.clone(),
            varying(2.0),
            varying(3.0),
        ];
        let mut strokes = Strokes::from_iter(&all);
        assert!(strokes.get(1).is_area() && !strokes.get(2).is_area());
        let marks = |strokes: &Strokes| strokes.iter().map(|s| s.to_mark()).collect::<Vec<_>>();
        let given = all.clone().map(Mark::from);
        assert_eq!(marks(&strokes), given);
        // Lists are cut, joined and thinned with the lines.
        let mut rest = strokes.split_off(2);
        assert_eq!(marks(&strokes), given[..2]);
        assert_eq!(marks(&rest), given[2..]);
        strokes.append(&mut rest);
        assert_eq!(marks(&strokes), given);
        strokes.retain(&[true, false, true, false, true]);
        assert_eq!(marks(&strokes), [0, 2, 4].map(|i| given[i].clone()));
        // Colours are those of the numbers.
        strokes.change(|_, mut stroke| stroke.color_mut().fill(0.6));
        assert_eq!(strokes.get(2).to_mark().color(), [0.6; 3]);
        // Other points are no outline of the line any more.
        let edited = StrokeRef {
            form: None,
            ..strokes.get(2)
        };
        assert!(Strokes::from_iter([edited]).get(0).to_mark().is_area());
    }
}
