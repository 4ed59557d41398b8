//! Many fits in one process: each has its own threads, memory and observer, and none sees another.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::support::{draft, goes_on};
use strokefit::fit::{Execution, Fit, Fitter, Progress, Stop};
use strokefit::image::Image;
use strokefit::rng;
use strokefit::svg;

const FITS: usize = 16;

/// A picture of smooth waves, another for each `index`.
fn picture(index: usize) -> Image {
    let (width, height) = (72, 48);
    let level = |x: usize, y: usize, c: usize| {
        let [fx, fy] = [0, 1].map(|k| 0.3 * rng::draw(index as u64, c as u64, k, 0));
        0.5 + 0.4 * (fx * x as f32 + fy * y as f32).sin()
    };
    Image::from_fn(width, height, 3, level).unwrap()
}

fn fitter<'a>() -> Fitter<'a> {
    Fitter::new(draft(40)).execution(Execution {
        threads: Some(2),
        ..Execution::default()
    })
}

#[test]
fn fits_side_by_side_are_those_one_after_the_other() {
    let alone: Vec<String> = (0..FITS)
        .map(|i| fitter().fit(&picture(i)).unwrap().svg())
        .collect();
    let together = thread::scope(|scope| {
        let fits: Vec<_> = (0..FITS)
            .map(|i| scope.spawn(move || fitter().fit(&picture(i)).unwrap().svg()))
            .collect();
        fits.into_iter()
            .map(|fit| fit.join().unwrap())
            .collect::<Vec<_>>()
    });
    assert!(alone == together);
}

/// Every other fit is stopped, each after another number of iterations; the rest run to their end.
#[test]
fn each_can_be_stopped_alone() {
    let fit = |index: usize| {
        let calls = AtomicUsize::new(0);
        let mut observer = |_: &Progress<'_>| {
            let call = calls.fetch_add(1, Ordering::Relaxed);
            goes_on(index.is_multiple_of(2) || call < 3 * index)
        };
        let fit = fitter().observer(&mut observer).fit(&picture(index));
        (fit.unwrap(), calls.into_inner())
    };
    let fits: Vec<(Fit, usize)> = thread::scope(|scope| {
        let fits: Vec<_> = (0..FITS).map(|i| scope.spawn(move || fit(i))).collect();
        fits.into_iter().map(|fit| fit.join().unwrap()).collect()
    });
    for (index, (fit, calls)) in fits.iter().enumerate() {
        if index % 2 == 1 {
            assert_eq!((fit.stop, *calls), (Stop::Interrupted, 3 * index + 1));
        } else {
            assert_ne!(fit.stop, Stop::Interrupted);
        }
        svg::read(&fit.svg()).unwrap();
    }
}
