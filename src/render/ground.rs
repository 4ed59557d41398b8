//! The ground of a scene: all that lies behind its marks, as pixels.

mod blur;
mod fill;

pub use blur::{Plane, blurred};
pub use fill::filled;

use crate::math::{Point, Vec2};
use crate::scene::{Area, Rgb, Scene};

/// The areas of the ground of `scene` on its background or, where it has none, on `behind`: three planes, row by row.
pub fn ground(scene: &Scene, behind: Rgb) -> [Vec<f32>; 3] {
    let [width, height] = [scene.width, scene.height].map(|side| side as usize);
    let behind = scene.background.unwrap_or(behind);
    let mut planes = behind.map(|level| vec![level; width * height]);
    for area in &scene.ground {
        for (i, covered) in coverage(area, width, height).into_iter().enumerate() {
            let center = Point::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            let (color, opacity) = area.ink(center);
            for (plane, color) in planes.iter_mut().zip(color) {
                plane[i] += opacity * covered * (color - plane[i]);
            }
        }
    }
    planes
}

/// The share of each pixel of a page that an area covers, 0 to 1, without its opacity, row by row.
pub fn coverage(area: &Area, width: usize, height: usize) -> Vec<f32> {
    let extent = area.extent();
    let [low, high] =
        [[extent.x0, extent.y0], [extent.x1, extent.y1]].map(|corner| corner.map(|px| px as i64));
    // A shadow beyond the page is blurred into it, as far as a blur reaches.
    let reach = (4.0 * area.blur).ceil() as i64;
    let page = [width, height].map(|side| side as i64);
    // The rectangle to blur: the area, cut where it is too far from the page to show there.
    let origin = low.map(|at| at.max(-reach));
    let end = [0, 1].map(|axis: usize| high[axis].min(page[axis] + reach));
    let size = [0, 1].map(|axis| (end[axis] - origin[axis]).max(0) as usize);
    let shift = Vec2::new(-(origin[0] as f64), -(origin[1] as f64));
    let rings = area.rings.iter();
    // Fill, then blur, as an SVG filter does. The caller applies the opacity.
    let sharp = filled(rings.map(|ring| ring.clone().moved(shift)), size);
    let soft = match area.blur > 0.0 {
        true => blurred(sharp, area.blur),
        false => sharp,
    };
    let mut covered = vec![0.0; width * height];
    for (y, row) in soft.values.chunks_exact(soft.width.max(1)).enumerate() {
        let y = y as i64 + origin[1];
        // Copy the part of the row that is on the page.
        let first = origin[0].clamp(0, width as i64);
        let last = end[0].clamp(0, width as i64);
        if (0..height as i64).contains(&y) && first < last {
            let own = (first - origin[0]) as usize..(last - origin[0]) as usize;
            let at = y as usize * width;
            covered[at + first as usize..at + last as usize].copy_from_slice(&row[own]);
        }
    }
    covered
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Shape;
    use crate::svg::{self, WriteOptions};
    use crate::verify;

    fn shadow(blur: f32) -> Area {
        let shape = Shape::Rect {
            low: (20.0, 14.5).into(),
            high: (90.0, 61.0).into(),
            radius: 12.0,
        };
        let area = Area::plain(vec![shape.path()], [0.1, 0.2, 0.3], 0.6);
        area.blurred(blur).unwrap()
    }

    #[test]
    fn the_ground_is_what_resvg_draws_of_its_file() {
        for blur in [0.7, 1.6, 2.5, 6.0, 9.3] {
            let scene = Scene {
                ground: vec![shadow(blur)],
                ..Scene::empty(110, 80, Some([0.9, 0.8, 0.7]))
            };
            let planes = ground(&scene, [1.0; 3]);
            let text = svg::write(&scene, &WriteOptions::default());
            let size = verify::Size::Exact {
                width: 110,
                height: 80,
            };
            let seen = verify::render(&text, size, None).unwrap();
            let pairs = planes.iter().flatten().zip(seen.planes().iter().flatten());
            let apart = pairs
                .map(|(a, b)| 255.0 * (a - b).abs())
                .fold(0.0, f32::max);
            // Below 2 px resvg filters recursively, by an approximation.
            let most = if blur < 2.0 { 10.0 } else { 4.0 };
            assert!(apart < most, "{blur}: {apart} levels");
        }
    }

    #[test]
    fn a_shadow_beyond_the_page_is_blurred_into_it() {
        let whole = coverage(&shadow(6.0), 110, 80);
        let part = coverage(&shadow(6.0), 50, 80);
        for y in 0..80 {
            assert_eq!(whole[y * 110..y * 110 + 50], part[y * 50..y * 50 + 50]);
        }
    }
}
