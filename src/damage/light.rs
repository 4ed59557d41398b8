//! Uneven light on paper, and its spots: a smooth field, by which a scanned or photographed page is divided.

use super::planes::Planes;
use super::recipe::Light;
use crate::math;

/// Numbers of a quadratic field.
const TERMS: usize = 6;

/// Luma of white.
const WHITE: f32 = 255.0;

/// Divides a page by the light on it and clears the spots of its paper, so that this has one colour, which is white if it is nearly
/// white; false if the picture is no
/// page, or its paper is even.
pub(super) fn evened(planes: &mut Planes, recipe: &Light) -> bool {
    let Some(field) = Field::of(planes, recipe) else {
        return false;
    };
    let (width, height) = (planes.width, planes.height);
    let light: Vec<f32> = (0..width * height)
        .map(|i| {
            field.at([
                (i % width) as f32 / width as f32,
                (i / width) as f32 / height as f32,
            ])
        })
        .collect();
    let [low, high] = light.iter().fold([f32::MAX, f32::MIN], |[low, high], v| {
        [low.min(*v), high.max(*v)]
    });
    // A page is mostly paper that follows the field, and bright.
    let luma = &planes.planes[0];
    let is_paper = |i: usize| (luma[i] / light[i] - 1.0).abs() < recipe.near;
    let paper: Vec<usize> = (0..light.len()).filter(|&i| is_paper(i)).collect();
    if low < recipe.least_luma || (paper.len() as f32) < recipe.least_paper * light.len() as f32 {
        return false;
    }
    let mut even = planes.clone();
    for plane in &mut even.planes {
        plane
            .iter_mut()
            .zip(&light)
            .for_each(|(value, light)| *value *= high / light);
    }
    let tones = [0, 1, 2].map(|c| Tone::of(&even.planes[c], &paper));
    let has_spots = recipe.spots.contains(&tones[0].spread);
    if has_spots {
        clear(&mut even, &tones, recipe.cleared);
    }
    if tones[0].middle >= recipe.white_luma
        && tones[1..]
            .iter()
            .all(|tone| tone.middle.abs() <= recipe.white_chroma)
    {
        whiten(&mut even, &tones);
    }
    let is_uneven = has_spots || high - low >= recipe.least_range;
    if is_uneven {
        *planes = even;
    }
    is_uneven
}

/// Paper in one plane.
struct Tone {
    middle: f32,
    /// RMS of its spots, as far as the nearer half of them tells.
    spread: f32,
}

impl Tone {
    fn of(plane: &[f32], paper: &[usize]) -> Self {
        let median = |mut values: Vec<f32>| {
            let middle = values.len() / 2;
            *values.select_nth_unstable_by(middle, f32::total_cmp).1
        };
        let middle = median(paper.iter().map(|&i| plane[i]).collect());
        let away = median(paper.iter().map(|&i| (plane[i] - middle).abs()).collect());
        Self {
            middle,
            spread: 1.48 * away,
        }
    }
}

/// Gives what differs from the paper by less than `most` times the spread the colour of the paper. What differs by twice that keeps
/// its own, and between them colours go over into each other, so that no edge is new.
fn clear(planes: &mut Planes, paper: &[Tone; 3], most: f32) {
    const LEAST_SPREAD: f32 = 0.5;
    for i in 0..planes.planes[0].len() {
        let away = |(plane, tone): (&Vec<f32>, &Tone)| {
            (plane[i] - tone.middle).abs() / (most * tone.spread.max(LEAST_SPREAD))
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
    fn of(planes: &Planes, recipe: &Light) -> Option<Self> {
        let mut cells = cells(planes, recipe);
        let mut field = Self::fitted(&cells)?;
        // Ink darkens cells, so that those far below the field are left out and it is fitted anew.
        for _ in 0..recipe.rounds {
            let is_near =
                |(place, value): &([f32; 2], f32)| *value > (1.0 - recipe.near) * field.at(*place);
            let kept: Vec<([f32; 2], f32)> = cells.iter().copied().filter(is_near).collect();
            if (kept.len() as f32) < recipe.least_paper * cells.len() as f32 {
                return None;
            }
            field = Self::fitted(&kept)?;
            cells = kept;
        }
        Some(field)
    }

    fn fitted(cells: &[([f32; 2], f32)]) -> Option<Self> {
        let mut normal = [[0.0_f64; TERMS]; TERMS];
        let mut right = [0.0_f64; TERMS];
        for (place, value) in cells {
            let terms = terms(*place).map(f64::from);
            for (k, row) in normal.iter_mut().enumerate() {
                row.iter_mut()
                    .zip(&terms)
                    .for_each(|(sum, term)| *sum += terms[k] * term);
                right[k] += terms[k] * f64::from(*value);
            }
        }
        let columns = normal.iter().map(|row| row.to_vec()).collect();
        let [solution] = math::solve_symmetric(columns, [right.to_vec()])?;
        let mut numbers = [0.0; TERMS];
        numbers
            .iter_mut()
            .zip(solution)
            .for_each(|(to, from)| *to = from as f32);
        Some(Self(numbers))
    }

    fn at(&self, place: [f32; 2]) -> f32 {
        self.0.iter().zip(terms(place)).map(|(a, b)| a * b).sum()
    }
}

fn terms([x, y]: [f32; 2]) -> [f32; TERMS] {
    [1.0, x, y, x * x, x * y, y * y]
}

/// The middles of cells, in units of the sides, and the luma that most of their brighter pixels have.
fn cells(planes: &Planes, recipe: &Light) -> Vec<([f32; 2], f32)> {
    let (width, height) = (planes.width, planes.height);
    let side = (width.min(height) / recipe.cells).max(1);
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
