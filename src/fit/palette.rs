//! Few colours: strokes, and the background, take theirs from a palette.
//!
//! A drawing of any colours is made first. Then each round finds the colour that every stroke would like to have,
//! by a Newton step on its own colour, gives it the nearest one of the palette, and fits everything but colours to
//! what that did. Where the palette is not given, its colours are the weighted means of what the strokes that have
//! them would like: the rounds are those of k-means, with the drawing moving along. Strokes over each other make up
//! for each other's missing colours in this way, as far as the palette allows.

use std::collections::BTreeSet;
use std::f32::consts::PI;

use super::anneal::Anneal;
use super::control::Control;
use super::descent::Descent;
use super::drawing::{Drawing, Wish};
use super::polish::{self, Terms};
use super::recipe::{Rates, Recipe};
use super::rounds::Rounds;
use crate::render::{AX, AY, BX, BY, OPACITY, RADIUS, RED};
use crate::scene::{Rgb, Scene, color, quantum};
use crate::seed::Candidate;

/// Which colours a drawing may have, its background included.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Colors {
    /// Any.
    #[default]
    Free,
    /// At most so many, chosen from the picture.
    AtMost(usize),
    /// These 8-bit ones.
    Palette(Vec<[u8; 3]>),
}

impl Colors {
    /// Whether `scene` has no other colours already.
    pub(super) fn allow(&self, scene: &Scene) -> bool {
        let strokes = scene.strokes().map(|stroke| stroke.color);
        let used: BTreeSet<_> = strokes
            .chain(scene.background)
            .map(|c| c.map(quantum))
            .collect();
        match self {
            Self::Free => true,
            Self::AtMost(most) => used.len() <= *most,
            Self::Palette(palette) => used.iter().all(|color| palette.contains(color)),
        }
    }
}

/// Rounds of choosing colours and fitting the rest.
pub(super) const ROUNDS: Rounds = Rounds {
    count: 12,
    iterations: 0.6,
    rate: 0.3,
};
/// Rounds at the end that relocate no stroke.
const QUIET_ROUNDS: usize = 2;
/// Share of its Newton step that a stroke would like to take: those under and over it take theirs as well.
const DAMPING: f32 = 0.7;
/// Iterations of k-means in a round.
const MEANS: usize = 10;

/// The colours of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Palette {
    colors: Vec<Rgb>,
    /// How many of them, from the first on, are as they are; the others follow the strokes.
    fixed: usize,
}

impl Palette {
    /// The palette that `colors` asks for, for a drawing that would like to have these colours; the `ground`, if it
    /// is given, has one of them. `None` where any colour will do.
    pub(super) fn new(colors: &Colors, wishes: &[Wish], ground: Option<Rgb>) -> Option<Self> {
        match colors {
            Colors::Free => None,
            Colors::Palette(given) => Some(Self {
                colors: given.iter().map(|&c| color(c)).collect(),
                fixed: given.len(),
            }),
            Colors::AtMost(most) => {
                let mut palette = Self {
                    colors: ground.into_iter().collect(),
                    fixed: usize::from(ground.is_some()),
                };
                palette.spread(*most, wishes);
                Some(palette)
            }
        }
    }

    /// The nearest colour.
    pub(super) fn nearest(&self, wanted: Rgb) -> Rgb {
        self.index(wanted)
            .and_then(|k| self.colors.get(k).copied())
            .unwrap_or(wanted)
    }

    /// The candidate in the nearest colour, with what is left of its gain.
    fn adapt(&self, mut candidate: Candidate) -> Candidate {
        let p = &mut candidate.stroke;
        let wanted = [p[RED], p[RED + 1], p[RED + 2]];
        let color = self.nearest(wanted);
        let length = (p[BX] - p[AX]).hypot(p[BY] - p[AY]);
        let area = p[RADIUS] * (2.0 * length + PI * p[RADIUS]);
        candidate.gain -= area * p[OPACITY] * p[OPACITY] * dist2(color, wanted);
        p[RED..OPACITY].copy_from_slice(&color);
        candidate
    }

    fn index(&self, wanted: Rgb) -> Option<usize> {
        let away = |k: &usize| dist2(self.colors[*k], wanted);
        (0..self.colors.len()).min_by(|j, k| away(j).total_cmp(&away(k)))
    }

    /// Adds the colour that is missed most until there are `most`, or none is missed.
    fn spread(&mut self, most: usize, wishes: &[Wish]) {
        while self.colors.len() < most {
            let missed = |wish: &Wish| match self.index(wish.color) {
                Some(k) => wish.weight * dist2(self.colors[k], wish.color),
                None => wish.weight,
            };
            let worst = wishes
                .iter()
                .max_by(|a, b| missed(a).total_cmp(&missed(b)))
                .filter(|wish| missed(wish) > 0.0);
            let Some(worst) = worst else {
                return;
            };
            let color = rounded(worst.color);
            if self.colors.contains(&color) {
                return;
            }
            self.colors.push(color);
        }
    }

    /// Moves the colours that are free to the means of the wishes that are nearest to them.
    fn follow(&mut self, wishes: &[Wish]) {
        for _ in 0..MEANS {
            let mut sums = vec![([0.0_f32; 3], 0.0_f32); self.colors.len()];
            for wish in wishes {
                if let Some(k) = self.index(wish.color) {
                    let (sum, weight) = &mut sums[k];
                    sum.iter_mut()
                        .zip(wish.color)
                        .for_each(|(s, c)| *s += wish.weight * c);
                    *weight += wish.weight;
                }
            }
            let moved = self.colors.iter_mut().zip(sums).skip(self.fixed);
            for (color, (sum, weight)) in moved.filter(|(_, (_, weight))| *weight > 0.0) {
                *color = rounded(sum.map(|s| s / weight));
            }
        }
    }
}

/// The colour that 8 bits can say.
fn rounded(rgb: Rgb) -> Rgb {
    color(rgb.map(quantum))
}

fn dist2(a: Rgb, b: Rgb) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Gives all strokes of `drawing` colours of `palette`, and fits the rest to that. All strokes must be free.
pub(super) fn run(
    drawing: &mut Drawing,
    palette: &mut Palette,
    recipe: &Recipe,
    anneal: Anneal,
    terms: Terms,
    control: &mut Control<'_>,
) {
    recolor(drawing, palette);
    let mut best = (drawing.mse(), drawing.snapshot());
    for round in 0..ROUNDS.count {
        if control.stopped().is_some() {
            break;
        }
        descend(drawing, palette, recipe, anneal, terms, round, control);
        recolor(drawing, palette);
        let mse = drawing.mse();
        if mse < best.0 {
            best = (mse, drawing.snapshot());
        }
    }
    drawing.restore(best.1);
}

/// Gives every stroke, and the background, the colour of the palette that is nearest to what it would like.
fn recolor(drawing: &mut Drawing, palette: &mut Palette) {
    let wishes = drawing.wishes(DAMPING);
    palette.follow(&wishes);
    let colors: Vec<Rgb> = wishes.iter().map(|w| palette.nearest(w.color)).collect();
    drawing.set_colors(&colors);
}

/// A round of descent on everything but colours; at its start strokes worth little go where more is to be gained.
fn descend(
    drawing: &mut Drawing,
    palette: &Palette,
    recipe: &Recipe,
    anneal: Anneal,
    terms: Terms,
    round: usize,
    control: &mut Control<'_>,
) {
    let rates = without_color(recipe.polish_rates);
    let mut descent = Descent::new(drawing.free(), rates, drawing.limits);
    if round + QUIET_ROUNDS < ROUNDS.count {
        let adapt = |candidate| palette.adapt(candidate);
        polish::relocate(drawing, recipe, terms, adapt, &mut descent);
    }
    ROUNDS.descend(round, drawing, descent, recipe, anneal, control);
}

/// Rates that leave colours as they are.
pub(super) fn without_color(rates: Rates) -> Rates {
    Rates {
        color: 0.0,
        ..rates
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish(level: f32, weight: f32) -> Wish {
        Wish {
            color: [level; 3],
            weight,
        }
    }

    fn learned(most: usize, wishes: &[Wish]) -> Vec<Rgb> {
        let mut palette = Palette::new(&Colors::AtMost(most), wishes, None).unwrap();
        palette.follow(wishes);
        palette.colors
    }

    #[test]
    fn a_palette_is_the_means_of_what_is_wished() {
        let wishes = [wish(0.0, 3.0), wish(0.2, 1.0), wish(1.0, 1.0)];
        let colors = learned(2, &wishes);
        assert_eq!(colors, [rounded([0.05; 3]), [1.0; 3]]);
    }

    #[test]
    fn no_more_colours_are_taken_than_are_wished() {
        let wishes = [wish(0.0, 3.0), wish(1.0, 1.0), wish(1.0, 2.0)];
        assert_eq!(learned(16, &wishes), [[0.0; 3], [1.0; 3]]);
    }

    #[test]
    fn given_colours_stay() {
        let wishes = [wish(0.3, 1.0), wish(0.9, 1.0)];
        let given = Colors::Palette(vec![[0; 3], [255; 3]]);
        let mut palette = Palette::new(&given, &wishes, None).unwrap();
        palette.follow(&wishes);
        assert_eq!(palette.colors, [[0.0; 3], [1.0; 3]]);
        assert_eq!(palette.nearest([0.9, 0.2, 0.8]), [1.0; 3]);
    }

    #[test]
    fn a_given_ground_has_its_colour() {
        let wishes = [wish(0.3, 9.0), wish(0.9, 1.0)];
        let palette = Palette::new(&Colors::AtMost(2), &wishes, Some([1.0; 3])).unwrap();
        assert_eq!(palette.colors, [[1.0; 3], rounded([0.3; 3])]);
    }
}
