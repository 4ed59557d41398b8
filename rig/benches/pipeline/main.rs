//! One benchmark per step of the pipeline, in the order of the steps.
//!
//! ```text
//! cargo bench -p rig --bench pipeline [-- FILTER]
//! ```
//!
//! Strokes are random where a step takes strokes, so that a figure moves when the step does and
//! not when the recipe of the fit is tuned. All cores are used, as in a fit.
//!
//! The steps `render/` are measured on random drawings of strokes of one size and on finished ones, on 1, 2, … threads, and the last
//! drawing at each SIMD level. Their throughput is in *pairs*: a stroke and a pixel of the picture where its coverage is above 0,
//! hidden or not; a pixel that several segments of one path cover is one pair. A *lane* is what the renderer does look at: blocks
//! visited × 16.
#![allow(clippy::unwrap_used, reason = "a benchmark that fails may stop")]
#![allow(clippy::print_stdout, reason = "the work in drawings is told")]

mod count;

use std::fs;
use std::hint::black_box;
use std::time::Duration;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput};
use fearless_simd::Level;

use count::{Count, LANES};
use rig::bench::measure::{DEPTH, EDGE, StrokeSize, go_to_root};
use rig::bench::scaling::thread_counts;
use strokefit::fit::{Budget, Config, Fitter, Objective, Simd};
use strokefit::image::{Image, Limits};
use strokefit::loss::Loss;
use strokefit::metrics;
use strokefit::optim::{Adam, AdamParams};
use strokefit::render::{
    Backdrop, Canvas, Gradients, PARAMS, Renderer, StrokeRef, Strokes, flattened,
};
use strokefit::scene::{PointKind, Scene, Stage};
use strokefit::seed::{Pyramid, Residual, Wanted, propose};
use strokefit::svg::{self, WriteOptions};
use strokefit::verify;

const PICTURE: &str = "samples/coffee-550x220.png";

/// Pictures of whole fits: a photograph with smooth shading, one with texture, flat art with alpha.
const FITTED: [&str; 3] = ["coffee-550x220", "chelsea-cat", "noto-gem"];

/// Strokes of a drawing, where nothing else is said.
const STROKES: usize = 5000;

const BACKDROP: [f32; 3] = [0.5; 3];

const fn strokes_of(radius_px: f32, length_px: f32) -> StrokeSize {
    StrokeSize {
        radius_px,
        length_px,
        opacity: 0.65,
    }
}

const THIN: StrokeSize = strokes_of(0.9, 5.0);
const MEDIUM: StrokeSize = strokes_of(2.5, 10.0);
/// Sizes of random strokes: radius and length, px; each opaque and half opaque.
const SIZES: [(&str, f32, f32); 3] = [
    ("thin", 0.7, 12.0),
    ("medium", 3.0, 14.0),
    ("large", 12.0, 40.0),
];
const OPACITIES: [f32; 2] = [1.0, 0.5];

fn main() {
    go_to_root().unwrap();
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .configure_from_args();
    let image = Image::open(PICTURE).unwrap();
    picture(&mut criterion, &image);
    seed(&mut criterion, &image);
    render(&mut criterion, &image);
    optim(&mut criterion, &image);
    drawing(&mut criterion, &image);
    fits(&mut criterion);
    criterion.final_summary();
}

fn picture(criterion: &mut Criterion, image: &Image) {
    let bytes = fs::read(PICTURE).unwrap();
    let mut group = criterion.benchmark_group("picture");
    group.throughput(Throughput::Elements(pixels(image)));
    group.bench_function("decode_png", |b| {
        b.iter(|| Image::decode(black_box(&bytes), PICTURE, Limits::default()).unwrap());
    });
    group.bench_function("encode_png", |b| {
        b.iter(|| black_box(image).encode_png().unwrap());
    });
    group.finish();
}

fn seed(criterion: &mut Criterion, image: &Image) {
    let mut group = criterion.benchmark_group("seed");
    group.bench_function("pyramid", |b| {
        b.iter_batched(|| image.clone(), Pyramid::new, BatchSize::LargeInput);
    });
    let level = Simd::Auto.level().unwrap();
    let canvas = Canvas::flat(Canvas::from_image(image).grid(), BACKDROP);
    let pyramid = Pyramid::new(image.clone());
    for count in [100, STROKES] {
        let wanted = Wanted {
            count,
            // Typical radius when `count` strokes share the picture.
            scale: 0.4 * (pixels(image) as f32 / count as f32).sqrt(),
            min_opacity: 0.1,
            level: 0,
            key: [0, 0],
        };
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function(BenchmarkId::new("propose", count), |b| {
            let residual = Residual {
                target: &pyramid,
                canvas: &canvas,
                weights: None,
            };
            b.iter(|| propose(level, black_box(&[residual]), wanted));
        });
    }
    group.finish();
}

fn render(criterion: &mut Criterion, image: &Image) {
    let target = Canvas::from_image(image);
    let grid = target.grid();
    let mut drawings = Vec::new();
    for (name, radius_px, length_px) in SIZES {
        for opacity in OPACITIES {
            let size = StrokeSize {
                radius_px,
                length_px,
                opacity,
            };
            let count = DEPTH * pixels(image) as f32 / size.area_px();
            let strokes = size.strokes(grid, count as usize);
            drawings.push((format!("{name} {opacity:.1}"), strokes, BACKDROP));
        }
    }
    drawings.push(settled("settled 2", Some(2), image));
    drawings.push(settled("settled", None, image));
    let best = Simd::Auto.level().unwrap();
    for (name, strokes, backdrop) in &drawings {
        for threads in thread_counts() {
            let name = format!("{name}, {threads} threads");
            passes(
                criterion,
                &name,
                strokes,
                *backdrop,
                &target,
                (best, threads),
            );
        }
    }
    let (_, strokes, backdrop) = drawings.last().unwrap();
    for simd in Simd::available() {
        let name = format!("settled, {simd}");
        let level = simd.level().unwrap();
        passes(criterion, &name, strokes, *backdrop, &target, (level, 1));
    }
}

/// A fit of the picture, as it is when finished, of strokes of at most `points` points. Curves are polylines, as the renderer
/// draws them.
fn settled(name: &str, points: Option<usize>, image: &Image) -> (String, Strokes, [f32; 3]) {
    let is_test = std::env::args().any(|arg| arg == "--test");
    let config = Config {
        budget: Budget {
            strokes: Some(if is_test { 50 } else { STROKES }),
            ..Budget::default()
        },
        points,
        polish: !is_test,
        ..Config::default()
    };
    let scene = Fitter::new(config).fit(image).unwrap().scene;
    let paths: Strokes = scene.marks().collect();
    let mut strokes = Strokes::new();
    for path in paths.iter() {
        let points = flattened(path);
        strokes.push(StrokeRef {
            points: &points,
            kinds: &vec![PointKind::On; points.len()],
            closed: false,
            rings: &[],
            form: None,
            paint: None,
            sweep: None,
            style: path.style,
        });
    }
    (name.into(), strokes, scene.background.unwrap_or([1.0; 3]))
}

/// Forward and both backward passes of `strokes` at a SIMD level and on so many threads.
fn passes(
    criterion: &mut Criterion,
    name: &str,
    strokes: &Strokes,
    backdrop: [f32; 3],
    target: &Canvas,
    (level, threads): (Level, usize),
) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.build().unwrap();
    let mut renderer = pool.install(|| Renderer::new(target.grid(), level));
    let backdrop = Backdrop::Color(backdrop);
    let objective = Objective::new(Loss::L2, target);
    let mut gradients = Gradients::default();
    renderer.backward(strokes, EDGE, backdrop, &objective, &mut gradients);
    let count = Count::of(target.grid(), strokes);
    // The work counted is the work done, up to rounding at the borders of blocks.
    let (done, counted) = (gradients.blocks as f64, count.blocks() as f64);
    assert!(
        (done / counted - 1.0).abs() < 0.01,
        "{name}: {done} blocks, {counted} counted"
    );
    let lanes = (count.blocks() * LANES) as f64 / count.pairs as f64;
    println!(
        "{name}: {} strokes, {} pairs, {lanes:.2} lanes each",
        strokes.len(),
        count.pairs
    );

    let mut group = criterion.benchmark_group("render");
    group.throughput(Throughput::Elements(count.pairs));
    let mut canvas = Canvas::flat(target.grid(), BACKDROP);
    group.bench_function(BenchmarkId::new("forward", name), |b| {
        let strokes = black_box(strokes);
        let mut pass = || renderer.forward(strokes, EDGE, backdrop, &mut canvas);
        b.iter(|| pool.install(&mut pass));
    });
    group.bench_function(BenchmarkId::new("backward", name), |b| {
        let strokes = black_box(strokes);
        let mut pass = || renderer.backward(strokes, EDGE, backdrop, &objective, &mut gradients);
        b.iter(|| pool.install(&mut pass));
    });
    group.bench_function(BenchmarkId::new("backward_with_worth", name), |b| {
        let strokes = black_box(strokes);
        let mut pass = || {
            renderer.backward_with_contributions(
                strokes,
                EDGE,
                backdrop,
                &objective,
                &mut gradients,
            );
        };
        b.iter(|| pool.install(&mut pass));
    });
    group.finish();
}

fn optim(criterion: &mut Criterion, image: &Image) {
    let grid = Canvas::from_image(image).grid();
    let mut strokes = THIN.strokes(grid, STROKES);
    let gradients = MEDIUM.strokes(grid, STROKES);
    let scales = [1.0; PARAMS].repeat(STROKES);
    let mut adam = Adam::new(STROKES * PARAMS, AdamParams::default());
    let mut group = criterion.benchmark_group("optim");
    group.throughput(Throughput::Elements(STROKES as u64));
    group.bench_function(BenchmarkId::new("adam_step", STROKES), |b| {
        let gradients = black_box(gradients.numbers());
        b.iter(|| adam.step_scaled(strokes.numbers_mut(), gradients, 1e-6, &scales));
    });
    group.finish();
}

/// Times the work on a finished drawing: to write, read, render and judge it.
fn drawing(criterion: &mut Criterion, image: &Image) {
    let scene = scene(image);
    let options = WriteOptions::default();
    let text = svg::write(&scene, &options);
    let drawn = verify::render(&text, verify::Size::Scale(1.0), Some(BACKDROP)).unwrap();

    let mut group = criterion.benchmark_group("svg");
    group.throughput(Throughput::Bytes(text.len() as u64));
    group.bench_function("write", |b| {
        b.iter(|| svg::write(black_box(&scene), &options));
    });
    group.bench_function("read", |b| {
        b.iter(|| svg::read(black_box(&text)).unwrap());
    });
    group.finish();

    let mut group = criterion.benchmark_group("verify");
    group.throughput(Throughput::Elements(STROKES as u64));
    group.bench_function("render", |b| {
        b.iter(|| verify::render(black_box(&text), verify::Size::Scale(1.0), None).unwrap());
    });
    group.bench_function("verify", |b| {
        b.iter(|| verify::verify(black_box(&text), image, &drawn, [1.0; 3]).unwrap());
    });
    group.finish();

    let mut group = criterion.benchmark_group("metrics");
    group.throughput(Throughput::Elements(pixels(image)));
    group.bench_function("psnr", |b| {
        b.iter(|| metrics::psnr(black_box(image), &drawn).unwrap());
    });
    group.bench_function("ssim", |b| {
        b.iter(|| metrics::ssim(black_box(image), &drawn).unwrap());
    });
    group.finish();
}

/// Whole fits, from decoded picture to settled scene.
fn fits(criterion: &mut Criterion) {
    let config = Config {
        budget: Budget {
            strokes: Some(1000),
            ..Budget::default()
        },
        polish: false,
        ..Config::default()
    };
    let mut group = criterion.benchmark_group("fit");
    for name in FITTED {
        let image = Image::open(format!("samples/{name}.png")).unwrap();
        group.bench_function(BenchmarkId::new("staged_1000", name), |b| {
            b.iter(|| {
                let fitter = Fitter::new(config.clone());
                fitter.fit(black_box(&image)).unwrap()
            });
        });
    }
    group.finish();
}

fn scene(image: &Image) -> Scene {
    let grid = Canvas::from_image(image).grid();
    let strokes = MEDIUM.strokes(grid, STROKES);
    let stage = Stage::from_iter(strokes.iter().map(|stroke| stroke.to_mark()));
    Scene {
        stages: vec![stage],
        ..Scene::empty(grid.width as u32, grid.height as u32, Some(BACKDROP))
    }
}

fn pixels(image: &Image) -> u64 {
    (image.width() * image.height()) as u64
}
