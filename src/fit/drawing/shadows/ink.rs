//! The ink of a shadow: the one colour that it mixes surfaces with, by shares.

use nalgebra::{Matrix4, Vector4};

use crate::shading::Value;

/// Number of times that the ink is found, each time from the pixels near the last one.
const ROUNDS: usize = 3;
/// How much the darkest or brightest ink counts where pixels of one surface do not tell how far away it is. A guess.
const TIE: f64 = 3e-2;

/// The ink of soft pixels, each a value and that of its surface in full light. Those farther than `near` from a mixture do not count.
pub(super) fn of(pixels: impl Iterator<Item = (Value, Value)>, near: f32) -> Option<Value> {
    let pixels: Vec<(Value, Value)> = pixels.collect();
    let mut ink = None;
    for _ in 0..ROUNDS {
        let is_near = |(value, base): &&(Value, Value)| {
            ink.is_none_or(|ink| share(*value, *base, ink).1 <= near)
        };
        ink = Some(common(
            &pixels.iter().filter(is_near).copied().collect::<Vec<_>>(),
        )?);
    }
    ink
}

/// The ink that lies on the lines through all surfaces and their soft pixels, as nearly as one can.
fn common(pixels: &[(Value, Value)]) -> Option<Value> {
    // On one surface all inks along the line are alike, so the farthest one that is a colour stands for them.
    let (mean, along, whole) = line(pixels.iter())?;
    let far = vector(farthest(mean, along)?);
    // One line for the pixels on about one colour, as single ones are rounded.
    let mut surfaces: Vec<(Value, Vec<&(Value, Value)>)> = Vec::new();
    for pixel in pixels {
        let about = pixel.1.map(|v| (v * 15.0).round());
        match surfaces.iter_mut().find(|(own, _)| *own == about) {
            Some((_, own)) => own.push(pixel),
            None => surfaces.push((about, vec![pixel])),
        }
    }
    // Σ w·P·(ink − base) = 0, with P the projection that takes away what is along the line.
    let (mut sum, mut right) = (Matrix4::<f64>::zeros(), Vector4::<f64>::zeros());
    for (_, pixels) in surfaces {
        if let Some((base, along, weight)) = line(pixels.into_iter()) {
            let along = vector(along);
            let own = (Matrix4::identity() - along * along.transpose()) * f64::from(weight);
            sum += own;
            right += own * vector(base);
        }
    }
    let tie = TIE * f64::from(whole);
    let ink = (sum + Matrix4::identity() * tie)
        .lu()
        .solve(&(right + far * tie))?;
    Some(std::array::from_fn(|c| (ink[c] as f32).clamp(0.0, 1.0)))
}

/// The mean surface of soft pixels, the direction of their differences from it, and the sum of the squares of these.
fn line<'a>(
    pixels: impl Iterator<Item = &'a (Value, Value)> + Clone,
) -> Option<(Value, Value, f32)> {
    let direction = direction(pixels.clone().map(|(value, base)| minus(*value, *base)))?;
    let weight = |(value, base): &(Value, Value)| distance2(*value, *base);
    let whole: f32 = pixels.clone().map(weight).sum();
    let mean = pixels.fold([0.0; 4], |mean: Value, pixel| {
        std::array::from_fn(|c| mean[c] + weight(pixel) / whole * pixel.1[c])
    });
    Some((mean, direction, whole))
}

fn vector(value: Value) -> Vector4<f64> {
    Vector4::from(value.map(f64::from))
}

fn minus(a: Value, b: Value) -> Value {
    std::array::from_fn(|c| a[c] - b[c])
}

/// The largest difference of two values.
pub(super) fn away(a: Value, b: Value) -> f32 {
    (0..4).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max)
}

/// The squared distance of two values.
pub(super) fn distance2(a: Value, b: Value) -> f32 {
    minus(a, b).iter().map(|v| v * v).sum()
}

/// The direction that differences have on the whole: their sum weighted by size, with opposite ones turned around.
fn direction(differences: impl Iterator<Item = Value>) -> Option<Value> {
    let differences: Vec<Value> = differences.collect();
    let mut axis = [0.0_f32; 4];
    // The first sum has no axis yet and takes all signs as they are; the second turns differences against the axis around.
    for _ in 0..2 {
        let mut sum = [0.0_f64; 4];
        for difference in &differences {
            let along: f32 = (0..4).map(|c| difference[c] * axis[c]).sum();
            let size = distance2(*difference, [0.0; 4]).sqrt();
            let sign = if along < 0.0 { -size } else { size };
            (0..4).for_each(|c| sum[c] += f64::from(sign * difference[c]));
        }
        let length = sum.iter().map(|v| v * v).sum::<f64>().sqrt();
        if length <= 0.0 {
            return None;
        }
        axis = sum.map(|v| (v / length) as f32);
    }
    Some(axis)
}

/// The value farthest from a surface in a direction that a colour can have: an opaque one, where the surface is transparent.
fn farthest(base: Value, direction: Value) -> Option<Value> {
    let most = |c: usize| match direction[c] {
        d if d > 1e-4 => (1.0 - base[c]) / d,
        d if d < -1e-4 => -base[c] / d,
        _ => f32::INFINITY,
    };
    let most = match base[3] > 0.5 {
        true => (0..3).map(most).fold(f32::INFINITY, f32::min),
        false => most(3),
    };
    let ink = [0, 1, 2, 3].map(|c| (base[c] + most * direction[c]).clamp(0.0, 1.0));
    (most.is_finite() && most > 0.0).then_some(ink)
}

/// The share of `ink` on a surface that a value shows, and how far it is from their mixture.
pub(super) fn share(value: Value, base: Value, ink: Value) -> (f32, f32) {
    let (mut along, mut whole) = (0.0, 0.0);
    for c in 0..4 {
        let full = ink[c] - base[c];
        along += (value[c] - base[c]) * full;
        whole += full * full;
    }
    let share = along / whole.max(f32::MIN_POSITIVE);
    // The share is the projection of (value − base) onto (ink − base); the rest is the distance from the mixture.
    let mixed = std::array::from_fn(|c| base[c] + share * (ink[c] - base[c]));
    (share, away(value, mixed))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Soft pixels of `ink` on a surface, 8 bits.
    fn soft(base: Value, ink: Value) -> impl Iterator<Item = (Value, Value)> {
        let mixed = move |share: f32| {
            let value = |c: usize| base[c] + share * (ink[c] - base[c]);
            (
                std::array::from_fn(|c| (255.0 * value(c)).round() / 255.0),
                base,
            )
        };
        (1..30).map(move |k| mixed(k as f32 / 100.0))
    }

    #[test]
    fn the_ink_is_where_the_lines_of_two_surfaces_meet() {
        let ink = [0.24, 0.24, 0.43, 1.0];
        let on = [[0.96, 0.97, 0.98, 1.0], [0.9, 0.4, 0.1, 1.0]];
        let found = of(on.into_iter().flat_map(|base| soft(base, ink)), 0.016).unwrap();
        assert!(away(found, ink) < 0.08, "{found:?}");
    }

    #[test]
    fn on_one_surface_the_ink_is_as_far_as_a_colour_can_be() {
        let found = of(soft([1.0, 1.0, 1.0, 1.0], [0.5, 0.5, 0.75, 1.0]), 0.016).unwrap();
        assert!(away(found, [0.0, 0.0, 0.5, 1.0]) < 0.03, "{found:?}");
        // Of a page without colour it is opaque.
        let found = of(soft([0.0; 4], [0.2, 0.4, 0.6, 1.0]), 0.016).unwrap();
        assert!(away(found, [0.2, 0.4, 0.6, 1.0]) < 0.05, "{found:?}");
    }

    #[test]
    fn what_is_off_the_mixture_does_not_count() {
        let black = soft([1.0; 4], [0.0, 0.0, 0.0, 1.0]);
        let red = (0..5).map(|_| ([1.0, 0.7, 0.7, 1.0], [1.0; 4]));
        let found = of(black.chain(red), 0.016).unwrap();
        assert!(away(found, [0.0, 0.0, 0.0, 1.0]) < 0.03, "{found:?}");
    }
}
