//! One benchmark per step of the pipeline, in the order of the steps.
//!
//! ```text
//! cargo bench -p rig --bench pipeline [-- FILTER]
//! ```
//!
//! Strokes are random where a step takes strokes, so that a figure moves when the step does and
//! not when the recipe of the fit is tuned. All cores are used, as in a fit.
#![allow(clippy::unwrap_used, reason = "a benchmark that fails may stop")]

use std::fs;
use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BatchSize, BenchmarkGroup, BenchmarkId, Criterion, Throughput};

use rig::bench::measure::{StrokeSize, go_to_root};
use strokefit::coverage::Coverage;
use strokefit::fit::{Budget, Config, Fitter, Objective, Simd};
use strokefit::image::{Image, Limits};
use strokefit::loss::Loss;
use strokefit::metrics;
use strokefit::optim::{Adam, AdamParams};
use strokefit::render::{Backdrop, Canvas, Gradients, PARAMS, Renderer, Softness, Strokes};
use strokefit::scene::{Scene, Stage};
use strokefit::seed::{Pyramid, Residual, Wanted, propose};
use strokefit::svg::{self, WriteOptions};
use strokefit::verify;

const PICTURE: &str = "samples/coffee-550x220.png";

/// Pictures of whole fits: a photograph with smooth shading, one with texture, flat art with alpha.
const FITTED: [&str; 3] = ["coffee-550x220", "chelsea-cat", "noto-gem"];

/// Strokes of a drawing, where nothing else is said.
const STROKES: usize = 5000;

const BACKDROP: [f32; 3] = [0.5; 3];

/// The edge that an antialiasing rasteriser draws.
const EDGE: Softness = Softness {
    coverage: Coverage::Smoothstep,
    width: 1.0,
};

const fn strokes_of(radius_px: f32, length_px: f32) -> StrokeSize {
    StrokeSize {
        radius_px,
        length_px,
        opacity: 0.65,
    }
}

const THIN: StrokeSize = strokes_of(0.9, 5.0);
const MEDIUM: StrokeSize = strokes_of(2.5, 10.0);
const LARGE: StrokeSize = strokes_of(14.0, 50.0);

/// Sizes of strokes, and the number of strokes of each: about what a stage holds.
const LOOKS: [(&str, usize, StrokeSize); 3] = [
    ("thin", 5000, THIN),
    ("medium", 2000, MEDIUM),
    ("large", 200, LARGE),
];

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
    for (name, count, look) in &LOOKS {
        let target = Canvas::from_image(image);
        let strokes = look.strokes(target.grid(), *count);
        let mut group = criterion.benchmark_group("render");
        passes(&mut group, name, &strokes, &target);
        group.finish();
    }
}

/// Forward and both backward passes of `strokes`; the throughput is in blocks of 16 px.
fn passes(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    strokes: &Strokes,
    target: &Canvas,
) {
    let mut renderer = Renderer::new(target.grid(), Simd::Auto.level().unwrap());
    let backdrop = Backdrop::Color(BACKDROP);
    let objective = Objective::new(Loss::L2, target);
    let mut gradients = Gradients::default();
    renderer.backward(strokes, EDGE, backdrop, &objective, &mut gradients);
    group.throughput(Throughput::Elements(gradients.blocks));

    let mut canvas = Canvas::flat(target.grid(), BACKDROP);
    group.bench_function(BenchmarkId::new("forward", name), |b| {
        b.iter(|| renderer.forward(black_box(strokes), EDGE, backdrop, &mut canvas));
    });
    group.bench_function(BenchmarkId::new("backward", name), |b| {
        b.iter(|| {
            renderer.backward(
                black_box(strokes),
                EDGE,
                backdrop,
                &objective,
                &mut gradients,
            );
        });
    });
    group.bench_function(BenchmarkId::new("backward_with_worth", name), |b| {
        b.iter(|| {
            let strokes = black_box(strokes);
            renderer.backward_with_contributions(
                strokes,
                EDGE,
                backdrop,
                &objective,
                &mut gradients,
            );
        });
    });
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
        b.iter(|| verify::verify(black_box(&text), image, &drawn).unwrap());
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
