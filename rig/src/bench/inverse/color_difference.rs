//! CIEDE2000 colour differences of pictures.
//!
//! G. Sharma, W. Wu, E. N. Dalal, "The CIEDE2000 color-difference formula: implementation notes, supplementary test
//! data, and mathematical observations", 2005. The tests have its published pairs. Colours are sRGB, seen under D65.

use rayon::prelude::*;

use strokefit::image::Image;
use strokefit::math;

/// Mean difference of the 8-bit pixels of two pictures of one size.
pub(super) fn mean(a: &Image, b: &Image) -> f64 {
    let (a, b) = (a.to_rgb8(), b.to_rgb8());
    let row = 3 * 1024;
    let rows = a.par_chunks(row).zip(b.par_chunks(row));
    let sums: Vec<f64> = rows.map(|(a, b)| sum(a, b)).collect();
    sums.iter().sum::<f64>() / (a.len() / 3).max(1) as f64
}

/// Sum over pixels. Most are equal to each other, and most others equal to the last pair.
fn sum(a: &[u8], b: &[u8]) -> f64 {
    let pixels = |bytes| <[u8]>::as_chunks::<3>(bytes).0;
    let (mut last, mut apart, mut sum) = (None, 0.0, 0.0);
    for pair in pixels(a).iter().zip(pixels(b)).filter(|(a, b)| a != b) {
        if last != Some(pair) {
            (last, apart) = (Some(pair), difference(lab(*pair.0), lab(*pair.1)));
        }
        sum += apart;
    }
    sum
}

/// Lightness, and the two coordinates of colour, of 8-bit sRGB; white is D65.
fn lab(rgb: [u8; 3]) -> [f64; 3] {
    let [r, g, b] = rgb.map(|level| {
        let v = f64::from(level) / 255.0;
        if v <= 0.04045 {
            v / 12.92
        } else {
            math::powf((v + 0.055) / 1.055, 2.4)
        }
    });
    // IEC 61966-2-1; each row's sum is the white point.
    let x = (0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b) / 0.950_47;
    let y = 0.212_672_9 * r + 0.715_152_2 * g + 0.072_175_0 * b;
    let z = (0.019_333_9 * r + 0.119_192 * g + 0.950_304_1 * b) / 1.088_83;
    let [x, y, z] = [x, y, z].map(|t| {
        if t > 216.0 / 24_389.0 {
            math::cbrt(t)
        } else {
            (24_389.0 / 27.0 * t + 16.0) / 116.0
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// ΔE00 of two colours; the names are those of the paper.
fn difference([l1, a1, b1]: [f64; 3], [l2, a2, b2]: [f64; 3]) -> f64 {
    let mean_c = f64::midpoint(math::hypot(a1, b1), math::hypot(a2, b2));
    let g = 0.5 * (1.0 - saturation(mean_c));
    let (a1, a2) = ((1.0 + g) * a1, (1.0 + g) * a2);
    let (c1, c2) = (math::hypot(a1, b1), math::hypot(a2, b2));
    let (h1, h2) = (hue(a1, b1), hue(a2, b2));
    let (turn, mean_h) = if c1 * c2 == 0.0 {
        (0.0, h1 + h2)
    } else {
        between(h1, h2)
    };
    let big_h = 2.0 * (c1 * c2).sqrt() * sin(turn / 2.0);
    let (mean_l, mean_c) = (f64::midpoint(l1, l2), f64::midpoint(c1, c2));
    let t =
        1.0 - 0.17 * cos(mean_h - 30.0) + 0.24 * cos(2.0 * mean_h) + 0.32 * cos(3.0 * mean_h + 6.0)
            - 0.2 * cos(4.0 * mean_h - 63.0);
    let off = math::powi(mean_l - 50.0, 2);
    let s_l = 1.0 + 0.015 * off / (20.0 + off).sqrt();
    let (s_c, s_h) = (1.0 + 0.045 * mean_c, 1.0 + 0.015 * mean_c * t);
    let theta = 30.0 * math::exp(-math::powi((mean_h - 275.0) / 25.0, 2));
    let r_t = -sin(2.0 * theta) * 2.0 * saturation(mean_c);
    let (l, c, h) = ((l2 - l1) / s_l, (c2 - c1) / s_c, big_h / s_h);
    (l * l + c * c + h * h + r_t * c * h).max(0.0).sqrt()
}

/// √(C⁷ / (C⁷ + 25⁷)).
fn saturation(c: f64) -> f64 {
    let c7 = math::powi(c, 7);
    (c7 / (c7 + math::powi(25.0, 7))).sqrt()
}

/// Degrees, 0 to 360.
fn hue(a: f64, b: f64) -> f64 {
    let flat = a.abs() >= b.abs();
    match (flat, a, b) {
        (_, 0.0, 0.0) => 0.0,
        (true, ..0.0, _) => 180.0 + math::atan(b / a).to_degrees(),
        (true, _, ..0.0) => 360.0 + math::atan(b / a).to_degrees(),
        (true, ..) => math::atan(b / a).to_degrees(),
        (false, _, ..0.0) => 270.0 - math::atan(a / b).to_degrees(),
        (false, ..) => 90.0 - math::atan(a / b).to_degrees(),
    }
}

/// The shorter way from one hue to another, and the hue halfway along it.
fn between(h1: f64, h2: f64) -> (f64, f64) {
    let (way, middle) = (h2 - h1, f64::midpoint(h1, h2));
    // Opposite hues may seem slightly more than opposite by rounding.
    if way.abs() <= 180.0 + 1e-9 {
        (way, middle)
    } else {
        let turn = if way > 0.0 { -360.0 } else { 360.0 };
        let back = if h1 + h2 < 360.0 { 180.0 } else { -180.0 };
        (way + turn, middle + back)
    }
}

fn sin(degrees: f64) -> f64 {
    math::sin(degrees.to_radians())
}

fn cos(degrees: f64) -> f64 {
    math::cos(degrees.to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 1 of the paper.
    #[rustfmt::skip]
    const PAIRS: [([f64; 3], [f64; 3], f64); 34] = [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, 3.1571, -77.2803], [50.0, 0.0, -82.7485], 2.8615),
        ([50.0, 2.8361, -74.0200], [50.0, 0.0, -82.7485], 3.4412),
        ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
        ([50.0, -1.1848, -84.8006], [50.0, 0.0, -82.7485], 1.0000),
        ([50.0, -0.9009, -85.5211], [50.0, 0.0, -82.7485], 1.0000),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
        ([50.0, -1.0, 2.0], [50.0, 0.0, 0.0], 2.3669),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0009], 7.1792),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0010], 7.1792),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0011], 7.2195),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0012], 7.2195),
        ([50.0, -0.0010, 2.4900], [50.0, 0.0009, -2.4900], 4.8045),
        ([50.0, -0.0010, 2.4900], [50.0, 0.0010, -2.4900], 4.8045),
        ([50.0, -0.0010, 2.4900], [50.0, 0.0011, -2.4900], 4.7461),
        ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.3065),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([50.0, 2.5, 0.0], [61.0, -5.0, 29.0], 22.8977),
        ([50.0, 2.5, 0.0], [56.0, -27.0, -3.0], 31.9030),
        ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
        ([50.0, 2.5, 0.0], [50.0, 3.1736, 0.5854], 1.0000),
        ([50.0, 2.5, 0.0], [50.0, 3.2972, 0.0], 1.0000),
        ([50.0, 2.5, 0.0], [50.0, 1.8634, 0.5757], 1.0000),
        ([50.0, 2.5, 0.0], [50.0, 3.2592, 0.3350], 1.0000),
        ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ([63.0109, -31.0961, -5.8663], [62.8187, -29.7946, -4.0864], 1.2630),
        ([61.2901, 3.7196, -5.3901], [61.4292, 2.2480, -4.9620], 1.8731),
        ([35.0831, -44.1164, 3.7933], [35.0232, -40.0716, 1.5901], 1.8645),
        ([22.7233, 20.0904, -46.6940], [23.0331, 14.9730, -42.5619], 2.0373),
        ([36.4612, 47.8580, 18.3852], [36.2715, 50.5065, 21.2231], 1.4146),
        ([90.8027, -2.0831, 1.4410], [91.1528, -1.6435, 0.0447], 1.4441),
        ([90.9257, -0.5406, -0.9208], [88.6381, -0.8985, -0.7239], 1.5381),
        ([6.7747, -0.2908, -2.4247], [5.8714, -0.0985, -2.2286], 0.6377),
        ([2.0776, 0.0795, -1.1350], [0.9033, -0.0636, -0.5514], 0.9082),
    ];

    #[test]
    fn published_pairs_are_as_far_apart_as_published() {
        for (a, b, published) in PAIRS {
            for found in [difference(a, b), difference(b, a)] {
                assert!((found - published).abs() < 5.1e-5, "{a:?} {b:?}: {found}");
            }
        }
    }

    #[test]
    fn colours_are_seen_under_d65() {
        let near = |found: [f64; 3], expected: [f64; 3]| {
            let apart = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f64::max) < 0.02, "{found:?}");
        };
        near(lab([255; 3]), [100.0, 0.0, 0.0]);
        near(lab([0; 3]), [0.0, 0.0, 0.0]);
        near(lab([255, 0, 0]), [53.24, 80.09, 67.20]);
        near(lab([0, 0, 255]), [32.30, 79.19, -107.86]);
    }

    #[test]
    fn equal_pixels_count_as_nothing() {
        let plane = vec![0.0, 1.0, 1.0, 1.0];
        let a = Image::new(4, 1, [plane.clone(), plane.clone(), plane]).unwrap();
        let white = Image::filled(4, 1, [1.0; 3]).unwrap();
        assert!((mean(&a, &white) - 25.0).abs() < 1e-3, "a quarter of 100");
        assert_eq!(mean(&a, &a), 0.0);
    }
}
