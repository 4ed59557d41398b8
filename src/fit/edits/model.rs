//! The survey around one path, a stroke or a ring of an area: the change of the squared error by a shift of its vertices.
//!
//! With the slope g and the stiffness H of each vertex, a shift δ changes the squared error by about
//! `Σ g·δ + ½ Σ H|δ|²`. The stiffness is a bound, after Gauss and Newton, so that gains are underestimated and losses
//! overestimated, as long as the shift is short.

use std::ops::Range;

use rayon::prelude::*;

use super::{Edit, written_points};
use crate::math::{self, nearest_on_segment};
use crate::render::{Form, Piece, Pieces, StrokeRef, Strokes, Survey, flattened};

/// Least segments of a line or a curve in a survey. A guess.
pub(in crate::fit) const LEAST: usize = 4;

/// One path and the survey of its vertices.
pub(in crate::fit) struct QuadraticModel<'a> {
    /// The index of the stroke or area that it belongs to.
    pub(super) mark: usize,
    /// The index among the mark's paths.
    pub(super) path: usize,
    /// True if it is a ring of an area.
    pub(in crate::fit) is_ring: bool,
    /// A stroke, or a ring of an area as one.
    pub(in crate::fit) stroke: StrokeRef<'a>,
    /// Its lines and curves, in drawing order.
    pub(super) pieces: Vec<Cut>,
    vertices: &'a [[f32; 2]],
    slopes: &'a [[f32; 2]],
    stiffness: &'a [f32],
}

/// A piece, cut into segments.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    pub(super) piece: Piece,
    /// The index of its first vertex.
    pub(super) first: usize,
    /// The number of its segments.
    pub(super) steps: usize,
}

impl<'a> QuadraticModel<'a> {
    /// The terrains of all paths whose points may come and go: of each stroke, and of each ring of an area. The points of a band
    /// come and go in pairs, so bands have none; nor have outlines of lines whose width varies, which follow from those, and paths with
    /// cubic curves or arcs, whose points stay as many and of their kinds.
    pub(in crate::fit) fn all(survey: &'a Survey, strokes: &'a Strokes) -> Vec<Self> {
        let of_mark = |mark: usize| {
            let stroke = strokes.get(mark);
            // The survey has the vertices of all paths of a mark one after the other.
            let mut first = survey.firsts[mark] as usize;
            let is_tied = matches!(stroke.form, Some(Form::Band | Form::Sweep));
            let is_fit = stroke.is_finite() && !is_tied;
            let paths = stroke.paths().enumerate().filter(move |_| is_fit);
            let paths = paths.map(move |(path, (_, points))| {
                let model = Self::new(survey, points, (mark, path, stroke.is_area()), first);
                // Between rings is a vertex that no segment has.
                first += model.vertices.len() + 1;
                model
            });
            paths.filter(|model| !model.stroke.is_mixed())
        };
        let marks = (0..strokes.len()).into_par_iter();
        marks.flat_map_iter(of_mark).collect()
    }

    /// The terrain of a path whose vertices begin with number `start` of the survey.
    fn new(
        survey: &'a Survey,
        stroke: StrokeRef<'a>,
        (mark, path, is_ring): (usize, usize, bool),
        start: usize,
    ) -> Self {
        let mut first = 0;
        let cut = |piece: Piece| {
            let steps = piece.steps(stroke, LEAST);
            first += steps;
            Cut {
                piece,
                first: first - steps,
                steps,
            }
        };
        let pieces: Vec<Cut> = Pieces::of(stroke).map(cut).collect();
        // The polyline of a dot is a segment without a length.
        let range = start..start + first.max(1) + 1;
        Self {
            mark,
            path,
            is_ring,
            stroke,
            pieces,
            vertices: &survey.vertices[range.clone()],
            slopes: &survey.slopes[range.clone()],
            stiffness: &survey.stiffness[range],
        }
    }

    /// Most points of the path in its file once it is edited.
    pub(in crate::fit) fn written_points(&self, edit: &Edit) -> usize {
        let changed = edit
            .changes
            .iter()
            .find_map(|(_, change)| change.on(self.stroke));
        written_points(changed.unwrap_or(self.stroke))
    }

    /// The best shift in the direction `across`, of at most `most` px, of the vertices from `first` on, each by its part
    /// of `weights`; and its gain.
    pub(super) fn shift(
        &self,
        first: usize,
        weights: impl Iterator<Item = f32>,
        across: [f32; 2],
        most: f32,
    ) -> (f32, f32) {
        let (mut slope, mut stiffness) = (0.0, 0.0);
        let vertices = self.slopes.iter().zip(self.stiffness).skip(first);
        // Vertices shift by w·δ along `across`: the slope in δ is Σ w·(g · across), the stiffness Σ w²·H.
        for ((g, k), w) in vertices.zip(weights) {
            slope += w * (g[0] * across[0] + g[1] * across[1]);
            stiffness += w * w * k;
        }
        // No pixel depends on these vertices, as where other marks cover them.
        if stiffness <= 0.0 {
            return (0.0, 0.0);
        }
        // The parabola slope·δ + ½ stiffness·δ² is lowest at δ = −slope / stiffness. The model holds near the path alone.
        let shift = (-slope / stiffness).clamp(-most, most);
        (shift, -(slope * shift + 0.5 * stiffness * shift * shift))
    }

    /// The vertex of the piece at an end of the stroke, point `end`, that is farthest out: from where the next piece ends.
    pub(super) fn tip(&self, end: usize) -> Option<[f32; 2]> {
        let last = self.pieces.len().checked_sub(1)?;
        let (at, from) = if end == 0 {
            let next = self.pieces[last.min(1)];
            (self.pieces[0], next.first + next.steps)
        } else {
            (self.pieces[last], self.pieces[last.saturating_sub(1)].first)
        };
        let from = self.vertices[from];
        let away2 = |v: &[f32; 2]| math::powi(v[0] - from[0], 2) + math::powi(v[1] - from[1], 2);
        let vertices = self.vertices[at.first..=at.first + at.steps].iter();
        vertices
            .max_by(|a, b| away2(a).total_cmp(&away2(b)))
            .copied()
    }

    /// Gain of changing the stroke to `changed`, if the vertices of the pieces that depend on point `k` shift to the
    /// nearest places of the new path.
    pub(super) fn gain(&self, changed: StrokeRef<'_>, k: usize) -> f32 {
        let line = Polyline(flattened(changed));
        // The first vertex is looked for from the first segment on.
        let (mut last, mut segment) = (0, 0);
        // The other pieces stay as they are, and so does their error.
        let touched = self.pieces.iter().filter(|cut| cut.piece.depends_on(k));
        let vertices = touched.flat_map(|cut| cut.first..=cut.first + cut.steps);
        let growth = |i: usize| {
            // Neighbouring vertices have neighbouring nearest places, so the search goes on from the last segment. A vertex that
            // doesn't follow on the last one begins another run of pieces, and is compared with all segments.
            let (v, g) = (self.vertices[i], self.slopes[i]);
            let to;
            (to, segment) = if i == last || i == last + 1 {
                line.nearest_from(v, segment)
            } else {
                line.nearest(v)
            };
            last = i;
            let shift = [to[0] - v[0], to[1] - v[1]];
            let length2 = shift[0] * shift[0] + shift[1] * shift[1];
            // g · δ + ½ H|δ|²
            g[0] * shift[0] + g[1] * shift[1] + 0.5 * self.stiffness[i] * length2
        };
        -vertices.map(growth).sum::<f32>()
    }
}

/// A polyline of at least two vertices.
struct Polyline(Vec<[f32; 2]>);

impl Polyline {
    fn segments(&self) -> Range<usize> {
        0..self.0.len() - 1
    }

    /// The place that is nearest to `p`, and its segment: the first of several.
    fn nearest(&self, p: [f32; 2]) -> ([f32; 2], usize) {
        let mut best = (self.nearest_of(0, p), 0);
        for at in self.segments().skip(1) {
            let found = self.nearest_of(at, p);
            if found.1 < best.0.1 {
                best = (found, at);
            }
        }
        (best.0.0, best.1)
    }

    /// The nearest place that is reached from segment `from` along the polyline without going away from `p`.
    fn nearest_from(&self, p: [f32; 2], from: usize) -> ([f32; 2], usize) {
        let mut best = (self.nearest_of(from, p), from);
        self.follow(p, from + 1..self.segments().end, &mut best);
        self.follow(p, (0..from).rev(), &mut best);
        (best.0.0, best.1)
    }

    /// Goes along the segments as long as that does not lead away from `p`.
    fn follow(
        &self,
        p: [f32; 2],
        segments: impl Iterator<Item = usize>,
        best: &mut (([f32; 2], f32), usize),
    ) {
        for at in segments {
            let found = self.nearest_of(at, p);
            // Where a segment ends the next one starts, as near to `p`.
            if found.1 > best.0.1 {
                return;
            }
            *best = (found, at);
        }
    }

    /// The place on segment `at` that is nearest to `p`, and the square of its distance.
    fn nearest_of(&self, at: usize, p: [f32; 2]) -> ([f32; 2], f32) {
        nearest_on_segment(p, [self.0[at], self.0[at + 1]])
    }
}
