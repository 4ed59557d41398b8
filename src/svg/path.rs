//! The attribute `d` of a path, which holds one stroke or several of one look.

use super::dialect::{MAX_UNITS, Unit};
use crate::scene::UNITS_PER_PX;

/// The length of the segment that represents a dot.
const DOT: i64 = UNITS_PER_PX / 100;

/// A place in units of 1/[`UNITS_PER_PX`](crate::scene::UNITS_PER_PX) px.
type Place = [i64; 2];

/// The `d` of strokes with these corners. Each pair of numbers is absolute or relative, whichever is shorter. A
/// stroke that begins at the end of the previous one continues its line.
pub(super) fn data<'a>(strokes: impl IntoIterator<Item = &'a [Place]>, unit: Unit) -> String {
    let mut out = String::new();
    let mut at = None;
    for points in strokes {
        let Some((&start, rest)) = points.split_first() else {
            continue;
        };
        if at != Some(start) || rest.is_empty() {
            push_step(&mut out, ['M', 'm'], at, start, unit);
        }
        at = Some(start);
        for &point in rest {
            push_step(&mut out, ['L', 'l'], at, point, unit);
            at = Some(point);
        }
        if rest.is_empty() {
            out.push('h');
            unit.push(&mut out, DOT);
            // The next relative step would start 0.01 off.
            at = None;
        }
    }
    out
}

/// Appends the step from `at`, if known, to `to`.
fn push_step(
    out: &mut String,
    [absolute, relative]: [char; 2],
    at: Option<Place>,
    to: Place,
    unit: Unit,
) {
    let step = |letter: char, [x, y]: Place| {
        let mut text = String::from(letter);
        unit.push(&mut text, x);
        // A minus sign needs no separator.
        if y >= 0 {
            text.push(' ');
        }
        unit.push(&mut text, y);
        text
    };
    let from_page = step(absolute, to);
    let from_here = at.map(|[x, y]| step(relative, [to[0] - x, to[1] - y]));
    out.push_str(
        from_here
            .as_ref()
            .filter(|text| text.len() < from_page.len())
            .unwrap_or(&from_page),
    );
}

/// The content of a `d`.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Parsed {
    /// The corners of each stroke, neighbours different: two, or one for a dot.
    pub(super) strokes: Vec<Vec<Place>>,
    /// Whether a stroke continues the line of the previous one, so that the shape of joins matters.
    pub(super) has_corner: bool,
}

/// The strokes of a `d`, or `None` if it is not part of the dialect.
pub(super) fn parse(d: &str, unit: Unit) -> Option<Parsed> {
    let mut parsed = Parsed {
        strokes: Vec::new(),
        has_corner: false,
    };
    let mut reached = Reached::Nowhere;
    let mut rest = d;
    while let Some(letter) = rest.chars().next() {
        let tail = &rest[letter.len_utf8()..];
        let end = tail.find(|c: char| c.is_alphabetic()).unwrap_or(tail.len());
        reached = reached.step(letter, Numbers(&tail[..end], unit), &mut parsed)?;
        rest = &tail[end..];
    }
    matches!(reached, Reached::Drawn(_) | Reached::Dotted).then_some(parsed)
}

/// What the last step of a path was.
#[derive(Clone, Copy)]
enum Reached {
    Nowhere,
    /// To the start of a stroke.
    Put(Place),
    /// To the end of a stroke.
    Drawn(Place),
    /// To a dot.
    Dotted,
}

impl Reached {
    fn step(self, letter: char, numbers: Numbers<'_>, parsed: &mut Parsed) -> Option<Self> {
        match (letter, self) {
            ('M', Self::Nowhere | Self::Drawn(_) | Self::Dotted) => {
                numbers.place([0, 0]).map(Self::Put)
            }
            ('m', Self::Drawn(at)) => numbers.place(at).map(Self::Put),
            ('L' | 'l', Self::Put(at) | Self::Drawn(at)) => {
                parsed.has_corner |= matches!(self, Self::Drawn(_));
                let to = numbers.place(if letter == 'l' { at } else { [0, 0] })?;
                let mut points = vec![at, to];
                points.dedup();
                parsed.strokes.push(points);
                Some(Self::Drawn(to))
            }
            ('h', Self::Put(at)) if numbers.one() == Some(DOT) => {
                parsed.strokes.push(vec![at]);
                Some(Self::Dotted)
            }
            _ => None,
        }
    }
}

/// Parses what follows a letter, in this unit.
#[derive(Clone, Copy)]
struct Numbers<'a>(&'a str, Unit);

impl Numbers<'_> {
    fn one(self) -> Option<i64> {
        self.1.parse(self.0)
    }

    /// Two numbers, separated by a space or the minus sign of the second, as steps from `origin`.
    fn place(self, origin: Place) -> Option<Place> {
        let Self(text, unit) = self;
        let minus = text.bytes().skip(1).position(|b| b == b'-');
        let (x, y) = match text.split_once(' ') {
            Some(pair) => pair,
            None => text.split_at_checked(minus? + 1)?,
        };
        let place = [origin[0] + unit.parse(x)?, origin[1] + unit.parse(y)?];
        place
            .iter()
            .all(|units| units.abs() <= MAX_UNITS)
            .then_some(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn px(x: i64, y: i64) -> Place {
        [x * UNITS_PER_PX, y * UNITS_PER_PX]
    }

    /// Writes, and checks that reading gives the same.
    fn written(strokes: &[&[Place]], has_corner: bool) -> String {
        let d = data(strokes.iter().copied(), Unit::PX);
        let strokes = strokes.iter().map(|points| points.to_vec()).collect();
        let expected = Parsed {
            strokes,
            has_corner,
        };
        assert_eq!(parse(&d, Unit::PX), Some(expected), "{d}");
        d
    }

    #[test]
    fn a_step_is_absolute_or_relative_whichever_is_shorter() {
        let one = |a, b| written(&[&[a, b]], false);
        assert_eq!(one(px(1, 2), px(3, 4)), "M1 2L3 4");
        assert_eq!(one(px(100, 200), px(103, 199)), "M100 200l3-1");
        assert_eq!(one(px(-1, -2), px(-3, 4)), "M-1-2L-3 4");
    }

    #[test]
    fn a_dot_is_a_short_segment() {
        assert_eq!(written(&[&[px(5, 6)]], false), "M5 6h0.01");
        for (precision, expected) in [(1, "M50 60h0.1"), (2, "M500 600h1"), (3, "M5000 6000h10")] {
            let unit = Unit::decimal(precision);
            let d = data([&[px(5, 6)][..]], unit);
            assert_eq!(d, expected);
            assert_eq!(parse(&d, unit).unwrap().strokes, [[px(5, 6)]]);
        }
    }

    #[test]
    fn strokes_end_to_end_are_a_polyline() {
        let (a, b, c) = (px(1, 2), px(3, 4), px(5, 6));
        assert_eq!(written(&[&[a, b], &[b, c]], true), "M1 2L3 4L5 6");
    }

    #[test]
    fn strokes_apart_are_parts_of_a_path() {
        let (a, b, c) = (px(100, 100), px(110, 100), px(112, 90));
        assert_eq!(
            written(&[&[a, b], &[c, a]], false),
            "M100 100l10 0m2-10l-12 10"
        );
    }

    #[test]
    fn after_a_dot_steps_are_absolute() {
        let (a, b) = (px(100, 100), px(101, 100));
        let d = written(&[&[a], &[a], &[a, b]], false);
        assert_eq!(d, "M100 100h0.01M100 100h0.01M100 100l1 0");
    }

    #[test]
    fn path_data_outside_the_dialect_is_refused() {
        let refused = [
            "",
            "M",
            "M1 2",
            "M1 2L3",
            "M1 2L3 4 5",
            "m1 2l3 4",
            "M1 2h1",
            "M1 2 3 4",
            "M1,2L3,4",
            "M1 2L--3 4",
            "Mé 2L3 4",
            "L1 2",
            "M1 2M3 4L5 6",
            "M1 2L3 4h0.01",
            "M1 2h0.01L3 4",
            "M1 2h0.01m3 4l5 6",
            "M1 2L3 4m5 6",
            "M1 2L3 4Z",
            "M1 2L3  4",
            "M1 2 L3 4",
            "M2000000000 1l2000000000 1l1 1",
        ];
        for d in refused {
            assert_eq!(parse(d, Unit::PX), None, "{d}");
        }
    }
}
