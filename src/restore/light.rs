//! Uneven light on paper, and its spots: a smooth field, by which a scanned or photographed page is divided. Paper keeps its own colour,
//! unless it is to be white. Light falls on what is drawn as well: what is drawn on a gradient has more tones without it.

use std::ops::Range;

use super::planes::{Planes, tones};
use crate::math::{Normal, median};

/// Numbers of a quadratic field.
const TERMS: usize = 6;

/// Luma of white.
const WHITE: f32 = 255.0;

// All of these are guesses.
/// Cells along the shorter side.
const CELLS: usize = 12;
/// Rounds in which cells without paper are left out.
const ROUNDS: usize = 4;
/// Largest relative difference of paper and the light on it.
const NEAR: f32 = 0.06;
/// As [`NEAR`], of cells, in units of the median one, and at least. Of a normal distribution 0.1 % are farther away than five times the
/// median.
const OUTLYING: f32 = 5.0;
const LEAST_NEAR: f32 = 0.004;
/// Largest relative difference of paper, without its noise, and the light on it.
const LIKE: f32 = 0.03;
/// Least share of paper in a page.
const LEAST_PAPER: f32 = 0.7;
/// What is drawn on a page has at least so many times fewer tones without the light, which falls on all of it. Of 16 clip arts in uneven
/// light it has 2.1 to 5.8 times fewer, of ink and pencil about as many; of the same clip arts on a gradient 0.15 to 0.6 times.
const FEWER_TONES: f32 = 0.8;
/// Least luma of paper, levels.
const LEAST_LUMA: f32 = 90.0;
/// Least range of the luma of paper in uneven light, levels.
const LEAST_RANGE: f32 = 12.0;
/// RMS of the luma of spots, levels. Even paper has less, and what has more is no paper.
const SPOTS: Range<f32> = 1.0..6.0;
/// Spots are cleared that differ from the paper by less than so many times their RMS.
const CLEARED: f32 = 3.0;

/// Divides a page by the light on it and clears the spots of its paper, so that this has one colour, its mean; false if the picture is
/// no page, or its paper is even.
pub(super) fn evened(planes: &mut Planes) -> bool {
    let Some(page) = Page::of(planes) else {
        return false;
    };
    let tones = page.tones(planes);
    let has_spots = SPOTS.contains(&tones[0].spread);
    if !has_spots && page.range[1] - page.range[0] < LEAST_RANGE {
        return false;
    }
    page.divide(planes);
    if has_spots {
        clear(planes, &tones);
    }
    true
}

/// Divides a page by the light on it and makes its paper white; false if the picture is no page, or its paper is white.
pub(super) fn whitened(planes: &mut Planes) -> bool {
    let Some(page) = Page::of(planes) else {
        return false;
    };
    let tones = page.tones(planes);
    let is_white = tones[0].middle > WHITE - 1.0 && page.range[1] - page.range[0] < 1.0;
    if is_white {
        return false;
    }
    page.divide(planes);
    clear(planes, &tones);
    whiten(planes, &tones);
    true
}

/// A picture that is mostly paper, which follows a smooth field of light and is bright.
struct Page {
    /// Luma of the light at each pixel.
    light: Vec<f32>,
    /// The least and the largest luma of the light, and the mean one.
    range: [f32; 2],
    mean: f32,
    /// The pixels that are paper.
    paper: Vec<usize>,
}

impl Page {
    fn of(planes: &Planes) -> Option<Self> {
        let field = Field::of(planes)?;
        let (width, height) = (planes.width, planes.height);
        let place = |i: usize| {
            let (x, y) = (i % width, i / width);
            [x as f32 / width as f32, y as f32 / height as f32]
        };
        let light: Vec<f32> = (0..width * height).map(|i| field.at(place(i))).collect();
        let wider = |[low, high]: [f32; 2], v: &f32| [low.min(*v), high.max(*v)];
        let range = light.iter().fold([f32::MAX, f32::MIN], wider);
        let mean = light.iter().sum::<f32>() / light.len() as f32;
        let luma = &planes.planes[0];
        let is_paper = |i: &usize| (luma[*i] / light[*i] - 1.0).abs() < LIKE;
        let paper: Vec<usize> = (0..light.len()).filter(is_paper).collect();
        let is_mostly_paper = paper.len() as f32 >= LEAST_PAPER * light.len() as f32;
        let page = Self {
            light,
            range,
            mean,
            paper,
        };
        let is_page =
            range[0] >= LEAST_LUMA && is_mostly_paper && page.fewer_tones(luma) >= FEWER_TONES;
        is_page.then_some(page)
    }

    /// How many times fewer tones what is drawn has without the light; 1 if nothing is drawn.
    fn fewer_tones(&self, luma: &[f32]) -> f32 {
        let mut is_drawn = vec![true; luma.len()];
        self.paper.iter().for_each(|i| is_drawn[*i] = false);
        let drawn = (0..luma.len()).filter(|i| is_drawn[*i]);
        let even = |i: usize| luma[i] * self.mean / self.light[i];
        let own = concentration(drawn.clone().map(|i| luma[i]));
        match own {
            0.0 => 1.0,
            own => concentration(drawn.map(even)) / own,
        }
    }

    /// Divides a page by its light, so that it has the mean one.
    fn divide(&self, planes: &mut Planes) {
        for plane in &mut planes.planes {
            let pixels = plane.iter_mut().zip(&self.light);
            pixels.for_each(|(value, light)| *value *= self.mean / light);
        }
    }

    /// The paper in each plane of the page, divided by the light.
    fn tones(&self, planes: &Planes) -> [Tone; 3] {
        [0, 1, 2].map(|c| self.tone(&planes.planes[c]))
    }

    fn tone(&self, plane: &[f32]) -> Tone {
        let even = |&i: &usize| plane[i] * (self.mean / self.light[i]);
        let values = || self.paper.iter().map(even);
        let middle = median(values()).unwrap_or_default();
        let away = median(values().map(|v| (v - middle).abs())).unwrap_or_default();
        Tone {
            middle,
            spread: 1.48 * away,
        }
    }
}

/// The sum of the squares of the shares of tones of four levels: one in so many, if all are as common.
fn concentration(values: impl Iterator<Item = f32>) -> f32 {
    let tones = tones(values).map(|count| count as f32);
    let all = tones.iter().sum::<f32>().max(1.0);
    tones.iter().map(|tone| (tone / all) * (tone / all)).sum()
}

/// Paper in one plane.
struct Tone {
    middle: f32,
    /// RMS of its spots, as far as the nearer half of them tells.
    spread: f32,
}

/// Gives what differs from the paper by less than [`CLEARED`] times the spread the colour of the paper. What differs by twice that keeps
/// its own, and between them colours go over into each other, so that no edge is new.
fn clear(planes: &mut Planes, paper: &[Tone; 3]) {
    const LEAST_SPREAD: f32 = 0.5;
    for i in 0..planes.planes[0].len() {
        let away = |(plane, tone): (&Vec<f32>, &Tone)| {
            (plane[i] - tone.middle).abs() / (CLEARED * tone.spread.max(LEAST_SPREAD))
        };
        let away = planes.planes.iter().zip(paper).map(away);
        let kept = (away.fold(0.0, f32::max) - 1.0).clamp(0.0, 1.0);
        for (plane, tone) in planes.planes.iter_mut().zip(paper) {
            plane[i] = tone.middle + kept * (plane[i] - tone.middle);
        }
    }
}

/// Makes the paper white, and as much lighter and less tinted what is on it.
fn whiten(planes: &mut Planes, paper: &[Tone; 3]) {
    let [luma, chromas @ ..] = &mut planes.planes;
    for (i, luma) in luma.iter_mut().enumerate() {
        let share = *luma / paper[0].middle;
        for (chroma, tone) in chromas.iter_mut().zip(&paper[1..]) {
            chroma[i] = (chroma[i] - share * tone.middle) * WHITE / paper[0].middle;
        }
        *luma = share * WHITE;
    }
}

/// A quadratic of the place, in units of the picture's sides.
struct Field([f32; TERMS]);

impl Field {
    /// The light on the paper: what the bright pixels of cells have, without cells that hold too little paper.
    fn of(planes: &Planes) -> Option<Self> {
        let mut cells = cells(planes);
        let mut field = Self::fitted(&cells)?;
        // Ink darkens cells, so that those far below the field are left out and it is fitted anew. Then those that are as far away as
        // few cells of paper are: a thing that is lighter than the paper would bend the field.
        for round in 0..2 * ROUNDS {
            let away = |(place, value): &([f32; 2], f32)| *value / field.at(*place) - 1.0;
            let usual = median(cells.iter().map(|cell| away(cell).abs())).unwrap_or_default();
            let is_near = |cell: &&([f32; 2], f32)| match round < ROUNDS {
                true => away(cell) > -NEAR,
                false => away(cell).abs() <= (OUTLYING * usual).clamp(LEAST_NEAR, NEAR),
            };
            let kept: Vec<([f32; 2], f32)> = cells.iter().filter(is_near).copied().collect();
            if (kept.len() as f32) < LEAST_PAPER * cells.len() as f32 {
                return None;
            }
            field = Self::fitted(&kept)?;
            cells = kept;
        }
        Some(field)
    }

    fn fitted(cells: &[([f32; 2], f32)]) -> Option<Self> {
        let mut equations = Normal::of(TERMS);
        for (place, value) in cells {
            let terms = terms(*place);
            let terms: [(usize, f64); TERMS] = std::array::from_fn(|k| (k, terms[k].into()));
            equations.add(&terms, [f64::from(*value)], 1.0);
        }
        let solution = equations.solve()?;
        Some(Self(std::array::from_fn(|k| solution[k][0] as f32)))
    }

    fn at(&self, place: [f32; 2]) -> f32 {
        self.0.iter().zip(terms(place)).map(|(a, b)| a * b).sum()
    }
}

fn terms([x, y]: [f32; 2]) -> [f32; TERMS] {
    [1.0, x, y, x * x, x * y, y * y]
}

/// The middles of cells, in units of the sides, and the luma that most of their brighter pixels have.
fn cells(planes: &Planes) -> Vec<([f32; 2], f32)> {
    let (width, height) = (planes.width, planes.height);
    let side = (width.min(height) / CELLS).max(1);
    let starts = |size: usize| (0..size.saturating_sub(side - 1)).step_by(side);
    let middle = |at: usize, size: usize| (at as f32 + side as f32 / 2.0) / size as f32;
    let mut cells = Vec::new();
    for y in starts(height) {
        for x in starts(width) {
            let rows = (y..y + side).flat_map(|row| &planes.planes[0][row * width + x..][..side]);
            let mut values: Vec<f32> = rows.copied().collect();
            let bright = values.len() * 3 / 4;
            let (_, value, _) = values.select_nth_unstable_by(bright, f32::total_cmp);
            cells.push(([middle(x, width), middle(y, height)], *value));
        }
    }
    cells
}
