//! Which drawings are made of a picture.

use std::fs;
use std::path::{Path, PathBuf};

use super::case::{Case, Limit, Method, Preset, stem};
use super::programs::Peer;
use super::unread;
use crate::coverage::CoverageSchedule;
use crate::error::{Error, ErrorKind, Result};
use crate::report::pareto::{OWN, ParetoEntry};

/// What a run does.
#[derive(Debug, Clone, PartialEq)]
pub enum Work {
    /// Fits, the article's recipe and peers.
    Plan(Plan),
    /// Peers alone, at all of their settings.
    Peers,
    /// Scores the SVGs in these folders that are named as the pictures.
    Files(Vec<PathBuf>),
}

/// Which fits are made, and how the article's recipe is run.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Numbers of strokes, at every preset with the first coverage function.
    pub strokes: Vec<usize>,
    /// Presets.
    pub presets: Vec<Preset>,
    /// The first for everything; the others for a draft of the usual number of strokes.
    pub coverages: Vec<CoverageSchedule>,
    /// How many seeds, for a balanced fit of the usual number of strokes.
    pub seeds: u64,
    /// Strokes and iterations of the article's recipe.
    pub article: [usize; 2],
    /// Settings of each peer at most, spread over its own.
    pub peer_settings: usize,
}

/// The number of strokes that coverage functions and seeds are compared at, or the next below.
const USUAL_STROKES: usize = 1000;

/// The article's own strokes and iterations.
const ARTICLE_RUN: [usize; 2] = [5000, 1500];

impl Plan {
    /// Less than a minute for a picture.
    pub fn short() -> Self {
        Self {
            strokes: vec![10, 100, 400],
            presets: vec![Preset::Draft, Preset::Balanced],
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
            presets: vec![
                Preset::Stages,
                Preset::Draft,
                Preset::Balanced,
                Preset::Best,
            ],
            // In a fit all edges are as steep, so that tanh is sigmoid, and atan:K is atan.
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

    fn fits(&self) -> Vec<Method> {
        let fit = |preset, coverage: &CoverageSchedule, strokes, seed| Method::Fit {
            preset,
            coverage: coverage.to_string(),
            strokes,
            seed,
        };
        let Some(first) = self.coverages.first() else {
            return Vec::new();
        };
        let usual = self.usual_strokes();
        // Tails make a fit take ten times as long: a draft shows as well what they do.
        let [quick, balanced] = [Preset::Draft, Preset::Balanced].map(|preset| self.preset(preset));
        let mut fits = Vec::new();
        for &preset in &self.presets {
            let of_strokes = |&strokes: &usize| fit(preset, first, strokes, 0);
            fits.extend(self.strokes.iter().map(of_strokes));
        }
        let others = self.coverages[1..].iter();
        fits.extend(others.map(|coverage| fit(quick, coverage, usual, 0)));
        fits.extend((1..self.seeds).map(|seed| fit(balanced, first, usual, seed)));
        // What the article's recipe is compared with, at its own number of strokes.
        let beside =
            [Preset::Stages, Preset::Draft].map(|preset| fit(preset, first, self.article[0], 0));
        for method in beside {
            if !fits.contains(&method) {
                fits.push(method);
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

    /// `preset`, if it is one of the plan's, or the first of them.
    fn preset(&self, preset: Preset) -> Preset {
        let first = self.presets.first().copied().unwrap_or(preset);
        let is_there = self.presets.contains(&preset);
        if is_there { preset } else { first }
    }
}

/// At most `settings` of each peer's, spread over them.
fn peer_methods(peers: &[Box<dyn Peer>], settings: usize) -> Vec<Method> {
    let methods = peers.iter().flat_map(|peer| {
        let all = peer.settings();
        let step = all.len().div_ceil(settings.max(1)).max(1);
        let name = peer.name().to_owned();
        all.into_iter()
            .step_by(step)
            .map(move |settings| Method::Peer {
                name: name.clone(),
                settings,
            })
    });
    methods.collect()
}

/// Words of this file alone: each is a coverage function.
fn coverages(words: &[&str]) -> Vec<CoverageSchedule> {
    words.iter().filter_map(|word| word.parse().ok()).collect()
}

impl Work {
    /// The drawings of one picture.
    pub(super) fn cases(&self, picture: &Path, peers: &[Box<dyn Peer>]) -> Result<Vec<Case>> {
        let methods = match self {
            Self::Plan(plan) => {
                let [strokes, iterations] = plan.article;
                let article = Method::Article {
                    strokes,
                    limit: Limit::Iterations(iterations),
                    seed: 0,
                };
                let mut methods = plan.fits();
                methods.push(article);
                methods.extend(peer_methods(peers, plan.peer_settings));
                methods
            }
            Self::Peers => peer_methods(peers, usize::MAX),
            Self::Files(folders) => files(folders, picture)?,
        };
        let case = |method| Case {
            picture: picture.to_owned(),
            method,
        };
        Ok(methods.into_iter().map(case).collect())
    }

    /// The article's recipe for as long as our own fits of as many strokes took.
    pub(super) fn at_equal_time(&self, picture: &Path, entries: &[ParetoEntry]) -> Option<Case> {
        let Self::Plan(plan) = self else {
            return None;
        };
        let (name, strokes) = (stem(picture), plan.article[0]);
        let draft = entries.iter().find(|e| {
            let asked = e.label.split(' ').nth(1) == Some(strokes.to_string().as_str());
            e.picture == name
                && e.family == OWN
                && e.preset.as_deref() == Some("draft")
                && e.seed == Some(0)
                && asked
        })?;
        let method = Method::Article {
            strokes,
            limit: Limit::TimeOf {
                preset: Preset::Draft,
                cpu_s: draft.cpu_s?,
            },
            seed: 0,
        };

        Some(Case {
            picture: picture.to_owned(),
            method,
        })
    }
}

/// The SVGs in `folders` that have the picture's name; a family is called as its folder.
fn files(folders: &[PathBuf], picture: &Path) -> Result<Vec<Method>> {
    let name = format!("{}.svg", stem(picture));
    let mut methods = Vec::new();
    for folder in folders {
        let path = folder.join(&name);
        fs::read_dir(folder).map_err(|e| unread(folder, e))?;
        if path.is_file() {
            let family = folder.file_name().unwrap_or(folder.as_os_str());
            methods.push(Method::File {
                family: family.to_string_lossy().into_owned(),
                path,
            });
        }
    }
    if methods.is_empty() {
        let message = format!("no folder of SVGs has a {name}: name the files as the pictures");
        return Err(Error::new(ErrorKind::Config, message));
    }
    Ok(methods)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::pareto::ARTICLE;

    #[test]
    fn the_words_of_this_file_are_understood() {
        assert_eq!(Plan::short().coverages.len(), 2);
        assert_eq!(Plan::full().coverages.len(), 4);
    }

    #[test]
    fn no_drawing_is_planned_twice() {
        for plan in [Plan::short(), Plan::full()] {
            let labels: Vec<String> = plan.fits().iter().map(Method::label).collect();
            let mut unique = labels.clone();
            unique.sort();
            unique.dedup();
            assert_eq!(unique.len(), labels.len(), "{labels:?}");
        }
    }

    #[test]
    fn the_articles_recipe_is_always_there() {
        let plan = Plan {
            strokes: vec![10],
            ..Plan::short()
        };
        let cases = Work::Plan(plan).cases(Path::new("a.png"), &[]).unwrap();
        let families: Vec<_> = cases.iter().map(|c| c.method.family().to_owned()).collect();
        assert!(families.contains(&ARTICLE.to_owned()));
        let beside = cases.iter().filter(|c| c.method.label().contains(" 5000 "));
        assert_eq!(beside.count(), 2, "fits of as many strokes");
    }
}
