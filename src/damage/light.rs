//! Uneven light on paper: a smooth field, by which a photographed page is divided.

use super::planes::Planes;
use super::recipe::Light;
use crate::math;

/// Numbers of a quadratic field.
const TERMS: usize = 6;

/// Divides a page by the light on it, so that its paper has one colour; false if the picture is no page, or its light is even.
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
    // A page is mostly paper that follows the field, bright, in light that is not even.
    let luma = &planes.planes[0];
    let is_paper = |(value, light): (&f32, &f32)| (value / light - 1.0).abs() < recipe.near;
    let paper = luma
        .iter()
        .zip(&light)
        .filter(|(v, l)| is_paper((v, l)))
        .count() as f32;
    if low < recipe.least_luma
        || high - low < recipe.least_range
        || paper < recipe.least_paper * light.len() as f32
    {
        return false;
    }
    for plane in &mut planes.planes {
        plane
            .iter_mut()
            .zip(&light)
            .for_each(|(value, light)| *value *= high / light);
    }
    true
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
