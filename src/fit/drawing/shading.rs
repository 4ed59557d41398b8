//! The choice of a shade: a gradient for a picture whose page is one.
//!
//! Two axes are tried, a line and a radius, on the means of some thousand blocks of the picture. Level lines of a shade
//! run across the line, or around the centre. So the colours' gradients point along the line, or through the centre,
//! which tells both in closed form. A pattern search then makes the blocks at equal offsets as equal as
//! possible. Last come the stops: the best colours for given offsets are a linear least-squares problem, and
//! offsets are added as long as they remove a share of the error. All of this is repeated on the blocks that the last
//! shade has met, so that things in front of the shade do not bend it.

mod axis;
mod profile;

use crate::fit::recipe::ShadeChoice;
use crate::image::Image;
use crate::math::Point;
use crate::scene::{Axis, Scene, Shade};
use crate::svg::{self, WriteOptions};

/// The shade of `picture`, if more of the picture is near it than near its best single colour, and it removes as much
/// squared error as its bytes have to at `price_per_byte`.
pub(in crate::fit) fn choose(
    picture: &Image,
    choice: &ShadeChoice,
    price_per_byte: f32,
) -> Option<Shade> {
    let blocks = Blocks::of(picture, choice);
    let flat = blocks.flat();
    let candidates = [axis::Kind::Linear, axis::Kind::Radial];
    let candidates = candidates.map(|kind| blocks.shade(kind, choice));
    let met = |shade: &Shade| blocks.met(|block| premultiplied(shade, block.center));
    let (share, shade) = candidates
        .into_iter()
        .flatten()
        .map(|shade| (met(&shade).share, shade))
        .max_by(|(a, _), (b, _)| a.total_cmp(b))?;
    let alone = blocks.met(|_| flat);
    let gain = (alone.error - met(&shade).error) * blocks.area;
    let page = Scene::empty(picture.width() as u32, picture.height() as u32, None);
    let is_worth_it = share >= choice.least_share
        && share >= alone.share + choice.least_gain
        && gain >= price_per_byte * bytes(&page, &shade) as f32;
    is_worth_it.then_some(shade)
}

/// Bytes that `shade` adds to the file of `page`.
fn bytes(page: &Scene, shade: &Shade) -> usize {
    let length = |scene: &Scene| svg::write(scene, &WriteOptions::default()).len();
    let shaded = Scene {
        shade: Some(shade.clone()),
        ..page.clone()
    };
    length(&shaded) - length(page)
}

/// Premultiplied colour, and opacity.
type Value = [f32; 4];

/// The mean of a square of the picture.
#[derive(Debug, Clone, Copy)]
struct Block {
    center: Point,
    value: Value,
    /// 1, or 0 for a block that does not take part.
    weight: f32,
}

/// The means of squares of the picture, row by row.
struct Blocks {
    columns: usize,
    all: Vec<Block>,
    /// Pixels of a block.
    area: f32,
    /// A block with no channel farther from a shade than this has met it.
    near: f32,
    size: [f32; 2],
}

/// Likeness of the picture to a shade.
struct Met {
    /// The share of the blocks that it has met.
    share: f32,
    /// Squared error, each value as large as that of a block that just fails, at most.
    error: f32,
}

impl Blocks {
    fn of(picture: &Image, choice: &ShadeChoice) -> Self {
        let (width, height) = (picture.width(), picture.height());
        let side = width.max(height).div_ceil(choice.blocks).max(1);
        let [columns, rows] = [width.div_ceil(side), height.div_ceil(side)];
        let block = |i: usize| {
            let [x, y] = [i % columns * side, i / columns * side];
            let [right, below] = [(x + side).min(width), (y + side).min(height)];
            let pixels = (y..below).flat_map(|y| (x..right).map(move |x| y * width + x));
            let mut sum = [0.0; 4];
            let mut count = 0.0;
            for pixel in pixels {
                let alpha = picture.alpha().map_or(1.0, |alpha| alpha[pixel]);
                for (sum, plane) in sum.iter_mut().zip(picture.planes()) {
                    *sum += alpha * plane[pixel];
                }
                sum[3] += alpha;
                count += 1.0;
            }
            Block {
                center: Point::new((x + right) as f32 / 2.0, (y + below) as f32 / 2.0),
                value: sum.map(|sum: f32| sum / count),
                weight: 1.0,
            }
        };
        Self {
            columns,
            all: (0..columns * rows).map(block).collect(),
            area: (side * side) as f32,
            near: choice.near,
            size: [width as f32, height as f32],
        }
    }

    /// The value that most blocks are near to, of those that blocks have.
    fn flat(&self) -> Value {
        let key = |block: &Block| block.value.map(|v| (v * 255.0).round() as u8);
        let mut keys: Vec<[u8; 4]> = self.all.iter().map(key).collect();
        keys.sort_unstable();
        let runs = keys.chunk_by(|a, b| a == b);
        let most = runs.max_by_key(|run| run.len()).and_then(|run| run.first());
        most.map_or([0.0; 4], |key| key.map(|level| f32::from(level) / 255.0))
    }

    /// The shade of this kind, if there is an axis and the blocks seem to lie along it.
    fn shade(&self, kind: axis::Kind, choice: &ShadeChoice) -> Option<Shade> {
        let mut blocks = Self {
            all: self.all.clone(),
            ..*self
        };
        let mut found = None;
        for _ in 0..choice.rounds {
            let axis = axis::of(&blocks, kind, choice.level)?;
            let shade = profile::of(&blocks, axis, choice)?;
            let met = self.met(|block| premultiplied(&shade, block.center));
            if met.share < choice.hopeless_share {
                return None;
            }
            for block in &mut blocks.all {
                let meets = self.is_near(block, premultiplied(&shade, block.center));
                block.weight = if meets { 1.0 } else { 0.0 };
            }
            found = Some(shade);
        }
        found
    }

    fn met(&self, value: impl Fn(&Block) -> Value) -> Met {
        let mut met = Met {
            share: 0.0,
            error: 0.0,
        };
        for block in &self.all {
            let value = value(block);
            if self.is_near(block, value) {
                met.share += 1.0 / self.all.len() as f32;
            }
            let most = self.near * self.near;
            let errors = block
                .value
                .iter()
                .zip(value)
                .map(|(a, b)| (a - b) * (a - b));
            met.error += errors.map(|error| error.min(most)).sum::<f32>();
        }
        met
    }

    fn is_near(&self, block: &Block, value: Value) -> bool {
        let apart = block.value.iter().zip(value).map(|(a, b)| (a - b).abs());
        apart.fold(0.0, f32::max) <= self.near
    }

    /// The colours' gradients at each block that takes part with its neighbours, per px: by x and by y, for each channel.
    fn slopes(&self) -> impl Iterator<Item = (Point, [[f32; 2]; 4])> {
        let (columns, rows) = (self.columns, self.all.len() / self.columns);
        let inner = (1..rows.saturating_sub(1))
            .flat_map(move |y| (1..columns.saturating_sub(1)).map(move |x| y * columns + x));
        inner.filter_map(|i| {
            let near = [i - 1, i + 1, i - self.columns, i + self.columns];
            let [left, right, above, below] = near.map(|i| self.all[i]);
            let weights = [left, right, above, below, self.all[i]].map(|block| block.weight);
            if weights.contains(&0.0) {
                return None;
            }
            let slope = |c: usize| {
                [
                    (right.value[c] - left.value[c]) / (right.center.x - left.center.x),
                    (below.value[c] - above.value[c]) / (below.center.y - above.center.y),
                ]
            };
            Some((self.all[i].center, [0, 1, 2, 3].map(slope)))
        })
    }

    /// The largest offset of a page along `axis`, and the smallest.
    fn extent(&self, axis: Axis) -> [f32; 2] {
        let [width, height] = self.size;
        let corners = [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]];
        let offsets = corners.map(|[x, y]| axis.offset(Point::new(x, y)));
        [
            offsets.iter().copied().fold(f32::INFINITY, f32::min),
            offsets.iter().copied().fold(f32::NEG_INFINITY, f32::max),
        ]
    }
}

fn premultiplied(shade: &Shade, at: Point) -> Value {
    let ([r, g, b], opacity) = shade.at(at);
    [r * opacity, g * opacity, b * opacity, opacity]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::recipe::{Preset, Recipe};
    use crate::math;

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
        choose(
            picture,
            &Recipe::of(Preset::Balanced).background.shade,
            1e-3,
        )
    }

    /// The largest difference of a channel, in levels, on black.
    fn error(picture: &Image, shade: &Shade) -> f32 {
        let seen = picture.flattened([0.0; 3]);
        let planes = shade.planes(WIDTH, HEIGHT, [0.0; 3]);
        let pairs = seen.planes().iter().flatten().zip(planes.iter().flatten());
        255.0 * pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
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
        let choice = Recipe::of(Preset::Balanced).background.shade;
        assert!(choose(&ramp, &choice, 1e-4).is_some());
        assert_eq!(choose(&ramp, &choice, 1.0), None);
    }

    #[test]
    fn the_smallest_pictures_are_no_trouble() {
        for (width, height) in [(1, 1), (1, 9), (3, 2), (200, 1)] {
            let picture = Image::filled(width, height, [0.3; 3]).unwrap();
            assert_eq!(shade(&picture), None, "{width}×{height}");
        }
    }
}
