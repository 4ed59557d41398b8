//! Light as sRGB encodes it.

use crate::math;

/// Light of 0..1 as sRGB encodes it.
pub(super) fn encoded(light: f32) -> f32 {
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * math::powf(light, 1.0 / 2.4) - 0.055
    }
}
