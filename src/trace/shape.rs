//! Connected shapes: their pixels, and the distance of each from the outside.

/// A connected set of pixels in a frame that leaves a border of one pixel around it.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    /// The place of the frame's first pixel in the picture.
    pub(super) origin: [isize; 2],
    pub(super) width: usize,
    pub(super) height: usize,
    /// True if each pixel of the frame is one of the shape, row by row.
    pub(super) inside: Vec<bool>,
}

/// The 8-connected shapes of the pixels of a picture with the same key; those without a key belong to none.
pub(super) fn shapes<K: Copy + PartialEq>(
    keys: &[Option<K>],
    width: usize,
    least: usize,
) -> Vec<(K, Shape)> {
    let found = connected(keys, width).into_iter();
    let found = found.filter(|(_, members)| members.len() >= least);
    found
        .map(|(key, members)| (key, Shape::of(&members, width)))
        .collect()
}

/// The 8-connected sets of pixels with the same key.
pub(super) fn connected<K: Copy + PartialEq>(
    keys: &[Option<K>],
    width: usize,
) -> Vec<(K, Vec<usize>)> {
    let height = keys.len() / width;
    let mut seen = vec![false; keys.len()];
    let mut found = Vec::new();
    let mut stack = Vec::new();
    for start in 0..keys.len() {
        let Some(key) = keys[start].filter(|_| !seen[start]) else {
            continue;
        };
        let mut members = Vec::new();
        seen[start] = true;
        stack.push(start);
        while let Some(i) = stack.pop() {
            members.push(i);
            let (x, y) = (i % width, i / width);
            for row in y.saturating_sub(1)..(y + 2).min(height) {
                for column in x.saturating_sub(1)..(x + 2).min(width) {
                    let k = row * width + column;
                    if !seen[k] && keys[k] == Some(key) {
                        seen[k] = true;
                        stack.push(k);
                    }
                }
            }
        }
        found.push((key, members));
    }
    found
}

impl Shape {
    fn of(members: &[usize], width: usize) -> Self {
        let xs = members.iter().map(|i| i % width);
        let ys = members.iter().map(|i| i / width);
        let [left, right] = [xs.clone().min(), xs.max()].map(Option::unwrap_or_default);
        let [top, bottom] = [ys.clone().min(), ys.max()].map(Option::unwrap_or_default);
        let (frame_width, frame_height) = (right - left + 3, bottom - top + 3);
        let mut inside = vec![false; frame_width * frame_height];
        for i in members {
            let (x, y) = (i % width - left + 1, i / width - top + 1);
            inside[y * frame_width + x] = true;
        }
        Self {
            origin: [left as isize - 1, top as isize - 1],
            width: frame_width,
            height: frame_height,
            inside,
        }
    }

    /// The centre of pixel `i` of the frame, px of the picture.
    pub(super) fn place(&self, i: usize) -> [f32; 2] {
        let [x, y] = [i % self.width, i / self.width].map(|v| v as isize);
        [self.origin[0] + x, self.origin[1] + y].map(|v| v as f32 + 0.5)
    }

    /// Pixel `i` of the frame, which is one of the shape, in a picture `width` px wide.
    pub(super) fn pixel(&self, i: usize, width: usize) -> usize {
        let [x, y] = [i % self.width, i / self.width].map(|v| v as isize);
        (self.origin[1] + y) as usize * width + (self.origin[0] + x) as usize
    }

    /// The columns and rows, in the picture, of the pixels of the shape and of those beside it.
    pub(super) fn with_border(&self) -> impl Iterator<Item = [isize; 2]> + '_ {
        let (w, h) = (self.width as isize, self.height as isize);
        let inside = move |x: isize, y: isize| {
            x >= 0 && y >= 0 && x < w && y < h && self.inside[(y * w + x) as usize]
        };
        let near = move |&[x, y]: &[isize; 2]| {
            (-1..=1).any(|dy| (-1..=1).any(|dx| inside(x + dx, y + dy)))
        };
        let frame = (0..h).flat_map(move |y| (0..w).map(move |x| [x, y]));
        let members = frame.filter(near);
        members.map(|[x, y]| [x + self.origin[0], y + self.origin[1]])
    }

    /// The squared distance of each pixel's centre to the nearest pixel outside, px².
    pub(super) fn distances2(&self) -> Vec<f32> {
        let far = (self.width + self.height) as f32;
        let mut field: Vec<f32> = self
            .inside
            .iter()
            .map(|&inside| if inside { far * far } else { 0.0 })
            .collect();
        let mut column = vec![0.0; self.height];
        let mut envelope = Envelope::default();
        for x in 0..self.width {
            for (y, value) in column.iter_mut().enumerate() {
                *value = field[y * self.width + x];
            }
            envelope.transform(&mut column);
            for (y, value) in column.iter().enumerate() {
                field[y * self.width + x] = *value;
            }
        }
        for row in field.chunks_exact_mut(self.width) {
            envelope.transform(row);
        }
        field
    }
}

/// The lower envelope of parabolas, after Felzenszwalb and Huttenlocher, "Distance transforms of sampled functions".
#[derive(Default)]
struct Envelope {
    places: Vec<usize>,
    starts: Vec<f32>,
    values: Vec<f32>,
}

impl Envelope {
    /// Replaces each value by the least of `values[k] + (i − k)²`.
    fn transform(&mut self, values: &mut [f32]) {
        // Felzenszwalb and Huttenlocher: the lower envelope of the parabolas values[k] + (i − k)², in linear time.
        // First pass: each new parabola hides those on top of the stack that it meets before they begin.
        self.values.clear();
        self.values.extend_from_slice(values);
        self.places.clear();
        self.starts.clear();
        for (i, &value) in self.values.iter().enumerate() {
            let mut start = f32::NEG_INFINITY;
            while let Some(&k) = self.places.last() {
                let (p, q) = (k as f32, i as f32);
                start = ((value + q * q) - (self.values[k] + p * p)) / (2.0 * (q - p));
                if self.starts.last().is_some_and(|&last| start > last) {
                    break;
                }
                self.places.pop();
                self.starts.pop();
                start = f32::NEG_INFINITY;
            }
            self.places.push(i);
            self.starts.push(start);
        }
        // Second pass: the envelope from left to right.
        let mut k = 0;
        for (i, value) in values.iter_mut().enumerate() {
            while self.starts.get(k + 1).is_some_and(|&s| s < i as f32) {
                k += 1;
            }
            let place = self.places[k];
            let away = i.abs_diff(place) as f32;
            *value = self.values[place] + away * away;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shapes of a picture in letters; a space belongs to none.
    fn of(rows: &[&str]) -> Vec<(u8, Shape)> {
        let keys = rows.concat().into_bytes();
        let keys: Vec<Option<u8>> = keys.into_iter().map(|b| (b != b' ').then_some(b)).collect();
        shapes(&keys, rows[0].len(), 2)
    }

    #[test]
    fn shapes_are_connected_by_corners_and_of_one_key() {
        let found = of(&["a b", "ab ", "  a", "aa "]);
        let sizes: Vec<_> = found
            .iter()
            .map(|(key, shape)| (*key, shape.inside.iter().filter(|i| **i).count()))
            .collect();
        assert_eq!(sizes, [(b'a', 2), (b'b', 2), (b'a', 3)]);
    }

    #[test]
    fn distances_are_to_the_nearest_pixel_outside() {
        let square = &of(&["aaaaa"; 5])[0].1;
        let distances = square.distances2();
        let row = |y: usize| &distances[y * square.width..][..square.width];
        assert_eq!(row(1), [0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0]);
        assert_eq!(row(3), [0.0, 1.0, 4.0, 9.0, 4.0, 1.0, 0.0]);
    }

    #[test]
    fn distances_go_across_corners() {
        // Of the pixels outside, the corner's is the nearest one to the middle.
        let ell = &of(&["aaaa ", "aaaaa", "aaaaa", "aaaaa", "aaaaa"])[0].1;
        let at = |x: usize, y: usize| ell.distances2()[(y + 1) * ell.width + x + 1];
        assert_eq!(at(2, 2), 8.0_f32.min(9.0));
    }

    #[test]
    fn the_border_is_one_pixel_wide() {
        let bar = &of(&["     ", " aa  ", "     "])[0].1;
        let border: Vec<_> = bar.with_border().collect();
        assert_eq!(border.len(), 12);
        assert!(border.contains(&[0, 0]) && border.contains(&[3, 2]));
    }
}
