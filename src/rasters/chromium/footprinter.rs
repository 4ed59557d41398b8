//! Footprints of single strokes.

use super::accumulator::Accumulator;
use super::contour::Contour;
use super::outline::Outline;
use super::window::Window;
use crate::rasters::footprint::Footprint;
use crate::scene::Mark;

/// Tells of single strokes how much of each pixel a browser covers with them; keeps its memory from call to call.
pub(in crate::rasters) struct Footprinter {
    size: [usize; 2],
    windows: Vec<(Window, Accumulator)>,
    outline: Outline,
}

impl Footprinter {
    /// One for pictures of `width`×`height` px.
    pub(in crate::rasters) fn new(width: usize, height: usize) -> Self {
        let windows = Window::all(width, height).into_iter();
        Self {
            size: [width, height],
            windows: windows
                .map(|window| (window, Accumulator::new(window.size[0], window.size[1])))
                .collect(),
            outline: Outline::default(),
        }
    }

    /// The pixels that `mark` covers.
    pub(in crate::rasters) fn footprint(&mut self, mark: &Mark) -> Footprint {
        let contour = Contour::of(mark);
        let [width, _] = self.size;
        let mut pixels = Vec::new();
        for (window, accumulator) in &mut self.windows {
            if !window.touches(contour.bounds) {
                continue;
            }
            self.outline.follow(&contour, *window);
            let [columns, rows] = window.shown(self.size);
            let [left, top] = window.corner;
            // Tiles overlap: each tells of the pixels that it shows.
            accumulator.fill(&self.outline, |y, x, coverages| {
                let y = top + y;
                if !rows.contains(&y) {
                    return;
                }
                for (x, &coverage) in (left + x..columns.end).zip(coverages) {
                    if x >= columns.start {
                        pixels.push(((y * width + x) as u32, coverage));
                    }
                }
            });
        }
        // Windows beside each other take turns in a row.
        if !pixels.is_sorted() {
            pixels.sort_unstable();
        }
        pixels.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::draw;
    use super::*;
    use crate::image::Image;
    use crate::scene::{Path, PathPoint, Stroke};

    #[test]
    fn footprints_are_what_is_drawn_in_white_on_black() {
        let (width, height) = (300, 270);
        let [on, off] = [PathPoint::on, PathPoint::off];
        let bent = vec![
            on([-5.0, 20.0].into()),
            off([320.0, 40.0].into()),
            on([240.0, 280.0].into()),
        ];
        let paths = [
            Path::new(bent, false).unwrap(),
            Path::line([20.0, 9.0].into(), [290.0, 260.0].into()),
            Path::dot([254.5, 254.5].into()),
            Path::dot([900.0, 9.0].into()),
        ];
        let mut footprinter = Footprinter::new(width, height);
        for path in paths {
            let stroke = Stroke {
                path,
                radius: 1.7,
                color: [1.0; 3],
                opacity: 1.0,
            };
            let page = Image::filled(width, height, [0.0; 3]).unwrap();
            let stroke = Mark::Stroke(stroke);
            let drawn = draw([&stroke].into_iter(), &[page]).remove(0).to_rgb8();
            let drawn = (0..).zip(drawn.into_iter().step_by(3));
            assert_eq!(footprinter.footprint(&stroke), drawn.collect());
        }
    }
}
