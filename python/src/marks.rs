//! Marks as arrays: flat columns with offsets, which are checked once and packed for the renderers.

use numpy::ndarray::ArrayView1;
use numpy::{Element, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use strokefit::math::{Point, Real};
use strokefit::render::reference;
use strokefit::render::{STYLE, StrokeRef, Strokes};
use strokefit::scene::{MAX_POINTS, Mark, Path, PathPoint};

use crate::columns::rows;
use crate::failure::Failure;

/// Points (m × 2, px), where each mark's points begin (n + 1), widths (n, px), colours (n × 3), opacities (n), which points
/// are on their path (m), which paths are closed (n), which marks are areas (n), and the points at which a further ring of an
/// area begins; for n marks of m points. The last four may be missing.
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
                off: row.off,
                closed: row.closed,
                rings: row.rings,
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
                off: row.off.to_vec(),
                closed: row.closed,
                rings: row.rings.iter().map(|&end| end as usize).collect(),
                radius,
                color: [red, green, blue],
                opacity,
            });
        })?;
        Ok(Self(strokes))
    }
}

impl PackedMarks {
    /// The marks as parts of a scene.
    pub(crate) fn marks(&self) -> impl Iterator<Item = Mark> {
        self.0.iter().map(|stroke| stroke.to_mark())
    }

    /// The derivatives `numbers`, which are in the order of [`Strokes::numbers`], as arrays.
    pub(crate) fn unpack<'py>(
        &self,
        py: Python<'py>,
        numbers: &[f32],
    ) -> PyResult<MarkGradients<'py, f32>> {
        let each = (0..self.0.len()).map(|i| &numbers[self.0.range(i)]);
        let split = each.filter_map(|own| own.split_last_chunk());
        unpacked(
            py,
            split.map(|(points, style)| (points.as_chunks().0, *style)),
        )
    }
}

impl PackedMarks64 {
    /// The derivatives of the `strokes` as arrays.
    pub(crate) fn unpack<'py>(
        py: Python<'py>,
        strokes: &[reference::Stroke],
    ) -> PyResult<MarkGradients<'py, f64>> {
        let each = strokes.iter().map(|stroke| {
            let [red, green, blue] = stroke.color;
            let style = [stroke.radius, red, green, blue, stroke.opacity];
            (stroke.points.as_slice(), style)
        });
        unpacked(py, each)
    }
}

/// One mark of the arrays.
struct Row<'a, T> {
    points: &'a [[T; 2]],
    off: &'a [bool],
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
    let (points, starts, widths, colors, opacities, on_path, closed, filled, rings) = arrays;
    finite("points", points.as_array().iter())?;
    finite("widths", widths.as_array().iter())?;
    finite("colors", colors.as_array().iter())?;
    within_one(opacities)?;
    let (points, starts) = (points.as_array(), starts.as_array());
    let (widths, colors, opacities) = (widths.as_array(), colors.as_array(), opacities.as_array());
    check_starts(&starts.to_vec(), points.nrows())?;
    let rings = rings
        .as_ref()
        .map_or_else(Vec::new, |rings| rings.as_array().to_vec());
    let mut further = Further::new(&rings);
    let [on_path, closed, filled] =
        [on_path, closed, filled].map(|flags| flags.as_ref().map(|flags| flags.as_array()));
    let is = |flags: &Option<ArrayView1<'_, bool>>, i: usize, missing: bool| {
        flags.as_ref().map_or(missing, |flags| flags[i])
    };
    let (mut places, mut off, mut ends) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..widths.len() {
        let own = starts[i] as usize..starts[i + 1] as usize;
        places.clear();
        places.extend(own.clone().map(|k| [points[[k, 0]], points[[k, 1]]]));
        off.clear();
        off.extend(own.clone().map(|k| !is(&on_path, k, true)));
        ends.clear();
        let is_area = is(&filled, i, false);
        further.ends(own.clone(), is_area, i, &mut ends)?;
        let row = Row {
            points: &places,
            off: &off,
            closed: is_area || is(&closed, i, false),
            rings: &ends,
            style: [
                if is_area {
                    T::zero()
                } else {
                    widths[i] * T::of(0.5)
                },
                colors[[i, 0]],
                colors[[i, 1]],
                colors[[i, 2]],
                opacities[i],
            ],
        };
        check_path(&row, i)?;
        push(row);
    }
    further.check()
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
        let ends_on = (row.closed && end - start > 1) || !(row.off[start] || row.off[end - 1]);
        if ends_on && end - start <= MAX_POINTS {
            continue;
        }
        // Says what is wrong.
        let point = |k: usize| PathPoint {
            at: Point::new(0.0, 0.0),
            is_on: !row.off[k],
        };
        let path = Path::new((start..end).map(point).collect(), row.closed);
        if let Err(error) = path {
            let error = error.within(format!("mark {i}"));
            return Err(Failure::Library(error).into());
        }
    }
    Ok(())
}

/// Refuses what is not finite.
fn finite<'a, T: Real>(name: &str, values: impl Iterator<Item = &'a T>) -> PyResult<()> {
    match values
        .enumerate()
        .find(|(_, value)| !value.to_f64().is_finite())
    {
        Some((i, value)) => refuse(format!(
            "{name} holds {value} (value {i} of all): give finite numbers"
        )),
        None => Ok(()),
    }
}

fn within_one<T: Element + Real>(opacities: &PyReadonlyArray1<'_, T>) -> PyResult<()> {
    let opacities = opacities.as_array();
    let all = 0.0..=1.0;
    let outside = |(_, value): &(usize, &T)| !all.contains(&value.to_f64());
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

/// Points and styles of derivatives as arrays. The derivative by a width is half of that by its radius.
fn unpacked<'py, 'a, T: Element + Real>(
    py: Python<'py>,
    each: impl Iterator<Item = (&'a [[T; 2]], [T; STYLE])>,
) -> PyResult<MarkGradients<'py, T>> {
    let (mut points, mut widths, mut colors, mut opacities) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (own, [radius, red, green, blue, opacity]) in each {
        points.extend_from_slice(own);
        widths.push(radius * T::of(0.5));
        colors.push([red, green, blue]);
        opacities.push(opacity);
    }
    Ok((
        rows(py, points)?,
        PyArray1::from_vec(py, widths),
        rows(py, colors)?,
        PyArray1::from_vec(py, opacities),
    ))
}
