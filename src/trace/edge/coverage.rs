//! The exact share of each pixel that a ring covers, and its derivatives, near its edges.

use super::curve::Ring;
use super::segment::Vertex;
use crate::math::{Point, Vec2};

/// A page of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Page {
    /// Column and row of the first pixel.
    pub(super) origin: [i32; 2],
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Page {
    /// The index of a pixel, or of the nearest one.
    pub(super) fn index(&self, [x, y]: [i32; 2]) -> usize {
        let x = (x - self.origin[0]).clamp(0, self.width as i32 - 1);
        let y = (y - self.origin[1]).clamp(0, self.height as i32 - 1);
        y as usize * self.width + x as usize
    }

    /// The part of an edge that is on the page, or [`MARGIN`] beside it.
    fn clipped(&self, from: Point, to: Point) -> Option<[Point; 2]> {
        let way = to - from;
        let mut range = [0.0_f64, 1.0];
        let axes = [
            (from.x, way.x, 0, self.width),
            (from.y, way.y, 1, self.height),
        ];
        for (at, way, axis, size) in axes {
            let low = f64::from(self.origin[axis] - MARGIN);
            let high = low + size as f64 + 2.0 * f64::from(MARGIN);
            if way == 0.0 && !(low..=high).contains(&at) {
                return None;
            }
            if way != 0.0 {
                let [a, b] = [low, high].map(|side| (side - at) / way);
                range = [range[0].max(a.min(b)), range[1].min(a.max(b))];
            }
        }
        (range[0] <= range[1]).then(|| range.map(|t| from + t * way))
    }

    fn has(&self, [x, y]: [i32; 2]) -> bool {
        let [x, y] = [x - self.origin[0], y - self.origin[1]];
        x >= 0 && y >= 0 && (x as usize) < self.width && (y as usize) < self.height
    }
}

/// Neighbouring pixels of a row.
#[derive(Debug, Clone, Copy)]
struct Run {
    first: i32,
    end: i32,
    /// The index of its first pixel among all of the band.
    offset: usize,
}

/// The pixels near some segments of a ring, row by row.
#[derive(Debug, Clone)]
pub(super) struct Band {
    page: Page,
    /// The first row.
    top: i32,
    /// The index of the first run of each row, and the number of all.
    rows: Vec<usize>,
    runs: Vec<Run>,
    count: usize,
    /// The share that the ring covers left of each run.
    before: Vec<f64>,
}

/// Distance of the pixels of a band from its segments, px.
const MARGIN: i32 = 3;

impl Band {
    /// The pixels of a page near some segments of a ring, and near `others`.
    pub(super) fn of(ring: &Ring, segments: &[usize], others: &[&Ring], page: Page) -> Self {
        // 1. Pieces of rows near places about a px apart.
        let owns = ring.owns();
        let mut pieces: Vec<[i32; 3]> = Vec::new();
        let mut last = None;
        let mut add = |p: Point| {
            let [x, y] = [p.x.floor() as i32, p.y.floor() as i32];
            if last.replace([x, y]) == Some([x, y]) {
                return;
            }
            pieces.extend((y - MARGIN..=y + MARGIN).map(|y| [y, x - MARGIN, x + MARGIN + 1]));
        };
        let own = segments.iter().map(|&i| ring.polyline_of(i, &owns));
        let others = others.iter().flat_map(|other| {
            let owns = other.owns();
            (0..other.segments()).map(move |i| other.polyline_of(i, &owns))
        });
        for vertices in own.chain(others) {
            for pair in vertices.windows(2) {
                let Some([from, to]) = page.clipped(pair[0].at, pair[1].at) else {
                    continue;
                };
                let way = to - from;
                let count = way.hypot().ceil() as usize;
                (0..count).for_each(|k| add(from + k as f64 / count as f64 * way));
                add(to);
            }
        }
        Self::of_pieces(ring, pieces, page)
    }

    /// All pixels of a page in the box of a ring.
    pub(super) fn around(ring: &Ring, page: Page) -> Self {
        let owns = ring.owns();
        let vertices = (0..ring.segments()).flat_map(|i| ring.polyline_of(i, &owns));
        let mut rows = [f64::INFINITY, f64::NEG_INFINITY];
        let mut columns = rows;
        for vertex in vertices {
            for ([low, high], at) in [(&mut columns, vertex.at.x), (&mut rows, vertex.at.y)] {
                (*low, *high) = (low.min(at), high.max(at));
            }
        }
        let [rows, columns] =
            [rows, columns].map(|[low, high]| [low.floor() as i32, high.ceil() as i32]);
        let top = page.origin[1];
        let rows = rows[0].max(top)..rows[1].min(top + page.height as i32);
        let pieces = rows.map(|y| [y, columns[0], columns[1]]);
        Self::of_pieces(ring, pieces.collect(), page)
    }

    /// The pixels of some parts of rows, each with its row, its first column and the one behind its last, within the page.
    fn of_pieces(ring: &Ring, mut pieces: Vec<[i32; 3]>, page: Page) -> Self {
        let owns = ring.owns();
        // 2. Those that overlap are one.
        let [left, top] = page.origin;
        let [right, bottom] = [left + page.width as i32, top + page.height as i32];
        pieces.retain_mut(|[y, first, end]| {
            (*first, *end) = ((*first).max(left), (*end).min(right));
            *y >= top && *y < bottom && first < end
        });
        // Rows and columns of a page are not negative, so that they sort as one number.
        pieces.sort_unstable_by_key(|[y, first, _]| {
            (((y - top) as u64) << 32) | (first - left) as u64
        });
        let mut band = Self {
            page,
            top: pieces.first().map_or(0, |piece| piece[0]),
            rows: vec![0],
            runs: Vec::new(),
            count: 0,
            before: Vec::new(),
        };
        for row in pieces.chunk_by(|a, b| a[0] == b[0]) {
            // Rows without pieces have no runs.
            while band.top + (band.rows.len() as i32 - 1) < row[0][0] {
                band.rows.push(band.runs.len());
            }
            let first = band.runs.len();
            for &[_, start, end] in row {
                match band.runs[first..].last_mut() {
                    Some(run) if start <= run.end => run.end = run.end.max(end),
                    _ => band.runs.push(Run {
                        first: start,
                        end,
                        offset: 0,
                    }),
                }
            }
            band.rows.push(band.runs.len());
        }
        for run in &mut band.runs {
            run.offset = band.count;
            band.count += (run.end - run.first) as usize;
        }
        // 3. What edges left of each run cover of its row.
        band.before = vec![0.0; band.runs.len()];
        for i in 0..ring.segments() {
            let vertices = ring.polyline_of(i, &owns);
            for pair in vertices.windows(2) {
                let (from, to) = (pair[0].at, pair[1].at);
                band.add_before(from, to);
            }
        }
        band
    }

    fn add_before(&mut self, from: Point, to: Point) {
        let (low, high) = (from.y.min(to.y), from.y.max(to.y));
        let last = self.top + self.rows.len() as i32 - 1;
        let rows = (low.floor() as i32).max(self.top)..(high.ceil() as i32).min(last);
        for y in rows {
            let runs = self.rows[(y - self.top) as usize]..self.rows[(y - self.top) as usize + 1];
            if runs.is_empty() || self.runs[runs.end - 1].first as f64 <= from.x.min(to.x) {
                continue;
            }
            // The part of the edge in this row, and left of each run.
            let way = to - from;
            let at = |y: f64| ((y - from.y) / way.y).clamp(0.0, 1.0);
            let (a, b) = (at(f64::from(y)), at(f64::from(y) + 1.0));
            let (a, b) = if a < b { (a, b) } else { (b, a) };
            for k in runs {
                let x = f64::from(self.runs[k].first);
                let [p, q] = [a, b].map(|t| from.x + t * way.x);
                let share = match (p < x, q < x) {
                    (true, true) => 1.0,
                    (false, false) => 0.0,
                    (true, false) => (x - p) / (q - p),
                    (false, true) => (x - q) / (p - q),
                };
                self.before[k] -= share * (b - a) * way.y;
            }
        }
    }

    /// The number of pixels.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// The places of the pixels, in their order.
    pub(super) fn places(&self) -> impl Iterator<Item = [i32; 2]> + '_ {
        let rows = self.rows.windows(2).zip(self.top..);
        rows.flat_map(|(runs, y)| {
            let runs = &self.runs[runs[0]..runs[1]];
            runs.iter()
                .flat_map(move |run| (run.first..run.end).map(move |x| [x, y]))
        })
    }

    /// The index of a pixel, and that of the end of its run.
    fn index(&self, [x, y]: [i32; 2]) -> Option<(usize, usize)> {
        let row = usize::try_from(y - self.top)
            .ok()
            .filter(|row| row + 1 < self.rows.len())?;
        let runs = &self.runs[self.rows[row]..self.rows[row + 1]];
        let run = runs.iter().find(|run| run.first <= x && x < run.end)?;
        let index = run.offset + (x - run.first) as usize;
        Some((index, run.offset + (run.end - run.first) as usize))
    }
}

/// The part of an edge that lies in one pixel.
#[derive(Debug, Clone, Copy)]
struct Piece {
    pixel: usize,
    /// The first vertex of its edge; the second one follows.
    first: usize,
    /// From its start to its end, px.
    along: Vec2,
    /// The place of its middle between both vertices, 0 to 1.
    middle: f64,
}

/// The shares that a ring covers of the pixels of a band, by the signed area within it.
#[derive(Debug, Clone)]
pub(super) struct Coverage<'a> {
    band: &'a Band,
    /// What edges cover of their own pixels, and the change of all further pixels of the run, which begins at a pixel.
    inner: Vec<f64>,
    steps: Vec<f64>,
    vertices: Vec<Vertex>,
    pieces: Vec<Piece>,
    /// True if an edge has left the band within the page, so that the shares are not those of all that it covers.
    pub(super) is_outside: bool,
}

impl<'a> Coverage<'a> {
    /// Nothing but what lies left of the runs.
    pub(super) fn none(band: &'a Band) -> Self {
        Self {
            band,
            inner: vec![0.0; band.len()],
            steps: vec![0.0; band.len()],
            vertices: Vec::new(),
            pieces: Vec::new(),
            is_outside: false,
        }
    }

    /// The coverage of a ring.
    pub(super) fn of(ring: &Ring, band: &'a Band) -> Self {
        let mut coverage = Self::none(band);
        let owns = ring.owns();
        (0..ring.segments()).for_each(|i| coverage.add(ring, i, &owns));
        coverage
    }

    /// Adds segment `i` of a ring. Rings are whole in the end, but their segments may come in any order.
    pub(super) fn add(&mut self, ring: &Ring, i: usize, owns: &[usize]) {
        let first = self.vertices.len();
        self.vertices.extend(ring.polyline_of(i, owns));
        for k in first..self.vertices.len() - 1 {
            self.add_edge(k);
        }
    }

    /// Forgets how the shares move.
    pub(super) fn forget(&mut self) {
        self.vertices.clear();
        self.pieces.clear();
        self.is_outside = false;
    }

    /// The share of each pixel; 1 where a line overlaps itself inside of a join.
    pub(super) fn shares(&self) -> Vec<f64> {
        let sums = self.sums().into_iter();
        sums.map(|sum| sum.min(1.0)).collect()
    }

    /// The share of each pixel, more than 1 where it is covered twice.
    fn sums(&self) -> Vec<f64> {
        let mut shares = self.inner.clone();
        for (run, before) in self.band.runs.iter().zip(&self.band.before) {
            let end = run.offset + (run.end - run.first) as usize;
            let mut sum = *before;
            let steps = &self.steps[run.offset..end];
            for (share, step) in shares[run.offset..end].iter_mut().zip(steps) {
                sum += step;
                *share += sum;
            }
        }
        shares
    }

    /// Adds an edge, pixel by pixel.
    fn add_edge(&mut self, first: usize) {
        let band = self.band;
        let [from, to] = [self.vertices[first].at, self.vertices[first + 1].at];
        let bottom = f64::from(band.top + band.rows.len() as i32 - 1);
        if from.y.max(to.y) <= f64::from(band.top) || from.y.min(to.y) >= bottom {
            self.is_outside |= band
                .page
                .has([from.x.floor() as i32, from.y.floor() as i32]);
            return;
        }
        let way = to - from;
        let mut t = 0.0;
        while t < 1.0 {
            let at = from + t * way;
            // The pixel that the edge is about to cross, and where it leaves that.
            let cell = |at: f64, way: f64| {
                if way < 0.0 {
                    at.ceil() - 1.0
                } else {
                    at.floor()
                }
            };
            let [x, y] = [cell(at.x, way.x), cell(at.y, way.y)];
            let leaves = |at: f64, way: f64, cell: f64| match way {
                way if way > 0.0 => t + (cell + 1.0 - at) / way,
                way if way < 0.0 => t + (cell - at) / way,
                _ => 1.0,
            };
            let end = leaves(at.x, way.x, x).min(leaves(at.y, way.y, y)).min(1.0);
            // Rounding may leave it where it is.
            let end = end.max(t + 1e-9);
            let (along, middle) = ((end - t) * way, 0.5 * (t + end));
            let right = x + 1.0 - (from.x + middle * way.x);
            t = end;
            let place = [x as i32, y as i32];
            let Some((pixel, end)) = band.index(place) else {
                self.is_outside |= band.page.has(place);
                continue;
            };
            // The pixel has what lies between the piece and its right border, all further ones the whole height.
            self.inner[pixel] -= along.y * right;
            if pixel + 1 < end {
                self.steps[pixel + 1] -= along.y;
            }
            self.pieces.push(Piece {
                pixel,
                first,
                along,
                middle,
            });
        }
    }

    /// The derivatives of the shares by the unknowns: pixel, unknown, slope. Some have several entries.
    pub(super) fn slopes(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let vertices = &self.vertices;
        let sums = self.sums();
        // What is covered twice stays covered.
        let counts = move |piece: &&Piece| sums[piece.pixel] < FULL;
        self.pieces.iter().filter(counts).flat_map(move |piece| {
            // An edge that moves by v sweeps v × along.
            let ends = [piece.first, piece.first + 1].into_iter();
            let parts = ends.zip([1.0 - piece.middle, piece.middle]);
            parts.flat_map(move |(vertex, weight)| {
                let slopes = vertices[vertex].slopes().iter();
                slopes.map(move |(unknown, v)| {
                    (
                        piece.pixel,
                        *unknown as usize,
                        weight * v.cross(piece.along),
                    )
                })
            })
        })
    }

    /// The pixels that edges touch.
    pub(super) fn touched(&self) -> Vec<usize> {
        let mut pixels: Vec<usize> = self.pieces.iter().map(|piece| piece.pixel).collect();
        pixels.sort_unstable();
        pixels.dedup();
        pixels
    }
}

/// A share that says that a pixel is covered twice.
const FULL: f64 = 1.0 + 1e-6;

#[cfg(test)]
mod tests {
    use super::super::line::Line;
    use super::super::segment::{Knot, Segment};
    use super::*;
    use crate::scene::{Cap, Shape};

    const PAGE: Page = Page {
        origin: [2, 1],
        width: 30,
        height: 26,
    };

    /// A ring with a segment of each kind, a circle, and lines of one width and of a varying one.
    fn rings() -> Vec<Ring> {
        let knot = |x, y, segment| Knot {
            at: Point::new(x, y),
            segment,
            is_smooth: false,
            radius: 0.0,
        };
        let controls = [Point::new(13.0, 22.3), Point::new(4.1, 20.2)];
        let knots = vec![
            knot(5.3, 4.2, Segment::Line),
            knot(18.7, 3.6, Segment::Arc(0.4)),
            knot(20.1, 14.9, Segment::Cubic(controls)),
        ];
        let circle = Ring::Shape {
            shape: Shape::circle(Point::new(20.3, 15.8), 7.4),
            turn: 1.0,
        };
        // An arc that two lines touch, with round ends; and a circle with a pen.
        let hook = [
            knot(8.3, 21.2, Segment::Line),
            Knot {
                is_smooth: true,
                ..knot(8.3, 12.4, Segment::Arc(1.0))
            },
            Knot {
                is_smooth: true,
                ..knot(21.9, 12.4, Segment::Line)
            },
            knot(21.9, 19.7, Segment::Line),
        ];
        let swelling = Line {
            knots: hook
                .iter()
                .zip([0.4, 1.3, 3.2, 0.3])
                .map(|(knot, radius)| Knot { radius, ..*knot })
                .collect(),
            is_even: false,
            ..Line::even(&hook, false, 1.0, Cap::Round)
        };
        let hook = Line::even(&hook, false, 2.17, Cap::Round);
        let loop_ = [
            knot(9.1, 13.2, Segment::Arc(1.0)),
            knot(22.73, 13.6, Segment::Arc(1.0)),
        ];
        let loop_ = Line::even(&loop_, true, 1.9, Cap::Round);
        vec![
            Ring::Knots(knots),
            circle,
            Ring::Line(hook),
            Ring::Line(loop_),
            Ring::Line(swelling),
        ]
    }

    fn is_swelling(ring: &Ring) -> bool {
        matches!(ring, Ring::Line(line) if !line.is_even)
    }

    fn whole(ring: &Ring) -> Band {
        let all: Vec<usize> = (0..ring.segments()).collect();
        Band::of(ring, &all, &[], PAGE)
    }

    #[test]
    fn pixels_within_are_covered_wholly_and_others_by_what_the_area_leaves() {
        for ring in rings() {
            let band = whole(&ring);
            let shares = Coverage::of(&ring, &band).shares();
            // Pieces of edges are at least 1e-9 of these long, and may be longer than what is left of their pixel.
            let hair = if is_swelling(&ring) { 1e-8 } else { 1e-9 };
            assert!(
                shares
                    .iter()
                    .all(|share| (-hair..1.0 + hair).contains(share)),
                "{shares:?}"
            );
            // Both sides of the edges are in the band.
            assert!(shares.iter().any(|share| share.abs() < 1e-9));
            assert!(shares.iter().any(|share| (share - 1.0).abs() < 1e-9));
        }
        // The middle of the disc is beyond the band.
        let disc = &rings()[1];
        let band = whole(disc);
        let sum: f64 = Coverage::of(disc, &band).shares().iter().sum();
        let inside = |[x, y]: [i32; 2]| {
            let p = Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            (p - Point::new(20.3, 15.8)).hypot() < 4.0 && !band.places().any(|q| q == [x, y])
        };
        let pixels = (0..40).flat_map(|y| (0..40).map(move |x| [x, y]));
        let rest = pixels.filter(|p| inside(*p)).count() as f64;
        let area = std::f64::consts::PI * 7.4 * 7.4;
        assert!((sum + rest - area).abs() < 1e-6, "{sum} {rest} {area}");
    }

    #[test]
    fn slopes_are_central_differences() {
        for ring in rings() {
            let band = whole(&ring);
            let values = ring.values();
            // The polygon of a round end turns with the line.
            let tolerance = if matches!(ring, Ring::Line(_)) {
                0.03
            } else {
                1e-4
            };
            let coverage = Coverage::of(&ring, &band);
            let mut slopes = vec![vec![0.0; values.len()]; band.len()];
            coverage
                .slopes()
                .for_each(|(i, k, slope)| slopes[i][k] += slope);
            const STEP: f64 = 1e-6;
            for k in 0..values.len() {
                // The sides of a swelling arc turn with its bulge, which moves it by many px.
                let largest = slopes.iter().fold(1.0, |l: f64, s| l.max(s[k].abs()));
                let tolerance = tolerance * if is_swelling(&ring) { largest } else { 1.0 };
                let moved = [-STEP, STEP].map(|step| {
                    let mut values = values.clone();
                    values[k] += step;
                    Coverage::of(&ring.with(&values), &band).shares()
                });
                for (i, slopes) in slopes.iter().enumerate() {
                    let expected = (moved[1][i] - moved[0][i]) / (2.0 * STEP);
                    let found = slopes[k];
                    assert!(
                        (found - expected).abs() < tolerance,
                        "{i} {k}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn an_edge_that_leaves_the_band_says_so() {
        let ring = &rings()[1];
        let band = whole(ring);
        assert!(!Coverage::of(ring, &band).is_outside);
        let far = ring.with(&[24.9, 15.8, 7.4]);
        assert!(Coverage::of(&far, &band).is_outside);
    }
}
