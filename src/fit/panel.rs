//! Those that a file is settled for: resvg, the judge, and the browser, which differs most from it.
//!
//! What is drawn right for resvg alone is drawn wrong for others by all that they differ: tiny-skia rounds up
//! after every translucent stroke, Cairo and Skia do not, and each has edges of its own. So resvg is
//! left with a share of the difference, just as large as keeps the browser within [`AIM_DB`].

use super::drawing::Drawing;
use super::settle::Written;
use crate::browser;
use crate::error::Result;
use crate::image::Image;
use crate::metrics;
use crate::render::Canvas;

/// How much less faithful than resvg's the browser's picture may be, dB. At 0 photographs would lose in
/// resvg what nobody sees in a browser; a program is called faithful within 0.6.
const AIM_DB: f64 = 0.4;

/// Share of the offset that a round takes from the target. All of it is more than comes back on edges; with less
/// the browser stays behind.
const OFFSET_TAKEN: f64 = 0.7;

/// How much a round adds to the browser's share for each dB that its picture is off the aim.
const SHARE_PER_DB: f64 = 0.15;

/// A drawing on each ground, as the file says it.
pub(super) struct Views {
    /// What the browser draws.
    shown: Vec<Image>,
    /// Our own render.
    soft: Vec<Image>,
    /// On each ground.
    errors: Vec<Errors>,
}

/// Mean squared errors.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Errors {
    drawn: f64,
    shown: f64,
    soft: f64,
    /// Between resvg and the browser.
    apart: f64,
}

impl Views {
    pub(super) fn of(drawing: &mut Drawing, written: &Written) -> Result<Self> {
        let scene = &written.rounded.scene;
        let soft = drawing.soft(scene);
        let grounds = drawing.grounds();
        let pages: Vec<Image> = grounds.iter().map(|g| g.page(scene).to_image()).collect();
        let shown = browser::draw(scene.strokes(), &pages);
        let drawn = &written.drawn;
        let mut errors = Vec::new();
        for (i, ground) in grounds.iter().enumerate() {
            let picture = ground.picture();
            errors.push(Errors {
                drawn: metrics::mse(picture, &drawn[i])?,
                shown: metrics::mse(picture, &shown[i])?,
                soft: metrics::mse(picture, &soft[i])?,
                apart: metrics::mse(&drawn[i], &shown[i])?,
            });
        }
        Ok(Self {
            shown,
            soft,
            errors,
        })
    }

    /// The largest on any ground.
    fn largest(&self, of: impl Fn(&Errors) -> f64) -> f64 {
        self.errors.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The share of the browser in the first round.
    pub(super) fn first_share(&self) -> f64 {
        self.largest(Errors::fair_share)
    }

    /// Its share in the next round, after one in which it had `share`.
    pub(super) fn next_share(&self, share: f64) -> f64 {
        let shortfall_db = self.largest(Errors::shortfall_db);
        (share + SHARE_PER_DB * (shortfall_db - AIM_DB)).clamp(0.0, 1.0)
    }

    /// How bad the file is: its error in resvg, or in the browser less what it may be more there.
    pub(super) fn badness(&self) -> f64 {
        self.largest(|errors| errors.drawn.max(errors.shown / ratio(AIM_DB)))
    }

    /// What is to be drawn on each ground of `drawing`, less a part of what the pictures differ by from our own
    /// render, of which `share` is the browser's.
    pub(super) fn targets(&self, drawing: &Drawing, written: &Written, share: f64) -> Vec<Canvas> {
        let shares = [1.0 - share, share].map(|share| (OFFSET_TAKEN * share) as f32);
        let grounds = drawing.grounds().iter().enumerate();
        let corrected = grounds.map(|(i, ground)| {
            let pictures = [&written.drawn[i], &self.shown[i]];
            corrected(ground.picture(), &self.soft[i], pictures, shares)
        });
        corrected.map(|image| Canvas::from_image(&image)).collect()
    }
}

fn corrected(target: &Image, soft: &Image, seen: [&Image; 2], shares: [f32; 2]) -> Image {
    let planes = [0, 1, 2].map(|c| {
        let [drawn, shown] = seen.map(|image| &image.planes()[c]);
        let pixels = target.planes()[c].iter().zip(&soft.planes()[c]);
        let pixels = pixels.zip(drawn.iter().zip(shown));
        let offset = |soft, drawn, shown| shares[0] * (drawn - soft) + shares[1] * (shown - soft);
        pixels
            .map(|((target, &soft), (&drawn, &shown))| target - offset(soft, drawn, shown))
            .collect()
    });
    Image::from_planes(target.width(), target.height(), planes)
}

impl Errors {
    /// By how many dB the browser is less faithful than resvg.
    fn shortfall_db(&self) -> f64 {
        let [shown, drawn] = [self.shown, self.drawn].map(|mse| mse.max(MIN_ERROR));
        10.0 * (shown / drawn).log10()
    }

    /// The share `s` that the browser has to have of the offset, so that it is at the aim: with a difference
    /// `d²` between the two and an error `e²` that both have, resvg's is `e² + s²·d²` then, and the browser's
    /// `e² + (1 − s)²·d²`.
    fn fair_share(&self) -> f64 {
        let (ratio, d2) = (ratio(AIM_DB), self.apart / self.soft.max(MIN_ERROR));
        // (ratio − 1)·d²·s² + 2·d²·s = d² − (ratio − 1)
        let (a, b, c) = ((ratio - 1.0) * d2, d2, d2 - (ratio - 1.0));
        if c <= 0.0 {
            0.0
        } else {
            c / (b + (b * b + a * c).sqrt())
        }
    }
}

/// Less than any picture of 8 bits can tell.
const MIN_ERROR: f64 = 1e-9;

fn ratio(db: f64) -> f64 {
    10f64.powf(db / 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(soft: f64, apart: f64) -> Errors {
        Errors {
            drawn: soft,
            shown: soft,
            soft,
            apart,
        }
    }

    #[test]
    fn the_browser_has_no_share_where_the_difference_is_small_beside_the_error() {
        assert_eq!(errors(1e-3, 9e-5).fair_share(), 0.0);
        assert_eq!(errors(0.0, 0.0).fair_share(), 0.0);
    }

    #[test]
    fn the_share_leaves_the_browser_at_the_aim() {
        for apart in [2e-4, 1e-3, 1e-2] {
            let errors = errors(1e-3, apart);
            let share = errors.fair_share();
            let left = |share: f64| errors.soft + share * share * apart;
            let shortfall_db = 10.0 * (left(1.0 - share) / left(share)).log10();
            assert!((shortfall_db - AIM_DB).abs() < 1e-9, "{apart}: {share}");
        }
    }

    #[test]
    fn a_perfect_drawing_is_shared_almost_alike() {
        let share = errors(0.0, 1e-4).fair_share();
        assert!((0.48..0.5).contains(&share), "{share}");
    }

    #[test]
    fn targets_are_corrected_by_the_shares() {
        let gray = |level| Image::filled(2, 1, [level; 3]).unwrap();
        let image = corrected(
            &gray(0.5),
            &gray(0.25),
            [&gray(0.5), &gray(0.0)],
            [0.5, 0.25],
        );
        assert_eq!(image.planes()[1], [0.4375; 2]);
    }
}
