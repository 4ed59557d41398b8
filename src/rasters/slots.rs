//! A lookup from pixels of a picture to their places in a list.

/// For each pixel of a picture, its place among some of them.
#[derive(Debug)]
pub(super) struct Slots(Vec<u32>);

const NOWHERE: u32 = u32::MAX;

impl Slots {
    /// No places yet, for a picture of so many pixels.
    pub(super) fn new(pixels: usize) -> Self {
        Self(vec![NOWHERE; pixels])
    }

    /// Number of pixels of the picture.
    pub(super) fn pixels(&self) -> usize {
        self.0.len()
    }

    /// Gives each of these pixels its place among them.
    pub(super) fn set(&mut self, pixels: &[u32]) {
        for (slot, &pixel) in (0..).zip(pixels) {
            self.0[pixel as usize] = slot;
        }
    }

    /// Takes their places from these pixels.
    pub(super) fn clear(&mut self, pixels: &[u32]) {
        for &pixel in pixels {
            self.0[pixel as usize] = NOWHERE;
        }
    }

    /// The place of this pixel.
    pub(super) fn find(&self, pixel: u32) -> Option<usize> {
        let slot = self.0[pixel as usize];
        (slot != NOWHERE).then_some(slot as usize)
    }
}
