//! Layers of things: an area with the marks on it, as a face with its eyes, and marks of one colour that touch.

use kurbo::Rect;

use super::layer::{Layer, LayerKind, Written};
use crate::scene::Precedence;

/// An area that has this share of the page's sides is the page, and nobody's thing. A guess.
const PAGE: f64 = 0.9;

/// The marks of a thing, by their numbers. The first one may be the area that the others lie on.
type Thing = Vec<usize>;

/// Layers of things on a page of this size, px. Marks between them that belong to nothing share a layer.
///
/// A mark belongs to the topmost thing that it meets, if that is an area which encloses it or has a mark of its colour that it
/// touches. So it changes places with no mark that it meets, and the picture stays as it is.
pub(super) fn by_object(marks: &[Written], page: [u32; 2]) -> Vec<Layer> {
    let precedence = Precedence::of_shapes(marks.iter().map(|mark| Some(&mark.mark)));
    let mut things: Vec<Thing> = Vec::new();
    let mut thing_of: Vec<usize> = Vec::with_capacity(marks.len());
    for (i, mark) in marks.iter().enumerate() {
        // Past the topmost thing that it meets it would change the picture.
        let below = precedence.below(i);
        // Things are numbered from the back, so the largest number is the topmost one.
        let topmost = below.iter().map(|&k| thing_of[k]).max();
        // The things above the topmost one don't meet the mark, so it can be drawn before them.
        let belongs = topmost.filter(|&thing| {
            let root = &marks[things[thing][0]];
            let touches = |k: &&usize| thing_of[**k] == thing && is_alike(&marks[**k], mark);
            !is_page(root, page)
                && (root.mark.encloses(&mark.mark) || below.iter().any(|k| touches(&k)))
        });
        let thing = belongs.unwrap_or_else(|| {
            things.push(Thing::new());
            things.len() - 1
        });
        things[thing].push(i);
        thing_of.push(thing);
    }
    layers(&things, marks)
}

fn layers(things: &[Thing], marks: &[Written]) -> Vec<Layer> {
    let is_alone = |thing: &Thing| thing.len() == 1;
    // Neighbours of one mark each share a layer: a layer for each of them would say nothing.
    let runs = things.chunk_by(|a, b| is_alone(a) && is_alone(b));
    let layer = |things: &[Thing]| {
        let own = things.iter().flatten();
        let strokes: Vec<Written> = own.map(|&i| marks[i].clone()).collect();
        let color = strokes.first().map(Written::color);
        let is_thing = !things.iter().any(is_alone);
        Layer {
            strokes,
            kind: LayerKind::Object(color.filter(|_| is_thing)),
        }
    };
    runs.map(layer).collect()
}

/// True if two marks have one colour and are both strokes or both areas.
fn is_alike(a: &Written, b: &Written) -> bool {
    a.color() == b.color() && a.is_filled() == b.is_filled()
}

/// True if a mark is as large as the page.
fn is_page(mark: &Written, page: [u32; 2]) -> bool {
    let [width, height] = page.map(f64::from);
    let seen = mark
        .mark
        .bounds()
        .intersect(Rect::new(0.0, 0.0, width, height));
    seen.width() >= PAGE * width && seen.height() >= PAGE * height
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Point;
    use crate::scene::{Area, Cap, Mark, Path, PathPoint, Scene, Stage, Stroke};

    const PAGE: u32 = 100;

    fn square(x: f64, away: f64, grey: f32) -> Mark {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let points = corners
            .map(|[dx, dy]: [f64; 2]| PathPoint::on(Point::new(x + away * dx, 50.0 + away * dy)));
        let ring = Path::new(points.into(), true).unwrap();
        Area::plain(vec![ring], [grey; 3], 1.0).into()
    }

    fn line([ax, ay]: [f64; 2], [bx, by]: [f64; 2], grey: f32) -> Mark {
        let stroke = Stroke {
            path: Path::line(Point::new(ax, ay), Point::new(bx, by)),
            radius: 1.0,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [grey; 3],
            opacity: 1.0,
        };
        stroke.into()
    }

    /// The colours of the marks of each layer in tenths, and whether it is a thing.
    fn layers(marks: &[Mark]) -> Vec<(Vec<u32>, bool)> {
        let scene = Scene {
            stages: vec![Stage::from_iter(marks.to_vec())],
            ..Scene::empty(PAGE, PAGE, None)
        };
        let written = marks
            .iter()
            .map(|mark| scene.quantized_mark(mark, 2).unwrap().into());
        let written: Vec<Written> = written.collect();
        let tenths = |mark: &Written| u32::from(mark.color()[0]) * 10 / 255;
        let layer = |layer: Layer| {
            let is_thing = layer.kind != LayerKind::Object(None);
            (layer.strokes.iter().map(tenths).collect(), is_thing)
        };
        let layers = by_object(&written, [PAGE; 2]);
        layers.into_iter().map(layer).collect()
    }

    #[test]
    fn a_face_has_its_eyes_though_another_face_came_between() {
        let marks = [
            square(25.0, 20.0, 0.1),
            square(75.0, 20.0, 0.5),
            square(20.0, 3.0, 0.2),
            square(80.0, 3.0, 0.6),
            square(30.0, 3.0, 0.3),
        ];
        assert_eq!(layers(&marks), [(vec![1, 2, 3], true), (vec![5, 6], true)]);
    }

    #[test]
    fn what_lies_on_two_things_belongs_to_neither() {
        let marks = [
            square(25.0, 20.0, 0.1),
            square(70.0, 20.0, 0.5),
            line([30.0, 50.0], [60.0, 50.0], 0.9),
        ];
        assert_eq!(layers(&marks), [(vec![1, 5, 9], false)]);
    }

    #[test]
    fn strokes_of_one_colour_that_touch_are_a_thing() {
        let marks = [
            line([10.0, 10.0], [30.0, 10.0], 0.1),
            line([70.0, 10.0], [90.0, 10.0], 0.1),
            line([30.0, 10.0], [30.0, 40.0], 0.1),
        ];
        assert_eq!(layers(&marks), [(vec![1, 1], true), (vec![1], false)]);
    }

    #[test]
    fn the_page_is_nobodys_thing() {
        let marks = [
            square(50.0, 50.0, 0.1),
            square(25.0, 10.0, 0.5),
            square(25.0, 3.0, 0.6),
        ];
        assert_eq!(layers(&marks), [(vec![1], false), (vec![5, 6], true)]);
    }
}
