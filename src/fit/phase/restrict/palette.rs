//! Few colours: strokes and background take their colours from a palette.
//!
//! The drawing has first been fitted in any colours. Each round finds the colour that would suit every stroke best, by a
//! Newton step on its own colour, gives the stroke the nearest colour of the palette, and then fits everything but
//! colours. A palette that is not given is found by k-means during these rounds: each of its colours is the weighted
//! mean of the colours that would suit its strokes best. In this way strokes that overlap make up for colours that the
//! palette lacks, as far as it allows.

use std::f32::consts::PI;

use super::preferences::{DAMPING, PreferredColor, preferences, set_colors};
use super::rounds::{self, Rounds};
use crate::error::Result;
use crate::fit::config::Colors;
use crate::fit::drawing::Drawing;
use crate::fit::phase::polish::{PALETTE_ITERATIONS, Shares};
use crate::fit::phase::relocation;
use crate::fit::run::session::Session;
use crate::math;
use crate::render::{AX, AY, BX, BY, OPACITY, RADIUS, RED};
use crate::scene::{Rgb, color, quantum};
use crate::seed::Candidate;

/// Rounds of choosing colours and fitting the rest. Half, twice, in 12 colours: count −0.07, −0.01 dB; rate −0.19, −0.58.
pub(super) const ROUNDS: Rounds = Rounds {
    count: 12,
    iterations: PALETTE_ITERATIONS,
    rate: 0.3,
};
/// Rounds at the end without relocation. Half, twice: 0.00, −0.01 dB.
const QUIET_ROUNDS: usize = 2;
/// Iterations of k-means in a round. Half, twice: 0.00 dB.
const MEANS: usize = 10;
/// Share of the pixels that show the background where it is kept: a background that a given palette does not replace. A guess.
const KEPT_SHARE: f32 = 0.25;
/// Least difference, per channel, of a kept background from all colours of the palette. A guess.
const KEPT_DISTANCE: f32 = 0.2;

/// Restricts the drawing to the configured palette and fits all other numbers again. Returns the palette, or nothing if any
/// colours are allowed. All strokes must be free.
pub(super) fn run(session: &mut Session<'_>) -> Result<Option<Palette>> {
    let config = session.config;
    let has_background = session.writer.has_background;
    let drawing = &mut session.drawing;
    let Some(mut palette) = palette(drawing, &config.colors, has_background) else {
        return Ok(None);
    };
    let until = Shares::of(config).palette;
    session.timer.until = until;
    let rates = session.recipe.polish.rates.without_color();
    palette.recolor(&mut session.drawing);
    rounds::best(session, ROUNDS, |session, round| {
        // The last rounds relocate nothing, so that new strokes are fitted.
        if round + QUIET_ROUNDS < ROUNDS.count {
            let limit = session.drawing.len();
            relocation::relocate(session, limit, |candidate| palette.adapt(candidate));
        }
        rounds::run(session, ROUNDS, round, rates)?;
        palette.recolor(&mut session.drawing);
        Ok(true)
    })?;
    session.timer.until = 1.0;
    Ok(Some(palette))
}

/// The palette for the drawing, unless any colours are allowed. A background that is kept becomes fixed.
fn palette(drawing: &mut Drawing, colors: &Colors, has_background: bool) -> Option<Palette> {
    if *colors == Colors::Free {
        return None;
    }
    drawing.free_mut().flatten_paints();
    let mut preferences = preferences(drawing, 0.0);
    if !has_background {
        preferences.truncate(drawing.len());
    }
    let is_given = has_background && drawing.background_fixed;
    let background = drawing.background().filter(|_| is_given);
    let palette = Palette::new(colors, &preferences, background);
    if has_background && is_kept(drawing, colors, preferences.last()) {
        drawing.background_fixed = true;
    }
    palette
}

/// True if the background stays as it is although the given palette has no such colour: much of it
/// shows, as its `preference` says, and all colours of the palette are far from its own.
fn is_kept(drawing: &Drawing, colors: &Colors, preference: Option<&PreferredColor>) -> bool {
    let (Colors::Palette(given), Some(preference)) = (colors, preference) else {
        return false;
    };
    let area = drawing.pixel_area();
    let shown = area * preference.weight / drawing.pixels() as f32;
    // Summed over three channels, as `dist2` is.
    let far2 = 3.0 * KEPT_DISTANCE * KEPT_DISTANCE;
    let is_far = |&c: &[u8; 3]| dist2(color(c), preference.color) > far2;
    shown >= KEPT_SHARE && given.iter().all(is_far)
}

/// The colours of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Palette {
    colors: Vec<Rgb>,
    /// Number of them, from the first on, that are fixed. The others follow the strokes.
    fixed: usize,
}

impl Palette {
    /// The palette that `colors` asks for, chosen from these `preferences` unless it is given. It includes the colour of a
    /// fixed `background`. `None` if any colours are allowed.
    fn new(
        colors: &Colors,
        preferences: &[PreferredColor],
        background: Option<Rgb>,
    ) -> Option<Self> {
        match colors {
            Colors::Free => None,
            Colors::Palette(given) => Some(Self {
                colors: given.iter().map(|&c| color(c)).collect(),
                fixed: given.len(),
            }),
            Colors::AtMost(most) => {
                let mut palette = Self {
                    colors: background.into_iter().collect(),
                    fixed: usize::from(background.is_some()),
                };
                palette.spread(*most, preferences);
                Some(palette)
            }
        }
    }

    /// Gives every stroke, and the background, the nearest colour to the one that suits it best.
    pub(super) fn recolor(&mut self, drawing: &mut Drawing) {
        let preferences = preferences(drawing, DAMPING);
        self.follow(&preferences, MEANS);
        let colors: Vec<Rgb> = preferences.iter().map(|w| self.nearest(w.color)).collect();
        set_colors(drawing, &colors);
    }

    /// The nearest colour.
    fn nearest(&self, wanted: Rgb) -> Rgb {
        self.index(wanted)
            .and_then(|k| self.colors.get(k).copied())
            .unwrap_or(wanted)
    }

    /// The candidate in the nearest colour of the palette, with the gain that it has then.
    fn adapt(&self, mut candidate: Candidate) -> Candidate {
        let p = &mut candidate.stroke;
        let wanted = [p[RED], p[RED + 1], p[RED + 2]];
        let color = self.nearest(wanted);
        let length = math::hypot(p[BX] - p[AX], p[BY] - p[AY]);
        // A wrong colour of opacity α adds α²·|Δ|² to each of the pixels that the capsule covers.
        let area = p[RADIUS] * (2.0 * length + PI * p[RADIUS]);
        candidate.gain -= area * p[OPACITY] * p[OPACITY] * dist2(color, wanted);
        p[RED..OPACITY].copy_from_slice(&color);
        candidate
    }

    fn index(&self, wanted: Rgb) -> Option<usize> {
        let away = |k: &usize| dist2(self.colors[*k], wanted);
        (0..self.colors.len()).min_by(|j, k| away(j).total_cmp(&away(k)))
    }

    /// Adds, one by one, the colour whose absence costs most, until there are `most` or none is missing.
    fn spread(&mut self, most: usize, preferences: &[PreferredColor]) {
        while self.colors.len() < most {
            // The squared error that the nearest colour of the palette leaves. The first colour has the largest weight.
            let missed = |preference: &PreferredColor| match self.index(preference.color) {
                Some(k) => preference.weight * dist2(self.colors[k], preference.color),
                None => preference.weight,
            };
            let worst = preferences
                .iter()
                .max_by(|a, b| missed(a).total_cmp(&missed(b)))
                .filter(|preference| missed(preference) > 0.0);
            let Some(worst) = worst else {
                return;
            };
            let color = rounded(worst.color);
            // Rounded to 8 bits it is in the palette already, so that no further colour would help.
            if self.colors.contains(&color) {
                return;
            }
            self.colors.push(color);
        }
    }

    /// Moves the colours that are not fixed to the weighted means of the nearest preferences, by k-means.
    fn follow(&mut self, preferences: &[PreferredColor], iterations: usize) {
        for _ in 0..iterations {
            let mut sums = vec![([0.0_f32; 3], 0.0_f32); self.colors.len()];
            for preference in preferences {
                if let Some(k) = self.index(preference.color) {
                    let (sum, weight) = &mut sums[k];
                    sum.iter_mut()
                        .zip(preference.color)
                        .for_each(|(s, c)| *s += preference.weight * c);
                    *weight += preference.weight;
                }
            }
            // Lloyd's step. A colour that nothing is nearest to stays where it is.
            let moved = self.colors.iter_mut().zip(sums).skip(self.fixed);
            for (color, (sum, weight)) in moved.filter(|(_, (_, weight))| *weight > 0.0) {
                *color = rounded(sum.map(|s| s / weight));
            }
        }
    }
}

/// The nearest 8-bit colour.
fn rounded(rgb: Rgb) -> Rgb {
    color(rgb.map(quantum))
}

fn dist2(a: Rgb, b: Rgb) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn preference(level: f32, weight: f32) -> PreferredColor {
        PreferredColor {
            color: [level; 3],
            weight,
        }
    }

    fn learned(most: usize, preferences: &[PreferredColor]) -> Vec<Rgb> {
        let mut palette = Palette::new(&Colors::AtMost(most), preferences, None).unwrap();
        palette.follow(preferences, 10);
        palette.colors
    }

    #[test]
    fn a_palette_is_the_means_of_what_is_preferred() {
        let preferences = [
            preference(0.0, 3.0),
            preference(0.2, 1.0),
            preference(1.0, 1.0),
        ];
        let colors = learned(2, &preferences);
        assert_eq!(colors, [rounded([0.05; 3]), [1.0; 3]]);
    }

    #[test]
    fn no_more_colours_are_taken_than_are_preferred() {
        let preferences = [
            preference(0.0, 3.0),
            preference(1.0, 1.0),
            preference(1.0, 2.0),
        ];
        assert_eq!(learned(16, &preferences), [[0.0; 3], [1.0; 3]]);
    }

    #[test]
    fn given_colours_stay() {
        let preferences = [preference(0.3, 1.0), preference(0.9, 1.0)];
        let given = Colors::Palette(vec![[0; 3], [255; 3]]);
        let mut palette = Palette::new(&given, &preferences, None).unwrap();
        palette.follow(&preferences, 10);
        assert_eq!(palette.colors, [[0.0; 3], [1.0; 3]]);
        assert_eq!(palette.nearest([0.9, 0.2, 0.8]), [1.0; 3]);
    }

    #[test]
    fn a_given_background_has_its_colour() {
        let preferences = [preference(0.3, 9.0), preference(0.9, 1.0)];
        let palette = Palette::new(&Colors::AtMost(2), &preferences, Some([1.0; 3])).unwrap();
        assert_eq!(palette.colors, [[1.0; 3], rounded([0.3; 3])]);
    }
}
