//! The pixels that resvg covers with a single stroke.

use std::ops::Range;

use resvg::tiny_skia::{FillRule, Mask as Raster, Path as Outline, PathBuilder, Rect, Transform};

use super::footprint::Footprint;
use crate::outline;
use crate::scene::{Mark, Path};

/// The pixels of a picture of `width`×`height` px that `mark`, which is as its file has it, covers.
pub(super) fn footprint(mark: &Mark, width: usize, height: usize) -> Footprint {
    covered(mark, [width, height]).unwrap_or_default()
}

fn covered(mark: &Mark, size: [usize; 2]) -> Option<Footprint> {
    let outline = match mark {
        Mark::Stroke(stroke) => outline::stroked(stroke, 1.0)?,
        Mark::Area(area) if let Some(band) = area.band() => outline::of_band(&band)?,
        Mark::Area(area) => outline_of_rings(&area.rings)?,
    };
    filled(&outline, size)
}

fn outline_of_rings(rings: &[Path]) -> Option<Outline> {
    let mut builder = PathBuilder::new();
    rings
        .iter()
        .for_each(|ring| outline::push(&mut builder, ring, 1.0));
    builder.finish()
}

fn filled(outline: &Outline, size: [usize; 2]) -> Option<Footprint> {
    // Only the box of the outline is drawn. It lies on whole pixels, so that samples fall where they do on the page.
    let [columns, rows] = touched(outline.bounds(), size);
    let mut raster = Raster::new(columns.len() as u32, rows.len() as u32)?;
    let corner = Transform::from_translate(-(columns.start as f32), -(rows.start as f32));
    raster.fill_path(outline, FillRule::Winding, true, corner);
    let width = size[0];
    let levels = rows.zip(raster.data().chunks_exact(columns.len()));
    let covered = levels.flat_map(|(y, levels)| (y * width + columns.start..).zip(levels));
    let covered = covered.map(|(pixel, &level)| (pixel as u32, level));
    Some(covered.collect())
}

/// The columns and rows of a picture of `size` that a box touches.
fn touched(bounds: Rect, size: [usize; 2]) -> [Range<usize>; 2] {
    let sides = [
        (bounds.left(), bounds.right()),
        (bounds.top(), bounds.bottom()),
    ];
    [0, 1].map(|axis| {
        let (low, high) = sides[axis];
        let end = (high.ceil().max(0.0) as usize).min(size[axis]);
        (low.floor().max(0.0) as usize).min(end)..end
    })
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use proptest::prelude::*;

    use super::*;
    use crate::math::{self, Point, nearest_on_segment};
    use crate::scene::{Area, Band, PathPoint, Scene, Stage, Stroke};
    use crate::svg::{self, WriteOptions};
    use crate::verify::{self, Size};

    /// The farthest that a place of the page within the stroke's discs is from their edge, of places that are not covered.
    fn deepest_hole(stroke: &Stroke, side: usize) -> f32 {
        let covered: HashSet<u32> = footprint(&stroke.clone().into(), side, side)
            .iter()
            .filter(|&(_, level)| level >= 128)
            .map(|(pixel, _)| pixel)
            .collect();
        let line = stroke.path.flattened(0.02);
        let depth = |pixel: usize| {
            let p = [pixel % side, pixel / side].map(|at| at as f32 + 0.5);
            let away2 = |ends: &[Point]| nearest_on_segment(p, [ends[0].into(), ends[1].into()]).1;
            let depths = line
                .windows(2)
                .map(|ends| stroke.radius - away2(ends).sqrt());
            depths.fold(f32::MIN, f32::max)
        };
        let holes = (0..side * side).filter(|&pixel| !covered.contains(&(pixel as u32)));
        holes.map(depth).fold(f32::MIN, f32::max)
    }

    proptest! {
        #[test]
        fn no_written_stroke_has_a_hole(
            points in prop::collection::vec((-1.5..1.5_f32, -1.5..1.5_f32, any::<bool>()), 3..11),
            [x, y] in [3.0..45.0_f32, 3.0..45.0_f32],
            radius in 2.0..42.0_f32,
            is_round in any::<bool>(),
        ) {
            // A loop around the page's middle, or any points.
            let count = points.len() as f32;
            let points = points.iter().enumerate().map(|(i, &(dx, dy, is_on))| {
                let (sin, cos) = math::sin_cos(i as f32 / count * std::f32::consts::TAU);
                let [u, v] = if is_round { [cos + 0.2 * dx, sin + 0.2 * dy] } else { [dx, dy] };
                PathPoint { at: Point::new(60.0 + x * u, 60.0 + y * v), is_on }
            });
            let stroke = Stroke {
                path: Path::new(points.collect(), true).unwrap(),
                radius,
                color: [0.0; 3],
                opacity: 1.0,
            };
            let written = Scene::empty(120, 120, None).quantized_mark(&stroke.into(), 2).unwrap();
            let written = written.as_stroke().unwrap();
            prop_assert!(deepest_hole(written, 120) < 1.5, "{written:?}");
        }
    }

    #[test]
    fn a_band_is_drawn_as_its_rings() {
        let [on, off] = [PathPoint::on, PathPoint::off];
        let bent = vec![
            on([15.0, 20.0].into()),
            off([25.0, 34.0].into()),
            off([40.0, 41.0].into()),
            off([60.0, 40.0].into()),
            on([82.0, 22.0].into()),
        ];
        let corners = vec![
            on([20.0, 70.0].into()),
            on([50.0, 15.0].into()),
            on([80.0, 75.5].into()),
        ];
        let (size, closed) = (100, corners.clone());
        for (points, is_closed, most) in
            [(bent, false, 32), (corners, false, 16), (closed, true, 16)]
        {
            let line = Path::new(points, is_closed).unwrap();
            let band = Band { line, width: 7.5 };
            let area = Area {
                rings: band.rings(),
                color: [0.0; 3],
                opacity: 1.0,
                shade: None,
            };
            let found = area.band().unwrap();
            assert!((found.width - 7.5).abs() < 1e-4, "{found:?}");
            let [of_band, of_rings] = [
                outline::of_band(&band).unwrap(),
                outline_of_rings(&area.rings).unwrap(),
            ]
            .map(|outline| filled(&outline, [size; 2]).unwrap());
            let level = |footprint: &Footprint, pixel: u32| {
                let found = footprint.iter().find(|(at, _)| *at == pixel);
                found.map_or(0, |(_, level)| i32::from(level))
            };
            let pixels = 0..(size * size) as u32;
            let apart =
                pixels.map(|pixel| (level(&of_band, pixel) - level(&of_rings, pixel)).abs());
            let apart = apart.max().unwrap();
            assert!(apart <= most, "{apart} {band:?}");
        }
    }

    #[test]
    fn footprints_are_what_resvg_draws_in_white_on_black() {
        let (width, height) = (60, 50);
        let [on, off] = [PathPoint::on, PathPoint::off];
        let bent = |closed| {
            let points = vec![
                on([-5.0, 20.0].into()),
                off([70.0, 3.25].into()),
                on([40.0, 44.5].into()),
                on([12.0, 41.0].into()),
            ];
            Path::new(points, closed).unwrap()
        };
        let paths = [
            bent(false),
            bent(true),
            Path::line([20.0, 9.0].into(), [44.5, 30.25].into()),
            Path::dot([25.5, 24.5].into()),
        ];
        for path in paths {
            let stroke = Stroke {
                path,
                radius: 1.75,
                color: [1.0; 3],
                opacity: 1.0,
            };
            let scene = Scene {
                stages: vec![Stage::from_iter([stroke.clone()])],
                ..Scene::empty(width, height, Some([0.0; 3]))
            };
            let text = svg::write(&scene, &WriteOptions::default());
            let drawn = verify::render(&text, Size::Exact { width, height }, None).unwrap();
            let drawn = (0..).zip(drawn.to_rgb8().into_iter().step_by(3));
            let footprint = footprint(&stroke.clone().into(), width as usize, height as usize);
            assert_eq!(footprint, drawn.collect(), "{:?}", stroke.path);
        }
    }
}
