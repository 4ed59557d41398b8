//! The renderers that a file is settled for: resvg, the judge, and Chromium, which differs most from it.
//!
//! If a drawing is tuned to resvg alone, every other renderer is off by its full difference from resvg:
//! tiny-skia rounds up after every translucent stroke, Cairo and Skia do not, and each has edges of its own. So settling
//! corrects for a mean of the two: Chromium's share is just large enough to keep it within [`Settling::browser_db`].

use rayon::prelude::*;

use super::drawing::Drawing;
use super::drawing::objective::Target;
use super::drawing::surface::Surface;
use super::file::RenderedFile;
use super::recipe::Settling;
use crate::error::Result;
use crate::image::Image;
use crate::math;
use crate::metrics;
use crate::rasters::chromium;
use crate::render::Canvas;
use crate::scene::Scene;

/// Renders of a file by the model of Chromium and by our own renderer, beside resvg's; one per surface.
#[derive(Clone)]
pub(super) struct Renderings {
    settling: Settling,
    /// Chromium's renders.
    chromium: Vec<Image>,
    /// Our own renders.
    own: Vec<Image>,
    errors: Vec<Errors>,
}

/// Mean squared errors against the picture on one matte.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Errors {
    resvg: f64,
    chromium: f64,
    own: f64,
}

impl Renderings {
    /// The renderings of `file`, which was written from `drawing`; `chromium` are Chromium's renders of it.
    pub(super) fn of(
        file: &RenderedFile,
        chromium: Vec<Image>,
        drawing: &mut Drawing,
        settling: Settling,
    ) -> Result<Self> {
        let own = drawing.soft(&file.rounded.scene);
        let errors = |(i, surface): (usize, &Surface)| {
            let to_picture = |image: &Image| metrics::mse(surface.picture(), image);
            let (chromium, own) = rayon::join(|| to_picture(&chromium[i]), || to_picture(&own[i]));
            Ok(Errors {
                resvg: file.errors[i],
                chromium: chromium?,
                own: own?,
            })
        };
        let surfaces = drawing.surfaces.par_iter().enumerate();
        let errors: Result<_> = surfaces.map(errors).collect();
        Ok(Self {
            settling,
            errors: errors?,
            chromium,
            own,
        })
    }

    /// The largest value over all mattes.
    fn largest(&self, of: impl Fn(&Errors) -> f64) -> f64 {
        self.errors.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Chromium's renders.
    pub(super) fn chromium(&self) -> &[Image] {
        &self.chromium
    }

    /// By how many dB renderers are less faithful than our own render.
    pub(super) fn added_db(&self) -> f64 {
        10.0 * math::log10(self.worst_mse() / self.largest(|errors| errors.own).max(MIN_ERROR))
    }

    /// Chromium's share of the offset in the first round, after `file`, which these render.
    pub(super) fn first_share(&self, file: &RenderedFile) -> Result<f64> {
        let pairs = file.drawn.iter().zip(&self.chromium);
        let mut shares = self
            .errors
            .iter()
            .zip(pairs)
            .map(|(errors, (resvg, chromium))| {
                let between = metrics::mse(resvg, chromium)?;
                Ok(errors.fair_share(between, self.settling.browser_db))
            });
        shares.try_fold(0.0, |largest, share| Ok(f64::max(largest, share?)))
    }

    /// Chromium's share in the next round, after one with `share`.
    pub(super) fn next_share(&self, share: f64) -> f64 {
        let shortfall_db = self.largest(Errors::shortfall_db);
        let Settling {
            browser_db,
            share_per_db,
            ..
        } = self.settling;
        (share + share_per_db * (shortfall_db - browser_db)).clamp(0.0, 1.0)
    }

    /// The error by which files are compared: that in resvg, or in Chromium divided by what is allowed there, if
    /// larger.
    pub(super) fn worst_mse(&self) -> f64 {
        let allowed = ratio(self.settling.browser_db);
        self.largest(|errors| errors.resvg.max(errors.chromium / allowed))
    }

    /// The targets of the next round, one per surface: the picture less a part of the renderers' offset from our own
    /// render. Chromium has `share` of that offset, resvg the rest.
    pub(super) fn targets(
        &self,
        drawing: &Drawing,
        file: &RenderedFile,
        share: f64,
    ) -> Vec<Target> {
        let taken = self.settling.offset_taken;
        let shares = [1.0 - share, share].map(|share| (taken * share) as f32);
        let surfaces = drawing.surfaces.iter().enumerate();
        let corrected = surfaces.map(|(i, surface)| {
            let pictures = [&file.drawn[i], &self.chromium[i]];
            let target = corrected(surface.picture(), &self.own[i], pictures, shares);
            surface.target_of(Canvas::from_image(&target))
        });
        corrected.collect()
    }
}

/// Chromium's renders of `scene`, one per surface.
pub(super) fn by_chromium(scene: &Scene, surfaces: &[Surface]) -> Vec<Image> {
    let backdrops: Vec<Image> = surfaces
        .iter()
        .map(|s| s.backdrop_canvas(scene).to_image())
        .collect();
    chromium::draw(scene.marks(), &backdrops)
}

/// `target` less the offset of two renders from our `own`: `renders` by resvg and Chromium, and the share of each.
fn corrected(target: &Image, own: &Image, renders: [&Image; 2], shares: [f32; 2]) -> Image {
    let planes = [0, 1, 2].map(|c| {
        let [resvg, chromium] = renders.map(|image| &image.planes()[c]);
        let pixels = target.planes()[c].iter().zip(&own.planes()[c]);
        let pixels = pixels.zip(resvg.iter().zip(chromium));
        let offset =
            |own, resvg, chromium| shares[0] * (resvg - own) + shares[1] * (chromium - own);
        pixels
            .map(|((target, &own), (&resvg, &chromium))| target - offset(own, resvg, chromium))
            .collect()
    });
    Image::from_planes(target.width(), target.height(), planes)
}

impl Errors {
    /// By how many dB Chromium is less faithful than resvg.
    fn shortfall_db(&self) -> f64 {
        let [chromium, resvg] = [self.chromium, self.resvg].map(|mse| mse.max(MIN_ERROR));
        10.0 * math::log10(chromium / resvg)
    }

    /// Chromium's share `s` of the offset that leaves Chromium `aim_db` behind resvg. With a difference `d²`, which is `between`
    /// the two, and an error `e²` that both have, resvg's error is then `e² + s²·d²`, and Chromium's
    /// `e² + (1 − s)²·d²`.
    fn fair_share(&self, between: f64, aim_db: f64) -> f64 {
        let (ratio, d2) = (ratio(aim_db), between / self.own.max(MIN_ERROR));
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

    fn errors(own: f64) -> Errors {
        Errors {
            resvg: own,
            chromium: own,
            own,
        }
    }

    #[test]
    fn the_browser_has_no_share_where_the_difference_is_small_beside_the_error() {
        assert_eq!(errors(1e-3).fair_share(9e-5, AIM_DB), 0.0);
        assert_eq!(errors(0.0).fair_share(0.0, AIM_DB), 0.0);
    }

    #[test]
    fn the_share_leaves_the_browser_at_the_aim() {
        for between in [2e-4, 1e-3, 1e-2] {
            let errors = errors(1e-3);
            let share = errors.fair_share(between, AIM_DB);
            let left = |share: f64| errors.own + share * share * between;
            let shortfall_db = 10.0 * math::log10(left(1.0 - share) / left(share));
            assert!((shortfall_db - AIM_DB).abs() < 1e-9, "{between}: {share}");
        }
    }

    #[test]
    fn a_perfect_drawing_is_shared_almost_alike() {
        let share = errors(0.0).fair_share(1e-4, AIM_DB);
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
