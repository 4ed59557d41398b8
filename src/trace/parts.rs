//! Parts: a shape of lines and of what is much wider than those comes apart, as dots that lines join, notes on a staff and
//! heads of arrows do.
//!
//! A blob is what a disc reaches that has no room in the lines. Lines that swell or meet at a sharp angle have such places,
//! too, but there the shape narrows little by little; at a blob it does so at once.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::lines::{self, Line};
use super::shape::{Shape, connected};
use super::skeleton::Graph;
use crate::math::{distance, median};

// Numbers of blobs of shapes that are lines otherwise, whose usual radius is `r` px. All of them are guesses.
/// A disc with a radius of so many `r`, and so many px more, has room in a blob and not in lines, nor where two of those cross at
/// 60°.
const ROOM: [f32; 2] = [2.0, 0.5];
/// Within 2 px of a blob lines are thinner than so many `r`, and so many px more.
const ABRUPT: [f32; 2] = [1.25, 0.6];
/// A line is longer than so many times its width; what is shorter is a part of the blob.
const LEAST_ASPECT: f32 = 4.0;
/// Lines are as long together as this, px and in units of `r`.
const LEAST_LENGTH: [f32; 2] = [24.0, 12.0];
/// A blob is none if lines that run across cover this share of it.
pub(super) const COVERED: f32 = 0.8;

/// A part of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// Of no shape that came apart.
    Whole,
    /// The lines of a shape.
    Lines(u32),
    /// One of the blobs of all shapes.
    Blob(u32),
}

/// The parts of the shapes of a picture.
#[derive(Debug, Clone)]
pub(super) struct Parts {
    width: usize,
    /// The part of each pixel; empty if no shape came apart.
    of: Vec<Part>,
    /// The shape of each blob.
    shapes: Vec<u32>,
}

impl Parts {
    /// The parts of a picture `width` px wide in which no shape comes apart.
    pub(super) fn whole(width: usize) -> Self {
        Self {
            width,
            of: Vec::new(),
            shapes: Vec::new(),
        }
    }

    /// The parts of some shapes of a picture `width` px wide that has `count` pixels.
    pub(super) fn of(shapes: &[&Shape], width: usize, count: usize) -> Self {
        let found = shapes.par_iter().map(|shape| blobs(shape));
        let found: Vec<Vec<Option<usize>>> = found.collect();
        let mut parts = Self::whole(width);
        if found.iter().flatten().any(Option::is_some) {
            parts.of = vec![Part::Whole; count];
        }
        for (i, (shape, blobs)) in (0..).zip(shapes.iter().zip(found)) {
            if blobs.iter().all(Option::is_none) {
                continue;
            }
            // Blobs are numbered over all shapes, in the order of their first pixels.
            let mut names = vec![None; blobs.iter().flatten().fold(0, |most, &k| most.max(k + 1))];
            for (k, blob) in blobs.iter().enumerate().filter(|(k, _)| shape.inside[*k]) {
                let mut name = |blob: usize| {
                    *names[blob].get_or_insert_with(|| {
                        parts.shapes.push(i);
                        parts.shapes.len() as u32 - 1
                    })
                };
                parts.of[shape.pixel(k, width)] = match *blob {
                    Some(blob) => Part::Blob(name(blob)),
                    None => Part::Lines(i),
                };
            }
        }
        parts
    }

    /// True if no shape came apart.
    pub(super) fn are_whole(&self) -> bool {
        self.of.is_empty()
    }

    /// The part of a pixel.
    pub(super) fn at(&self, i: usize) -> Part {
        self.of.get(i).copied().unwrap_or(Part::Whole)
    }

    /// The part of a pixel, or a blob beside it.
    pub(super) fn near(&self, i: usize) -> Part {
        if self.of[i] != Part::Whole {
            return self.of[i];
        }
        let [x, y] = [i % self.width, i / self.width];
        let columns = x.saturating_sub(1)..(x + 2).min(self.width);
        let rows = y.saturating_sub(1)..(y + 2).min(self.of.len() / self.width);
        let beside = rows.flat_map(|y| columns.clone().map(move |x| y * self.width + x));
        let mut parts = beside.map(|k| self.of[k]);
        let blob = parts.find(|part| matches!(part, Part::Blob(_)));
        blob.unwrap_or(Part::Whole)
    }

    /// The number of blobs.
    pub(super) fn blobs(&self) -> usize {
        self.shapes.len()
    }

    /// The shape of a blob.
    pub(super) fn shape(&self, blob: u32) -> u32 {
        self.shapes[blob as usize]
    }

    /// Joins lines, each with its shape and its pixels, with the blobs beside them: only those, if there `may` be others and
    /// most lines of the shape are; or else the whole shape is one again.
    pub(super) fn join(&mut self, lines: Vec<(u32, Vec<usize>)>, may: bool) {
        let size_of = |shape: u32| {
            let own = self.of.iter().filter(|part| **part == Part::Lines(shape));
            own.count()
        };
        let shapes: BTreeSet<u32> = lines.iter().map(|(shape, _)| *shape).collect();
        let are_few = |shape: &u32| {
            let own = lines.iter().filter(|(of, _)| of == shape);
            2 * own.map(|(_, pixels)| pixels.len()).sum::<usize>() < size_of(*shape)
        };
        let (few, many): (Vec<u32>, Vec<u32>) =
            shapes.into_iter().partition(|shape| may && are_few(shape));
        many.into_iter().for_each(|shape| self.make_whole(shape));
        for (_, pixels) in lines.iter().filter(|(shape, _)| few.contains(shape)) {
            self.grow_blob(pixels);
        }
    }

    /// Makes one blob of some pixels and of all blobs beside them.
    fn grow_blob(&mut self, pixels: &[usize]) {
        let beside = pixels.iter().flat_map(|&i| around(self.width, i, 2));
        let blobs = beside.filter_map(|k| match self.of.get(k) {
            Some(Part::Blob(blob)) => Some(*blob),
            _ => None,
        });
        let blobs: BTreeSet<u32> = blobs.collect();
        let Some(&first) = blobs.first() else {
            return;
        };
        for part in &mut self.of {
            if matches!(part, Part::Blob(blob) if blobs.contains(blob)) {
                *part = Part::Blob(first);
            }
        }
        pixels.iter().for_each(|&i| self.of[i] = Part::Blob(first));
    }

    /// Makes a shape whole again.
    fn make_whole(&mut self, shape: u32) {
        let shapes = &self.shapes;
        let is_own = |part: &&mut Part| match **part {
            Part::Whole => false,
            Part::Lines(of) => of == shape,
            Part::Blob(blob) => shapes[blob as usize] == shape,
        };
        let own = self.of.iter_mut().filter(is_own);
        own.for_each(|part| *part = Part::Whole);
    }
}

/// The blob of each pixel of a shape's frame; none at all if the shape is one part.
fn blobs(shape: &Shape) -> Vec<Option<usize>> {
    // The nearest pixel outside is half a pixel beyond the outline.
    let depths = shape.distances2().into_iter().map(|d2| d2.sqrt() - 0.5);
    let depths: Vec<f32> = depths.collect();
    let Some(radius) = usual_radius(shape, &depths) else {
        return Vec::new();
    };
    // What a disc reaches that has no room in lines is wide.
    let Some(wide) = opened(shape, &depths, ROOM[0] * radius + ROOM[1]) else {
        return Vec::new();
    };
    let pieces = Pieces::of(shape, &wide);
    let lines = pieces.lines(radius);
    if !lines.contains(&true) {
        return Vec::new();
    }
    let thin = ABRUPT[0] * radius + ABRUPT[1];
    let mut blobs = pieces.blobs(&lines, &depths, thin);
    if !blobs.contains(&true) {
        return Vec::new();
    }
    // Where lines meet at a sharp angle, they draw what is wide there.
    let away2 = distances2_to_lines(shape, radius);
    let is_drawn = |&&i: &&usize| away2[i] <= (radius + SLACK) * (radius + SLACK);
    for (piece, is_blob) in pieces.list.iter().zip(&mut blobs) {
        let drawn = piece.members.iter().filter(is_drawn).count() as f32;
        *is_blob &= drawn < COVERED * piece.members.len() as f32;
    }
    // What sticks to a blob is a part of it.
    let blob_of = |piece: usize| {
        if pieces.list[piece].is_wide || lines[piece] {
            return blobs[piece].then_some(piece);
        }
        let members = pieces.list[piece].members.iter();
        members
            .flat_map(|&i| pieces.near(i, 1))
            .find(|&piece| blobs[piece])
    };
    let blob_of: Vec<Option<usize>> = (0..pieces.list.len()).map(blob_of).collect();
    pieces.of.iter().map(|piece| blob_of[(*piece)?]).collect()
}

/// The squared distance of each pixel of a shape's frame from the thin lines of its skeleton, px².
fn distances2_to_lines(shape: &Shape, radius: f32) -> Vec<f32> {
    let lines = lines::lines(Graph::of(shape));
    let is_thin = |line: &&Line| {
        let usual = median(line.spots.iter().map(|spot| spot.radius));
        usual.is_some_and(|usual| usual <= 1.5 * radius + 0.5)
    };
    let mut apart = Shape {
        inside: vec![true; shape.inside.len()],
        ..shape.clone()
    };
    for pair in lines
        .iter()
        .filter(is_thin)
        .flat_map(|line| line.spots.windows(2))
    {
        let [a, b] = [pair[0].at, pair[1].at];
        let steps = (2.0 * distance(a, b)).ceil().max(1.0) as usize;
        for step in 0..=steps {
            let share = step as f32 / steps as f32;
            let place = [0, 1].map(|k| a[k] + share * (b[k] - a[k]) - shape.origin[k] as f32);
            let i = place[1] as usize * shape.width + place[0] as usize;
            apart.inside[i.min(shape.inside.len() - 1)] = false;
        }
    }
    apart.distances2()
}

/// Farthest beside a traced line that its border may be, px. A guess.
const SLACK: f32 = 1.0;

/// The pieces that the border of what is wide cuts a shape into.
struct Pieces {
    /// Width of the shape's frame.
    width: usize,
    /// The piece of each pixel of the frame.
    of: Vec<Option<usize>>,
    list: Vec<Piece>,
}

/// A connected piece of a shape.
struct Piece {
    is_wide: bool,
    members: Vec<usize>,
}

impl Pieces {
    fn of(shape: &Shape, wide: &[bool]) -> Self {
        let keys = shape.inside.iter().zip(wide);
        let keys: Vec<Option<bool>> = keys.map(|(inside, wide)| inside.then_some(*wide)).collect();
        let mut of = vec![None; keys.len()];
        let mut list = Vec::new();
        for (is_wide, members) in connected(&keys, shape.width) {
            members.iter().for_each(|&i| of[i] = Some(list.len()));
            list.push(Piece { is_wide, members });
        }
        Self {
            width: shape.width,
            of,
            list,
        }
    }

    /// The pieces at most `reach` columns and rows away from a pixel, one for each pixel there.
    fn near(&self, i: usize, reach: isize) -> impl Iterator<Item = usize> + '_ {
        around(self.width, i, reach).filter_map(|k| *self.of.get(k)?)
    }

    /// True for each piece that is a line: long, and no handle of something larger. None is if they are short together.
    fn lines(&self, radius: f32) -> Vec<bool> {
        let least = (LEAST_ASPECT * 4.0 * radius * radius).max(LEAST_PIXELS);
        let is_line = |(piece, is_handle): (&Piece, bool)| {
            !piece.is_wide && piece.members.len() as f32 > least && !is_handle
        };
        let pieces = self.list.iter().zip(self.handles());
        let lines: Vec<bool> = pieces.map(is_line).collect();
        let own = self.list.iter().zip(&lines).filter(|(_, line)| **line);
        let size: usize = own.map(|(piece, _)| piece.members.len()).sum();
        let [px, radii] = LEAST_LENGTH;
        match size as f32 > 2.0 * radius * px.max(radii * radius) {
            true => lines,
            false => vec![false; lines.len()],
        }
    }

    /// True for each piece that leaves a larger one and comes back to it.
    fn handles(&self) -> Vec<bool> {
        let contact = |(i, piece): (usize, &Option<usize>)| {
            let piece = (*piece).filter(|&piece| !self.list[piece].is_wide)?;
            let beside = self.near(i, 2).find(|&other| self.list[other].is_wide)?;
            Some((piece, beside))
        };
        let contacts: Vec<_> = self.of.iter().enumerate().map(contact).collect();
        let mut seen = BTreeSet::new();
        let mut handles = vec![false; self.list.len()];
        for ((piece, other), _) in connected(&contacts, self.width) {
            let is_larger = self.list[other].members.len() > self.list[piece].members.len();
            handles[piece] |= !seen.insert((piece, other)) && is_larger;
        }
        handles
    }

    /// True for each wide piece that is a blob: lines begin there at once, and are nowhere near it as deep as `thin`.
    fn blobs(&self, lines: &[bool], depths: &[f32], thin: f32) -> Vec<bool> {
        let mut blobs: Vec<bool> = self.list.iter().map(|piece| piece.is_wide).collect();
        let lines = self.list.iter().zip(lines).filter(|(_, line)| **line);
        let members = lines.flat_map(|(piece, _)| &piece.members);
        for &i in members.filter(|&&i| depths[i] > thin) {
            self.near(i, 2).for_each(|piece| blobs[piece] = false);
        }
        blobs
    }
}

/// The pixels of a shape that discs of radius `room` reach which lie within it; `None` if there is room for none.
fn opened(shape: &Shape, depths: &[f32], room: f32) -> Option<Vec<bool>> {
    let outside = Shape {
        inside: depths.iter().map(|&depth| depth <= room).collect(),
        ..shape.clone()
    };
    if !outside.inside.contains(&false) {
        return None;
    }
    let reach = (room + 0.5) * (room + 0.5);
    let is_reached = |(d2, &inside): (f32, &bool)| inside && d2 <= reach;
    Some(
        outside
            .distances2()
            .into_iter()
            .zip(&shape.inside)
            .map(is_reached)
            .collect(),
    )
}

/// Half the width of most of a shape: the median depth of its ridges.
fn usual_radius(shape: &Shape, depths: &[f32]) -> Option<f32> {
    let is_ridge =
        |&i: &usize| shape.inside[i] && around(shape.width, i, 1).all(|k| depths[k] <= depths[i]);
    let ridges = (0..depths.len()).filter(is_ridge);
    Some(median(ridges.map(|i| depths[i]))?.max(LEAST_RADIUS))
}

/// Lines are at least as wide as this, px: depths are whole pixels. A guess.
const LEAST_RADIUS: f32 = 0.8;

/// Lines have more pixels than this. A guess.
const LEAST_PIXELS: f32 = 12.0;

/// The pixels at most `reach` columns and rows away from one of a frame.
fn around(width: usize, i: usize, reach: isize) -> impl Iterator<Item = usize> {
    let at = move |dx: isize, dy: isize| i.checked_add_signed(dy * width as isize + dx);
    (-reach..=reach).flat_map(move |dy| (-reach..=reach).filter_map(move |dx| at(dx, dy)))
}
