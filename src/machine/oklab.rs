//! How different two colours look.

use crate::math;
use crate::scene::linear_light;

/// How far two colours are apart in Oklab, where equal distances look equal; from black to white it is 1 (Ottosson, "A perceptual
/// color space for image processing", 2020).
pub(super) fn perceptual_distance(a: [u8; 3], b: [u8; 3]) -> f32 {
    let [a, b] = [a, b].map(oklab);
    let difference2 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    difference2.sum::<f32>().sqrt()
}

fn oklab(color: [u8; 3]) -> [f32; 3] {
    let [r, g, b] = color.map(linear_light);
    let [l, m, s] = [
        0.412_221_46 * r + 0.536_332_55 * g + 0.051_445_995 * b,
        0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b,
        0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b,
    ]
    .map(math::cbrt);
    [
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_oklab() {
        let away = |a, b| perceptual_distance(a, b);
        assert!((away([0; 3], [255; 3]) - 1.0).abs() < 1e-4);
        // Red is at (0.62796, 0.22486, 0.12585), as Ottosson gives it.
        let red = oklab([255, 0, 0]);
        let given = [0.62796, 0.22486, 0.12585];
        assert!(
            red.iter()
                .zip(given)
                .all(|(own, given)| (own - given).abs() < 1e-4)
        );
        assert_eq!(away([40, 80, 90], [40, 80, 90]), 0.0);
    }
}
