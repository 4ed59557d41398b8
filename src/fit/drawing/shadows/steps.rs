//! Blurs as steps of opacity, for programs without filters.

use super::OUTLINE_OF_BLUR;
use super::region::Region;
use crate::render::blurred;
use crate::scene::{Area, Mark, quantized_anywhere};
use crate::trace;

/// Largest change of opacity from one step to the next, and the least and the most steps. Steps of 3 levels are hardly seen. A guess.
const STEP: f32 = 3.0 / 255.0;
const LEAST: usize = 4;
const MOST: usize = 24;
/// Decimals of their outlines.
const PRECISION: u8 = 1;

/// Shapes without a blur that together look like a blurred one, back to front.
pub(super) fn of(shadow: &Area) -> Vec<Area> {
    let region = Region::around(shadow.extent());
    let soft = blurred(region.covered(&shadow.rings), shadow.blur);
    let count = ((shadow.opacity / STEP).ceil() as usize).clamp(LEAST, MOST);
    let step = |k: usize| {
        // The step covers what has more than the middle of its shares.
        let share = (k as f32 + 0.5) / count as f32;
        let above = soft.values.iter().map(|value| value - share + 0.5);
        let above: Vec<f32> = above.collect();
        let rings = trace::rings(&above, soft.width, OUTLINE_OF_BLUR * shadow.blur).into_iter();
        let rings: Vec<_> = rings.map(|ring| ring.moved(region.corner())).collect();
        // Steps lie on each other: with `before` below it, opacity α gives before + (1 − before)·α.
        let [before, own] = [k, k + 1].map(|k| shadow.opacity * k as f32 / count as f32);
        let opacity = (own - before) / (1.0 - before);
        let area = Mark::Area(Area::plain(rings, shadow.color, opacity));
        quantized_anywhere(&area, PRECISION)?.as_area().cloned()
    };
    (0..count).filter_map(step).collect()
}
