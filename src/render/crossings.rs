//! The segments of areas that can cross a row of tiles, so that a tile looks at these alone.

use super::grid::TILE;

/// The segments of areas, by the rows of tiles that they cross.
#[derive(Debug, Default)]
pub(super) struct Crossings {
    rows: Vec<Vec<Crossing>>,
}

/// A segment of an area, px.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    area: u32,
    pub(super) ends: [[f32; 2]; 2],
}

impl Crossings {
    /// Forgets all segments, for a page of so many rows of tiles.
    pub(super) fn clear(&mut self, rows: usize) {
        self.rows.resize_with(rows, Vec::new);
        self.rows.iter_mut().for_each(Vec::clear);
    }

    /// Adds the rings of an area, whose index is above the indices of all areas before.
    pub(super) fn add(&mut self, area: u32, vertices: &[[f32; 2]]) {
        for segment in vertices.windows(2) {
            let ends @ [a, b] = [segment[0], segment[1]];
            // An end is the vertex between two rings.
            if (a[0] + a[1] + b[0] + b[1]).is_nan() {
                continue;
            }
            // The rows of tiles between the upper and the lower end. A segment is listed in each of them.
            let first = a[1].min(b[1]).max(0.0) as usize / TILE;
            // A segment above the page ends in its row −1.
            let end = (a[1].max(b[1]) / TILE as f32 + 1.0).max(0.0) as usize;
            let end = end.min(self.rows.len());
            for row in self.rows.get_mut(first..end).unwrap_or_default() {
                row.push(Crossing { area, ends });
            }
        }
    }

    /// The segments of an area that can cross the row of tiles that begins at `top`, px.
    pub(super) fn of(&self, area: u32, top: f32) -> &[Crossing] {
        let row = self.rows.get(top as usize / TILE);
        let row = row.map_or(&[][..], Vec::as_slice);
        // Areas are added in rising order, so each row's list is sorted by area.
        let [first, end] = [area, area + 1].map(|area| row.partition_point(|c| c.area < area));
        &row[first..end]
    }
}

/// True if the rings wind around the first pixel of the tile at `origin`, px.
pub(super) fn is_inside(crossings: &[Crossing], origin: [f32; 2]) -> bool {
    let senses = crossings.iter().map(|crossing| {
        // Column 0 means that the segment crosses to the left of the first pixel's centre, however far away.
        let (column, sense) = crossing.at(0, origin);
        if column == 0 { sense } else { 0 }
    });
    senses.sum::<i32>() != 0
}

impl Crossing {
    /// The first pixel of a row of a tile whose centre is beyond the segment, and the growth of the winding number there.
    #[inline(always)]
    pub(super) fn at(&self, row: usize, [left, top]: [f32; 2]) -> (usize, i32) {
        let [a, b] = self.ends;
        let y = top + row as f32 + 0.5;
        // Half open: a row through a vertex crosses the same segments as a line just below it, so no vertex counts twice. A sense
        // other than 0 also means that the ends differ in y, so the division below is safe.
        let sense = i32::from(b[1] <= y) - i32::from(a[1] <= y);
        if sense == 0 {
            return (0, 0);
        }
        let x = a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]);
        // Column k has its centre at k + ½, so ⌊x − left + ½⌋ is the first one whose centre is beyond x.
        ((x - left + 0.5).max(0.0) as usize, sense)
    }
}
