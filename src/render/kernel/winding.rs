//! The two sides of an area's rings in a tile: inside, where they wind around a pixel, and outside.
//!
//! Each row of pixels is scanned from the left. A segment that crosses the row adds ±1 from the first pixel behind the
//! crossing on, or from the start of the tile if it crosses before that. So the rings are looked at as a whole, however far
//! from the tile they are, and neighbouring tiles agree.

use super::super::crossings::Crossing;
use super::super::grid::{BLOCK, BLOCKS, BlockSet, Lanes, TILE, TILE_BLOCKS};

/// The sides of four pixels in a row, by the bits of those that are inside.
const SIDES: [[f32; BLOCK]; 1 << BLOCK] = {
    let mut sides = [[-1.0; BLOCK]; 1 << BLOCK];
    let mut bits = 0;
    while bits < sides.len() {
        let mut lane = 0;
        while lane < BLOCK {
            if bits >> lane & 1 == 1 {
                sides[bits][lane] = 1.0;
            }
            lane += 1;
        }
        bits += 1;
    }
    sides
};

/// On which side each pixel of a tile is, by block: 1 inside, −1 outside.
#[derive(Debug)]
pub(super) struct Windings {
    lanes: [Lanes; BLOCKS],
    /// By row: by how much the winding number grows at each pixel.
    steps: [[i32; TILE]; TILE],
    /// By row: the pixels at which it may grow.
    places: [u32; TILE],
}

impl Windings {
    pub(super) fn new() -> Self {
        Self {
            lanes: [Lanes::splat(-1.0); BLOCKS],
            steps: [[0; TILE]; TILE],
            places: [0; TILE],
        }
    }

    /// The sides of the pixels of a block of an area; a stroke has none.
    #[inline(always)]
    pub(super) fn sides(&self, is_area: bool, block: usize) -> Option<&Lanes> {
        is_area.then_some(&self.lanes[block])
    }

    /// Looks at the `crossings` of an area with the rows of the tile at `origin`, px. Returns the blocks all of whose pixels are
    /// inside.
    // Once, and not in the kernel of every instruction set and edge: its loops unroll to a lot of code.
    #[inline(never)]
    pub(super) fn fill(&mut self, crossings: &[Crossing], origin: [f32; 2]) -> BlockSet {
        for crossing in crossings {
            self.cross(crossing, origin);
        }
        let mut full = BlockSet::MAX;
        for y in 0..TILE {
            let inside = self.scan(y);
            for column in 0..TILE_BLOCKS {
                let block = y / BLOCK * TILE_BLOCKS + column;
                let bits = (inside >> (BLOCK * column)) as usize % SIDES.len();
                let lane = y % BLOCK * BLOCK;
                self.lanes[block].0[lane..lane + BLOCK].copy_from_slice(&SIDES[bits]);
                full &= !(BlockSet::from(bits + 1 != SIDES.len()) << block);
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
