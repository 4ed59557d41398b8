//! Aliased pictures of few colours that compression has given many.
//!
//! Of an antialiased edge a third of the pixels lie between the colours of its sides, of an aliased one none. So each pixel has one of a
//! few colours again, and the picture stairs that can be [smoothed](super::stairs).

use super::labels::{Color, Labels};
use super::noise::EDGE_RANGE;
use super::planes::Planes;

/// Largest share of the pixels of 3×3 px with an edge that lie between its sides, in the middle half of its range. Aliased pictures in
/// JPEG of quality 75 have up to 0.1, 9 of 10 up to 0.07; antialiased ones of quality 60 and 90 0.12 and more.
const MOST_BETWEEN: f32 = 0.09;
/// Side of a cell of colours that are taken as one where they are counted, levels. A guess.
const CELL: f32 = 8.0;
/// Cells of a channel.
const CELLS: usize = 32;
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
    let nearest = |pixel: usize| {
        let color = planes.planes.each_ref().map(|plane| plane[pixel]);
        let mut nearest = (0, f32::INFINITY);
        for (label, known) in (0..).zip(&palette) {
            let distance = apart(*known, color);
            if distance < nearest.1 {
                nearest = (label, distance);
            }
        }
        nearest.0
    };
    Some(Labels {
        width: planes.width,
        height: planes.height,
        of: (0..planes.planes[0].len()).map(nearest).collect(),
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
    let [mut between, mut all] = [0_usize; 2];
    for y in 1..planes.height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            let [mut low, mut high] = [f32::MAX, f32::MIN];
            for row in y - 1..=y + 1 {
                for v in &luma[row * width + x - 1..=row * width + x + 1] {
                    (low, high) = (low.min(*v), high.max(*v));
                }
            }
            let place = (luma[y * width + x] - low) / (high - low);
            let has_edge = high - low >= EDGE_RANGE;
            between += usize::from(has_edge && (0.25..0.75).contains(&place));
            all += usize::from(has_edge);
        }
    }
    // Without edges there is nothing to tell by.
    if all == 0 {
        1.0
    } else {
        between as f32 / all as f32
    }
}

/// The most common colours that lie so far apart, the most common one first.
fn palette(planes: &Planes, least_apart: f32) -> Vec<[f32; 3]> {
    // The sums of the colours of each cell, and their numbers.
    let mut cells = vec![[0.0_f64; 4]; CELLS * CELLS * CELLS];
    let count = planes.planes[0].len();
    for pixel in 0..count {
        let color = planes.planes.each_ref().map(|plane| plane[pixel]);
        // Chroma begins at −128.
        let [luma, blue, red] = [color[0], color[1] + 128.0, color[2] + 128.0]
            .map(|v| ((v / CELL) as usize).min(CELLS - 1));
        let cell = &mut cells[(luma * CELLS + blue) * CELLS + red];
        for (sum, value) in cell.iter_mut().zip([color[0], color[1], color[2], 1.0]) {
            *sum += f64::from(value);
        }
    }
    let mut palette: Vec<[f32; 3]> = Vec::new();
    while palette.len() < MOST_COLORS {
        let mut most = (LEAST_SHARE * count as f32, None);
        for [luma, blue, red, cell] in &cells {
            if *cell as f32 > most.0 {
                let color = [luma, blue, red].map(|sum| (sum / cell) as f32);
                let is_far = |known: &[f32; 3]| apart(*known, color) >= least_apart * least_apart;
                if palette.iter().all(is_far) {
                    most = (*cell as f32, Some(color));
                }
            }
        }
        match most.1 {
            Some(color) => palette.push(color),
            None => break,
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
