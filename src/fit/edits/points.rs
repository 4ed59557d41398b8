//! Edits of a path's points: one more, one less, a corner that becomes smooth or a control point that becomes a corner.

use std::ops::Range;

use super::model::{Cut, QuadraticModel};
use super::{Change, Edit};
use crate::render::{Knot, Piece, StrokeRef};
use crate::scene::PointKind;

/// Farthest that a new corner moves from its line at once, in units of the line's length.
const REACH: f32 = 0.5;
/// Lines and curves shorter than this, px, get no point.
const SHORTEST: f32 = 0.5;
/// Expected gain of a control point, in units of the gain that is found.
const SMOOTHNESS: f32 = 0.7;

/// Points of a path in the place of its own.
#[derive(Debug, Clone)]
struct Changed {
    points: Vec<[f32; 2]>,
    kinds: Vec<PointKind>,
}

impl Changed {
    fn of(path: StrokeRef<'_>) -> Self {
        Self {
            points: path.points.to_vec(),
            kinds: path.kinds.to_vec(),
        }
    }

    fn on<'a>(&'a self, path: StrokeRef<'a>) -> StrokeRef<'a> {
        StrokeRef {
            points: &self.points,
            kinds: &self.kinds,
            form: None,
            ..path
        }
    }

    fn remove(&mut self, k: usize) {
        self.points.remove(k);
        self.kinds.remove(k);
    }

    /// True if the points make a path.
    fn is_path(&self, closed: bool) -> bool {
        let is_on = |end: Option<&PointKind>| end == Some(&PointKind::On);
        closed || (is_on(self.kinds.first()) && is_on(self.kinds.last()))
    }

    /// The edit that `gain`s this much.
    fn edit(self, model: &QuadraticModel<'_>, gain: f32, price: f32) -> Edit {
        let growth = self.points.len() as isize - model.stroke.points.len() as isize;
        let change = Change::Path {
            index: model.path,
            points: self.points,
            kinds: self.kinds,
        };
        Edit {
            changes: vec![(model.mark, change)],
            gain,
            price,
            growth,
            // An edge of an area may turn its inside out. A point of a stroke need not pay at once.
            is_tried: model.is_ring,
        }
    }
}

/// A new point, before any list of points is copied for it.
#[derive(Debug, Clone, Copy)]
struct Insertion {
    gain: f32,
    /// The index of the new point.
    place: usize,
    at: [f32; 2],
    is_off: bool,
    /// The former index of a point that moves, and where to.
    moved: Option<(usize, [f32; 2])>,
}

/// The point more that gains most; it has to gain `to_add`.
pub(in crate::fit) fn add(model: &QuadraticModel<'_>, to_add: f32) -> Option<Edit> {
    let within = |(i, &cut): (usize, &Cut)| {
        let chord = Chord::of(model, cut.piece).filter(|chord| chord.length > SHORTEST);
        let insertions = chord.map(|chord| match cut.piece.control() {
            None => within_line(model, cut, chord),
            Some(control) => [within_curve(model, i, control, chord), None],
        });
        insertions.into_iter().flatten().flatten()
    };
    // A piece is passed over where the chord is too short for one more point.
    let insertions = model.pieces.iter().enumerate().flat_map(within);
    let best =
        insertions.reduce(|best, other| if other.gain > best.gain { other } else { best })?;
    let mut changed = Changed::of(model.stroke);
    // The moved point comes first: its index is the one before the insertion.
    if let Some((k, to)) = best.moved {
        changed.points[k] = to;
    }
    changed.points.insert(best.place, best.at);
    changed
        .kinds
        .insert(best.place, PointKind::on_if(!best.is_off));
    Some(changed.edit(model, best.gain, -to_add))
}

/// The point less that costs least; it spares `to_keep`. All others stay where they are.
pub(in crate::fit) fn remove(model: &QuadraticModel<'_>, to_keep: f32) -> Option<Edit> {
    let count = model.stroke.points.len();
    if count < 3 {
        return None;
    }
    best_change(model, 0..count, to_keep, |changed, k| changed.remove(k))
}

/// The point less that costs least; it spares `to_keep`. An end may move: a curve that turns back beside it ends where it
/// turned.
pub(in crate::fit) fn drop(model: &QuadraticModel<'_>, to_keep: f32) -> Option<Edit> {
    let StrokeRef { kinds, closed, .. } = model.stroke;
    let count = kinds.len();
    if count < 3 {
        return None;
    }
    // A control point beside an end may have pulled the curve beyond that end. Without it the stroke would be too short, unless
    // the end moves to where the curve was farthest out.
    let removal = remove(model, to_keep);
    let retraction = |(k, end): (usize, usize)| {
        let tip = model
            .tip(end)
            .filter(|_| kinds[k] == PointKind::Quad && !closed)?;
        best_change(model, k..k + 1, to_keep, |changed, k| {
            changed.points[end] = tip;
            changed.remove(k);
        })
    };
    let retractions = [(1, 0), (count - 2, count - 1)]
        .into_iter()
        .filter_map(retraction);
    let edits = removal.into_iter().chain(retractions);
    edits.reduce(|best, edit| if edit.gain > best.gain { edit } else { best })
}

/// The corner that should be smooth, or the control point that should be a corner. The path stays near the point.
pub(in crate::fit) fn toggle(model: &QuadraticModel<'_>, to_change: f32) -> Option<Edit> {
    let StrokeRef {
        points,
        kinds,
        closed,
        ..
    } = model.stroke;
    let count = points.len();
    if count < 3 {
        return None;
    }
    let inner = if closed { 0..count } else { 1..count - 1 };
    best_change(model, inner, -to_change, |changed, k| {
        // The curve through the point runs from a to b. Beside a control point it ends halfway; for a corner that becomes smooth,
        // this halfway place is an estimate, as the new control point moves it.
        let neighbours = [(k + count - 1) % count, (k + 1) % count];
        let [a, b] = neighbours.map(|i| match kinds[i] == PointKind::Quad {
            true => [0, 1].map(|axis| 0.5 * (points[i][axis] + points[k][axis])),
            false => points[i],
        });
        // A quadratic curve is farthest from its chord at a quarter of its ends and half of its control point.
        changed.points[k] = [0, 1].map(|axis| match kinds[k] == PointKind::Quad {
            true => 0.25 * (a[axis] + b[axis]) + 0.5 * points[k][axis],
            false => 2.0 * points[k][axis] - 0.5 * (a[axis] + b[axis]),
        });
        changed.kinds[k] = PointKind::on_if(kinds[k] != PointKind::On);
    })
}

/// The most gaining `change` of one of the points `of` that leaves a path.
fn best_change(
    model: &QuadraticModel<'_>,
    of: Range<usize>,
    price: f32,
    change: impl Fn(&mut Changed, usize),
) -> Option<Edit> {
    let mut best: Option<(f32, Changed)> = None;
    for k in of {
        let mut changed = Changed::of(model.stroke);
        change(&mut changed, k);
        // An open path has to begin and end with on-points.
        if changed.is_path(model.stroke.closed) {
            let gain = model.gain(changed.on(model.stroke), k);
            if best.as_ref().is_none_or(|(most, _)| gain > *most) {
                best = Some((gain, changed));
            }
        }
    }
    best.map(|(gain, changed)| changed.edit(model, gain, price))
}

/// The line between the knots of a piece.
#[derive(Debug, Clone, Copy)]
struct Chord {
    a: [f32; 2],
    b: [f32; 2],
    length: f32,
    /// At a right angle to the chord, of length 1.
    across: [f32; 2],
}

impl Chord {
    fn of(model: &QuadraticModel<'_>, piece: Piece) -> Option<Self> {
        let points = model.stroke.points;
        Self::between(piece.from.place(points), piece.to.place(points))
    }

    fn between(a: [f32; 2], b: [f32; 2]) -> Option<Self> {
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        let length = (x * x + y * y).sqrt();
        (length > 0.0).then(|| Self {
            a,
            b,
            length,
            across: [-y / length, x / length],
        })
    }

    /// A place moved across the chord.
    fn moved(&self, place: [f32; 2], shift: f32) -> [f32; 2] {
        [0, 1].map(|axis| place[axis] + shift * self.across[axis])
    }
}

/// A corner or a control point in the middle of a line. A corner shifts vertices like a tent, a control point like a
/// parabola.
fn within_line(model: &QuadraticModel<'_>, cut: Cut, chord: Chord) -> [Option<Insertion>; 2] {
    let (Knot::Point(from), Knot::Point(to)) = (cut.piece.from, cut.piece.to) else {
        return [None; 2];
    };
    let at = |k: usize| k as f32 / cut.steps as f32;
    // Shares of the point's shift that the line's vertices take, t = k / steps. A corner: 1 − |2t − 1|. A control point:
    // 2t(1 − t), its Bernstein polynomial.
    let tent = (0..=cut.steps).map(|k| 1.0 - (2.0 * at(k) - 1.0).abs());
    let parabola = (0..=cut.steps).map(|k| 2.0 * at(k) * (1.0 - at(k)));
    let most = REACH * chord.length;
    let corner = model.shift(cut.first, tent, chord.across, most);
    // The parabola is at most ½, so that the control point may shift twice as far for the same shift of the curve.
    let control = model.shift(cut.first, parabola, chord.across, 2.0 * most);
    let middle = [0, 1].map(|axis| 0.5 * (chord.a[axis] + chord.b[axis]));
    // The line that closes a path ends at a point before its start.
    let place = if to > from { to } else { from + 1 };
    let insertion = |(shift, gain): (f32, f32), is_off: bool, factor: f32| Insertion {
        gain: gain * factor,
        place,
        at: chord.moved(middle, shift),
        is_off,
        moved: None,
    };
    [
        Some(insertion(corner, false, 1.0)),
        Some(insertion(control, true, SMOOTHNESS)),
    ]
}

/// One more control point of curve number `i`: the curve is cut in two if both its ends are points on the path, and
/// otherwise the new one lies where it meets the next curve.
fn within_curve(
    model: &QuadraticModel<'_>,
    i: usize,
    control: usize,
    chord: Chord,
) -> Option<Insertion> {
    let cut = model.pieces[i];
    let most = REACH * chord.length;
    match (cut.piece.from, cut.piece.to) {
        // De Casteljau: the curve is the same with a control point halfway to each end, and each of them can move.
        (Knot::Point(_), Knot::Point(_)) => {
            // The curve a, c, b becomes a, (a + c)/2, (c + b)/2, b. The on-point between the halves is implied: it lies halfway.
            let c = model.stroke.points[control];
            let halves =
                [chord.a, chord.b].map(|end| [0, 1].map(|axis| 0.5 * (end[axis] + c[axis])));
            let at = |k: usize| k as f32 / cut.steps as f32;
            let first = (0..=cut.steps).map(|k| of_first_half(at(k)));
            let second = (0..=cut.steps).map(|k| of_first_half(1.0 - at(k)));
            let first = model.shift(cut.first, first, chord.across, most);
            let second = model.shift(cut.first, second, chord.across, most);
            // Both move at once, and halfway, since each counts the other's share of the slope.
            Some(Insertion {
                gain: 0.5 * (first.1 + second.1),
                place: control + 1,
                at: chord.moved(halves[1], 0.5 * second.0),
                is_off: true,
                moved: Some((control, chord.moved(halves[0], 0.5 * first.0))),
            })
        }
        // The new point pulls both curves beside the knot, most at the knot itself.
        (_, Knot::Between(_, next)) => {
            // It changes about the second half of this curve and the first half of the next one.
            let ahead = model.pieces.get(i + 1)?.steps.div_ceil(2);
            let back = cut.steps.div_ceil(2);
            let (p, q) = (model.stroke.points[control], model.stroke.points[next]);
            let along = Chord::between(p, q)?;
            let weight = |k: usize| {
                let away = match k.checked_sub(back) {
                    None => (back - k) as f32 / back as f32,
                    Some(beyond) => beyond as f32 / ahead as f32,
                };
                // Its curve ends halfway to p and to q, so its middle moves by ¼(½ + ½) + ½ = ¾ of the point's shift.
                0.75 * (1.0 - away * away)
            };
            let weights = (0..=back + ahead).map(weight);
            let first = cut.first + cut.steps - back;
            let (shift, gain) = model.shift(first, weights, along.across, most);
            Some(Insertion {
                gain,
                place: control + 1,
                at: along.moved(chord.b, shift),
                is_off: true,
                moved: None,
            })
        }
        _ => None,
    }
}

/// The share that the first of two control points, which cut a curve in two, has in the curve's point at `t`.
fn of_first_half(t: f32) -> f32 {
    // By t = ½ it is the control point of the first half, 2s(1 − s), and half of the implied point at its end, s².
    if t < 0.5 {
        let s = 2.0 * t;
        2.0 * s * (1.0 - s) + 0.5 * s * s
    } else {
        // In the second half it has a share through the implied point alone: ½(1 − s)² for s from 0 to 1.
        let s = 2.0 - 2.0 * t;
        0.5 * s * s
    }
}
