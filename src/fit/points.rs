//! Points at their price: strokes get points where that gains more than the bytes of a point cost, and lose those that
//! gain less.
//!
//! A survey tells how the squared error depends on the vertices of all strokes, each line and curve being cut in
//! [`LEAST`] segments or more: slope g and stiffness H. A shift δ of the vertices changes the squared error by about
//! `Σ g·δ + ½ Σ H δ²`. Both a new point and one that is taken away shift vertices, so that this says what each is worth,
//! and how far to move a new point:
//!
//! - Within a line, a new point on the path shifts vertices like a tent, one off the path like a parabola.
//! - A curve between two points on the path is cut in two, with a control point each.
//! - Within a spline, a control point is added between two.
//! - A point that is taken away shifts the vertices to the path without it.

use super::drawing::Drawing;
use super::session::Session;
use crate::render::{Gradients, Knot, Piece, Pieces, StrokeRef, Strokes, Survey};

/// Least segments of a line or a curve in a survey.
const LEAST: usize = 4;

pub(super) fn knob(name: &str, default: f32) -> f32 {
    std::env::var(name)
        .ok()
        .and_then(|v| v.parse().ok())
        .unwrap_or(default)
}

/// A change of one stroke's points.
#[derive(Debug, Clone)]
struct Edit {
    stroke: usize,
    /// Squared error that it removes; below 0 if it adds some.
    gain: f32,
    points: Vec<[f32; 2]>,
    off: Vec<bool>,
    /// The former index of each point, `None` for a new one.
    sources: Vec<Option<usize>>,
}

impl Edit {
    /// The number of points that are added.
    fn added(&self, stroke: StrokeRef<'_>) -> isize {
        self.points.len() as isize - stroke.points.len() as isize
    }
}

/// Changes the points of the free strokes where that pays. Returns the former index of each number of the free
/// strokes, `None` for a new one.
pub(super) fn rearrange(session: &mut Session<'_>, done: f32) -> Vec<Option<usize>> {
    let drawing = &mut session.drawing;
    let (_, survey) = drawing.survey(LEAST);
    let strokes = drawing.free();
    let count = strokes.len();
    let mean = knob("P_MEAN", 4.0);
    let share = knob("P_SHARE", 0.3);
    let most = ((mean * count as f32) as usize).max(2 * count);
    let room = most.saturating_sub(strokes.points());
    let wanted = ((share * count as f32).ceil() as usize).min(room);
    let price = knob("P_PRICE", 0.0) + session.price.of_points(1);
    let max_points = knob("P_MAX", 100.0) as usize;
    let mut additions: Vec<Edit> = Vec::new();
    let mut removals: Vec<Edit> = Vec::new();
    for i in 0..count {
        let stroke = strokes.get(i);
        if !stroke.is_finite() {
            continue;
        }
        let terrain = Terrain::new(&survey, i, stroke);
        if stroke.points.len() < max_points && done < knob("P_UNTIL", 0.85) {
            additions.extend(terrain.best_insertion().filter(|e| e.gain > price));
        }
        removals.extend(terrain.best_removal());
    }
    additions.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    removals.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let factor = knob("P_FACTOR", 1.0);
    // Removals that cost less than their price, and those that make room for better additions.
    let mut edits: Vec<Option<Edit>> = vec![None; count];
    let mut coming = additions.into_iter();
    for edit in coming.by_ref().take(wanted) {
        let i = edit.stroke;
        edits[i] = Some(edit);
    }
    let mut leaving = removals.into_iter().peekable();
    while let Some(edit) = leaving.next_if(|edit| -edit.gain < price) {
        let i = edit.stroke;
        if edits[i].is_none() {
            edits[i] = Some(edit);
        }
    }
    let swaps = (knob("P_SWAP", 0.2) * count as f32) as usize;
    if wanted == room || room == 0 {
        for (new, old) in coming.zip(leaving).take(swaps) {
            if new.gain * factor < -old.gain {
                break;
            }
            let (i, k) = (new.stroke, old.stroke);
            if i != k && edits[i].is_none() && edits[k].is_none() {
                edits[i] = Some(new);
                edits[k] = Some(old);
            }
        }
    }
    drawing.edit_points(&edits)
}

impl Drawing {
    /// The free strokes' worth and a survey of their vertices, in squared error, summed over the channels and the pixels
    /// of the picture.
    fn survey(&mut self, least: usize) -> (Gradients, Survey) {
        let (gradients, mut survey) = self.surveyed(least);
        let area = self.pixel_area();
        let values = 3.0 * self.pixels() as f32;
        // The slopes are of the mean squared error; the stiffness is of the sum at this resolution.
        survey
            .slopes
            .iter_mut()
            .flatten()
            .for_each(|v| *v *= values);
        survey.stiffness.iter_mut().for_each(|v| *v *= area);
        (gradients, survey)
    }

    fn edit_points(&mut self, edits: &[Option<Edit>]) -> Vec<Option<usize>> {
        let strokes = self.free();
        let mut edited = Strokes::new();
        let mut sources = Vec::with_capacity(strokes.numbers().len());
        for (i, stroke) in strokes.iter().enumerate() {
            let range = strokes.range(i);
            match &edits[i] {
                None => {
                    edited.push(stroke);
                    sources.extend(range.map(Some));
                }
                Some(edit) => {
                    edited.push(StrokeRef {
                        points: &edit.points,
                        off: &edit.off,
                        ..stroke
                    });
                    for source in &edit.sources {
                        let at = source.map(|k| range.start + 2 * k);
                        sources.extend([at, at.map(|at| at + 1)]);
                    }
                    let look = range.start + 2 * stroke.points.len()..range.end;
                    sources.extend(look.map(Some));
                }
            }
        }
        *self.free_mut() = edited;
        sources
    }
}

/// The survey around one stroke.
struct Terrain<'a> {
    index: usize,
    stroke: StrokeRef<'a>,
    vertices: &'a [[f32; 2]],
    slopes: &'a [[f32; 2]],
    stiffness: &'a [f32],
    /// The pieces, each with its first vertex and its number of segments.
    pieces: Vec<(Piece, usize, usize)>,
}

impl<'a> Terrain<'a> {
    fn new(survey: &'a Survey, index: usize, stroke: StrokeRef<'a>) -> Self {
        let range = survey.firsts[index] as usize..survey.firsts[index + 1] as usize;
        let mut at = 0;
        let pieces = Pieces::of(stroke).map(|piece| {
            let steps = piece.steps(stroke.points, LEAST);
            at += steps;
            (piece, at - steps, steps)
        });
        Self {
            index,
            stroke,
            pieces: pieces.collect(),
            vertices: &survey.vertices[range.clone()],
            slopes: &survey.slopes[range.clone()],
            stiffness: &survey.stiffness[range],
        }
    }

    /// The edit of the points that `f` changes.
    fn edit(
        &self,
        gain: f32,
        change: impl FnOnce(&mut Vec<[f32; 2]>, &mut Vec<bool>, &mut Vec<Option<usize>>),
    ) -> Edit {
        let mut points = self.stroke.points.to_vec();
        let mut off = self.stroke.off.to_vec();
        let mut sources: Vec<_> = (0..points.len()).map(Some).collect();
        change(&mut points, &mut off, &mut sources);
        Edit {
            stroke: self.index,
            gain,
            points,
            off,
            sources,
        }
    }

    /// The best shift across `chord` of vertices `first..` with these `weights`, and its gain.
    fn shift(&self, first: usize, weights: &[f32], across: [f32; 2], most: f32) -> (f32, f32) {
        let (mut slope, mut stiffness) = (0.0, 0.0);
        for (k, w) in weights.iter().enumerate() {
            let g = self.slopes[(first + k) % self.slopes.len()];
            slope += w * (g[0] * across[0] + g[1] * across[1]);
            stiffness += w * w * self.stiffness[(first + k) % self.slopes.len()];
        }
        if stiffness <= 0.0 {
            return (0.0, 0.0);
        }
        let shift = (-slope / stiffness).clamp(-most, most);
        (shift, -(slope * shift + 0.5 * stiffness * shift * shift))
    }

    /// The most gaining new point.
    fn best_insertion(&self) -> Option<Edit> {
        let insertions = self.pieces.iter().flat_map(|piece| self.insertions(*piece));
        insertions.max_by(|a, b| a.gain.total_cmp(&b.gain))
    }

    fn insertions(&self, (piece, first, steps): (Piece, usize, usize)) -> Vec<Edit> {
        let points = self.stroke.points;
        let (a, b) = (piece.from.place(points), piece.to.place(points));
        let chord = [b[0] - a[0], b[1] - a[1]];
        let length = (chord[0] * chord[0] + chord[1] * chord[1]).sqrt();
        if length < knob("P_LEN", 0.5) {
            return Vec::new();
        }
        let across = [-chord[1] / length, chord[0] / length];
        let most = knob("P_REACH", 0.5) * length;
        let t = |k: usize| k as f32 / steps as f32;
        let mut edits = Vec::new();
        let kind = knob("P_KIND", 3.0) as usize;
        match (piece.control, piece.from, piece.to) {
            (None, Knot::Point(from), Knot::Point(to)) => {
                let at = |shift: f32| {
                    [0, 1].map(|k| 0.5 * (a[k] + b[k]) + shift * across[k])
                };
                let place = if to == from + 1 { to } else { from + 1 };
                let tent: Vec<f32> = (0..=steps)
                    .map(|k| 1.0 - (2.0 * t(k) - 1.0).abs())
                    .collect();
                if kind & 1 == 1 {
                    let (shift, gain) = self.shift(first, &tent, across, most);
                    edits.push(self.edit(gain, |points, off, sources| {
                        points.insert(place, at(shift));
                        off.insert(place, false);
                        sources.insert(place, None);
                    }));
                }
                let bow: Vec<f32> = (0..=steps).map(|k| 2.0 * t(k) * (1.0 - t(k))).collect();
                if kind & 2 == 2 {
                    let (shift, gain) = self.shift(first, &bow, across, 2.0 * most);
                    edits.push(self.edit(gain, |points, off, sources| {
                        points.insert(place, at(shift));
                        off.insert(place, true);
                        sources.insert(place, None);
                    }));
                }
            }
            (Some(control), Knot::Point(_), Knot::Point(_)) => {
                let c = points[control];
                let halves = [a, b].map(|end| [0, 1].map(|k| 0.5 * (end[k] + c[k])));
                let near = |t: f32| {
                    if t < 0.5 {
                        let s = 2.0 * t;
                        2.0 * s * (1.0 - s) + 0.5 * s * s
                    } else {
                        let s = 2.0 - 2.0 * t;
                        0.5 * s * s
                    }
                };
                let weights = [
                    (0..=steps).map(|k| near(t(k))).collect::<Vec<_>>(),
                    (0..=steps).map(|k| near(1.0 - t(k))).collect(),
                ];
                let shifts = weights.map(|w| self.shift(first, &w, across, 0.5 * most));
                let gain = shifts[0].1 + shifts[1].1;
                edits.push(self.edit(gain, |points, off, sources| {
                    let moved = |half: [f32; 2], shift: f32| {
                        [0, 1].map(|k| half[k] + 0.5 * shift * across[k])
                    };
                    points[control] = moved(halves[0], shifts[0].0);
                    points.insert(control + 1, moved(halves[1], shifts[1].0));
                    off.insert(control + 1, true);
                    sources.insert(control + 1, None);
                }));
            }
            (Some(control), _, Knot::Between(_, next)) => {
                // A control point where the two curves meet.
                let next_steps = self
                    .pieces
                    .iter()
                    .find(|p| p.1 == (first + steps) % (self.vertices.len() - 1))
                    .map_or(LEAST, |p| p.2);
                let (back, ahead) = (steps.div_ceil(2), next_steps.div_ceil(2));
                let start = first + steps - back;
                let weights: Vec<f32> = (0..=back + ahead)
                    .map(|k| {
                        let away = if k < back {
                            (back - k) as f32 / back as f32
                        } else {
                            (k - back) as f32 / ahead as f32
                        };
                        0.75 * (1.0 - away * away)
                    })
                    .collect();
                if start + weights.len() > self.vertices.len() {
                    return edits;
                }
                let (p, q) = (points[control], points[next]);
                let chord = [q[0] - p[0], q[1] - p[1]];
                let length = (chord[0] * chord[0] + chord[1] * chord[1]).sqrt().max(1e-3);
                let across = [-chord[1] / length, chord[0] / length];
                let (shift, gain) = self.shift(start, &weights, across, most);
                edits.push(self.edit(gain, |points, off, sources| {
                    let place = control + 1;
                    points.insert(place, [0, 1].map(|k| b[k] + shift * across[k]));
                    off.insert(place, true);
                    sources.insert(place, None);
                }));
            }
            _ => {}
        }
        edits
    }

    /// The point that is missed least.
    fn best_removal(&self) -> Option<Edit> {
        let count = self.stroke.points.len();
        if count < 3 {
            return None;
        }
        let removals = (0..count).filter_map(|k| {
            let mut edit = self.edit(0.0, |points, off, sources| {
                points.remove(k);
                off.remove(k);
                sources.remove(k);
            });
            let open_end_is_off = edit.off.first() == Some(&true) || edit.off.last() == Some(&true);
            if open_end_is_off && !self.stroke.closed {
                return None;
            }
            edit.gain = -self.growth(&edit);
            Some(edit)
        });
        removals.max_by(|a, b| a.gain.total_cmp(&b.gain))
    }

    /// By how much the squared error grows when the stroke takes the points of `edit`: its vertices shift to the nearest
    /// places of the new path.
    fn growth(&self, edit: &Edit) -> f32 {
        let changed = StrokeRef {
            points: &edit.points,
            off: &edit.off,
            ..self.stroke
        };
        let line = crate::render::flattened(changed);
        let mut growth = 0.0;
        for ((v, g), h) in self.vertices.iter().zip(self.slopes).zip(self.stiffness) {
            let to = nearest(&line, *v);
            let shift = [to[0] - v[0], to[1] - v[1]];
            growth += g[0] * shift[0] + g[1] * shift[1];
            growth += 0.5 * h * (shift[0] * shift[0] + shift[1] * shift[1]);
        }
        growth
    }
}

/// The point of a polyline nearest to `p`.
fn nearest(line: &[[f32; 2]], p: [f32; 2]) -> [f32; 2] {
    let mut best = (f32::INFINITY, p);
    for pair in line.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let axis = [b[0] - a[0], b[1] - a[1]];
        let length2 = (axis[0] * axis[0] + axis[1] * axis[1]).max(1e-12);
        let h = ((p[0] - a[0]) * axis[0] + (p[1] - a[1]) * axis[1]) / length2;
        let h = h.clamp(0.0, 1.0);
        let q = [a[0] + h * axis[0], a[1] + h * axis[1]];
        let away = (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
        if away < best.0 {
            best = (away, q);
        }
    }
    best.1
}
