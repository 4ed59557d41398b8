//! The tuned numbers of the search for damage, all of them in levels of 8 bits where no other unit is named. They are
//! measured on 80 drawings of flat art and icons, on 27 photographs and drawings (`rig robust`).

use std::ops::Range;

/// Search for noise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noises {
    /// Most pixels that are looked at. A guess.
    pub(super) most_sites: usize,
    /// Largest range of the means of 5×5 px within 13×13 px where there is nothing but noise. A guess.
    pub(super) far_range: f32,
    /// Largest range of 5×5 px without an edge, and least range of a block with one. Guesses.
    pub(super) near_range: f32,
    pub(super) edge_range: f32,
    /// Least share of pixels far from edges. Photographs of detail have 0.1 to 0.3, flat art 0.4 and more.
    pub(super) least_far: f32,
    /// Least shares of pixels beside edges, and of pixels of one tone. A guess.
    pub(super) least_near: f32,
    pub(super) least_tone: f32,
    /// Least and most noise: less is not seen, more is hatching.
    pub(super) least: f32,
    pub(super) most: f32,
    /// Largest ratio of the quartiles of noise. White noise has 1.3, such noise after JPEG 1.7, photographs 1.5 to 4.
    pub(super) most_uneven: f32,
    /// Noise beside edges is larger by this than what is measured there as noise, since edges are in it.
    pub(super) near_in_noise: f32,
    /// Largest noise, upper quartile, of a picture that is clean far from edges. JPEG of flat art has 0 to 0.3, photographs
    /// 0.7 and more.
    pub(super) clean: f32,
    /// Least noise in blocks with edges, of which 0.7 have more. Clean flat art has 0 to 0.5, JPEG of quality 90 1.07 and more.
    pub(super) least_beside: f32,
}

impl Noises {
    pub(super) const MEASURED: Self = Self {
        most_sites: 250_000,
        far_range: 24.0,
        near_range: 32.0,
        edge_range: 48.0,
        least_far: 0.3,
        least_near: 0.001,
        least_tone: 0.02,
        least: 0.6,
        most: 25.0,
        most_uneven: 1.75,
        near_in_noise: 1.25,
        clean: 0.6,
        least_beside: 0.8,
    };
}

/// Flat art: most of its pixels have few tones.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlatArt {
    /// So many tones of four levels. A guess.
    pub(super) tones: usize,
    /// The least share of the pixels that have them.
    pub(super) least_share: f32,
}

impl FlatArt {
    pub(super) const MEASURED: Self = Self {
        tones: 8,
        least_share: 0.5,
    };
}

/// Restoration.
#[derive(Debug, Clone, Copy)]
pub(super) struct Restoration {
    /// Coefficients below so many times the noise are left out: far from edges, and beside them. Of 12 drawings, at qualities 90,
    /// 75, 30 of JPEG, 4.1, 5.2, 5.5 times the noise beside edges come nearest to the clean picture.
    pub(super) far: f32,
    pub(super) near: f32,
    /// Range of luma of a block with an edge.
    pub(super) edge_range: f32,
    /// Blocks begin at every pixel, at every second one of larger pictures than this, and at every fourth one of pictures
    /// eight times as large. A guess.
    pub(super) all_blocks: usize,
}

impl Restoration {
    pub(super) const MEASURED: Self = Self {
        far: 3.6,
        near: 5.0,
        edge_range: 48.0,
        all_blocks: 600_000,
    };

    /// Rows and columns from one block to the next in a picture of so many pixels: of a large one fewer blocks hold each pixel, for
    /// time.
    pub(super) fn step(&self, pixels: usize) -> usize {
        let larger = [1, 8].map(|times| pixels > times * self.all_blocks);
        larger.iter().filter(|is| **is).fold(1, |step, _| 2 * step)
    }
}

/// Search for stairs, and their smoothing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stairs {
    /// Most colours of a picture without antialiasing. A guess.
    pub(super) most_colors: usize,
    /// Largest share of the pixels at borders that are unlike three of those beside them: antialiased and dithered ones are.
    pub(super) most_lonely: f32,
    /// Least common side, px, of the squares that a picture is made of; their stairs are meant.
    pub(super) least_square: usize,
    /// Farthest that a border moves, px along an axis. Below 0.5 the centres of pixels keep their colours.
    pub(super) reach: f32,
    /// Rounds of smoothing. A guess.
    pub(super) rounds: usize,
    /// Most pixels of a speck, whose border stays: smooth ones shrink to nothing. A guess.
    pub(super) speck: usize,
    /// Share of specks of what a transparent picture shows from which on its stairs are meant. The difference of two screenshots has
    /// 0.26; a guess.
    pub(super) most_specks: f32,
}

impl Stairs {
    pub(super) const MEASURED: Self = Self {
        most_colors: 32,
        most_lonely: 0.1,
        least_square: 2,
        reach: 0.45,
        rounds: 60,
        speck: 8,
        most_specks: 0.1,
    };
}

/// Search for dithering, and the mean.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dithering {
    /// Least difference, 0..1, of a lonely pixel from those beside it: JPEG leaves less.
    pub(super) least: f32,
    /// Half the side of the window in which lonely pixels are counted, px.
    pub(super) around: usize,
    /// Share of lonely pixels of a dithered window: random ones of two colours have 0.3, lines 1 px wide none.
    pub(super) dense: f32,
    /// Least share of a dithered picture that is. Drawings in the palette of old browsers have 0.08 to 0.8, photographs in 32 or 256
    /// colours without dithering up to 0.012, drawings in few colours 0.
    pub(super) least_share: f32,
    /// Coefficients below so many times the mixture's RMS from planes are left out: `far` of the lowest ones, and more by `rise` times
    /// the square of the frequency, which is 1 for the highest along a side: mixtures are fine. Of 14 drawings, 0.6 and 3.2 come 37.2
    /// dB near to the clean picture, 0.3 and 5 36.4; 3 of all frequencies 33.4, a Gaussian of 1.5 px 26.9, the mixture 25.7.
    pub(super) far: f32,
    pub(super) rise: f32,
}

impl Dithering {
    pub(super) const MEASURED: Self = Self {
        least: 0.15,
        around: 4,
        dense: 0.2,
        least_share: 0.04,
        far: 0.6,
        rise: 3.2,
    };
}

/// Search for uneven light on paper, and for its spots. All of it is a guess.
#[derive(Debug, Clone)]
pub(super) struct Light {
    /// Cells along the shorter side.
    pub(super) cells: usize,
    /// Rounds in which cells without paper are left out.
    pub(super) rounds: usize,
    /// Largest relative difference of paper and the light on it.
    pub(super) near: f32,
    /// Least share of paper in a page.
    pub(super) least_paper: f32,
    /// Least luma of paper, and least range of its luma.
    pub(super) least_luma: f32,
    pub(super) least_range: f32,
    /// RMS of the luma of spots. Even paper has less, and what has more is no paper.
    pub(super) spots: Range<f32>,
    /// Spots are cleared that differ from the paper by less than so many times their RMS.
    pub(super) cleared: f32,
    /// Least luma, and most chroma, of paper that is white.
    pub(super) white_luma: f32,
    pub(super) white_chroma: f32,
}

impl Light {
    pub(super) const MEASURED: Self = Self {
        cells: 12,
        rounds: 4,
        near: 0.06,
        least_paper: 0.7,
        least_luma: 90.0,
        least_range: 12.0,
        spots: 1.0..6.0,
        cleared: 3.0,
        white_luma: 200.0,
        white_chroma: 12.0,
    };
}
