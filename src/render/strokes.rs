//! Strokes as the renderer and the optimiser see them: rows of numbers.

use crate::math::Point;
use crate::scene::{Path, Stroke};

/// Numbers per stroke, in the order of the constants below.
pub const PARAMS: usize = 9;

/// x of the first end, px.
pub const AX: usize = 0;
/// y of the first end, px.
pub const AY: usize = 1;
/// x of the second end, px; equal to the first for a dot.
pub const BX: usize = 2;
/// y of the second end, px.
pub const BY: usize = 3;
/// Half the stroke width, px.
pub const RADIUS: usize = 4;
/// Red; green and blue follow. sRGB-encoded, 0..1.
pub const RED: usize = 5;
/// 0..1.
pub const OPACITY: usize = 8;

/// The numbers of one stroke.
pub type Params = [f32; PARAMS];

/// The numbers of `stroke`.
pub fn pack(stroke: &Stroke) -> Params {
    let (a, b) = stroke.path.ends();
    let [red, green, blue] = stroke.color;
    [
        a.x,
        a.y,
        b.x,
        b.y,
        stroke.radius,
        red,
        green,
        blue,
        stroke.opacity,
    ]
}

/// The stroke of these numbers, always a capsule.
pub fn unpack(p: &Params) -> Stroke {
    Stroke {
        path: Path::line(Point::new(p[AX], p[AY]), Point::new(p[BX], p[BY])),
        radius: p[RADIUS],
        color: [p[RED], p[RED + 1], p[RED + 2]],
        opacity: p[OPACITY],
    }
}
