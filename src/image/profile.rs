//! Colour profiles: pictures in other colours than sRGB are converted. The one door of `moxcms`.

use moxcms::{
    Chromaticity, CicpColorPrimaries, CicpProfile, ColorPrimaries, ColorProfile, DataColorSpace,
    Layout, MatrixCoefficients, ToneReprCurve, TransferCharacteristics, TransformOptions,
};

use super::decoded::Coding;
use super::{Image, Remark, tone};
use crate::error;

/// Steps of each channel in the colours that decide whether a profile counts as sRGB's.
const PROBES: usize = 6;

/// A profile that changes none of these colours by more than this is taken for sRGB: an 8-bit level and a half. Files of
/// sRGB have many profiles, which differ in the last digits of their tables.
const SAME: f32 = 1.5 / 255.0;

/// The picture in sRGB, and a remark on the conversion. Colours that are sRGB's stay as they are.
pub(super) fn to_srgb(image: Image, coding: &Coding) -> (Image, Option<Remark>) {
    let outcome = match coding {
        Coding::Icc(icc) => converted(&image, icc),
        Coding::Cicp(primaries, transfer) => stated(&image, *primaries, *transfer),
        Coding::Gamma {
            gamma,
            chromaticities,
        } => {
            let profile = of_gamma(*gamma, *chromaticities);
            through(&image, &profile, Layout::Rgb)
        }
    };
    match outcome {
        Ok(Some(planes)) => (Image { planes, ..image }, Some(Remark::Converted)),
        Ok(None) => (image, None),
        Err(why) => (image, Some(Remark::ProfileIgnored(why))),
    }
}

/// Planes in sRGB; `None` if colours stay as they are; or why they cannot be converted.
type Outcome = Result<Option<[Vec<f32>; 3]>, &'static str>;

const UNKNOWN: &str = "of an unknown kind";

/// A picture by its ICC profile.
fn converted(image: &Image, icc: &[u8]) -> Outcome {
    let profile = ColorProfile::new_from_slice(icc).map_err(|_| "damaged")?;
    // The samples are RGB by now. A profile of grey then applies to the first of three equal planes.
    let layout = match profile.color_space {
        DataColorSpace::Rgb => Layout::Rgb,
        DataColorSpace::Gray => Layout::Gray,
        // The decoder has made RGB of it.
        _ => return Err("not of RGB or grey"),
    };
    through(image, &profile, layout)
}

/// A picture by the code points of its primaries and transfer function.
fn stated(image: &Image, primaries: u8, transfer: u8) -> Outcome {
    let primaries = CicpColorPrimaries::try_from(primaries).map_err(|_| UNKNOWN)?;
    let curve = TransferCharacteristics::try_from(transfer).map_err(|_| UNKNOWN)?;
    let profile = ColorProfile::new_from_cicp(CicpProfile {
        color_primaries: primaries,
        transfer_characteristics: curve,
        matrix_coefficients: MatrixCoefficients::Identity,
        full_range: true,
    });
    match tone::Transfer::of(transfer) {
        Some(transfer) => {
            // PQ and HLG go beyond white, which an ICC transform would clip: only the primaries are taken from the profile.
            let matrix = profile.transform_matrix(&ColorProfile::new_srgb()).v;
            Ok(Some(tone::to_srgb(image.planes(), transfer, matrix)))
        }
        None => through(image, &profile, Layout::Rgb),
    }
}

/// The profile of colours that are powers of light: sRGB's where nothing else is said.
fn of_gamma(gamma: Option<f64>, chromaticities: Option<[f64; 8]>) -> ColorProfile {
    let mut profile = ColorProfile::new_srgb();
    if let Some(
        [
            white_x,
            white_y,
            red_x,
            red_y,
            green_x,
            green_y,
            blue_x,
            blue_y,
        ],
    ) = chromaticities
    {
        let place = |x: f64, y: f64| Chromaticity::new(x as f32, y as f32);
        let primaries = ColorPrimaries {
            red: place(red_x, red_y),
            green: place(green_x, green_y),
            blue: place(blue_x, blue_y),
        };
        profile.update_rgb_colorimetry(place(white_x, white_y).to_xyyb(), primaries);
    }
    if let Some(gamma) = gamma {
        let curve = ToneReprCurve::Parametric(vec![(1.0 / gamma) as f32]);
        // A profile with code points is read by these, and its curves are not looked at.
        profile.cicp = None;
        profile.red_trc = Some(curve.clone());
        profile.green_trc = Some(curve.clone());
        profile.blue_trc = Some(curve);
    }
    profile
}

/// A picture through a profile of red, green and blue, or grey.
fn through(image: &Image, profile: &ColorProfile, layout: Layout) -> Outcome {
    let conversion = Conversion::new(profile, layout).ok_or(UNKNOWN)?;
    if conversion.is_none() {
        return Ok(None);
    }
    let converted = conversion.of(image.planes(), image.width());
    converted.map(Some).ok_or(UNKNOWN)
}

/// Red, green and blue of amounts of cyan, magenta, yellow and black in a picture of this width, if the profile is one of
/// these inks.
fn converted_inks(
    inks: &[Vec<f32>; 4],
    width: usize,
    icc: &[u8],
) -> Result<[Vec<f32>; 3], &'static str> {
    let profile = ColorProfile::new_from_slice(icc).map_err(|_| "damaged")?;
    if profile.color_space != DataColorSpace::Cmyk {
        return Err("not of CMYK");
    }
    // Four channels of any meaning are called so.
    let conversion = Conversion::new(&profile, Layout::Rgba).ok_or(UNKNOWN)?;
    conversion.of(inks, width).ok_or(UNKNOWN)
}

/// The colours of a picture of inks, which stand where red, green, blue and alpha are: by its profile, or as if each ink
/// took all the light of one colour.
pub(super) fn of_inks(
    image: Image,
    coding: Option<&Coding>,
) -> error::Result<(Image, Option<Remark>)> {
    let (width, height) = (image.width(), image.height());
    let black = match image.alpha() {
        Some(black) => black.to_vec(),
        // Alpha of 1 everywhere is left out.
        None => vec![1.0; width * height],
    };
    let [cyan, magenta, yellow] = image.into_planes();
    let inks = [cyan, magenta, yellow, black];
    let converted = match coding {
        Some(Coding::Icc(icc)) => converted_inks(&inks, width, icc).map(Some),
        _ => Ok(None),
    };
    let (planes, remark) = match converted {
        Ok(Some(planes)) => (planes, Some(Remark::Converted)),
        Ok(None) => (taken_away(&inks), Some(Remark::Inks)),
        Err(why) => (taken_away(&inks), Some(Remark::ProfileIgnored(why))),
    };
    Ok((Image::new(width, height, planes)?, remark))
}

/// Light that ideal inks leave.
fn taken_away([cyan, magenta, yellow, black]: &[Vec<f32>; 4]) -> [Vec<f32>; 3] {
    // Cyan takes away red, magenta green, yellow blue, and black a share of all three.
    [cyan, magenta, yellow].map(|ink| {
        let pairs = ink.iter().zip(black);
        pairs
            .map(|(ink, black)| (1.0 - ink) * (1.0 - black))
            .collect()
    })
}

/// From the colours of a profile to sRGB.
struct Conversion {
    /// Samples of a pixel, 1, 3 or 4.
    channels: usize,
    /// In `f64`: with `f32`, the last digits depend on the processor.
    transform: std::sync::Arc<moxcms::TransformF64Executor>,
}

impl Conversion {
    fn new(profile: &ColorProfile, layout: Layout) -> Option<Self> {
        let (srgb, options) = (ColorProfile::new_srgb(), TransformOptions::default());
        let transform = profile.create_transform_f64(layout, &srgb, Layout::Rgb, options);
        let channels = match layout {
            Layout::Gray => 1,
            Layout::Rgb => 3,
            _ => 4,
        };
        transform.ok().map(|transform| Self {
            channels,
            transform,
        })
    }

    /// True if colours stay as they are.
    fn is_none(&self) -> bool {
        // A lattice of colours through the profile. If none of them changes, the samples stay, without rounding.
        let level = |i: usize| i as f32 / (PROBES - 1) as f32;
        let pixels = 0..if self.channels == 1 {
            PROBES
        } else {
            PROBES.pow(3)
        };
        let sample = |i: usize, c: usize| match self.channels {
            1 => level(i),
            _ => level(i / PROBES.pow(c as u32) % PROBES),
        };
        let planes = [0, 1, 2].map(|c| pixels.clone().map(|i| sample(i, c)).collect::<Vec<_>>());
        let same = |converted: [Vec<f32>; 3]| {
            let mut pairs = planes.iter().flatten().zip(converted.iter().flatten());
            pairs.all(|(a, b)| (a - b).abs() <= SAME)
        };
        self.of(&planes, pixels.len()).is_some_and(same)
    }

    /// The planes of a picture of this width in sRGB; `None` if the conversion fails.
    fn of(&self, planes: &[Vec<f32>], width: usize) -> Option<[Vec<f32>; 3]> {
        let mut converted = [0, 1, 2].map(|c| Vec::with_capacity(planes[c].len()));
        let (mut row, mut out) = (vec![0.0; self.channels * width], vec![0.0; 3 * width]);
        // Row by row, since the transform takes interleaved samples: memory for one row, and not for another picture.
        for start in (0..planes[0].len()).step_by(width) {
            for (x, pixel) in row.chunks_exact_mut(self.channels).enumerate() {
                for (sample, plane) in pixel.iter_mut().zip(planes) {
                    *sample = f64::from(plane[start + x]);
                }
            }
            self.transform.transform(&row, &mut out).ok()?;
            for (c, plane) in converted.iter_mut().enumerate() {
                let samples = out.iter().skip(c).step_by(3).map(|&v| v as f32);
                plane.extend(samples.map(|v| if v.is_nan() { 0.0 } else { v.clamp(0.0, 1.0) }));
            }
        }
        Some(converted)
    }
}
