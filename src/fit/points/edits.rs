//! The changes of a stroke's points, each with its gain.

use super::terrain::{Cut, Terrain};
use crate::fit::recipe::Points;
use crate::render::{Knot, Piece, StrokeRef};

/// A change of one stroke's points.
#[derive(Debug, Clone)]
pub(super) struct Edit {
    /// The index of the stroke.
    pub(super) stroke: usize,
    /// Squared error that it removes; below 0 if it adds some.
    pub(super) gain: f32,
    pub(super) points: Vec<[f32; 2]>,
    pub(super) off: Vec<bool>,
    /// The former index of each point, `None` for a new one.
    pub(super) sources: Vec<Option<usize>>,
}

impl Edit {
    /// No change yet.
    fn of_none(terrain: &Terrain<'_>) -> Self {
        Self {
            stroke: terrain.index,
            gain: 0.0,
            points: terrain.stroke.points.to_vec(),
            off: terrain.stroke.off.to_vec(),
            sources: (0..terrain.stroke.points.len()).map(Some).collect(),
        }
    }

    /// `stroke`, edited.
    pub(super) fn of<'a>(&'a self, stroke: StrokeRef<'a>) -> StrokeRef<'a> {
        StrokeRef {
            points: &self.points,
            off: &self.off,
            ..stroke
        }
    }

    fn insert(&mut self, k: usize, at: [f32; 2], is_off: bool) {
        self.points.insert(k, at);
        self.off.insert(k, is_off);
        self.sources.insert(k, None);
    }

    fn remove(&mut self, k: usize) {
        self.points.remove(k);
        self.off.remove(k);
        self.sources.remove(k);
    }

    /// Whether the points make a path.
    fn is_path(&self, closed: bool) -> bool {
        let is_on = |end: Option<&bool>| end == Some(&false);
        closed || (is_on(self.off.first()) && is_on(self.off.last()))
    }
}

/// The new point that gains most.
pub(super) fn best_insertion(terrain: &Terrain<'_>, points: &Points) -> Option<Edit> {
    let cuts = terrain.pieces.iter().enumerate();
    let insertions = cuts.flat_map(|(i, &cut)| {
        let chord = Chord::of(terrain, cut.piece).filter(|chord| chord.length > points.shortest);
        chord
            .into_iter()
            .flat_map(move |chord| match cut.piece.control {
                None => within_line(terrain, cut, chord, points),
                Some(control) => Vec::from_iter(within_curve(terrain, i, control, chord, points)),
            })
    });
    best(insertions)
}

/// The point that is missed least.
pub(super) fn best_removal(terrain: &Terrain<'_>) -> Option<Edit> {
    let count = terrain.stroke.points.len();
    if count < 3 {
        return None;
    }
    let removal = |k: usize| {
        let mut edit = Edit::of_none(terrain);
        edit.remove(k);
        valued(terrain, edit, k)
    };
    best((0..count).filter_map(removal))
}

/// The point that is missed least, where an end may move.
pub(super) fn best_loss(terrain: &Terrain<'_>) -> Option<Edit> {
    best(
        [best_removal(terrain), best_retraction(terrain)]
            .into_iter()
            .flatten(),
    )
}

/// The control point beside an end that is missed least. A curve that turns back there ends where it turned.
fn best_retraction(terrain: &Terrain<'_>) -> Option<Edit> {
    let StrokeRef { off, closed, .. } = terrain.stroke;
    let count = off.len();
    if count < 3 || closed {
        return None;
    }
    let retraction = |(k, end): (usize, usize)| {
        let tip = terrain.tip(end).filter(|_| off[k])?;
        let mut edit = Edit::of_none(terrain);
        edit.points[end] = tip;
        edit.remove(k);
        valued(terrain, edit, k)
    };
    let ends = [(1, 0), (count - 2, count - 1)];
    best(ends.into_iter().filter_map(retraction))
}

/// The corner that should be smooth, or the control point that should be a corner. The path stays near the point.
pub(super) fn best_toggle(terrain: &Terrain<'_>) -> Option<Edit> {
    let StrokeRef {
        points,
        off,
        closed,
        ..
    } = terrain.stroke;
    let count = points.len();
    let toggle = |k: usize| {
        if !closed && (k == 0 || k + 1 == count) {
            return None;
        }
        let neighbours = [(k + count - 1) % count, (k + 1) % count];
        let [a, b] = neighbours.map(|i| match off[i] {
            true => [0, 1].map(|axis| 0.5 * (points[i][axis] + points[k][axis])),
            false => points[i],
        });
        let mut edit = Edit::of_none(terrain);
        // A quadratic curve is farthest from its chord at a quarter of its ends and half of its control point.
        edit.points[k] = [0, 1].map(|axis| match off[k] {
            true => 0.25 * (a[axis] + b[axis]) + 0.5 * points[k][axis],
            false => 2.0 * points[k][axis] - 0.5 * (a[axis] + b[axis]),
        });
        edit.off[k] = !off[k];
        valued(terrain, edit, k)
    };
    if count < 3 {
        return None;
    }
    best((0..count).filter_map(toggle))
}

/// The edit of point `k` with its gain, if it leaves a path.
fn valued(terrain: &Terrain<'_>, mut edit: Edit, k: usize) -> Option<Edit> {
    if !edit.is_path(terrain.stroke.closed) {
        return None;
    }
    edit.gain = terrain.gain(edit.of(terrain.stroke), k);
    Some(edit)
}

fn best(edits: impl Iterator<Item = Edit>) -> Option<Edit> {
    edits.reduce(|best, edit| if edit.gain > best.gain { edit } else { best })
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
    fn of(terrain: &Terrain<'_>, piece: Piece) -> Option<Self> {
        let points = terrain.stroke.points;
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
fn within_line(terrain: &Terrain<'_>, cut: Cut, chord: Chord, points: &Points) -> Vec<Edit> {
    let (Knot::Point(from), Knot::Point(to)) = (cut.piece.from, cut.piece.to) else {
        return Vec::new();
    };
    let at = |k: usize| k as f32 / cut.steps as f32;
    let tent = (0..=cut.steps).map(|k| 1.0 - (2.0 * at(k) - 1.0).abs());
    let parabola = (0..=cut.steps).map(|k| 2.0 * at(k) * (1.0 - at(k)));
    let most = points.reach * chord.length;
    let corner = terrain.shift(cut.first, tent, chord.across, most);
    let control = terrain.shift(cut.first, parabola, chord.across, 2.0 * most);
    let middle = [0, 1].map(|axis| 0.5 * (chord.a[axis] + chord.b[axis]));
    // The line that closes a path ends at a point before its start.
    let place = if to > from { to } else { from + 1 };
    let edit = |(shift, gain): (f32, f32), is_off: bool, worth: f32| {
        let mut edit = Edit::of_none(terrain);
        edit.insert(place, chord.moved(middle, shift), is_off);
        edit.gain = gain * worth;
        edit
    };
    vec![
        edit(corner, false, 1.0),
        edit(control, true, points.smoothness),
    ]
}

/// One more control point of curve number `i`: the curve is cut in two if both its ends are points on the path, and
/// otherwise the new one lies where it meets the next curve.
fn within_curve(
    terrain: &Terrain<'_>,
    i: usize,
    control: usize,
    chord: Chord,
    points: &Points,
) -> Option<Edit> {
    let cut = terrain.pieces[i];
    let most = points.reach * chord.length;
    let mut edit = Edit::of_none(terrain);
    match (cut.piece.from, cut.piece.to) {
        (Knot::Point(_), Knot::Point(_)) => {
            let c = terrain.stroke.points[control];
            let halves =
                [chord.a, chord.b].map(|end| [0, 1].map(|axis| 0.5 * (end[axis] + c[axis])));
            let at = |k: usize| k as f32 / cut.steps as f32;
            let first = (0..=cut.steps).map(|k| of_first_half(at(k)));
            let second = (0..=cut.steps).map(|k| of_first_half(1.0 - at(k)));
            let first = terrain.shift(cut.first, first, chord.across, most);
            let second = terrain.shift(cut.first, second, chord.across, most);
            // Both move at once, and halfway, since each counts the other's share of the slope.
            edit.points[control] = chord.moved(halves[0], 0.5 * first.0);
            edit.insert(control + 1, chord.moved(halves[1], 0.5 * second.0), true);
            edit.gain = 0.5 * (first.1 + second.1);
        }
        (_, Knot::Between(_, next)) => {
            let ahead = terrain.pieces.get(i + 1)?.steps.div_ceil(2);
            let back = cut.steps.div_ceil(2);
            let (p, q) = (terrain.stroke.points[control], terrain.stroke.points[next]);
            let along = Chord::between(p, q)?;
            let weight = |k: usize| {
                let away = match k.checked_sub(back) {
                    None => (back - k) as f32 / back as f32,
                    Some(beyond) => beyond as f32 / ahead as f32,
                };
                0.75 * (1.0 - away * away)
            };
            let weights = (0..=back + ahead).map(weight);
            let first = cut.first + cut.steps - back;
            let (shift, gain) = terrain.shift(first, weights, along.across, most);
            edit.insert(control + 1, along.moved(chord.b, shift), true);
            edit.gain = gain;
        }
        _ => return None,
    }
    Some(edit)
}

/// The share that the first of two control points, which cut a curve in two, has in the curve's point at `t`.
fn of_first_half(t: f32) -> f32 {
    if t < 0.5 {
        let s = 2.0 * t;
        2.0 * s * (1.0 - s) + 0.5 * s * s
    } else {
        let s = 2.0 - 2.0 * t;
        0.5 * s * s
    }
}
