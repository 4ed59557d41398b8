//! The reference: strokes × pixels, `f64`, no cleverness. Slow; the oracle of every faster path.
//!
//! **Forward.** Source-over with opacity, back to front: with `d` the signed distance of a pixel's
//! sample point and `σ` the coverage ([`coverage`](crate::coverage)),
//!
//! ```text
//! m = opacity·σ(d)          C ← C + m(c − C)
//! ```
//!
//! **Backward**, from any `g = ∂L/∂canvas`, per pixel. Pass 1, front to back, gives the
//! transmittance `T` in front of every stroke; pass 2, back to front, carries the colour `B` behind
//! it:
//!
//! ```text
//! ∂L/∂m = T·g·(c − B)       ∂L/∂c = T·m·g        ∂L/∂background = T₀·g
//! ∂L/∂opacity = ∂L/∂m·σ(d)  ∂L/∂d = ∂L/∂m·opacity·σ'(d)
//! ```
//!
//! and from `∂L/∂d` on by the chain rule: to the ends of the nearest segment of the flattened path, and from its vertices to
//! the points that they are means of. Nothing is divided by `1 − m`, so opaque strokes are no
//! special case.
//!
//! **Leave-one-out.** Without stroke `i` a pixel changes by `δ = −T·m·(c − B)`, so the squared
//! error changes by `Σ(2e·δ + δ²)`, exactly, with `e = canvas − target`.
//! [`Reference::leave_one_out_by_removal`] really removes each stroke.
//!
//! **Stiffness.** A shift of a vertex by x across the stroke changes the distance at a pixel by at most `w·x`, with `w` the
//! share of the vertex in the nearest point of the path. So the squared error has, after Gauss and Newton, a second
//! derivative by x of at most `Σ k·w`, `k = 2|∂C/∂d|²` and `∂C/∂d = T·opacity·σ'(d)·(c − B)`, since `w² ≤ w`. Sums of
//! these bounds also hold for vertices that move together, because the `w` of a pixel add up to 1.
//!
//! **Areas.** A stroke with rings is an area: its distance is measured from its contours, and all else is as
//! for a path, without a radius. A cut makes coverage 1 deep inside it as well as 0 far outside.
//!
//! Domain: any finite parameters; a radius of 0 or below leaves the tail of the coverage function,
//! outside of the edge.
//!
//! Source: the gradient of source-over in two passes is what Kerbl et al., "3D Gaussian splatting
//! for real-time radiance field rendering", SIGGRAPH 2023, do front to back; here without their
//! division.

mod outline;
mod scene;

use kurbo::{Point, Vec2};

use crate::coverage::Coverage;
use outline::Outline;
pub use scene::{Rgb, Scene, Stroke};

/// The derivatives of a loss by every number of a [`Scene`], each in the place of its number.
#[derive(Debug, Clone, PartialEq)]
pub struct Gradients {
    /// By the background.
    pub background: Rgb,
    /// By the strokes, in the scene's order.
    pub strokes: Vec<Stroke>,
}

/// The reference renderer: how a scene is turned into pixels.
///
/// Pictures are `width·height` colours, row by row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    /// From signed distance to coverage.
    pub coverage: Coverage,
    /// Width of the soft edge, px.
    pub softness: f64,
    /// ε of the signed distance, px².
    pub eps: f64,
    /// Where in a pixel it is sampled, px from its upper left corner in x and y: ½ is the centre,
    /// and 0 is for data that has pixels at integer coordinates.
    pub sample_offset: f64,
    /// True if coverage beyond [`Coverage::support`] is dropped, as the fast renderer does.
    pub cut: bool,
}

impl Reference {
    /// Samples at pixel centres, with ε = 0 and no cut.
    pub fn new(coverage: Coverage, softness: f64) -> Self {
        Self {
            coverage,
            softness,
            eps: 0.0,
            sample_offset: 0.5,
            cut: false,
        }
    }

    /// The picture of `scene`.
    pub fn render(&self, scene: &Scene) -> Vec<Rgb> {
        let outlines = outlines(scene);
        self.samples(scene)
            .map(|p| {
                let strokes = scene.strokes.iter().zip(&outlines);
                strokes.fold(scene.background, |behind, (stroke, outline)| {
                    let (color, share) = stroke.ink(p);
                    let m = stroke.opacity * share * self.covered(outline, p).0;
                    over(behind, color, m)
                })
            })
            .collect()
    }

    /// The derivatives of a loss by every number of `scene`, from `d_canvas = ∂L/∂canvas`.
    pub fn gradients(&self, scene: &Scene, d_canvas: &[Rgb]) -> Gradients {
        let outlines = outlines(scene);
        let mut background = [0.0; 3];
        let mut strokes: Vec<Stroke> = scene.strokes.iter().map(Stroke::zero).collect();
        let vertices = |outline: &Outline| vec![Vec2::ZERO; outline.means.len()];
        let mut slopes: Vec<Vec<Vec2>> = outlines.iter().map(vertices).collect();
        for (p, &g) in self.samples(scene).zip(d_canvas) {
            let layers = self.layers(scene, &outlines, p);
            // T₀: the backdrop shows through the rearmost stroke and all in front of it.
            let through = layers
                .first()
                .map_or(1.0, |back| back.transmittance * (1.0 - back.m));
            add(&mut background, through, g);
            for (i, layer) in layers.iter().enumerate() {
                let stroke = &scene.strokes[i];
                let d_distance = accumulate(&mut strokes[i], stroke, layer, g);
                for (vertex, by) in outlines[i].by_vertices(p, self.eps) {
                    slopes[i][vertex] += by * d_distance;
                }
            }
        }
        for ((stroke, outline), slopes) in strokes.iter_mut().zip(&outlines).zip(slopes) {
            // From vertices to points by the transpose of flattening.
            let mut by_points = vec![Vec2::ZERO; stroke.points.len()];
            for (mean, slope) in outline.means.iter().zip(slopes) {
                mean.hand_back(slope, &mut by_points);
            }
            stroke.points = by_points.into_iter().map(|by| [by.x, by.y]).collect();
        }
        Gradients {
            background,
            strokes,
        }
    }

    /// The stiffness of every vertex of the flattened path of each stroke.
    pub fn stiffness(&self, scene: &Scene) -> Vec<Vec<f64>> {
        let outlines = outlines(scene);
        let mut stiffness: Vec<Vec<f64>> =
            outlines.iter().map(|s| vec![0.0; s.means.len()]).collect();
        for p in self.samples(scene) {
            for (i, layer) in self.layers(scene, &outlines, p).iter().enumerate() {
                let reach = layer.reach();
                let by_distance = layer.transmittance * scene.strokes[i].opacity * layer.slope;
                let k = 2.0 * by_distance * by_distance * dot(reach, reach);
                // The derivatives by both ends are u·(1−h) and u·h, so their lengths are the shares.
                for (vertex, by) in outlines[i].by_vertices(p, 0.0) {
                    stiffness[i][vertex] += k * by.hypot();
                }
            }
        }
        stiffness
    }

    /// For each stroke, the change of the sum of squared errors over all values if it were removed.
    /// Positive where a stroke is worth having.
    pub fn leave_one_out(&self, scene: &Scene, target: &[Rgb]) -> Vec<f64> {
        let mut changes = vec![0.0; scene.strokes.len()];
        let (canvas, outlines) = (self.render(scene), outlines(scene));
        for (k, p) in self.samples(scene).enumerate().take(target.len()) {
            for (i, layer) in self.layers(scene, &outlines, p).iter().enumerate() {
                for channel in 0..3 {
                    let e = canvas[k][channel] - target[k][channel];
                    // Without the stroke, its colour behind shows in its place: (e + δ)² − e² = 2eδ + δ².
                    let delta = -layer.transmittance * layer.m * layer.reach()[channel];
                    changes[i] += 2.0 * e * delta + delta * delta;
                }
            }
        }
        changes
    }

    /// [`leave_one_out`](Self::leave_one_out) by rendering the scene again without
    /// each stroke.
    pub fn leave_one_out_by_removal(&self, scene: &Scene, target: &[Rgb]) -> Vec<f64> {
        let whole = squared_error(&self.render(scene), target);
        (0..scene.strokes.len())
            .map(|i| {
                let mut rest = scene.clone();
                rest.strokes.remove(i);
                squared_error(&self.render(&rest), target) - whole
            })
            .collect()
    }

    /// The sample points of all pixels, row by row.
    fn samples(&self, scene: &Scene) -> impl Iterator<Item = Point> + use<> {
        let (width, offset) = (scene.width, self.sample_offset);
        let at = move |i| i as f64 + offset;
        (0..scene.height).flat_map(move |y| (0..width).map(move |x| Point::new(at(x), at(y))))
    }

    /// Coverage and its derivative by the distance.
    fn covered(&self, outline: &Outline, p: Point) -> (f64, f64) {
        // The fast renderer drops coverage beyond the support, and gives an area full coverage at the same depth inside.
        let d = outline.distance(p, self.eps);
        let support = self.coverage.support(self.softness);
        if self.cut && d < -support {
            return (0.0, 0.0);
        }
        if self.cut && outline.is_area && d > support {
            return (1.0, 0.0);
        }
        let value = self.coverage.value(d, self.softness);
        (value, self.coverage.derivative(d, self.softness))
    }

    /// Each stroke at the sample point `p`, back to front.
    fn layers(&self, scene: &Scene, outlines: &[Outline], p: Point) -> Vec<Layer> {
        // Back to front: the colour behind each stroke. Then front to back: the transmittance in front of it.
        let mut behind = scene.background;
        let mut layers = Vec::with_capacity(scene.strokes.len());
        for (stroke, outline) in scene.strokes.iter().zip(outlines) {
            let (coverage, slope) = self.covered(outline, p);
            let (color, share) = stroke.ink(p);
            let (coverage, slope) = (share * coverage, share * slope);
            let m = stroke.opacity * coverage;
            layers.push(Layer {
                color,
                coverage,
                slope,
                m,
                behind,
                transmittance: 1.0,
            });
            behind = over(behind, color, m);
        }
        let mut transmittance = 1.0;
        for layer in layers.iter_mut().rev() {
            layer.transmittance = transmittance;
            transmittance *= 1.0 - layer.m;
        }
        layers
    }
}

/// The sum of squared differences over all values.
pub fn squared_error(canvas: &[Rgb], target: &[Rgb]) -> f64 {
    let values = canvas.as_flattened().iter().zip(target.as_flattened());
    values.map(|(c, t)| (c - t) * (c - t)).sum()
}

/// One stroke at one sample point.
struct Layer {
    color: Rgb,
    /// Coverage, times the opacity of the gradient.
    coverage: f64,
    /// Derivative of the coverage by the distance.
    slope: f64,
    /// Opacity times coverage.
    m: f64,
    /// The colour of all strokes behind.
    behind: Rgb,
    /// Share of the stroke that those in front let through.
    transmittance: f64,
}

/// The outlines of all strokes.
fn outlines(scene: &Scene) -> Vec<Outline> {
    scene.strokes.iter().map(Stroke::outline).collect()
}

/// Adds the derivatives of one pixel, where `∂L/∂canvas = g`, by the style of `stroke`; returns `∂L/∂d` there.
fn accumulate(sum: &mut Stroke, stroke: &Stroke, layer: &Layer, g: Rgb) -> f64 {
    let d_m = layer.transmittance * dot(g, layer.reach());
    let d_distance = d_m * stroke.opacity * layer.slope;
    if stroke.rings.is_empty() {
        sum.radius += d_distance;
    }
    if stroke.paint.is_none() {
        add(&mut sum.color, layer.transmittance * layer.m, g);
    }
    sum.opacity += d_m * layer.coverage;
    d_distance
}

impl Layer {
    /// `c − B`.
    fn reach(&self) -> Rgb {
        std::array::from_fn(|k| self.color[k] - self.behind[k])
    }
}

fn over(behind: Rgb, color: Rgb, m: f64) -> Rgb {
    std::array::from_fn(|k| behind[k] + m * (color[k] - behind[k]))
}

fn dot(x: Rgb, y: Rgb) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// `sum += weight·x`.
fn add<const N: usize>(sum: &mut [f64; N], weight: f64, x: [f64; N]) {
    for (sum, x) in sum.iter_mut().zip(x) {
        *sum += weight * x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::PointKind;

    const RED: Rgb = [1.0, 0.0, 0.0];

    fn pixel(strokes: Vec<Stroke>) -> Scene {
        Scene {
            width: 1,
            height: 1,
            background: [0.5; 3],
            strokes,
        }
    }

    fn red(opacity: f64) -> Stroke {
        Stroke {
            points: vec![[0.5, 0.5]],
            kinds: vec![PointKind::On],
            closed: false,
            rings: Vec::new(),
            radius: 5.0,
            color: RED,
            opacity,
            paint: None,
        }
    }

    #[test]
    fn strokes_are_laid_over_what_is_behind() {
        let reference = Reference::new(Coverage::Smoothstep, 1.0);
        assert_eq!(reference.render(&pixel(vec![])), [[0.5; 3]]);
        assert_eq!(reference.render(&pixel(vec![red(1.0)])), [RED]);
        assert_eq!(
            reference.render(&pixel(vec![red(0.5)])),
            [[0.75, 0.25, 0.25]]
        );
        let blue = Stroke {
            color: [0.0, 0.0, 1.0],
            ..red(0.5)
        };
        assert_eq!(
            reference.render(&pixel(vec![red(1.0), blue])),
            [[0.5, 0.0, 0.5]]
        );
    }

    #[test]
    fn pixels_are_sampled_where_they_are_said_to_be() {
        let mut reference = Reference::new(Coverage::Raw, 1.0);
        let dot = Stroke {
            points: vec![[1.0, 0.0]],
            radius: 0.0,
            ..red(1.0)
        };
        let scene = Scene {
            width: 3,
            ..pixel(vec![dot])
        };
        let gray = [0.5; 3];
        reference.sample_offset = 0.0;
        assert_eq!(reference.render(&scene), [gray, [0.75, 0.25, 0.25], gray]);
        reference.sample_offset = 0.5;
        let canvas = reference.render(&scene);
        assert_eq!(canvas[0], canvas[1]);
        assert!(canvas[0][0] > canvas[2][0]);
    }

    #[test]
    fn a_cut_drops_tails_and_nothing_else() {
        let mut reference = Reference::new(Coverage::Sigmoid, 1.0);
        let scene = Scene {
            width: 20,
            ..pixel(vec![red(1.0)])
        };
        let whole = reference.render(&scene);
        reference.cut = true;
        let cut = reference.render(&scene);
        let changed = (0..20).filter(|&x| whole[x] != cut[x]);
        assert_eq!(changed.collect::<Vec<_>>(), (12..20).collect::<Vec<_>>());
        assert_eq!(cut[12], [0.5; 3]);
    }

    #[test]
    fn a_scene_of_the_crate_can_be_rendered() {
        use crate::math::Point;
        use crate::scene;
        let mut scene = scene::Scene::empty(1, 1, None);
        scene.stages.push(scene::Stage::from_iter([scene::Stroke {
            path: scene::Path::dot(Point::new(0.5, 0.5)),
            radius: 5.0,
            radii: Vec::new(),
            cap: scene::Cap::Round,
            color: [1.0, 0.0, 0.0],
            opacity: 0.5,
        }]));
        let scene = Scene::from(&scene);
        assert_eq!(scene.strokes, [red(0.5)]);
        assert_eq!(scene.background, [1.0; 3]);
    }
}
