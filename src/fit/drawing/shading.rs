//! The choice of a shade: a gradient for a picture whose page is one.

use crate::image::Image;
use crate::math;
use crate::scene::{Area, Scene, Shade, ShadeStop};
use crate::shading::{Block, Blocks, NEAR, Value};
use crate::svg::{self, WriteOptions};

// All of these are guesses.
/// Blocks along the longer side of the picture, whose means are fitted.
const BLOCKS: usize = 64;
/// The least share of the blocks that a gradient has to meet.
const LEAST_SHARE: f32 = 0.5;
/// Share of the blocks that it has to meet beyond the share that the best single colour meets.
const LEAST_GAIN: f32 = 0.25;
/// Largest change of a page per px: a larger one is the edge of a thing.
const STEEPEST: f32 = 14.0 / 255.0;

/// A page with the gradient of `picture`, if more of the picture is near it than near its best single colour, and it removes as much
/// squared error as its bytes have to at `price_per_byte`.
pub(in crate::fit) fn choose(picture: &Image, price_per_byte: f32) -> Option<Area> {
    let (blocks, area) = blocks(picture);
    let flat = flat(&blocks);
    // The flat page is the alternative: a gradient has to explain more of the picture than the best single colour.
    let alone = blocks.met(NEAR, |_| flat);
    // No shade is near more than all of the picture.
    if alone.share + LEAST_GAIN > 1.0 {
        return None;
    }
    let (shade, met) = blocks.best_shade()?;
    if has_edge(&shade) {
        return None;
    }
    let gain = (alone.error - met.error) * area;
    let size = [picture.width(), picture.height()].map(|side| side as u32);
    let page = Area::page(shade, size);
    let is_worth_it = met.share >= LEAST_SHARE
        && met.share >= alone.share + LEAST_GAIN
        && gain >= price_per_byte * bytes(&page, size) as f32;
    is_worth_it.then_some(page)
}

/// True if the shade changes by more than [`STEEPEST`] somewhere: there is the edge of a thing, which is none of the page.
fn has_edge(shade: &Shade) -> bool {
    let length = shade.axis().length() as f32;
    shade.stops().windows(2).any(|ends| {
        // One px more, so that two stops in one place count as an edge of a pixel and not as infinitely steep.
        let px = 1.0 + length * (ends[1].offset - ends[0].offset);
        let value = |stop: &ShadeStop, c: usize| match c {
            3 => stop.opacity,
            c => stop.color[c] * stop.opacity,
        };
        let changes = (0..4).map(|c| (value(&ends[1], c) - value(&ends[0], c)).abs());
        changes.fold(0.0, f32::max) > STEEPEST * px
    })
}

/// Bytes that a page with a gradient adds to the file of an empty scene.
fn bytes(page: &Area, [width, height]: [u32; 2]) -> usize {
    let length = |ground: Vec<Area>| {
        let empty = Scene::empty(width, height, None);
        svg::write(&Scene { ground, ..empty }, &WriteOptions::default()).len()
    };
    length(vec![page.clone()]) - length(Vec::new())
}

/// The means of the picture's blocks, and the pixels of one.
fn blocks(picture: &Image) -> (Blocks, f32) {
    let size = [picture.width(), picture.height()];
    let (blocks, side) = Blocks::of_page(size, BLOCKS, |pixels| {
        let mut sum = [0.0; 4];
        for &pixel in pixels {
            let alpha = picture.alpha().map_or(1.0, |alpha| alpha[pixel]);
            for (sum, plane) in sum.iter_mut().zip(picture.planes()) {
                *sum += alpha * plane[pixel];
            }
            sum[3] += alpha;
        }
        Some(sum.map(|sum: f32| sum / pixels.len() as f32))
    });
    (blocks, (side * side) as f32)
}

/// The value that most blocks are near to, of those that blocks have.
fn flat(blocks: &Blocks) -> Value {
    let key = |block: &Block| block.value.map(|v| (v * 255.0).round() as u8);
    // In 8-bit levels, so that blocks of one colour are equal.
    let mut keys: Vec<[u8; 4]> = blocks.all.iter().map(key).collect();
    let most = math::most_common(&mut keys).map_or([0; 4], |keys| keys[0]);
    most.map(|level| f32::from(level) / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Axis;
    use crate::shading::premultiplied;

    const WIDTH: usize = 120;
    const HEIGHT: usize = 80;

    /// A picture of 8-bit red, green, blue and alpha by place.
    fn picture(value: impl Fn(f32, f32) -> [f32; 4]) -> Image {
        let at = |i: usize| value((i % WIDTH) as f32 + 0.5, (i / WIDTH) as f32 + 0.5);
        let plane = |c: usize| -> Vec<f32> {
            let level = |i| (at(i)[c] * 255.0).round() / 255.0;
            (0..WIDTH * HEIGHT).map(level).collect()
        };
        let opaque = Image::new(WIDTH, HEIGHT, [plane(0), plane(1), plane(2)]).unwrap();
        opaque.with_alpha(plane(3)).unwrap()
    }

    fn shade(picture: &Image) -> Option<Shade> {
        choose(picture, 1e-3)?.shade
    }

    /// The largest difference of a channel, in levels, on black.
    fn error(picture: &Image, shade: &Shade) -> f32 {
        let seen = picture.flattened([0.0; 3]);
        let [r, g, b] = seen.planes();
        let apart = |i: usize| {
            let at = math::point([(i % WIDTH) as f32 + 0.5, (i / WIDTH) as f32 + 0.5]);
            let shown = premultiplied(shade, at).into_iter().zip([r[i], g[i], b[i]]);
            shown.fold(0.0, |most: f32, (a, b)| most.max((a - b).abs()))
        };
        255.0 * (0..WIDTH * HEIGHT).map(apart).fold(0.0, f32::max)
    }

    #[test]
    fn a_slanted_ramp_is_a_line_of_two_stops() {
        let ramp = picture(|x, y| {
            let t = (x + 0.5 * y) / (WIDTH as f32 + 0.5 * HEIGHT as f32);
            [0.2 + 0.6 * t, 0.9 - 0.5 * t, 0.3, 1.0]
        });
        let shade = shade(&ramp).unwrap();
        assert_eq!(shade.stops().len(), 2, "{shade:?}");
        assert!(shade.is_opaque() && error(&ramp, &shade) < 1.5, "{shade:?}");
    }

    #[test]
    fn a_glow_is_a_radius_that_ends_where_it_does() {
        let glow = picture(|x, y| {
            let away = math::hypot(x - 70.0, y - 30.0);
            [0.0, 0.35, 0.8, (1.0 - away / 40.0).max(0.0)]
        });
        let shade = shade(&glow).unwrap();
        let Axis::Radial { center, radius } = shade.axis() else {
            panic!("{shade:?}");
        };
        assert!(
            (center.x - 70.0).abs() < 0.5 && (center.y - 30.0).abs() < 0.5,
            "{shade:?}"
        );
        assert!(
            (radius - 40.0).abs() < 1.0 && shade.stops().len() <= 3,
            "{shade:?}"
        );
        assert!(error(&glow, &shade) < 6.0, "{shade:?}");
    }

    #[test]
    fn things_in_front_do_not_bend_a_shade() {
        let ramp = |x: f32| [0.1 + 0.7 * x / WIDTH as f32, 0.5, 0.5, 1.0];
        let sign = picture(|x, y| {
            let is_thing = (30.0..60.0).contains(&x) && (20.0..60.0).contains(&y);
            if is_thing {
                [0.9, 0.1, 0.1, 1.0]
            } else {
                ramp(x)
            }
        });
        let clear = picture(|x, _| ramp(x));
        let shade = shade(&sign).unwrap();
        assert!(error(&clear, &shade) < 1.5, "{shade:?}");
    }

    #[test]
    fn a_disc_in_a_glow_is_none_of_the_page() {
        let disc = picture(|x, y| {
            let away = math::hypot(x - 60.0, y - 40.0);
            match away < 12.0 {
                true => [0.9, 0.2, 0.1, 1.0],
                false => [0.2, 0.3, 1.0 - away / 100.0, 1.0],
            }
        });
        assert_eq!(shade(&disc), None);
    }

    #[test]
    fn pages_of_one_colour_and_textures_have_none() {
        let flat = picture(|x, _| {
            if x < 20.0 {
                [0.0, 0.0, 0.0, 1.0]
            } else {
                [1.0; 4]
            }
        });
        assert_eq!(shade(&flat), None);
        let texture = picture(|x, y| {
            let v = 0.5 + 0.3 * math::sin(0.7 * x) * math::cos(0.9 * y) + 0.002 * x;
            [v, v, 1.0 - v, 1.0]
        });
        assert_eq!(shade(&texture), None);
        assert_eq!(shade(&picture(|_, _| [0.0; 4])), None);
    }

    #[test]
    fn a_shade_that_costs_more_than_it_removes_is_left_out() {
        let ramp = picture(|x, _| [0.4 + 0.1 * x / WIDTH as f32, 0.5, 0.5, 1.0]);
        assert!(choose(&ramp, 1e-4).is_some());
        assert_eq!(choose(&ramp, 1.0), None);
    }

    #[test]
    fn the_smallest_pictures_are_no_trouble() {
        for (width, height) in [(1, 1), (1, 9), (3, 2), (200, 1)] {
            let picture = Image::filled(width, height, [0.3; 3]).unwrap();
            assert_eq!(shade(&picture), None, "{width}×{height}");
        }
    }
}
