//! Do coloured strokes find coloured strokes?
//!
//! The star's sixteen strokes, in random colours on grey, against the star in its own, composited
//! one over another; 200 steps. Every stroke has eight numbers: its ends, radius and colour. Colours
//! go from 0 to 1 where positions go from 0 to 64, so they learn at a tenth of the positions' rate.

use rayon::prelude::*;

use super::convergence::{STAR, START, STEPS, convergence, push_descent, show};
use super::descent::{Method, Problem, descend};
use super::{COVERAGES, ResultFolder, SIZE};
use crate::report::picture;
use crate::report::plot::Panel;
use strokefit::Result;
use strokefit::coverage::Coverage;
use strokefit::loss::Loss;
use strokefit::render::OPACITY;
use strokefit::render::reference::{Reference, Rgb, Scene, Stroke};
use strokefit::rng;

const METHODS: [Method; 2] = [Method::Adam(0.5), Method::RmsProp(0.1)];

/// Ends, radius and colour; no opacity.
const PARAMS: usize = OPACITY;

/// Where the colour begins among them.
const RED: usize = 5;

/// The learning rate of colours over that of positions.
const COLOR_RATE: f64 = 0.1;

/// Key of the random colours.
const SEED: u64 = 1;

/// The star's colours, and that behind.
const COLORS: [Rgb; 4] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
];
const GRAY: Rgb = [0.5; 3];

/// Pixels at integer coordinates.
fn reference(coverage: Coverage) -> Reference {
    Reference {
        eps: 1e-4,
        sample_offset: 0.0,
        ..Reference::new(coverage, 1.0)
    }
}

/// The mean squared error of opaque strokes on grey against a picture.
struct Coloring {
    reference: Reference,
    target: Vec<Rgb>,
}

impl Coloring {
    fn new(coverage: Coverage) -> Self {
        Self {
            reference: reference(coverage),
            target: reference(Coverage::Raw).render(&scene(&star())),
        }
    }
}

impl Problem<f64> for Coloring {
    fn evaluate(&self, params: &[f64], gradient: &mut [f64]) -> f64 {
        let scene = scene(params);
        let canvas = self.reference.render(&scene);
        let (canvas, target) = (canvas.as_flattened(), self.target.as_flattened());
        let d_canvas = Loss::L2.gradient(canvas, target);
        let gradients = self.reference.gradients(&scene, d_canvas.as_chunks().0);
        for (to, from) in gradient.chunks_exact_mut(PARAMS).zip(&gradients.strokes) {
            to.copy_from_slice(&from.to_params()[..PARAMS]);
        }
        Loss::L2.mean(canvas, target)
    }

    fn clamp(&self, params: &mut [f64]) {
        for stroke in params.chunks_exact_mut(PARAMS) {
            for color in &mut stroke[RED..] {
                *color = color.clamp(0.0, 1.0);
            }
        }
    }

    fn scales(&self, len: usize) -> Vec<f64> {
        let scale = |i: usize| if i % PARAMS < RED { 1.0 } else { COLOR_RATE };
        (0..len).map(scale).collect()
    }
}

fn scene(params: &[f64]) -> Scene {
    let opaque = |&[ax, ay, bx, by, radius, red, green, blue]: &[f64; PARAMS]| {
        Stroke::capsule([ax, ay, bx, by, radius, red, green, blue, 1.0])
    };
    Scene {
        width: SIZE,
        height: SIZE,
        background: GRAY,
        strokes: params.as_chunks().0.iter().map(opaque).collect(),
    }
}

/// The star in its colours.
fn star() -> Vec<f64> {
    let rows = STAR.into_iter().zip(COLORS);
    rows.flat_map(|(shape, color)| shape.into_iter().chain(color))
        .collect()
}

fn start() -> Vec<f64> {
    let color = |i, k| f64::from(rng::draw(SEED, 0, i, k));
    let rows = (0..).zip(START);
    let row = |(i, shape): (u64, [f64; 5])| shape.into_iter().chain([0, 1, 2].map(|k| color(i, k)));
    rows.flat_map(row).collect()
}

/// Writes `colors.csv`, and per optimiser a chart of the losses and a sheet of the drawings.
///
/// # Errors
/// When a file cannot be written.
pub fn run(output: &mut ResultFolder) -> Result<()> {
    let mut table = convergence();
    for (i, method) in METHODS.into_iter().enumerate() {
        let name = format!("colors-{method}");
        output.doing(i as f64 / METHODS.len() as f64, &name);
        let descent = |&c: &Coverage| descend(&Coloring::new(c), &start(), method, STEPS);
        let descents: Vec<_> = COVERAGES.par_iter().map(descent).collect();
        for (coverage, descent) in COVERAGES.iter().zip(&descents) {
            let (coverage, method) = (coverage.to_string(), method.to_string());
            let labels = ["colors", "", &coverage, &method, "random"];
            push_descent(&mut table, &labels.map(str::to_owned), descent);
        }
        let descents: Vec<_> = COVERAGES.into_iter().zip(descents).collect();
        let target = Some(panel(Coverage::Raw, &star())?);
        show(output, &name, &descents, target, |coverage, descent| {
            panel(coverage, descent.last())
        })?;
    }
    output.text("colors.csv", &table.csv())
}

fn panel(coverage: Coverage, params: &[f64]) -> Result<Panel> {
    let canvas = reference(coverage).render(&scene(params));
    let image = picture::map(SIZE, &canvas, |rgb| rgb)?;
    Ok(Panel::new("target", image))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_descent_gets_better() {
        let problem = Coloring::new(Coverage::Sigmoid);
        let descent = descend(&problem, &start(), METHODS[0], 10);
        assert!(descent.loss_at(10) < 0.9 * descent.loss_at(0));
        assert_eq!(descent.last().len(), 16 * PARAMS);
    }
}
