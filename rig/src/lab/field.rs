//! Which way does the loss pull a circle, from everywhere?
//!
//! The mean squared error of a circle of radius 8 against a target at 1.5 × the centre, (48, 48),
//! for every position of the circle's centre, and its gradient by that position: as stream lines over the loss.
//! Where no line begins the slope is 0, and descent cannot leave.

use rayon::prelude::*;

use super::descent::Problem;
use super::matching::{Form, Matching, Samples};
use super::{COVERAGES, ResultFolder, SIZE};
use crate::report::Table;
use crate::report::picture::{self, heat};
use crate::report::plot::{Panel, Path, Sheet};
use strokefit::Result;
use strokefit::coverage::Coverage;
use strokefit::math;

const TARGET: [f64; 3] = [48.0, 48.0, 8.0];
const RADIUS: f64 = 8.0;

/// ε of the signed distance, px². Added to the square: the article's way of adding it, to both
/// components (see [`convergence`](super::convergence)), tilts even a plateau a little.
const EPS: f64 = 1e-4;

/// Px between the positions in the table.
const TABLE_STEP: usize = 2;
/// Px between the starts of stream lines.
const STREAM_STEP: usize = 7;

/// The slope, per px, below which there is said to be none.
const FLAT: f64 = 1e-12;

/// Loss and slope at one position of the centre.
#[derive(Debug, Clone, Copy, Default)]
struct Slope {
    loss: f64,
    d_x: f64,
    d_y: f64,
}

/// The slopes at all integer positions, row by row.
struct Field {
    coverage: Coverage,
    slopes: Vec<Slope>,
}

/// Writes `field.csv` and `field-streams.png`.
///
/// # Errors
/// When a file cannot be written.
pub fn run(output: &mut ResultFolder) -> Result<()> {
    output.doing(
        0.0,
        "the loss at every position, for six coverage functions",
    );
    let coverages = [Coverage::Raw].into_iter().chain(COVERAGES);
    let fields: Vec<Field> = coverages.map(Field::new).collect();
    output.text("field.csv", &table(&fields).csv())?;
    let sheet = Sheet {
        title: "stream lines of the descent, over the loss".into(),
        columns: 3,
        zoom: 6,
        panels: fields.iter().map(Field::panel).collect::<Result<_>>()?,
    };
    output.picture("field-streams.png", &sheet.draw()?)
}

fn table(fields: &[Field]) -> Table {
    let mut table = Table::new(&["coverage", "x", "y", "loss", "d_x", "d_y"]);
    for field in fields {
        for (x, y) in positions(TABLE_STEP) {
            let Slope { loss, d_x, d_y } = field.at(x, y);
            let place = [x, y].map(|v| v.to_string());
            let numbers = [loss, d_x, d_y].map(|v| format!("{v:e}"));
            let coverage = [field.coverage.to_string()];
            table.row(coverage.into_iter().chain(place).chain(numbers));
        }
    }
    table
}

fn positions(step: usize) -> impl Iterator<Item = (usize, usize)> {
    let ys = (step / 2..SIZE).step_by(step);
    ys.flat_map(move |y| (step / 2..SIZE).step_by(step).map(move |x| (x, y)))
}

impl Field {
    fn new(coverage: Coverage) -> Self {
        let samples = Samples {
            size: SIZE,
            origin: 0.0,
            eps: EPS,
        };
        let problem = Matching {
            samples,
            form: Form::Circle,
            coverage,
            target: samples.draw(Form::Circle, &TARGET, Coverage::Raw),
            radii: [f64::NEG_INFINITY, f64::INFINITY],
        };
        let slope = |i: usize| {
            let mut gradient = [0.0; 3];
            let params = [(i % SIZE) as f64, (i / SIZE) as f64, RADIUS];
            let loss = problem.evaluate(&params, &mut gradient);
            let [d_x, d_y, _] = gradient;
            Slope { loss, d_x, d_y }
        };
        Self {
            coverage,
            slopes: (0..SIZE * SIZE).into_par_iter().map(slope).collect(),
        }
    }

    /// Nearest position on the grid.
    fn at(&self, x: usize, y: usize) -> Slope {
        self.slopes[y.min(SIZE - 1) * SIZE + x.min(SIZE - 1)]
    }

    fn panel(&self) -> Result<Panel> {
        let losses: Vec<f64> = self.slopes.iter().map(|slope| slope.loss).collect();
        let most = losses.iter().copied().fold(0.0, f64::max);
        let image = picture::map(SIZE, &losses, |loss| heat(loss / most))?;
        Ok(Panel {
            paths: self.streams(),
            ..Panel::new(self.coverage, image)
        })
    }

    fn streams(&self) -> Vec<Path> {
        let stream = |(x, y): (usize, usize)| self.stream([x as f64, y as f64]);
        let streams = positions(STREAM_STEP).map(stream);
        let line = |points| Path {
            points,
            color: [255; 3],
            arrow: true,
        };
        streams
            .filter(|points| points.len() > 2)
            .map(line)
            .collect()
    }

    /// Where the descent goes from `p`: steps of ½ px down the slope, until it ends or turns back.
    fn stream(&self, mut p: [f64; 2]) -> Vec<[f64; 2]> {
        let mut points = Vec::new();
        let mut before = [0.0; 2];
        for _ in 0..4 * SIZE {
            let inside = p.iter().all(|x| (0.0..=(SIZE - 1) as f64).contains(x));
            let Some(down) = self.down(p).filter(|_| inside) else {
                break;
            };
            if down[0] * before[0] + down[1] * before[1] < 0.0 {
                break;
            }
            points.push(p.map(|x| x + 0.5));
            p = [p[0] + down[0] / 2.0, p[1] + down[1] / 2.0];
            before = down;
        }
        points
    }

    /// The direction of descent at `p`, between the positions of the grid; none where it is flat.
    fn down(&self, p: [f64; 2]) -> Option<[f64; 2]> {
        let cell = p.map(|x| x.clamp(0.0, (SIZE - 2) as f64) as usize);
        let part = [p[0] - cell[0] as f64, p[1] - cell[1] as f64];
        let mut sum = [0.0; 2];
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let slope = self.at(cell[0] + i, cell[1] + j);
            let along = |k: usize, far| if far == 1 { part[k] } else { 1.0 - part[k] };
            let weight = along(0, i) * along(1, j);
            sum[0] -= weight * slope.d_x;
            sum[1] -= weight * slope.d_y;
        }
        let length = math::hypot(sum[0], sum[1]);
        (length > FLAT).then(|| sum.map(|x| x / length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_reach_where_compact_functions_do_not() {
        let far = |coverage| {
            let Slope { d_x, d_y, .. } = Field::new(coverage).at(8, 8);
            math::hypot(d_x, d_y)
        };
        assert!(far(Coverage::Atan { k: 1.0 }) > 1e-6);
        assert!(far(Coverage::Smoothstep) < FLAT);
        assert!(far(Coverage::Raw) < FLAT);
    }

    #[test]
    fn streams_end_at_the_target() {
        let field = Field::new(Coverage::Atan { k: 1.0 });
        let end = *field.stream([40.0, 52.0]).last().unwrap();
        assert!(math::hypot(end[0] - 48.5, end[1] - 48.5) < 1.5, "{end:?}");
    }
}
