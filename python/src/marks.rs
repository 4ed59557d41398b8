//! Marks as arrays: flat columns with offsets, which are checked once and packed for the renderers.

use std::borrow::Cow;

use numpy::ndarray::Dimension;
use numpy::{
    Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray, PyReadonlyArray1,
    PyReadonlyArray2,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use strokefit::math::{Point, Real};
use strokefit::render::reference;
use strokefit::render::{STYLE, StrokeRef, Strokes};
use strokefit::scene::{MAX_POINTS, Mark, Path, PathPoint, PointKind};

use crate::columns::point_kind;
use crate::failure::Failure;

/// Points (m × 2, px), where each mark's points begin (n + 1), widths (n, px), colours (n × 3), opacities (n), which points
/// are on their path (m), which paths are closed (n), which marks are areas (n), the points at which a further ring of an
/// area begins, and the kinds of points (m); for n marks of m points. The last five may be missing.
type Arrays<'py, T> = (
    PyReadonlyArray2<'py, T>,
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray1<'py, T>,
    PyReadonlyArray2<'py, T>,
    PyReadonlyArray1<'py, T>,
    Option<PyReadonlyArray1<'py, bool>>,
    Option<PyReadonlyArray1<'py, bool>>,
    Option<PyReadonlyArray1<'py, bool>>,
    Option<PyReadonlyArray1<'py, i64>>,
    Option<PyReadonlyArray1<'py, u8>>,
);

/// Derivatives by points (m × 2), widths (n), colours (n × 3) and opacities (n).
pub(crate) type MarkGradients<'py, T> = (
    Bound<'py, PyArray2<T>>,
    Bound<'py, PyArray1<T>>,
    Bound<'py, PyArray2<T>>,
    Bound<'py, PyArray1<T>>,
);

/// Marks for the renderer.
#[pyclass(frozen, module = "strokefit._native")]
pub(crate) struct PackedMarks(pub(crate) Strokes);

/// Marks for the reference renderer.
#[pyclass(frozen, module = "strokefit._native")]
pub(crate) struct PackedMarks64(pub(crate) Vec<reference::Stroke>);

#[pymethods]
impl PackedMarks {
    #[new]
    fn new(arrays: Arrays<'_, f32>) -> PyResult<Self> {
        let mut strokes = Strokes::new();
        each(&arrays, |row| {
            strokes.push(StrokeRef {
                points: row.points,
                kinds: row.kinds,
                closed: row.closed,
                rings: row.rings,
                form: None,
                paint: None,
                sweep: None,
                style: &row.style,
            });
        })?;
        Ok(Self(strokes))
    }
}

#[pymethods]
impl PackedMarks64 {
    #[new]
    fn new(arrays: Arrays<'_, f64>) -> PyResult<Self> {
        let mut strokes = Vec::new();
        each(&arrays, |row| {
            let [radius, red, green, blue, opacity] = row.style;
            strokes.push(reference::Stroke {
                points: row.points.to_vec(),
                kinds: row.kinds.to_vec(),
                closed: row.closed,
                rings: row.rings.iter().map(|&end| end as usize).collect(),
                radius,
                color: [red, green, blue],
                opacity,
                paint: None,
            });
        })?;
        Ok(Self(strokes))
    }
}

impl PackedMarks {
    /// The marks as parts of a scene.
    pub(crate) fn marks(&self) -> impl Iterator<Item = Mark> {
        self.0.iter().map(|stroke| stroke.to_mark().recognised())
    }

    /// The derivatives `numbers`, which are in the order of [`Strokes::numbers`], by kind.
    pub(crate) fn unpack(&self, numbers: &[f32]) -> Derivatives<f32> {
        let each = (0..self.0.len()).map(|i| &numbers[self.0.range(i)]);
        let split = each.filter_map(|own| own.split_last_chunk());
        let split = split.map(|(points, style)| (points.as_chunks().0, *style));
        Derivatives::of(self.0.points(), self.0.len(), split)
    }
}

impl PackedMarks64 {
    /// The derivatives of the `strokes` by kind.
    pub(crate) fn unpack(strokes: &[reference::Stroke]) -> Derivatives<f64> {
        let points = strokes.iter().map(|stroke| stroke.points.len()).sum();
        let each = strokes.iter().map(|stroke| {
            let [red, green, blue] = stroke.color;
            let style = [stroke.radius, red, green, blue, stroke.opacity];
            (stroke.points.as_slice(), style)
        });
        Derivatives::of(points, strokes.len(), each)
    }
}

/// Derivatives by kind. That by a width is half of that by its radius.
pub(crate) struct Derivatives<T> {
    points: Vec<[T; 2]>,
    widths: Vec<T>,
    colors: Vec<[T; 3]>,
    opacities: Vec<T>,
}

impl<T: Element + Real> Derivatives<T> {
    fn of<'a>(
        points: usize,
        marks: usize,
        each: impl Iterator<Item = (&'a [[T; 2]], [T; STYLE])>,
    ) -> Self {
        let mut all = Self {
            points: Vec::with_capacity(points),
            widths: Vec::with_capacity(marks),
            colors: Vec::with_capacity(marks),
            opacities: Vec::with_capacity(marks),
        };
        for (own, [radius, red, green, blue, opacity]) in each {
            all.points.extend_from_slice(own);
            all.widths.push(radius * T::of(0.5));
            all.colors.push([red, green, blue]);
            all.opacities.push(opacity);
        }
        all
    }

    /// The derivatives as arrays, which take them over.
    pub(crate) fn arrays(self, py: Python<'_>) -> PyResult<MarkGradients<'_, T>> {
        Ok((
            table(py, self.points)?,
            PyArray1::from_vec(py, self.widths),
            table(py, self.colors)?,
            PyArray1::from_vec(py, self.opacities),
        ))
    }
}

/// One row of `N` values each, which are not copied.
fn table<T: Element, const N: usize>(
    py: Python<'_>,
    rows: Vec<[T; N]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([count, N])
}

/// One mark of the arrays.
struct Row<'a, T> {
    points: &'a [[T; 2]],
    kinds: &'a [PointKind],
    closed: bool,
    /// For an area, the index behind the last point of each of its rings.
    rings: &'a [u32],
    /// Radius, red, green, blue, opacity.
    style: [T; STYLE],
}

/// Calls `push` with every mark, once it is known to be one.
fn each<T: Element + Real>(
    arrays: &Arrays<'_, T>,
    mut push: impl FnMut(Row<'_, T>),
) -> PyResult<()> {
    let (points, starts, widths, colors, opacities, on_path, closed, filled, rings, kinds) = arrays;
    let (points, colors) = (contiguous(points), contiguous(colors));
    let [widths, opacities] = [widths, opacities].map(contiguous);
    let [starts, rings] =
        [Some(starts), rings.as_ref()].map(|all| all.map(contiguous).unwrap_or_default());
    let [on_path, closed, filled] =
        [on_path, closed, filled].map(|flags| flags.as_ref().map(contiguous));
    finite("points", &points)?;
    finite("widths", &widths)?;
    finite("colors", &colors)?;
    within_one(&opacities)?;
    let (points, colors) = (points.as_chunks().0, colors.as_chunks().0);
    check_starts(&starts, points.len())?;
    let is =
        |flags: &Option<Cow<'_, [bool]>>, i: usize| flags.as_ref().is_some_and(|flags| flags[i]);
    let mut further = Further::new(&rings);
    let all_kinds = all_kinds(on_path.as_deref(), kinds.as_ref(), points.len())?;
    let mut ends = Vec::new();
    for (i, &[red, green, blue]) in colors.iter().enumerate() {
        let own = starts[i] as usize..starts[i + 1] as usize;
        let is_area = is(&filled, i);
        ends.clear();
        further.ends(own.clone(), is_area, i, &mut ends)?;
        let radius = if is_area {
            T::zero()
        } else {
            widths[i] * T::of(0.5)
        };
        let row = Row {
            points: &points[own.clone()],
            kinds: &all_kinds[own.clone()],
            closed: is_area || is(&closed, i),
            rings: &ends,
            style: [radius, red, green, blue, opacities[i]],
        };
        check_path(&row, i)?;
        push(row);
    }
    further.check()
}

/// The kinds of all points, by their numbers or by whether they are on their path.
fn all_kinds(
    on_path: Option<&[bool]>,
    kinds: Option<&PyReadonlyArray1<'_, u8>>,
    count: usize,
) -> PyResult<Vec<PointKind>> {
    let Some(kinds) = kinds else {
        let of_flags =
            |flags: &[bool]| flags.iter().map(|&is_on| PointKind::on_if(is_on)).collect();
        return Ok(on_path.map_or_else(|| vec![PointKind::On; count], of_flags));
    };
    let numbers = contiguous(kinds);
    let kinds = numbers.iter().map(|&kind| point_kind(kind));
    let kinds = kinds.collect::<PyResult<Vec<PointKind>>>()?;
    let differs = |(kind, is_on): (&PointKind, &bool)| (*kind == PointKind::On) != *is_on;
    match on_path.and_then(|flags| kinds.iter().zip(flags).position(differs)) {
        Some(k) => refuse(format!(
            "on_path[{k}] and kinds[{k}] differ: kinds is 0 for points on their path; give one of the two arrays"
        )),
        None => Ok(kinds),
    }
}

/// The values of an array in a row, which are copied if they lie otherwise.
fn contiguous<'a, T: Element + Copy, D: Dimension>(
    array: &'a PyReadonlyArray<'_, T, D>,
) -> Cow<'a, [T]> {
    // In the order of the axes: NumPy also calls columns contiguous that lie one after the other.
    match array.as_array().to_slice() {
        Some(values) => Cow::Borrowed(values),
        None => array.as_array().iter().copied().collect(),
    }
}

/// The points at which further rings begin, mark by mark.
struct Further<'a> {
    all: &'a [i64],
    next: usize,
}

impl<'a> Further<'a> {
    fn new(all: &'a [i64]) -> Self {
        Self { all, next: 0 }
    }

    /// The ends of the rings of mark `i`, which has these points, counted from its first point; none for a stroke.
    fn ends(
        &mut self,
        own: std::ops::Range<usize>,
        is_area: bool,
        i: usize,
        ends: &mut Vec<u32>,
    ) -> PyResult<()> {
        let mut last = own.start as i64;
        while let Some(&start) = self.all.get(self.next).filter(|&&at| at < own.end as i64) {
            if !is_area || start <= last {
                return refuse(format!(
                    "rings[{}] is {start}: give, in rising order, the points after its first at which a further ring of \
                     an area begins; mark {i} has the points {} to {}{}",
                    self.next,
                    own.start,
                    own.end - 1,
                    if is_area { "" } else { " and is a stroke" },
                ));
            }
            ends.push((start - own.start as i64) as u32);
            (last, self.next) = (start, self.next + 1);
        }
        if is_area {
            ends.push(own.len() as u32);
        }
        Ok(())
    }

    fn check(&self) -> PyResult<()> {
        match self.all.get(self.next) {
            Some(at) => refuse(format!(
                "rings[{}] is {at}: there are not as many points",
                self.next
            )),
            None => Ok(()),
        }
    }
}

fn check_starts(starts: &[i64], points: usize) -> PyResult<()> {
    let ends = (starts.first(), starts.last());
    if ends != (Some(&0), Some(&(points as i64))) {
        return refuse(format!(
            "starts goes from {} to {}: it has to go from 0 to {points}, the number of points",
            starts.first().unwrap_or(&0),
            starts.last().unwrap_or(&0),
        ));
    }
    match starts.windows(2).position(|pair| pair[0] >= pair[1]) {
        Some(i) => refuse(format!(
            "starts[{i}] is {} and starts[{}] is {}: every mark needs a point, so the numbers have to rise",
            starts[i],
            i + 1,
            starts[i + 1]
        )),
        None => Ok(()),
    }
}

/// Refuses what is no path.
fn check_path<T: Real>(row: &Row<'_, T>, i: usize) -> PyResult<()> {
    let start = [0]
        .into_iter()
        .chain(row.rings.iter().map(|&end| end as usize));
    let end = row.rings.iter().map(|&end| end as usize);
    let paths = start.zip(end.chain((row.rings.is_empty()).then_some(row.points.len())));
    for (start, end) in paths {
        let kinds = &row.kinds[start..end];
        let is_few = end - start <= MAX_POINTS;
        if is_few && PointKind::check(kinds, row.closed).is_ok() {
            continue;
        }
        // Says what is wrong.
        let point = |&kind: &PointKind| PathPoint {
            at: Point::ZERO,
            kind,
        };
        let path = Path::new(kinds.iter().map(point).collect(), row.closed);
        if let Err(error) = path {
            let error = error.within(format!("mark {i}"));
            return Err(Failure::Library(error).into());
        }
    }
    Ok(())
}

/// Refuses what is not finite.
fn finite<T: Real>(name: &str, values: &[T]) -> PyResult<()> {
    let is_finite = |value: &T| value.to_f64().is_finite();
    // All of them are looked at, and nothing is branched on, so that it takes vectors.
    if values
        .iter()
        .fold(true, |all, value| all & is_finite(value))
    {
        return Ok(());
    }
    let found = values
        .iter()
        .enumerate()
        .find(|(_, value)| !is_finite(value));
    found.map_or(Ok(()), |(i, value)| {
        refuse(format!(
            "{name} holds {value} (value {i} of all): give finite numbers"
        ))
    })
}

fn within_one<T: Real>(opacities: &[T]) -> PyResult<()> {
    let outside = |(_, value): &(usize, &T)| !(0.0..=1.0).contains(&value.to_f64());
    match opacities.iter().enumerate().find(outside) {
        Some((i, value)) => refuse(format!(
            "opacities[{i}] is {value}: give 0 to 1, and clamp them after each step of a descent"
        )),
        None => Ok(()),
    }
}

fn refuse<T>(message: String) -> PyResult<T> {
    Err(PyValueError::new_err(message))
}
