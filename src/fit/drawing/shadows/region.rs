//! A box of whole px, which may go beyond the page.

use kurbo::Rect;

use crate::math::Vec2;
use crate::render::{self, Plane};
use crate::scene::Path;

/// A box of whole px.
pub(super) struct Region {
    origin: [i64; 2],
    pub(super) size: [usize; 2],
}

impl Region {
    /// The least box around `bounds`.
    pub(super) fn around(bounds: Rect) -> Self {
        let bounds = bounds.expand();
        Self {
            origin: [bounds.x0, bounds.y0].map(|px| px as i64),
            size: [bounds.width(), bounds.height()].map(|px| px as usize),
        }
    }

    /// The corner with the least coordinates.
    pub(super) fn corner(&self) -> Vec2 {
        let [x, y] = self.origin.map(|px| px as f64);
        Vec2::new(x, y)
    }

    /// The shares of its pixels that rings cover.
    pub(super) fn covered<'a>(&self, rings: impl IntoIterator<Item = &'a Path>) -> Plane {
        let rings = rings.into_iter();
        let own = rings.map(|ring| ring.clone().moved(-self.corner()));
        render::filled(own, self.size)
    }

    /// The index in the box of the pixel of a page of this size that is nearest to its own.
    pub(super) fn on_page(&self, k: usize, page: [usize; 2]) -> usize {
        let at = [k % self.size[0], k / self.size[0]];
        let [x, y] = [0, 1].map(|axis| {
            let px = at[axis] as i64 + self.origin[axis];
            (px.clamp(0, page[axis] as i64 - 1) - self.origin[axis]) as usize
        });
        y * self.size[0] + x
    }

    /// The pixels that are on a page of this size, each with its index in the box and on the page.
    pub(super) fn pixels(&self, page: [usize; 2]) -> impl Iterator<Item = (usize, usize)> + use<> {
        let [width, height] = self.size;
        let [left, top] = self.origin;
        let on_page = move |k: usize| {
            let [x, y] = [(k % width) as i64 + left, (k / width) as i64 + top];
            let is_on = (0..page[0] as i64).contains(&x) && (0..page[1] as i64).contains(&y);
            is_on.then(|| (k, y as usize * page[0] + x as usize))
        };
        (0..width * height).filter_map(on_page)
    }
}
