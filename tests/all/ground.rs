//! What lies on the page itself: gradients, soft shadows and glows are chosen where the picture has them, and kept.

use crate::support::{draft, drawn, on_white, rendered, sample};
use strokefit::fit::{Background, Base, Colors, Config, Fitter};
use strokefit::image::Image;
use strokefit::machine::{self, Sheet};
use strokefit::metrics::Quality;
use strokefit::scene::{Blurs, Scene, Shape};
use strokefit::{svg, verify};

/// A ramp with a red square on it.
fn sign() -> Image {
    let (width, height) = (96, 64);
    let ends = [[0.2, 0.9], [0.5, 0.6], [0.9, 0.3]];
    let level = |x: usize, y: usize, c: usize| {
        if (30..50).contains(&x) && (20..40).contains(&y) {
            return [0.9, 0.1, 0.1][c];
        }
        let [from, to] = ends[c];
        let part = (x as f32 + 0.5) / width as f32;
        ((from + (to - from) * part) * 255.0).round() / 255.0
    };
    Image::from_fn(width, height, 3, level).unwrap()
}

fn has_gradient(scene: &Scene) -> bool {
    scene.ground.iter().any(|area| area.shade.is_some())
}

/// A ring, a frame and a line in one colour on paper of another.
fn logo(paper: &str, ink: &str) -> Image {
    on_white(&format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="150" height="100"><rect width="150" height="100" fill="{paper}"/><g fill="none" stroke="{ink}" stroke-width="8"><circle cx="50" cy="44" r="26"/><rect x="86" y="20" width="50" height="44" rx="9"/><path d="M14 86L136 82"/></g></svg>"##
    ))
}

#[test]
fn paper_of_any_colour_is_left_out() {
    let config = Config {
        background: Background::None,
        ..Config::default()
    };
    for (paper, ink) in [
        ("#fff", "#223"),
        ("#101830", "#e8ecf8"),
        ("#f4e8d0", "#3c281e"),
        ("#b0283c", "#fff"),
    ] {
        let fit = drawn(&logo(paper, ink), &config);
        assert_eq!(
            (fit.scene.background, fit.scene.len()),
            (None, 3),
            "{paper}"
        );
        let verdict = verify::verify(&fit.svg(), &fit.target, &fit.soft, fit.matte).unwrap();
        let db = verdict.fidelity.psnr_db;
        assert!(verdict.agrees() && db > 38.0, "{paper}: {verdict:?}");
        let seen = verify::render(&fit.svg(), verify::Size::Scale(1.0), None).unwrap();
        let covered = seen.alpha().unwrap().iter().sum::<f32>() / 15_000.0;
        assert!((0.2..0.3).contains(&covered), "{paper}: {covered}");
    }
}

/// The blur of a dark shape, and what casts it.
const CARD: &str = r##"<rect x="30" y="34" width="110" height="60" rx="9" fill="#102040" fill-opacity="0.45" filter="url(#f)"/>
<rect x="30" y="28" width="110" height="60" rx="9" fill="#fdfdfd"/><circle cx="60" cy="58" r="14" fill="#e05020"/>"##;
const STAR: &str = r##"<path d="M86 18L100 56 140 58 108 82 120 122 86 98 52 122 64 82 30 58 70 56z" fill="#30c0ff" filter="url(#f)"/>
<path d="M86 18L100 56 140 58 108 82 120 122 86 98 52 122 64 82 30 58 70 56z" fill="#fff6d0"/>"##;

/// A picture of 170×130 px of these elements on a page of a colour, or on none, as resvg draws it.
fn picture(page: Option<&str>, blur: f32, elements: &str) -> Image {
    let page = page.map_or_else(String::new, |color| {
        format!(r##"<rect width="170" height="130" fill="{color}"/>"##)
    });
    let text = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="170" height="130"><filter id="f" x="-50%" y="-50%" width="200%" height="200%" color-interpolation-filters="sRGB"><feGaussianBlur stdDeviation="{blur}"/></filter>{page}{elements}</svg>"##
    );
    if page.is_empty() {
        rendered(&text)
    } else {
        on_white(&text)
    }
}

fn judged(picture: &Image, config: &Config) -> (Scene, Quality) {
    let fit = drawn(picture, config);
    let verdict = verify::verify(&fit.svg(), &fit.target, &fit.soft, fit.matte).unwrap();
    assert!(verdict.agreement.psnr_db > 38.0, "{verdict:?}");
    assert_eq!(svg::read(&fit.svg()).unwrap(), fit.scene);
    assert_eq!(svg::lint(&fit.svg()), []);
    (fit.scene, verdict.fidelity)
}

#[test]
fn cards_that_are_lighter_than_their_page_have_a_shadow_each() {
    let cards = r##"<g fill="#141850" fill-opacity="0.25" filter="url(#f)"><rect x="14" y="28" width="64" height="80" rx="8"/><rect x="92" y="28" width="64" height="80" rx="8"/></g>
<g fill="#fff"><rect x="14" y="20" width="64" height="80" rx="8"/><rect x="92" y="20" width="64" height="80" rx="8"/></g>"##;
    let (scene, fidelity) = judged(&picture(Some("#f6f7fb"), 5.0, cards), &Config::default());
    assert_eq!((scene.ground.len(), scene.len()), (2, 2));
    for shadow in &scene.ground {
        assert!((shadow.blur - 5.0).abs() < 0.8, "{shadow:?}");
        let shape = shadow.rings[0].shape();
        assert!(matches!(shape, Some(Shape::Rect { .. })), "{shadow:?}");
    }
    assert!(fidelity.ssimulacra2 > 85.0, "{fidelity:?}");
}

#[test]
fn a_glow_and_a_fade_are_a_gradient_each() {
    for name in ["glow-300", "fade-400"] {
        let picture = sample(name);
        let fit = drawn(&picture, &Config::default());
        assert!(has_gradient(&fit.scene) && fit.scene.len() <= 40, "{name}");
        let seen = verify::on_mattes(&fit.svg(), &picture).unwrap();
        for score in [
            seen.black_ssimulacra2,
            seen.white_ssimulacra2,
            seen.magenta_ssimulacra2,
        ] {
            assert!(score >= 85.0, "{name}: {seen:?}");
        }
    }
}

#[test]
fn strokes_are_drawn_on_a_gradient() {
    let fit = drawn(&sign(), &draft(20));
    assert!(has_gradient(&fit.scene) && fit.scene.background.is_none());
    assert!(!fit.scene.is_empty());
    let verdict = verify::verify(&fit.svg(), &fit.target, &fit.soft, fit.matte).unwrap();
    let [seen, agreement] = [verdict.fidelity.psnr_db, verdict.agreement.psnr_db];
    assert!(seen > 30.0 && agreement > 36.0, "{verdict:?}");
    assert_eq!(svg::read(&fit.svg()).unwrap(), fit.scene);
}

#[test]
fn a_card_casts_the_shadow_that_was_drawn() {
    let card = picture(Some("#e8ecf2"), 6.0, CARD);
    let (scene, fidelity) = judged(&card, &Config::default());
    let [shadow] = &scene.ground[..] else {
        panic!("{:?}", scene.ground);
    };
    assert!((shadow.blur - 6.0).abs() < 0.8, "{shadow:?}");
    let Some(Shape::Rect { low, high, .. }) = shadow.rings[0].shape() else {
        panic!("{shadow:?}");
    };
    let sides = [low.x - 30.0, low.y - 34.0, high.x - 140.0, high.y - 94.0];
    assert!(sides.iter().all(|off| off.abs() < 1.5), "{shadow:?}");
    assert!(scene.len() <= 4 && fidelity.psnr_db > 46.0, "{fidelity:?}");
}

/// True for each area of the ground that is blurred.
fn blurs(scene: &Scene) -> Vec<bool> {
    scene.ground.iter().map(|area| area.blur > 0.0).collect()
}

#[test]
fn a_card_on_a_card_casts_its_shadow_on_that() {
    let cards = r##"<rect x="16" y="18" width="138" height="100" rx="10" fill="#203060" fill-opacity="0.35" filter="url(#f)"/>
<rect x="16" y="14" width="138" height="100" rx="10" fill="#fff"/>
<rect x="50" y="46" width="70" height="40" rx="6" fill="#203060" fill-opacity="0.5" filter="url(#f)"/>
<rect x="50" y="42" width="70" height="40" rx="6" fill="#ffd76e"/>"##;
    let (scene, fidelity) = judged(&picture(Some("#e8ecf4"), 4.0, cards), &Config::default());
    assert_eq!(blurs(&scene), [true, false, true], "{:?}", scene.ground);
    assert_eq!(scene.ground[1].color, [1.0; 3]);
    for shadow in [&scene.ground[0], &scene.ground[2]] {
        assert!((shadow.blur - 4.0).abs() < 0.8, "{shadow:?}");
    }
    assert!(scene.len() == 1 && fidelity.psnr_db > 46.0, "{fidelity:?}");
}

#[test]
fn a_shadow_across_two_colours_is_one() {
    let card = r##"<rect y="60" width="170" height="70" fill="#3556d8"/><circle cx="85" cy="66" r="36" fill="#000" fill-opacity="0.3" filter="url(#f)"/><circle cx="85" cy="60" r="36" fill="#fff"/>"##;
    let (scene, fidelity) = judged(&picture(Some("#ffcf5a"), 5.0, card), &Config::default());
    assert_eq!(blurs(&scene), [false, true], "{:?}", scene.ground);
    let shadow = &scene.ground[1];
    // Black is where the lines of both colours meet.
    assert!(shadow.color.iter().all(|c| *c < 0.06), "{shadow:?}");
    assert!((shadow.opacity - 0.3).abs() < 0.03, "{shadow:?}");
    assert!(matches!(
        shadow.rings[0].shape(),
        Some(Shape::Circle { .. })
    ));
    assert!(scene.len() == 1 && fidelity.psnr_db > 46.0, "{fidelity:?}");
}

/// A white glyph with a shadow on a tile with a gradient, on a page of the glyph's colour.
const TILE: &str = r##"<defs><linearGradient id="g" x2="0" y2="1"><stop stop-color="#2bb673"/><stop offset="1" stop-color="#0b6e4f"/></linearGradient></defs>
<rect x="15" y="5" width="140" height="120" rx="26" fill="url(#g)"/>
<path d="M60 36h54v18h-34v16h28v18h-28v30h-20z" fill="#000" fill-opacity="0.4" filter="url(#f)"/>
<path d="M60 32h54v18h-34v16h28v18h-28v30h-20z" fill="#fff"/>"##;

#[test]
fn a_glyph_casts_its_shadow_on_a_gradient() {
    let (scene, fidelity) = judged(&picture(Some("#fff"), 4.0, TILE), &Config::default());
    assert_eq!(blurs(&scene), [false, true], "{:?}", scene.ground);
    assert!(scene.ground[0].shade.is_some());
    assert!((scene.ground[1].blur - 4.0).abs() < 0.8);
    assert!(scene.len() == 1 && fidelity.psnr_db > 44.0, "{fidelity:?}");
}

#[test]
fn a_ball_casts_an_ellipse_on_the_floor() {
    let ball = r##"<rect y="80" width="170" height="50" fill="#d9b48a"/><ellipse cx="85" cy="104" rx="46" ry="9" fill="#3a2208" fill-opacity="0.5" filter="url(#f)"/><circle cx="85" cy="62" r="40" fill="#d9483b"/>"##;
    let (scene, fidelity) = judged(&picture(Some("#bfe3ee"), 4.0, ball), &Config::default());
    assert_eq!(blurs(&scene), [false, true], "{:?}", scene.ground);
    let Some(Shape::Ellipse { center, radii }) = scene.ground[1].rings[0].shape() else {
        panic!("{:?}", scene.ground[1]);
    };
    let off = [
        center.x - 85.0,
        center.y - 104.0,
        radii[0] - 46.0,
        radii[1] - 9.0,
    ];
    assert!(
        off.iter().all(|off| off.abs() < 4.0),
        "{center:?} {radii:?}"
    );
    assert!(scene.len() == 1 && fidelity.psnr_db > 44.0, "{fidelity:?}");
}

#[test]
fn steps_are_shadows_without_filters() {
    let config = Config {
        blurs: Blurs::Steps,
        ..Config::default()
    };
    let tile = picture(Some("#fff"), 4.0, TILE);
    let fit = drawn(&tile, &config);
    let text = fit.svg();
    assert!(
        !text.contains("filter") && fit.scene.ground.len() > 8,
        "{text}"
    );
    assert_eq!(svg::read(&text).unwrap(), fit.scene);
    let verdict = verify::verify(&text, &fit.target, &fit.soft, fit.matte).unwrap();
    assert!(verdict.fidelity.psnr_db > 40.0, "{verdict:?}");
}

#[test]
fn machines_cut_what_lies_below_shadows() {
    let fit = drawn(&picture(Some("#fff"), 4.0, TILE), &Config::default());
    let text = |scene: &Scene| {
        let sheet = Sheet { scene, width: None };
        machine::dxf(&sheet)
    };
    let bare = Scene {
        ground: Vec::new(),
        ..fit.scene.clone()
    };
    assert!(text(&fit.scene).len() > text(&bare).len());
}

#[test]
fn a_glow_around_a_star_is_a_blur_of_it_on_a_page_and_on_none() {
    for page in [Some("#101428"), None] {
        let star = picture(page, 7.0, STAR);
        let (scene, fidelity) = judged(&star, &Config::default());
        assert!(!scene.ground.is_empty(), "{page:?}");
        assert!(
            scene.len() <= 3 && fidelity.psnr_db > 42.0,
            "{page:?} {fidelity:?}"
        );
    }
}

#[test]
fn a_refined_drawing_keeps_its_ground() {
    let card = picture(Some("#e8ecf2"), 5.0, CARD);
    for (picture, config) in [(sign(), draft(5)), (card, Config::default())] {
        let first = drawn(&picture, &config);
        assert_eq!(first.scene.ground.len(), 1);
        let base = Base::read(first.svg(), &picture, false).unwrap();
        let second = Fitter::new(draft(20)).on(base).fit(&picture).unwrap();
        assert_eq!(second.scene.ground, first.scene.ground);
        assert_eq!(svg::read(&second.svg()).unwrap(), second.scene);
    }
}

#[test]
fn a_background_or_colours_that_are_given_leave_none() {
    let background = |background| Config {
        background,
        ..draft(9)
    };
    let few_colors = Config {
        colors: Colors::AtMost(3),
        ..draft(9)
    };
    let white = background(Background::Color([1.0; 3]));
    let card = picture(Some("#e8ecf2"), 5.0, CARD);
    for (picture, config) in [
        (&sign(), &white),
        (&sign(), &background(Background::None)),
        (&sign(), &few_colors),
        (&card, &white),
        (&card, &few_colors),
    ] {
        assert_eq!(drawn(picture, config).scene.ground, []);
    }
}

#[test]
fn only_a_glow_and_a_fade_have_a_gradient_and_neither_has_a_shadow() {
    let others = [
        "chelsea-cat",
        "coffee-300",
        "rocket-320",
        "noto-gem",
        "noto-hibiscus",
        "bicycle",
    ];
    for name in others.into_iter().chain(["glow-300", "fade-400"]) {
        let scene = drawn(&sample(name), &draft(9)).scene;
        assert_eq!(has_gradient(&scene), !others.contains(&name), "{name}");
        assert!(scene.ground.iter().all(|area| area.blur == 0.0), "{name}");
    }
}
