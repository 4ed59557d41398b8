//! Distances between centre lines.

use crate::bench::elements::Element;
use strokefit::math::Point;

/// Distances between two sets of centre lines, px: of places on either to the nearest place on the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Distances {
    pub(super) mean: f64,
    pub(super) largest: f64,
}

impl Distances {
    /// `None` where one of them has no strokes.
    pub(super) fn between(a: &[Element], b: &[Element]) -> Option<Self> {
        let (a, b) = (chords(a), chords(b));
        if a.is_empty() || b.is_empty() {
            return None;
        }
        let mut all: Vec<f64> = Vec::new();
        for (from, to) in [(&a, &b), (&b, &a)] {
            all.extend(from.iter().flat_map(places).map(|p| nearest(p, to)));
        }
        Some(Self {
            mean: all.iter().sum::<f64>() / all.len().max(1) as f64,
            largest: all.iter().copied().fold(0.0, f64::max),
        })
    }
}

fn chords(elements: &[Element]) -> Vec<[Point; 2]> {
    let strokes = elements.iter().filter(|e| e.width_px.is_some());
    let lines = strokes.flat_map(|element| &element.lines);
    let chords = lines.flat_map(|line| match line[..] {
        [dot] => vec![[dot, dot]],
        _ => line.windows(2).map(|w| [w[0], w[1]]).collect(),
    });
    chords.collect()
}

/// Places half a px apart.
fn places(&[a, b]: &[Point; 2]) -> impl Iterator<Item = Point> {
    let way = b - a;
    let count = (2.0 * way.hypot()).ceil().max(1.0);
    (0..count as usize).map(move |i| a + way * (i as f64 / count))
}

fn nearest(p: Point, chords: &[[Point; 2]]) -> f64 {
    let to = |&[a, b]: &[Point; 2]| {
        let way = b - a;
        let h = (p - a).dot(way) / way.hypot2().max(f64::MIN_POSITIVE);
        (a + way * h.clamp(0.0, 1.0)).distance(p)
    };
    chords.iter().map(to).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[[f64; 2]]) -> Element {
        let points: Vec<Point> = points.iter().map(|&[x, y]| Point::new(x, y)).collect();
        Element {
            lines: vec![points],
            width_px: Some(1.0),
            ..Element::default()
        }
    }

    #[test]
    fn distances_are_both_ways() {
        let a = [line(&[[0.0, 0.0], [10.0, 0.0]])];
        let b = [line(&[[0.0, 3.0], [10.0, 3.0]])];
        let apart = Distances::between(&a, &b).unwrap();
        assert_eq!((apart.mean, apart.largest), (3.0, 3.0));
        // All of the longer one is far from the shorter one, though not the other way round.
        let longer = [line(&[[0.0, 0.0], [20.0, 0.0]])];
        for apart in [
            Distances::between(&a, &longer).unwrap(),
            Distances::between(&longer, &a).unwrap(),
        ] {
            assert!(apart.largest > 9.0 && apart.mean < 5.0, "{apart:?}");
        }
    }

    #[test]
    fn filled_areas_have_no_centre_lines() {
        let a = line(&[[0.0, 0.0], [10.0, 0.0]]);
        let filled = Element {
            width_px: None,
            ..a.clone()
        };
        assert_eq!(Distances::between(&[a], &[filled]), None);
    }
}
