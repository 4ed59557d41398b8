//! Finds strokes of zero length in path data.

use super::number;

type Point = [f64; 2];

/// True if a subpath has a segment and all its points coincide. A lone `M` draws nothing in any program, so
/// it does not count.
pub(super) fn has_zero_length(d: &str) -> bool {
    let mut walk = Walk::default();
    let mut rest = d;
    while let Some(command) = rest.chars().next() {
        rest = &rest[command.len_utf8()..];
        if !command.is_ascii_alphabetic() {
            continue;
        }
        let end = rest.find(|c: char| c.is_ascii_alphabetic() && !matches!(c, 'e' | 'E'));
        let (arguments, after) = rest.split_at(end.unwrap_or(rest.len()));
        walk.follow(command, &number::all(arguments));
        rest = after;
    }
    walk.end_subpath();
    walk.found
}

/// A walk along the path.
#[derive(Default)]
struct Walk {
    start: Point,
    here: Point,
    /// Segments since the last `M`.
    segments: usize,
    /// True if a point since the last `M` differs from it.
    moved: bool,
    found: bool,
}

impl Walk {
    fn follow(&mut self, command: char, arguments: &[f64]) {
        let relative = command.is_ascii_lowercase();
        match command.to_ascii_uppercase() {
            'M' => self.move_to(relative, arguments),
            'Z' => self.close(),
            'H' => self.along_axis(0, relative, arguments),
            'V' => self.along_axis(1, relative, arguments),
            'A' => self.points(relative, arguments, 7, 5),
            'C' => self.points(relative, arguments, 6, 0),
            'S' | 'Q' => self.points(relative, arguments, 4, 0),
            _ => self.points(relative, arguments, 2, 0),
        }
    }

    fn move_to(&mut self, relative: bool, arguments: &[f64]) {
        let Some((&[x, y], more)) = arguments.split_first_chunk() else {
            return;
        };
        self.end_subpath();
        self.here = self.absolute([x, y], relative);
        self.start = self.here;
        self.points(relative, more, 2, 0);
    }

    fn close(&mut self) {
        self.segments += 1;
        self.here = self.start;
    }

    fn along_axis(&mut self, axis: usize, relative: bool, arguments: &[f64]) {
        for &value in arguments {
            let mut to = self.here;
            to[axis] = if relative { to[axis] + value } else { value };
            self.reach(to);
            self.here = to;
            self.segments += 1;
        }
    }

    /// Segments of `count` arguments each, where points start at index `first`.
    fn points(&mut self, relative: bool, arguments: &[f64], count: usize, first: usize) {
        for segment in arguments.chunks_exact(count) {
            let mut to = self.here;
            for &[x, y] in segment[first..].as_chunks().0 {
                to = self.absolute([x, y], relative);
                self.reach(to);
            }
            self.here = to;
            self.segments += 1;
        }
    }

    fn absolute(&self, [x, y]: Point, relative: bool) -> Point {
        if relative {
            [self.here[0] + x, self.here[1] + y]
        } else {
            [x, y]
        }
    }

    fn reach(&mut self, point: Point) {
        self.moved |= point != self.start;
    }

    fn end_subpath(&mut self) {
        self.found |= self.segments > 0 && !self.moved;
        self.segments = 0;
        self.moved = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_without_length_are_found() {
        for d in [
            "M5 5L5 5",
            "M5 5l0 0",
            "M5 5h0",
            "M5,5z",
            "m5 5 0 0",
            "M5 5C5 5 5 5 5 5",
            "M1 1h3M5 5v0",
            "M5 5A2 2 0 0 1 5 5",
            "M5 5l0 0z",
        ] {
            assert!(has_zero_length(d), "{d}");
        }
    }

    #[test]
    fn strokes_of_any_length_are_not() {
        for d in [
            "",
            "M5 5",
            "M5 5h0.01",
            "M5 5L5 6",
            "M1 1 2 2z",
            "M5 5C5 5 6 6 5 5",
            "M5 5l1 0l-1 0",
            "M5 5h1e-3",
            "M1 1M2 2h1",
            "nonsense é",
        ] {
            assert!(!has_zero_length(d), "{d}");
        }
    }
}
