//! Long paths against capsules of the size of their segments: as many pairs, in fewer strokes.

use std::f32::consts::TAU;

use rig::bench::measure::{DEPTH, StrokeSize};
use strokefit::fit::Simd;
use strokefit::render::{Canvas, Grid, StrokeRef, Strokes};
use strokefit::rng;

use super::count::Count;
use super::{BACKDROP, Bench, OPACITIES, SIZES, Speed, Workload};

/// Segments of a path.
const SEGMENTS: [usize; 3] = [2, 7, 50];

/// Largest turn from one segment to the next, radians.
const TURN: f32 = 1.0;

/// Prints the pairs per second of paths over those of capsules, on one thread. Both take turns, so that other load on the
/// machine slows them alike.
pub(crate) fn print(target: &Canvas, rounds: usize) {
    println!(
        "\npaths: million pairs per second on one thread, and over those of capsules of the size of a segment"
    );
    println!(
        "{:<12} {:>8} {:>8} {:>9} {:>15} {:>15} {:>15} {:>9} {:>11}",
        "strokes",
        "segments",
        "number",
        "lanes/pr",
        "forward",
        "backward",
        "worth",
        "per lane",
        "per segment"
    );
    for (name, radius_px, length_px) in SIZES {
        for opacity in OPACITIES {
            let size = StrokeSize {
                radius_px,
                length_px,
                opacity,
            };
            row(&format!("{name} {opacity:.1}"), size, target, rounds);
        }
    }
}

fn row(name: &str, size: StrokeSize, target: &Canvas, rounds: usize) {
    let grid = target.grid();
    let count = (DEPTH * (grid.width * grid.height) as f32 / size.area_px()) as usize;
    let workload = |strokes| Workload::new(name.to_owned(), strokes, BACKDROP, target);
    let mut workloads = vec![workload(size.strokes(grid, count))];
    workloads.extend(SEGMENTS.map(|n| workload(walks(size, grid, count.div_ceil(n), n))));
    let level = Simd::Auto.level().expect("every machine has a SIMD level");
    let mut benches: Vec<Bench<'_>> = workloads
        .iter()
        .map(|workload| Bench::new(workload, target, level, 1))
        .collect();
    let mut speeds: Vec<Speed> = benches.iter().map(Bench::unmeasured).collect();
    for _ in 0..rounds {
        for (bench, best) in benches.iter_mut().zip(&mut speeds) {
            bench.measure(best);
        }
    }
    benches.iter().for_each(Bench::check);
    let rates = |i: usize| -> [f64; 3] {
        let Speed {
            forward,
            backward,
            worth,
            ..
        } = speeds[i];
        [forward, backward, worth].map(|s| workloads[i].count.pairs as f64 / s / 1e6)
    };
    let lanes_per_pair = |i: usize| {
        let count = &workloads[i].count;
        count.lanes() as f64 / count.pairs as f64
    };
    for (i, workload) in workloads.iter().enumerate() {
        let segments = if i == 0 { 1 } else { SEGMENTS[i - 1] };
        print!(
            "{:<12} {:>8} {:>8} {:>9.2}",
            workload.name,
            segments,
            workload.strokes.len(),
            lanes_per_pair(i)
        );
        for (rate, of_capsules) in rates(i).iter().zip(rates(0)) {
            print!(" {rate:>8.0} {:>5.2}×", rate / of_capsules);
        }
        // Where strokes are opaque, how many pairs are hidden depends on how the strokes lie.
        let [_, backward, _] = rates(i);
        let [_, of_capsules, _] = rates(0);
        let per_lane = backward * lanes_per_pair(i) / (of_capsules * lanes_per_pair(0));
        // A pixel that several segments of a path cover is one pair of the path, and one of each of them.
        let of_segments = Count::of(grid, &capsules(&workload.strokes)).pairs as f64;
        let per_segment = backward / of_capsules * of_segments / workload.count.pairs as f64;
        println!(" {per_lane:>8.2}× {per_segment:>10.2}×");
    }
}

/// The segments of polylines, as strokes of their own.
fn capsules(paths: &Strokes) -> Strokes {
    let mut capsules = Strokes::new();
    for path in paths.iter() {
        for ends in path.points.windows(2) {
            capsules.push(StrokeRef {
                points: ends,
                off: &[false; 2],
                ..path
            });
        }
    }
    capsules
}

/// `count` random walks of `segments` steps of the length of `size`, the same in every run. They turn back at the borders of
/// the picture, so that all of it is covered alike.
fn walks(size: StrokeSize, grid: Grid, count: usize, segments: usize) -> Strokes {
    let mut strokes = Strokes::new();
    let (mut points, off) = (Vec::new(), vec![false; segments + 1]);
    let sides = [grid.width as f32, grid.height as f32];
    for i in 0..count as u64 {
        let draw = |k| rng::draw(0, 7, i, k);
        let mut at = [draw(0) * sides[0], draw(1) * sides[1]];
        let mut angle = draw(2) * TAU;
        points.clear();
        points.push(at);
        for k in 0..segments as u64 {
            angle += TURN * (2.0 * draw(6 + k) - 1.0);
            let mut step = [angle.cos(), angle.sin()].map(|v| v * size.length_px);
            for axis in 0..2 {
                if !(0.0..sides[axis]).contains(&(at[axis] + step[axis])) {
                    step[axis] = -step[axis];
                }
                at[axis] += step[axis];
            }
            angle = step[1].atan2(step[0]);
            points.push(at);
        }
        strokes.push(StrokeRef {
            points: &points,
            off: &off,
            closed: false,
            rings: &[],
            form: None,
            paint: None,
            style: &[size.radius_px, draw(3), draw(4), draw(5), size.opacity],
        });
    }
    strokes
}
