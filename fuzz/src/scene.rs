//! Scenes of any numbers: quantised, written, read back, drawn by our renderer and, now and then, by resvg.
//!
//! Most runs stay on their own thread: a scene has a tile or two, for which workers would have to be woken.

use std::cell::RefCell;

use rayon::{ThreadPool, ThreadPoolBuilder};
use strokefit::coverage::Coverage;
use strokefit::fit::{Objective, Simd};
use strokefit::loss::Loss;
use strokefit::math::{self, Point};
use strokefit::render::{Backdrop, Canvas, Gradients, Renderer, Softness, Strokes};
use strokefit::scene::{
    Arc, Area, Cap, Mark, Path, PathPoint, PointKind, Quantized, Scene, Stroke,
};
use strokefit::verify::{self, Size};
use strokefit::{image::Image, svg};

/// One run in so many is done by several threads, and one is drawn by resvg.
const SELDOM: u8 = 32;

/// The bytes of an input, taken one after the other; zeros where there are no more.
struct Source<'a>(&'a [u8]);

impl Source<'_> {
    fn byte(&mut self) -> u8 {
        match self.0.split_first() {
            Some((&byte, rest)) => {
                self.0 = rest;
                byte
            }
            None => 0,
        }
    }

    /// Any float: bits as they come, or, three times in four, one of a size that occurs.
    fn float(&mut self) -> f32 {
        let bits = u32::from_le_bytes([(); 4].map(|()| self.byte()));
        match bits >> 30 {
            3 => f32::from_bits(bits.rotate_left(2)),
            2 => (bits & 0xffff) as f32 / 65535.0,
            _ => ((bits & 0x3fff_ffff) as f32 / (1 << 22) as f32) - 64.0,
        }
    }

    fn mark(&mut self) -> Mark {
        let [ax, ay, bx, by, radius, red, green, blue, opacity] = [(); 9].map(|()| self.float());
        let (a, b) = (math::point([ax, ay]), math::point([bx, by]));
        let color = [red, green, blue];
        let path = match self.byte() % 12 {
            0 | 1 => Path::dot(a),
            2 => self.path([PathPoint::on(a), PathPoint::on(b)], false),
            3 => self.path([PathPoint::on(a), PathPoint::off(b)], true),
            4 => {
                let ring =
                    |source: &mut Self| source.path([PathPoint::on(a), PathPoint::off(b)], true);
                return Area::plain(self.rings(ring), color, opacity).into();
            }
            8 => self.mixed_path([a, b], false),
            9 => self.mixed_path([a, b], true),
            10 => {
                let ring = |source: &mut Self| source.mixed_path([a, b], true);
                return Area::plain(self.rings(ring), color, opacity).into();
            }
            _ => Path::line(a, b),
        };
        let stroke = Stroke {
            path,
            radius: radius.into(),
            radii: Vec::new(),
            cap: if self.byte().is_multiple_of(4) {
                Cap::Butt
            } else {
                Cap::Round
            },
            color,
            opacity,
        };
        if !self.byte().is_multiple_of(4) {
            return stroke.into();
        }
        let vertices = stroke.path.points().iter().filter(|p| p.is_on());
        let radii = vertices.map(|_| f64::from(self.float())).collect();
        let varying = Stroke::varying(stroke.path.clone(), radii, color, opacity);
        varying.unwrap_or(stroke).into()
    }

    /// One ring to three.
    fn rings(&mut self, ring: impl Fn(&mut Self) -> Path) -> Vec<Path> {
        let count = 1 + self.byte() % 3;
        (0..count).map(|_| ring(self)).collect()
    }

    fn point(&mut self) -> Point {
        math::point([self.float(), self.float()])
    }

    /// A path with up to seven more points between these two, on or off it.
    fn path(&mut self, [start, end]: [PathPoint; 2], closed: bool) -> Path {
        let kinds = self.byte();
        let between = (0..kinds % 8).map(|i| PathPoint {
            at: self.point(),
            kind: PointKind::on_if(kinds >> (i + 1) & 1 == 1),
        });
        let points = [start].into_iter().chain(between).chain([end]).collect();
        Path::new(points, closed).expect("an open path has its ends on it")
    }

    /// A path of up to four pieces of all kinds, which starts and ends at these places; a closed one comes back from there by one
    /// more.
    fn mixed_path(&mut self, [start, end]: [Point; 2], closed: bool) -> Path {
        let mut ends = vec![start];
        ends.extend((0..self.byte() % 4).map(|_| self.point()));
        ends.push(end);
        let next = ends.iter().cycle().skip(1);
        let pairs = ends.iter().zip(next).map(|(a, b)| [*a, *b]);
        let points = pairs.flat_map(|ends| {
            let between = self.between(ends);
            [PathPoint::on(ends[0])].into_iter().chain(between)
        });
        let mut points: Vec<PathPoint> = points.collect();
        if !closed {
            let last = points.iter().rposition(PathPoint::is_on);
            points.truncate(last.map_or(0, |last| last + 1));
        }
        Path::new(points, closed).expect("a piece between two points on a path")
    }

    /// The points of a line, a curve or an arc between its ends.
    fn between(&mut self, ends: [Point; 2]) -> Vec<PathPoint> {
        match self.byte() % 6 {
            0 => vec![],
            1 => vec![PathPoint::off(self.point())],
            2 => vec![PathPoint::off(self.point()), PathPoint::off(self.point())],
            3 => vec![
                PathPoint::cubic(self.point()),
                PathPoint::cubic(self.point()),
            ],
            4 => vec![PathPoint::arc(self.point())],
            // Half circles are what rounding has to take care of.
            _ => vec![PathPoint::arc(Arc::of_bulge(ends, 1.0).through)],
        }
    }

    fn scene(&mut self) -> Scene {
        let (width, height) = (1 + self.byte() % 70, 1 + self.byte() % 40);
        let background = [(); 3].map(|()| self.float());
        let background = self.byte().is_multiple_of(2).then_some(background);
        let mut scene = Scene::empty(width.into(), height.into(), background);
        for _ in 0..self.byte() % 3 {
            let stage = (0..self.byte() % 8).map(|_| self.mark()).collect();
            scene.stages.push(stage);
        }
        scene
    }

    fn softness(&mut self) -> Softness {
        let coverage = match self.byte() % 4 {
            0 => Coverage::Smoothstep,
            1 => Coverage::Sigmoid,
            2 => Coverage::Tanh,
            _ => Coverage::Atan { k: 4.0 },
        };
        let width = 0.05 + f32::from(self.byte()) / 40.0;
        Softness { coverage, width }
    }
}

/// An SVG says all that it can, and its render is finite; anything else is dropped without harm.
pub fn scene(data: &[u8]) {
    let mut source = Source(data);
    let (scene, softness, precision) = (source.scene(), source.softness(), source.byte() % 8);
    let Quantized {
        scene: quantized,
        dropped,
        ..
    } = scene.quantized(precision);
    assert_eq!(quantized.len() + dropped.total(), scene.len());
    let text = svg::write(
        &scene,
        &svg::WriteOptions {
            precision,
            ..Default::default()
        },
    );
    assert_eq!(
        svg::read(&text).expect("what is written can be read"),
        quantized
    );
    // Numbers of all kinds do no harm, those of a drawing give a picture.
    let draw_both = || {
        draw(&scene, softness);
        draw(&quantized, softness).expect("a drawing has a finite render");
    };
    match source.byte() % SELDOM {
        1 => draw_both(),
        _ => ALONE.with(|pool| pool.install(draw_both)),
    }
    if source.byte() % SELDOM == 1
        && let Ok(image) = verify::render(&text, Size::Scale(1.0), None)
    {
        assert_eq!(
            (image.width(), image.height()),
            (scene.width as usize, scene.height as usize)
        );
    }
}

thread_local! {
    /// This thread alone.
    static ALONE: ThreadPool = ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build()
        .expect("a pool that starts no thread");
    /// Gradients are written over and over, as in a fit.
    static GRADIENTS: RefCell<Gradients> = RefCell::default();
}

/// The canvas and the gradients of `scene`, if all of them are finite.
fn draw(scene: &Scene, softness: Softness) -> Option<()> {
    let strokes: Strokes = scene.marks().collect();
    let background = scene.background.unwrap_or([1.0; 3]);
    let target = Image::filled(scene.width as usize, scene.height as usize, [0.5; 3]).ok()?;
    let target = Canvas::from_image(&target);
    let mut renderer = Renderer::new(target.grid(), Simd::Auto.level()?);
    let mut canvas = Canvas::flat(target.grid(), background);
    renderer.forward(&strokes, softness, Backdrop::Color(background), &mut canvas);
    let finite = |values: &[f32]| values.iter().all(|v| v.is_finite());
    let objective = Objective::new(Loss::L2, &target);
    GRADIENTS.with_borrow_mut(|gradients| {
        let backdrop = Backdrop::Color(background);
        renderer.backward_with_contributions(&strokes, softness, backdrop, &objective, gradients);
        let picture = canvas.to_image();
        let is_finite = picture.planes().iter().all(|plane| finite(plane))
            && finite(&gradients.strokes)
            && finite(&gradients.contribution);
        is_finite.then_some(())
    })
}
