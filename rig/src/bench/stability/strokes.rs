//! Degenerate and absurd strokes. Canvas, gradients and worths in `f32` are compared with the reference, and
//! the file of the scene has to be readable.

use super::oracle::{BACKGROUND, Specimen, random, random_paths};
use super::{Check, Observation};
use strokefit::Result;
use strokefit::coverage::Coverage;
use strokefit::render::{Params, StrokeRef, Strokes};
use strokefit::rng;
use strokefit::scene::{Quantized, Scene, Stage};
use strokefit::svg::{self, WriteOptions};
use strokefit::verify;

/// A scene of one kind of trouble.
struct HardScene {
    name: &'static str,
    what: &'static str,
    page: Specimen,
    functions: &'static [Coverage],
    exception: &'static str,
}

const HIDDEN: &str = "each stroke hides another of its own colour, so the true gradients of ends are almost 0; the \
                      rest is the cutoff below 1/16384 of the light";

pub(super) fn checks() -> Vec<Check<'static>> {
    let gaps = scenes().into_iter().map(|hard| {
        Check::new("strokes", hard.name, hard.what, move || {
            let (written, is_right) = written(&hard.page)?;
            let gap = hard.page.gap(hard.functions)?;
            let finding = gap.finding();
            let figure = format!("{}; {written}", finding.figure);
            if !is_right || !gap.canvas_holds() {
                return Ok(Observation::new(figure, false));
            }
            let finding = finding.excepting(hard.exception);
            Ok(Observation { figure, ..finding })
        })
    });
    gaps.chain([Check::new(
        "strokes",
        "not-finite",
        "each number of a stroke NaN, +∞ and −∞ in turn: dropped and counted, the rest is drawn",
        poisoned,
    )])
    .collect()
}

fn scenes() -> Vec<HardScene> {
    let hard = |name, what, strokes: &[Params]| HardScene {
        name,
        what,
        page: Specimen::new(40, 36, strokes.iter().collect()),
        functions: &Coverage::EACH,
        exception: "",
    };
    let red = |a: [f32; 2], b: [f32; 2], radius: f32, opacity: f32| {
        [a[0], a[1], b[0], b[1], radius, 0.9, 0.2, 0.1, opacity]
    };
    let across = |radius, opacity| red([5.2, 6.1], [30.4, 25.7], radius, opacity);
    vec![
        HardScene {
            page: Specimen::new(40, 36, random(1, 40, 36, 30)),
            ..hard("random", "30 strokes of mixed size and opacity", &[])
        },
        hard(
            "coincident-ends",
            "both ends in one place",
            &[red([20.3, 17.1], [20.3, 17.1], 4.2, 0.7)],
        ),
        hard(
            "nearly-coincident-ends",
            "ends 10⁻⁴ px apart",
            &[red([20.3, 17.1], [20.3001, 17.1], 4.2, 0.7)],
        ),
        hard("radius-0", "a radius of 0", &[across(0.0, 0.9)]),
        hard("radius-negative", "a radius of −2 px", &[across(-2.0, 0.9)]),
        hard(
            "off-canvas",
            "wholly off the canvas",
            &[red([-50.0, -9.0], [-45.0, 50.0], 3.0, 1.0)],
        ),
        hard(
            "across-the-edge",
            "partly off the canvas",
            &[red([-12.0, 8.0], [60.0, 30.0], 5.0, 0.6)],
        ),
        hard("opacity-0", "an opacity of 0", &[across(3.0, 0.0)]),
        hard("opacity-1", "an opacity of 1", &[across(3.0, 1.0)]),
        HardScene {
            page: Specimen::new(40, 36, opaque_stack()),
            ..hard("opaque-stack", "30 opaque strokes, stacked", &[])
        },
        hard(
            "covers-everything",
            "one opaque stroke over the canvas, one on top",
            &[
                red([20.0, 18.0], [21.0, 18.0], 90.0, 1.0),
                red([9.0, 9.0], [30.0, 20.0], 3.0, 0.5),
            ],
        ),
        HardScene {
            page: pile(10_000, red([3.0, 4.0], [9.0, 7.0], 2.0, 0.001)),
            functions: &[Coverage::Smoothstep, Coverage::Sigmoid],
            ..hard(
                "identical-strokes",
                "10,000 identical strokes of opacity 0.001",
                &[],
            )
        },
        HardScene {
            page: pile(10_000, red([3.0, 4.0], [9.0, 7.0], 2.0, 1.0)),
            exception: HIDDEN,
            functions: &[Coverage::Smoothstep, Coverage::Sigmoid],
            ..hard(
                "identical-opaque-strokes",
                "10,000 identical opaque strokes",
                &[],
            )
        },
        HardScene {
            page: Specimen::new(40, 36, random_paths(1, 40, 36, 20)),
            ..hard(
                "random-paths",
                "20 paths with corners and curves, every other one closed",
                &[],
            )
        },
        HardScene {
            page: Specimen::new(40, 36, walk(1000)),
            ..hard(
                "1000-points",
                "one translucent path of 1,000 points that crosses itself all over",
                &[],
            )
        },
        hard(
            "length-10^6",
            "a capsule of 10⁶ px through the canvas",
            &[red([-5e5, -4e5], [5e5, 4.001e5], 2.0, 0.5)],
        ),
        hard(
            "coordinates-10^6",
            "one end in the canvas, the other at (10⁶, 10⁶) px",
            &[red([7.0, 5.0], [1e6, 1e6], 2.0, 0.5)],
        ),
    ]
}

/// One path of `points` points in small steps.
fn walk(points: usize) -> Strokes {
    let mut at = [20.0, 18.0];
    let step = |i: u64| {
        for (k, v) in at.iter_mut().enumerate() {
            *v = (*v + 6.0 * (rng::draw(4, k as u64, i, 0) - 0.5)).clamp(-3.0, 43.0);
        }
        at
    };
    let places: Vec<[f32; 2]> = (0..points as u64).map(step).collect();
    let mut strokes = Strokes::new();
    strokes.push(StrokeRef {
        points: &places,
        off: &vec![false; points],
        closed: false,
        rings: &[],
        form: None,
        paint: None,
        style: &[1.2, 0.9, 0.2, 0.1, 0.6],
    });
    strokes
}

/// Page of one stroke, `count` times.
fn pile(count: usize, stroke: Params) -> Specimen {
    Specimen::new(12, 12, std::iter::repeat_n(stroke, count).collect())
}

fn opaque_stack() -> Strokes {
    let mut strokes = random(3, 40, 36, 30);
    strokes.change(|_, stroke| {
        let [radius, .., opacity] = stroke.style;
        *radius += 4.0;
        *opacity = 1.0;
    });
    strokes
}

fn scene(page: &Specimen) -> Scene {
    let (width, height) = (page.width as u32, page.height as u32);
    Scene {
        stages: vec![Stage::from_iter(page.strokes.iter().map(|s| s.to_mark()))],
        ..Scene::empty(width, height, Some(BACKGROUND))
    }
}

/// Writes, reads back and draws; says what became of the strokes, and whether they are read as they were
/// written.
fn written(page: &Specimen) -> Result<(String, bool)> {
    let scene = scene(page);
    let quantized = scene.quantized(2);
    let text = svg::write(&scene, &WriteOptions::default());
    let back = svg::read(&text)?;
    verify::render(&text, verify::Size::Scale(1.0), None)?;
    let figure = format!(
        "file: {} strokes, {} dropped",
        back.len(),
        quantized.dropped.total()
    );
    Ok((figure, back == quantized.scene))
}

/// Strokes with numbers that are none, among five that are sound.
fn poisoned() -> Result<Observation> {
    let sound = Specimen::new(40, 36, random(2, 40, 36, 5));
    let kept = scene(&sound).quantized(2).scene.len();
    let (mut dropped, mut wrong) = (0, Vec::new());
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for k in 0..9 {
            let mut page = sound.clone();
            page.strokes.push(sound.strokes.get(0));
            let number = page.strokes.range(5).start + k;
            page.strokes.numbers_mut()[number] = bad;
            let Quantized {
                scene: quantized,
                dropped: out,
                ..
            } = scene(&page).quantized(2);
            dropped += out.total() + kept - 5;
            let text = svg::write(&scene(&page), &WriteOptions::default());
            let drawn = verify::render(&text, verify::Size::Scale(1.0), None).is_ok();
            let sane = svg::read(&text).is_ok_and(|back| back == quantized);
            if !drawn || !sane || quantized.len() != kept {
                wrong.push(format!("number {k} {bad}"));
            }
        }
    }
    let figure = if wrong.is_empty() {
        format!("27 of 27 dropped and counted ({dropped}), every file valid")
    } else {
        format!("wrong: {}", wrong.join(", "))
    };
    Ok(Observation::new(figure, wrong.is_empty() && dropped == 27))
}

#[cfg(test)]
mod tests {
    use super::super::oracle::{oracle, pixels, slopes};
    use super::*;

    #[test]
    fn what_is_not_finite_is_dropped_and_counted() {
        let finding = poisoned().unwrap();
        assert!(finding.figure.starts_with("27 of 27"), "{}", finding.figure);
    }

    /// Checks what the exception of identical opaque strokes says: there is next to nothing to be wrong about.
    #[test]
    fn identical_opaque_strokes_have_next_to_no_gradients() {
        let stroke = [3.0, 4.0, 9.0, 7.0, 2.0, 0.9, 0.2, 0.1, 1.0];
        let page = pile(1000, stroke);
        let (scene, target) = (page.naive(), pixels(&page.noise().unwrap()));
        let reference = oracle(Coverage::Smoothstep);
        let canvas = reference.render(&scene);
        let gradients = reference.gradients(&scene, &slopes(&canvas, &target));
        let ends = gradients.strokes.iter().flat_map(|s| &s.points).flatten();
        let steepest = ends.fold(0.0, |most: f64, v| most.max(v.abs()));
        let worths = reference.leave_one_out(&scene, &target).into_iter();
        let dearest = worths.fold(0.0, |most: f64, v| most.max(v.abs()));
        assert!(
            steepest < 1e-6 && dearest < 1e-4,
            "{steepest:e} {dearest:e}"
        );
    }

    #[test]
    fn a_wrong_gradient_would_be_seen() {
        let mut page = Specimen::new(20, 20, random(4, 20, 20, 5));
        let target = page.noise().unwrap();
        let coverage = Coverage::Smoothstep;
        assert!(page.gap_under(coverage, &target).unwrap().holds());
        page.strokes.numbers_mut()[0] = f32::NAN;
        assert!(!page.gap_under(coverage, &target).unwrap().holds());
    }
}
