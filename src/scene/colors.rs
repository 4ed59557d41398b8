//! The colours of a drawing, which layers, cut-outs and style sheets go by.

use std::collections::BTreeSet;

use crate::math;

/// Each of these colours once, in the order in which they first come.
pub(crate) fn distinct_colors(colors: impl IntoIterator<Item = [u8; 3]>) -> Vec<[u8; 3]> {
    let mut seen = BTreeSet::new();
    let colors = colors.into_iter();
    colors.filter(|color| seen.insert(*color)).collect()
}

/// sRGB's transfer function.
pub(crate) fn linear_light(level: u8) -> f32 {
    let x = f32::from(level) / 255.0;
    if x <= 0.04045 {
        x / 12.92
    } else {
        math::powf((x + 0.055) / 1.055, 2.4)
    }
}
