//! Budgets hold, and no drawing has a hole: what cases of users showed.

use crate::support::{
    self, Place, assert_says, committed, goes_on, of_bytes, of_psnr, of_strokes, sample, within,
};
use strokefit::fit::{Base, Budget, Config, ErrorWeighting, Fit, Fitter, Preset, Progress, Stop};
use strokefit::image::Image;
use strokefit::report::Judged;

fn drawn(picture: &Image, budget: Budget, preset: Preset) -> Fit {
    let config = Config {
        preset,
        look: Some(ErrorWeighting::Exact),
        ..within(budget)
    };
    support::drawn(picture, &config)
}

fn judged(name: &str, budget: Budget) -> Judged {
    judged_of(&sample(name), budget)
}

fn judged_of(picture: &Image, budget: Budget) -> Judged {
    Judged::new(drawn(picture, budget, Preset::Balanced)).unwrap()
}

/// A picture of 250 px at most: larger ones take more time and show no more.
fn small(name: &str) -> Image {
    let picture = sample(name);
    if picture.width() > 250 {
        picture.halved()
    } else {
        picture
    }
}

fn db(judged: &Judged) -> f64 {
    judged.verdict.fidelity.psnr_db
}

#[test]
fn as_many_bytes_as_a_fidelity_takes_draw_as_well() {
    let cases = [
        ("blob2", 35.0),
        ("rrect", 35.0),
        ("heart", 38.0),
        ("gasket", 38.0),
        ("bicycle", 34.0),
    ];
    for (name, wanted_db) in cases {
        let picture = small(name);
        let by_db = judged_of(&picture, of_psnr(wanted_db));
        let bytes = by_db.svg.len() + 20;
        let by_bytes = judged_of(&picture, of_bytes(bytes));
        assert!(db(&by_db) >= wanted_db, "{name}: {}", db(&by_db));
        assert!(by_bytes.svg.len() <= bytes, "{name}");
        assert!(
            db(&by_bytes) >= db(&by_db) - 2.0,
            "{name}: {} of {}",
            db(&by_bytes),
            db(&by_db)
        );
    }
}

#[test]
fn a_budget_that_what_pays_keeps_draws_as_well() {
    // What pays is 9 marks of 41 dB, and 585 bytes of 39 dB.
    let cartoon = judged("cartoon", of_strokes(10));
    assert!(cartoon.fit.scene.len() <= 10, "{}", cartoon.fit.scene.len());
    assert!(db(&cartoon) > 40.0, "{}", db(&cartoon));
    let logo = judged("logo", of_bytes(605));
    assert!(logo.svg.len() <= 605, "{}", logo.svg.len());
    assert!(db(&logo) > 36.0, "{}", db(&logo));
}

#[test]
fn a_drawing_is_shortened_to_the_bytes_asked_for() {
    let picture = sample("cartoon");
    let drawing = judged("cartoon", Budget::default());
    let base = Base::read(drawing.svg.clone(), &picture, false).unwrap();
    let config = Config {
        look: Some(ErrorWeighting::Exact),
        ..within(of_bytes(drawing.svg.len() - 200))
    };
    let fit = Fitter::new(config).on(base).fit(&picture).unwrap();
    let shorter = Judged::new(fit).unwrap();
    assert!(
        shorter.svg.len() + 200 <= drawing.svg.len(),
        "{}",
        shorter.svg.len()
    );
    assert!(shorter.fit.scene.len() > 3, "{}", shorter.fit.scene.len());
}

#[test]
fn every_budget_of_bytes_is_kept_without_a_hole() {
    for bytes in [2000, 2400, 2600, 4000] {
        let judged = judged("cartoon", of_bytes(bytes));
        assert!(judged.holds(), "{bytes}: {:?}", judged.verdict.agreement);
        assert!(judged.svg.len() <= bytes, "{bytes}");
        assert!(bytes < 4000 || db(&judged) >= 43.0, "{}", db(&judged));
    }
}

#[test]
fn a_fit_that_is_stopped_keeps_its_bytes() {
    let picture = sample("cartoon");
    for last in [1, 60, 400, 900] {
        let mut calls = 0;
        let mut observer = |_: &Progress<'_>| {
            calls += 1;
            goes_on(calls < last)
        };
        let fitter = Fitter::new(within(of_bytes(1200))).observer(&mut observer);
        let fit = fitter.fit(&picture).unwrap();
        assert_eq!(fit.stop, Stop::Interrupted, "{last}");
        assert!(fit.svg().len() <= 1200, "{last}: {}", fit.svg().len());
    }
}

#[test]
fn a_few_bytes_hold_a_stroke() {
    let heart = judged("heart", of_bytes(600));
    assert!(
        !heart.fit.scene.is_empty() && db(&heart) > 20.0,
        "{}",
        db(&heart)
    );
}

#[test]
fn black_areas_have_no_gash() {
    let comic = judged("comic", Budget::default());
    let agreement = comic.verdict.agreement;
    assert!(
        agreement.max_abs < 160 && agreement.patch_abs < 40,
        "{agreement:?}"
    );
}

#[test]
fn a_fidelity_of_a_transparent_picture_takes_few_strokes() {
    let by_default = judged("noto-gem", Budget::default());
    let by_db = judged("noto-gem", of_psnr(db(&by_default)));
    let [few, usual] = [&by_db, &by_default].map(|judged| judged.fit.scene.len());
    assert!(
        db(&by_db) >= db(&by_default) && few <= 2 * usual,
        "{few} {usual}"
    );
}

#[test]
fn a_fidelity_beyond_reach_ends_the_search() {
    // Noise of 28 dB on grey: each stroke draws a few of its grains.
    let noise = |x: usize, y: usize| (x * 7919 + y * 104_729) % 8191 % 52;
    let grain = Image::from_fn(96, 96, 1, |x, y, _| 0.4 + noise(x, y) as f32 / 255.0).unwrap();
    let fit = drawn(&grain, of_psnr(45.0), Preset::Draft);
    assert!(fit.scene.len() <= 96 * 96 / 16, "{}", fit.scene.len());
}

#[test]
fn a_longer_fit_of_few_strokes_is_never_worse() {
    for name in ["cartoon", "heart", "gasket"] {
        let picture = small(name);
        let fit = |preset| drawn(&picture, of_strokes(8), preset);
        let db = |preset| db(&Judged::new(fit(preset)).unwrap());
        let [draft, balanced, best] = [Preset::Draft, Preset::Balanced, Preset::Best].map(db);
        assert!(
            draft <= balanced && balanced <= best,
            "{name}: {draft} {balanced} {best}"
        );
    }
}

#[test]
fn an_enlarged_picture_gets_about_the_same_drawing() {
    let pixels = image::open(committed("samples/coffee-300.png"))
        .unwrap()
        .to_rgb8();
    let strokes = |times: u32| {
        let [width, height] = [times * pixels.width(), times * pixels.height()];
        let smooth = image::imageops::FilterType::CatmullRom;
        let large = image::imageops::resize(&pixels, width, height, smooth);
        let of = |x: usize, y: usize, c: usize| large[(x as u32, y as u32)].0[c];
        let large = Image::from_fn(width as usize, height as usize, 3, of).unwrap();
        drawn(&large, Budget::default(), Preset::Draft).scene.len()
    };
    let [few, many] = [strokes(4), strokes(10)];
    assert!(many.abs_diff(few) * 4 <= few, "{few} {many}");
}

#[test]
fn what_a_picture_or_a_budget_is_not_made_for_is_said() {
    for (picture, options, status, words) in [
        ("heart", "--bytes 300", 3, "no stroke fits in 300 bytes"),
        ("s3x3", "", 0, ""),
        (
            "dither",
            "--preset draft",
            0,
            "dots or noise finer than strokes",
        ),
    ] {
        let fit = format!("fit @tests/data/pictures/{picture}.png -o out.svg {options}");
        assert_says(&Place::new().said(&fit, status), &[words]);
    }
}
