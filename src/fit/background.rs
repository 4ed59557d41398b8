//! What lies behind all strokes.

use crate::image::Image;
use crate::scene::Rgb;

/// The colour behind all strokes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Background {
    /// Chosen from the picture.
    #[default]
    Auto,
    /// No background; pictures are laid on white.
    None,
    /// This colour.
    Color(Rgb),
}

impl Background {
    /// What `Auto` comes to for `picture`: opaque strokes cannot show what is translucent, a soft shadow or
    /// glass, so that a picture with such areas is laid on white for them.
    pub(super) fn for_strokes(self, opaque: bool, picture: &Image) -> Self {
        if self == Self::Auto && opaque && translucent_share(picture) > TRANSLUCENT {
            Self::Color([1.0; 3])
        } else {
            self
        }
    }

    /// The colour that a picture with alpha is laid on.
    pub(super) fn ground(self) -> Rgb {
        match self {
            Self::Color(color) => color,
            Self::Auto | Self::None => [1.0; 3],
        }
    }

    /// The colour that the page starts from, and whether it stays that colour.
    pub(super) fn choose(self, target: &Image) -> (Rgb, bool) {
        match self {
            Self::Auto => (prevailing_color(target), false),
            Self::None => ([1.0; 3], true),
            Self::Color(color) => (color, true),
        }
    }
}

/// Share of the pixels that one colour must have to be taken for the ground.
const PREVAILING: f64 = 0.25;

/// The colour of most pixels if it is a ground, otherwise the mean colour.
fn prevailing_color(image: &Image) -> Rgb {
    let pixels = image.width() * image.height();
    let levels = image.to_rgb8();
    let (colors, _) = levels.as_chunks::<3>();
    let mut colors: Vec<u32> = colors
        .iter()
        .map(|&[r, g, b]| u32::from_be_bytes([0, r, g, b]))
        .collect();
    colors.sort_unstable();
    let runs = colors.chunk_by(|a, b| a == b);
    let most = runs.max_by_key(|run| run.len()).unwrap_or_default();
    match most {
        [color, ..] if most.len() as f64 >= PREVAILING * pixels as f64 => {
            let [_, rgb @ ..] = color.to_be_bytes();
            rgb.map(|v| f32::from(v) / 255.0)
        }
        _ => [0, 1, 2].map(|c| {
            let sum: f64 = image.planes()[c].iter().map(|&v| f64::from(v)).sum();
            (sum / pixels as f64) as f32
        }),
    }
}

/// Share of the pixels in translucent areas that opaque strokes can leave out.
const TRANSLUCENT: f64 = 0.005;

/// Share of the pixels that are translucent and have four translucent neighbours: the edge of an opaque
/// shape is a pixel wide.
fn translucent_share(image: &Image) -> f64 {
    let Some(alpha) = image.alpha() else {
        return 0.0;
    };
    let (width, height) = (image.width(), image.height());
    let shows = |x: usize, y: usize| (0.03..0.97).contains(&alpha[y * width + x]);
    let inside = |x: usize, y: usize| {
        shows(x, y)
            && (x == 0 || shows(x - 1, y))
            && (x + 1 == width || shows(x + 1, y))
            && (y == 0 || shows(x, y - 1))
            && (y + 1 == height || shows(x, y + 1))
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    pixels.filter(|&(x, y)| inside(x, y)).count() as f64 / (width * height) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grey disc with an antialiased edge, `alpha` inside.
    fn disc(alpha: f32) -> Image {
        let side = 40;
        let inside = |i: usize| {
            let away = ((i % side) as f32 - 20.0).hypot((i / side) as f32 - 20.0);
            alpha * (15.5 - away).clamp(0.0, 1.0)
        };
        Image::filled(side, side, [0.4; 3])
            .and_then(|grey| grey.with_alpha((0..side * side).map(inside).collect()))
            .unwrap()
    }

    #[test]
    fn what_is_translucent_is_laid_on_white_for_opaque_strokes() {
        let (solid, glass) = (disc(1.0), disc(0.5));
        let white = Background::Color([1.0; 3]);
        assert_eq!(Background::Auto.for_strokes(true, &solid), Background::Auto);
        assert_eq!(Background::Auto.for_strokes(true, &glass), white);
        assert_eq!(
            Background::Auto.for_strokes(false, &glass),
            Background::Auto
        );
        assert_eq!(Background::None.for_strokes(true, &glass), Background::None);
    }
}
