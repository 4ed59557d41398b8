//! Reorders strokes so that strokes of equal colour, width and opacity (of one *style*) become neighbours.
//!
//! Two strokes may swap if they share no pixel or have the same colour. Among the orders that keep all other
//! pairs as they are, a greedy search picks one with few changes of style. The result depends only on the
//! strokes and on which lies above which, so arranging twice changes nothing.

use std::collections::{BTreeMap, BTreeSet};

use super::dialect::Unit;
use super::layer::{Layer, LayerKind, Written};
use super::objects;
use super::options::{Form, Group, Order, WriteOptions};
use super::path::{self, Kind};
use super::tour;
use crate::scene::{Mark, Path, Precedence, Scene, Stage, units};

/// The layers of the file, none of them empty.
pub(super) fn layers(scene: &Scene, options: &WriteOptions) -> Vec<Layer> {
    let written = |stage: &Stage| -> Vec<_> {
        let marks = stage.marks.iter();
        marks
            .filter_map(|mark| scene.quantized_mark(mark, options.precision))
            .map(|mark| Written::rounded(mark, options.precision))
            .collect()
    };
    let stages = scene.stages.iter().map(written);
    let stages = stages.filter(|strokes| !strokes.is_empty());
    // 1. Layers: stages, colours or objects.
    let mut layers: Vec<_> = match options.group {
        Group::Stage => stages
            .map(|strokes| Layer {
                strokes,
                kind: LayerKind::Stage,
            })
            .collect(),
        Group::Color => by_color(stages.flatten().collect()),
        Group::Object => {
            let marks: Vec<Written> = stages.flatten().collect();
            objects::by_object(&marks, [scene.width, scene.height])
        }
    };
    // Objects are found by the order of marks: another order could give other objects when the file is written again.
    if options.group == Group::Object {
        return layers;
    }
    // 2. Strokes of one style side by side, as one `d` or one group serves them all.
    if options.form == Form::Smallest {
        for layer in &mut layers {
            let strokes = layer.strokes.iter_mut();
            strokes.for_each(|stroke| orient(stroke, options.unit()));
            layer.strokes = arranged(std::mem::take(&mut layer.strokes), style_of, Written::width);
        }
    }
    // 3. Short ways between strokes, within what the style's order leaves free.
    if options.order == Order::Travel {
        for layer in &mut layers {
            layer.strokes = with_little_travel(std::mem::take(&mut layer.strokes), options.form);
        }
    }
    layers
}

/// The strokes of a layer in an order of little travel. In the smallest form, strokes of one style stay together.
fn with_little_travel(strokes: Vec<Written>, form: Form) -> Vec<Written> {
    let mut shortened = Vec::with_capacity(strokes.len());
    let is_together =
        |a: &Written, b: &Written| form != Form::Smallest || style_of(a) == style_of(b);
    for run in strokes.chunk_by(is_together) {
        let from = tour::end(&shortened);
        shortened.extend(tour::shortened(run, from));
    }
    // The tours of the runs start where the last one ends, and may be longer in sum than the order as it was.
    if tour::between(&shortened) < tour::between(&strokes) {
        shortened
    } else {
        strokes
    }
}

/// The scene in the order and the layers of its file: what [`read`](super::read) returns for the text that
/// [`write`](super::write()) wrote, unless it wrote outlines, which are areas.
pub fn arrange(scene: &Scene, options: &WriteOptions) -> Scene {
    let stage = |layer: &Layer| layer.strokes.iter().map(|mark| mark.mark.clone()).collect();
    let quantized = scene.quantized(options.precision).scene;
    Scene {
        stages: layers(&quantized, options).iter().map(stage).collect(),
        ..quantized
    }
}

/// Starts a stroke at the end that makes its path shorter. Shapes stay as they are, and rings keep their sense, which makes holes.
fn orient(mark: &mut Written, unit: Unit) {
    let Mark::Stroke(stroke) = &mut mark.mark else {
        return;
    };
    // The line of an outline stays as it is, too.
    if stroke.path.shape().is_some() || stroke.is_varying() {
        return;
    }
    let length = |path: &Path| path::data([path], Kind::Line, unit).len();
    let mut turned = stroke.path.turned();
    // A turned path may have fewer points than its other direction had, so that this is asked until it settles.
    while length(&turned) < length(&stroke.path) {
        stroke.path = turned;
        turned = stroke.path.turned();
    }
}

/// Numbers that strokes must have in common to be one path.
pub(super) fn style_of(stroke: &Written) -> (i64, [u8; 3], u8) {
    (stroke.width(), stroke.color(), stroke.opacity())
}

/// Number of strokes that are arranged together. Comparing the pairs of more would take long.
const WINDOW: usize = 4096;

/// Layers of one colour.
fn by_color(strokes: Vec<Written>) -> Vec<Layer> {
    // Two candidates, and the one of fewer layers is taken; of equal ones the first, which changes nothing.
    let in_order = strokes.clone();
    let arranged = arranged(strokes, Written::color, |_| ());
    // Strokes that a fit has stacked by colour stay as they are, however many there are.
    let best = [in_order, arranged]
        .into_iter()
        .min_by_key(|strokes| runs(strokes).count());
    let best = best.unwrap_or_default();
    let mut seen: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    let mut layers = Vec::new();
    for run in runs(&best) {
        let color = run.first().map_or([0; 3], Written::color);
        let count = seen.entry(color).or_default();
        layers.push(Layer {
            strokes: run.to_vec(),
            kind: LayerKind::Color(color, *count),
        });
        // A colour that comes again gets the next number, so that names of layers differ.
        *count += 1;
    }
    layers
}

/// Neighbours of one colour.
fn runs(strokes: &[Written]) -> impl Iterator<Item = &[Written]> {
    strokes.chunk_by(|a, b| a.color() == b.color())
}

/// Reorders strokes so that strokes of one `run` are together as far as possible, and runs of one `group_key` follow each
/// other.
fn arranged<R: Ord, K: Ord>(
    mut strokes: Vec<Written>,
    run: impl Fn(&Written) -> R,
    group_key: impl Fn(&Written) -> K,
) -> Vec<Written> {
    // Windows are arranged one by one, in order: a stroke never leaves its window, so the precedence between windows holds.
    for window in strokes.chunks_mut(WINDOW) {
        let order = order(window, &run, &group_key);
        let sorted: Vec<_> = order.iter().map(|&i| window[i].clone()).collect();
        window.clone_from_slice(&sorted);
    }
    strokes
}

fn order<R: Ord, K: Ord>(
    strokes: &[Written],
    run: impl Fn(&Written) -> R,
    group_key: impl Fn(&Written) -> K,
) -> Vec<usize> {
    // Kahn's topological sort: the strokes with all below them drawn are free, and a greedy choice among them is next.
    let precedence = Precedence::of(strokes.iter().map(|stroke| &stroke.mark));
    let mut waiting = precedence.waiting();
    let ranks = ranks(strokes);
    let mut runs: BTreeMap<R, Run> = BTreeMap::new();
    for stroke in strokes {
        runs.entry(run(stroke)).or_default().left += 1;
    }
    let mut free = waiting.free();
    let mut order: Vec<usize> = Vec::with_capacity(strokes.len());
    loop {
        for i in free {
            let run = runs.entry(run(&strokes[i])).or_default();
            // By rank, not by index: the order of equal choices mustn't depend on the order that came in.
            run.ready.insert((ranks[i], i));
        }
        let Some(next) = take(&mut runs, strokes, order.last().copied(), &run, &group_key) else {
            return order;
        };
        order.push(next);
        free = waiting.draw(next);
    }
}

/// The strokes of one style.
#[derive(Default)]
struct Run {
    /// Strokes that may be placed next, each behind its rank.
    ready: BTreeSet<(usize, usize)>,
    /// Number of strokes that are not placed yet, ready or not.
    left: usize,
}

/// For each stroke its place in an order that depends on nothing but what strokes are.
fn ranks(strokes: &[Written]) -> Vec<usize> {
    let key = |stroke: &Written| {
        let points = stroke.paths().iter().flat_map(Path::points);
        let points = points.flat_map(|p| [units(p.at.x), units(p.at.y), -(p.kind as i64)]);
        let style = (stroke.mark.is_butt(), style_of(stroke));
        (points.collect::<Vec<i64>>(), style)
    };
    let keys: BTreeSet<_> = strokes.iter().map(key).collect();
    let ranks: BTreeMap<_, usize> = keys.into_iter().zip(0..).collect();
    strokes.iter().map(|stroke| ranks[&key(stroke)]).collect()
}

/// Takes a stroke of the same style as the last one, or begins a run.
fn take<R: Ord, K: Ord>(
    runs: &mut BTreeMap<R, Run>,
    strokes: &[Written],
    last: Option<usize>,
    run: impl Fn(&Written) -> R,
    group_key: impl Fn(&Written) -> K,
) -> Option<usize> {
    let may_go_on = |key: &R| runs.get(key).is_some_and(|run| !run.ready.is_empty());
    let last = last.map(|i| &strokes[i]);
    // Go on with the run as long as it has free strokes; a run that waits for others is broken.
    let key = last.map(&run).filter(may_go_on);
    let key = key.or_else(|| begin(runs, strokes, last.map(&group_key), group_key).map(run))?;
    let run = runs.get_mut(&key)?;
    run.left -= 1;
    run.ready.pop_first().map(|(_, i)| i)
}

/// The first stroke of the next run. It prefers a run that can be placed as a whole, then one of the `last` group,
/// then one of the group with the most such runs, then the run with the most strokes ready.
fn begin<'a, R, K: Ord>(
    runs: &BTreeMap<R, Run>,
    strokes: &'a [Written],
    last: Option<K>,
    group_key: impl Fn(&Written) -> K,
) -> Option<&'a Written> {
    let ready = || {
        runs.values()
            .filter_map(|run| Some((run, &strokes[run.ready.first()?.1])))
    };
    let is_whole = |run: &Run| run.ready.len() == run.left;
    let mut counts = BTreeMap::<K, usize>::new();
    for (_, first) in ready().filter(|(run, _)| is_whole(run)) {
        *counts.entry(group_key(first)).or_default() += 1;
    }
    let rank = |(run, first): &(&Run, &Written)| {
        let group = Some(group_key(first));
        let relatives = group.as_ref().and_then(|group| counts.get(group)).copied();
        // Compared in this order. Whole runs first, as a broken one costs a second change of style.
        (is_whole(run), group == last, relatives, run.ready.len())
    };
    ready().max_by_key(rank).map(|(_, first)| first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Point;
    use crate::scene::{Area, Cap, PathPoint, Stroke, color};

    fn stroke(x: f64, level: u8, width: f64) -> Written {
        let stroke = Stroke {
            path: Path::line(Point::new(x, 10.0), Point::new(x, 90.0)),
            radius: 0.5 * width,
            radii: Vec::new(),
            cap: Cap::Round,
            color: color([level; 3]),
            opacity: 1.0,
        };
        Mark::from(stroke).into()
    }

    fn by_width(strokes: &[Written]) -> Vec<usize> {
        order(strokes, style_of, Written::width)
    }

    #[test]
    fn strokes_apart_come_together_by_look() {
        let strokes = [
            stroke(10.0, 1, 4.0),
            stroke(30.0, 2, 2.0),
            stroke(50.0, 3, 4.0),
            stroke(70.0, 4, 2.0),
        ];
        assert_eq!(by_width(&strokes), [2, 0, 3, 1]);
    }

    /// A square whose sides are this far `away` from (x, 50); with a `hole`, a frame 4 px wide.
    fn square(x: f64, away: f64, hole: bool, level: u8) -> Written {
        let ring = |away: f64| {
            let [left, right, top, bottom] = [x - away, x + away, 50.0 - away, 50.0 + away];
            let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
            corners.map(|p| PathPoint::on(p.into())).to_vec()
        };
        let mut inner = ring(away - 4.0);
        inner.reverse();
        let rings = [Some(ring(away)), hole.then_some(inner)];
        let rings = rings.into_iter().flatten();
        let rings = rings.map(|points| Path::of_points(points, true));
        let area = Area::plain(rings.collect(), color([level; 3]), 1.0);
        Mark::from(area).into()
    }

    #[test]
    fn an_area_goes_past_what_it_does_not_cover_and_nothing_else() {
        let by_color = |marks: &[Written]| order(marks, Written::color, |_| ());
        // A line in the middle of the page, and the square around it or the frame.
        let line = || stroke(50.0, 2, 2.0);
        assert_eq!(
            by_color(&[
                square(50.0, 48.0, false, 1),
                line(),
                square(50.0, 20.0, false, 1)
            ]),
            [0, 1, 2]
        );
        assert_eq!(
            by_color(&[
                square(90.0, 30.0, false, 1),
                line(),
                square(90.0, 20.0, false, 1)
            ]),
            [0, 2, 1]
        );
        let inside = square(50.0, 10.0, false, 2);
        assert_eq!(
            by_color(&[
                square(50.0, 40.0, true, 1),
                inside.clone(),
                square(50.0, 40.0, true, 1)
            ]),
            [0, 2, 1]
        );
        assert_eq!(
            by_color(&[
                square(50.0, 40.0, false, 1),
                inside,
                square(50.0, 40.0, false, 1)
            ]),
            [0, 1, 2]
        );
    }

    #[test]
    fn what_lies_above_stays_above() {
        let strokes = [
            stroke(10.0, 1, 4.0),
            stroke(11.0, 2, 2.0),
            stroke(12.0, 3, 4.0),
        ];
        assert_eq!(by_width(&strokes), [0, 1, 2]);
    }
}
