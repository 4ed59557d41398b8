//! The machine's own limits: arithmetic in registers, copies in caches and memory.

use std::hint::black_box;
use std::sync::Barrier;
use std::time::Instant;

use fearless_simd::{Level, dispatch, f32x16, prelude::*};
use strokefit::fit::Simd as SimdName;

/// Rounds of a chain between two looks at the clock.
const STEPS: usize = 20_000;
/// Bytes of the two buffers of a copy together: in the first cache, in the second, in memory.
const COPIES: [usize; 3] = [24 << 10, 512 << 10, 256 << 20];

/// Measured limits of some threads together.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    threads: usize,
    /// Fused multiply-add, two operations each, 10⁹/s.
    pub(crate) fused: f64,
    /// Multiplications and additions apart, as the renderer has them, so that every SIMD level gives
    /// the same bits; 10⁹/s.
    pub(crate) separate: f64,
    /// Roots, 10⁹/s.
    pub(crate) root: f64,
    /// Divisions, 10⁹/s.
    pub(crate) quotient: f64,
    /// Copies of [`COPIES`], read and written, 10⁹ bytes/s.
    pub(crate) copy: [f64; 3],
}

/// The limits of each number of threads.
pub(crate) fn measure(threads: &[usize], rounds: usize) -> Vec<Limits> {
    let level = SimdName::Auto
        .level()
        .expect("every machine has a SIMD level");
    threads
        .iter()
        .map(|&threads| Limits::measure(level, threads, rounds))
        .collect()
}

pub(crate) fn print(limits: &[Limits]) {
    println!("\nlimits of this machine, measured");
    println!(
        "{:>7} {:>11} {:>14} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "threads",
        "FMA Gflop/s",
        "mul, add Gop/s",
        "sqrt G/s",
        "div G/s",
        "L1 GB/s",
        "L2 GB/s",
        "RAM GB/s"
    );
    for limit in limits {
        println!(
            "{:>7} {:>11.0} {:>14.0} {:>9.1} {:>9.1} {:>9.0} {:>9.0} {:>9.1}",
            limit.threads,
            limit.fused,
            limit.separate,
            limit.root,
            limit.quotient,
            limit.copy[0],
            limit.copy[1],
            limit.copy[2]
        );
    }
}

impl Limits {
    fn measure(level: Level, threads: usize, rounds: usize) -> Self {
        let chain = |kind, chains: &[usize]| {
            let rate = |&chains| {
                let seconds = together(threads, rounds, || move || run(level, kind, chains));
                (threads * chains * STEPS * 16) as f64 / seconds / 1e9
            };
            // The number of chains that hides the latency depends on the registers there are.
            chains.iter().map(rate).fold(0.0, f64::max)
        };
        let copy = COPIES.map(|bytes| {
            let words = bytes / 8;
            let repeats = (1 << 22) / words + 1;
            let seconds = together(threads, rounds.min(10), || {
                let (from, mut to) = (vec![1.0_f32; words], vec![0.0_f32; words]);
                move || {
                    for _ in 0..repeats {
                        black_box(&mut to).copy_from_slice(black_box(&from));
                    }
                }
            });
            (threads * repeats * words * 8) as f64 / seconds / 1e9
        });
        Self {
            threads,
            fused: 2.0 * chain(Kind::Fused, &[6, 12, 24]),
            separate: 2.0 * chain(Kind::Separate, &[6, 12, 24]),
            root: chain(Kind::Root, &[6]),
            quotient: chain(Kind::Quotient, &[6]),
            copy,
        }
    }
}

/// The shortest time, s, in which `threads` threads each do a job of `make` at once.
fn together<J: FnMut()>(threads: usize, rounds: usize, make: impl Fn() -> J + Sync) -> f64 {
    let barrier = Barrier::new(threads);
    let worker = || {
        let mut job = make();
        let mut best = f64::INFINITY;
        for _ in 0..rounds.max(2) {
            barrier.wait();
            let start = Instant::now();
            job();
            // Until the slowest is done.
            barrier.wait();
            best = best.min(start.elapsed().as_secs_f64());
        }
        best
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        let times = workers
            .into_iter()
            .map(|worker| worker.join().expect("no worker panics"));
        times.fold(0.0, f64::max)
    })
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Fused,
    Separate,
    Root,
    Quotient,
}

/// [`STEPS`] of each of `chains` independent chains of an operation.
fn run(level: Level, kind: Kind, chains: usize) {
    match (kind, chains) {
        (Kind::Fused, 6) => dispatch!(level, simd => fused::<_, 6>(simd)),
        (Kind::Fused, 12) => dispatch!(level, simd => fused::<_, 12>(simd)),
        (Kind::Fused, _) => dispatch!(level, simd => fused::<_, 24>(simd)),
        (Kind::Separate, 6) => dispatch!(level, simd => separate::<_, 6>(simd)),
        (Kind::Separate, 12) => dispatch!(level, simd => separate::<_, 12>(simd)),
        (Kind::Separate, _) => dispatch!(level, simd => separate::<_, 24>(simd)),
        (Kind::Root, _) => dispatch!(level, simd => root(simd)),
        (Kind::Quotient, _) => dispatch!(level, simd => quotient(simd)),
    }
}

#[inline(always)]
fn fused<S: Simd, const N: usize>(simd: S) {
    let factor = f32x16::splat(simd, black_box(0.999));
    let term = f32x16::splat(simd, black_box(0.001));
    let mut sums = [term; N];
    for _ in 0..STEPS {
        for sum in &mut sums {
            *sum = sum.mul_add(factor, term);
        }
    }
    keep(sums);
}

#[inline(always)]
fn separate<S: Simd, const N: usize>(simd: S) {
    let factor = f32x16::splat(simd, black_box(0.999));
    let term = f32x16::splat(simd, black_box(0.001));
    let mut sums = [term; N];
    for _ in 0..STEPS {
        for sum in &mut sums {
            *sum = *sum * factor + term;
        }
    }
    keep(sums);
}

#[inline(always)]
fn root<S: Simd>(simd: S) {
    let mut values = [f32x16::splat(simd, black_box(1.5)); 6];
    for _ in 0..STEPS {
        for value in &mut values {
            *value = value.sqrt();
        }
    }
    keep(values);
}

#[inline(always)]
fn quotient<S: Simd>(simd: S) {
    let divisor = f32x16::splat(simd, black_box(1.000_1));
    let mut values = [f32x16::splat(simd, black_box(1.5)); 6];
    for _ in 0..STEPS {
        for value in &mut values {
            *value /= divisor;
        }
    }
    keep(values);
}

/// The results are used, as far as the compiler knows.
#[inline(always)]
fn keep<S: Simd, const N: usize>(values: [f32x16<S>; N]) {
    for value in values {
        black_box(value);
    }
}
