//! Line charts.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::{Drawn, FONT, register, undrawn};
use strokefit::Result;
use strokefit::math;

/// Colours that are told apart with any kind of colour vision: Okabe & Ito, "Color universal
/// design", 2008, and a brown.
const SERIES: [RGBColor; 9] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
    RGBColor(150, 150, 150),
    RGBColor(110, 60, 20),
];

/// Width of the legend beside a chart, px, and its first line.
const LEGEND_WIDTH: i32 = 172;
const LEGEND_TOP: i32 = 48;

/// Numbers over numbers, as lines and marks.
#[derive(Debug, Clone, Default)]
pub struct Chart {
    /// Above the chart.
    pub title: String,
    /// Below the horizontal axis, and beside the vertical one.
    pub axes: [String; 2],
    /// True if the vertical axis is logarithmic; values ≤ 0 are then left out.
    pub logarithmic: bool,
    /// True if the horizontal axis is logarithmic.
    pub logarithmic_x: bool,
    /// The lines, with their legends.
    pub series: Vec<(String, Vec<[f64; 2]>)>,
    /// Points in the colour of the line of the same index.
    pub marks: Vec<Vec<[f64; 2]>>,
}

impl Chart {
    /// The chart as SVG text of 640 × 420 px, for a page.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`](strokefit::ErrorKind::Picture) when it cannot be drawn.
    pub fn svg(&self) -> Result<String> {
        const SIZE: (u32, u32) = (640, 420);
        register()?;
        let mut text = String::new();
        {
            let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
            let drawn = root.fill(&WHITE).map_err(Into::into);
            let drawn = drawn.and_then(|()| self.draw_on(&root));
            let drawn = drawn.and_then(|()| Ok(root.present()?));
            drawn.map_err(|cause| undrawn(SIZE.0 as usize, SIZE.1 as usize, cause))?;
        }
        Ok(text)
    }

    fn draw_on<B: DrawingBackend>(&self, root: &DrawingArea<B, Shift>) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let series: Vec<_> = self.series.iter().map(|(_, p)| self.points(p)).collect();
        let marks: Vec<_> = self.marks.iter().map(|p| self.points(p)).collect();
        let all = || series.iter().chain(&marks).flatten();
        let margin = if marks.is_empty() { 0.0 } else { MARGIN };
        let [x, y] = [0, 1].map(|k| widened(span(all().map(|p| p[k])), margin));
        let width = root.dim_in_pixel().0 as i32;
        let (area, beside) = root.split_horizontally(width - LEGEND_WIDTH);
        let mut chart = ChartBuilder::on(&area)
            .caption(&self.title, (FONT, 16))
            .margin(10)
            .margin_right(24)
            .x_label_area_size(40)
            .y_label_area_size(70)
            .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .x_desc(&self.axes[0])
            .y_desc(&self.axes[1])
            .x_label_formatter(&|v| self.label_x(*v))
            .y_label_formatter(&|v| self.label_y(*v, is_plain(y)))
            .label_style((FONT, 13))
            .draw()?;
        // The first above all others.
        let lines: Vec<_> = series.iter().zip(SERIES.iter().cycle()).collect();
        for (points, color) in lines.into_iter().rev() {
            let points = points.iter().map(|&[x, y]| (x, y));
            chart.draw_series(LineSeries::new(points, color.stroke_width(2)))?;
        }
        let discs: Vec<_> = marks.iter().zip(SERIES.iter().cycle()).collect();
        for (points, color) in discs.into_iter().rev() {
            let disc = |&[x, y]: &[f64; 2]| Circle::new((x, y), 3, color.filled());
            chart.draw_series(points.iter().map(disc))?;
        }
        self.draw_legend(&beside)
    }

    fn draw_legend<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let rows = (0..).map(|row| LEGEND_TOP + row * 20);
        for (((name, _), y), color) in self.series.iter().zip(rows).zip(SERIES.iter().cycle()) {
            let line = PathElement::new([(0, y), (18, y)], color.stroke_width(3));
            area.draw(&line)?;
            area.draw(&Text::new(name.as_str(), (24, y - 6), (FONT, 13)))?;
        }
        Ok(())
    }

    /// Points as they are drawn: on a logarithmic axis as logarithms.
    fn points(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let along = |v: f64, logarithmic: bool| if logarithmic { math::log10(v) } else { v };
        let drawn = points
            .iter()
            .map(|&[x, y]| [along(x, self.logarithmic_x), along(y, self.logarithmic)]);
        drawn.filter(|p| p.iter().all(|v| v.is_finite())).collect()
    }

    fn label_x(&self, v: f64) -> String {
        if self.logarithmic_x {
            significant(math::powf(10.0, v))
        } else {
            format!("{v}")
        }
    }

    fn label_y(&self, v: f64, plain: bool) -> String {
        if self.logarithmic && plain {
            significant(math::powf(10.0, v))
        } else if self.logarithmic {
            format!("{:.1e}", math::powf(10.0, v))
        } else {
            let text = format!("{v:.3}");
            text.trim_end_matches('0').trim_end_matches('.').into()
        }
    }
}

/// A number above 0 with two significant digits.
fn significant(v: f64) -> String {
    let digits = (1.0 - math::log10(v).floor()).clamp(0.0, 6.0) as usize;
    let unit = math::powi(
        10.0,
        digits as i32
            - if v >= 100.0 {
                math::log10(v) as i32 - 1
            } else {
                0
            },
    );
    format!("{:.digits$}", (v * unit).round() / unit)
}

/// True if the numbers of a logarithmic axis need no exponents.
fn is_plain((low, high): (f64, f64)) -> bool {
    low > -1.5 && high < 6.0
}

/// Room around marks, as a share of the axis.
const MARGIN: f64 = 0.04;

fn widened((low, high): (f64, f64), share: f64) -> (f64, f64) {
    let margin = (high - low) * share;
    (low - margin, high + margin)
}

/// Least and greatest of `values`, apart by something.
fn span(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let around = |(low, high): (f64, f64), v: f64| (low.min(v), high.max(v));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), around);
    match high - low {
        width if width > 0.0 && width.is_finite() => (low, high),
        _ if low.is_finite() => (low - 0.5, low + 0.5),
        _ => (0.0, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_of_nothing_is_empty_axes() {
        assert!(Chart::default().svg().is_ok());
    }

    #[test]
    fn marks_are_drawn_into_svg() {
        let chart = Chart {
            logarithmic_x: true,
            series: vec![("front".into(), vec![[1.0, 20.0], [100.0, 30.0]])],
            marks: vec![vec![[1.0, 20.0], [100.0, 30.0], [0.0, 10.0]]],
            ..Chart::default()
        };
        let text = chart.svg().unwrap();
        assert_eq!(text.matches("<circle").count(), 2, "0 has no logarithm");
        assert!(text.contains("front"));
    }

    #[test]
    fn logarithmic_axes_have_exponents_only_where_numbers_need_them() {
        let svg = |high| {
            let chart = Chart {
                logarithmic: true,
                series: vec![("a".into(), vec![[0.0, 1.0], [1.0, high]])],
                ..Chart::default()
            };
            chart.svg().unwrap()
        };
        let has_exponents = |svg: String| svg.contains("1.0e");
        assert!(!has_exponents(svg(100.0)) && has_exponents(svg(1e9)));
    }

    #[test]
    fn labels_have_two_significant_digits() {
        let numbers = [0.0123, 0.5, 3.162, 31.62, 1234.0];
        let texts = numbers.map(significant);
        assert_eq!(texts, ["0.012", "0.50", "3.2", "32", "1200"]);
    }
}
