//! Forms that are held while points move: a shape stays one of its kind, and a line that is exactly level or upright stays
//! so. A descent follows what its slopes leave of the form, and after each step the nearest such form takes the place of the
//! points, as rounding and the optimiser's own scales move them a little off it.

use crate::math;
use crate::render::{Form, StrokeRef, Strokes};
use crate::scene::{Band, Cap, Path, PathPoint, PointKind, Stroke};

/// The forms among the free strokes of a drawing.
#[derive(Debug, Clone, Default)]
pub(in crate::fit) struct Constraints {
    /// Strokes and areas that are shapes or bands, by their indices. Of a band, the places of coordinates that lines of its
    /// middle have in common.
    formed: Vec<(usize, Form, Places)>,
    /// Places, among all numbers of the free strokes, of coordinates that are equal.
    equal: Places,
}

/// Groups of places of numbers that are equal.
type Places = Vec<Vec<usize>>;

impl Constraints {
    /// The forms that areas have, and the first `formed` strokes. Others are level by chance.
    pub(in crate::fit) fn of(strokes: &Strokes, formed: usize) -> Self {
        let mut constraints = Self::forms(strokes);
        let found = strokes.iter().enumerate();
        let free = found.filter(|(i, stroke)| *i < formed || stroke.is_area());
        for (i, stroke) in free.filter(|(_, stroke)| stroke.form.is_none()) {
            let start = strokes.range(i).start;
            let paths = stroke.paths();
            let equal = paths.flat_map(|(first, path)| equal(path, start + 2 * first));
            constraints.equal.extend(equal);
        }
        constraints
    }

    /// The forms alone: a shape stays one of its kind, and a band is none any more once its points have moved each by itself.
    pub(in crate::fit) fn forms(strokes: &Strokes) -> Self {
        let form = |(i, stroke): (usize, StrokeRef<'_>)| match stroke.form? {
            Form::Band => Some((i, Form::Band, equal_of(&stroke.band()?))),
            shape => Some((i, shape, Places::new())),
        };
        Self {
            formed: strokes.iter().enumerate().filter_map(form).collect(),
            equal: Places::new(),
        }
    }

    /// Projects slopes onto the changes that keep each form: a shape moves and grows, a level line moves as a whole.
    pub(in crate::fit) fn project(&self, strokes: &Strokes, slopes: &mut [f32]) {
        for (i, form, _) in &self.formed {
            let change = slopes[places(strokes, *i)].as_chunks_mut().0;
            match (form, strokes.get(*i).band()) {
                (Form::Shape(kind), _) => kind.project(change),
                (Form::Band, Some(band)) => band.project(change),
                (Form::Band, None) => {}
                // The points follow from the line and its radii, which no step changes.
                (Form::Sweep, _) => change.fill([0.0; 2]),
            }
        }
        for places in &self.equal {
            level(places, slopes);
        }
    }

    /// Gives all points of a shape the largest of their squared slopes, so that an optimiser scales them alike.
    pub(in crate::fit) fn share(&self, strokes: &Strokes, squares: &mut [f32]) {
        for (i, ..) in &self.formed {
            let points = &mut squares[places(strokes, *i)];
            let most = points.iter().copied().fold(0.0, f32::max);
            // With one second moment for all points a step is the projected gradient times a constant, which keeps the form.
            points.fill(most);
        }
    }

    /// True if there is none.
    pub(in crate::fit) fn is_empty(&self) -> bool {
        self.formed.is_empty() && self.equal.is_empty()
    }

    /// Restores the forms after their points have moved.
    pub(in crate::fit) fn restore(&self, strokes: &mut Strokes) {
        for (i, form, equal) in &self.formed {
            let (places, band) = (places(strokes, *i), strokes.get(*i).band());
            let points = strokes.numbers_mut()[places].as_chunks_mut().0;
            match (form, band) {
                (Form::Shape(kind), _) => kind.restore(points),
                (Form::Band, Some(band)) => leveled(band, equal).put(points),
                (Form::Band, None) | (Form::Sweep, _) => {}
            }
        }
        let numbers = strokes.numbers_mut();
        self.equal.iter().for_each(|places| level(places, numbers));
    }
}

/// The places of the coordinates of a stroke.
fn places(strokes: &Strokes, i: usize) -> std::ops::Range<usize> {
    let start = strokes.range(i).start;
    start..start + 2 * strokes.get(i).points.len()
}

/// Places of coordinates that lines of a band's middle have in common.
fn equal_of(band: &Band) -> Places {
    let middle = Strokes::from_iter([&Stroke {
        path: band.line.clone(),
        radius: 1.0,
        radii: Vec::new(),
        cap: Cap::Round,
        color: [0.0; 3],
        opacity: 1.0,
    }]);
    equal(middle.get(0), 0)
}

/// The band with lines that are level or upright, as these coordinates of its middle are equal.
fn leveled(band: Band, equal: &[Vec<usize>]) -> Band {
    let points = band.line.points();
    let mut numbers: Vec<f32> = points.iter().flat_map(|p| math::xy(p.at)).collect();
    equal.iter().for_each(|places| level(places, &mut numbers));
    // Only places change; each point of the middle stays on or off the path.
    let places = numbers.as_chunks::<2>().0.iter();
    let points = points.iter().zip(places).map(|(p, &at)| PathPoint {
        at: math::point(at),
        ..*p
    });
    Band {
        line: Path::of_points(points.collect(), band.line.is_closed()),
        ..band
    }
}

/// Gives the numbers at these places their mean.
fn level(places: &[usize], numbers: &mut [f32]) {
    // Among lists of equal numbers the mean is the nearest one. So it restores coordinates, and it projects slopes.
    let mean = places.iter().map(|&i| numbers[i]).sum::<f32>() / places.len() as f32;
    places.iter().for_each(|&i| numbers[i] = mean);
}

/// Places of coordinates that lines of a path have in common. The coordinates of its first point are at `start` and behind it.
fn equal(path: StrokeRef<'_>, start: usize) -> Places {
    let count = path.points.len();
    let mut equal = Vec::new();
    for axis in 0..2 {
        let is_along = |i: usize| {
            let next = (i + 1) % count;
            let is_line = [path.kinds[i], path.kinds[next]] == [PointKind::On; 2]
                && (path.closed || next > 0);
            is_line && path.points[i][axis] == path.points[next][axis]
        };
        // Lines along this axis share the coordinate. A closed path is walked from the end of a run of them, so that none is cut.
        let from = (0..count).find(|&i| !is_along((i + count - 1) % count));
        let mut run = Vec::new();
        for i in (0..count).map(|k| (from.unwrap_or(0) + k) % count) {
            run.push(start + 2 * i + axis);
            if !is_along(i) {
                equal.push(std::mem::take(&mut run));
            }
        }
    }
    equal.retain(|run| run.len() > 1);
    equal
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Area, Mark, Shape};

    fn area(ring: Path) -> Mark {
        Area::plain(vec![ring], [0.5; 3], 1.0).into()
    }

    /// The mark after each of its numbers has moved, and its forms were restored.
    fn moved(mark: &Mark) -> Mark {
        let mut strokes = Strokes::from_iter([mark]);
        let constraints = Constraints::of(&strokes, 1);
        let numbers = strokes.numbers_mut().iter_mut().enumerate();
        numbers.for_each(|(i, number)| *number += 0.02 * math::sin(3.0 * i as f32));
        constraints.restore(&mut strokes);
        strokes.get(0).to_mark()
    }

    #[test]
    fn shapes_stay_shapes() {
        let (low, high) = ((10.0, 12.0).into(), (40.0, 33.0).into());
        let center = (30.0, 31.0).into();
        for shape in [
            Shape::Circle {
                center,
                radius: 9.0,
            },
            Shape::Ellipse {
                center,
                radii: [9.0, 5.0],
            },
            Shape::Rect {
                low,
                high,
                radius: 3.0,
            },
            Shape::Rect {
                low,
                high,
                radius: 0.0,
            },
        ] {
            let moved = moved(&area(shape.path()));
            let found = moved.shape().unwrap();
            assert_eq!(
                std::mem::discriminant(&found),
                std::mem::discriminant(&shape)
            );
            assert_ne!(found, shape);
        }
    }

    #[test]
    fn outlines_of_lines_stay_where_they_are() {
        let path = Path::line((3.0, 4.0).into(), (20.0, 9.0).into());
        let line = Stroke::varying(path, vec![1.0, 3.0], [0.5; 3], 1.0).unwrap();
        let strokes = Strokes::from_iter([&line]);
        let mut slopes = vec![1.0; strokes.numbers().len()];
        Constraints::forms(&strokes).project(&strokes, &mut slopes);
        // Colour and opacity are free.
        let points = 2 * strokes.points();
        assert!(slopes[..points].iter().all(|slope| *slope == 0.0));
        assert!(slopes[points..].iter().all(|slope| *slope == 1.0));
    }

    #[test]
    fn lines_stay_level_and_upright() {
        let points = [
            (1.0, 2.0),
            (9.0, 2.0),
            (20.0, 2.0),
            (20.0, 9.0),
            (25.0, 12.0),
        ];
        let path = Path::new(
            points.map(|p: (f64, f64)| PathPoint::on(p.into())).into(),
            false,
        )
        .unwrap();
        let stroke = Stroke {
            path,
            radius: 1.0,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [0.5; 3],
            opacity: 1.0,
        };
        let moved = moved(&stroke.into());
        let [a, b, c, d, e] = moved.paths()[0].points() else {
            panic!("{moved:?}")
        };
        assert_eq!([a.at.y, b.at.y], [c.at.y; 2]);
        assert_eq!(c.at.x, d.at.x);
        assert!(d.at.y != e.at.y && c.at.y != 2.0);
    }
}
