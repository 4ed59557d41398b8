//! Which strokes may change places, and in what order those of one look come together.
//!
//! Strokes that share no pixel, or have one colour, look the same in either order. Of all orders that leave
//! the others as they are, a greedy one with few changes of look is taken. It depends on nothing but the
//! strokes and which of them lies above which, so that arranging twice changes nothing.

use std::collections::{BTreeMap, BTreeSet};

use super::options::{Form, Group, WriteOptions};
use crate::scene::{Scene, Stage, UNITS_PER_PX, Written};

/// Strokes of a layer, and the colour that is all of theirs if that made the layer.
#[derive(Debug, Clone)]
pub(super) struct Layer {
    pub(super) strokes: Vec<Written>,
    pub(super) color: Option<[u8; 3]>,
}

/// The layers of the file.
pub(super) fn layers(scene: &Scene, options: &WriteOptions) -> Vec<Layer> {
    let written = |stage: &Stage| -> Vec<_> {
        let strokes = stage.strokes.iter();
        strokes
            .filter_map(|stroke| Written::new(stroke, scene, options.precision))
            .collect()
    };
    let stages = scene.stages.iter().map(written);
    let mut layers: Vec<_> = match options.group {
        Group::Stage => stages
            .map(|strokes| Layer {
                strokes,
                color: None,
            })
            .collect(),
        Group::Color => by_color(stages.flatten().collect()),
    };
    if options.form == Form::Smallest {
        for layer in &mut layers {
            layer.strokes = arranged(std::mem::take(&mut layer.strokes), |s| s.width, pen);
        }
    }
    layers
}

/// The scene in the order and the layers of its file, unless that has outlines: what
/// [`read`](super::read) reads from what [`write`](super::write()) wrote.
pub fn arrange(scene: &Scene, options: &WriteOptions) -> Scene {
    let stage = |layer: &Layer| Stage {
        strokes: layer.strokes.iter().map(Written::stroke).collect(),
    };
    let (quantized, _) = scene.quantized(options.precision);
    Scene {
        stages: layers(&quantized, options).iter().map(stage).collect(),
        ..quantized
    }
}

/// What strokes have to have in common to be one path.
pub(super) fn pen(stroke: &Written) -> (i64, [u8; 3], u8) {
    (stroke.width, stroke.color, stroke.opacity)
}

/// Whether there is a way to see in which order the two are drawn.
pub(super) fn touch(a: &Written, b: &Written) -> bool {
    let reach = (a.width + b.width) / 2 + APART;
    let near = |axis: usize| {
        let ends = |s: &Written| {
            let along = || s.points.iter().map(|p| p[axis]);
            (along().min().unwrap_or(0), along().max().unwrap_or(0))
        };
        let ((a_near, a_far), (b_near, b_far)) = (ends(a), ends(b));
        a_near - b_far < reach && b_near - a_far < reach
    };
    near(0) && near(1) && distance(a, b) < reach as f64
}

/// Strokes farther apart than the diagonal of a pixel have no pixel in common.
const APART: i64 = UNITS_PER_PX * 3 / 2;

/// Strokes that are arranged together: the pairs of more would take long to compare.
const WINDOW: usize = 4096;

/// Layers of one colour.
fn by_color(strokes: Vec<Written>) -> Vec<Layer> {
    let arranged = arranged(strokes, |s| s.color, pen);
    let runs = arranged.chunk_by(|a, b| a.color == b.color);
    runs.map(|run| Layer {
        strokes: run.to_vec(),
        color: run.first().map(|s| s.color),
    })
    .collect()
}

/// The strokes with those of one `outer` look together as far as may be, and of one `inner` look within.
fn arranged<K: Ord, L: Ord>(
    mut strokes: Vec<Written>,
    outer: impl Fn(&Written) -> K,
    inner: impl Fn(&Written) -> L,
) -> Vec<Written> {
    for window in strokes.chunks_mut(WINDOW) {
        let order = order(window, &outer, &inner);
        let sorted: Vec<_> = order.iter().map(|&i| window[i].clone()).collect();
        window.clone_from_slice(&sorted);
    }
    strokes
}

/// The strokes that may come next: by outer look, inner look, and themselves.
type Ready<'a, K, L> = BTreeMap<K, BTreeMap<L, BTreeSet<(&'a Written, usize)>>>;

fn order<'a, K: Ord, L: Ord>(
    strokes: &'a [Written],
    outer: impl Fn(&Written) -> K,
    inner: impl Fn(&Written) -> L,
) -> Vec<usize> {
    let above = above(strokes);
    let mut below = vec![0_usize; strokes.len()];
    above.iter().flatten().for_each(|&i| below[i] += 1);
    let mut ready: Ready<'a, K, L> = BTreeMap::new();
    let put = |ready: &mut Ready<'a, K, L>, i: usize| {
        let stroke = &strokes[i];
        let runs = ready.entry(outer(stroke)).or_default();
        runs.entry(inner(stroke)).or_default().insert((stroke, i));
    };
    (0..strokes.len())
        .filter(|&i| below[i] == 0)
        .for_each(|i| put(&mut ready, i));
    let mut order: Vec<usize> = Vec::with_capacity(strokes.len());
    while let Some(next) = take(
        &mut ready,
        order.last().map(|&i| &strokes[i]),
        &outer,
        &inner,
    ) {
        order.push(next);
        for &i in &above[next] {
            below[i] -= 1;
            if below[i] == 0 {
                put(&mut ready, i);
            }
        }
    }
    order
}

/// Takes a stroke that looks like the last one, or else one of the looks that most may come next with.
fn take<K: Ord, L: Ord>(
    ready: &mut Ready<'_, K, L>,
    last: Option<&Written>,
    outer: impl Fn(&Written) -> K,
    inner: impl Fn(&Written) -> L,
) -> Option<usize> {
    let same_outer = last.and_then(|last| ready.get_key_value(&outer(last)));
    let (_, runs) = same_outer.or_else(|| {
        let count = |runs: &BTreeMap<L, BTreeSet<_>>| runs.values().map(BTreeSet::len).sum();
        ready
            .iter()
            .max_by_key(|(_, runs)| -> usize { count(runs) })
    })?;
    let same_inner = last.and_then(|last| runs.get(&inner(last)));
    let run = same_inner.or_else(|| runs.values().max_by_key(|run| run.len()))?;
    let &(stroke, next) = run.first()?;
    let (outer, inner) = (outer(stroke), inner(stroke));
    let runs = ready.get_mut(&outer)?;
    let run = runs.get_mut(&inner)?;
    run.pop_first();
    if run.is_empty() {
        runs.remove(&inner);
    }
    if runs.is_empty() {
        ready.remove(&outer);
    }
    Some(next)
}

/// For each stroke, the later ones that have to stay above it.
fn above(strokes: &[Written]) -> Vec<Vec<usize>> {
    let above = |(i, below): (usize, &Written)| {
        let later = strokes.iter().enumerate().skip(i + 1);
        later
            .filter(|(_, stroke)| stroke.color != below.color && touch(stroke, below))
            .map(|(k, _)| k)
            .collect()
    };
    strokes.iter().enumerate().map(above).collect()
}

/// Distance of the centre lines, in units.
fn distance(a: &Written, b: &Written) -> f64 {
    let (a, b) = (ends(a), ends(b));
    if cross(a, b) {
        return 0.0;
    }
    let gaps = [gap(a[0], b), gap(a[1], b), gap(b[0], a), gap(b[1], a)];
    gaps.into_iter().fold(f64::INFINITY, f64::min)
}

type Segment = [[f64; 2]; 2];

fn ends(stroke: &Written) -> Segment {
    let place = |p: Option<&[i64; 2]>| p.map_or([0.0; 2], |p| p.map(|units| units as f64));
    [place(stroke.points.first()), place(stroke.points.last())]
}

/// From a point to a segment.
fn gap([x, y]: [f64; 2], [a, b]: Segment) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length2 = dx * dx + dy * dy;
    let along = ((x - a[0]) * dx + (y - a[1]) * dy) / length2.max(f64::MIN_POSITIVE);
    let h = along.clamp(0.0, 1.0);
    (x - a[0] - h * dx).hypot(y - a[1] - h * dy)
}

fn cross(a: Segment, b: Segment) -> bool {
    let side = |[from, to]: Segment, p: [f64; 2]| {
        (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0])
    };
    side(a, b[0]) * side(a, b[1]) < 0.0 && side(b, a[0]) * side(b, a[1]) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const PX: i64 = UNITS_PER_PX;

    fn stroke(x: i64, color: u8, width: i64) -> Written {
        Written {
            points: vec![[x * PX, 10 * PX], [x * PX, 90 * PX]],
            width: width * PX,
            color: [color; 3],
            opacity: 255,
        }
    }

    fn by_width(strokes: &[Written]) -> Vec<usize> {
        order(strokes, |s| s.width, pen)
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

    #[test]
    fn what_lies_above_stays_above() {
        let strokes = [stroke(10, 1, 4), stroke(11, 2, 2), stroke(12, 3, 4)];
        assert_eq!(by_width(&strokes), [0, 1, 2]);
    }

    #[test]
    fn strokes_touch_where_they_may_share_a_pixel() {
        let base = stroke(10, 1, 4);
        let touches = [13, 14, 15].map(|x| touch(&base, &stroke(x, 2, 2)));
        assert_eq!(touches, [true, true, false]);
        let beyond = Written {
            points: vec![[10 * PX, 96 * PX]],
            ..base.clone()
        };
        assert!(!touch(&base, &beyond));
    }

    #[test]
    fn crossing_strokes_touch() {
        let across = Written {
            points: vec![[-500 * PX, 50 * PX], [500 * PX, 51 * PX]],
            ..stroke(0, 2, 1)
        };
        assert!(touch(&stroke(10, 1, 1), &across));
    }
}
