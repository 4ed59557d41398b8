//! Bridges: a line goes on below the line that covers it. Rings: the ends of a line meet.

use std::collections::BTreeMap;

use super::areas::{Areas, Label, Pixels};
use super::lines::Line;
use super::parts::{Part, Parts};
use super::skeleton::Spot;
use crate::math::distance;

/// A line and its colour.
#[derive(Debug, Clone)]
pub(super) struct Colored {
    pub(super) line: Line,
    pub(super) color: u8,
    /// True if it goes on below another one, which has to be drawn on top of it.
    pub(super) is_covered: bool,
    /// The part that it is of a shape that came apart.
    pub(super) part: Part,
}

/// One end of a line.
type End = (usize, bool);

// All of these are guesses.
/// Longest gap that a line goes on across, in units of its radius and px.
const LONGEST: [f32; 2] = [8.0, 3.0];
/// The cosine of the largest angle between a line's end and the gap.
const STRAIGHT: f32 = 0.85;
/// As [`LONGEST`], of a gap within a blob of its colour.
const WITHIN: [f32; 2] = [24.0, 12.0];
/// As [`STRAIGHT`], of such a gap.
const STRAIGHT_WITHIN: f32 = 0.996;
/// Most px of a gap that may show the canvas.
const OPEN: usize = 3;
/// A line whose ends meet is a ring if it has this many places or more.
const LEAST_RING: usize = 8;

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
    parts: &Parts,
    pixels: &Pixels<'_>,
) -> Vec<Colored> {
    let under = Under {
        areas,
        parts,
        pixels,
    };
    let mut gaps = gaps(&lines, &under);
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
fn gaps(lines: &[Colored], under: &Under<'_>) -> Vec<Gap> {
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
            let reach = match line.part {
                Part::Lines(_) => longest(WITHIN, end.radius),
                _ => longest(LONGEST, end.radius),
            };
            let far = (reach / CELL).ceil() as i32;
            let near = (-far..=far).flat_map(|y| (-far..=far).map(move |x| [column + x, row + y]));
            let others = near.filter_map(|place| cells.get(&place)).flatten();
            gaps.extend(others.filter_map(|&b| gap(lines, [b, a], under)));
            cells.entry([column, row]).or_default().push(a);
        }
    }
    gaps
}

/// Longest gap, px, of a line with this radius.
fn longest([radii, px]: [f32; 2], radius: f32) -> f32 {
    radii * radius + px
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

/// The picture under a gap.
struct Under<'a> {
    areas: &'a Areas,
    parts: &'a Parts,
    pixels: &'a Pixels<'a>,
}

impl Under<'_> {
    /// The labels and parts at steps of a pixel from one place to another.
    fn along(
        &self,
        from: [f32; 2],
        to: [f32; 2],
    ) -> impl Iterator<Item = Option<(Label, Part)>> + '_ {
        let steps = distance(from, to).ceil() as usize;
        (0..=steps).map(move |step| {
            let share = step as f32 / steps.max(1) as f32;
            let place = [0, 1].map(|k| from[k] + share * (to[k] - from[k]));
            let i = self.pixels.at(place)?;
            Some((self.areas.labels[i], self.parts.at(i)))
        })
    }
}

/// The gap between two ends, if a line may go on across it: it is short, straight and shows no canvas.
fn gap(lines: &[Colored], ends: [End; 2], under: &Under<'_>) -> Option<Gap> {
    // Ends of one colour; a dot has two ends, too, but is no ring.
    let [a, b] = ends;
    let (color, part) = (lines[a.0].color, lines[a.0].part);
    let is_same = a.0 == b.0;
    if color != lines[b.0].color
        || part != lines[b.0].part
        || (is_same && lines[a.0].line.spots.len() < LEAST_RING)
    {
        return None;
    }
    // About the same width.
    let (from, there) = leaving(&lines[a.0].line, a.1);
    let (to, back) = leaving(&lines[b.0].line, b.1);
    let way = [0, 1].map(|k| to.at[k] - from.at[k]);
    let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
    let (less, more) = (from.radius.min(to.radius), from.radius.max(to.radius));
    if more > 1.6 * less + 0.5 {
        return None;
    }
    // Both ends point along the gap. A gap of less than a pixel has no direction.
    let cosine = |d: [f32; 2]| (d[0] * way[0] + d[1] * way[1]) / length;
    let straightness = match length {
        ..1.0 => 1.0,
        _ => cosine(there).min(-cosine(back)),
    };
    if straightness <= STRAIGHT {
        return None;
    }
    // Not far apart; but through a blob, however far, if it is straight.
    let own = Label::Color(color);
    let parts = || under.along(from.at, to.at).flatten();
    let is_blob = part != Part::Whole && parts().any(|(_, part)| matches!(part, Part::Blob(_)));
    let may_join = match is_blob {
        true => {
            straightness > STRAIGHT_WITHIN
                && length <= longest(WITHIN, less)
                && parts().all(|(label, _)| label == own)
        }
        false => length <= longest(LONGEST, less),
    };
    if !may_join {
        return None;
    }
    // Something lies on the gap: where the canvas shows, there is no line below.
    let (mut open, mut covered) = (0, 0);
    for at in under.along(from.at, to.at) {
        match at.map(|(label, _)| label) {
            Some(Label::Canvas) | None => open += 1,
            Some(label) if label != own => covered += 1,
            Some(_) => {}
        }
    }
    (open <= OPEN).then_some(Gap {
        ends,
        straightness,
        is_covered: covered > 0,
    })
}

impl Colored {
    /// Lets a line that ends at a blob end in it, as its end is not seen there.
    pub(super) fn reach_into_blobs(&mut self, parts: &Parts, pixels: &Pixels<'_>) {
        if self.line.closed || !matches!(self.part, Part::Lines(_)) {
            return;
        }
        for is_end in [false, true] {
            let (end, way) = leaving(&self.line, is_end);
            let place = |step: usize| [0, 1].map(|k| end.at[k] + step as f32 * way[k]);
            let is_blob = |step: &usize| {
                let at = pixels.at(place(*step)).map(|i| parts.at(i));
                matches!(at, Some(Part::Blob(_)))
            };
            let reach = (2.0 * end.radius).ceil() as usize + 3;
            let Some(border) = (1..=reach).find(is_blob) else {
                continue;
            };
            let inner = (border..border + reach).take_while(is_blob).last();
            let more = (1..=inner.unwrap_or(border)).map(|step| Spot {
                at: place(step),
                radius: end.radius,
            });
            let spots = &mut self.line.spots;
            match is_end {
                true => spots.extend(more),
                false => drop(spots.splice(0..0, more.rev())),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::areas::Planes;
    use super::*;

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
            part: Part::Whole,
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
        bridged(lines, &areas, &Parts::of(&[], 64, 64 * 40), &pixels)
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
