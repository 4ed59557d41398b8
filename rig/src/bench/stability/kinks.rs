//! Gradients at kinks: a pixel on the centre line, at the clamp of `h`, at the end of the soft edge, or equally near to two
//! segments of a path. There the gradient has to lie between the slopes of the two sides, and `f32` has to agree with `f64`.

use super::oracle::{Gap, Specimen, oracle, pixels, random, slopes};
use super::{Check, Observation, WITHIN};
use strokefit::Result;
use strokefit::coverage::Coverage;
use strokefit::render::reference::{Scene, squared_error};
use strokefit::render::{Params, StrokeRef, Strokes};

/// Step of the one-sided differences, px or channel values.
const STEP: f64 = 1e-6;

/// Coverage functions without a jump in their derivative.
const SMOOTH: [Coverage; 5] = [
    Coverage::Smoothstep,
    Coverage::Sigmoid,
    Coverage::Tanh,
    Coverage::Atan { k: 1.0 },
    Coverage::Atan { k: 4.0 },
];

const JUMP: &str =
    "the derivative of `raw` jumps at its end, and f32 rounds some pixels to the other side";

/// Largest gradient of the other end of a disc, as a share of the largest gradient.
const ANOTHER_END: f64 = 0.1;

const DISC: &str = "a capsule of zero length is a disc by definition: the gradient of both ends goes to the first, \
                    although the loss also has a slope along the other, different on each side";

pub(super) fn checks() -> Vec<Check<'static>> {
    let check = |name: &'static str, what: &'static str, stroke: Params| {
        Check::new("kinks", name, what, move || {
            let page = around(Strokes::from_iter([&stroke]).get(0));
            Ok(Found::on(&page, &SMOOTH)?.finding())
        })
    };
    let raw = Check::new(
        "kinks",
        "end-of-raw",
        "pixels exactly where `raw` begins to rise",
        || {
            let stroke = Strokes::from_iter([&horizontal(2.5)]);
            let found = Found::on(&around(stroke.get(0)), &[Coverage::Raw])?;
            let rest =
                found.gap.canvas_holds() && found.gap.worth_holds() && found.is_nearly_between();
            Ok(found.finding().excepting(if rest { JUMP } else { "" }))
        },
    );
    let on_the_end = Check::new(
        "kinks",
        "on-the-end",
        "a pixel centre on both ends of a dot",
        || {
            let found = Found::on(&around(Strokes::from_iter([&dot()]).get(0)), &SMOOTH)?;
            let rest = found.gap.holds() && found.outside <= ANOTHER_END;
            Ok(found.finding().excepting(if rest { DISC } else { "" }))
        },
    );
    vec![
        check(
            "on-the-axis",
            "a line of pixel centres on the centre line",
            horizontal(2.0),
        ),
        check(
            "clamp-of-h",
            "pixel centres abreast of the ends, where h is clamped",
            horizontal(4.0),
        ),
        check(
            "end-of-smoothstep",
            "pixel centres where smoothstep begins and ends",
            horizontal(2.75),
        ),
        check(
            "on-the-edge",
            "pixel centres on the edge, d = 0",
            horizontal(3.0),
        ),
        raw,
        on_the_end,
    ]
    .into_iter()
    .chain(along_paths())
    .collect()
}

/// Where a path has kinks: its points, whether each is off it, and whether it is closed.
struct Bend {
    name: &'static str,
    what: &'static str,
    points: &'static [[f32; 2]],
    off: &'static [bool],
    closed: bool,
    exception: &'static str,
}

const MEDIAL: &str = "these pixels are equally near to two segments: all of the derivative goes to one of them, and \
                      f32 may take the other one";

/// Largest excess of a gradient over the one-sided slopes at such pixels.
const MEDIAL_WITHIN: f64 = 1e-2;

const BENDS: [Bend; 7] = [
    Bend {
        name: "joint",
        what: "a point in the middle of a line, on a pixel centre",
        points: &[[6.5, 9.5], [12.5, 9.5], [17.5, 9.5]],
        off: &[false; 3],
        closed: false,
        exception: "",
    },
    Bend {
        name: "corner",
        what: "a right angle on a pixel centre, its arms along pixel centres",
        points: &[[6.5, 4.5], [6.5, 12.5], [17.5, 12.5]],
        off: &[false; 3],
        closed: false,
        exception: MEDIAL,
    },
    Bend {
        name: "cusp",
        what: "a turn by 180° on a pixel centre",
        points: &[[6.5, 9.5], [17.5, 9.5], [6.5, 9.5]],
        off: &[false; 3],
        closed: false,
        exception: "",
    },
    Bend {
        name: "coinciding-points",
        what: "three points in one place between two arms",
        points: &[
            [6.2, 4.1],
            [9.3, 11.7],
            [9.3, 11.7],
            [9.3, 11.7],
            [18.1, 13.2],
        ],
        off: &[false; 5],
        closed: false,
        exception: "",
    },
    Bend {
        name: "crossing",
        what: "a path that crosses itself at right angles on a pixel centre",
        points: &[
            [5.5, 9.5],
            [17.5, 9.5],
            [17.5, 3.5],
            [11.5, 3.5],
            [11.5, 16.5],
        ],
        off: &[false; 5],
        closed: false,
        exception: MEDIAL,
    },
    Bend {
        name: "cusp-of-a-curve",
        what: "a curve that comes back to where it began",
        points: &[[6.5, 9.5], [18.5, 9.5], [6.5, 9.5]],
        off: &[false, true, false],
        closed: false,
        exception: "",
    },
    Bend {
        name: "loop",
        what: "a closed spline about a pixel centre, symmetric on both axes",
        points: &[[6.5, 4.5], [16.5, 4.5], [16.5, 14.5], [6.5, 14.5]],
        off: &[true; 4],
        closed: true,
        exception: MEDIAL,
    },
];

fn along_paths() -> impl Iterator<Item = Check<'static>> {
    BENDS.iter().map(|bend| {
        Check::new("kinks", bend.name, bend.what, || {
            let page = around(StrokeRef {
                points: bend.points,
                off: bend.off,
                closed: bend.closed,
                rings: &[],
                form: None,
                paint: None,
                style: &[2.2, 0.9, 0.2, 0.1, 0.7],
            });
            let found = Found::on(&page, &SMOOTH)?;
            let rest =
                found.gap.canvas_holds() && found.gap.worth_holds() && found.is_nearly_between();
            let note = if rest { bend.exception } else { "" };
            Ok(found.finding().excepting(note))
        })
    })
}

/// The stroke between two ordinary ones, so that there are gradients to compare with.
fn around(stroke: StrokeRef<'_>) -> Specimen {
    let others = random(8, 24, 20, 2);
    let mut strokes = Strokes::new();
    strokes.push(others.get(0));
    strokes.push(stroke);
    strokes.push(others.get(1));
    Specimen::new(24, 20, strokes)
}

/// A stroke along pixel centres, with ends on pixel centres.
fn horizontal(radius: f32) -> Params {
    [6.5, 9.5, 17.5, 9.5, radius, 0.9, 0.2, 0.1, 0.7]
}

fn dot() -> Params {
    [11.5, 9.5, 11.5, 9.5, 3.3, 0.9, 0.2, 0.1, 0.7]
}

/// Findings on a page.
#[derive(Debug, Clone, Copy)]
struct Found {
    gap: Gap,
    /// Excess of gradients over the one-sided slopes.
    outside: f64,
}

impl Found {
    fn on(page: &Specimen, functions: &[Coverage]) -> Result<Self> {
        let mut outside: f64 = 0.0;
        for &coverage in functions {
            outside = outside.max(beyond_slopes(page, coverage)?);
        }
        let gap = page.gap(functions)?;
        Ok(Self { gap, outside })
    }

    fn is_between(self) -> bool {
        self.outside <= WITHIN
    }

    /// True if gradients lie between the slopes within [`MEDIAL_WITHIN`]: where pixels are equally near to two
    /// segments, rounding chooses between two derivatives.
    fn is_nearly_between(self) -> bool {
        self.outside <= MEDIAL_WITHIN
    }

    fn finding(self) -> Observation {
        let Self { gap, outside } = self;
        let figure = format!("{gap}; beyond the one-sided slopes by {outside:.1e}");
        Observation::new(figure, gap.holds() && self.is_between())
    }
}

/// Excess of the reference's gradients over the slopes on both sides, as a share of the largest gradient.
fn beyond_slopes(page: &Specimen, coverage: Coverage) -> Result<f64> {
    let (scene, target) = (page.naive(), pixels(&page.noise()?));
    let reference = oracle(coverage);
    let canvas = reference.render(&scene);
    let loss = |scene: &Scene| {
        let values = (target.len() * 3) as f64;
        squared_error(&reference.render(scene), &target) / values
    };
    let gradients = reference.gradients(&scene, &slopes(&canvas, &target));
    let (mut most, mut outside) = (f64::MIN_POSITIVE, 0.0_f64);
    for (i, gradient) in gradients.strokes.iter().enumerate() {
        for (k, analytic) in gradient.to_params().into_iter().enumerate() {
            let [left, right] = one_sided(&scene, i, k, &loss);
            let (low, high) = (left.min(right), left.max(right));
            outside = outside.max(low - analytic).max(analytic - high);
            most = most.max(analytic.abs());
        }
    }
    Ok(outside / most)
}

/// The slopes of `loss` along number `k` of stroke `i`, from below and from above.
fn one_sided(scene: &Scene, i: usize, k: usize, loss: &impl Fn(&Scene) -> f64) -> [f64; 2] {
    let at = |step: f64| {
        let mut moved = scene.clone();
        let mut params = moved.strokes[i].to_params();
        params[k] += step;
        moved.strokes[i] = moved.strokes[i].with_params(&params);
        loss(&moved)
    };
    let here = at(0.0);
    [(here - at(-STEP)) / STEP, (at(STEP) - here) / STEP]
}
