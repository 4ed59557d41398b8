//! The renderers that a file is settled for: resvg, the judge, and the browser, which differs most from it.
//!
//! If a drawing is tuned to resvg alone, every other renderer is off by its full difference from resvg:
//! tiny-skia rounds up after every translucent stroke, Cairo and Skia do not, and each has edges of its own. So settling
//! corrects for a mean of the two. The browser's share is just large enough to keep it within [`Settling::browser_db`].

use rayon::prelude::*;

use super::drawing::Drawing;
use super::file::RenderedFile;
use super::recipe::Settling;
use super::session::Session;
use super::surface::Surface;
use crate::error::Result;
use crate::image::Image;
use crate::math;
use crate::metrics;
use crate::rasters::chromium;
use crate::render::Canvas;
use crate::scene::Scene;

/// Renders of a file by the model of a browser and by our own renderer, beside resvg's; one per surface.
#[derive(Clone)]
pub(super) struct Renderings {
    settling: Settling,
    /// The browser's renders.
    shown: Vec<Image>,
    /// Our own renders.
    soft: Vec<Image>,
    errors: Vec<Errors>,
}

/// Mean squared errors against the picture on one matte.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Errors {
    drawn: f64,
    shown: f64,
    soft: f64,
    /// Between resvg and the browser.
    apart: f64,
}

impl Renderings {
    /// Writes the drawing and renders the file.
    pub(super) fn of(session: &mut Session<'_>) -> Result<(RenderedFile, Self)> {
        let (file, shown) = session.render_file_beside(shown)?;
        let drawing = &mut session.drawing;
        let soft = drawing.soft(&file.rounded.scene);
        let drawn = &file.drawn;
        let errors = |(i, surface): (usize, &Surface)| {
            let picture = surface.picture();
            let to_picture = |image: &Image| metrics::mse(picture, image);
            let (files, others) = rayon::join(
                || (to_picture(&drawn[i]), to_picture(&shown[i])),
                || (to_picture(&soft[i]), metrics::mse(&drawn[i], &shown[i])),
            );
            Ok(Errors {
                drawn: files.0?,
                shown: files.1?,
                soft: others.0?,
                apart: others.1?,
            })
        };
        let surfaces = drawing.surfaces.par_iter().enumerate();
        let errors: Result<_> = surfaces.map(errors).collect();
        let seen = Self {
            settling: session.recipe.settling,
            errors: errors?,
            shown,
            soft,
        };
        Ok((file, seen))
    }

    /// The largest value over all mattes.
    fn largest(&self, of: impl Fn(&Errors) -> f64) -> f64 {
        self.errors.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The browser's renders.
    pub(super) fn shown(&self) -> &[Image] {
        &self.shown
    }

    /// By how many dB renderers are less faithful than our own render.
    pub(super) fn added_db(&self) -> f64 {
        10.0 * math::log10(self.badness() / self.largest(|errors| errors.soft).max(MIN_ERROR))
    }

    /// The browser's share of the offset in the first round.
    pub(super) fn first_share(&self) -> f64 {
        self.largest(|errors| errors.fair_share(self.settling.browser_db))
    }

    /// The browser's share in the next round, after one with `share`.
    pub(super) fn next_share(&self, share: f64) -> f64 {
        let shortfall_db = self.largest(Errors::shortfall_db);
        let Settling {
            browser_db,
            share_per_db,
            ..
        } = self.settling;
        (share + share_per_db * (shortfall_db - browser_db)).clamp(0.0, 1.0)
    }

    /// The error by which files are compared: that in resvg, or in the browser divided by what is allowed there, if
    /// larger.
    pub(super) fn badness(&self) -> f64 {
        let allowed = ratio(self.settling.browser_db);
        self.largest(|errors| errors.drawn.max(errors.shown / allowed))
    }

    /// The targets of the next round, one per surface: the picture less a part of the renderers' offset from our own
    /// render. The browser has `share` of that offset, resvg the rest.
    pub(super) fn targets(
        &self,
        drawing: &Drawing,
        file: &RenderedFile,
        share: f64,
    ) -> Vec<Canvas> {
        let taken = self.settling.offset_taken;
        let shares = [1.0 - share, share].map(|share| (taken * share) as f32);
        let surfaces = drawing.surfaces.iter().enumerate();
        let corrected = surfaces.map(|(i, surface)| {
            let pictures = [&file.drawn[i], &self.shown[i]];
            let target = corrected(surface.picture(), &self.soft[i], pictures, shares);
            surface.veiled(Canvas::from_image(&target))
        });
        corrected.collect()
    }
}

/// The browser's renders of `scene`, one per surface.
fn shown(scene: &Scene, surfaces: &[Surface]) -> Vec<Image> {
    let backdrops: Vec<Image> = surfaces.iter().map(|s| s.empty(scene).to_image()).collect();
    chromium::draw(scene.strokes(), &backdrops)
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
        10.0 * math::log10(shown / drawn)
    }

    /// The browser's share `s` of the offset that leaves the browser `aim_db` behind resvg. With a difference `d²`
    /// between the two and an error `e²` that both have, resvg's error is then `e² + s²·d²`, and the browser's
    /// `e² + (1 − s)²·d²`.
    fn fair_share(&self, aim_db: f64) -> f64 {
        let (ratio, d2) = (ratio(aim_db), self.apart / self.soft.max(MIN_ERROR));
        // (ratio − 1)·d²·s² + 2·d²·s = d² − (ratio − 1)
        let (a, b, c) = ((ratio - 1.0) * d2, d2, d2 - (ratio - 1.0));
        if c <= 0.0 {
            0.0
        } else {
            c / (b + (b * b + a * c).sqrt())
        }
    }
}

/// Less than any difference between two 8-bit pictures.
const MIN_ERROR: f64 = 1e-9;

fn ratio(db: f64) -> f64 {
    math::powf(10.0, db / 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const AIM_DB: f64 = 0.4;

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
        assert_eq!(errors(1e-3, 9e-5).fair_share(AIM_DB), 0.0);
        assert_eq!(errors(0.0, 0.0).fair_share(AIM_DB), 0.0);
    }

    #[test]
    fn the_share_leaves_the_browser_at_the_aim() {
        for apart in [2e-4, 1e-3, 1e-2] {
            let errors = errors(1e-3, apart);
            let share = errors.fair_share(AIM_DB);
            let left = |share: f64| errors.soft + share * share * apart;
            let shortfall_db = 10.0 * math::log10(left(1.0 - share) / left(share));
            assert!((shortfall_db - AIM_DB).abs() < 1e-9, "{apart}: {share}");
        }
    }

    #[test]
    fn a_perfect_drawing_is_shared_almost_alike() {
        let share = errors(0.0, 1e-4).fair_share(AIM_DB);
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
