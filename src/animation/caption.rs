//! A line of text beneath a picture.

use std::ops::Range;

use crate::error::Result;
use crate::image::{Image, Limits};

/// The letters that captions are made of, in the order of their picture.
const LETTERS: &str = "0123456789.,strokedBinfa";

/// Hack Regular at 13 px, black on white, side by side. `rig/` has the font, and a test that draws them again.
const PICTURE: &[u8] = include_bytes!("letters.png");

/// Columns of a letter in that picture.
const COLUMNS: usize = 8;

/// From one letter to the next in a caption, px; each begins at a whole pixel.
const ADVANCE: f32 = 6.723_574;

/// White on the left of a caption, px.
const MARGIN: usize = 4;

/// `picture` with `text` beneath it, at least `min_width` px wide. Characters that are none of the letters are blank.
///
/// # Errors
/// [`ErrorKind::Picture`](crate::ErrorKind::Picture) when there is no memory for it.
pub(super) fn captioned(picture: &Image, text: &str, min_width: usize) -> Result<Image> {
    let letters = Image::decode(PICTURE, "letters.png", Limits::default())?;
    let width = picture.width().max(min_width);
    let height = picture.height() + letters.height();
    let mut planes = Image::filled(width, height, [1.0; 3])?.into_planes();
    lay(&mut planes, width, [0, 0], picture, 0..picture.width());
    for (i, letter) in text.chars().enumerate() {
        if let Some(place) = LETTERS.find(letter) {
            let at = [MARGIN + (i as f32 * ADVANCE) as usize, picture.height()];
            let columns = place * COLUMNS..(place + 1) * COLUMNS;
            lay(&mut planes, width, at, &letters, columns);
        }
    }
    Ok(Image::from_planes(width, height, planes))
}

/// Lays `columns` of `picture` on `planes` of rows of `width`, from the pixel `[x, y]` on; as ink on it.
fn lay(
    planes: &mut [Vec<f32>; 3],
    width: usize,
    [x, y]: [usize; 2],
    picture: &Image,
    columns: Range<usize>,
) {
    for (to, from) in planes.iter_mut().zip(picture.planes()) {
        let rows = from.chunks_exact(picture.width());
        for (to, from) in to.chunks_exact_mut(width).skip(y).zip(rows) {
            for (to, from) in to.iter_mut().skip(x).zip(&from[columns.clone()]) {
                *to *= *from;
            }
        }
    }
}
