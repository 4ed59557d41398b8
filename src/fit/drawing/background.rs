//! The choice of the background.

use crate::fit::config::Background;
use crate::fit::recipe::BackgroundChoice;
use crate::image::Image;
use crate::scene::Rgb;

/// The background, replaced by white where opaque strokes need that: they cannot reproduce translucent areas, such as
/// soft shadows or glass, so that a picture with such areas is flattened onto white for them.
pub(in crate::fit) fn for_strokes(
    background: Background,
    opaque: bool,
    picture: &Image,
    choice: &BackgroundChoice,
) -> Background {
    let is_translucent = || translucent_share(picture, choice) > choice.translucent_share;
    if background == Background::Auto && opaque && is_translucent() {
        Background::Color([1.0; 3])
    } else {
        background
    }
}

/// The matte that a picture with alpha is flattened onto if the drawing is not transparent.
pub(in crate::fit) fn matte(background: Background) -> Rgb {
    match background {
        Background::Color(color) => color,
        Background::Auto | Background::None => [1.0; 3],
    }
}

/// The background that a fit to `target` starts with, and whether it keeps its colour.
pub(in crate::fit) fn choose(
    background: Background,
    target: &Image,
    choice: &BackgroundChoice,
) -> (Rgb, bool) {
    match background {
        Background::Auto => {
            let levels = target.to_rgb8();
            let (colors, _) = levels.as_chunks();
            let paper = border_color(colors, target.width(), choice);
            let color = paper.unwrap_or_else(|| prevailing_color(target, colors, choice));
            (color, false)
        }
        Background::None => ([1.0; 3], true),
        Background::Color(color) => (color, true),
    }
}

/// The colour of the paper that is seen along the border of an opaque picture, if there is one.
pub(super) fn paper(picture: &Image, choice: &BackgroundChoice) -> Option<Rgb> {
    let levels = picture.to_rgb8();
    let (colors, _) = levels.as_chunks();
    border_color(colors, picture.width(), choice)
}

/// The most common colour of the pixels along the border, if that is the colour of enough of them: paper reaches the
/// border, and what is drawn on it may cover more than half of it.
fn border_color(colors: &[[u8; 3]], width: usize, choice: &BackgroundChoice) -> Option<Rgb> {
    let height = colors.len() / width;
    let rows = (0..height).flat_map(|y| [y * width, y * width + width - 1]);
    let columns = (0..width).flat_map(|x| [x, (height - 1) * width + x]);
    let border = rows.chain(columns).map(|i| colors[i]);
    common_color(border, choice.border_share)
}

/// The most common colour if its share is large enough, otherwise the mean colour.
fn prevailing_color(image: &Image, colors: &[[u8; 3]], choice: &BackgroundChoice) -> Rgb {
    common_color(colors.iter().copied(), choice.prevailing_share).unwrap_or_else(|| {
        [0, 1, 2].map(|c| {
            let sum: f64 = image.planes()[c].iter().map(|&v| f64::from(v)).sum();
            (sum / colors.len() as f64) as f32
        })
    })
}

/// The most common colour, if at least this share of the pixels has it.
fn common_color(pixels: impl Iterator<Item = [u8; 3]>, least_share: f64) -> Option<Rgb> {
    let mut colors: Vec<[u8; 3]> = pixels.collect();
    colors.sort_unstable();
    let runs = colors.chunk_by(|a, b| a == b);
    let most = runs.max_by_key(|run| run.len()).unwrap_or_default();
    let is_common = most.len() as f64 >= least_share * colors.len() as f64;
    let color = most.first().filter(|_| is_common)?;
    Some(color.map(|v| f32::from(v) / 255.0))
}

/// Share of the pixels that are translucent and have only translucent neighbours. This leaves out the antialiased edges
/// of opaque shapes, which are a pixel wide.
fn translucent_share(image: &Image, choice: &BackgroundChoice) -> f64 {
    let Some(alpha) = image.alpha() else {
        return 0.0;
    };
    let (width, height) = (image.width(), image.height());
    let [least, most] = choice.translucent;
    let shows = |x: usize, y: usize| (least..most).contains(&alpha[y * width + x]);
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
    use crate::fit::recipe::{Preset, Recipe};
    use crate::math;

    /// A grey disc with an antialiased edge, `alpha` inside.
    fn disc(alpha: f32) -> Image {
        let side = 40;
        let inside = |i: usize| {
            let away = math::hypot((i % side) as f32 - 20.0, (i / side) as f32 - 20.0);
            alpha * (15.5 - away).clamp(0.0, 1.0)
        };
        Image::filled(side, side, [0.4; 3])
            .and_then(|grey| grey.with_alpha((0..side * side).map(inside).collect()))
            .unwrap()
    }

    #[test]
    fn what_is_translucent_is_laid_on_white_for_opaque_strokes() {
        let (solid, glass) = (disc(1.0), disc(0.5));
        let choice = Recipe::of(Preset::Balanced).background;
        let of = |background, opaque, picture| for_strokes(background, opaque, picture, &choice);
        let (auto, none) = (Background::Auto, Background::None);
        assert_eq!(of(auto, true, &solid), auto);
        assert_eq!(of(auto, true, &glass), Background::Color([1.0; 3]));
        assert_eq!(of(auto, false, &glass), auto);
        assert_eq!(of(none, true, &glass), none);
    }
}
