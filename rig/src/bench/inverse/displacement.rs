//! Displacement of edges: the area where two drawings differ, for each px of the edges of one.
//!
//! Both are drawn without antialiasing at four times the size of the picture. Each pixel belongs to the nearest of the
//! artist's colours, so that only edges count and slight differences of colour do not. Neighbouring shades, as those of
//! a gradient, are one colour.

use std::collections::{BTreeMap, HashMap};

use super::anatomy::crisp;
use strokefit::Result;
use strokefit::image::Image;
use strokefit::verify::{self, Size};

/// Px of the render for each px of the picture, along a side.
const SCALE: usize = 4;

/// Levels of a channel in a cell of colours. *Guess*: a gradient changes by one or two levels from px to px.
const CELL: u8 = 4;

/// Cells that are no farther apart along any channel are of one colour.
const LINKED: i16 = 2;

/// A drawing as areas of one colour each.
#[derive(Debug)]
pub(super) struct Areas {
    size: [usize; 2],
    /// Its colours, each with the number of its kind.
    palette: Vec<([u8; 3], usize)>,
    /// The kind of each px of the render.
    kinds: Vec<usize>,
    /// Length of all edges, px of the render.
    edges: f64,
}

impl Areas {
    /// The areas of SVG text in a picture of so many px, on white.
    ///
    /// # Errors
    /// As [`verify::render`].
    pub(super) fn of(svg: &str, width: usize, height: usize) -> Result<Self> {
        let size = [width * SCALE, height * SCALE];
        let pixels = drawn(svg, size)?;
        let palette = palette(&pixels);
        let kinds = nearest(&pixels, &palette);
        let edges = edges(&kinds, size);
        Ok(Self {
            size,
            palette,
            kinds,
            edges,
        })
    }

    /// Number of its colours.
    pub(super) fn colors(&self) -> usize {
        let kinds = self.palette.iter().map(|(_, kind)| kind + 1);
        kinds.max().unwrap_or_default()
    }

    /// Displacement of the edges of other SVG text from these, px of the picture; `None` where there are no edges.
    ///
    /// # Errors
    /// As [`verify::render`].
    pub(super) fn displacement_px(&self, svg: &str) -> Result<Option<f64>> {
        let others = nearest(&drawn(svg, self.size)?, &self.palette);
        let pairs = self.kinds.iter().zip(&others);
        let apart = pairs.filter(|(own, other)| own != other).count();
        let px = apart as f64 / self.edges / SCALE as f64;
        Ok((self.edges > 0.0).then_some(px))
    }
}

fn drawn(svg: &str, [width, height]: [usize; 2]) -> Result<Vec<[u8; 3]>> {
    let side = |px: usize| u32::try_from(px).unwrap_or(u32::MAX);
    let size = Size::Exact {
        width: side(width),
        height: side(height),
    };
    let picture: Image = verify::render(&crisp(svg)?, size, Some([1.0; 3]))?;
    Ok(picture.to_rgb8().as_chunks::<3>().0.to_vec())
}

/// The most frequent colour of each cell. Cells that are linked are of one kind.
fn palette(pixels: &[[u8; 3]]) -> Vec<([u8; 3], usize)> {
    let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    for &color in pixels {
        *counts.entry(color).or_default() += 1;
    }
    let mut cells: BTreeMap<[i16; 3], ([u8; 3], usize)> = BTreeMap::new();
    for (color, count) in counts {
        let cell = cells
            .entry(color.map(|level| i16::from(level / CELL)))
            .or_insert((color, 0));
        if count > cell.1 {
            *cell = (color, count);
        }
    }
    let kinds = linked(&cells);
    let colors = cells.iter().map(|(cell, &(color, _))| (color, kinds[cell]));
    colors.collect()
}

/// The number of the kind of each cell.
fn linked<T>(cells: &BTreeMap<[i16; 3], T>) -> BTreeMap<[i16; 3], usize> {
    let mut kinds: BTreeMap<[i16; 3], usize> = BTreeMap::new();
    let mut kind = 0;
    for &start in cells.keys() {
        if kinds.contains_key(&start) {
            continue;
        }
        kinds.insert(start, kind);
        let mut open = vec![start];
        while let Some(cell) = open.pop() {
            for near in around(cell) {
                if cells.contains_key(&near) && !kinds.contains_key(&near) {
                    kinds.insert(near, kind);
                    open.push(near);
                }
            }
        }
        kind += 1;
    }
    kinds
}

/// The cells that a cell is linked to, and itself.
fn around([r, g, b]: [i16; 3]) -> impl Iterator<Item = [i16; 3]> {
    let steps = || -LINKED..=LINKED;
    let pairs = steps().flat_map(move |i| steps().map(move |j| [i, j]));
    pairs.flat_map(move |[i, j]| steps().map(move |k| [r + i, g + j, b + k]))
}

/// The kind of the nearest colour for each pixel.
fn nearest(pixels: &[[u8; 3]], palette: &[([u8; 3], usize)]) -> Vec<usize> {
    let dist2 = |a: [u8; 3], b: [u8; 3]| -> i32 {
        let apart = a.iter().zip(b).map(|(&a, b)| i32::from(a) - i32::from(b));
        apart.map(|d| d * d).sum()
    };
    let mut known: HashMap<[u8; 3], usize> = HashMap::new();
    let mut kind_of = |&color: &[u8; 3]| {
        *known.entry(color).or_insert_with(|| {
            let nearest = palette.iter().min_by_key(|(own, _)| dist2(*own, color));
            nearest.map_or(0, |(_, kind)| *kind)
        })
    };
    pixels.iter().map(&mut kind_of).collect()
}

/// Length of the edges between kinds by the Cauchy–Crofton formula over four directions, which is within 5 % for a
/// straight edge of any direction: π/8 · (changes along rows and columns + changes along diagonals / √2).
fn edges(kinds: &[usize], [width, height]: [usize; 2]) -> f64 {
    let changes = |dx: usize, dy: usize| -> usize {
        let row = |y: usize| {
            let (upper, lower) = (&kinds[y * width..][..width], &kinds[(y + dy) * width..]);
            let pairs = upper.iter().zip(&lower[dx..width]);
            pairs.filter(|(a, b)| a != b).count()
        };
        (0..height - dy).map(row).sum()
    };
    let rising: usize = (0..height - 1)
        .map(|y| {
            let (upper, lower) = (&kinds[y * width + 1..], &kinds[(y + 1) * width..]);
            let pairs = upper[..width - 1].iter().zip(lower);
            pairs.filter(|(a, b)| a != b).count()
        })
        .sum();
    let straight = changes(1, 0) + changes(0, 1);
    let diagonal = changes(1, 1) + rising;
    std::f64::consts::PI / 8.0
        * (straight as f64 + diagonal as f64 * std::f64::consts::FRAC_1_SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn svg(body: &str) -> String {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="64" height="64">{body}</svg>"#)
    }

    fn square(x: f64, y: f64, fill: &str) -> String {
        svg(&format!(
            r#"<rect x="{x}" y="{y}" width="40" height="40" fill="{fill}"/>"#
        ))
    }

    fn apart(a: &str, b: &str) -> f64 {
        let areas = Areas::of(a, 64, 64).unwrap();
        areas.displacement_px(b).unwrap().unwrap()
    }

    /// Two of four sides move by half a px, or all of them; lengths of upright edges are taken for 5 % less.
    #[test]
    fn a_square_is_displaced_by_what_its_sides_move() {
        let own = square(10.0, 10.0, "#000");
        assert_eq!(apart(&own, &own), 0.0);
        let along = apart(&own, &square(10.5, 10.0, "#000"));
        assert!((0.25..0.27).contains(&along), "{along}");
        let across = apart(&own, &square(10.5, 10.5, "#000"));
        assert!((0.5..0.54).contains(&across), "{across}");
    }

    #[test]
    fn a_slightly_different_colour_is_no_displacement() {
        let (own, other) = (square(9.0, 9.0, "#000"), square(9.0, 9.0, "#333"));
        assert_eq!(apart(&own, &other), 0.0);
    }

    #[test]
    fn a_gradient_is_one_colour_and_has_no_edges() {
        let gradient = svg(
            r##"<linearGradient id="a"><stop stop-color="#f00"/><stop offset="1" stop-color="#00f"/></linearGradient><rect width="64" height="64" fill="url(#a)"/>"##,
        );
        let areas = Areas::of(&gradient, 64, 64).unwrap();
        assert_eq!((areas.colors(), areas.edges), (1, 0.0));
        assert_eq!(areas.displacement_px(&gradient).unwrap(), None);
    }

    #[test]
    fn edges_of_any_direction_have_their_length() {
        for degrees in [0.0, 20.0, 30.0, 45.0, 70.0] {
            let turned = svg(&format!(
                r#"<rect x="16" y="16" width="32" height="32" transform="rotate({degrees} 32 32)"/>"#
            ));
            let areas = Areas::of(&turned, 64, 64).unwrap();
            let share = areas.edges / (4.0 * 32.0 * SCALE as f64);
            assert!((0.93..1.05).contains(&share), "{degrees}°: {share}");
        }
    }
}
