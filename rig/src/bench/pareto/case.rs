//! One drawing: who makes it, how, and what it costs and gains.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Instant;
use std::{fmt, fs};

use serde::{Deserialize, Serialize};

use crate::bench::files::{self, stem};
use crate::bench::peers::Peer;
use crate::lab::article::{Capsules, Reproduction};
use crate::lab::unwritten;
use crate::report::pareto::ParetoEntry;
use strokefit::coverage::{Coverage, CoverageSchedule};
use strokefit::fit::{Budget, Config, Execution, Fitter, Preset, StageRecord};
use strokefit::image::Image;
use strokefit::metrics::Agreement;
use strokefit::report::{Usage, gzip_bytes};
use strokefit::svg::{self, WriteOptions};
use strokefit::verify::{self, MIN_AGREEMENT_DB};
use strokefit::{Error, ErrorKind, Result};

const WHITE: [f32; 3] = [1.0; 3];

/// Iterations of the article's recipe between two readings of the clock.
const CLOCK_EVERY: usize = 10;

/// One drawing to make.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// The picture's file.
    pub picture: PathBuf,
    /// Who makes it, and how.
    pub maker: Maker,
}

/// Who makes a drawing, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Maker {
    /// A fit.
    Fit {
        /// Amount of work.
        effort: Effort,
        /// The coverage function or mix, in its own words.
        coverage: String,
        /// Number of strokes.
        strokes: usize,
        /// Key of every random draw.
        seed: u64,
    },
    /// The recipe of the article: all strokes at once, from a random start.
    Article {
        /// Number of strokes.
        strokes: usize,
        /// Number of iterations, or as many as fit in a time.
        limit: Limit,
        /// Key of the random start.
        seed: u64,
    },
    /// Another program, or a library of another project.
    Peer {
        /// The peer's name.
        name: String,
        /// Its settings, in its own words.
        settings: String,
    },
    /// A file that is there already.
    File {
        /// Whose it is.
        family: String,
        /// The SVG.
        path: PathBuf,
    },
}

/// Amount of work that a fit spends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effort {
    /// The stages of a draft, without polish.
    Stages,
    /// `--preset draft`
    Draft,
    /// `--preset balanced`
    Balanced,
    /// `--preset best`
    Best,
}

impl Effort {
    /// Every effort, the least first.
    pub const ALL: [Self; 4] = [Self::Stages, Self::Draft, Self::Balanced, Self::Best];

    /// The preset that it takes its recipe from.
    fn preset(self) -> Preset {
        match self {
            Self::Stages | Self::Draft => Preset::Draft,
            Self::Balanced => Preset::Balanced,
            Self::Best => Preset::Best,
        }
    }
}

impl fmt::Display for Effort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stages => f.write_str("stages"),
            Self::Draft | Self::Balanced | Self::Best => self.preset().fmt(f),
        }
    }
}

impl FromStr for Effort {
    type Err = Error;

    /// `stages`, or the word of a preset.
    fn from_str(text: &str) -> Result<Self> {
        let mut all = Self::ALL.into_iter();
        all.find(|effort| effort.to_string() == text)
            .ok_or_else(|| {
                let right = "stages, draft, balanced or best";
                Error::new(
                    ErrorKind::Config,
                    format!("'{text}' is not a preset: give {right}"),
                )
            })
    }
}

/// When the article's recipe ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Limit {
    /// After so many iterations.
    Iterations(usize),
    /// After as much CPU time as the fit with this effort and as many strokes took.
    TimeOf {
        /// The fit.
        effort: Effort,
        /// CPU time that it took, s.
        cpu_s: f64,
    },
}

/// A drawing as its maker left it.
struct Made {
    text: String,
    strokes: Option<usize>,
    soft: Option<Image>,
    stages: Vec<StageRecord>,
    /// Peak memory of another program, bytes.
    peak_rss_bytes: Option<u64>,
}

impl Made {
    fn file(text: String) -> Self {
        Self {
            text,
            strokes: None,
            soft: None,
            stages: Vec::new(),
            peak_rss_bytes: None,
        }
    }
}

impl Maker {
    /// Whose drawing it is.
    pub fn family(&self) -> &str {
        match self {
            Self::Fit { .. } => "strokefit",
            Self::Article { .. } => "article",
            Self::Peer { name, .. } => name,
            Self::File { family, .. } => family,
        }
    }

    /// Tells it apart from other drawings of its family.
    pub fn label(&self) -> String {
        match self {
            Self::Fit {
                effort,
                coverage,
                strokes,
                seed,
            } => format!("{effort} {strokes} {coverage} seed {seed}"),
            Self::Article {
                strokes,
                limit,
                seed,
            } => match limit {
                Limit::Iterations(n) => format!("{strokes} strokes, {n} iterations, seed {seed}"),
                Limit::TimeOf { effort, .. } => {
                    format!("{strokes} strokes, time of {effort}, seed {seed}")
                }
            },
            Self::Peer { settings, .. } => settings.clone(),
            Self::File { .. } => "file".into(),
        }
    }

    fn draw(&self, picture: &Image, peers: &[Box<dyn Peer>]) -> Result<Made> {
        match self {
            Self::Fit {
                effort,
                coverage,
                strokes,
                seed,
            } => fitted(picture, *effort, coverage.parse()?, *strokes, *seed),
            Self::Article {
                strokes,
                limit,
                seed,
            } => article(picture, *strokes, *limit, *seed),
            Self::Peer { name, settings } => {
                let peer = peers.iter().find(|peer| peer.name() == name);
                let peer = peer.ok_or_else(|| {
                    Error::new(
                        ErrorKind::Config,
                        format!("{name}: not installed: install it"),
                    )
                })?;
                let traced = peer.trace(picture, settings)?;
                Ok(Made {
                    peak_rss_bytes: traced.peak_rss_bytes,
                    ..Made::file(traced.svg)
                })
            }
            Self::File { path, .. } => read(path).map(Made::file),
        }
    }
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).map_err(|e| {
        let message = format!("{}: cannot be read ({e}): give an SVG file", path.display());
        Error::new(ErrorKind::Io, message)
    })
}

fn fitted(
    picture: &Image,
    effort: Effort,
    coverage: CoverageSchedule,
    strokes: usize,
    seed: u64,
) -> Result<Made> {
    let config = Config {
        budget: Budget {
            strokes: Some(strokes),
            ..Budget::default()
        },
        preset: effort.preset(),
        polish: effort != Effort::Stages,
        coverage,
        seed,
        ..Config::default()
    };
    let fit = Fitter::new(config).fit(picture)?;
    Ok(Made {
        text: svg::write(&fit.scene, &WriteOptions::default()),
        strokes: Some(fit.scene.len()),
        soft: Some(fit.soft),
        stages: fit.stages.clone(),
        peak_rss_bytes: None,
    })
}

fn article(picture: &Image, strokes: usize, limit: Limit, seed: u64) -> Result<Made> {
    let start = Capsules::random(picture.width(), picture.height(), strokes, seed);
    let mut descent = Reproduction::new(picture, start, Execution::default())?;
    let meter = Meter::start();
    let goes_on = |step: usize| match limit {
        Limit::Iterations(n) => step < n,
        Limit::TimeOf { cpu_s, .. } => {
            !step.is_multiple_of(CLOCK_EVERY) || meter.cost().cpu_s.is_none_or(|used| used < cpu_s)
        }
    };
    let mut step = 0;
    while goes_on(step) {
        descent.step(Coverage::Smoothstep);
        step += 1;
    }
    let scene = descent.drawing().scene();
    // Strokes may end up thinner than a file can have them, so the soft render is not compared with the file.
    Ok(Made {
        strokes: Some(scene.quantized(2).scene.len()),
        ..Made::file(svg::write(&scene, &WriteOptions::default()))
    })
}

/// Time and memory used since its start.
struct Meter {
    start: Instant,
    before: Usage,
}

#[derive(Debug, Clone, Copy)]
struct Cost {
    wall_s: f64,
    /// CPU time of this process and of the children it waited for; `None` where the system does not report it.
    cpu_s: Option<f64>,
    peak_rss_bytes: Option<u64>,
}

impl Meter {
    fn start() -> Self {
        Self {
            start: Instant::now(),
            before: Usage::now(),
        }
    }

    fn cost(&self) -> Cost {
        let wall_s = self.start.elapsed().as_secs_f64();
        let now = Usage::now();
        let all = |usage: Usage| Some(usage.cpu_s? + usage.children_cpu_s?);
        Cost {
            wall_s,
            cpu_s: all(now)
                .zip(all(self.before))
                .map(|(now, before)| now - before),
            peak_rss_bytes: now.peak_rss_bytes,
        }
    }
}

impl Case {
    /// The record of this case before anything is known of the drawing.
    pub fn entry(&self, picture: &Image) -> ParetoEntry {
        let (preset, coverage, seed) = match &self.maker {
            Maker::Fit {
                effort,
                coverage,
                seed,
                ..
            } => (
                Some(effort.to_string()),
                Some(coverage.clone()),
                Some(*seed),
            ),
            Maker::Article { seed, .. } => (None, None, Some(*seed)),
            Maker::Peer { .. } | Maker::File { .. } => (None, None, None),
        };
        ParetoEntry {
            picture: stem(&self.picture),
            digest: digest(picture),
            width: picture.width(),
            height: picture.height(),
            family: self.maker.family().into(),
            label: self.maker.label(),
            preset,
            coverage,
            seed,
            ..ParetoEntry::default()
        }
    }

    /// Makes the drawing, writes it to `svg_to` and measures it. Memory is that of this process.
    ///
    /// # Errors
    /// When it cannot be made, written or drawn.
    pub fn measure(&self, svg_to: &Path, peers: &[Box<dyn Peer>]) -> Result<ParetoEntry> {
        let picture = open(&self.picture)?;
        let meter = Meter::start();
        let drawn = self.maker.draw(&picture, peers)?;
        let cost = meter.cost();
        fs::write(svg_to, &drawn.text).map_err(|e| unwritten(svg_to, e))?;
        let shown = verify::fidelity(&drawn.text, &picture)?;
        let agreement = drawn.soft.as_ref().map(|soft| agreement(&drawn.text, soft));
        let agreement_db = agreement.transpose()?.map(|a| a.psnr_db);
        let timed = !matches!(self.maker, Maker::File { .. });
        let foreign = matches!(self.maker, Maker::Peer { .. });
        Ok(ParetoEntry {
            strokes: drawn.strokes,
            wall_s: timed.then_some(cost.wall_s),
            cpu_s: cost.cpu_s.filter(|_| timed),
            peak_rss_bytes: if foreign { drawn.peak_rss_bytes } else { cost.peak_rss_bytes.filter(|_| timed) },
            svg_bytes: drawn.text.len(),
            gzip_bytes: gzip_bytes(&drawn.text),
            fidelity: Some(shown),
            agreement_db,
            failure: agreement_db.filter(|db| *db < MIN_AGREEMENT_DB).map(|db| {
                format!("resvg's render agrees with the fit to {db:.1} dB, less than {MIN_AGREEMENT_DB} dB")
            }),
            stages: drawn.stages,
            ..self.entry(&picture)
        })
    }
}

fn agreement(text: &str, soft: &Image) -> Result<Agreement> {
    let size = verify::Size::Exact {
        width: soft.width() as u32,
        height: soft.height() as u32,
    };
    Agreement::between(soft, &verify::render(text, size, Some(WHITE))?)
}

/// The picture as every maker gets it: transparency laid on white.
pub(super) fn open(path: &Path) -> Result<Image> {
    Ok(Image::open(path)?.flattened(WHITE))
}

/// A short hash of the picture's size and pixels, which tells pictures of one name apart.
pub(super) fn digest(picture: &Image) -> String {
    files::digest(&[&picture.width().to_le_bytes(), &picture.to_rgb8()])
}
