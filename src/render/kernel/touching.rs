//! The segments of a stroke that touch a tile.

use fearless_simd::{Level, dispatch, f32x16, prelude::*};

use super::super::crossings::is_inside;
use super::super::edge::Reach;
use super::super::grid::{LANES, TILE};
use super::super::polylines::Polylines;
use super::lanes::members;

/// A stroke that may touch a tile.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct Listed {
    pub(in crate::render) stroke: u32,
    /// The index of its first segment in the tile's list; the next stroke's segments follow.
    pub(in crate::render) first: u32,
    /// True for an area that covers the tile as a whole: the tile is inside, and no segment comes near it.
    pub(in crate::render) fills: bool,
}

/// The segments between the vertices that a vector holds, two lanes each.
const SEGMENTS: usize = LANES / 2 - 1;

/// The lanes of a vector of vertices that hold an x.
const LANES_OF_X: u64 = 0x5555;

/// Lists the segments whose bounding boxes touch the tile at `origin`, each by its first vertex, and drops strokes that have
/// none.
pub(in crate::render) fn list_segments(
    level: Level,
    polylines: &Polylines,
    origin: [f32; 2],
    reach: Reach,
    listed: &mut Vec<Listed>,
    segments: &mut Vec<u32>,
) {
    // One tile's list, built stroke by stroke in drawing order.
    segments.clear();
    let mut kept = 0;
    // Not `retain_mut`: the compiler may build its closure without the instructions of the level.
    dispatch!(level, simd => {
        let sides = Sides::new(simd, origin);
        for slot in 0..listed.len() {
            let stroke = listed[slot].stroke as usize;
            let before = segments.len();
            let first = polylines.firsts[stroke];
            let vertices = &polylines.vertices[first as usize..polylines.firsts[stroke + 1] as usize];
            // A single segment has the bounding box of its stroke, which touches the tile already.
            if vertices.len() == 2 {
                segments.push(first);
            } else if polylines.areas[stroke] {
                sides.touched(simd, vertices, reach.outside, |segment| {
                    // Of the two around the vertex between rings, one end is no number.
                    if !(vertices[segment][0] + vertices[segment + 1][0]).is_nan() {
                        segments.push(first + segment as u32);
                    }
                });
            } else {
                let margin = polylines.styles[stroke][0] + reach.outside;
                sides.touched(simd, vertices, margin, |segment| {
                    segments.push(first + segment as u32);
                });
            }
            // The list is compacted in place: strokes without a segment here drop out. An area may cover all of the tile.
            let is_far = segments.len() == before;
            let fills = is_far && polylines.areas[stroke] && {
                let crossings = polylines.crossings.of(listed[slot].stroke, origin[1]);
                is_inside(crossings, origin)
            };
            if fills || !is_far {
                listed[kept] = Listed {
                    first: before as u32,
                    fills,
                    ..listed[slot]
                };
                kept += 1;
            }
        }
    });
    listed.truncate(kept);
}

/// The sides of a tile, in lanes of x and y by turns.
struct Sides<S: Simd> {
    /// Left and top.
    low: f32x16<S>,
    /// Right and bottom.
    high: f32x16<S>,
}

impl<S: Simd> Sides<S> {
    #[inline(always)]
    fn new(simd: S, [x, y]: [f32; 2]) -> Self {
        let low: [f32; LANES] = std::array::from_fn(|lane| [x, y][lane % 2]);
        let low = f32x16::load_array_ref(simd, &low);
        Self {
            low,
            high: low + TILE as f32,
        }
    }

    /// Calls `visit` with the index of each segment of a polyline that comes within `margin` of the tile on all four sides.
    #[inline(always)]
    fn touched(&self, simd: S, vertices: &[[f32; 2]], margin: f32, mut visit: impl FnMut(usize)) {
        let mut rest = vertices.as_flattened();
        let count = vertices.len() - 1;
        for first in (0..count).step_by(SEGMENTS) {
            // Vertices are x and y by turns, as in memory. Vectors overlap by one vertex, because segments share their ends.
            let places = match rest.first_chunk() {
                Some(places) => f32x16::load_array_ref(simd, places),
                None => {
                    let mut places = [0.0; LANES];
                    places[..rest.len()].copy_from_slice(rest);
                    f32x16::load_array_ref(simd, &places)
                }
            };
            // One bit a lane: the vertex is on the inner side of left or top, and of right or bottom.
            let from_low = (places + margin).simd_gt(self.low).to_bitmask();
            let to_high = (places - margin).simd_lt(self.high).to_bitmask();
            // Of each of the four sides, one end of a segment at least has to be on the inner one.
            let [from_low, to_high] = [from_low, to_high].map(|ends| ends | ends >> 2);
            let inside = from_low & to_high;
            let present = (1 << (2 * SEGMENTS.min(count - first))) - 1;
            // Both axes have to agree: x is in the even lanes, y beside it in the odd ones.
            let touching = inside & inside >> 1 & LANES_OF_X & present;
            for bit in members(touching) {
                visit(first + bit / 2);
            }
            rest = rest.get(2 * SEGMENTS..).unwrap_or_default();
        }
    }
}
