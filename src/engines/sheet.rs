//! Pictures side by side, with their differences made visible.

use crate::error::Result;
use crate::image::Image;

/// By how much differences are amplified: to the picture, and to resvg's render.
pub const DIFFERENCE_GAIN: [f32; 2] = [4.0, 16.0];

/// px between two pictures, white.
const GAP: usize = 8;

/// From left to right: the picture, if there is one; the engine's render; its difference from the
/// picture and from resvg's render, absolute and amplified by [`DIFFERENCE_GAIN`], black where
/// there is none.
///
/// # Errors
/// [`ErrorKind::Picture`](crate::ErrorKind::Picture) when sizes differ.
pub fn compared(target: Option<&Image>, resvg: &Image, drawn: &Image) -> Result<Image> {
    let [to_target, to_resvg] = DIFFERENCE_GAIN;
    let mut panels = Vec::new();
    if let Some(target) = target {
        panels.push(target.flattened([1.0; 3]));
    }
    panels.push(drawn.clone());
    if let Some(target) = target {
        panels.push(difference(&panels[0], drawn, to_target)?);
        debug_assert_eq!(panels[0].width(), target.width());
    }
    panels.push(difference(resvg, drawn, to_resvg)?);
    beside(&panels)
}

fn difference(a: &Image, b: &Image, gain: f32) -> Result<Image> {
    let plane = |c: usize| {
        let pairs = a.planes()[c].iter().zip(&b.planes()[c]);
        pairs
            .map(|(a, b)| ((a - b).abs() * gain).min(1.0))
            .collect()
    };
    Image::new(a.width(), b.height(), [plane(0), plane(1), plane(2)])
}

fn beside(panels: &[Image]) -> Result<Image> {
    let height = panels.iter().map(Image::height).max().unwrap_or(0);
    let width =
        panels.iter().map(Image::width).sum::<usize>() + GAP * panels.len().saturating_sub(1);
    let plane = |c: usize| {
        let row = |y: usize| {
            let rows = panels
                .iter()
                .map(move |p| &p.planes()[c][y * p.width()..][..p.width()]);
            rows.collect::<Vec<_>>().join(&[1.0; GAP][..])
        };
        (0..height).flat_map(row).collect()
    };
    Image::new(width, height, [plane(0), plane(1), plane(2)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_amplified_and_stand_beside_the_pictures() {
        let gray = |level| Image::filled(2, 1, [level; 3]).unwrap();
        let sheet = compared(Some(&gray(0.5)), &gray(0.25), &gray(0.375)).unwrap();
        assert_eq!((sheet.width(), sheet.height()), (4 * 2 + 3 * GAP, 1));
        let row = &sheet.planes()[1];
        let panel = |i: usize| row[i * (2 + GAP)];
        assert_eq!([0, 1, 2, 3].map(panel), [0.5, 0.375, 0.5, 1.0]);
        assert_eq!(row[2..2 + GAP], [1.0; GAP]);
    }

    #[test]
    fn without_a_picture_there_are_two_panels() {
        let gray = Image::filled(3, 2, [0.5; 3]).unwrap();
        assert_eq!(compared(None, &gray, &gray).unwrap().width(), 2 * 3 + GAP);
    }
}
