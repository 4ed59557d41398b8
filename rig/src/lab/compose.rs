//! Composition of a picture from coloured strokes.
//!
//! The four strokes of the star, red, green, blue and yellow, are laid on grey one after another:
//! `canvas ← canvas·(1−m) + colour·m` with `m = opacity·coverage`. Shown are `m`, the two products and
//! the canvas after each stroke; opaque, and with an opacity of ½.

use super::star::STAR;
use super::{COVERAGES, ResultFolder, SIZE};
use crate::report::Table;
use crate::report::picture;
use crate::report::plot::{Panel, Sheet};
use strokefit::Result;
use strokefit::coverage::Coverage;
use strokefit::image::Image;
use strokefit::render::reference::{Reference, Rgb, Scene, Stroke};

/// The star's colours.
pub const COLORS: [Rgb; 4] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
];

/// The colour behind.
pub const GRAY: Rgb = [0.5; 3];

const OPACITIES: [f64; 2] = [1.0, 0.5];

/// Renderer of the small colour experiments: pixels at integer coordinates.
pub fn reference(coverage: Coverage) -> Reference {
    Reference {
        eps: 1e-4,
        sample_offset: 0.0,
        ..Reference::new(coverage, 1.0)
    }
}

/// The star in its colours, on grey.
pub fn star(opacity: f64) -> Scene {
    let stroke = |(&[ax, ay, bx, by, radius], [red, green, blue]): (&[f64; 5], Rgb)| {
        Stroke::capsule([ax, ay, bx, by, radius, red, green, blue, opacity])
    };
    Scene {
        width: SIZE,
        height: SIZE,
        background: GRAY,
        strokes: STAR.iter().zip(COLORS).map(stroke).collect(),
    }
}

/// One stroke laid on a canvas, pixel by pixel.
struct Overlay {
    /// `opacity·coverage`.
    m: Vec<f64>,
    /// `canvas·(1−m)`.
    kept: Vec<Rgb>,
    /// `colour·m`.
    added: Vec<Rgb>,
    /// The sum of the two.
    canvas: Vec<Rgb>,
}

/// Writes `compose.csv`, `compose-opaque.png` and `compose-half.png` with the products, and
/// `compose-coverages.png` with the picture by each coverage function.
///
/// # Errors
/// When a file cannot be written.
pub fn run(output: &mut ResultFolder<'_>) -> Result<()> {
    let mut table = Table::new(&["opacity", "stroke", "mean_m", "red", "green", "blue"]);
    for (opacity, name) in OPACITIES.into_iter().zip(["opaque", "half"]) {
        let steps = steps(&star(opacity), reference(Coverage::Smoothstep));
        for (i, step) in steps.iter().enumerate() {
            let mean_m = step.m.iter().sum::<f64>() / step.m.len() as f64;
            let [red, green, blue] = mean(&step.canvas);
            table.row([opacity, (i + 1) as f64, mean_m, red, green, blue]);
        }
        output.picture(&format!("compose-{name}.png"), &sheet(opacity, &steps)?)?;
    }
    output.picture("compose-coverages.png", &coverages()?)?;
    output.text("compose.csv", &table.csv())
}

fn steps(scene: &Scene, reference: Reference) -> Vec<Overlay> {
    let mut canvas = vec![scene.background; SIZE * SIZE];
    let step = |stroke: &Stroke| {
        let m = mask(scene, stroke.clone(), reference);
        let pixels = || canvas.iter().zip(&m);
        let kept: Vec<Rgb> = pixels().map(|(c, &m)| c.map(|c| c * (1.0 - m))).collect();
        let added: Vec<Rgb> = m.iter().map(|&m| stroke.color.map(|c| c * m)).collect();
        let sum = |(x, y): (&Rgb, &Rgb)| std::array::from_fn(|k| x[k] + y[k]);
        canvas = kept.iter().zip(&added).map(sum).collect();
        Overlay {
            m,
            kept,
            added,
            canvas: canvas.clone(),
        }
    };
    scene.strokes.iter().map(step).collect()
}

/// Share of each pixel that the stroke takes: the value of a white stroke on black.
fn mask(scene: &Scene, stroke: Stroke, reference: Reference) -> Vec<f64> {
    let alone = Scene {
        background: [0.0; 3],
        strokes: vec![Stroke {
            color: [1.0; 3],
            ..stroke
        }],
        ..*scene
    };
    reference.render(&alone).iter().map(|rgb| rgb[0]).collect()
}

fn mean(canvas: &[Rgb]) -> Rgb {
    let sum = |k: usize| canvas.iter().map(|rgb| rgb[k]).sum::<f64>();
    std::array::from_fn(|k| sum(k) / canvas.len() as f64)
}

fn sheet(opacity: f64, steps: &[Overlay]) -> Result<Image> {
    let mut panels = Vec::new();
    for (i, step) in steps.iter().enumerate() {
        let n = i + 1;
        panels.push(Panel::new(
            format!("m{n}"),
            picture::map(SIZE, &step.m, picture::gray)?,
        ));
        let rgb = |pixels: &[Rgb]| picture::map(SIZE, pixels, |rgb| rgb);
        panels.push(Panel::new(format!("canvas·(1−m{n})"), rgb(&step.kept)?));
        panels.push(Panel::new(format!("colour·m{n}"), rgb(&step.added)?));
        panels.push(Panel::new(format!("canvas after {n}"), rgb(&step.canvas)?));
    }
    let sheet = Sheet {
        title: format!("four strokes of opacity {opacity} on grey"),
        columns: 4,
        zoom: 3,
        panels,
    };
    sheet.draw()
}

fn coverages() -> Result<Image> {
    let mut panels = Vec::new();
    for opacity in OPACITIES {
        for coverage in COVERAGES {
            let canvas = reference(coverage).render(&star(opacity));
            let title = format!("{coverage}, opacity {opacity}");
            panels.push(Panel::new(title, picture::map(SIZE, &canvas, |rgb| rgb)?));
        }
    }
    let sheet = Sheet {
        title: "the same strokes by other coverage functions".into(),
        columns: COVERAGES.len(),
        zoom: 3,
        panels,
    };
    sheet.draw()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_canvas_is_the_render() {
        for opacity in OPACITIES {
            let reference = reference(Coverage::Sigmoid);
            let scene = star(opacity);
            let steps = steps(&scene, reference);
            let canvas = &steps.last().unwrap().canvas;
            let render = reference.render(&scene);
            let pairs = canvas.as_flattened().iter().zip(render.as_flattened());
            assert!(pairs.clone().all(|(x, y)| (x - y).abs() < 1e-14));
        }
    }
}
