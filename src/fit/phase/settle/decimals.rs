//! Fewer decimals: areas whose points lie on tenths of a px take a quarter less of the file, and show it hardly.
//!
//! An area goes there if the squared error that this adds is below the price of the bytes that it saves. All are tried at
//! once, and where that adds too much, each half of them.

use crate::fit::budget::price::Price;
use crate::fit::drawing::Drawing;
use crate::fit::halves::by_halves;
use crate::render::{StrokeRef, Strokes};
use crate::scene::{Area, Mark, Scene};

/// Decimals of the points of areas that are rounded.
const COARSE: u8 = 1;

/// Rounds the points of the areas of `drawing` where that pays. `scene` is the drawing as its file has it, with `precision`
/// decimals. Returns true if any is rounded.
pub(super) fn drop_decimals(
    drawing: &mut Drawing,
    price: Price,
    scene: &Scene,
    precision: u8,
) -> bool {
    if precision <= COARSE || price.per_byte() == 0.0 || !drawing.free().has_areas() {
        return false;
    }
    let price = price.in_drawing(drawing);
    let rounded: Vec<Option<Mark>> = drawing
        .free()
        .iter()
        .map(|area| rounded(area, scene))
        .collect();
    let of_areas = (0..rounded.len()).filter(|&i| rounded[i].is_some());
    let (mut error, mut has_changed) = (drawing.mse(), false);
    by_halves(of_areas.collect(), |group| {
        let bytes = |drawing: &Drawing| -> usize {
            let of = |&i: &usize| price.bytes_of(drawing.free().get(i));
            group.iter().map(of).sum()
        };
        let (before, bytes_before) = (drawing.free().clone(), bytes(drawing));
        put(drawing, group, &rounded);
        let saved = bytes_before.saturating_sub(bytes(drawing));
        let now = drawing.mse();
        let added = (now - error) * (3 * drawing.pixels()) as f64;
        let pays = added <= f64::from(price.of_saved(saved)) && saved > 0;
        if pays {
            (error, has_changed) = (now, true);
        } else {
            *drawing.free_mut() = before;
        }
        pays
    });
    has_changed
}

/// The area with fewer decimals; `None` for a stroke, or if nothing would be left.
fn rounded(area: StrokeRef<'_>, scene: &Scene) -> Option<Mark> {
    let mark = area.is_area().then(|| area.to_mark())?;
    let rounded = scene.quantized_mark(&mark, COARSE)?;
    let Mark::Area(rounded) = rounded else {
        return None;
    };
    let (color, opacity) = (mark.color(), mark.opacity());
    Some(Mark::Area(Area {
        color,
        opacity,
        ..rounded
    }))
}

/// Puts the rounded areas of this group into the places of the present ones.
fn put(drawing: &mut Drawing, group: &[usize], rounded: &[Option<Mark>]) {
    let mut is_in_group = vec![false; rounded.len()];
    group.iter().for_each(|&i| is_in_group[i] = true);
    let mut strokes = Strokes::new();
    for (i, stroke) in drawing.free().iter().enumerate() {
        match &rounded[i] {
            Some(mark) if is_in_group[i] => strokes.push_mark(mark),
            _ => strokes.push(stroke),
        }
    }
    *drawing.free_mut() = strokes;
}
