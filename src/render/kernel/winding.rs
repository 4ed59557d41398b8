//! The two sides of an area's rings in a tile: inside, where they wind around a pixel, and outside.
//!
//! Each row of pixels is scanned from the left. A segment that crosses the row adds ±1 from the first pixel behind the
//! crossing on, or from the start of the tile if it crosses before that. So the rings are looked at as a whole, however far
//! from the tile they are, and neighbouring tiles agree.

use super::super::crossings::Crossing;
use super::super::grid::{BLOCK, BlockSet, TILE, TILE_BLOCKS};

/// A row of a block, one bit a pixel.
const ROW: u32 = (1 << BLOCK) - 1;

/// On which side each pixel of a tile is.
#[derive(Debug)]
pub(super) struct Windings {
    /// By row: the pixels that are inside, one bit each.
    inside: [u32; TILE],
    /// By row: growth of the winding number at each pixel.
    steps: [[i32; TILE]; TILE],
    /// By row: the pixels at which it may grow.
    places: [u32; TILE],
}

impl Windings {
    pub(super) fn new() -> Self {
        Self {
            inside: [0; TILE],
            steps: [[0; TILE]; TILE],
            places: [0; TILE],
        }
    }

    /// The pixels of a block that are inside an area, one bit each; a stroke has no sides.
    #[inline(always)]
    pub(super) fn inside(&self, is_area: bool, block: usize) -> Option<u64> {
        is_area.then(|| {
            let (row, column) = (block / TILE_BLOCKS * BLOCK, block % TILE_BLOCKS * BLOCK);
            // From the last row to the first, so that row 0 ends in the lowest bits, as in the lanes of a block.
            let rows = self.inside[row..row + BLOCK].iter().rev();
            rows.fold(0, |bits, row| {
                bits << BLOCK | u64::from(row >> column & ROW)
            })
        })
    }

    /// Looks at the `crossings` of an area with the rows of the tile at `origin`, px. Returns the blocks all of whose pixels are
    /// inside.
    // Once, and not in the kernel of every instruction set and edge: its loops unroll to a lot of code.
    #[inline(never)]
    pub(super) fn fill(&mut self, crossings: &[Crossing], origin: [f32; 2]) -> BlockSet {
        for crossing in crossings {
            self.cross(crossing, origin);
        }
        for y in 0..TILE {
            self.inside[y] = self.scan(y);
        }
        let mut full = 0;
        for (y, rows) in self.inside.chunks_exact(BLOCK).enumerate() {
            // A bit stays 1 if the column is inside in all four rows of these blocks.
            let all = rows.iter().fold(u32::MAX, |all, row| all & row);
            for x in 0..TILE_BLOCKS {
                let is_full = all >> (x * BLOCK) & ROW == ROW;
                full |= BlockSet::from(is_full) << (y * TILE_BLOCKS + x);
            }
        }
        full
    }

    /// The pixels of a row that are inside, one bit each. Its steps are 0 afterwards.
    fn scan(&mut self, row: usize) -> u32 {
        let (mut inside, mut winding) = (0_u32, 0);
        let mut places = std::mem::take(&mut self.places[row]);
        while places != 0 {
            let column = places.trailing_zeros();
            places &= places - 1;
            // The nonzero rule: a pixel is inside if the rings wind around it, in whichever sense.
            let was_inside = winding != 0;
            winding += std::mem::take(&mut self.steps[row][column as usize]);
            // From here on, all pixels are on the other side.
            if was_inside != (winding != 0) {
                inside ^= u32::MAX << column;
            }
        }
        inside
    }

    /// Adds a segment's crossings of the rows.
    fn cross(&mut self, crossing: &Crossing, origin @ [left, top]: [f32; 2]) {
        let [a, b] = crossing.ends;
        // A segment to the right of the tile steps behind its last pixel.
        if a[0].min(b[0]) >= left + TILE as f32 {
            return;
        }
        // One row more on both sides than is crossed, because of rounding: the comparisons decide.
        let first = (a[1].min(b[1]) - top - 1.0).max(0.0) as usize;
        let end = (a[1].max(b[1]) - top + 1.0).max(0.0) as usize;
        for row in first..end.min(TILE) {
            let (column, sense) = crossing.at(row, origin);
            // Those behind the tile's end are of no account.
            if let Some(step) = self.steps[row].get_mut(column) {
                *step += sense;
                self.places[row] |= 1 << column;
            }
        }
    }
}
