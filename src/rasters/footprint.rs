//! The pixels that a shape covers.

/// The pixels of a picture that a shape covers, and how much of each.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Footprint {
    pixels: Vec<u32>,
    /// 1 to 255.
    levels: Vec<u8>,
}

impl Footprint {
    /// The indices of the pixels, counted row by row, rising.
    pub(crate) fn pixels(&self) -> &[u32] {
        &self.pixels
    }

    /// The index of each pixel, and its coverage, 1 to 255.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, u8)> {
        let levels = self.levels.iter().copied();
        self.pixels.iter().copied().zip(levels)
    }
}

/// The footprint of pixels by rising index, each with its coverage, 0 to 255.
impl FromIterator<(u32, u8)> for Footprint {
    fn from_iter<I: IntoIterator<Item = (u32, u8)>>(covered: I) -> Self {
        let covered = covered.into_iter().filter(|&(_, level)| level > 0);
        let (pixels, levels) = covered.unzip();
        Self { pixels, levels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_covered_counts() {
        let footprint: Footprint = [(12, 0), (13, 255), (24, 51), (99, 0)]
            .into_iter()
            .collect();
        assert_eq!(footprint.iter().collect::<Vec<_>>(), [(13, 255), (24, 51)]);
        assert_eq!(footprint.pixels(), [13, 24]);
    }
}
