//! Contours: the closed lines along which a field is ½, by marching squares.

use crate::math::distance;

/// A place, px.
pub(super) type Place = [f32; 2];

/// The value at a place, by those of the four pixels around it: bilinear, and even beyond the outermost pixels. `at` is in
/// pixels from the centre of the first one, of which there are `[width, height]`.
pub(super) fn between(at: Place, [width, height]: [usize; 2], value: impl Fn(usize) -> f32) -> f32 {
    let pixel = |x: f32, y: f32| {
        let column = (x.max(0.0) as usize).min(width - 1);
        let row = (y.max(0.0) as usize).min(height - 1);
        value(row * width + column)
    };
    let [left, top] = at.map(f32::floor);
    let [u, v] = [at[0] - left, at[1] - top];
    let row = |y: f32| pixel(left, y) * (1.0 - u) + pixel(left + 1.0, y) * u;
    row(top) * (1.0 - v) + row(top + 1.0) * v
}

/// A field on a frame of pixels that is 0 along the frame's border.
pub(super) struct Field {
    /// Column and row of the first pixel in the picture.
    pub(super) origin: [i32; 2],
    pub(super) width: usize,
    pub(super) values: Vec<f32>,
}

impl Field {
    /// The contours. Going along one, what is inside lies to the left, seen with y pointing down.
    pub(super) fn contours(&self) -> Vec<Vec<Place>> {
        let next = self.links();
        let mut seen = vec![false; next.len()];
        let mut rings = Vec::new();
        for start in 0..next.len() {
            if next[start] == NOWHERE || seen[start] {
                continue;
            }
            let mut ring = Vec::new();
            let mut at = start;
            while !seen[at] {
                seen[at] = true;
                ring.push(self.crossing(at));
                at = next[at] as usize;
            }
            rings.push(ring);
        }
        rings
    }

    /// Distance of the edge of the shape outwards from a place on a contour, px, if nothing else is near.
    ///
    /// Between pixel centres the field is no straight ramp, so that a contour is up to 0.09 px off. But the integral of
    /// the field across an edge is exact.
    pub(super) fn edge(&self, at: Place, outward: Place) -> f32 {
        const REACH: f32 = 1.5;
        const STEPS: u8 = 12;
        let step = 2.0 * REACH / f32::from(STEPS);
        let value = |t: f32| self.at([0, 1].map(|k| at[k] + t * outward[k]));
        if value(-REACH) < 0.95 || value(REACH) > 0.05 {
            return 0.0;
        }
        let middles = (0..STEPS).map(|i| -REACH + (f32::from(i) + 0.5) * step);
        let covered: f32 = middles.map(value).sum::<f32>() * step;
        (covered - REACH).clamp(-0.3, 0.3)
    }

    /// The field between pixel centres.
    pub(super) fn at(&self, p: Place) -> f32 {
        let at = [0, 1].map(|k| p[k] - 0.5 - self.origin[k] as f32);
        let height = self.values.len() / self.width;
        between(at, [self.width, height], |i| self.values[i])
    }

    /// The value of a pixel of the picture, 0 beyond the field.
    pub(super) fn share(&self, at: [i32; 2]) -> f32 {
        let [x, y] = [0, 1].map(|k| at[k] - self.origin[k]);
        let is_within = x >= 0 && y >= 0 && (x as usize) < self.width;
        let value = self
            .values
            .get(y.max(0) as usize * self.width + x.max(0) as usize);
        value.filter(|_| is_within).copied().unwrap_or(0.0)
    }

    /// For each edge of the grid of pixel centres that a contour enters a cell through, the edge that it leaves it by.
    ///
    /// Edge 2·i goes from pixel i to the right, edge 2·i + 1 down.
    fn links(&self) -> Vec<u32> {
        let w = self.width;
        let mut next = vec![NOWHERE; 2 * self.values.len()];
        let is_inside = |i: usize| self.values[i] >= 0.5;
        for row in 0..(self.values.len() / w).saturating_sub(1) {
            for i in row * w..(row + 1) * w - 1 {
                let corners = [i, i + 1, i + w + 1, i + w].map(is_inside);
                let case = corners
                    .iter()
                    .rev()
                    .fold(0, |case, &c| 2 * case + u8::from(c));
                let (top, right, bottom, left) = (2 * i, 2 * i + 3, 2 * (i + w), 2 * i + 1);
                let mut link = |from: usize, to: usize| next[from] = to as u32;
                // Corners are 1 (this pixel), 2 (right), 4 (below right), 8 (below).
                match case {
                    1 => link(left, top),
                    2 => link(top, right),
                    3 => link(left, right),
                    4 => link(right, bottom),
                    6 => link(top, bottom),
                    7 => link(left, bottom),
                    8 => link(bottom, left),
                    9 => link(bottom, top),
                    11 => link(bottom, right),
                    12 => link(right, left),
                    13 => link(right, top),
                    14 => link(top, left),
                    5 if self.is_full(i) => {
                        link(left, bottom);
                        link(right, top);
                    }
                    5 => {
                        link(left, top);
                        link(right, bottom);
                    }
                    10 if self.is_full(i) => {
                        link(top, left);
                        link(bottom, right);
                    }
                    10 => {
                        link(top, right);
                        link(bottom, left);
                    }
                    _ => {}
                }
            }
        }
        next
    }

    /// True if the middle of the cell below and right of pixel `i` is inside.
    fn is_full(&self, i: usize) -> bool {
        let w = self.width;
        let sum: f32 = [i, i + 1, i + w, i + w + 1]
            .map(|k| self.values[k])
            .iter()
            .sum();
        sum > 2.0
    }

    /// The place on an edge where the field is ½.
    fn crossing(&self, edge: usize) -> Place {
        let i = edge / 2;
        let [step, dx, dy] = match edge % 2 {
            0 => [1, 1, 0],
            _ => [self.width, 0, 1],
        };
        let (a, b) = (self.values[i], self.values[i + step]);
        let share = (0.5 - a) / (b - a);
        let [x, y] = [i % self.width, i / self.width];
        let at =
            |origin: i32, at: usize, d: usize| origin as f32 + at as f32 + 0.5 + share * d as f32;
        [at(self.origin[0], x, dx), at(self.origin[1], y, dy)]
    }
}

const NOWHERE: u32 = u32::MAX;

/// True if the first place of a contour lies within another one.
pub(super) fn is_within(inner: &[Place], outer: &[Place]) -> bool {
    let [x, y] = inner[0];
    let next = outer.iter().cycle().skip(1);
    let crosses = |(a, b): (&Place, &Place)| {
        let is_level_with = (a[1] > y) != (b[1] > y);
        is_level_with && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    };
    outer.iter().zip(next).filter(|pair| crosses(*pair)).count() % 2 == 1
}

/// Twice the area within a ring, px²; negative if it runs the other way.
pub(super) fn twice_area(ring: &[Place]) -> f32 {
    let next = ring.iter().cycle().skip(1);
    let pairs = ring.iter().zip(next);
    pairs.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
}

/// Places evenly along a ring, about `step` px apart.
pub(super) fn resampled(ring: &[Place], step: f32) -> Vec<Place> {
    let next = ring.iter().cycle().skip(1);
    let sides: Vec<(Place, Place, f32)> = ring
        .iter()
        .zip(next)
        .map(|(&a, &b)| (a, b, distance(a, b)))
        .collect();
    let all: f32 = sides.iter().map(|side| side.2).sum();
    let count = ((all / step).round() as usize).max(8);
    let step = all / count as f32;
    let mut out = Vec::with_capacity(count);
    let mut done = 0.0;
    for (a, b, length) in sides {
        while out.len() < count && out.len() as f32 * step <= done + length {
            let share = (out.len() as f32 * step - done) / length.max(f32::MIN_POSITIVE);
            out.push([0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])));
        }
        done += length;
    }
    // Rounding may leave the last one out.
    out.resize(count, ring[0]);
    out
}
