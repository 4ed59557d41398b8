//! An A-buffer: which strokes cover each pixel, and how much of it, for each rasteriser.
//!
//! Where strokes in front let through `T` and those behind have the colour `B`, a stroke of colour `c` and opacity `o` that
//! covers `m` of a pixel adds `m·T·o·(c − B)` to its colour. So the squared error there is a polynomial of the second
//! degree in `m`. Levels are not rounded here; the pictures begin as renderers have rounded them.
//!
//! Source: Carpenter, "The A-buffer, an antialiased hidden surface method", SIGGRAPH 1984.

use std::cmp::Ordering;

use crate::fit::file::RenderedFile;
use crate::fit::renderers::Renderings;
use crate::fit::run::session::Session;
use crate::image::Image;
use crate::math::Point;
use crate::rasters::{Footprint, PerRasterizer, Rasterizer, Selection};
use crate::scene::{Mark, Rgb};

/// Most surfaces of a drawing.
const SURFACES: usize = 2;

/// A colour for each surface.
type Colors = [Rgb; SURFACES];

/// A stroke in a pixel.
#[derive(Debug, Clone, Copy)]
struct Fragment {
    stroke: u32,
    /// Coverage of the pixel, 0 to 255.
    levels: PerRasterizer<u8>,
}

/// Which strokes cover each pixel.
pub(super) struct Fragments {
    surfaces: usize,
    /// Of the picture, px.
    width: usize,
    /// Weight of an error at each pixel, if not everywhere alike.
    weights: Option<Vec<f32>>,
    targets: Vec<Colors>,
    /// Backdrop of all strokes.
    backdrops: Vec<Colors>,
    /// The strokes of each pixel, back to front.
    lists: Vec<Vec<Fragment>>,
    pictures: PerRasterizer<Vec<Colors>>,
}

/// View of a stroke in a pixel.
#[derive(Debug, Clone, Copy)]
struct Sight {
    /// Coverage of the pixel, 0 to 255.
    level: u8,
    /// Transmittance of the strokes in front.
    through: f32,
    /// The colours behind it.
    behind: Colors,
}

/// Response of a pixel to the coverage by a stroke.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Response {
    /// Coverage of the pixel by the stroke, 0 to 255.
    level: u8,
    /// Change of the colours by full coverage.
    whole: Colors,
    /// The squared error that coverage adds: the coefficients of its first and its second power.
    coefficients: [f32; 2],
}

impl Fragments {
    /// The fragments of the strokes of `file`, `written` as they are there, which cover `footprints`.
    pub(super) fn of(
        session: &Session<'_>,
        file: &RenderedFile,
        seen: &Renderings,
        written: &[Option<Mark>],
        footprints: &[PerRasterizer<Footprint>],
    ) -> Self {
        let surfaces = session.drawing.surfaces.iter();
        let (targets, backdrops): (Vec<_>, Vec<_>) = surfaces
            .map(|surface| {
                let backdrop = surface.backdrop_canvas(&file.rounded.scene).to_image();
                (surface.picture().clone(), backdrop)
            })
            .unzip();
        let width = targets.first().map_or(1, Image::width);
        let (targets, backdrops) = (colors(&targets), colors(&backdrops));
        let mut fragments = Self {
            surfaces: session.drawing.surfaces.len(),
            width,
            weights: session.focus.as_ref().map(|focus| focus.values().to_vec()),
            lists: vec![Vec::new(); targets.len()],
            pictures: [
                colors(&file.drawn),
                colors(seen.chromium()),
                backdrops.clone(),
            ],
            targets,
            backdrops,
        };
        for (id, footprints) in footprints.iter().enumerate() {
            for (rasterizer, footprint) in footprints.iter().enumerate() {
                for (pixel, level) in footprint.iter() {
                    fragments.level_mut(pixel as usize, id)[rasterizer] = level;
                }
            }
        }
        // Nobody has drawn exact areas yet.
        let composed = fragments.pictures.last_mut().into_iter().flatten();
        for (pixel, (colors, list)) in composed.zip(&fragments.lists).enumerate() {
            for fragment in list {
                if let Some(mark) = &written[fragment.stroke as usize] {
                    let [.., level] = fragment.levels;
                    let (color, opacity) = mark.ink(center(pixel, width));
                    blend(colors, share(level) * opacity, color);
                }
            }
        }
        fragments
    }

    /// Where it is kept how much of a pixel stroke `id` covers.
    fn level_mut(&mut self, pixel: usize, id: usize) -> &mut PerRasterizer<u8> {
        let (list, stroke) = (&mut self.lists[pixel], id as u32);
        let at = match list.binary_search_by_key(&stroke, |fragment| fragment.stroke) {
            Ok(at) => at,
            Err(at) => {
                let levels = Default::default();
                list.insert(at, Fragment { stroke, levels });
                at
            }
        };
        &mut list[at].levels
    }

    /// The mean squared error of each rasteriser's pictures, on the surface where it is largest.
    pub(super) fn errors(&self) -> PerRasterizer<f64> {
        self.pictures.each_ref().map(|pictures| {
            let of = |surface: usize| {
                let pixels = pictures.iter().zip(&self.targets).enumerate();
                let errors = pixels.map(|(pixel, (picture, target))| {
                    let channels = picture[surface].iter().zip(target[surface]);
                    let error = channels.map(|(a, b)| (a - b) * (a - b)).sum::<f32>();
                    f64::from(self.weight(pixel) * error)
                });
                errors.sum()
            };
            (0..self.surfaces).map(of).fold(0.0, f64::max) / self.values()
        })
    }

    /// Number of values of a picture, each as often as its error counts.
    fn values(&self) -> f64 {
        let pixels = 0..self.targets.len();
        3.0 * pixels
            .map(|pixel| f64::from(self.weight(pixel)))
            .sum::<f64>()
    }

    /// Weight of an error at a pixel.
    fn weight(&self, pixel: usize) -> f32 {
        self.weights.as_ref().map_or(1.0, |weights| weights[pixel])
    }

    /// Responses of these pixels to stroke `id`.
    pub(super) fn responses(
        &self,
        id: usize,
        strokes: &[Option<Mark>],
        pixels: &[u32],
    ) -> Vec<PerRasterizer<Response>> {
        let Some(stroke) = &strokes[id] else {
            return Vec::new();
        };
        let responses = pixels.iter().map(|&pixel| {
            let pixel = pixel as usize;
            let sights = self.sights(id, strokes, pixel);
            std::array::from_fn(|i| {
                let colors = [&self.pictures[i][pixel], &self.targets[pixel]];
                let response = Response::of(stroke, &sights[i], colors, self.surfaces);
                response.weighted(self.weight(pixel))
            })
        });
        responses.collect()
    }

    /// Views of stroke `id` in a pixel.
    fn sights(&self, id: usize, strokes: &[Option<Mark>], pixel: usize) -> PerRasterizer<Sight> {
        let mut sights = [Sight {
            level: 0,
            through: 1.0,
            behind: self.backdrops[pixel],
        }; Rasterizer::ALL.len()];
        for fragment in &self.lists[pixel] {
            let Some(other) = &strokes[fragment.stroke as usize] else {
                continue;
            };
            let order = (fragment.stroke as usize).cmp(&id);
            let (color, opacity) = other.ink(center(pixel, self.width));
            for (sight, &level) in sights.iter_mut().zip(&fragment.levels) {
                let m = share(level) * opacity;
                match order {
                    Ordering::Less => blend(&mut sight.behind, m, color),
                    Ordering::Equal => sight.level = level,
                    Ordering::Greater => sight.through *= 1.0 - m,
                }
            }
        }
        sights
    }

    /// Changes what stroke `id` covers of these pixels.
    pub(super) fn change(&mut self, id: usize, pixels: &[u32], changes: &[Change]) {
        for &Change {
            slot,
            levels,
            colors,
        } in changes
        {
            let pixel = pixels[slot] as usize;
            *self.level_mut(pixel, id) = levels;
            for (pictures, change) in self.pictures.iter_mut().zip(colors) {
                let values = pictures[pixel].as_flattened_mut().iter_mut();
                let change = change.as_flattened();
                values
                    .zip(change)
                    .for_each(|(value, change)| *value += change);
            }
        }
    }
}

/// Change of a pixel, one of some, when a stroke moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    slot: usize,
    levels: PerRasterizer<u8>,
    /// Change of the colours.
    colors: PerRasterizer<Colors>,
}

/// Changes of the pixels of `selection`, of these `responses`, when a stroke comes to cover `footprints`.
pub(super) fn changes(
    responses: &[PerRasterizer<Response>],
    footprints: &PerRasterizer<Footprint>,
    selection: &Selection<'_>,
) -> Vec<Change> {
    let mut levels = vec![PerRasterizer::default(); responses.len()];
    for (rasterizer, footprint) in footprints.iter().enumerate() {
        for (slot, level) in selection.covered(footprint) {
            levels[slot][rasterizer] = level;
        }
    }
    let changes = responses.iter().zip(levels).enumerate();
    let changed = changes
        .filter(|(_, (response, levels))| response.map(|response| response.level) != *levels);
    let change =
        |(slot, (response, levels)): (usize, (&PerRasterizer<Response>, PerRasterizer<u8>))| {
            Change {
                slot,
                levels,
                colors: std::array::from_fn(|i| {
                    let more = share(levels[i]) - share(response[i].level);
                    response[i].whole.map(|rgb| rgb.map(|v| more * v))
                }),
            }
        };
    changed.map(change).collect()
}

impl Response {
    /// That to a `mark` as it is seen, of a pixel with these colours in picture and target, on so many surfaces.
    fn of(
        mark: &Mark,
        &Sight {
            level,
            through,
            behind,
        }: &Sight,
        [picture, target]: [&Colors; 2],
        surfaces: usize,
    ) -> Self {
        let mut response = Self {
            level,
            ..Self::default()
        };
        let color = mark.color();
        let factor = through * mark.opacity();
        for surface in 0..surfaces {
            for channel in 0..3 {
                let whole = factor * (color[channel] - behind[surface][channel]);
                let present = picture[surface][channel] - target[surface][channel];
                let without = present - share(level) * whole;
                response.whole[surface][channel] = whole;
                response.coefficients[0] += 2.0 * without * whole;
                response.coefficients[1] += whole * whole;
            }
        }
        response
    }

    /// This response where an error has this weight.
    fn weighted(self, weight: f32) -> Self {
        Self {
            coefficients: self.coefficients.map(|term| weight * term),
            ..self
        }
    }

    /// The squared error that a stroke adds that covers so much of the pixel.
    pub(super) fn error_at(&self, level: u8) -> f32 {
        let m = share(level);
        m * (self.coefficients[0] + m * self.coefficients[1])
    }

    /// The squared error that the stroke adds now.
    pub(super) fn error(&self) -> f32 {
        self.error_at(self.level)
    }
}

/// The centre of a pixel of a picture of this width.
fn center(pixel: usize, width: usize) -> Point {
    let (x, y) = (pixel % width, pixel / width);
    Point::new(x as f32 + 0.5, y as f32 + 0.5)
}

fn share(level: u8) -> f32 {
    f32::from(level) / 255.0
}

fn blend(behind: &mut Colors, m: f32, color: Rgb) {
    for behind in behind {
        for (value, color) in behind.iter_mut().zip(color) {
            *value += m * (color - *value);
        }
    }
}

/// The colours of each pixel in pictures of one size.
fn colors(pictures: &[Image]) -> Vec<Colors> {
    let planes = pictures.first().map(Image::planes);
    let mut colors = vec![Colors::default(); planes.map_or(0, |[red, ..]| red.len())];
    for (surface, picture) in pictures.iter().enumerate() {
        for (channel, plane) in picture.planes().iter().enumerate() {
            for (colors, &value) in colors.iter_mut().zip(plane) {
                colors[surface][channel] = value;
            }
        }
    }
    colors
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rasters::Rasters;
    use crate::rng;
    use crate::scene::{Path, Stroke};

    const PIXELS: usize = 30;

    fn draw(key: u64, i: usize) -> f32 {
        rng::draw(0, 1, key, i as u64)
    }

    fn footprint(key: u64) -> Footprint {
        let level = |i: usize| (255.0 * draw(key, i)) as u8;
        (0..PIXELS as u32).zip((0..PIXELS).map(level)).collect()
    }

    fn stroke(key: u64) -> Mark {
        Mark::from(Stroke {
            path: Path::dot([0.0, 0.0].into()),
            radius: 1.0,
            color: [0, 1, 2].map(|c| draw(key, 900 + c)),
            opacity: 0.3 + 0.7 * draw(key, 990),
        })
    }

    /// The pictures of strokes that cover these footprints.
    fn composed(
        backdrops: &[Colors],
        strokes: &[Option<Mark>],
        footprints: &[PerRasterizer<Footprint>],
    ) -> PerRasterizer<Vec<Colors>> {
        std::array::from_fn(|i| {
            let mut pictures = backdrops.to_vec();
            for (stroke, footprints) in strokes.iter().flatten().zip(footprints) {
                for (pixel, level) in footprints[i].iter() {
                    let m = share(level) * stroke.opacity();
                    blend(&mut pictures[pixel as usize], m, stroke.color());
                }
            }
            pictures
        })
    }

    fn collected(footprints: &[PerRasterizer<Footprint>], strokes: &[Option<Mark>]) -> Fragments {
        let colors = |key: u64| {
            let color = |i: usize| [0, 1, 2].map(|c| draw(key, 3 * i + c));
            (0..PIXELS).map(|i| [color(i), color(i + PIXELS)]).collect()
        };
        let backdrops: Vec<Colors> = colors(50);
        let mut fragments = Fragments {
            surfaces: SURFACES,
            width: PIXELS,
            weights: Some((0..PIXELS).map(|i| draw(60, i)).collect()),
            targets: colors(51),
            pictures: composed(&backdrops, strokes, footprints),
            backdrops,
            lists: vec![Vec::new(); PIXELS],
        };
        for (id, footprints) in footprints.iter().enumerate() {
            for (rasterizer, footprint) in footprints.iter().enumerate() {
                for (pixel, level) in footprint.iter() {
                    fragments.level_mut(pixel as usize, id)[rasterizer] = level;
                }
            }
        }
        fragments
    }

    #[test]
    fn what_a_footprint_does_to_pictures_and_errors_is_foretold() {
        let strokes: Vec<Option<Mark>> = (0..4).map(|key| Some(stroke(key))).collect();
        let keys = |id: u64| [10 * id + 100, 10 * id + 101, 10 * id + 102];
        let mut footprints: Vec<PerRasterizer<Footprint>> =
            (0..4).map(|id| keys(id).map(footprint)).collect();
        let mut fragments = collected(&footprints, &strokes);
        let pixels: Vec<u32> = (0..PIXELS as u32).collect();
        for id in [2, 0, 3] {
            let responses = fragments.responses(id, &strokes, &pixels);
            let moved = keys(id as u64).map(|key| footprint(key + 1000));
            let error = |i: usize, footprint: &Footprint| -> f32 {
                let levels = footprint
                    .iter()
                    .map(|(pixel, level)| responses[pixel as usize][i].error_at(level));
                levels.sum()
            };
            let foretold: PerRasterizer<f32> =
                std::array::from_fn(|i| error(i, &moved[i]) - error(i, &footprints[id][i]));
            let before = all_errors(&fragments);
            let mut scratch = Rasters::new([PIXELS, 1]);
            let changes = scratch.on(&pixels, |selection| changes(&responses, &moved, selection));
            fragments.change(id, &pixels, &changes);
            footprints[id] = moved;
            let expected = composed(&fragments.backdrops, &strokes, &footprints);
            for (pictures, expected) in fragments.pictures.iter().zip(&expected) {
                for (a, b) in pictures
                    .as_flattened()
                    .as_flattened()
                    .iter()
                    .zip(expected.as_flattened().as_flattened())
                {
                    assert!((a - b).abs() < 1e-5, "{a} {b}");
                }
            }
            for ((after, before), foretold) in
                all_errors(&fragments).iter().zip(before).zip(foretold)
            {
                assert!(
                    (after - before - foretold).abs() < 1e-4,
                    "{before} {after} {foretold}"
                );
            }
        }
    }

    /// The weighted squared error of each rasteriser, on all surfaces.
    fn all_errors(fragments: &Fragments) -> PerRasterizer<f32> {
        fragments.pictures.each_ref().map(|pictures| {
            let pixels = pictures.iter().zip(&fragments.targets).enumerate();
            let error = pixels.map(|(pixel, (a, b))| {
                let values = a.as_flattened().iter().zip(b.as_flattened());
                fragments.weight(pixel) * values.map(|(a, b)| (a - b) * (a - b)).sum::<f32>()
            });
            error.sum()
        })
    }
}
