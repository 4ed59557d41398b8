//! Compares fits with the article's recipe, at equal strokes and at equal time.

use super::{ARTICLE, Comparison, Holds, OWN, ParetoEntry};

/// Least gain of a fit over the article's recipe at equal strokes, dB.
const MIN_GAIN_DB: f64 = 6.0;
/// Largest share of the recipe's CPU time that the fit may take.
const MAX_TIME: f64 = 0.25;

/// Resolution of CPU time, s.
const TICK_S: f64 = 0.01;

/// Start of the label of the article's own run. The claim is made of this run only.
const OWN_RUN: &str = "5000 strokes, 1500 iterations";
/// Least pixels per stroke for the claim; the article's demo has 24. Where strokes are as small as pixels, there
/// is little to gain.
const MIN_ROOM: usize = 8;

/// A run of the recipe, and the best fit of as many strokes that took at most a quarter of its time.
pub(super) struct AtEqualStrokes<'a> {
    pub(super) recipe: &'a ParetoEntry,
    pub(super) fit: Option<&'a ParetoEntry>,
}

/// A run of the recipe that took as long as a fit of as many strokes.
pub(super) struct AtEqualTime<'a> {
    pub(super) recipe: &'a ParetoEntry,
    pub(super) fit: &'a ParetoEntry,
}

/// The strokes that a run of the recipe was given: the first word of its label.
fn asked(recipe: &ParetoEntry) -> Option<&str> {
    recipe.label.split(' ').next()
}

/// The runs of the recipe that have a drawing.
fn recipes<'a>(here: &[&'a ParetoEntry]) -> impl Iterator<Item = &'a ParetoEntry> {
    let recipes = here.iter().copied().filter(|e| e.family == ARTICLE);
    recipes.filter(|e| e.psnr_db().is_some())
}

/// Fits of as many strokes as a run of the recipe.
fn fits<'a>(
    here: &[&'a ParetoEntry],
    recipe: &'a ParetoEntry,
) -> impl Iterator<Item = &'a ParetoEntry> {
    let own = here.iter().copied().filter(|e| e.family == OWN);
    own.filter(|e| e.psnr_db().is_some() && e.asked_strokes() == asked(recipe))
}

fn gain_db(fit: &ParetoEntry, recipe: &ParetoEntry) -> f64 {
    fit.psnr_db().unwrap_or(f64::NAN) - recipe.psnr_db().unwrap_or(f64::NAN)
}

impl<'a> AtEqualStrokes<'a> {
    /// One for each run of the recipe in `here`, the drawings of one picture.
    pub(super) fn all(here: &[&'a ParetoEntry]) -> Vec<Self> {
        let runs = recipes(here).filter(|e| !e.label.contains("time of"));
        let best = |recipe: &'a ParetoEntry| {
            let most = MAX_TIME * recipe.cpu_s?;
            let quick = fits(here, recipe).filter(|e| e.cpu_s.is_some_and(|cpu| cpu <= most));
            quick.max_by(|a, b| gain_db(a, recipe).total_cmp(&gain_db(b, recipe)))
        };
        runs.map(|recipe| Self {
            recipe,
            fit: best(recipe),
        })
        .collect()
    }

    /// dB that the fit gains, and the share of the recipe's CPU time that it takes.
    pub(super) fn gain(&self) -> Option<[f64; 2]> {
        let fit = self.fit?;
        let share = fit.cpu_s? / self.recipe.cpu_s?.max(TICK_S);
        Some([gain_db(fit, self.recipe), share])
    }

    pub(super) fn comparison(&self) -> Comparison {
        let time = self.recipe.cpu_s.unwrap_or(f64::NAN);
        let preset = self.fit.and_then(|fit| fit.preset.as_deref());
        let figure = match self.gain() {
            Some([gain, share]) => format!(
                "{gain:+.2} dB ({}) in {share:.2} of its CPU time",
                preset.unwrap_or_default()
            ),
            None => format!("no fit of as many strokes took at most {MAX_TIME} of its {time:.2} s"),
        };
        let enough = self.gain().is_some_and(|[gain, _]| gain >= MIN_GAIN_DB);
        Comparison {
            picture: self.recipe.picture.clone(),
            claim: format!(
                "at least {MIN_GAIN_DB} dB above the article's recipe ({}) in at most {MAX_TIME} of its CPU time",
                self.recipe.label
            ),
            figure,
            holds: match enough {
                true => Holds::Holds,
                false if self.is_claimed() => Holds::Refuted,
                false => Holds::Not,
            },
        }
    }

    fn is_claimed(&self) -> bool {
        let strokes = asked(self.recipe).and_then(|word| word.parse().ok());
        let pixels = self.recipe.width * self.recipe.height;
        self.recipe.label.starts_with(OWN_RUN)
            && strokes.is_some_and(|strokes: usize| pixels >= MIN_ROOM * strokes)
    }
}

impl<'a> AtEqualTime<'a> {
    /// One for each run of the recipe in `here`, the drawings of one picture, that was given a fit's time.
    pub(super) fn all(here: &[&'a ParetoEntry]) -> Vec<Self> {
        let all = recipes(here).filter_map(|recipe| {
            let same = |e: &&ParetoEntry| {
                let preset = e.preset.as_deref().unwrap_or_default();
                recipe.label.contains(&format!("time of {preset},")) && e.seed == recipe.seed
            };
            let fit = fits(here, recipe).find(same)?;
            Some(Self { recipe, fit })
        });
        all.collect()
    }

    /// dB that the fit gains.
    pub(super) fn gain_db(&self) -> f64 {
        gain_db(self.fit, self.recipe)
    }

    pub(super) fn comparison(&self) -> Comparison {
        let [ours, theirs] = [self.fit, self.recipe].map(|e| e.cpu_s.unwrap_or(f64::NAN));
        let gain = self.gain_db();
        Comparison {
            picture: self.recipe.picture.clone(),
            claim: format!(
                "better than the article's recipe at equal CPU time ({})",
                self.recipe.label
            ),
            figure: format!("{gain:+.2} dB, {ours:.2} s against {theirs:.2} s"),
            holds: if gain > 0.0 { Holds::Holds } else { Holds::Not },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{comparisons, drawing};
    use super::*;

    fn own(preset: &str, cpu_s: f64, psnr_db: f64) -> ParetoEntry {
        let label = format!("{preset} 100 smoothstep seed 0");
        ParetoEntry {
            preset: Some(preset.into()),
            ..drawing(OWN, &label, cpu_s, 900, psnr_db)
        }
    }

    fn recipe(label: &str, cpu_s: f64, psnr_db: f64) -> ParetoEntry {
        drawing(ARTICLE, label, cpu_s, 900, psnr_db)
    }

    #[test]
    fn only_quick_fits_count_against_the_article() {
        let recipe = recipe("100 strokes, 1500 iterations, seed 0", 4.0, 24.0);
        let slow = own("best", 2.0, 35.0);
        let holds = |quick| comparisons(&[recipe.clone(), slow.clone(), quick])[0].holds;
        assert_eq!(holds(own("draft", 0.8, 29.0)), Holds::Not, "only 5 dB");
        assert_eq!(holds(own("draft", 1.2, 31.0)), Holds::Not, "too slow");
        assert_eq!(holds(own("draft", 1.0, 30.0)), Holds::Holds);
    }

    #[test]
    fn the_articles_own_run_has_to_be_beaten_where_there_is_room() {
        let run = |side| ParetoEntry {
            width: side,
            height: side,
            ..recipe("5000 strokes, 1500 iterations, seed 0", 4.0, 24.0)
        };
        let worse = drawing(OWN, "stages 5000 smoothstep seed 0", 0.8, 900, 29.0);
        let holds = |side| comparisons(&[run(side), worse.clone()])[0].holds;
        assert_eq!(holds(300), Holds::Refuted);
        assert_eq!(holds(100), Holds::Not, "2 px per stroke");
    }

    #[test]
    fn an_equal_time_is_that_of_the_fit_it_names() {
        let entries = [
            recipe("100 strokes, time of draft, seed 0", 0.8, 20.0),
            own("best", 9.0, 35.0),
            own("draft", 0.8, 29.0),
        ];
        let comparison = &comparisons(&entries)[0];
        assert!(comparison.figure.starts_with("+9.00 dB"), "{comparison:?}");
    }
}
