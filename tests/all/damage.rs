//! Damage is recognised and not drawn; what is clean is drawn as it is.

use crate::support::{drawn, of_psnr, picture, rendered, within};
use strokefit::Result;
use strokefit::fit::{Background, Colors, Config, Fit};
use strokefit::image::Image;
#[cfg(feature = "cli")]
use strokefit::image::Limits;
use strokefit::metrics::Quality;
use strokefit::restore::{self, Damage, Paper, Restored};

fn default(picture: &Image) -> Fit {
    drawn(picture, &Config::default())
}

/// The picture that a damaged one is meant to be, with its own paper.
fn meant(picture: &Image) -> Result<Option<Restored>> {
    restore::restored(picture, Paper::Own)
}

/// The file against another picture than the one that was drawn, dB.
fn psnr_db(fit: &Fit, truth: &Image) -> f64 {
    let file = rendered(&fit.svg());
    Quality::between(truth, &file).unwrap().psnr_db
}

/// `clean` with normal noise of an RMS of `levels`, cut off at black and white.
fn noisy(clean: &Image, levels: f32) -> Image {
    let width = clean.width();
    let noise = |i: usize| {
        // The sum of twelve uniform numbers, from a counter.
        let mix = |k: u64| {
            let z = (i as u64 * 12 + k + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 40) as f32 / (1_u64 << 24) as f32
        };
        levels / 255.0 * ((0..12).map(mix).sum::<f32>() - 6.0)
    };
    Image::from_fn(width, clean.height(), 3, |x, y, c| {
        let i = y * width + x;
        (clean.planes()[c][i] + noise(3 * i + c)).clamp(0.0, 1.0)
    })
    .unwrap()
}

/// A picture after a JPEG of some quality, which the program alone writes.
#[cfg(feature = "cli")]
fn compressed(picture: &Image, quality: u8) -> Image {
    let jpeg = picture.encode_jpeg(quality).unwrap();
    Image::decode(&jpeg, "JPEG", Limits::default()).unwrap()
}

/// Discs and bars of flat colours on white, antialiased.
fn flat_art() -> Image {
    let shapes: [([f32; 3], [f32; 3]); 3] = [
        ([40.0, 44.0, 24.0], [0.8, 0.2, 0.2]),
        ([88.0, 60.0, 26.0], [0.2, 0.5, 0.8]),
        ([60.0, 90.0, 18.0], [0.95, 0.75, 0.2]),
    ];
    Image::from_fn(128, 128, 3, |x, y, c| {
        shapes
            .iter()
            .fold(1.0_f32, |below, ([cx, cy, radius], color)| {
                let [dx, dy] = [x as f32 + 0.5 - cx, y as f32 + 0.5 - cy];
                let share = (radius - (dx * dx + dy * dy).sqrt() + 0.5).clamp(0.0, 1.0);
                below + share * (color[c] - below)
            })
    })
    .unwrap()
}

#[test]
fn clean_pictures_have_no_damage() {
    let names = [
        "bicycle.png",
        "chelsea-cat.png",
        "coffee-300.png",
        "dashboard-900.png",
        "noto-rocket.png",
    ];
    for name in names {
        let found = meant(&picture(name).flattened([1.0; 3])).unwrap();
        assert_eq!(found.map(|found| found.damage), None, "{name}");
    }
    assert!(meant(&flat_art()).unwrap().is_none());
}

#[test]
fn noise_is_not_drawn() {
    let clean = flat_art();
    let noisy = noisy(&clean, 8.0);
    let [of_clean, of_noisy] = [&clean, &noisy].map(default);
    let noise = of_noisy.damage.unwrap().noise;
    assert!((3.0..8.0).contains(&noise), "{noise}");
    assert_eq!(of_noisy.scene.len(), of_clean.scene.len());
    // The noisy picture itself has 31 dB.
    let db = psnr_db(&of_noisy, &clean);
    assert!(db > 38.0, "{db}");
    assert_eq!(
        of_noisy.scene.background, of_clean.scene.background,
        "paper is white again"
    );
}

#[test]
fn literally_damage_is_drawn() {
    let noisy = noisy(&flat_art(), 8.0);
    let literal = Config {
        literal: true,
        ..Config::default()
    };
    let psnr = within(of_psnr(28.0));
    for config in [literal, psnr] {
        assert_eq!(drawn(&noisy, &config).damage, None);
    }
}

#[test]
fn traces_of_jpeg_are_not_drawn() {
    let (jpeg, logo) = (picture("logo_q30.jpg"), picture("logo.png"));
    // Where the grid of blocks begins elsewhere, as in a screenshot of a part, too.
    for [left, top] in [[0, 0], [3, 5]] {
        let cropped = |of: &Image| {
            let (width, planes) = (of.width(), of.planes());
            let at = |x: usize, y: usize, c: usize| planes[c][(y + top) * width + x + left];
            Image::from_fn(width - left, of.height() - top, 3, at).unwrap()
        };
        let fit = default(&cropped(&jpeg));
        assert!(fit.damage.unwrap().ringing > 1.0);
        assert!(fit.scene.len() <= 25, "{} marks", fit.scene.len());
        let db = psnr_db(&fit, &cropped(&logo));
        assert!(db >= 32.5, "{db}");
    }
}

#[cfg(feature = "cli")]
#[test]
fn weak_compression_is_told_by_its_blocks() {
    // Its noise is as small as what antialiasing leaves beside edges.
    for quality in [90, 95] {
        let damage = meant(&compressed(&flat_art(), quality))
            .unwrap()
            .unwrap()
            .damage;
        assert!((0.5..3.0).contains(&damage.ringing), "{damage:?}");
        assert_eq!(damage.noise, 0.0);
    }
}

/// Flat art on transparency: its pixels outside of discs.
fn with_alpha(picture: Image, is_binary: bool) -> Image {
    let width = picture.width();
    let alpha = (0..width * picture.height()).map(|i| {
        let (x, y) = ((i % width) as f32 - 60.3, (i / width) as f32 - 64.8);
        let alpha = (56.0 - x.hypot(y)).clamp(0.0, 1.0);
        if is_binary { alpha.round() } else { alpha }
    });
    picture.with_alpha(alpha.collect()).unwrap()
}

#[test]
fn noise_on_transparency_is_not_drawn() {
    let clean = with_alpha(flat_art(), false);
    let noisy = with_alpha(noisy(&flat_art(), 8.0), false);
    let found = meant(&noisy).unwrap().unwrap();
    assert!(
        (3.0..10.0).contains(&found.damage.noise),
        "{:?}",
        found.damage
    );
    assert_eq!(found.picture.alpha(), clean.alpha());
    let db = |picture: &Image| Quality::between(&clean, picture).unwrap().psnr_db;
    assert!(
        db(&found.picture) > db(&noisy) + 6.0,
        "{} {}",
        db(&found.picture),
        db(&noisy)
    );
    assert!(meant(&clean).unwrap().is_none());
}

#[test]
fn stairs_of_transparency_become_smooth() {
    let grey = Image::filled(128, 128, [0.4; 3]).unwrap();
    let (smooth, stairs) = (with_alpha(grey.clone(), false), with_alpha(grey, true));
    let found = meant(&stairs).unwrap().unwrap();
    assert!(found.damage.stairs);
    let mse = |picture: &Image| Quality::between(&smooth, picture).unwrap().mse;
    assert!(
        mse(&found.picture) < 0.8 * mse(&stairs),
        "{} {}",
        mse(&found.picture),
        mse(&stairs)
    );
}

#[test]
fn specks_are_left_as_they_are() {
    // A disc with stairs among dots of one to four pixels, on transparency.
    let dots = |x: usize, y: usize| y % 32 == 4 && x % 16 < 1 + x / 32 && x < 128;
    let disc = |x: usize, y: usize| (x as f32 - 64.0).hypot(y as f32 - 80.0) < 30.0;
    let alpha: Vec<f32> = (0..128 * 128)
        .map(|i| f32::from(u8::from(dots(i % 128, i / 128) || disc(i % 128, i / 128))))
        .collect();
    let picture = Image::filled(128, 128, [0.2; 3])
        .unwrap()
        .with_alpha(alpha.clone())
        .unwrap();
    let found = meant(&picture).unwrap().unwrap();
    assert!(found.damage.stairs);
    let kept = found.picture.alpha().unwrap();
    let is_kept = |i: usize| kept[i] == alpha[i];
    assert!(
        (0..128 * 128)
            .filter(|i| dots(i % 128, i / 128) && !disc(i % 128, i / 128))
            .all(is_kept)
    );
}

#[test]
fn stairs_of_one_bit_become_smooth() {
    let fit = default(&picture("bilevel2.png"));
    assert!(fit.damage.unwrap().stairs);
    assert!(fit.scene.len() <= 12, "{} marks", fit.scene.len());
    let is_white = |color: [f32; 3]| color.iter().all(|v| *v > 0.998);
    assert!(!fit.scene.marks().any(|mark| is_white(mark.color())));
    let db = psnr_db(&fit, &picture("smooth2.png"));
    assert!(db >= 34.0, "{db}");
}

#[cfg(feature = "cli")]
#[test]
fn stairs_that_were_compressed_become_smooth() {
    let clean = flat_art();
    let colors = [
        [1.0; 3],
        [0.8, 0.2, 0.2],
        [0.2, 0.5, 0.8],
        [0.95, 0.75, 0.2],
    ];
    // Each pixel has the colour of a disc or of the page.
    let aliased = Image::from_fn(128, 128, 3, |x, y, c| {
        let own = clean.planes().each_ref().map(|plane| plane[y * 128 + x]);
        let apart =
            |color: &[f32; 3]| -> f32 { color.iter().zip(own).map(|(a, b)| (a - b).powi(2)).sum() };
        let nearest = colors.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
        nearest.unwrap()[c]
    });
    let fit = default(&compressed(&aliased.unwrap(), 90));
    let damage = fit.damage.unwrap();
    assert!(damage.stairs && damage.ringing > 1.0, "{damage:?}");
    assert!(fit.scene.len() <= 4, "{} marks", fit.scene.len());
    let db = psnr_db(&fit, &clean);
    assert!(db > 33.0, "{db}");
}

#[test]
fn corners_between_long_runs_are_no_stairs() {
    // A grid of lines of a pixel, and a ring.
    let ring =
        |x: usize, y: usize| (38.0..41.0).contains(&(x as f32 - 64.2).hypot(y as f32 - 63.6));
    let dark = |x: usize, y: usize| x % 16 == 8 || y % 16 == 8 || ring(x, y);
    let picture = Image::from_fn(128, 128, 1, |x, y, _| f32::from(!dark(x, y))).unwrap();
    let found = meant(&picture).unwrap().unwrap();
    assert!(found.damage.stairs);
    let [own, restored] = [&picture, &found.picture].map(|p| p.planes()[0].clone());
    // Crossings far from the ring.
    for (x, y) in [(8, 8), (24, 24), (120, 120), (104, 120)] {
        for i in [0, 1, 2].map(|k| (y - 1 + k) * 128 + x - 1) {
            assert_eq!(own[i..i + 3], restored[i..i + 3], "{x} {y}");
        }
    }
}

#[test]
fn squares_on_a_grid_are_meant() {
    let sprite = Image::from_fn(96, 96, 1, |x, y, _| {
        f32::from(u8::from((x / 8 + y / 8) % 3 == 0 || x / 8 == 4))
    });
    assert!(meant(&sprite.unwrap()).unwrap().is_none());
}

#[test]
fn ink_on_a_photographed_page_is_ink() {
    let config = Config {
        colors: Colors::Palette(vec![[0x20, 0x2a, 0x6e]]),
        background: Background::None,
        opaque: true,
        ..Config::default()
    };
    // Chance decides on some of the pieces: three seeds give 35 to 42 marks.
    let photograph = picture("signature_photo.jpg");
    let with_seed = |seed| {
        let config = Config {
            seed,
            ..config.clone()
        };
        drawn(&photograph, &config)
    };
    let marks = (1..3).map(|seed| with_seed(seed).scene.len());
    let fit = with_seed(0);
    let mean = (fit.scene.len() + marks.sum::<usize>()) / 3;
    assert!(mean <= 40, "{mean} marks");
    let truth = picture("signature_truth.png");
    let file = rendered(&fit.svg());
    let inked = file.alpha().unwrap().iter().map(|alpha| *alpha > 0.5);
    let [mut both, mut either, mut paper, mut stained] = [0.0; 4];
    for (is_inked, truth) in inked.zip(&truth.planes()[0]) {
        let is_ink = *truth < 0.5;
        both += f64::from(u8::from(is_inked && is_ink));
        either += f64::from(u8::from(is_inked || is_ink));
        paper += f64::from(u8::from(!is_ink));
        stained += f64::from(u8::from(is_inked && !is_ink));
    }
    assert!(fit.damage.unwrap().uneven_light);
    assert!(both / either >= 0.9, "IoU {}", both / either);
    assert!(
        stained / paper <= 0.01,
        "{} of the paper is inked",
        stained / paper
    );
}

#[test]
fn a_gradient_below_flat_things_is_no_light() {
    let page = |is_lit: bool| {
        let picture = Image::from_fn(160, 160, 3, |x, y, c| {
            let light = 0.95 - 0.3 * y as f32 / 160.0;
            let within = |[cx, cy]: [f32; 2]| (x as f32 - cx).hypot(y as f32 - cy) < 24.0;
            let color = [0.9, 0.4, 0.35][c];
            match [[50.0, 45.0], [105.0, 110.0]].into_iter().any(within) {
                true => color * if is_lit { light } else { 0.8 },
                false => light,
            }
        });
        noisy(&picture.unwrap(), 3.0)
    };
    let is_light = |is_lit| {
        let found = meant(&page(is_lit)).unwrap();
        found.is_some_and(|found| found.damage.uneven_light)
    };
    assert!(is_light(true), "light falls on all of a page");
    assert!(
        !is_light(false),
        "what is drawn on a gradient is as light everywhere"
    );
}

#[test]
fn spots_of_scanned_paper_are_no_content() {
    // Blots a third of the page wide, in light that falls off by 4 %.
    let blot = |x: usize, y: usize| {
        let [x, y] = [x, y].map(|at| at as f32 / 12.0);
        x.sin() * (0.8 * y + 0.5 * x.cos()).sin()
    };
    let line = |x: usize, y: usize| {
        let [x, y] = [x as f32 + 0.5, y as f32 + 0.5];
        let away = (y - 80.0 - 30.0 * (x / 25.0).sin()).abs() * 0.7;
        match (16.0..144.0).contains(&x) {
            true => (2.5 - away).clamp(0.0, 1.0),
            false => 0.0,
        }
    };
    let scan = Image::from_fn(160, 160, 3, |x, y, _| {
        let paper = 0.93 + 0.014 * blot(x, y) - 0.04 * x as f32 / 160.0;
        paper * (1.0 - 0.8 * line(x, y))
    });
    let scan = noisy(&scan.unwrap(), 2.0);
    // The paper keeps its colour, or is white if that is asked for.
    for (paper, color) in [(Paper::Own, 0.91), (Paper::White, 1.0)] {
        let found = restore::restored(&scan, paper).unwrap().unwrap();
        assert!(found.damage.uneven_light);
        let pixels = (0..160 * 160).map(|i| (line(i % 160, i / 160), found.picture.planes()[0][i]));
        let of = |share: f32| pixels.clone().filter(move |pixel| pixel.0 == share);
        let is_paper = |value: f32| (value - color).abs() < 2.0 / 255.0;
        let alike = of(0.0).filter(|pixel| is_paper(pixel.1)).count();
        let all = of(0.0).count();
        assert!(alike as f32 > 0.98 * all as f32, "{alike} of {all}");
        assert!(of(1.0).all(|pixel| pixel.1 < 0.4));

        let config = Config {
            paper,
            ..Config::default()
        };
        let fit = drawn(&scan, &config);
        // The line comes in 6 to 9 pieces by the noise; spots would be dozens of marks.
        assert!(fit.scene.len() <= 9, "{} marks", fit.scene.len());
        assert!(fit.scene.background.unwrap().into_iter().all(is_paper));
    }
}

#[test]
fn what_is_lighter_than_its_page_stays_lighter() {
    // A red disc with a white border on cream, with the noise of a camera.
    let sticker = |x: usize, y: usize| {
        let away = (x as f32 - 79.5).hypot(y as f32 - 79.5);
        [54.0, 46.0].map(|radius| (radius - away).clamp(0.0, 1.0))
    };
    let cream = [0.955, 0.94, 0.905];
    let clean = Image::from_fn(160, 160, 3, |x, y, c| {
        let [border, disc] = sticker(x, y);
        let page = cream[c] + border * (1.0 - cream[c]);
        page + disc * ([0.8, 0.2, 0.2][c] - page)
    });
    let fit = default(&noisy(&clean.unwrap(), 3.0));
    let page = fit.scene.background.unwrap();
    for (page, cream) in page.into_iter().zip(cream) {
        assert!((page - cream).abs() < 3.0 / 255.0, "{page} of {cream}");
    }
    let is_white = |color: [f32; 3]| color.iter().all(|v| *v > 0.985);
    assert!(fit.scene.marks().any(|mark| is_white(mark.color())));
    assert!(fit.scene.len() <= 4, "{} marks", fit.scene.len());
}

#[test]
fn ink_on_a_grey_page_keeps_its_colour_without_the_page() {
    let ink = [20.0 / 255.0, 40.0 / 255.0, 120.0 / 255.0];
    let clean = Image::from_fn(120, 100, 3, |x, y, c| {
        let away = (x as f32 - 59.5).hypot(y as f32 - 49.5);
        0.5 + (30.0 - away).clamp(0.0, 1.0) * (ink[c] - 0.5)
    });
    let config = Config {
        background: Background::None,
        ..Config::default()
    };
    let fit = drawn(&clean.unwrap(), &config);
    let is_ink = |color: [f32; 3]| color.iter().zip(ink).all(|(a, b)| (a - b).abs() < 0.02);
    assert!(
        fit.scene.marks().any(|mark| is_ink(mark.color())),
        "{}",
        fit.svg()
    );
}

#[test]
fn what_is_darker_than_its_page_is_no_shadow() {
    // A large pale thing in the middle of a white page, with noise that is cut off at white.
    let clean = Image::from_fn(160, 160, 3, |x, y, _| {
        let away = (x as f32 - 84.5).hypot(y as f32 - 92.5);
        1.0 - 0.12 * (50.0 - away).clamp(0.0, 1.0)
    });
    let found = meant(&noisy(&clean.unwrap(), 8.0)).unwrap().unwrap();
    assert!(!found.damage.uneven_light, "{:?}", found.damage);
}

#[test]
fn details_are_counted_without_noise_and_paper() {
    let marked = Image::from_fn(160, 160, 3, |x, y, _| {
        let is_dot = x % 20 < 4 && y % 20 < 4;
        if is_dot {
            0.2
        } else {
            0.9 - 0.1 * x as f32 / 160.0
        }
    });
    let fit = default(&noisy(&marked.unwrap(), 3.0));
    let judged = strokefit::report::Judged::new(fit).unwrap();
    let kept = judged.verdict.fidelity.details_kept.unwrap();
    assert!(kept > 0.9, "{kept}");
}

#[test]
fn what_was_enlarged_is_drawn_as_it_was() {
    let clean = flat_art();
    let (width, height) = (2 * clean.width(), 2 * clean.height());
    // Linear enlargement.
    let enlarged = Image::from_fn(width, height, 3, |x, y, c| {
        let beside = |at: usize, size: usize| {
            let other = if at.is_multiple_of(2) {
                (at / 2).saturating_sub(1)
            } else {
                at / 2 + 1
            };
            [at / 2, other.min(size - 1)]
        };
        let ([x, left], [y, above]) = (beside(x, clean.width()), beside(y, clean.height()));
        let at = |x: usize, y: usize| clean.planes()[c][y * clean.width() + x];
        let row = |y: usize| 0.75 * at(x, y) + 0.25 * at(left, y);
        0.75 * row(y) + 0.25 * row(above)
    })
    .unwrap();
    let [small, large] = [&clean, &enlarged].map(default);
    assert!(
        large.scene.len() <= small.scene.len() + 1,
        "{} marks",
        large.scene.len()
    );
    assert_eq!(large.scene.page, Some([width as u32, height as u32]));
}

#[test]
fn damage_is_told_in_words() {
    let damage = Damage {
        noise: 5.25,
        halved_chroma: true,
        ..Damage::default()
    };
    assert_eq!(
        damage.to_string(),
        "noise of 5.2 levels, colours at half the resolution"
    );
}

#[test]
fn level_and_upright_lines_have_no_stairs() {
    // A grid of lines of two pixels, whose crossings were rounded.
    let dark = |i: usize| (i % 200 + 4) % 16 < 2 || (i / 200 + 4) % 16 < 2;
    let plane: Vec<f32> = (0..200 * 160).map(|i| f32::from(!dark(i))).collect();
    let picture = Image::new(200, 160, [plane.clone(), plane.clone(), plane]).unwrap();
    assert!(meant(&picture).unwrap().is_none());
    let fit = default(&picture);
    assert!(fit.scene.len() < 40, "{} marks", fit.scene.len());
    let db = psnr_db(&fit, &picture);
    assert!(db >= 35.0, "{db}");
}
