//! `strokefit-rig pareto` with VTracer, as a library, among the peers.
//!
//! ```text
//! cargo bench -p rig --bench pareto -- PICTURE... -o DIR [--short | --peers]
//! ```
//!
//! Pictures, folder and results are those of the command, so that either goes on where the other was:
//! with `--peers` only peers are measured, to be added to what the command found.
//! With `--test`, or run as a test, one small picture shows that it runs.
#![allow(clippy::print_stdout, reason = "its output is lines")]

use std::path::{Path, PathBuf};

use rig::bench::child::{Runner, perform};
use rig::bench::measure::go_to_root;
use rig::bench::pareto::{self, Sweep, Work};
use rig::bench::peers::{self, Peer, Traced};
use rig::lab::ResultFolder;
use strokefit::image::Image;
use strokefit::report::Usage;
use strokefit::{Error, ErrorKind, Result};
use vtracer::{ColorImage, Config};

/// Mark of a process that measures one case.
const CASE: &str = "--case";

fn main() -> Result<()> {
    go_to_root().map_err(|e| Error::new(ErrorKind::Io, e.to_string()))?;
    let args: Vec<String> = std::env::args().skip(1).collect();
    if let Some(at) = args.iter().position(|arg| arg == CASE) {
        let measurement = args.get(at + 1).map_or("", String::as_str);
        println!("{}", perform(measurement, &all_peers())?);
        return Ok(());
    }
    // Cargo passes --bench to benchmarks, unless it runs them as tests.
    let is_set = |flag: &str| args.iter().any(|arg| arg == flag);
    if is_set("--bench") && !is_set("--test") {
        measure(&args)
    } else {
        try_out()
    }
}

fn all_peers() -> Vec<Box<dyn Peer>> {
    std::iter::once(Box::new(VTracer) as Box<dyn Peer>)
        .chain(peers::installed())
        .collect()
}

fn measure(args: &[String]) -> Result<()> {
    let refuse = || Error::new(ErrorKind::Config, "give pictures and -o DIR, after --");
    let is_set = |flag: &str| args.iter().any(|arg| arg == flag);
    let at = args.iter().position(|arg| arg == "-o").ok_or_else(refuse)?;
    let folder = args.get(at + 1).ok_or_else(refuse)?;
    let words = [&args[..at], &args[at + 2..]].concat();
    let named = words.into_iter().filter(|word| !word.starts_with("--"));
    let pictures: Vec<PathBuf> = named.map(PathBuf::from).collect();
    if pictures.is_empty() {
        return Err(refuse());
    }
    let work = match (is_set("--peers"), is_set("--short")) {
        (true, _) => Work::Peers,
        (false, true) => Work::Sweep(Sweep::short()),
        (false, false) => Work::Sweep(Sweep::full()),
    };
    run(Path::new(folder), &pictures, &work)
}

fn try_out() -> Result<()> {
    let io = |e: std::io::Error| Error::new(ErrorKind::Io, e.to_string());
    let folder = tempfile::tempdir().map_err(io)?;
    let ramp = |k: usize| {
        (0..48 * 32)
            .map(|i| (i % 48 * k % 48) as f32 / 47.0)
            .collect()
    };
    let picture = folder.path().join("ramp.png");
    let image = Image::new(48, 32, [ramp(1), ramp(2), ramp(5)])?;
    std::fs::write(&picture, image.encode_png()?).map_err(io)?;
    let sweep = Sweep {
        strokes: vec![10],
        article: [20, 5],
        ..Sweep::short()
    };
    run(&folder.path().join("out"), &[picture], &Work::Sweep(sweep))
}

fn run(folder: &Path, pictures: &[PathBuf], work: &Work) -> Result<()> {
    let runner = Runner::new([CASE])?;
    let measure = |case: &_, svg: &_| runner.case(case, svg);
    let mut say = |line: &str| println!("{line}");
    let mut output = ResultFolder::new(folder, true)?;
    let report = pareto::run(folder, pictures, work, &all_peers(), &measure, &mut say)?;
    pareto::publish(&mut output, folder, pictures, &report)?;
    match report.failures() {
        0 => Ok(()),
        n => Err(Error::new(ErrorKind::Config, format!("{n} cases failed"))),
    }
}

/// VTracer at settings from coarse to fine: speckles below a side, bits of a channel, steps of colour,
/// simplification of curves; colour clusters, stacked.
struct VTracer;

/// `[filter_speckle, color_precision, layer_difference]`, and the tolerance of simplification, px.
const SETTINGS: [([usize; 3], Option<f64>); 12] = [
    ([16, 6, 96], Some(2.0)),
    ([10, 8, 48], None),
    ([10, 8, 48], Some(1.5)),
    ([8, 6, 48], Some(1.5)),
    ([6, 6, 32], Some(1.5)),
    ([4, 6, 32], None),
    ([4, 6, 16], Some(1.0)),
    ([4, 6, 16], None),
    ([3, 7, 12], Some(1.0)),
    ([2, 8, 8], Some(1.0)),
    ([2, 8, 8], None),
    ([1, 8, 4], None),
];

impl Peer for VTracer {
    fn name(&self) -> &str {
        "vtracer 1.0"
    }

    fn settings(&self) -> Vec<String> {
        (0..SETTINGS.len()).map(words).collect()
    }

    fn trace(&self, picture: &Image, settings: &str) -> Result<Traced> {
        let refuse =
            |what: String| Error::new(ErrorKind::Config, format!("vtracer {settings}: {what}"));
        let known = (0..SETTINGS.len()).find(|&i| words(i) == settings);
        let ([filter_speckle, bits, step], simplify) =
            SETTINGS[known.ok_or_else(|| refuse("not among its settings".into()))?];
        let config = Config {
            filter_speckle,
            color_precision: bits as i32,
            layer_difference: step as i32,
            simplify,
            path_precision: Some(1),
            optimize: 2,
            ..Config::default()
        };
        let pixels = picture
            .to_rgb8()
            .chunks_exact(3)
            .flat_map(|p| [p[0], p[1], p[2], 255])
            .collect();
        let image = ColorImage {
            pixels,
            width: picture.width(),
            height: picture.height(),
        };
        let svg = config.build().and_then(|pipeline| pipeline.to_svg(&image));
        Ok(Traced {
            svg: svg.map_err(|e| refuse(e.to_string()))?,
            peak_rss_bytes: Usage::now().peak_rss_bytes,
        })
    }
}

fn words(i: usize) -> String {
    let ([speckle, bits, step], simplify) = SETTINGS[i];
    let simplify = simplify.map_or_else(String::new, |px| format!(" simplify {px}"));
    format!("speckle {speckle} precision {bits} step {step}{simplify}")
}
