//! The difference between a frame and the previous one.

use super::super::Image;

/// A rectangle of RGBA pixels, transparent where nothing changes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Patch {
    /// Left edge, px; even, as WebP requires.
    pub(super) x: u32,
    /// Upper edge, px; even.
    pub(super) y: u32,
    pub(super) width: u32,
    pub(super) height: u32,
    /// Time for which it is shown, ms.
    pub(super) ms: u32,
    /// `width·height` pixels row by row, not premultiplied.
    pub(super) rgba: Vec<u8>,
}

/// An 8-bit colour.
type Rgb8 = [u8; 3];

impl Patch {
    /// The patch that turns `before` into `image`, of the same size; without `before`, the whole image. A
    /// frame that equals the previous one is a single transparent pixel.
    pub(super) fn between(before: Option<&Image>, image: &Image, ms: u32) -> Self {
        let (width, height) = (image.width(), image.height());
        let after = pixels(image);
        let Some(before) = before.map(pixels) else {
            let opaque = after.iter().flat_map(|&color| opaque(color)).collect();
            return Self::new([0, 0, width, height], opaque, ms);
        };
        let differs = |x: usize, y: usize| before[y * width + x] != after[y * width + x];
        let [x, y, right, bottom] = bounds(width, height, differs).unwrap_or([0, 0, 1, 1]);
        // One column or row more on the left or above, where that makes the corner even: WebP stores half of it.
        let (x, y) = (x & !1, y & !1);
        let mut rgba = Vec::with_capacity((right - x) * (bottom - y) * 4);
        for (x, y) in (y..bottom).flat_map(|y| (x..right).map(move |x| (x, y))) {
            let pixel = differs(x, y).then(|| opaque(after[y * width + x]));
            rgba.extend(pixel.unwrap_or_default());
        }
        Self::new([x, y, right - x, bottom - y], rgba, ms)
    }

    fn new(place: [usize; 4], rgba: Vec<u8>, ms: u32) -> Self {
        let [x, y, width, height] = place.map(|n| n as u32);
        Self {
            x,
            y,
            width,
            height,
            ms,
            rgba,
        }
    }
}

fn opaque([r, g, b]: Rgb8) -> [u8; 4] {
    [r, g, b, 255]
}

fn pixels(image: &Image) -> Vec<Rgb8> {
    let bytes = image.to_rgb8();
    bytes.as_chunks::<3>().0.to_vec()
}

/// Left, top, right and bottom (both exclusive) of the pixels for which `inside` is true.
fn bounds(
    width: usize,
    height: usize,
    inside: impl Fn(usize, usize) -> bool,
) -> Option<[usize; 4]> {
    // From each side to the first pixel inside. Columns are searched between top and bottom alone.
    let in_row = |y: usize| (0..width).any(|x| inside(x, y));
    let top = (0..height).find(|&y| in_row(y))?;
    let bottom = (top..height).rfind(|&y| in_row(y))? + 1;
    let in_column = |x: usize| (top..bottom).any(|y| inside(x, y));
    let left = (0..width).find(|&x| in_column(x))?;
    let right = (left..width).rfind(|&x| in_column(x))? + 1;
    Some([left, top, right, bottom])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(levels: &[f32], width: usize) -> Image {
        let plane = levels.to_vec();
        Image::new(
            width,
            levels.len() / width,
            [plane.clone(), plane.clone(), plane],
        )
        .unwrap()
    }

    #[test]
    fn only_what_changes_is_said() {
        let before = grey(&[0.0; 20], 5);
        let mut levels = [0.0; 20];
        (levels[13], levels[19]) = (1.0, 1.0);
        let patch = Patch::between(Some(&before), &grey(&levels, 5), 40);
        assert_eq!([patch.x, patch.y, patch.width, patch.height], [2, 2, 3, 2]);
        let alphas: Vec<u8> = patch.rgba.chunks(4).map(|p| p[3]).collect();
        assert_eq!(alphas, [0, 255, 0, 0, 0, 255]);
    }

    #[test]
    fn nothing_new_is_one_clear_pixel() {
        let image = grey(&[0.5; 6], 3);
        let patch = Patch::between(Some(&image), &image, 40);
        assert_eq!((patch.width, patch.height), (1, 1));
        assert_eq!(patch.rgba, [0; 4]);
    }
}
