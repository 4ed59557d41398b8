//! The door of the library: other threads can cancel, a fit knows how it is written.

use std::ops::ControlFlow;
use std::sync::mpsc;

use crate::support::{draft, drawn, goes_on, sample};
use strokefit::ErrorKind;
use strokefit::fit::{CancelToken, Checkpoint, Config, Fitter, Preset, Progress, Recipe, Stop};
use strokefit::image::Image;
use strokefit::scene::Marks;
use strokefit::svg::{self, Form, WriteOptions};

fn with_recipe(change: impl Fn(&mut Recipe)) -> Config {
    let mut recipe = Recipe::of(Preset::Draft);
    change(&mut recipe);
    Config {
        recipe: Some(recipe),
        ..draft(60)
    }
}

#[test]
fn no_iterations_of_polish_are_none() {
    let picture = sample("noto-rocket");
    let none = Config {
        marks: Marks::Strokes,
        ..with_recipe(|recipe| recipe.polish.iterations = 0)
    };
    let none = drawn(&picture, &none);
    let off = Config {
        polish: false,
        marks: Marks::Strokes,
        ..with_recipe(|_| ())
    };
    let off = drawn(&picture, &off);
    // Without polish, strokes that were promised but not accepted are topped up in the end.
    assert!(none.scene.len() < off.scene.len());
    let first = off.scene.marks().take(none.scene.len());
    assert!(none.scene.marks().eq(first));
}

#[test]
fn a_fit_is_written_as_it_was_fitted() {
    let config = Config {
        opaque: true,
        file: WriteOptions {
            form: Form::Smallest,
            precision: 1,
            ..WriteOptions::default()
        },
        ..draft(60)
    };
    let fit = drawn(&sample("noto-gem"), &config);
    assert_eq!(fit.svg(), svg::write(&fit.scene, &config.file));
    assert_ne!(fit.svg(), svg::write(&fit.scene, &WriteOptions::default()));
}

#[test]
fn another_thread_cancels_a_fit() {
    let (token, (began, begins)) = (CancelToken::default(), mpsc::channel());
    let elsewhere = token.clone();
    let canceller = std::thread::spawn(move || {
        begins.recv().unwrap();
        elsewhere.cancel();
    });
    // It would take minutes.
    let mut recipe = Recipe::of(Preset::Best);
    recipe.polish.iterations = 1_000_000;
    let config = Config {
        recipe: Some(recipe),
        ..draft(200)
    };
    let mut watch = move |_: &Progress<'_>| {
        // Nobody listens any more once the fit is cancelled.
        let _ = began.send(());
        ControlFlow::Continue(())
    };
    let fitter = Fitter::new(config).observer(&mut watch).cancelled_by(token);
    let fit = fitter.fit(&sample("noto-gem")).unwrap();
    canceller.join().unwrap();
    assert_eq!(fit.stop, Stop::Interrupted);
    assert!(!fit.scene.is_empty(), "what was drawn until then is there");
}

#[test]
fn a_checkpoint_of_other_options_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fit.state");
    let picture = sample("noto-gem");
    let fit = |config: &Config| {
        let mut checkpoint = Checkpoint::new(&path);
        let fitter = Fitter::new(config.clone()).checkpoint(&mut checkpoint);
        fitter.fit(&picture)
    };
    let config = with_recipe(|_| ());
    let first = fit(&config).unwrap();
    let error = fit(&with_recipe(|recipe| recipe.relocation.gain = 3.1)).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Config);
    assert_eq!(fit(&config).unwrap().scene, first.scene);
}

/// What looks random.
fn noise(width: usize, height: usize) -> Image {
    let level = |x, y, c| {
        let i = y * width + x;
        (i * i * [3, 5, 7][c] % 97) as f32 / 96.0
    };
    Image::from_fn(width, height, 3, level).unwrap()
}

/// Every phase is interrupted somewhere, between two rounds of settling too.
#[test]
fn a_fit_that_is_stopped_at_any_call_goes_on_to_the_same_drawing() {
    let folder = tempfile::tempdir().unwrap();
    let picture = noise(32, 24);
    let config = Config {
        stages: Some(2),
        ..with_recipe(|recipe| {
            recipe.stages.iterations = 3;
            recipe.polish.iterations = 5;
            recipe.settling_rounds = 2;
        })
    };
    let whole = drawn(&picture, &config).scene;
    let mut failed = Vec::new();
    for last in 1.. {
        let path = folder.path().join(format!("{last}.state"));
        let fit = |last: usize| {
            let mut calls = 0;
            let mut watch = |_: &Progress<'_>| {
                calls += 1;
                goes_on(calls != last)
            };
            let mut checkpoint = Checkpoint::new(&path);
            let fitter = Fitter::new(config.clone()).observer(&mut watch);
            fitter.checkpoint(&mut checkpoint).fit(&picture).unwrap()
        };
        if fit(last).stop != Stop::Interrupted {
            break;
        }
        if fit(usize::MAX).scene != whole {
            failed.push(last);
        }
    }
    assert!(failed.is_empty(), "stopped at calls {failed:?}");
}

/// Noise takes three times the strokes that a plan without a budget guesses.
#[test]
fn progress_is_not_done_while_much_is_to_come() {
    let picture = noise(96, 96);
    let config = Config {
        quality: Some(55.0),
        recipe: Some(Recipe::of(Preset::Draft)),
        ..Config::default()
    };
    let mut told = Vec::new();
    let mut watch = |progress: &Progress<'_>| {
        told.push((progress.polishing, progress.settling, progress.done));
        ControlFlow::Continue(())
    };
    let fit = Fitter::new(config).observer(&mut watch).fit(&picture);
    assert!(fit.unwrap().scene.len() > 300);
    assert!(told.is_sorted_by(|a, b| a.2 <= b.2), "it never decreases");
    let growing: Vec<_> = told.iter().filter(|told| !told.0).collect();
    let polishing: Vec<_> = told.iter().filter(|told| told.0 && !told.1).collect();
    let (polished, half) = (polishing.len(), polishing.len() / 2);
    assert!(growing.iter().all(|told| told.2 < 0.7), "polish is to come");
    assert!(polishing[half].2 < 0.8, "half of it is to come");
    assert!(polishing[..polished - 1].iter().all(|told| told.2 < 1.0));
}
