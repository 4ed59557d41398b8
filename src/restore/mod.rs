//! Damage of pictures: what a picture has been through, and the picture that is meant.
//!
//! ```text
//! labels     the colours of a picture that has few
//! stairs     smooth borders, of which stairs are left for want of antialiasing
//! aliased    the few colours of a picture without antialiasing that was compressed
//! grid       where the blocks of a JPEG begin
//! noise      how far pixels are from flat places, far from edges and beside them
//! shrink     the picture without what noise explains
//! dither     colours that are mixed pixel by pixel
//! chroma     colours that were kept at half the resolution, along the edges of luma
//! clip       tones that noise was cut off from, at black and white
//! light      uneven light on paper, and its spots
//! ```

mod aliased;
mod chroma;
mod clip;
mod cosine;
mod dither;
mod grid;
mod labels;
mod light;
mod noise;
mod planes;
mod shrink;
mod stairs;

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::image::Image;
use crate::words::words;
use labels::Labels;
use noise::Noise;
use planes::Planes;

/// Flat art: this many tones of four levels have most of its pixels. A guess.
const TONES: usize = 8;
/// The least share of the pixels of flat art that have them.
const LEAST_SHARE: f32 = 0.5;
/// Coefficients below so many times the noise are left out: far from edges. Of 12 drawings, at qualities 90, 75, 30 of JPEG, 4.1,
/// 5.2, 5.5 times the noise beside edges come nearest to the clean picture.
const FAR: f32 = 3.6;
/// As [`FAR`], beside edges.
const NEAR: f32 = 5.0;

/// What becomes of the paper of a page.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Paper {
    /// It keeps its colour; uneven light and spots go
    #[default]
    Own,
    /// It becomes white, and as much lighter what is on it
    White,
}

words!(Paper, "a paper": Own = "own", White = "white");

/// The picture that a damaged one is meant to be, and what has happened to it.
#[derive(Debug, Clone)]
pub struct Restored {
    /// The picture without the damage.
    pub picture: Image,
    /// The damage.
    pub damage: Damage,
}

/// The damage of a picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Damage {
    /// True if its borders have stairs for want of antialiasing.
    pub stairs: bool,
    /// Share of its pixels in which colours are mixed from those of a palette.
    pub dithering: f32,
    /// RMS of noise far from edges, levels of luma of 8 bits.
    pub noise: f32,
    /// RMS of noise beside edges, as compression leaves it, levels of luma of 8 bits.
    pub ringing: f32,
    /// True if colours were kept at half the resolution.
    pub halved_chroma: bool,
    /// True if it is a page in uneven light, of spotted paper, or of paper that was made white.
    pub uneven_light: bool,
}

impl Damage {
    /// The distance of the picture that is meant from the truth, as far as can be told: noise goes, but for a part.
    pub fn doubt(&self) -> Doubt {
        let of_means = if self.dithering > 0.0 {
            dither::DOUBT
        } else {
            0.0
        };
        let of_stairs = if self.stairs { stairs::DOUBT } else { 0.0 };
        Doubt {
            far: (self.noise / 2.0).max(of_means),
            near: self.ringing.max(of_stairs),
        }
    }
}

/// How far a picture may be from what it means, RMS in levels of luma of 8 bits.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Doubt {
    /// Far from edges.
    pub far: f32,
    /// Beside edges.
    pub near: f32,
}

impl Doubt {
    /// The larger of the two.
    pub fn most(self) -> f32 {
        self.far.max(self.near)
    }
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = 100.0 * self.dithering;
        let parts = [
            (self.stairs, "stairs for want of antialiasing".to_owned()),
            (share > 0.0, format!("dithering on {share:.0} % of it")),
            (
                self.noise > 0.0,
                format!("noise of {:.1} levels", self.noise),
            ),
            (
                self.ringing > 0.0,
                format!(
                    "traces of compression of {:.1} levels beside edges",
                    self.ringing
                ),
            ),
            (
                self.halved_chroma,
                "colours at half the resolution".to_owned(),
            ),
            (self.uneven_light, "uneven paper".to_owned()),
        ];
        let parts: Vec<String> = parts
            .into_iter()
            .filter(|(is, _)| *is)
            .map(|(_, part)| part)
            .collect();
        f.write_str(&parts.join(", "))
    }
}

/// The picture that `picture` is meant to be; `None` if it is not damaged, as far as can be told, and its paper stays. Alpha stays as it
/// is, but for the stairs of one that has no shades.
///
/// # Errors
/// None in practice: a restored picture has the size of the given one and finite values.
pub fn restored(picture: &Image, paper: Paper) -> Result<Option<Restored>> {
    let restored = undamaged(picture)?;
    match paper {
        Paper::Own => Ok(restored),
        Paper::White => whitened(picture, restored),
    }
}

/// What was restored of a picture with white paper, if it is a page.
pub(crate) fn whitened(picture: &Image, restored: Option<Restored>) -> Result<Option<Restored>> {
    let mut planes = Planes::of(restored.as_ref().map_or(picture, |r| &r.picture));
    if planes.alpha.is_some() || !light::whitened(&mut planes) {
        return Ok(restored);
    }
    let damage = Damage {
        uneven_light: true,
        ..restored.map_or(Damage::default(), |r| r.damage)
    };
    Ok(Some(Restored {
        picture: planes.image()?,
        damage,
    }))
}

/// The picture without its damage, if it has some.
fn undamaged(picture: &Image) -> Result<Option<Restored>> {
    let labels = Labels::of(picture, Labels::MOST);
    if let Some(restored) = labels.map_or(Ok(None), |labels| of_few_colors(picture, &labels))? {
        return Ok(Some(restored));
    }
    let planes = Planes::of(picture);
    let halved_chroma = chroma::is_halved(&planes);
    let noise = noise::measure(&planes);
    noise.map_or(Ok(None), |noise| {
        without_noise(picture, planes, &noise, halved_chroma)
    })
}

/// The picture that one of few colours is meant to be.
fn of_few_colors(picture: &Image, labels: &Labels) -> Result<Option<Restored>> {
    if labels.width.max(labels.height) < Labels::LEAST_SIDE {
        return Ok(None);
    }
    let mixed = if labels.is_transparent() {
        None
    } else {
        dither::mixed(picture, labels)?
    };
    if let Some((picture, dithering)) = mixed {
        let damage = Damage {
            dithering,
            ..Damage::default()
        };
        return Ok(Some(Restored { picture, damage }));
    }
    let smoothed = stairs::smoothed(labels)?;
    let damage = Damage {
        stairs: true,
        ..Damage::default()
    };
    Ok(smoothed.map(|picture| Restored { picture, damage }))
}

/// A picture without noise and, on paper, without shadows and spots; `None` of a photograph, whose texture is as fine as noise.
fn without_noise(
    picture: &Image,
    mut planes: Planes,
    noise: &Noise,
    halved_chroma: bool,
) -> Result<Option<Restored>> {
    shrunk(&mut planes, noise);
    if halved_chroma {
        let chromas = chroma::along_luma(&planes);
        planes.planes[1..]
            .iter_mut()
            .zip(chromas)
            .for_each(|(plane, chroma)| *plane = chroma);
    }
    // Tones are mended last: the mean of what is left of noise is known only without it.
    let channels = clip::unclipped(picture, planes.image()?);
    let mut picture = Image::new(planes.width, planes.height, channels)?;
    if let Some(alpha) = planes.alpha {
        picture = picture.with_alpha(alpha)?;
    }
    // Only scans and photographs of pages have both grain and shadows or spots; a gradient is drawn. No page is transparent.
    let mut planes = Planes::of(&picture);
    let may_be_page = noise.most() > 0.0 && planes.alpha.is_none();
    let uneven_light = may_be_page && light::evened(&mut planes);
    if !is_flat_art(&planes) {
        return Ok(None);
    }
    if uneven_light {
        picture = planes.image()?;
    }
    // What was compressed may have had stairs before.
    let labels = aliased::labels(&planes, noise.near);
    let smoothed = labels.map_or(Ok(None), |labels| stairs::smoothed(&labels))?;
    let stairs = smoothed.is_some();
    let picture = smoothed.unwrap_or(picture);
    let damage = Damage {
        stairs,
        noise: noise.most(),
        ringing: noise.near,
        halved_chroma,
        uneven_light,
        ..Damage::default()
    };
    Ok(Some(Restored { picture, damage }))
}

/// True if most pixels have one of a few tones.
fn is_flat_art(planes: &Planes) -> bool {
    let luma = planes.planes[0].iter().enumerate();
    let opaque = luma.filter(|(pixel, _)| planes.is_opaque(*pixel));
    let mut tones = planes::tones(opaque.map(|(_, value)| *value));
    tones.sort_unstable_by(|a, b| b.cmp(a));
    let all: usize = tones.iter().sum();
    let most: usize = tones.iter().take(TONES).sum();
    most as f32 >= LEAST_SHARE * all as f32
}

/// Leaves out what noise explains.
fn shrunk(planes: &mut Planes, noise: &Noise) {
    let least = |luma: f32, range: f32| {
        let far = FAR * noise.at(luma);
        // A block without an edge may overlap one of JPEG that has one.
        if range >= noise::EDGE_RANGE || far == 0.0 {
            far.max(NEAR * noise.near)
        } else {
            far
        }
    };
    planes.planes = shrink::shrink(&planes.planes, planes.width, &shrink::WHITE, &least);
}
