//! Points of the crate, which are `kurbo`'s, its elementary functions, the one door of `libm`, and least
//! squares.

mod elementary;
mod linear;
mod real;
mod search;

pub use elementary::{
    Elementary, atan, cbrt, cos, exp, exp2, hypot, ln, log2, log10, powf, sin, sin_cos, tan, tanh,
};
pub(crate) use linear::Normal;
pub use real::{Real, powi};
pub(crate) use search::search;

/// Points and displacements of the picture plane, px; x to the right, y down, pixel centres at +0.5.
pub use kurbo::{Point, Vec2};

/// The point of single-precision coordinates, as the renderer has them.
pub fn point([x, y]: [f32; 2]) -> Point {
    Point::new(x.into(), y.into())
}

/// The coordinates of a point in single precision, as the renderer has them.
pub fn xy(p: Point) -> [f32; 2] {
    [p.x as f32, p.y as f32]
}

/// The distance between two points, px.
pub(crate) fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let [x, y] = [a[0] - b[0], a[1] - b[1]];
    (x * x + y * y).sqrt()
}

/// The unit vector from one point to another.
pub(crate) fn direction(from: [f32; 2], to: [f32; 2]) -> [f32; 2] {
    let length = distance(from, to).max(f32::MIN_POSITIVE);
    [0, 1].map(|k| (to[k] - from[k]) / length)
}

/// The median of some values, the upper one of two; `None` of none.
pub(crate) fn median(values: impl Iterator<Item = f32>) -> Option<f32> {
    let mut values: Vec<f32> = values.collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f32::total_cmp).1)
}

/// The values that are equal to the most common one, which become neighbours; `None` of no values. Of equally common ones the
/// largest is taken, whatever the order.
pub(crate) fn most_common<T: Ord>(values: &mut [T]) -> Option<&[T]> {
    values.sort_unstable();
    let runs = values.chunk_by(|a, b| a == b);
    runs.max_by_key(|run| run.len())
}

/// The point of the segment from `a` to `b` that is nearest to `p`, and its squared distance.
pub(crate) fn nearest_on_segment(p: [f32; 2], [a, b]: [[f32; 2]; 2]) -> ([f32; 2], f32) {
    let axis = [b[0] - a[0], b[1] - a[1]];
    let length2 = (axis[0] * axis[0] + axis[1] * axis[1]).max(f32::MIN_POSITIVE);
    let h = ((p[0] - a[0]) * axis[0] + (p[1] - a[1]) * axis[1]) / length2;
    let h = h.clamp(0.0, 1.0);
    let q = [a[0] + h * axis[0], a[1] + h * axis[1]];
    let away = [q[0] - p[0], q[1] - p[1]];
    (q, away[0] * away[0] + away[1] * away[1])
}
