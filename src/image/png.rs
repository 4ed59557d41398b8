//! The chunks of a PNG that define its colours.

use super::decoded::Coding;
use super::header::be32;

/// Gammas this near to 1/2.2 count as sRGB's, which tools round in many ways. libpng has the same tolerance.
const NEAR: f64 = 0.05;

/// Gammas beyond these are no pictures'; 0 is a known mistake of encoders.
const GAMMAS: std::ops::RangeInclusive<f64> = 0.05..=5.0;

/// The colours that the samples encode, where chunks say so: by `cICP`, else `iCCP`, else `sRGB`, else `gAMA` and
/// `cHRM`. `icc` is the profile in `iCCP`.
pub(super) fn coding(bytes: &[u8], icc: Option<Vec<u8>>) -> Option<Coding> {
    let find = |name: &[u8; 4]| {
        let mut chunks = chunks(bytes);
        let found = chunks.find(|(found, _)| *found == name);
        found.map(|(_, body)| body)
    };
    // A PNG is RGB of the full range, so `cICP` makes sense with the matrix 0 and the full-range flag 1 alone.
    if let Some(&[primaries, transfer, 0, 1]) = find(b"cICP")
        && is_stated(primaries, transfer)
    {
        return Some(Coding::Cicp(primaries, transfer));
    }
    if icc.is_some() {
        return icc.map(Coding::Icc);
    }
    // All pictures here are sRGB: nothing to convert.
    if find(b"sRGB").is_some() {
        return None;
    }
    let gamma = find(b"gAMA").and_then(gamma);
    let chromaticities = find(b"cHRM").and_then(chromaticities);
    let is_plain = gamma.is_none() && chromaticities.is_none();
    (!is_plain).then_some(Coding::Gamma {
        gamma,
        chromaticities,
    })
}

/// True if code points name known primaries, and a transfer function of displays.
fn is_stated(primaries: u8, transfer: u8) -> bool {
    matches!(primaries, 1 | 4..=9 | 11 | 12 | 22) && matches!(transfer, 1 | 4..=8 | 11..=16 | 18)
}

/// The power that encodes light; `None` for sRGB's, and for nonsense.
fn gamma(body: &[u8]) -> Option<f64> {
    // `gAMA` and `cHRM` store numbers times 100,000.
    let gamma = f64::from(be32(body, 0)?) / 1e5;
    let is_usual = (gamma * 2.2 - 1.0).abs() < NEAR;
    (GAMMAS.contains(&gamma) && !is_usual).then_some(gamma)
}

/// The white point and the primaries, x and y of each; `None` if no colours can be made of them.
fn chromaticities(body: &[u8]) -> Option<[f64; 8]> {
    let mut places = [0.0; 8];
    for (i, place) in places.iter_mut().enumerate() {
        *place = f64::from(be32(body, 4 * i)?) / 1e5;
    }
    let [_, _, red @ .., blue_x, blue_y] = places;
    let [red_x, red_y, green_x, green_y] = red;
    // Twice the area of the triangle that the primaries span.
    let area = (green_x - red_x) * (blue_y - red_y) - (blue_x - red_x) * (green_y - red_y);
    // Conversion divides by y, and inverts the matrix of the primaries: neither may be 0.
    let has_height = places.iter().skip(1).step_by(2).all(|&y| y > 1e-3);
    (has_height && area.abs() > 1e-3 && places.iter().all(|&v| v <= 1.5)).then_some(places)
}

/// The name and body of each chunk before the first with pixels.
fn chunks(bytes: &[u8]) -> impl Iterator<Item = (&[u8], &[u8])> {
    let mut at = 8_usize;
    std::iter::from_fn(move || {
        let length = be32(bytes, at)? as usize;
        let name = bytes.get(at + 4..at + 8)?;
        let body = bytes.get(at + 8..)?.get(..length)?;
        // Length, name and checksum take 4 bytes each.
        at += 12 + length;
        (name != b"IDAT").then_some((name, body))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A PNG up to its pixels, with these chunks.
    fn png(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
        for (name, body) in chunks.iter().chain(&[(b"IDAT", &b""[..])]) {
            bytes.extend((body.len() as u32).to_be_bytes());
            bytes.extend(*name);
            bytes.extend(*body);
            bytes.extend([0; 4]);
        }
        bytes
    }

    fn gamma_of(value: u32) -> [u8; 4] {
        value.to_be_bytes()
    }

    #[test]
    fn the_first_of_the_statements_counts() {
        let linear = gamma_of(100_000);
        let (cicp, srgb, gama) = (
            (b"cICP", &[12, 13, 0, 1][..]),
            (b"sRGB", &[0][..]),
            (b"gAMA", &linear[..]),
        );
        let icc = || Some(vec![1, 2, 3]);
        assert_eq!(
            coding(&png(&[gama, srgb, cicp]), icc()),
            Some(Coding::Cicp(12, 13))
        );
        assert_eq!(coding(&png(&[gama, srgb]), icc()), icc().map(Coding::Icc));
        assert_eq!(coding(&png(&[gama, srgb]), None), None);
        let stated = Coding::Gamma {
            gamma: Some(1.0),
            chromaticities: None,
        };
        assert_eq!(coding(&png(&[gama]), None), Some(stated));
        assert_eq!(coding(&png(&[]), None), None);
    }

    #[test]
    fn code_points_that_say_nothing_are_passed_over() {
        for unknown in [[2, 2, 0, 1], [1, 13, 1, 1], [1, 13, 0, 0], [0, 13, 0, 1]] {
            assert_eq!(coding(&png(&[(b"cICP", &unknown)]), None), None);
        }
    }

    #[test]
    fn the_gamma_of_srgb_and_nonsense_change_nothing() {
        for value in [45_455, 45_000, 47_000, 0, 1, u32::MAX] {
            assert_eq!(coding(&png(&[(b"gAMA", &gamma_of(value))]), None), None);
        }
        assert_eq!(coding(&png(&[(b"gAMA", &[0, 1])]), None), None);
        assert_eq!(coding(&png(&[(b"cHRM", &[0; 32])]), None), None);
    }

    #[test]
    fn no_cut_or_length_leads_astray() {
        let whole = png(&[(b"gAMA", &gamma_of(u32::MAX)), (b"cHRM", &[255; 32])]);
        for cut in 0..whole.len() {
            coding(&whole[..cut], None);
        }
        let mut long = whole;
        long[8..12].fill(255);
        assert_eq!(coding(&long, None), None);
    }
}
