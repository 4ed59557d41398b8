//! Which drawings of a picture are made and measured.

use std::fs;
use std::path::{Path, PathBuf};

use super::case::{Case, Effort, Limit, Maker};
use super::unread;
use crate::bench::files::stem;
use crate::bench::peers::Peer;
use crate::report::pareto::{OWN, ParetoEntry};
use strokefit::coverage::CoverageSchedule;
use strokefit::{Error, ErrorKind, Result};

/// Measurements of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Work {
    /// Fits, the article's recipe and peers.
    Sweep(Sweep),
    /// Peers alone, at all of their settings.
    Peers,
    /// Scores the SVGs in these folders that are named as the pictures.
    Files(Vec<PathBuf>),
}

/// Which fits are made, and how the article's recipe is run.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Numbers of strokes, with every effort and the first coverage function.
    pub strokes: Vec<usize>,
    /// Amounts of work that the fits spend.
    pub efforts: Vec<Effort>,
    /// The first for everything; the others for a draft of the usual number of strokes.
    pub coverages: Vec<CoverageSchedule>,
    /// Number of seeds, for a balanced fit of the usual number of strokes.
    pub seeds: u64,
    /// Strokes and iterations of the article's recipe.
    pub article: [usize; 2],
    /// Most settings of each peer, spread over all that it has.
    pub peer_settings: usize,
}

/// The number of strokes that coverage functions and seeds are compared at, or the next below.
const USUAL_STROKES: usize = 1000;

/// The article's own strokes and iterations.
const ARTICLE_RUN: [usize; 2] = [5000, 1500];

impl Sweep {
    /// Less than a minute for a picture.
    pub fn short() -> Self {
        Self {
            strokes: vec![10, 100, 400],
            efforts: vec![Effort::Draft, Effort::Balanced],
            coverages: coverages(&["smoothstep", "sigmoid>smoothstep"]),
            seeds: 2,
            article: ARTICLE_RUN,
            peer_settings: 3,
        }
    }

    /// All of it: two to four minutes for a picture of 300 px.
    pub fn full() -> Self {
        Self {
            strokes: vec![10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000],
            efforts: vec![
                Effort::Stages,
                Effort::Draft,
                Effort::Balanced,
                Effort::Best,
            ],
            // Softness fixes the slope of the edge, so that in a fit tanh is sigmoid and atan:K is atan.
            coverages: coverages(&[
                "smoothstep",
                "raw>smoothstep",
                "sigmoid>smoothstep",
                "atan>smoothstep",
            ]),
            seeds: 5,
            article: ARTICLE_RUN,
            peer_settings: usize::MAX,
        }
    }

    fn fits(&self) -> Vec<Maker> {
        let fit = |effort, coverage: &CoverageSchedule, strokes, seed| Maker::Fit {
            effort,
            coverage: coverage.to_string(),
            strokes,
            seed,
        };
        let Some(first) = self.coverages.first() else {
            return Vec::new();
        };
        let usual = self.usual_strokes();
        // Functions with tails make a fit ten times as slow, and a draft shows their effect as well.
        let [quick, balanced] = [Effort::Draft, Effort::Balanced].map(|effort| self.effort(effort));
        let mut fits = Vec::new();
        for &effort in &self.efforts {
            let of_strokes = |&strokes: &usize| fit(effort, first, strokes, 0);
            fits.extend(self.strokes.iter().map(of_strokes));
        }
        let others = self.coverages[1..].iter();
        fits.extend(others.map(|coverage| fit(quick, coverage, usual, 0)));
        fits.extend((1..self.seeds).map(|seed| fit(balanced, first, usual, seed)));
        // Fits to compare the article's recipe with, at its own number of strokes.
        let beside =
            [Effort::Stages, Effort::Draft].map(|effort| fit(effort, first, self.article[0], 0));
        for maker in beside {
            if !fits.contains(&maker) {
                fits.push(maker);
            }
        }
        fits
    }

    /// The largest number up to the usual one, or the smallest there is.
    fn usual_strokes(&self) -> usize {
        let up_to = self.strokes.iter().filter(|&&n| n <= USUAL_STROKES);
        let usual = up_to.max().or(self.strokes.iter().min());
        usual.copied().unwrap_or(USUAL_STROKES)
    }

    /// `effort`, if it is one of the sweep's, or the first of them.
    fn effort(&self, effort: Effort) -> Effort {
        let first = self.efforts.first().copied().unwrap_or(effort);
        let is_there = self.efforts.contains(&effort);
        if is_there { effort } else { first }
    }
}

/// At most `settings` of each peer's, spread over them.
fn peer_makers(peers: &[Box<dyn Peer>], settings: usize) -> Vec<Maker> {
    let makers = peers.iter().flat_map(|peer| {
        let all = peer.settings();
        let step = all.len().div_ceil(settings.max(1)).max(1);
        let name = peer.name().to_owned();
        all.into_iter()
            .step_by(step)
            .map(move |settings| Maker::Peer {
                name: name.clone(),
                settings,
            })
    });
    makers.collect()
}

/// Parses words of this file, each of which is a coverage function.
fn coverages(words: &[&str]) -> Vec<CoverageSchedule> {
    words.iter().filter_map(|word| word.parse().ok()).collect()
}

impl Work {
    /// The drawings of one picture.
    pub(super) fn cases(&self, picture: &Path, peers: &[Box<dyn Peer>]) -> Result<Vec<Case>> {
        let makers = match self {
            Self::Sweep(sweep) => {
                let [strokes, iterations] = sweep.article;
                let article = Maker::Article {
                    strokes,
                    limit: Limit::Iterations(iterations),
                    seed: 0,
                };
                let mut makers = sweep.fits();
                makers.push(article);
                makers.extend(peer_makers(peers, sweep.peer_settings));
                makers
            }
            Self::Peers => peer_makers(peers, usize::MAX),
            Self::Files(folders) => files(folders, picture)?,
        };
        let case = |maker| Case {
            picture: picture.to_owned(),
            maker,
        };
        Ok(makers.into_iter().map(case).collect())
    }

    /// The article's recipe, run for as long as our own fit with as many strokes took.
    pub(super) fn at_equal_time(&self, picture: &Path, entries: &[ParetoEntry]) -> Option<Case> {
        let Self::Sweep(sweep) = self else {
            return None;
        };
        let (name, strokes) = (stem(picture), sweep.article[0]);
        let draft = entries.iter().find(|e| {
            let asked = e.label.split(' ').nth(1) == Some(strokes.to_string().as_str());
            e.picture == name
                && e.family == OWN
                && e.preset.as_deref() == Some("draft")
                && e.seed == Some(0)
                && asked
        })?;
        let maker = Maker::Article {
            strokes,
            limit: Limit::TimeOf {
                effort: Effort::Draft,
                cpu_s: draft.cpu_s?,
            },
            seed: 0,
        };

        Some(Case {
            picture: picture.to_owned(),
            maker,
        })
    }
}

/// SVGs in `folders` that have the picture's name; a family is named as its folder.
fn files(folders: &[PathBuf], picture: &Path) -> Result<Vec<Maker>> {
    let name = format!("{}.svg", stem(picture));
    let mut makers = Vec::new();
    for folder in folders {
        let path = folder.join(&name);
        fs::read_dir(folder).map_err(|e| unread(folder, e))?;
        if path.is_file() {
            let family = folder.file_name().unwrap_or(folder.as_os_str());
            makers.push(Maker::File {
                family: family.to_string_lossy().into_owned(),
                path,
            });
        }
    }
    if makers.is_empty() {
        let message = format!(
            "no folder of SVGs has a file {name}: give the files the names of the pictures"
        );
        return Err(Error::new(ErrorKind::Config, message));
    }
    Ok(makers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::pareto::ARTICLE;

    #[test]
    fn the_words_of_this_file_are_understood() {
        assert_eq!(Sweep::short().coverages.len(), 2);
        assert_eq!(Sweep::full().coverages.len(), 4);
    }

    #[test]
    fn no_drawing_is_planned_twice() {
        for sweep in [Sweep::short(), Sweep::full()] {
            let labels: Vec<String> = sweep.fits().iter().map(Maker::label).collect();
            let mut unique = labels.clone();
            unique.sort();
            unique.dedup();
            assert_eq!(unique.len(), labels.len(), "{labels:?}");
        }
    }

    #[test]
    fn the_articles_recipe_is_always_there() {
        let sweep = Sweep {
            strokes: vec![10],
            ..Sweep::short()
        };
        let cases = Work::Sweep(sweep).cases(Path::new("a.png"), &[]).unwrap();
        let families: Vec<_> = cases.iter().map(|c| c.maker.family().to_owned()).collect();
        assert!(families.contains(&ARTICLE.to_owned()));
        let beside = cases.iter().filter(|c| c.maker.label().contains(" 5000 "));
        assert_eq!(beside.count(), 2, "fits of as many strokes");
    }
}
