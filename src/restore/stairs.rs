//! Stairs of pictures without antialiasing, made smooth.
//!
//! The border between two colours runs from cell to cell, a cell having its corners in the centres of four pixels. Its node
//! in each cell is free to move there, so that no pixel's centre comes to lie on its other side. Nodes move to the middle of their
//! neighbours until the border is as smooth as that allows: constrained elastic surface nets, Gibson (1998). Nodes of corners between
//! level and upright runs stay.

use rayon::prelude::*;

use super::labels::{Color, Labels};
use crate::error::Result;
use crate::image::Image;

/// Distance of smooth borders from the truth, RMS in levels beside them: of 0, 4, 8, 12, 16 and 24, with 8 drawings of six clip arts and of
/// lines come nearest to antialiased ones, in a fifth fewer bytes than with 0.
pub(super) const DOUBT: f32 = 8.0;

/// Samples of a pixel across and down.
const SAMPLES: usize = 4;

/// Most colours of a picture without antialiasing. A guess.
const MOST_COLORS: usize = 32;
/// Largest share of the pixels at borders that are unlike three of those beside them: antialiased and dithered ones are.
const MOST_LONELY: f32 = 0.1;
/// Least common side, px, of the squares that a picture is made of; their stairs are meant.
const LEAST_SQUARE: usize = 2;
/// Farthest that a border moves, px along an axis. Below 0.5 the centres of pixels keep their colours.
const REACH: f32 = 0.45;
/// Least length of the runs before and after a corner, px. Of stairs one of them has a pixel or two.
const CORNER: usize = 4;
/// Rounds of smoothing. A guess.
const ROUNDS: usize = 60;
/// Most pixels of a speck, whose border stays: smooth ones shrink to nothing. A guess.
const SPECK: usize = 8;
/// Share of specks of what a transparent picture shows from which on its stairs are meant. The difference of two screenshots has
/// 0.26; a guess.
const MOST_SPECKS: f32 = 0.1;

/// The ways to the cells above, right, below and left.
const SIDES: [[f32; 2]; 4] = [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];

/// The picture with smooth borders in the place of stairs; `None` if it has none, or its stairs are meant.
pub(super) fn smoothed(labels: &Labels) -> Result<Option<Image>> {
    if labels.colors.len() > MOST_COLORS {
        return Ok(None);
    }
    let [borders, lonely] = labels.borders();
    // Level and upright lines have no stairs to tell by, however long their borders are.
    let is_antialiased = lonely as f32 >= MOST_LONELY * borders as f32 || lonely >= labels.steps();
    if is_antialiased || labels.common_run() >= LEAST_SQUARE {
        return Ok(None);
    }
    let (specks, share) = labels.specks(SPECK);
    if labels.is_transparent() && share > MOST_SPECKS {
        return Ok(None);
    }
    let nodes = labels.nodes(&specks);
    labels.drawn(&nodes).map(Some)
}

impl Labels {
    /// The number of places where a border turns to one side, and a pixel farther on to the other one.
    fn steps(&self) -> usize {
        let [columns, rows] = self.cells();
        // The sides through which a border that turns in a cell leaves it: above or below, and right or left.
        let turn = |cell: usize| {
            let [above, right, below, left] = crossed(&self.corners(cell));
            (above != below && right != left).then_some([above, right])
        };
        let step = |cell: usize| {
            let (x, y) = (cell % columns, cell / columns);
            let [above, right] = turn(cell)?;
            // The border goes on, and on the way that it had.
            let is_step = |next: usize| turn(next) == Some([!above, !right]);
            let on = right && x + 1 < columns && is_step(cell + 1);
            let down = !above && y + 1 < rows && is_step(cell + columns);
            Some(usize::from(on) + usize::from(down))
        };
        (0..columns * rows).filter_map(step).sum()
    }

    /// The greatest common divisor of the lengths of all runs of one colour, px, those at the picture's borders left out.
    fn common_run(&self) -> usize {
        let row = |y: usize| self.of[y * self.width..(y + 1) * self.width].to_vec();
        let column = |x: usize| {
            (0..self.height)
                .map(|y| self.of[y * self.width + x])
                .collect()
        };
        let lines = (0..self.height).map(row).chain((0..self.width).map(column));
        lines.fold(0, |common, line: Vec<u16>| {
            let runs: Vec<usize> = line.chunk_by(|a, b| a == b).map(<[u16]>::len).collect();
            let inner = runs
                .get(1..runs.len().saturating_sub(1))
                .unwrap_or_default();
            inner
                .iter()
                .fold(common, |common, run| divisor(common, *run))
        })
    }

    /// The number of cells in a row, and that of rows.
    fn cells(&self) -> [usize; 2] {
        [self.width + 1, self.height + 1]
    }

    /// The labels of the corners of a cell, clockwise from the upper left one.
    fn corners(&self, cell: usize) -> [u16; 4] {
        self.corner_pixels(cell).map(|pixel| self.of[pixel])
    }

    /// The pixels in whose centres a cell has its corners, clockwise from the upper left one; outside of the picture those at
    /// its border.
    fn corner_pixels(&self, cell: usize) -> [usize; 4] {
        let columns = self.cells()[0];
        let (x, y) = ((cell % columns) as isize, (cell / columns) as isize);
        [[-1, -1], [0, -1], [0, 0], [-1, 0]].map(|[dx, dy]| self.pixel_at(x + dx, y + dy))
    }

    /// True if a border turns in a cell and runs straight on for long before and after that. A turn of stairs is followed by a short run,
    /// whatever line they stand for.
    fn is_corner(&self, cell: usize, sides: [bool; 4]) -> bool {
        let [columns, rows] = self.cells();
        let [above, right, below, left] = sides;
        let runs_on = |side: usize| {
            let on = |k: usize| {
                let [x, y] = SIDES[side].map(|step| k as isize * step as isize);
                let x = (cell % columns).checked_add_signed(x);
                let y = (cell / columns).checked_add_signed(y);
                let (x, y) = (x.filter(|x| *x < columns)?, y.filter(|y| *y < rows)?);
                let straight = std::array::from_fn(|other| other % 2 == side % 2);
                Some(crossed(&self.corners(y * columns + x)) == straight)
            };
            (1..=CORNER).all(|k| on(k) == Some(true))
        };
        let turns = above != below && left != right;
        turns && (0..4).filter(|side| sides[*side]).all(runs_on)
    }

    /// The node of each cell, relative to its middle, px.
    fn nodes(&self, specks: &[bool]) -> Vec<[f32; 2]> {
        let [columns, rows] = self.cells();
        // Cells that a border runs through, other than those of specks and of corners.
        let mut nodes = vec![[0.0_f32; 2]; columns * rows];
        let is_free = |cell: &usize| {
            self.corner_pixels(*cell)
                .iter()
                .all(|pixel| !specks[*pixel])
        };
        let borders: Vec<(usize, [bool; 4])> = (0..nodes.len())
            .filter(is_free)
            .map(|cell| (cell, crossed(&self.corners(cell))))
            .filter(|(cell, crossed)| crossed.contains(&true) && !self.is_corner(*cell, *crossed))
            .collect();
        let beside = |cell: usize| {
            let row = columns as isize;
            [-row, 1, row, -1].map(|step| {
                cell.checked_add_signed(step)
                    .filter(|c| *c < columns * rows)
            })
        };
        // Each node goes towards the middle of those that the border leads to.
        for _ in 0..ROUNDS {
            let moved: Vec<[f32; 2]> = borders
                .par_iter()
                .map(|(cell, crossed)| {
                    let mut sum = [0.0_f32; 2];
                    let mut count = 0.0;
                    for (k, other) in beside(*cell).into_iter().enumerate() {
                        if let (true, Some(other)) = (crossed[k], other) {
                            (0..2)
                                .for_each(|axis| sum[axis] += SIDES[k][axis] + nodes[other][axis]);
                            count += 1.0;
                        }
                    }
                    // An end at the picture's border stays there.
                    if count < 2.0 {
                        return nodes[*cell];
                    }
                    // Halfway, or else neighbours would swap places for ever.
                    let halfway = |k: usize| (sum[k] / count + nodes[*cell][k]) / 2.0;
                    [0, 1].map(|k| halfway(k).clamp(-REACH, REACH))
                })
                .collect();
            borders
                .iter()
                .zip(moved)
                .for_each(|((cell, _), node)| nodes[*cell] = node);
        }
        nodes
    }

    /// The picture, each pixel the mean of samples.
    fn drawn(&self, nodes: &[[f32; 2]]) -> Result<Image> {
        let rows: Vec<usize> = (0..self.height).collect();
        let of_row = |&y: &usize| {
            (0..self.width)
                .map(|x| self.pixel(x, y, nodes))
                .collect::<Vec<_>>()
        };
        let rows: Vec<Vec<Color>> = rows.par_iter().map(of_row).collect();
        let plane = |k: usize| rows.iter().flatten().map(|color| color[k]).collect();
        let picture = Image::new(self.width, self.height, [plane(0), plane(1), plane(2)])?;
        picture.with_alpha(plane(3))
    }

    /// The colour of a pixel.
    fn pixel(&self, x: usize, y: usize, nodes: &[[f32; 2]]) -> Color {
        let columns = self.cells()[0];
        let cells = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[dx, dy]| (y + dy) * columns + x + dx);
        let own = self.of[y * self.width + x];
        if cells.iter().all(|cell| self.corners(*cell) == [own; 4]) {
            return self.colors[usize::from(own)];
        }
        let mut sum = [0.0; 4];
        for j in 0..SAMPLES {
            for i in 0..SAMPLES {
                // Relative to the middle of the pixel, and of the cell that the sample lies in.
                let [u, v] = [i, j].map(|k| (k as f32 + 0.5) / SAMPLES as f32 - 0.5);
                let cell = cells[usize::from(u > 0.0) + 2 * usize::from(v > 0.0)];
                let [u, v] = [u, v].map(|w| if w > 0.0 { w - 0.5 } else { w + 0.5 });
                let color = self.colors[usize::from(self.label([u, v], cell, nodes))];
                sum.iter_mut()
                    .zip(color)
                    .for_each(|(sum, value)| *sum += value);
            }
        }
        // A transparent sample has no colour.
        let [red, green, blue, alpha] = sum;
        let own = [red, green, blue].map(|v| v / alpha.max(1.0));
        [own[0], own[1], own[2], alpha / (SAMPLES * SAMPLES) as f32]
    }

    /// The label at a place of a cell, relative to its middle.
    fn label(&self, place: [f32; 2], cell: usize, nodes: &[[f32; 2]]) -> u16 {
        let corners = self.corners(cell);
        let crossed = crossed(&corners);
        let columns = self.cells()[0] as isize;
        let node = nodes[cell];
        let ends = [-columns, 1, columns, -1].map(|step| {
            let other = cell
                .checked_add_signed(step)
                .and_then(|other| nodes.get(other));
            other.copied().unwrap_or([0.0; 2])
        });
        // Clockwise from one border to the next one, all corners have one label.
        for from in (0..4).filter(|&side| crossed[side]) {
            let next = (1..=4).map(|k| (from + k) % 4).find(|&side| crossed[side]);
            let to = next.unwrap_or(from);
            let [start, end] = [from, to].map(|side| crossing(node, ends[side], side));
            if is_between(place, node, start, end) {
                return corners[(from + 1) % 4];
            }
        }
        corners[0]
    }
}

/// The place where the border from a cell's node to that of the cell beside it leaves the cell, through the side above, right,
/// below or left. Each node is relative to the middle of its cell.
fn crossing(node: [f32; 2], other: [f32; 2], side: usize) -> [f32; 2] {
    let axis = usize::from(side.is_multiple_of(2));
    let towards = if side == 1 || side == 2 { 0.5 } else { -0.5 };
    let share = (towards - node[axis]) / (2.0 * towards + other[axis] - node[axis]);
    let along = 1 - axis;
    let mut place = [towards; 2];
    place[along] = node[along] + share * (other[along] - node[along]);
    place
}

/// True for each side of a cell, above, right, below, left, if the labels at its ends differ.
fn crossed(corners: &[u16; 4]) -> [bool; 4] {
    [[0, 1], [1, 2], [2, 3], [3, 0]].map(|[a, b]| corners[a] != corners[b])
}

/// True if a place lies in the sector at `node` that goes clockwise, y being down, from one place to another.
fn is_between(place: [f32; 2], node: [f32; 2], from: [f32; 2], to: [f32; 2]) -> bool {
    let side = |a: [f32; 2], b: [f32; 2]| {
        (a[0] - node[0]) * (b[1] - node[1]) - (a[1] - node[1]) * (b[0] - node[0])
    };
    let (after, before) = (side(from, place) >= 0.0, side(place, to) > 0.0);
    if side(from, to) >= 0.0 {
        after && before
    } else {
        after || before
    }
}

/// The greatest common divisor of two numbers; of 0 and another the other.
fn divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { divisor(b, a % b) }
}
