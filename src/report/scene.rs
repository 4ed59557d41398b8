//! A drawing, as pages draw it.

use serde::Serialize;

use crate::math;
use crate::scene::{Area, Mark, Path, PathPoint, PointKind, Rgb, Scene, Shade, ShadeStop, Stroke};

/// A scene in numbers and colours that a page can hand to a canvas.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneRecord {
    /// Width in px.
    pub width: u32,
    /// Height in px.
    pub height: u32,
    /// `#rrggbb`; `null` if the drawing is transparent.
    pub background: Option<String>,
    /// The gradient on it; left out if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shade: Option<ShadeRecord>,
    /// The shadows on both and the things that they fall on, back to front, each as an area, and the standard deviation of its blur,
    /// px, 0 of a thing; left out if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub shadows: Vec<(MarkRecord, f32)>,
    /// Marks back to front, stage by stage.
    pub stages: Vec<Vec<MarkRecord>>,
}

/// In JSON a list of five: the points x, y, x, y, … and the radius, px, 0 for an area; the colour `#rrggbb`; the opacity,
/// 0..1; the kinds of the points, `o` on the path and `c` for a control point, with `z` after the points of a closed path,
/// and so after those of each ring of an area. An area with a gradient has that as a sixth, and an area that is the outline of a line
/// that line.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MarkRecord(
    pub Vec<f32>,
    pub f32,
    pub String,
    pub f32,
    pub String,
    #[serde(skip_serializing_if = "Option::is_none")] pub Option<MoreRecord>,
);

/// What some areas have besides.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum MoreRecord {
    /// The gradient that it is filled with.
    Shade(ShadeRecord),
    /// The line whose width varies that it is the outline of.
    Line(LineRecord),
}

/// A line whose width varies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LineRecord {
    /// Its points x, y, x, y, …, px.
    pub points: Vec<f32>,
    /// Their kinds, as those of a [`MarkRecord`].
    pub kinds: String,
    /// The width at each of them, px.
    pub widths: Vec<f32>,
}

impl From<&Scene> for SceneRecord {
    fn from(scene: &Scene) -> Self {
        let stages = scene.stages.iter();
        let is_page = |area: &&Area| area.is_page([scene.width, scene.height]);
        let page = scene.ground.iter().find(is_page);
        let shadows = scene.ground.iter().filter(|area| !is_page(area));
        Self {
            width: scene.width,
            height: scene.height,
            background: scene.background.map(css),
            shade: page
                .and_then(|page| page.shade.as_ref())
                .map(ShadeRecord::from),
            shadows: shadows.map(shadow).collect(),
            stages: stages
                .map(|stage| stage.marks.iter().map(MarkRecord::from).collect())
                .collect(),
        }
    }
}

/// A gradient as a canvas takes it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShadeRecord {
    /// x1, y1, x2, y2 of a linear gradient, or the centre and the radius of a radial one, px.
    pub axis: Vec<f64>,
    /// Offsets and colours `rgb(r g b / a)`.
    pub stops: Vec<(f32, String)>,
}

impl From<&Shade> for ShadeRecord {
    fn from(shade: &Shade) -> Self {
        let color = |stop: &ShadeStop| {
            let [r, g, b] = stop.color.map(|c| (c * 255.0).round());
            (stop.offset, format!("rgb({r} {g} {b} / {})", stop.opacity))
        };
        Self {
            axis: shade.axis().numbers(),
            stops: shade.stops().iter().map(color).collect(),
        }
    }
}

impl From<&Mark> for MarkRecord {
    fn from(mark: &Mark) -> Self {
        let line = mark.as_stroke().filter(|stroke| stroke.is_varying());
        // A canvas has one width and one kind of ends: a line with others is shown as an area.
        let mark = mark.clone().filled();
        let shade = mark.shade().map(ShadeRecord::from);
        let points = mark.paths().iter().flat_map(Path::points);
        Self(
            points.flat_map(|p| math::xy(p.at)).collect(),
            mark.radius() as f32,
            css(mark.color()),
            mark.opacity(),
            mark.paths().iter().map(kinds).collect(),
            match line {
                Some(line) => Some(MoreRecord::Line(LineRecord::from(line))),
                None => shade.map(MoreRecord::Shade),
            },
        )
    }
}

impl From<&Stroke> for LineRecord {
    fn from(line: &Stroke) -> Self {
        let points = line.path.points().iter();
        Self {
            points: points.flat_map(|p| math::xy(p.at)).collect(),
            kinds: kinds(&line.path),
            widths: line
                .radii_of_points()
                .iter()
                .map(|r| 2.0 * *r as f32)
                .collect(),
        }
    }
}

fn shadow(area: &Area) -> (MarkRecord, f32) {
    (MarkRecord::from(&Mark::from(area.clone())), area.blur)
}

fn kinds(path: &Path) -> String {
    let kind = |p: &PathPoint| match p.kind {
        PointKind::On => 'o',
        PointKind::Quad => 'c',
        PointKind::Cubic => 'b',
        PointKind::Arc => 'a',
    };
    let end = path.is_closed().then_some('z');
    path.points().iter().map(kind).chain(end).collect()
}

/// `#rrggbb`.
fn css(color: Rgb) -> String {
    let [r, g, b] = color.map(|c| (c * 255.0 + 0.5) as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Point;
    use crate::scene::{Axis, Cap, Stage};

    #[test]
    fn a_page_reads_points_radius_colour_opacity_and_kinds() {
        let stroke = Stroke {
            path: Path::line((1.5, 2.0).into(), (3.0, 4.0).into()),
            radius: 0.75,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [1.0, 0.5, 0.0],
            opacity: 0.25,
        };
        let stage = Stage::from_iter([stroke]);
        let scene = Scene {
            stages: vec![stage],
            ..Scene::empty(8, 6, Some([1.0; 3]))
        };
        let json = serde_json::to_string(&SceneRecord::from(&scene)).unwrap();
        let expected = r##"{"width":8,"height":6,"background":"#ffffff","stages":[[[[1.5,2.0,3.0,4.0],0.75,"#ff8000",0.25,"oo"]]]}"##;
        assert_eq!(json, expected);
    }

    #[test]
    fn a_page_reads_the_rings_of_an_area_one_after_the_other() {
        let ring = |points: &[([f64; 2], bool)]| {
            let point = |&([x, y], is_on): &([f64; 2], bool)| PathPoint {
                at: Point::new(x, y),
                kind: PointKind::on_if(is_on),
            };
            Path::new(points.iter().map(point).collect(), true).unwrap()
        };
        let rings = vec![
            ring(&[([0.0, 0.0], true), ([8.0, 0.0], true), ([4.0, 6.0], true)]),
            ring(&[([3.0, 1.0], true), ([4.0, 5.0], false)]),
        ];
        let area = Area::plain(rings, [0.0, 0.5, 1.0], 1.0);
        let json =
            |area: Area| serde_json::to_string(&MarkRecord::from(&Mark::from(area))).unwrap();
        let expected =
            r##"[[0.0,0.0,8.0,0.0,4.0,6.0,3.0,1.0,4.0,5.0],0.0,"#0080ff",1.0,"ooozocz"]"##;
        assert_eq!(json(area.clone()), expected);
        let axis = Axis::Linear {
            from: (0.0, 0.0).into(),
            to: (8.0, 0.0).into(),
        };
        let stop = |offset| ShadeStop {
            offset,
            color: [offset; 3],
            opacity: 1.0,
        };
        let shade = Shade::new(axis, &[stop(0.0), stop(1.0)]).ok();
        let shade_json = r#"{"axis":[0.0,0.0,8.0,0.0],"stops":[[0.0,"rgb(0 0 0 / 1)"],[1.0,"rgb(255 255 255 / 1)"]]}"#;
        let with_shade = expected.replace("z\"]", &format!("z\",{shade_json}]"));
        assert_eq!(json(Area { shade, ..area }), with_shade);
    }

    #[test]
    fn a_page_reads_the_line_of_an_outline() {
        let path = Path::line((1.0, 2.0).into(), (9.0, 2.0).into());
        let line = Stroke::varying(path, vec![0.0, 1.5], [0.0; 3], 1.0).unwrap();
        let json = serde_json::to_string(&MarkRecord::from(&Mark::from(line))).unwrap();
        let (outline, line) = json.split_once(",{").unwrap();
        assert!(outline.contains(r##",0.0,"#000000",1.0,"##), "{outline}");
        assert_eq!(
            line,
            r#""points":[1.0,2.0,9.0,2.0],"kinds":"oo","widths":[0.0,3.0]}]"#
        );
    }

    #[test]
    fn a_page_reads_the_axis_and_the_stops_of_a_shade() {
        let axis = Axis::Radial {
            center: (4.0, 3.0).into(),
            radius: 2.5,
        };
        let stop = |offset, opacity| ShadeStop {
            offset,
            color: [1.0, 0.4, 0.0],
            opacity,
        };
        let shade = Shade::new(axis, &[stop(0.0, 1.0), stop(1.0, 0.2)]).unwrap();
        let json = serde_json::to_string(&ShadeRecord::from(&shade)).unwrap();
        let expected = r#"{"axis":[4.0,3.0,2.5],"stops":[[0.0,"rgb(255 102 0 / 1)"],[1.0,"rgb(255 102 0 / 0.2)"]]}"#;
        assert_eq!(json, expected);
    }
}
