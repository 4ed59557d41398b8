//! Light beyond white: PQ and HLG, brought to the range of a page of sRGB.
//!
//! White of graphics is at 203 cd/m² in both, as ITU-R BT.2408 has it. Light up to that stays as it is, so a
//! screenshot keeps its colours; brighter light is bent towards white, down to half its light, so that the brightest
//! pixel is white. All three channels of a pixel shrink by one factor, which keeps the hue.

use crate::math;

/// Light of white on a page, cd/m².
const WHITE: f64 = 203.0;

/// The greatest light of PQ and of the display that HLG is shown on, cd/m².
const PQ_PEAK: f64 = 10_000.0;
const HLG_PEAK: f64 = 1_000.0;

/// Light of white from which on a picture with brighter light is bent.
const KNEE: f64 = 0.5;

/// A transfer function of more than white.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Transfer {
    /// SMPTE ST 2084.
    Pq,
    /// ARIB STD-B67.
    Hlg,
}

impl Transfer {
    /// The transfer function of a code point of ITU-T H.273.
    pub(super) fn of(code: u8) -> Option<Self> {
        match code {
            16 => Some(Self::Pq),
            18 => Some(Self::Hlg),
            _ => None,
        }
    }

    /// Light in units of white of a pixel's samples.
    fn light(self, samples: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Pq => samples.map(|v| pq(v) * PQ_PEAK / WHITE),
            Self::Hlg => {
                let [red, green, blue] = samples.map(hlg);
                // The display's exponent of 1.2 applies to the light of the whole pixel.
                let luma = 0.2627 * red + 0.6780 * green + 0.0593 * blue;
                let scale = math::powf(luma.max(1e-9), 0.2) * HLG_PEAK / WHITE;
                [red, green, blue].map(|v| v * scale)
            }
        }
    }
}

/// The EOTF of SMPTE ST 2084, 0..1 to 0..1.
fn pq(sample: f64) -> f64 {
    // ((V^(1/m₂) − c₁)₊ / (c₂ − c₃·V^(1/m₂)))^(1/m₁), with 1/m₂ = 32/2523 and 1/m₁ = 8192/1305.
    let power = math::powf(sample.max(0.0), 32.0 / 2523.0);
    let ratio = (power - 107.0 / 128.0).max(0.0) / (2413.0 / 128.0 - 2392.0 / 128.0 * power);
    math::powf(ratio, 8192.0 / 1305.0)
}

/// The inverse OETF of ITU-R BT.2100, 0..1 to 0..1.
fn hlg(sample: f64) -> f64 {
    const A: f64 = 0.178_832_77;
    if sample <= 0.5 {
        sample * sample / 3.0
    } else {
        (math::exp((sample - 0.559_910_73) / A) + 0.284_668_92) / 12.0
    }
}

/// The planes of a picture in sRGB. `matrix` leads from light of its primaries to light of sRGB's primaries.
pub(super) fn to_srgb(
    planes: &[Vec<f32>; 3],
    transfer: Transfer,
    matrix: [[f64; 3]; 3],
) -> [Vec<f32>; 3] {
    let pixel = |i: usize| {
        let light = transfer.light([0, 1, 2].map(|c: usize| f64::from(planes[c][i])));
        matrix.map(|row| {
            let sum: f64 = row.iter().zip(light).map(|(a, b)| a * b).sum();
            // A colour outside sRGB has a negative channel, which no page can show.
            sum.max(0.0)
        })
    };
    let pixels = 0..planes[0].len();
    let brightest = |light: [f64; 3]| light.into_iter().fold(0.0, f64::max);
    // Two passes: the curve depends on the brightest pixel.
    let peak = pixels
        .clone()
        .map(|i| brightest(pixel(i)))
        .fold(0.0, f64::max);
    let mut out = planes
        .each_ref()
        .map(|plane| Vec::with_capacity(plane.len()));
    for i in pixels {
        let light = pixel(i);
        let most = brightest(light);
        // One factor for all three channels, from the brightest of them, keeps hue and puts it within 1.
        let scale = if most > 0.0 {
            bent(most, peak) / most
        } else {
            1.0
        };
        for (plane, v) in out.iter_mut().zip(light) {
            plane.push(super::encoded((v * scale).min(1.0) as f32));
        }
    }
    out
}

/// Light of a picture whose brightest has `peak`, brought to 0..1. From the knee on an extended Reinhard curve, with slope 1 there.
fn bent(light: f64, peak: f64) -> f64 {
    if peak <= 1.0 || light <= KNEE {
        return light;
    }
    // Above the knee, in units of the room above it: y = x(1 + x/m²)/(1 + x), so y'(0) = 1 and y(m) = 1 at the peak m.
    let (over, most) = ((light - KNEE) / (1.0 - KNEE), (peak - KNEE) / (1.0 - KNEE));
    KNEE + (1.0 - KNEE) * over * (1.0 + over / (most * most)) / (1.0 + over)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAME: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn white_of_graphics_is_white() {
        // 58 % of PQ and 75 % of HLG are white, as BT.2408 has it.
        for (transfer, white) in [(Transfer::Pq, 0.5807), (Transfer::Hlg, 0.75)] {
            let [red, ..] = to_srgb(&[vec![white], vec![white], vec![white]], transfer, SAME);
            assert!((red[0] - 1.0).abs() < 0.01, "{transfer:?}: {red:?}");
        }
    }

    #[test]
    fn brighter_light_is_bent_and_keeps_its_order() {
        let ramp: Vec<f32> = (0..=100).map(|i| i as f32 / 100.0).collect();
        let [red, ..] = to_srgb(&[ramp.clone(), ramp.clone(), ramp], Transfer::Pq, SAME);
        assert!(red.windows(2).all(|pair| pair[0] <= pair[1]), "{red:?}");
        assert!(red[0] == 0.0 && red[100] > 0.9999, "{red:?}");
        assert!(red[58] > 0.8 && red[75] < 1.0, "{} {}", red[58], red[75]);
    }
}
