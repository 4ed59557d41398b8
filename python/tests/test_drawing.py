"""What is done with a finished drawing."""

from __future__ import annotations

import copy
import json
import pickle
import re
from pathlib import Path

import numpy as np
import pytest

import strokefit


# Coordinates of a place, px.
Place = tuple[float, ...]
# A line: start, end; or a quadratic curve: start, control point, end.
Piece = tuple[Place, ...]


@pytest.fixture(scope="module")
def drawing() -> strokefit.Drawing:
    y, x = np.mgrid[:40, :56]
    return strokefit.fit((0.5 + 0.4 * np.sin(x / 6) * np.cos(y / 8)), strokes=30)


def test_it_survives_pickling_and_copying(drawing: strokefit.Drawing) -> None:
    for other in (pickle.loads(pickle.dumps(drawing)), copy.deepcopy(drawing), copy.copy(drawing)):
        assert other == drawing and hash(other) == hash(drawing)
        assert other.report == drawing.report
        for mine, its in zip(drawing.strokes, other.strokes):
            assert (mine.points == its.points).all() and (mine.on_path == its.on_path).all()
            assert mine[2:] == its[2:]


def test_equality_is_that_of_the_files(drawing: strokefit.Drawing, waves: np.ndarray) -> None:
    assert drawing != strokefit.fit(waves, strokes=3)
    assert drawing != drawing.svg and drawing is not None
    assert len({drawing, pickle.loads(pickle.dumps(drawing))}) == 1


def test_it_is_shown_and_saved_as_svg(drawing: strokefit.Drawing, tmp_path: Path) -> None:
    path = tmp_path / "a.svg"
    drawing.save(path)
    assert path.read_bytes() == drawing.svg.encode() == drawing._repr_svg_().encode()
    drawing.save(str(path))
    words = repr(drawing)
    assert "56×40 px" in words and f"{len(drawing.strokes)} strokes" in words and " dB" in words
    with pytest.raises(FileNotFoundError):
        drawing.save(tmp_path / "no" / "a.svg")


@pytest.fixture(scope="module")
def bent() -> strokefit.Drawing:
    """A closed spline, a curve with a corner at its end, a polyline, and a dot, as a drawing has them."""
    paths = [
        '<path d="M8 20Q8 8 20 8T32 20 20 32 8 20z" stroke="#204060" stroke-width="3"/>',
        '<path d="M36 6Q48 6 48 14L38 20" stroke="#a03010" stroke-width="2.5" stroke-opacity="0.8"/>',
        '<path d="M36 36L44 24 52 36" stroke="#108040" stroke-width="2"/>',
        '<path d="M20 20h0.01" stroke="#000000" stroke-width="4"/>',
    ]
    svg = f"""<svg xmlns="http://www.w3.org/2000/svg" width="56" height="40" viewBox="0 0 56 40">
<rect width="56" height="40" fill="#ffffff"/>
<g id="stage-1" fill="none" stroke-linecap="round" stroke-linejoin="round">
{"".join(paths)}
</g>
</svg>"""
    picture = strokefit.render(svg, background="#ffffff")
    return strokefit.refine(svg, picture, strokes=len(paths), preset="draft")


def test_strokes_are_those_of_the_file(drawing: strokefit.Drawing, bent: strokefit.Drawing) -> None:
    for some in (drawing, bent):
        elements = re.findall("<path[^>]*>", some.svg)
        assert len(some.strokes) + len(some.areas) == some.report["strokes"] == len(elements)
        points = len(some.strokes.points) + len(some.areas.points)
        # A line with square ends is shown by its outline, which has more points than the line in the file.
        assert points == some.report["points"] or (some.areas and points > some.report["points"])
        for stroke, element in zip(some.strokes, (elements[i] for i in some.strokes.order)):
            attributes = dict(re.findall(r'(\S+)="([^"]*)"', element))
            expected, closed = pieces_of_data(attributes["d"])
            pieces = pieces_of_stroke(stroke)
            assert [len(piece) for piece in pieces] == [len(piece) for piece in expected]
            for piece, its in zip(pieces, expected):
                assert np.array(piece) == pytest.approx(np.array(its), abs=1e-4)
            assert stroke.closed == closed
            assert stroke.width == pytest.approx(float(attributes["stroke-width"]))
            assert "#" + "".join(f"{round(255 * c):02x}" for c in stroke.color) == attributes["stroke"]
            assert stroke.opacity == pytest.approx(float(attributes.get("stroke-opacity", 1)), abs=0.001)


def pieces_of_data(d: str) -> tuple[list[Piece], bool]:
    """The lines and curves of an attribute `d` of one stroke, and whether it is closed. A dot has none."""
    pieces: list[Piece] = []
    at = start = (0.0, 0.0)
    for letter, text in re.findall(r"([a-zA-Z])([^a-zA-Z]*)", d):
        numbers = [float(number) for number in re.findall(r"-?[\d.]+", text)]
        size = {"M": 2, "L": 2, "T": 2, "Q": 4, "H": 1, "Z": 1}[letter.upper()]
        for i in range(0, len(numbers), size):
            origin = at if letter.islower() else (0.0, 0.0)
            places = [(origin[0] + x, origin[1] + y) for x, y in zip(*[iter(numbers[i : i + size])] * 2)]
            if letter in "mM":
                start = places[0]
            elif letter in "lLqQ":
                pieces.append((at, *places))
            elif letter in "tT":
                before, knee, _ = pieces[-1]
                pieces.append((at, (2 * at[0] - knee[0], 2 * at[1] - knee[1]), *places))
            at = places[-1] if places else at
        # Steps add up to the start but for their rounding.
        if letter in "zZ" and at != pytest.approx(start, abs=1e-6):
            pieces.append((at, start))
    return pieces, d[-1] in "zZ"


def pieces_of_stroke(stroke: strokefit.Stroke) -> list[Piece]:
    """The lines and curves of a stroke, by the rules of docs/python.md."""
    # With the implied points, every point off the path has neighbours on it.
    points: list[tuple[Place, bool]] = []
    for place, is_on in zip(map(tuple, stroke.points.tolist()), stroke.on_path.tolist()):
        if points and not points[-1][1] and not is_on:
            points.append((middle(points[-1][0], place), True))
        points.append((place, is_on))
    if stroke.closed:
        (first, first_is_on), (last, last_is_on) = points[0], points[-1]
        if not first_is_on:
            assert not last_is_on
            points.insert(0, (middle(last, first), True))
        points.append(points[0])
    pieces: list[Piece] = []
    for (place, is_on), (after, after_is_on) in zip(points, points[1:]):
        if is_on:
            pieces.append((place, after))
        else:
            assert after_is_on
            pieces[-1] = (*pieces[-1], after)
    return pieces


def middle(a: Place, b: Place) -> Place:
    return tuple((np.array(a) + b) / 2)


def test_strokes_tell_curves_and_closed_paths(bent: strokefit.Drawing) -> None:
    ring, curve, polyline, dot = bent.strokes
    assert bent.strokes.closed.tolist() == [True, False, False, False]
    assert ring.closed and ring.on_path.sum() <= 1 and (~ring.on_path).sum() >= 4
    assert curve.on_path.tolist() == [True, False, True, True]
    assert polyline.on_path.tolist() == [True] * 3 and len(dot.points) == len(dot.on_path) == 1
    assert (np.concatenate([stroke.on_path for stroke in bent.strokes]) == bent.strokes.on_path).all()
    with pytest.raises(ValueError, match="read-only"):
        ring.on_path[0] = True


def test_flattened_paths_are_close_to_their_curves(bent: strokefit.Drawing) -> None:
    ring, _, polyline, dot = bent.strokes
    line = ring.flattened(0.01)
    assert line.dtype == np.float32 and (line[0] == line[-1]).all()
    # A spline of four control points at the corners of a square is within 6 % of a circle.
    radii = np.hypot(*(line - [20, 20]).T)
    assert 11 < radii.min() and radii.max() < 13.5
    assert len(ring.flattened(0.5)) < len(ring.flattened()) < len(line)
    assert (polyline.flattened() == polyline.points).all() and (dot.flattened() == dot.points).all()
    for tolerance in (0, -1, float("nan")):
        with pytest.raises(ValueError, match="give px above 0"):
            ring.flattened(tolerance)
    with pytest.raises(ValueError, match="start and end with points on it"):
        ring._replace(closed=False).flattened()


def test_strokes_are_a_sequence_with_columns(drawing: strokefit.Drawing) -> None:
    strokes = drawing.strokes
    n = len(strokes)
    assert strokes.starts.shape == (n + 1,) and strokes.starts[-1] == len(strokes.points)
    assert strokes.points.shape[1] == 2 and strokes.colors.shape == (n, 3)
    assert strokes.on_path.shape == (len(strokes.points),) and strokes.on_path.dtype == np.bool_
    assert strokes.closed.shape == (n,) and strokes.closed.dtype == np.bool_
    assert strokes.widths.shape == strokes.opacities.shape == strokes.layers.shape == (n,)
    assert [s.width for s in strokes] == strokes.widths.tolist()
    assert strokes[-1].opacity == strokes[n - 1].opacity == strokes[-2:][1].opacity
    assert (np.diff(strokes.layers) >= 0).all()
    assert max(strokes.layers.max(), *drawing.areas.layers, 0) + 1 == len(drawing.report["stages"])
    with pytest.raises(IndexError):
        strokes[n]
    with pytest.raises(ValueError, match="read-only"):
        strokes[0].points[0] = 1


def test_strokes_whose_width_varies_have_radii() -> None:
    outline = (
        "M386.25 177.17l-22.48 19.48q-8.63 7.83-17.79 15-9.13 7.15-18.75 13.63-9.6 6.47-19.65 12.23-10.05 5.77-20.49 10.8"
        "l-19.99 7.75a3.76 3.76 0 0 0-2.1 4.97 3.76 3.76 0 0 0 5.03 1.94l19.83-9.16q10.45-5.48 20.47-11.68 10-6.2 19.53-13.09"
        " 9.52-6.88 18.52-14.43 8.99-7.55 17.46-15.77l20.75-21.31a0.25 0.25 0 0 0-0.34-0.36z"
    )
    line = "M386.41 177.36l-21.65 20.43c-22.75 21.34-48.46 39.28-76.33 53.29l-19.97 8.48"
    svg = f"""<svg xmlns="http://www.w3.org/2000/svg" width="400" height="400" viewBox="0 0 400 400">
<rect width="400" height="400" fill="#ffffff"/>
<g id="stage-1" fill="none" stroke-linecap="round" xmlns:strokefit="urn:strokefit:line">
<path d="{outline}" fill="#000000" strokefit:line="{line}" strokefit:widths="0.5 3.02 6.16 7.51"/>
<path d="M36 6L50 6" stroke="#108040" stroke-width="3"/>
</g>
</svg>"""
    drawing = strokefit.refine(svg, strokefit.render(svg, background="#ffffff"), strokes=2, preset="draft")
    brush, even = drawing.strokes
    assert len(drawing.areas) == 0 and even.radii is None and brush.radii is not None
    assert brush.on_path.tolist() == [True, True, False, False, True, True]
    assert brush.radii.tolist() == pytest.approx([0.25, 1.51, 2.0333, 2.5567, 3.08, 3.755], abs=1e-3)
    assert brush.width == pytest.approx(7.51) and brush.points[0].tolist() == pytest.approx([386.41, 177.36])
    assert drawing.strokes.radii.tolist() == [*brush.radii.tolist(), 1.5, 1.5]
    assert (pickle.loads(pickle.dumps(drawing)).strokes.radii == drawing.strokes.radii).all()
    with pytest.warns(UserWarning, match="1 of the strokes of .* width that varies"):
        strokefit.Scene.read(svg)


@pytest.fixture(scope="module")
def filled() -> strokefit.Drawing:
    """A frame, a line and a drop, back to front, as a drawing has them."""
    svg = """<svg xmlns="http://www.w3.org/2000/svg" width="56" height="40" viewBox="0 0 56 40">
<rect width="56" height="40" fill="#ffffff"/>
<g id="stage-1" fill="none" stroke-linecap="round">
<path d="M4 4h30v30H4zm8 8v14h14V12z" fill="#204060"/>
<path d="M36 36L50 24" stroke="#108040" stroke-width="3"/>
</g>
<g id="stage-2">
<path d="M40 4h10Q50 20 40 20z" fill="#a03010"/>
</g>
</svg>"""
    return strokefit.refine(svg, strokefit.render(svg, background="#ffffff"), strokes=3, preset="draft")


def test_areas_have_rings_and_a_place_among_strokes(filled: strokefit.Drawing) -> None:
    frame, drop = filled.areas
    assert [len(ring) for ring in frame.rings] == [4, 4] and [len(ring) for ring in drop.rings] == [4]
    assert drop.on_path[0].tolist() == [True, True, False, True]
    assert filled.areas.order.tolist() == [0, 2] and filled.strokes.order.tolist() == [1]
    assert filled.areas.layers.tolist() == [0, 1] and filled.strokes.layers.tolist() == [0]
    assert frame.opacity == 1 and frame.color == pytest.approx((0x20 / 255, 0x40 / 255, 0x60 / 255), abs=0.02)
    assert [filled.report[count] for count in ("strokes", "areas")] == [3, 2]
    assert filled.report["points"] == len(filled.strokes.points) + len(filled.areas.points)
    assert "2 areas, 1 strokes" in repr(filled) and repr(filled.areas) == "<2 areas>"
    with pytest.raises(ValueError, match="read-only"):
        frame.rings[0][0] = 1


def test_flattened_rings_are_polygons(filled: strokefit.Drawing) -> None:
    outer, inner = filled.areas[0].flattened()
    assert abs(signed_area(outer)) == pytest.approx(900, abs=9)
    assert signed_area(outer) * signed_area(inner) < 0
    (drop,) = filled.areas[-1].flattened(0.01)
    assert (drop[0] == drop[-1]).all() and len(drop) > 5


def signed_area(polygon: np.ndarray) -> float:
    (x, y), (next_x, next_y) = polygon[:-1].T, polygon[1:].T
    return float((x * next_y - next_x * y).sum() / 2)


def test_areas_survive_pickling(filled: strokefit.Drawing) -> None:
    areas = pickle.loads(pickle.dumps(filled)).areas
    assert (areas.points == filled.areas.points).all() and areas[1][2:] == filled.areas[1][2:]
    assert (areas.ring_starts == filled.areas.ring_starts).all()


def test_renders_have_the_size_and_channels_asked_for(drawing: strokefit.Drawing) -> None:
    assert drawing.to_numpy().shape == (40, 56, 4)
    large = drawing.to_numpy(2.5, background="#ffffff")
    assert large.shape == (100, 140, 3) and large.dtype == np.uint8
    assert (strokefit.render(drawing.svg) == drawing.to_numpy()).all()
    assert (drawing.to_numpy()[:, :, 3] == 255).all()
    for scale in (0, -1, float("nan"), 1e9):
        with pytest.raises(ValueError, match="scale|size of 1 to"):
            drawing.to_numpy(scale)
    with pytest.raises(ValueError, match="'reddish' is not a background"):
        drawing.to_numpy(background="reddish")


def test_svgs_are_drawings_text_or_files(drawing: strokefit.Drawing, tmp_path: Path) -> None:
    path = tmp_path / "a.svg"
    drawing.save(path)
    for svg in (drawing, drawing.svg, path, str(path)):
        assert (strokefit.render(svg) == drawing.to_numpy()).all()
    with pytest.raises(ValueError, match="SVG"):
        strokefit.render("<html/>")
    with pytest.raises(FileNotFoundError):
        strokefit.render("no-such.svg")


def test_judging_says_what_the_report_says(waves: np.ndarray) -> None:
    drawing = strokefit.fit(waves, strokes=30)
    assert strokefit.judge(drawing, waves) == drawing.report["fidelity"]
    with pytest.raises(ValueError, match="aspect ratio"):
        strokefit.judge(drawing, waves[:, :20])


def test_the_report_is_json(drawing: strokefit.Drawing) -> None:
    assert json.loads(json.dumps(drawing.report)) == drawing.report
    assert set(drawing.report) == strokefit.Report.__required_keys__


def test_a_drawing_is_refined(waves: np.ndarray, tmp_path: Path) -> None:
    rough = strokefit.fit(waves, strokes=10)
    fine = strokefit.refine(rough, waves, strokes=40)
    assert 10 < fine.report["strokes"] <= 40
    assert fine.report["base"] == {"path": "the drawing", "strokes": rough.report["strokes"], "elements": 0}
    frozen = strokefit.refine(rough.svg, waves, strokes=40, freeze_base=True)
    assert frozen.report["base"]["elements"] > 0
    path = tmp_path / "rough.svg"
    rough.save(path)
    assert strokefit.refine(path, waves, strokes=40) == fine


def test_a_foreign_svg_stays_byte_for_byte(waves: np.ndarray, tmp_path: Path) -> None:
    path = tmp_path / "foreign.svg"
    head = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 56 40">\r\n<circle r="9"/>\r\n'
    path.write_bytes((head + "</svg>\r\n").encode())
    drawing = strokefit.refine(path, waves, strokes=5)
    assert drawing.svg.startswith(head)
    assert drawing.report["base"] == {"path": str(path), "strokes": 0, "elements": 1}
