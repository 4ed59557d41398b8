//! Aliased pictures of few colours that compression has given many.
//!
//! Of an antialiased edge a third of the pixels lie between the colours of its sides, of an aliased one none. So each pixel has one of a
//! few colours again, and the picture stairs that can be [smoothed](super::stairs).

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::labels::{Color, Labels};
use super::noise::EDGE_RANGE;
use super::planes::Planes;

/// Largest share of the pixels of 3×3 px with an edge that lie between its sides, in the middle half of its range. Aliased pictures in
/// JPEG of quality 75 have up to 0.1, 9 of 10 up to 0.07; antialiased ones of quality 60 and 90 0.12 and more.
const MOST_BETWEEN: f32 = 0.09;
/// Side of a cell of colours that are taken as one where they are counted, levels. A guess.
const CELL: f32 = 8.0;
/// Least distance of two colours, levels; and in units of the noise beside edges. Guesses.
const LEAST_APART: f32 = 16.0;
const APART: f32 = 6.0;
/// Weight of a squared difference of chroma, of which compression keeps less. Of 0.1, 0.3 and 1, with 0.3 fewest pixels of ten drawings
/// are alone among others.
const CHROMA: f32 = 0.3;
/// Least share of the pixels that a colour has. A guess.
const LEAST_SHARE: f32 = 0.0005;
/// Most colours. A guess.
const MOST_COLORS: usize = 32;

/// The colours of an aliased picture that has some `noise` beside edges, levels; `None` of an antialiased one.
pub(super) fn labels(planes: &Planes, noise: f32) -> Option<Labels> {
    if planes.alpha.is_some() || between(planes) > MOST_BETWEEN {
        return None;
    }
    let palette = palette(planes, LEAST_APART.max(APART * noise));
    let of = (0..planes.planes[0].len()).into_par_iter().map(|pixel| {
        let color = planes.planes.each_ref().map(|plane| plane[pixel]);
        let nearest = (0..palette.len())
            .min_by(|a, b| apart(palette[*a], color).total_cmp(&apart(palette[*b], color)));
        nearest.unwrap_or(0) as u16
    });
    Some(Labels {
        width: planes.width,
        height: planes.height,
        of: of.collect(),
        colors: colors(&palette)?,
    })
}

/// The colours of a palette.
fn colors(palette: &[[f32; 3]]) -> Option<Vec<Color>> {
    let row = Planes {
        width: palette.len(),
        height: 1,
        planes: [0, 1, 2].map(|k| palette.iter().map(|color| color[k]).collect()),
        alpha: None,
    };
    let row = row.image().ok()?;
    let [red, green, blue] = row.planes();
    let colors = red.iter().zip(green).zip(blue);
    Some(colors.map(|((r, g), b)| [*r, *g, *b, 1.0]).collect())
}

/// The share of the pixels beside edges that lie between the sides.
fn between(planes: &Planes) -> f32 {
    let (luma, width) = (&planes.planes[0], planes.width);
    let rows: Vec<&[f32]> = luma.chunks_exact(width).collect();
    let of_rows = |rows: &[&[f32]]| {
        let mut counts = [0_usize; 2];
        for x in 1..width.saturating_sub(1) {
            let around = rows.iter().flat_map(|row| &row[x - 1..=x + 1]);
            let [low, high] = around.fold([f32::MAX, f32::MIN], |[low, high], v| {
                [low.min(*v), high.max(*v)]
            });
            let range = high - low;
            let place = (rows[1][x] - low) / range;
            counts[0] += usize::from(range >= EDGE_RANGE && (0.25..0.75).contains(&place));
            counts[1] += usize::from(range >= EDGE_RANGE);
        }
        counts
    };
    let sum = |a: [usize; 2], b: [usize; 2]| [a[0] + b[0], a[1] + b[1]];
    let [between, all] = rows.par_windows(3).map(of_rows).reduce(|| [0; 2], sum);
    // Without edges there is nothing to tell by.
    if all == 0 {
        1.0
    } else {
        between as f32 / all as f32
    }
}

/// The most common colours that lie so far apart, the most common one first.
fn palette(planes: &Planes, least_apart: f32) -> Vec<[f32; 3]> {
    let count = planes.planes[0].len();
    let mut cells: BTreeMap<[i32; 3], ([f64; 3], usize)> = BTreeMap::new();
    for pixel in 0..count {
        let color = planes.planes.each_ref().map(|plane| plane[pixel]);
        let (sum, count) = cells
            .entry(color.map(|v| (v / CELL).round() as i32))
            .or_default();
        sum.iter_mut()
            .zip(color)
            .for_each(|(sum, v)| *sum += f64::from(v));
        *count += 1;
    }
    let mut cells: Vec<_> = cells.into_values().collect();
    cells.sort_by_key(|(_, count)| usize::MAX - count);
    let mut palette: Vec<[f32; 3]> = Vec::new();
    for (sum, cell) in cells {
        let color = sum.map(|sum| (sum / cell as f64) as f32);
        let is_new = palette
            .iter()
            .all(|known| apart(*known, color) >= least_apart * least_apart);
        if is_new && cell as f32 >= LEAST_SHARE * count as f32 && palette.len() < MOST_COLORS {
            palette.push(color);
        }
    }
    palette
}

/// The square of the distance of two colours, levels.
fn apart(a: [f32; 3], b: [f32; 3]) -> f32 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    let weighted = squares.zip([1.0, CHROMA, CHROMA]);
    weighted.map(|(square, weight)| weight * square).sum()
}
