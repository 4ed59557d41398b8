//! The colours of a picture that has few.

use crate::image::Image;

/// Red, green, blue and alpha, 0 or 1; all are 0 where a picture is transparent.
pub(super) type Color = [f32; 4];

/// The colours of a picture of few, by pixel.
pub(super) struct Labels {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) colors: Vec<Color>,
    pub(super) of: Vec<u16>,
}

impl Labels {
    /// Most colours of a picture of few: those of a GIF.
    pub(super) const MOST: usize = 256;

    /// Smaller pictures of few colours, px, are pixel art. A guess.
    pub(super) const LEAST_SIDE: usize = 48;

    /// The labels of a picture of at most so many colours; `None` if it has more, or a pixel is translucent.
    pub(super) fn of(picture: &Image, most: usize) -> Option<Self> {
        let pixels = picture.width() * picture.height();
        let mut colors: Vec<Color> = Vec::new();
        let mut of = Vec::with_capacity(pixels);
        let mut last = 0;
        for pixel in 0..pixels {
            let color = color(picture, pixel)?;
            if colors.get(last) != Some(&color) {
                last = match colors.iter().position(|known| *known == color) {
                    Some(known) => known,
                    None if colors.len() < most => {
                        colors.push(color);
                        colors.len() - 1
                    }
                    None => return None,
                };
            }
            of.push(u16::try_from(last).ok()?);
        }
        Some(Self {
            width: picture.width(),
            height: picture.height(),
            colors,
            of,
        })
    }

    /// True if the picture is transparent somewhere.
    pub(super) fn is_transparent(&self) -> bool {
        self.colors.contains(&[0.0; 4])
    }

    /// The label at a place; that of the border outside of the picture.
    pub(super) fn at(&self, x: isize, y: isize) -> u16 {
        let within = |at: isize, size: usize| at.clamp(0, size as isize - 1) as usize;
        self.of[within(y, self.height) * self.width + within(x, self.width)]
    }

    /// The number of the four pixels beside a place that have another colour.
    pub(super) fn others(&self, x: isize, y: isize) -> usize {
        let beside = [[1, 0], [-1, 0], [0, 1], [0, -1]];
        let is_other = |[dx, dy]: &[isize; 2]| self.at(x + dx, y + dy) != self.at(x, y);
        beside.iter().filter(|step| is_other(step)).count()
    }

    /// The number of pixels at a border, and that of those that are unlike three or all of the pixels beside them, as antialiased
    /// and dithered ones are.
    pub(super) fn borders(&self) -> [usize; 2] {
        let [mut borders, mut lonely] = [0; 2];
        for y in 0..self.height as isize {
            for x in 0..self.width as isize {
                let others = self.others(x, y);
                borders += usize::from(others > 0);
                lonely += usize::from(others >= 3);
            }
        }
        [borders, lonely]
    }
}

/// The colour of a pixel; `None` of a translucent one.
fn color(picture: &Image, pixel: usize) -> Option<Color> {
    let [red, green, blue] = picture.planes().each_ref().map(|plane| plane[pixel]);
    match picture.alpha().map_or(1.0, |alpha| alpha[pixel]) {
        1.0 => Some([red, green, blue, 1.0]),
        0.0 => Some([0.0; 4]),
        _ => None,
    }
}
