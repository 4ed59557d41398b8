//! Fewer decimals: areas whose points lie on tenths of a px take a quarter less of the file, and show it hardly.
//!
//! An area goes there if the squared error that this adds is below the price of the bytes that it saves.

use crate::fit::budget::price::Price;
use crate::fit::drawing::Drawing;
use crate::fit::edits::{Edit, apply_priced};
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
    let coarse = |(i, area): (usize, StrokeRef<'_>)| {
        let rounded = rounded(area, scene)?;
        let bytes = price.bytes_of(Strokes::from_iter([&rounded]).get(0));
        let saved = price
            .bytes_of(area)
            .checked_sub(bytes)
            .filter(|saved| *saved > 0)?;
        Some(Edit::replacing(i, vec![rounded], price.of_saved(saved)))
    };
    let edits = drawing
        .free()
        .iter()
        .enumerate()
        .filter_map(coarse)
        .collect();
    !apply_priced(drawing, edits, usize::MAX).made.is_empty()
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
