//! Reorders strokes so that strokes of equal colour, width and opacity (of one *style*) become neighbours.
//!
//! Two strokes may swap if they share no pixel or have the same colour. Among the orders that keep all other
//! pairs as they are, a greedy search picks one with few changes of style. The result depends only on the
//! strokes and on which lies above which, so arranging twice changes nothing.

use std::collections::{BTreeMap, BTreeSet};

use super::dialect::Unit;
use super::layer::{Layer, LayerKind};
use super::objects;
use super::options::{Form, Group, Order, WriteOptions};
use super::path::{self, Kind};
use super::tour;
use crate::scene::{Precedence, Scene, Stage, Written, WrittenPath};

/// The layers of the file, none of them empty.
pub(super) fn layers(scene: &Scene, options: &WriteOptions) -> Vec<Layer> {
    let written = |stage: &Stage| -> Vec<_> {
        let marks = stage.marks.iter();
        marks
            .filter_map(|mark| Written::new(mark, scene, options.precision).ok())
            .collect()
    };
    let stages = scene.stages.iter().map(written);
    let stages = stages.filter(|strokes| !strokes.is_empty());
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
    // Things are told by the order of their marks.
    if options.group == Group::Object {
        return layers;
    }
    if options.form == Form::Smallest {
        for layer in &mut layers {
            let strokes = layer.strokes.iter_mut();
            strokes.for_each(|stroke| orient(stroke, options.unit()));
            layer.strokes = arranged(std::mem::take(&mut layer.strokes), style_of, |s| s.width);
        }
    }
    if options.order == Order::Travel {
        for layer in &mut layers {
            layer.strokes = with_little_travel(std::mem::take(&mut layer.strokes), options.form);
        }
    }
    layers
}

/// The strokes of a layer in an order of little travel. In the smallest form, those of one style stay together.
fn with_little_travel(strokes: Vec<Written>, form: Form) -> Vec<Written> {
    let mut shortened = Vec::with_capacity(strokes.len());
    let is_together =
        |a: &Written, b: &Written| form != Form::Smallest || style_of(a) == style_of(b);
    for run in strokes.chunk_by(is_together) {
        let from = tour::end(&shortened);
        shortened.extend(tour::shortened(run, from));
    }
    if tour::between(&shortened) < tour::between(&strokes) {
        shortened
    } else {
        strokes
    }
}

/// The scene in the order and the layers of its file: what [`read`](super::read) returns for the text that
/// [`write`](super::write()) wrote, unless it wrote outlines, which cannot be read.
pub fn arrange(scene: &Scene, options: &WriteOptions) -> Scene {
    let stage = |layer: &Layer| layer.strokes.iter().map(Written::mark).collect();
    let quantized = scene.quantized(options.precision).scene;
    Scene {
        stages: layers(&quantized, options).iter().map(stage).collect(),
        ..quantized
    }
}

/// Starts a stroke at the end that makes its path shorter. Shapes stay as they are, and rings keep their sense, which makes holes.
fn orient(mark: &mut Written, unit: Unit) {
    if mark.is_area() || mark.shape.is_some() {
        return;
    }
    for path in &mut mark.paths {
        let length = |path: &WrittenPath| path::data([path], Kind::Line, unit).len();
        let mut reversed = path.reversed();
        // A reversed path may have fewer points than its other direction had, so that this is asked until it settles.
        while length(&reversed) < length(path) {
            *path = reversed;
            reversed = path.reversed();
        }
    }
}

/// Numbers that strokes must have in common to be one path.
pub(super) fn style_of(stroke: &Written) -> (i64, [u8; 3], u8) {
    (stroke.width, stroke.color, stroke.opacity)
}

/// Number of strokes that are arranged together. Comparing the pairs of more would take long.
const WINDOW: usize = 4096;

/// Layers of one colour.
fn by_color(strokes: Vec<Written>) -> Vec<Layer> {
    let in_order = strokes.clone();
    let arranged = arranged(strokes, |s| s.color, |_| ());
    // Strokes that a fit has stacked by colour stay as they are, however many there are.
    let best = [in_order, arranged]
        .into_iter()
        .min_by_key(|strokes| runs(strokes).count());
    let best = best.unwrap_or_default();
    let mut seen: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    let mut layers = Vec::new();
    for run in runs(&best) {
        let color = run.first().map_or([0; 3], |stroke| stroke.color);
        let count = seen.entry(color).or_default();
        layers.push(Layer {
            strokes: run.to_vec(),
            kind: LayerKind::Color(color, *count),
        });
        *count += 1;
    }
    layers
}

/// Neighbours of one colour.
fn runs(strokes: &[Written]) -> impl Iterator<Item = &[Written]> {
    strokes.chunk_by(|a, b| a.color == b.color)
}

/// Reorders strokes so that those of one `run` are together as far as possible, and runs of one `group_key` follow each
/// other.
fn arranged<R: Ord, K: Ord>(
    mut strokes: Vec<Written>,
    run: impl Fn(&Written) -> R,
    group_key: impl Fn(&Written) -> K,
) -> Vec<Written> {
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
    let precedence = Precedence::of(strokes);
    let mut waiting = precedence.waiting();
    let mut runs: BTreeMap<R, Run<'_>> = BTreeMap::new();
    for stroke in strokes {
        runs.entry(run(stroke)).or_default().left += 1;
    }
    let mut free = waiting.free();
    let mut order: Vec<usize> = Vec::with_capacity(strokes.len());
    loop {
        for i in free {
            let run = runs.entry(run(&strokes[i])).or_default();
            run.ready.insert((&strokes[i], i));
        }
        let last = order.last().map(|&i| &strokes[i]);
        let Some(next) = take(&mut runs, last, &run, &group_key) else {
            return order;
        };
        order.push(next);
        free = waiting.draw(next);
    }
}

/// The strokes of one style.
#[derive(Default)]
struct Run<'a> {
    /// Strokes that may be placed next.
    ready: BTreeSet<(&'a Written, usize)>,
    /// Number of strokes that are not placed yet, ready or not.
    left: usize,
}

/// Takes a stroke of the same style as the last one, or begins a run.
fn take<R: Ord, K: Ord>(
    runs: &mut BTreeMap<R, Run<'_>>,
    last: Option<&Written>,
    run: impl Fn(&Written) -> R,
    group_key: impl Fn(&Written) -> K,
) -> Option<usize> {
    let may_go_on = |key: &R| runs.get(key).is_some_and(|run| !run.ready.is_empty());
    let key = last.map(&run).filter(may_go_on);
    let key = key.or_else(|| begin(runs, last.map(&group_key), group_key).map(run))?;
    let run = runs.get_mut(&key)?;
    run.left -= 1;
    run.ready.pop_first().map(|(_, i)| i)
}

/// The first stroke of the next run. It prefers a run that can be placed as a whole, then one of the `last` group,
/// then one of the group with the most such runs, then the run with the most strokes ready.
fn begin<'a, R, K: Ord>(
    runs: &BTreeMap<R, Run<'a>>,
    last: Option<K>,
    group_key: impl Fn(&Written) -> K,
) -> Option<&'a Written> {
    let ready = || {
        runs.values()
            .filter_map(|run| Some((run, run.ready.first()?.0)))
    };
    let is_whole = |run: &Run<'_>| run.ready.len() == run.left;
    let mut counts = BTreeMap::<K, usize>::new();
    for (_, first) in ready().filter(|(run, _)| is_whole(run)) {
        *counts.entry(group_key(first)).or_default() += 1;
    }
    let rank = |(run, first): &(&Run<'_>, &Written)| {
        let group = Some(group_key(first));
        let relatives = group.as_ref().and_then(|group| counts.get(group)).copied();
        (is_whole(run), group == last, relatives, run.ready.len())
    };
    ready().max_by_key(rank).map(|(_, first)| first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::PathPoint;

    const PX: i64 = crate::scene::UNITS_PER_PX;

    fn stroke(x: i64, color: u8, width: i64) -> Written {
        Written {
            paths: vec![WrittenPath::line([x * PX, 10 * PX], [x * PX, 90 * PX])],
            shape: None,
            is_band: false,
            width: width * PX,
            color: [color; 3],
            opacity: 255,
            shade: None,
        }
    }

    fn by_width(strokes: &[Written]) -> Vec<usize> {
        order(strokes, style_of, |s| s.width)
    }

    #[test]
    fn strokes_apart_come_together_by_look() {
        let strokes = [
            stroke(10, 1, 4),
            stroke(30, 2, 2),
            stroke(50, 3, 4),
            stroke(70, 4, 2),
        ];
        assert_eq!(by_width(&strokes), [2, 0, 3, 1]);
    }

    /// A square whose sides are this far `away` from (x, 50); with a `hole`, a frame 4 px wide.
    fn square(x: i64, away: i64, hole: bool, color: u8) -> Written {
        let ring = |away: i64| {
            let [left, right] = [x - away, x + away];
            let [top, bottom] = [50 - away, 50 + away];
            [[left, top], [right, top], [right, bottom], [left, bottom]]
                .map(|p| PathPoint::on(p.map(|px| px * PX)))
        };
        let mut inner = ring(away - 4).to_vec();
        inner.reverse();
        let rings = [Some(ring(away).to_vec()), hole.then_some(inner)];
        Written {
            paths: rings
                .into_iter()
                .flatten()
                .map(|points| WrittenPath::new(points, true))
                .collect(),
            shape: None,
            width: 0,
            is_band: false,
            color: [color; 3],
            opacity: 255,
            shade: None,
        }
    }

    #[test]
    fn an_area_goes_past_what_it_does_not_cover_and_nothing_else() {
        let by_color = |marks: &[Written]| order(marks, |s| s.color, |_| ());
        // A line in the middle of the page, and the square around it or the frame.
        let line = || stroke(50, 2, 2);
        assert_eq!(
            by_color(&[square(50, 48, false, 1), line(), square(50, 20, false, 1)]),
            [0, 1, 2]
        );
        assert_eq!(
            by_color(&[square(90, 30, false, 1), line(), square(90, 20, false, 1)]),
            [0, 2, 1]
        );
        let inside = square(50, 10, false, 2);
        assert_eq!(
            by_color(&[
                square(50, 40, true, 1),
                inside.clone(),
                square(50, 40, true, 1)
            ]),
            [0, 2, 1]
        );
        assert_eq!(
            by_color(&[square(50, 40, false, 1), inside, square(50, 40, false, 1)]),
            [0, 1, 2]
        );
    }

    #[test]
    fn what_lies_above_stays_above() {
        let strokes = [stroke(10, 1, 4), stroke(11, 2, 2), stroke(12, 3, 4)];
        assert_eq!(by_width(&strokes), [0, 1, 2]);
    }
}
