//! A loss of one's own, and the descent by hand: only brightness matters, colours are free.
//!
//! The renderer knows no loss, the optimiser no strokes; what joins them is here.
//!
//! ```sh
//! cargo run --release --example loss -- samples/chelsea-cat.png pop.svg
//! ```

use strokefit::coverage::Coverage;
use strokefit::fit::Simd;
use strokefit::image::Image;
use strokefit::optim::{Adam, Schedule};
use strokefit::render::{
    Backdrop, Canvas, CanvasLoss, Gradients, Grid, PARAMS, Params, Renderer, Softness, StrokeMut,
    Strokes, TileRgb,
};
use strokefit::scene::{Scene, Stage};
use strokefit::svg::{self, WriteOptions};
use strokefit::{Error, ErrorKind, rng};

const STROKES: usize = 500;
const STEPS: usize = 300;
const GREY: [f32; 3] = [0.5; 3];

/// Shares of red, green and blue in brightness (Rec. 709).
pub(crate) const SHARES: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Squared error of brightness, summed over the pixels.
struct Brightness {
    target: Canvas,
}

impl CanvasLoss for Brightness {
    fn tile(
        &self,
        tile: usize,
        canvas: &TileRgb,
        mut error: Option<&mut TileRgb>,
        gradient: &mut TileRgb,
    ) -> f64 {
        let target = &self.target.tiles()[tile];
        let mut loss = 0.0;
        for block in 0..canvas.len() {
            for lane in 0..canvas[block][0].0.len() {
                let mut brightness = 0.0;
                for channel in 0..3 {
                    let e = canvas[block][channel].0[lane] - target[block][channel].0[lane];
                    if let Some(error) = &mut error {
                        error[block][channel].0[lane] = e;
                    }
                    brightness += SHARES[channel] * e;
                }
                for channel in 0..3 {
                    gradient[block][channel].0[lane] = 2.0 * SHARES[channel] * brightness;
                }
                loss += f64::from(brightness * brightness);
            }
        }
        loss
    }
}

/// Draws `picture` in the right brightness and any colour.
pub(crate) fn draw(picture: &Image) -> strokefit::Result<Scene> {
    let loss = Brightness {
        target: Canvas::from_image(picture),
    };
    let mut strokes: Strokes = (0..STROKES as u64).map(|i| random(i, picture)).collect();
    descend(&mut strokes, &loss, picture)?;
    let stage = Stage::from_iter(strokes.iter().map(|stroke| stroke.to_mark()));
    let (width, height) = (picture.width() as u32, picture.height() as u32);
    Ok(Scene {
        stages: vec![stage],
        ..Scene::empty(width, height, Some(GREY))
    })
}

/// Stroke `i` of a random start: anywhere, of any colour.
fn random(i: u64, picture: &Image) -> Params {
    let at = |k: u64, side: usize| rng::draw(0, 0, i, k) * side as f32;
    let (x, y) = (at(0, picture.width()), at(1, picture.height()));
    let [red, green, blue] = [2, 3, 4].map(|k| rng::draw(0, 0, i, k));
    [
        x,
        y,
        x + at(5, 16) - 8.0,
        y + at(6, 16) - 8.0,
        4.0,
        red,
        green,
        blue,
        1.0,
    ]
}

fn descend(strokes: &mut Strokes, loss: &Brightness, picture: &Image) -> strokefit::Result<()> {
    let level = Simd::Auto
        .level()
        .ok_or_else(|| Error::new(ErrorKind::Config, "no SIMD level on this machine"))?;
    let mut renderer = Renderer::new(Grid::new(picture.width(), picture.height()), level);
    let mut adam = Adam::new(strokes.len() * PARAMS, Default::default());
    // Ends, radius, colour, opacity: px and shades want steps of their own.
    let rates: Params = [0.5, 0.5, 0.5, 0.5, 0.2, 0.02, 0.02, 0.02, 0.0];
    let scales = rates.repeat(strokes.len());
    let (schedule, mut gradients) = (Schedule::Cosine { end: 0.1 }, Gradients::default());
    for step in 0..STEPS {
        // From a soft edge, which sees far, to the edge that rasterisers draw.
        let width = 1.0 + 3.0 * (1.0 - step as f32 / STEPS as f32);
        let coverage = Coverage::Smoothstep;
        let softness = Softness { coverage, width };
        renderer.backward(
            strokes,
            softness,
            Backdrop::Color(GREY),
            loss,
            &mut gradients,
        );
        let rate = schedule.factor(step, STEPS) as f32;
        adam.step_scaled(strokes.numbers_mut(), &gradients.strokes, rate, &scales);
        strokes.change(|_, stroke| clamp(stroke, picture));
    }
    Ok(())
}

/// Brings a stroke back to where it can be seen.
fn clamp(stroke: StrokeMut<'_>, picture: &Image) {
    let far = [picture.width() as f32, picture.height() as f32];
    for [x, y] in stroke.points {
        *x = x.clamp(0.0, far[0]);
        *y = y.clamp(0.0, far[1]);
    }
    let [radius, shades @ ..] = stroke.style;
    *radius = radius.clamp(0.6, far[0]);
    for shade in shades {
        *shade = shade.clamp(0.0, 1.0);
    }
}

#[allow(dead_code, reason = "the tests call `draw`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let (Some(input), Some(output)) = (args.next(), args.next()) else {
        return Err("say which picture to draw, and which SVG to write".into());
    };
    let scene = draw(&Image::open(input)?)?;
    std::fs::write(output, svg::write(&scene, &WriteOptions::default()))?;
    Ok(())
}
