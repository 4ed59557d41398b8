//! Bridges: a line goes on below the line that covers it. Rings: the ends of a line meet.

use std::collections::BTreeMap;

use super::areas::{Areas, Label, Pixels};
use super::lines::Line;
use super::recipe::Bridges;
use super::skeleton::Spot;

/// A line and its colour.
#[derive(Debug, Clone)]
pub(super) struct Colored {
    pub(super) line: Line,
    pub(super) color: u8,
    /// True if it goes on below another one, which has to be drawn on top of it.
    pub(super) is_covered: bool,
}

/// One end of a line.
type End = (usize, bool);

/// A gap between two ends that continue each other.
#[derive(Debug, Clone, Copy)]
struct Gap {
    ends: [End; 2],
    straightness: f32,
    is_covered: bool,
}

/// Joins lines of one colour across what covers them, the straightest first.
pub(super) fn bridged(
    lines: Vec<Colored>,
    areas: &Areas,
    pixels: &Pixels<'_>,
    bridges: Bridges,
) -> Vec<Colored> {
    let mut gaps = gaps(&lines, areas, pixels, bridges);
    gaps.sort_by(|a, b| {
        b.straightness
            .total_cmp(&a.straightness)
            .then(a.ends.cmp(&b.ends))
    });
    // Each end goes on across one gap. The gap is found from both of its ends.
    let mut across: BTreeMap<End, Gap> = BTreeMap::new();
    for gap in gaps {
        if gap.ends.iter().all(|end| !across.contains_key(end)) {
            let [a, b] = gap.ends;
            across.insert(a, gap);
            let ends = [b, a];
            across.insert(b, Gap { ends, ..gap });
        }
    }
    // Lines that are joined in this way are one.
    let mut seen = vec![false; lines.len()];
    let mut out = Vec::new();
    for first in 0..lines.len() {
        if !seen[first] {
            out.push(joined(&lines, &across, first, &mut seen));
        }
    }
    out
}

/// The line that `first` is a part of.
fn joined(
    lines: &[Colored],
    across: &BTreeMap<End, Gap>,
    first: usize,
    seen: &mut [bool],
) -> Colored {
    // Goes back to where it starts; a ring starts at `first`.
    let mut start = (first, false);
    while let Some(gap) = across.get(&start) {
        let (line, is_end) = gap.ends[1];
        start = (line, !is_end);
        if line == first {
            start = (first, false);
            break;
        }
    }
    let mut whole = Colored {
        line: Line {
            spots: Vec::new(),
            closed: lines[first].line.closed,
        },
        ..lines[first].clone()
    };
    let mut at = start;
    // Goes forwards from there, line by line, until nothing follows or the ring is closed.
    loop {
        seen[at.0] = true;
        let mut spots = lines[at.0].line.spots.clone();
        if at.1 {
            spots.reverse();
        }
        whole.line.spots.extend(spots);
        let Some(gap) = across.get(&(at.0, !at.1)) else {
            return whole;
        };
        whole.is_covered |= gap.is_covered;
        at = gap.ends[1];
        if seen[at.0] {
            whole.line.closed = true;
            return whole;
        }
    }
}

/// All gaps that a line could go on across.
fn gaps(lines: &[Colored], areas: &Areas, pixels: &Pixels<'_>, bridges: Bridges) -> Vec<Gap> {
    // Ends are compared with those in cells that a gap can reach into.
    const CELL: f32 = 32.0;
    let cell = |at: [f32; 2]| at.map(|v| (v / CELL).floor() as i32);
    let mut cells: BTreeMap<[i32; 2], Vec<End>> = BTreeMap::new();
    let mut gaps = Vec::new();
    for (i, line) in lines.iter().enumerate() {
        if line.line.closed || line.line.spots.len() < 2 {
            continue;
        }
        for a in [(i, false), (i, true)] {
            let (end, _) = leaving(&line.line, a.1);
            let [column, row] = cell(end.at);
            let far = (bridges.longest_for(end.radius) / CELL).ceil() as i32;
            let near = (-far..=far).flat_map(|y| (-far..=far).map(move |x| [column + x, row + y]));
            let others = near.filter_map(|place| cells.get(&place)).flatten();
            gaps.extend(others.filter_map(|&b| gap(lines, [b, a], areas, pixels, bridges)));
            cells.entry([column, row]).or_default().push(a);
        }
    }
    gaps
}

impl Bridges {
    /// Longest gap, px, of a line with this radius.
    fn longest_for(&self, radius: f32) -> f32 {
        self.longest[0] * radius + self.longest[1]
    }
}

/// The end of a line, and the direction in which it leaves there.
fn leaving(line: &Line, is_end: bool) -> (Spot, [f32; 2]) {
    let spots = &line.spots;
    let last = spots.len() - 1;
    let back = (3.0 * spots[last / 2].radius) as usize + 3;
    let (end, from) = if is_end {
        (spots[last], spots[last.saturating_sub(back)])
    } else {
        (spots[0], spots[back.min(last)])
    };
    let away = [0, 1].map(|k| end.at[k] - from.at[k]);
    let length = (away[0] * away[0] + away[1] * away[1]).sqrt();
    (end, away.map(|v| v / length.max(f32::MIN_POSITIVE)))
}

/// The gap between two ends, if a line may go on across it: it is short, straight and shows no canvas.
fn gap(
    lines: &[Colored],
    ends: [End; 2],
    areas: &Areas,
    pixels: &Pixels<'_>,
    bridges: Bridges,
) -> Option<Gap> {
    // Ends of one colour; a dot has two ends, too, but is no ring.
    let [a, b] = ends;
    let color = lines[a.0].color;
    let is_same = a.0 == b.0;
    if color != lines[b.0].color || (is_same && lines[a.0].line.spots.len() < bridges.least_ring) {
        return None;
    }
    // About the same width, and not far apart.
    let (from, there) = leaving(&lines[a.0].line, a.1);
    let (to, back) = leaving(&lines[b.0].line, b.1);
    let way = [0, 1].map(|k| to.at[k] - from.at[k]);
    let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
    let (less, more) = (from.radius.min(to.radius), from.radius.max(to.radius));
    if more > 1.6 * less + 0.5 || length > bridges.longest_for(less) {
        return None;
    }
    // Both ends point along the gap. A gap of less than a pixel has no direction.
    let cosine = |d: [f32; 2]| (d[0] * way[0] + d[1] * way[1]) / length;
    let straightness = match length {
        ..1.0 => 1.0,
        _ => cosine(there).min(-cosine(back)),
    };
    if straightness <= bridges.straight {
        return None;
    }
    // Something lies on the gap: where the canvas shows, there is no line below.
    let own = Label::Color(color);
    let (mut open, mut covered) = (0, 0);
    let steps = length.ceil() as usize;
    for step in 0..=steps {
        let share = step as f32 / steps.max(1) as f32;
        match pixels
            .at([0, 1].map(|k| from.at[k] + share * way[k]))
            .map(|i| areas.labels[i])
        {
            Some(Label::Canvas) | None => open += 1,
            Some(label) if label != own => covered += 1,
            Some(_) => {}
        }
    }
    (open <= bridges.open).then_some(Gap {
        ends,
        straightness,
        is_covered: covered > 0,
    })
}

#[cfg(test)]
mod tests {
    use super::super::areas::Planes;
    use super::*;
    use crate::fit::{Preset, Recipe};

    /// A straight line of colour 0 along y = 20 px.
    fn line(xs: std::ops::Range<usize>, radius: f32) -> Colored {
        let spot = |x: usize| Spot {
            at: [x as f32 + 0.5, 20.5],
            radius,
        };
        Colored {
            line: Line {
                spots: xs.map(spot).collect(),
                closed: false,
            },
            color: 0,
            is_covered: false,
        }
    }

    /// Lines, bridged, in a page of 64×40 px whose columns from 28 to 35 have the label `between`.
    fn bridged_across(between: Label, lines: Vec<Colored>) -> Vec<Colored> {
        let label = |i: usize| match i % 64 {
            28..36 => between,
            _ => Label::Color(0),
        };
        let areas = Areas {
            labels: (0..64 * 40).map(label).collect(),
            colors: Vec::new(),
        };
        let pixels = Pixels {
            width: 64,
            height: 40,
            target: Planes::default(),
            canvas: Planes::default(),
            weights: None,
        };
        bridged(
            lines,
            &areas,
            &pixels,
            Recipe::of(Preset::Balanced).tracing.bridges,
        )
    }

    #[test]
    fn a_covered_line_is_one() {
        let halves = vec![line(5..27, 2.0), line(37..60, 2.0)];
        let found = bridged_across(Label::Color(1), halves);
        assert_eq!(found.len(), 1);
        assert!(found[0].is_covered && !found[0].line.closed);
        assert_eq!(found[0].line.spots.len(), 45);
    }

    #[test]
    fn a_gap_that_shows_the_canvas_stays() {
        let halves = vec![line(5..27, 2.0), line(37..60, 2.0)];
        assert_eq!(bridged_across(Label::Canvas, halves).len(), 2);
    }

    #[test]
    fn unlike_or_far_lines_stay_apart() {
        let unlike = vec![line(5..27, 1.0), line(37..60, 3.0)];
        assert_eq!(bridged_across(Label::Color(1), unlike).len(), 2);
        let far = vec![line(5..15, 2.0), line(45..60, 2.0)];
        assert_eq!(bridged_across(Label::Color(1), far).len(), 2);
    }
}
