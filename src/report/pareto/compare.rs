//! Fronts, and what is claimed of them.

use serde::{Deserialize, Serialize};

use super::{ARTICLE, OWN, ParetoEntry, pictures};

/// What a fit is to gain over the article's recipe at equal strokes, dB.
const LEAST_GAIN_DB: f64 = 6.0;
/// The share of the recipe's CPU time that it may take.
const MOST_TIME: f64 = 0.25;

/// A claim, and whether it holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The picture.
    pub picture: String,
    /// What is claimed.
    pub claim: String,
    /// What was found.
    pub figure: String,
    /// Whether it holds.
    pub holds: Holds,
}

/// Whether a claim holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Holds {
    /// It does.
    Holds,
    /// It does not, which is a finding.
    Not,
    /// It does not, which is a failure.
    Refuted,
}

impl Holds {
    /// The words that a line ends in.
    pub fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Not => "does not hold",
            Self::Refuted => "FAIL",
        }
    }
}

impl Comparison {
    /// The line of standard output, ending in the verdict.
    pub fn line(&self) -> String {
        let Self {
            picture,
            claim,
            figure,
            holds,
        } = self;
        format!("{picture}, {claim}: {figure}: {}", holds.word())
    }
}

/// The entries that no other of `entries` beats in both `cost` (less is better) and `gain` (more is
/// better), by rising cost. Entries without either are left out.
pub fn front<'a>(
    entries: impl IntoIterator<Item = &'a ParetoEntry>,
    cost: impl Fn(&ParetoEntry) -> Option<f64>,
    gain: impl Fn(&ParetoEntry) -> Option<f64>,
) -> Vec<&'a ParetoEntry> {
    let known = entries.into_iter();
    let mut known: Vec<_> = known
        .filter_map(|e| Some((cost(e)?, gain(e)?, e)))
        .collect();
    known.sort_by(|(a, x, _), (b, y, _)| a.total_cmp(b).then(y.total_cmp(x)));
    let mut best = f64::NEG_INFINITY;
    known.retain(|&(_, gain, _)| {
        let better = gain > best;
        best = best.max(gain);
        better
    });
    known.into_iter().map(|(.., entry)| entry).collect()
}

/// What follows from `entries`; a claim of the article's recipe that does not hold is a failure where it
/// is one that `claims`.
pub fn comparisons(entries: &[ParetoEntry], claims: bool) -> Vec<Comparison> {
    let mut all = Vec::new();
    for picture in pictures(entries) {
        let here: Vec<&ParetoEntry> = entries.iter().filter(|e| e.picture == picture).collect();
        all.extend(against_article(picture, &here, claims));
        all.extend(against_peers(picture, &here));
    }
    all
}

/// At equal strokes, and at equal time.
fn against_article(picture: &str, here: &[&ParetoEntry], claims: bool) -> Vec<Comparison> {
    let recipes = here.iter().filter(|e| e.family == ARTICLE);
    recipes
        .filter_map(|recipe| {
            let asked = asked(recipe)?;
            let own = here
                .iter()
                .filter(|e| e.family == OWN && asked_of_fit(e) == Some(asked));
            if recipe.label.contains("time of") {
                at_equal_time(picture, recipe, own)
            } else {
                at_equal_strokes(picture, recipe, own, claims)
            }
        })
        .collect()
}

/// The strokes that the recipe was given: the first word of its label.
fn asked(recipe: &ParetoEntry) -> Option<&str> {
    recipe.label.split(' ').next()
}

/// The strokes that a fit was given: the second word of its label.
fn asked_of_fit(fit: &ParetoEntry) -> Option<&str> {
    fit.label.split(' ').nth(1)
}

fn at_equal_strokes<'a>(
    picture: &str,
    recipe: &ParetoEntry,
    own: impl Iterator<Item = &'a &'a ParetoEntry>,
    claims: bool,
) -> Option<Comparison> {
    let (time, recipe_db) = (recipe.cpu_s?, recipe.psnr_db()?);
    let quick = own.filter(|e| e.cpu_s.is_some_and(|cpu| cpu <= MOST_TIME * time));
    let best = quick.max_by(|a, b| {
        a.psnr_db()
            .unwrap_or(0.0)
            .total_cmp(&b.psnr_db().unwrap_or(0.0))
    });
    let (figure, holds) = match best {
        Some(best) => {
            let gain = best.psnr_db()? - recipe_db;
            let share = best.cpu_s? / time;
            let preset = best.preset.as_deref().unwrap_or_default();
            (
                format!("{gain:+.2} dB ({preset}) in {share:.2} of its CPU time"),
                gain >= LEAST_GAIN_DB,
            )
        }
        None => (
            format!("no fit of as many strokes took {MOST_TIME} of its {time:.2} s"),
            false,
        ),
    };
    Some(Comparison {
        picture: picture.into(),
        claim: format!(
            "{LEAST_GAIN_DB} dB or more over the article's recipe ({}) in {MOST_TIME} or less of its CPU time",
            recipe.label
        ),
        figure,
        holds: match (holds, claims) {
            (true, _) => Holds::Holds,
            (false, true) => Holds::Refuted,
            (false, false) => Holds::Not,
        },
    })
}

fn at_equal_time<'a>(
    picture: &str,
    recipe: &ParetoEntry,
    mut own: impl Iterator<Item = &'a &'a ParetoEntry>,
) -> Option<Comparison> {
    let same = |e: &ParetoEntry| {
        e.preset
            .as_deref()
            .is_some_and(|p| recipe.label.contains(&format!("time of {p},")))
    };
    let fit = own.find(|e| same(e) && e.seed == recipe.seed)?;
    let gain = fit.psnr_db()? - recipe.psnr_db()?;
    let (ours, theirs) = (fit.cpu_s?, recipe.cpu_s?);
    Some(Comparison {
        picture: picture.into(),
        claim: format!(
            "better than the article's recipe at equal CPU time ({})",
            recipe.label
        ),
        figure: format!("{gain:+.2} dB, {ours:.2} s against {theirs:.2} s"),
        holds: if gain > 0.0 { Holds::Holds } else { Holds::Not },
    })
}

/// Our best drawing of no more bytes after gzip against each drawing on the peer's own front.
fn against_peers(picture: &str, here: &[&ParetoEntry]) -> Vec<Comparison> {
    let mut peers: Vec<&str> = Vec::new();
    for entry in here {
        if entry.family != OWN && entry.family != ARTICLE && !peers.contains(&entry.family.as_str())
        {
            peers.push(&entry.family);
        }
    }
    let gzip = |e: &ParetoEntry| Some(e.gzip_bytes as f64);
    peers
        .into_iter()
        .filter_map(|peer| {
            let theirs = here.iter().copied().filter(|e| e.family == peer);
            let theirs = front(theirs, gzip, ParetoEntry::psnr_db);
            (!theirs.is_empty()).then(|| dominance(picture, peer, here, &theirs))
        })
        .collect()
}

fn dominance(
    picture: &str,
    peer: &str,
    here: &[&ParetoEntry],
    theirs: &[&ParetoEntry],
) -> Comparison {
    let (mut gains, mut losses) = (Vec::new(), Vec::new());
    for other in theirs {
        let own = here
            .iter()
            .filter(|e| e.family == OWN && e.gzip_bytes <= other.gzip_bytes);
        let best = own.filter_map(|e| e.psnr_db()).reduce(f64::max);
        let kilobytes = other.gzip_bytes as f64 / 1000.0;
        match (best, other.psnr_db()) {
            (Some(best), Some(db)) if best >= db => gains.push(best - db),
            (Some(best), Some(db)) => {
                losses.push(format!("{kilobytes:.1} kB ({:.2} dB)", best - db))
            }
            _ => losses.push(format!("{kilobytes:.1} kB (none of ours is as small)")),
        }
    }
    let range = match (
        gains.iter().copied().reduce(f64::min),
        gains.iter().copied().reduce(f64::max),
    ) {
        (Some(least), Some(most)) => format!(" by {least:.2} to {most:.2} dB"),
        _ => String::new(),
    };
    let but = if losses.is_empty() {
        String::new()
    } else {
        format!("; not at {}", losses.join(", "))
    };
    Comparison {
        picture: picture.into(),
        claim: format!("as faithful as {peer} at equal bytes after gzip"),
        figure: format!(
            "above it at {} of {} points of its front{range}{but}",
            gains.len(),
            theirs.len()
        ),
        holds: if losses.is_empty() {
            Holds::Holds
        } else {
            Holds::Not
        },
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawing;
    use super::*;

    fn own(preset: &str, cpu_s: f64, gzip_bytes: usize, psnr_db: f64) -> ParetoEntry {
        ParetoEntry {
            preset: Some(preset.into()),
            ..drawing(
                OWN,
                &format!("{preset} 100 smoothstep seed 0"),
                cpu_s,
                gzip_bytes,
                psnr_db,
            )
        }
    }

    #[test]
    fn a_front_has_what_nothing_beats() {
        let entries = [
            own("a", 3.0, 300, 31.0),
            own("b", 1.0, 100, 30.0),
            own("c", 2.0, 200, 29.0),
            own("d", 1.0, 100, 28.0),
        ];
        let front = front(&entries, |e| e.cpu_s, ParetoEntry::psnr_db);
        let presets: Vec<_> = front.iter().filter_map(|e| e.preset.as_deref()).collect();
        assert_eq!(presets, ["b", "a"]);
    }

    #[test]
    fn only_quick_fits_count_against_the_article() {
        let recipe = drawing(
            ARTICLE,
            "100 strokes, 1500 iterations, seed 0",
            4.0,
            900,
            24.0,
        );
        let slow = own("best", 2.0, 900, 35.0);
        let quick = own("draft", 0.8, 900, 29.0);
        let holds = |entries: &[ParetoEntry], claims| comparisons(entries, claims)[0].holds;
        let entries = [recipe.clone(), slow.clone(), quick];
        assert_eq!(
            holds(&entries, true),
            Holds::Refuted,
            "only 5 dB in a fifth"
        );
        assert_eq!(holds(&entries, false), Holds::Not);
        let better = own("draft", 1.0, 900, 30.0);
        assert_eq!(holds(&[recipe, slow, better], true), Holds::Holds);
    }

    #[test]
    fn an_equal_time_is_that_of_the_fit_it_names() {
        let recipe = drawing(
            ARTICLE,
            "100 strokes, time of draft, seed 0",
            0.8,
            900,
            20.0,
        );
        let entries = [
            recipe,
            own("draft", 0.8, 900, 29.0),
            own("best", 9.0, 900, 35.0),
        ];
        let comparison = &comparisons(&entries, true)[0];
        assert!(comparison.figure.starts_with("+9.00 dB"), "{comparison:?}");
    }

    #[test]
    fn where_a_peer_is_better_is_said() {
        let peer = |gzip, db| drawing("vtracer", "x", 0.1, gzip, db);
        let entries = [
            own("draft", 1.0, 1000, 25.0),
            own("draft", 1.0, 9000, 31.0),
            peer(500, 22.0),
            peer(1500, 26.0),
            peer(9500, 30.0),
        ];
        let comparison = &comparisons(&entries, true)[0];
        assert_eq!(comparison.holds, Holds::Not);
        for words in [
            "at 1 of 3",
            "by 1.00 to 1.00 dB",
            "0.5 kB (none",
            "1.5 kB (-1.00 dB)",
        ] {
            assert!(comparison.figure.contains(words), "{comparison:?}");
        }
    }
}
