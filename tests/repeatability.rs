//! The same bytes, today and tomorrow, on every instruction set, number of threads and build profile.
//!
//! The table in `tests/repeatability/hashes.txt` has the hash of the SVG of each sample under each set of
//! options. Where the algorithm is changed on purpose, the new table is written by
//!
//! ```sh
//! STROKEFIT_WRITE_HASHES=1 cargo test --release --test repeatability
//! ```
#![allow(missing_docs, clippy::unwrap_used)]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use strokefit::fit::{Background, Budget, Config, Execution, Fitter, Preset, Recipe, Simd};
use strokefit::image::Image;
use strokefit::svg::WriteOptions;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// The committed samples, by name.
fn samples() -> Vec<String> {
    let names = fs::read_dir(folder("samples")).unwrap().map(|entry| {
        let name = entry.unwrap().file_name().into_string().unwrap();
        name.strip_suffix(".png").map(str::to_owned)
    });
    let mut names: Vec<String> = names.flatten().collect();
    names.sort();
    names
}

/// Quick fits that between them pass through every part of the algorithm.
fn option_sets() -> [(&'static str, Config); 3] {
    let draft = |budget| Config {
        budget,
        preset: Preset::Draft,
        ..Config::default()
    };
    let strokes = Some(150);
    let most = Budget {
        strokes,
        ..Budget::default()
    };
    let faithful = Budget {
        psnr_db: Some(22.0),
        bytes: Some(9000),
        ..Budget::default()
    };
    // A draft is not settled against its file.
    let mut settled = Recipe::of(Preset::Draft);
    settled.settling.rounds = 2;
    [
        ("150 strokes", draft(most)),
        (
            "22 dB in 9 kB, settled",
            Config {
                recipe: Some(settled),
                ..draft(faithful)
            },
        ),
        (
            "opaque, progressive, seed 7",
            Config {
                opaque: true,
                progressive: true,
                background: Background::None,
                coverage: "atan:4>smoothstep".parse().unwrap(),
                file: WriteOptions {
                    precision: 1,
                    ..WriteOptions::default()
                },
                seed: 7,
                ..draft(most)
            },
        ),
    ]
}

fn drawn(sample: &str, config: &Config, execution: Execution) -> String {
    let picture = Image::open(folder("samples").join(format!("{sample}.png"))).unwrap();
    let fitter = Fitter::new(config.clone()).execution(execution);
    let fit = fitter.fit(&picture).unwrap();
    fit.svg()
}

/// FNV-1a, of 64 bits.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

fn table() -> String {
    let mut table = String::new();
    for sample in samples() {
        for (name, config) in option_sets() {
            let text = drawn(&sample, &config, Execution::default());
            let (hash, bytes) = (hash(&text), text.len());
            writeln!(table, "{hash:016x} {bytes:6} bytes  {sample}: {name}").unwrap();
        }
    }
    table
}

#[test]
fn samples_are_drawn_with_the_bytes_of_the_table() {
    let path = folder("tests/repeatability/hashes.txt");
    let new = table();
    if std::env::var_os("STROKEFIT_WRITE_HASHES").is_some() {
        fs::write(&path, &new).unwrap();
    }
    let old = fs::read_to_string(&path).unwrap();
    let changed: Vec<&str> = new.lines().filter(|line| !old.contains(line)).collect();
    assert!(
        old == new,
        "other bytes than in the table; where that is on purpose, the head of this file says how to write \
         it anew:\n{}",
        changed.join("\n")
    );
}

#[test]
fn how_it_is_run_changes_no_byte() {
    let [_, (_, config), _] = option_sets();
    let one = Execution {
        threads: Some(1),
        simd: Simd::Auto,
    };
    let expected = drawn("rocket-320", &config, one);
    for threads in [1, 2, 3, 8] {
        let execution = Execution {
            threads: Some(threads),
            ..one
        };
        assert!(
            drawn("rocket-320", &config, execution) == expected,
            "{threads} threads"
        );
    }
    for simd in Simd::ALL.into_iter().filter(|simd| simd.level().is_some()) {
        let execution = Execution {
            threads: Some(2),
            simd,
        };
        assert!(
            drawn("rocket-320", &config, execution) == expected,
            "{simd}"
        );
    }
}
