//! The attribute `d` of a path, which holds one stroke, several of one style, or the rings of an area.

use svgtypes::{PathParser, PathSegment};

use super::dialect::{MAX_UNITS, Unit};
use crate::math::Point;
use crate::scene::{Arc, ArcNumbers, Path, PathPiece, PathPoint, UNITS_PER_PX, px, units};

/// The length of the segment that represents a dot.
const DOT: i64 = UNITS_PER_PX / 100;

/// A place in units of 1/[`UNITS_PER_PX`](crate::scene::UNITS_PER_PX) px.
type Place = [i64; 2];

/// A kind of paths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Centre lines of strokes.
    Line,
    /// Rings of an area, all closed. Horizontal and vertical lines have letters of their own, which among centre lines make
    /// dots.
    Ring,
}

/// The `d` of these paths. The places of each step are absolute or relative, whichever is shorter.
pub(super) fn data<'a>(
    paths: impl IntoIterator<Item = &'a Path>,
    kind: Kind,
    unit: Unit,
) -> String {
    let mut writer = Writer {
        out: String::new(),
        kind,
        unit,
        at: None,
        letter: None,
    };
    paths.into_iter().for_each(|path| writer.push(path));
    writer.out
}

struct Writer {
    out: String,
    kind: Kind,
    unit: Unit,
    /// Where the last step ended, if a relative one may follow.
    at: Option<Place>,
    /// The letter of the last step, if another one may do without it.
    letter: Option<char>,
}

impl Writer {
    fn push(&mut self, path: &Path) {
        let mut pieces = path.pieces().peekable();
        let Some(first) = pieces.peek().map(|first| place(first.start())) else {
            return self.push_dot(path);
        };
        // SVG reads further numbers after M as a line, so the next step has to have its letter.
        self.push_step('M', &[first]);
        self.letter = None;
        // The last control point of the last curve; after a line, an arc or a move there is none to mirror.
        let mut control = Control::default();
        while let Some(piece) = pieces.next() {
            // The command that closes the path draws its last line.
            let is_closing = path.is_closed() && pieces.peek().is_none();
            if !(is_closing && matches!(piece, PathPiece::Line(_))) {
                control = self.push_piece(piece, control);
            }
        }
        if path.is_closed() {
            self.out.push('z');
            // After z the current point is the start of the path.
            (self.at, self.letter) = (Some(first), None);
        }
    }

    /// Appends a piece behind one with these control points, and returns its own.
    fn push_piece(&mut self, piece: PathPiece, last: Control) -> Control {
        let [from, to] = [piece.start(), piece.end()].map(place);
        // T and S take the control point opposite of the last one, which is exact in whole units.
        let opposite = last.map(|last| last.map(|control| mirrored(control, from)));
        let mut own = Control::default();
        match piece {
            PathPiece::Line(_) => self.push_step(self.line_letter(from, to), &[to]),
            PathPiece::Quad(curve) => {
                let knee = place(curve.p1);
                match opposite[QUAD] == Some(knee) {
                    true => self.push_step('T', &[to]),
                    false => self.push_step('Q', &[knee, to]),
                }
                own[QUAD] = Some(knee);
            }
            PathPiece::Cubic(curve) => {
                let [first, second] = [curve.p1, curve.p2].map(place);
                match opposite[CUBIC] == Some(first) {
                    true => self.push_step('S', &[second, to]),
                    false => self.push_step('C', &[first, second, to]),
                }
                own[CUBIC] = Some(second);
            }
            PathPiece::Arc(arc) => self.push_arc(arc.numbers(), to),
        }
        own
    }

    /// The letter of a line.
    fn line_letter(&self, from: Place, to: Place) -> char {
        match self.kind {
            Kind::Ring if from[1] == to[1] => 'H',
            Kind::Ring if from[0] == to[0] => 'V',
            _ => 'L',
        }
    }

    fn push_dot(&mut self, path: &Path) {
        for point in path.points() {
            self.push_step('M', &[place(point.at)]);
            self.out.push('h');
            self.unit.push(&mut self.out, DOT);
            // The next relative step would start 0.01 off.
            (self.at, self.letter) = (None, None);
        }
    }

    /// Appends a step to the last of these places in its shortest form.
    fn push_step(&mut self, letter: char, places: &[Place]) {
        self.push_shortest(letter, places.last().copied(), |writer, origin| {
            writer.numbers(letter, origin, places)
        });
    }

    /// Appends an arc.
    fn push_arc(&mut self, numbers: ArcNumbers, to: Place) {
        self.push_shortest('A', Some(to), |writer, origin| {
            let mut radius = String::new();
            writer.unit.push(&mut radius, numbers.radius);
            let [large, sweep] = [numbers.is_large, numbers.is_clockwise].map(u8::from);
            let end = writer.numbers('A', origin, &[to]);
            let separator = if end.starts_with('-') { "" } else { " " };
            format!("{radius} {radius} 0 {large} {sweep}{separator}{end}")
        });
    }

    /// Appends a step that ends at `to` in its shortest form, of the numbers that `text` gives as seen from a place. It does
    /// without a letter where the letter of the last step serves, and that is no longer.
    fn push_shortest(
        &mut self,
        letter: char,
        to: Option<Place>,
        text: impl Fn(&Self, Place) -> String,
    ) {
        // The shorter of the two. Of equal lengths, the one with the last letter: the next step may go without it.
        let from_page = self.lettered(letter, &text(self, [0, 0]));
        let from_here = self
            .at
            .map(|at| self.lettered(letter.to_ascii_lowercase(), &text(self, at)));
        let steps = [Some(from_page), from_here].into_iter().flatten();
        let shortest =
            steps.min_by_key(|(letter, text)| (text.len(), self.letter != Some(*letter)));
        if let Some((letter, text)) = shortest {
            self.out.push_str(&text);
            (self.at, self.letter) = (to, Some(letter));
        }
    }

    /// The numbers of some places as seen from `origin`, as far as the `letter` takes them. A minus sign needs no separator.
    fn numbers(&self, letter: char, origin: Place, places: &[Place]) -> String {
        let axes = match letter {
            'H' => 0..1,
            'V' => 1..2,
            _ => 0..2,
        };
        let mut text = String::new();
        for place in places {
            for units in axes.clone().map(|axis| place[axis] - origin[axis]) {
                if units >= 0 && !text.is_empty() {
                    text.push(' ');
                }
                self.unit.push(&mut text, units);
            }
        }
        text
    }

    /// A step with its letter and as text.
    fn lettered(&self, letter: char, numbers: &str) -> (char, String) {
        // Without a letter, a minus sign separates by itself.
        let separator = match self.letter {
            Some(last) if last == letter && numbers.starts_with('-') => String::new(),
            Some(last) if last == letter => " ".into(),
            _ => letter.into(),
        };
        (letter, separator + numbers)
    }
}

/// The last control points of the step before, by the kind of curve that may mirror them.
type Control = [Option<Place>; 2];

/// Of a quadratic curve, which T goes on with, and of a cubic one, which S does.
const QUAD: usize = 0;
const CUBIC: usize = 1;

/// The place of a rounded point.
fn place(p: Point) -> Place {
    [units(p.x), units(p.y)]
}

fn point([x, y]: Place) -> Point {
    Point::new(px(x), px(y))
}

/// The place opposite of `point` as seen from `center`.
fn mirrored(point: Place, center: Place) -> Place {
    [0, 1].map(|axis| 2 * center[axis] - point[axis])
}

/// The paths of a `d`, or `None` if it is not part of the dialect.
pub(super) fn parse(d: &str, kind: Kind, unit: Unit) -> Option<Vec<Path>> {
    let mut reader = Reader {
        kind,
        unit,
        paths: Vec::new(),
        points: Vec::new(),
        at: None,
        control: Control::default(),
    };
    for segment in PathParser::from(d) {
        reader.draw(segment.ok()?)?;
    }
    reader.end()?;
    Some(reader.paths).filter(|paths| !paths.is_empty())
}

/// Takes one segment after the other; each method returns `None` if a segment is not part of the dialect.
struct Reader {
    kind: Kind,
    unit: Unit,
    paths: Vec<Path>,
    /// The points of the path that has begun.
    points: Vec<PathPoint>,
    /// Where a relative segment starts; nowhere after a dot.
    at: Option<Place>,
    /// The last control point of the last segment, if that was a curve.
    control: Control,
}

impl Reader {
    fn draw(&mut self, segment: PathSegment) -> Option<()> {
        use PathSegment as S;
        let is_ring = self.kind == Kind::Ring;
        let origin = if segment.is_abs() {
            Some([0; 2])
        } else {
            self.at
        };
        // Sums of whole units: a relative path gathers no rounding error, however long it is.
        let along = |axis: usize, by: f64| Some(origin?[axis] + self.unit.units(by)?);
        let to = |x: f64, y: f64| within([along(0, x)?, along(1, y)?]);
        match segment {
            S::MoveTo { x, y, .. } => {
                let start = to(x, y)?;
                // A move ends the path before it; an open one was complete with its last segment.
                self.end()?;
                self.points.push(PathPoint::on(point(start)));
                (self.at, self.control) = (Some(start), Control::default());
                Some(())
            }
            S::LineTo { x, y, .. } => self.extend([], to(x, y)?),
            S::HorizontalLineTo { x, .. } if is_ring => {
                let to = [along(0, x)?, self.at?[1]];
                self.extend([], within(to)?)
            }
            S::VerticalLineTo { y, .. } if is_ring => {
                let to = [self.at?[0], along(1, y)?];
                self.extend([], within(to)?)
            }
            // Among strokes, the one horizontal step is the mark of a dot.
            S::HorizontalLineTo { abs: false, x } if self.unit.units(x)? == DOT => self.dot(),
            S::Quadratic { x1, y1, x, y, .. } => self.quadratic(to(x1, y1)?, to(x, y)?),
            S::SmoothQuadratic { x, y, .. } => {
                // SVG takes the current point where no curve precedes; our dialect refuses that, as it never writes it.
                let knee = within(mirrored(self.control[QUAD]?, self.at?))?;
                self.quadratic(knee, to(x, y)?)
            }
            S::CurveTo {
                x1,
                y1,
                x2,
                y2,
                x,
                y,
                ..
            } => self.cubic([to(x1, y1)?, to(x2, y2)?], to(x, y)?),
            S::SmoothCurveTo { x2, y2, x, y, .. } => {
                let first = within(mirrored(self.control[CUBIC]?, self.at?))?;
                self.cubic([first, to(x2, y2)?], to(x, y)?)
            }
            S::EllipticalArc {
                rx,
                ry,
                x_axis_rotation: 0.0,
                large_arc,
                sweep,
                x,
                y,
                ..
            } if rx == ry && rx > 0.0 => {
                let numbers = ArcNumbers {
                    radius: self.unit.units(rx)?,
                    is_large: large_arc,
                    is_clockwise: sweep,
                };
                let (from, to) = (point(self.at?), to(x, y)?);
                let arc = Arc::of_numbers([from, point(to)], numbers);
                self.extend([PathPoint::arc(arc.through)], to)
            }
            S::ClosePath { .. } => self.close(),
            _ => None,
        }
    }

    fn quadratic(&mut self, knee: Place, to: Place) -> Option<()> {
        self.extend([PathPoint::off(point(knee))], to)?;
        self.control[QUAD] = Some(knee);
        Some(())
    }

    fn cubic(&mut self, controls: [Place; 2], to: Place) -> Option<()> {
        self.extend(controls.map(|place| PathPoint::cubic(point(place))), to)?;
        self.control[CUBIC] = Some(controls[1]);
        Some(())
    }

    /// Draws a line or, with points `between`, a curve or an arc.
    fn extend<const N: usize>(&mut self, between: [PathPoint; N], to: Place) -> Option<()> {
        if self.points.is_empty() {
            return None;
        }
        self.points.extend(between);
        self.points.push(PathPoint::on(point(to)));
        (self.at, self.control) = (Some(to), Control::default());
        Some(())
    }

    fn dot(&mut self) -> Option<()> {
        if self.points.len() != 1 {
            return None;
        }
        self.push(false);
        self.at = None;
        Some(())
    }

    fn close(&mut self) -> Option<()> {
        self.at = self.points.first().map(|start| place(start.at));
        // A dot can't be closed.
        if self.points.len() < 2 {
            return None;
        }
        self.push(true);
        Some(())
    }

    /// Ends the path that has begun, if any. One point alone is none, and rings are closed.
    fn end(&mut self) -> Option<()> {
        match self.points.len() {
            0 => {}
            1 => return None,
            _ if self.kind == Kind::Ring => return None,
            _ => self.push(false),
        }
        Some(())
    }

    fn push(&mut self, closed: bool) {
        let points = std::mem::take(&mut self.points);
        // Canonical form drops the on-points that are implied: the points are those that were written.
        self.paths.push(Path::canonical(points, closed));
        self.control = Control::default();
    }
}

/// The place, if it is not too far away to be exact.
fn within(place: Place) -> Option<Place> {
    let is_near = place.iter().all(|units| units.abs() <= MAX_UNITS);
    is_near.then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::PointKind;

    fn px(x: i64, y: i64) -> Place {
        [x * UNITS_PER_PX, y * UNITS_PER_PX]
    }

    /// The path of these points, in px; each is on it unless it says `false`.
    fn path(points: &[(i64, i64, bool)], closed: bool) -> Path {
        let on_or_off = |&(x, y, is_on): &(i64, i64, bool)| PathPoint {
            at: point(px(x, y)),
            kind: PointKind::on_if(is_on),
        };
        Path::canonical(points.iter().map(on_or_off).collect(), closed)
    }

    fn line(places: &[(i64, i64)]) -> Path {
        let points: Vec<_> = places.iter().map(|&(x, y)| (x, y, true)).collect();
        path(&points, false)
    }

    /// Writes, and checks that reading gives the same.
    fn written(paths: &[Path]) -> String {
        let d = data(paths, Kind::Line, Unit::PX);
        assert_eq!(
            parse(&d, Kind::Line, Unit::PX).as_deref(),
            Some(paths),
            "{d}"
        );
        d
    }

    #[test]
    fn a_step_is_absolute_or_relative_whichever_is_shorter() {
        let one = |a, b| written(&[line(&[a, b])]);
        assert_eq!(one((1, 2), (3, 4)), "M1 2L3 4");
        assert_eq!(one((100, 200), (103, 199)), "M100 200l3-1");
        assert_eq!(one((-1, -2), (-3, 4)), "M-1-2L-3 4");
    }

    #[test]
    fn a_dot_is_a_short_segment() {
        assert_eq!(written(&[line(&[(5, 6)])]), "M5 6h0.01");
        for (precision, expected) in [(1, "M50 60h0.1"), (2, "M500 600h1"), (3, "M5000 6000h10")] {
            let unit = Unit::decimal(precision);
            let dot = line(&[(5, 6)]);
            let d = data([&dot], Kind::Line, unit);
            assert_eq!(d, expected);
            assert_eq!(parse(&d, Kind::Line, unit).unwrap(), [dot]);
        }
    }

    #[test]
    fn a_letter_is_written_once() {
        let bend = line(&[(1, 2), (3, 4), (5, 6)]);
        assert_eq!(written(&[bend]), "M1 2L3 4 5 6");
        let zigzag = line(&[(100, 100), (103, 99), (102, 98), (112, 91), (1, 2)]);
        assert_eq!(written(&[zigzag]), "M100 100l3-1-1-1 10-7L1 2");
    }

    #[test]
    fn a_curve_says_its_control_point_once() {
        let arch = path(&[(1, 5, true), (3, 1, false), (5, 5, true)], false);
        assert_eq!(written(&[arch]), "M1 5Q3 1 5 5");
        let wave = [
            (1, 5, true),
            (3, 1, false),
            (5, 9, false),
            (9, 5, false),
            (9, 9, true),
        ];
        assert_eq!(written(&[path(&wave, false)]), "M1 5Q3 1 4 5T7 7 9 9");
        let far = wave.map(|(x, y, is_on)| (x + 100, y + 100, is_on));
        assert_eq!(written(&[path(&far, false)]), "M101 105q2-4 3 0t3 2 2 2");
    }

    #[test]
    fn a_cubic_curve_says_its_first_control_point_once() {
        let cubic = |points: &[(i64, i64)]| {
            let kind =
                |i: usize| [PathPoint::on, PathPoint::cubic][usize::from(!i.is_multiple_of(3))];
            let points = points.iter().enumerate();
            let points = points.map(|(i, &(x, y))| kind(i)(point(px(x, y))));
            Path::canonical(points.collect(), false)
        };
        let arch = [(1, 5), (1, 1), (5, 1), (5, 5)];
        assert_eq!(written(&[cubic(&arch)]), "M1 5C1 1 5 1 5 5");
        let wave = [
            arch.as_slice(),
            &[(5, 9), (9, 8), (9, 2), (9, -4), (7, 1), (8, 8)],
        ]
        .concat();
        assert_eq!(written(&[cubic(&wave)]), "M1 5C1 1 5 1 5 5S9 8 9 2 7 1 8 8");
        let far: Vec<_> = wave.iter().map(|(x, y)| (x + 100, y + 100)).collect();
        assert_eq!(
            written(&[cubic(&far)]),
            "M101 105c0-4 4-4 4 0s4 3 4-3-2-1-1 6"
        );
    }

    #[test]
    fn an_arc_has_its_radius_and_two_flags() {
        let arc = |a, b, radius: f64, is_large, is_clockwise| {
            let numbers = ArcNumbers {
                radius: units(radius),
                is_large,
                is_clockwise,
            };
            let [a, b] = [a, b].map(|(x, y)| point(px(x, y)));
            let between = PathPoint::arc(Arc::of_numbers([a, b], numbers).through);
            Path::canonical(vec![PathPoint::on(a), between, PathPoint::on(b)], false)
        };
        let one = |a, b, radius, is_large, is_clockwise| {
            written(&[arc(a, b, radius, is_large, is_clockwise)])
        };
        assert_eq!(
            one((1, 2), (5, 6), 3.5, false, true),
            "M1 2A3.5 3.5 0 0 1 5 6"
        );
        assert_eq!(one((1, 2), (-5, 6), 9.0, true, false), "M1 2A9 9 0 1 0-5 6");
        assert_eq!(
            one((100, 200), (98, 203), 7.25, false, false),
            "M100 200a7.25 7.25 0 0 0-2 3"
        );
        // Half circles: half the chord if it is a decimal, or whole px.
        assert_eq!(
            one((1, 2), (6, 2), 0.1, true, true),
            "M1 2A2.5 2.5 0 0 1 6 2"
        );
        assert_eq!(one((1, 2), (6, 8), 0.1, false, false), "M1 2A3 3 0 0 0 6 8");
        let ends = [(1, 2), (5, 6)].map(|(x, y)| point(px(x, y)));
        let middle = |x, y| PathPoint::arc(point(px(x, y)));
        let disc = vec![
            PathPoint::on(ends[0]),
            middle(5, 2),
            PathPoint::on(ends[1]),
            middle(1, 6),
        ];
        let disc = Path::canonical(disc, true);
        assert_eq!(written(&[disc]), "M1 2A2 2 0 0 1 5 6 2 2 0 0 1 1 2z");
    }

    #[test]
    fn a_closed_path_comes_back_to_its_start() {
        let corners = [(1, 2, true), (9, 2, true), (5, 8, true)];
        assert_eq!(written(&[path(&corners, true)]), "M1 2L9 2 5 8z");
        let drop = [(1, 2, true), (9, 2, true), (5, 8, false)];
        assert_eq!(written(&[path(&drop, true)]), "M1 2L9 2Q5 8 1 2z");
        let ring = [(0, 0, false), (8, 0, false), (8, 8, false), (0, 8, false)];
        assert_eq!(written(&[path(&ring, true)]), "M0 4Q0 0 4 0T8 4 4 8 0 4z");
    }

    #[test]
    fn strokes_apart_are_parts_of_a_path() {
        let (a, b, c) = ((100, 100), (110, 100), (112, 90));
        let two = [line(&[a, b]), line(&[c, a])];
        assert_eq!(written(&two), "M100 100l10 0m2-10l-12 10");
        let closed = path(&[(100, 100, true), (110, 100, true), (112, 90, true)], true);
        let after = line(&[(101, 101), (108, 99)]);
        assert_eq!(written(&[closed, after]), "M100 100l10 0 2-10zm1 1l7-2");
    }

    #[test]
    fn strokes_end_to_end_stay_two() {
        let (a, b, c) = ((1, 2), (3, 4), (5, 6));
        assert_eq!(written(&[line(&[a, b]), line(&[b, c])]), "M1 2L3 4M3 4L5 6");
    }

    #[test]
    fn after_a_dot_steps_are_absolute() {
        let dot = || line(&[(100, 100)]);
        let d = written(&[dot(), dot(), line(&[(100, 100), (101, 100)])]);
        assert_eq!(d, "M100 100h0.01M100 100h0.01M100 100l1 0");
    }

    #[test]
    fn points_that_change_nothing_are_not_read() {
        for (d, expected) in [
            ("M1 2L1 2", "M1 2h0.01"),
            ("M1 2L3 4L3 4L5 6", "M1 2L3 4 5 6"),
            ("M1 2Q1 2 5 6", "M1 2L5 6"),
            ("M1 2C2 3 4 5 5 6", "M1 2L5 6"),
            ("M1 2C1 2 5 6 5 6", "M1 2L5 6"),
            ("M1 2C0 1 4 5 5 6", "M1 2C0 1 4 5 5 6"),
            ("M1 2A3 3 0 0 1 1 2", "M1 2h0.01"),
            ("M1 2A3 3 0 0 1 5 2L6 2", "M1 2A3 3 0 0 1 5 2L6 2"),
            ("M1 2a3 3 0 015 0", "M1 2A3 3 0 0 1 6 2"),
            ("M1 2L9 2L5 8L1 2Z", "M1 2L9 2 5 8z"),
            ("M1 5Q3 1 4 5Q5 9 9 9", "M1 5Q3 1 4 5T9 9"),
            ("M1,2 3 4 L5e0  6 ", "M1 2L3 4 5 6"),
        ] {
            assert_eq!(
                data(
                    &parse(d, Kind::Line, Unit::PX).unwrap(),
                    Kind::Line,
                    Unit::PX
                ),
                expected
            );
        }
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
            "M1 2L--3 4",
            "Mé 2L3 4",
            "L1 2",
            "M1 2M3 4L5 6",
            "M1 2L3 4h0.01",
            "M1 2h0.01L3 4",
            "M1 2h0.01m3 4l5 6",
            "M1 2L3 4m5 6",
            "M1 2z",
            "M1 2L3 4z1",
            "M1 2L3 4zL5 6",
            "M1 2L3 4zz",
            "M1 2h0.01z",
            "z",
            "M1 2T3 4",
            "M1 2L3 4T5 6",
            "M1 2Q3 4 5 6L7 8T9 9",
            "M1 2Q3 4",
            "M1 2Q3 4 5 6 7 8",
            "M1 2C3 4 5 6",
            "M1 2S3 4 5 6",
            "M1 2Q3 4 5 6S3 4 5 6",
            "M1 2C3 4 5 6 7 8T9 9",
            "M1 2C3 4 5 6 7 8L7 9S9 9 3 3",
            "M1 2A3 4 0 0 1 5 6",
            "M1 2A3 3 30 0 1 5 6",
            "M1 2A0 0 0 0 1 5 6",
            "M1 2A-3-3 0 0 1 5 6",
            "M1 2A3 3 0 0 2 5 6",
            "M1 2A3.0000001 3.0000001 0 0 1 5 6",
            "M1 2A3 3 0 0 1",
            "M1 2H5",
            "M1 2V5",
            "M2000000000 1l2000000000 1l1 1",
            "M1 2Q2000000000 1-2000000000 1T0 0",
        ];
        for d in refused {
            assert_eq!(parse(d, Kind::Line, Unit::PX), None, "{d}");
        }
    }

    #[test]
    fn rings_have_letters_for_horizontal_and_vertical_lines() {
        let square = path(
            &[
                (100, 100, true),
                (140, 100, true),
                (140, 130, true),
                (100, 130, true),
            ],
            true,
        );
        let hole = path(
            &[(110, 110, true), (110, 120, true), (130, 120, false)],
            true,
        );
        let rings = [square, hole];
        let d = data(&rings, Kind::Ring, Unit::PX);
        assert_eq!(d, "M100 100h40v30H100zm10 10v10q20 0 0-10z");
        assert_eq!(parse(&d, Kind::Ring, Unit::PX).as_deref(), Some(&rings[..]));
        assert_eq!(parse(&d, Kind::Line, Unit::PX), None);
        assert_eq!(
            parse("M1 2H9 12V8z", Kind::Ring, Unit::PX),
            Some(vec![path(
                &[(1, 2, true), (9, 2, true), (12, 2, true), (12, 8, true)],
                true
            )])
        );
        for open in ["M1 2h0.01", "M1 2L3 4 5 9", "M1 2h4v4M1 1h3v3z", "h4v4z"] {
            assert_eq!(parse(open, Kind::Ring, Unit::PX), None, "{open}");
        }
    }
}
