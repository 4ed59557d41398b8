//! Colour profiles: pictures in other colours than sRGB are converted. The one door of `moxcms`.

use moxcms::{ColorProfile, DataColorSpace, Layout, TransformOptions};

use super::{Image, Remark};

/// Steps of each channel in the colours that tell whether a profile is that of sRGB.
const PROBES: usize = 6;

/// A profile that changes none of these colours by more than this is taken for sRGB: an 8-bit level and a half. Files of
/// sRGB have many profiles, which differ in the last digits of their tables.
const SAME: f32 = 1.5 / 255.0;

/// The picture in sRGB, and what there is to say of that. A profile that is sRGB's changes nothing.
pub(super) fn to_srgb(image: Image, icc: &[u8]) -> (Image, Option<Remark>) {
    let Ok(profile) = ColorProfile::new_from_slice(icc) else {
        return (image, Some(Remark::ProfileIgnored("damaged")));
    };
    let layout = match profile.color_space {
        DataColorSpace::Rgb => Layout::Rgb,
        DataColorSpace::Gray => Layout::Gray,
        // The decoder has made RGB of it.
        _ => return (image, Some(Remark::ProfileIgnored("not of RGB or grey"))),
    };
    let Some(conversion) = Conversion::new(&profile, layout) else {
        return (image, Some(Remark::ProfileIgnored("of an unknown kind")));
    };
    if conversion.is_none() {
        return (image, None);
    }
    match conversion.of(image.planes(), image.width()) {
        Some(planes) => (Image { planes, ..image }, Some(Remark::Converted)),
        None => (image, Some(Remark::ProfileIgnored("of an unknown kind"))),
    }
}

/// From the colours of a profile to sRGB.
struct Conversion {
    /// Samples of a pixel, 1 or 3.
    channels: usize,
    /// In `f64`: with `f32`, the last digits depend on the processor.
    transform: std::sync::Arc<moxcms::TransformF64Executor>,
}

impl Conversion {
    fn new(profile: &ColorProfile, layout: Layout) -> Option<Self> {
        let (srgb, options) = (ColorProfile::new_srgb(), TransformOptions::default());
        let transform = profile.create_transform_f64(layout, &srgb, Layout::Rgb, options);
        let channels = if layout == Layout::Gray { 1 } else { 3 };
        transform.ok().map(|transform| Self {
            channels,
            transform,
        })
    }

    /// Whether colours stay as they are.
    fn is_none(&self) -> bool {
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
    fn of(&self, planes: &[Vec<f32>; 3], width: usize) -> Option<[Vec<f32>; 3]> {
        let mut converted = [0, 1, 2].map(|c| Vec::with_capacity(planes[c].len()));
        let (mut row, mut out) = (vec![0.0; self.channels * width], vec![0.0; 3 * width]);
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
