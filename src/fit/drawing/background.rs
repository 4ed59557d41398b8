//! The choice of the background, and of the ground on it.

use std::ops::Range;

use crate::fit::config::Background;
use crate::fit::drawing::shading;
use crate::fit::drawing::shadows::{self, Page, Terms};
use crate::image::Image;
use crate::math;
use crate::scene::{Area, Rgb};

/// Least share of the pixels that have the most common colour if that becomes the background; otherwise the mean colour does.
const PREVAILING_SHARE: f64 = 0.25;
/// Share of the pixels along the border from which on their most common colour is the background. A guess: three of eleven logos on
/// white had the logo's colour as paper.
const BORDER_SHARE: f64 = 0.4;
/// Share of the border that has about one colour, from which on it is spotted paper of that colour. A guess.
const SPOTTED_SHARE: f64 = 0.6;
/// Farthest that the spots of paper are from its colour, levels of 8 bits. A guess.
const SPOTS: u8 = 10;
/// Share of the pixels in translucent areas that opaque strokes may miss. Beyond it, the picture is flattened onto white for them. A
/// guess.
const TRANSLUCENT_SHARE: f64 = 0.005;
/// Alpha of translucent pixels. A guess.
const TRANSLUCENT: Range<f32> = 0.03..0.97;

/// The background, replaced by white where opaque strokes need that: they cannot reproduce translucent areas, such as
/// soft shadows or glass, so that a picture with such areas is flattened onto white for them.
pub(in crate::fit) fn for_strokes(
    background: Background,
    opaque: bool,
    picture: &Image,
) -> Background {
    let is_translucent = || translucent_share(picture) > TRANSLUCENT_SHARE;
    if background == Background::Auto && opaque && is_translucent() {
        Background::Color([1.0; 3])
    } else {
        background
    }
}

/// The background and the ground of a new drawing. A gradient replaces the background, and shadows lie on a page that stays.
pub(in crate::fit) fn with_ground(picture: &Image, terms: &Terms<'_>) -> (Background, Vec<Area>) {
    let shadows = |page: &Page| match terms.is_short {
        true => Vec::new(),
        false => shadows::choose(picture, page, terms),
    };
    if let Some(page) = shading::choose(picture, terms.per_byte) {
        let shadows = page.shade.clone().map(|shade| shadows(&Page::Shade(shade)));
        let ground = std::iter::once(page).chain(shadows.into_iter().flatten());
        return (Background::None, ground.collect());
    }
    // A transparent picture has no page, but may have shadows. An opaque one without paper has neither.
    let (page, background) = match (picture.alpha(), paper(picture)) {
        (Some(_), _) => (Page::Clear, Background::Auto),
        (None, Some(color)) => (Page::Color(color), Background::Color(color)),
        (None, None) => return (Background::Auto, Vec::new()),
    };
    match shadows(&page) {
        ground if ground.is_empty() => (Background::Auto, ground),
        // The blurs were fitted on this colour, so the background has to keep it.
        ground => (background, ground),
    }
}

/// What a drawing that is not transparent lies on, and what a picture with alpha is flattened onto for it: white unless told
/// otherwise. Without a background, that is the paper of an opaque picture, which then is in no mark.
pub(in crate::fit) fn matte(background: Background, picture: &Image) -> Rgb {
    match background {
        Background::Color(color) => color,
        Background::None => paper(picture).unwrap_or([1.0; 3]),
        Background::Auto => [1.0; 3],
    }
}

/// The background that a fit to `target` on `matte` starts with, and whether it keeps its colour.
pub(in crate::fit) fn choose(background: Background, target: &Image, matte: Rgb) -> (Rgb, bool) {
    match background {
        Background::Auto => {
            let levels = target.to_rgb8();
            let (colors, _) = levels.as_chunks();
            // The border first: paper reaches it, while what is drawn may cover most of the picture.
            let paper = border_color(colors, target.width());
            let color = paper.unwrap_or_else(|| prevailing_color(target, colors));
            (color, false)
        }
        Background::None | Background::Color(_) => (matte, true),
    }
}

/// The colour of the paper that is seen along the border of an opaque picture, if there is one.
pub(in crate::fit) fn paper(picture: &Image) -> Option<Rgb> {
    if picture.alpha().is_some() {
        return None;
    }
    let levels = picture.to_rgb8();
    let (colors, _) = levels.as_chunks();
    border_color(colors, picture.width())
}

/// The most common colour of the pixels along the border, if that is the colour of enough of them: paper reaches the
/// border, and the drawing on it may cover more than half of it.
fn border_color(colors: &[[u8; 3]], width: usize) -> Option<Rgb> {
    let height = colors.len() / width;
    let rows = (0..height).flat_map(|y| [y * width, y * width + width - 1]);
    let columns = (0..width).flat_map(|x| [x, (height - 1) * width + x]);
    let border: Vec<[u8; 3]> = rows.chain(columns).map(|i| colors[i]).collect();
    // An exact colour is better than the mean of spots, and is asked for first.
    common_color(border.iter().copied(), BORDER_SHARE).or_else(|| spotted_color(border))
}

/// The mean of the colours near the most common one, if enough of the pixels have those: paper that was scanned has spots.
fn spotted_color(mut pixels: Vec<[u8; 3]>) -> Option<Rgb> {
    let all = pixels.len();
    let most = math::most_common(&mut pixels)?[0];
    let is_near = |color: &[u8; 3]| {
        let channels = color.iter().zip(most);
        channels.fold(0, |far, (a, b)| far.max(a.abs_diff(b))) <= SPOTS
    };
    pixels.retain(is_near);
    let mean = |c: usize| {
        let sum: f32 = pixels.iter().map(|color| f32::from(color[c])).sum();
        sum / (255.0 * pixels.len() as f32)
    };
    let is_paper = pixels.len() as f64 >= SPOTTED_SHARE * all as f64;
    is_paper.then(|| [0, 1, 2].map(mean))
}

/// The most common colour if its share is large enough, otherwise the mean colour.
fn prevailing_color(image: &Image, colors: &[[u8; 3]]) -> Rgb {
    common_color(colors.iter().copied(), PREVAILING_SHARE).unwrap_or_else(|| {
        [0, 1, 2].map(|c| {
            let sum: f64 = image.planes()[c].iter().map(|&v| f64::from(v)).sum();
            (sum / colors.len() as f64) as f32
        })
    })
}

/// The most common colour, if at least this share of the pixels has it.
fn common_color(pixels: impl Iterator<Item = [u8; 3]>, least_share: f64) -> Option<Rgb> {
    let mut colors: Vec<[u8; 3]> = pixels.collect();
    let all = colors.len();
    let most = math::most_common(&mut colors)?;
    let is_common = most.len() as f64 >= least_share * all as f64;
    is_common.then(|| most[0].map(|v| f32::from(v) / 255.0))
}

/// Share of the pixels that are translucent and have only translucent neighbours. This leaves out the antialiased edges
/// of opaque shapes, which are a pixel wide.
fn translucent_share(image: &Image) -> f64 {
    let Some(alpha) = image.alpha() else {
        return 0.0;
    };
    let (width, height) = (image.width(), image.height());
    let shows = |x: usize, y: usize| TRANSLUCENT.contains(&alpha[y * width + x]);
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
            let away = math::hypot((i % side) as f32 - 20.0, (i / side) as f32 - 20.0);
            alpha * (15.5 - away).clamp(0.0, 1.0)
        };
        Image::filled(side, side, [0.4; 3])
            .and_then(|grey| grey.with_alpha((0..side * side).map(inside).collect()))
            .unwrap()
    }

    #[test]
    fn paper_with_spots_is_the_page() {
        let of = |x: usize, y: usize| match (x, y) {
            (8..32, 8..32) => 20,
            _ => 236 + (x * 7 + y * 11) % 9,
        };
        let page = Image::from_fn(40, 40, 3, |x, y, _| of(x, y) as f32 / 255.0).unwrap();
        let (color, is_fixed) = choose(Background::Auto, &page, [1.0; 3]);
        assert!(!is_fixed);
        assert!(
            color.iter().all(|v| (v * 255.0 - 240.0).abs() < 1.5),
            "{color:?}"
        );
        // Where every tone is as common as any other one there is no paper, and the background is their mean.
        let striped = Image::from_fn(40, 40, 3, |x, y, _| ((x + y) % 40) as f32 / 39.0).unwrap();
        let (color, _) = choose(Background::Auto, &striped, [1.0; 3]);
        assert!((color[0] - 0.5).abs() < 0.1, "{color:?}");
    }

    #[test]
    fn what_is_translucent_is_laid_on_white_for_opaque_strokes() {
        let (solid, glass) = (disc(1.0), disc(0.5));
        let of = |background, opaque, picture| for_strokes(background, opaque, picture);
        let (auto, none) = (Background::Auto, Background::None);
        assert_eq!(of(auto, true, &solid), auto);
        assert_eq!(of(auto, true, &glass), Background::Color([1.0; 3]));
        assert_eq!(of(auto, false, &glass), auto);
        assert_eq!(of(none, true, &glass), none);
    }
}
