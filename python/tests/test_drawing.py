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


@pytest.fixture(scope="module")
def drawing() -> strokefit.Drawing:
    y, x = np.mgrid[:40, :56]
    return strokefit.fit((0.5 + 0.4 * np.sin(x / 6) * np.cos(y / 8)), strokes=30)


def test_it_survives_pickling_and_copying(drawing: strokefit.Drawing) -> None:
    for other in (pickle.loads(pickle.dumps(drawing)), copy.deepcopy(drawing), copy.copy(drawing)):
        assert other == drawing and hash(other) == hash(drawing)
        assert other.report == drawing.report
        for mine, its in zip(drawing.strokes, other.strokes):
            assert (mine.points == its.points).all() and mine[1:] == its[1:]


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


def test_strokes_are_those_of_the_file(drawing: strokefit.Drawing) -> None:
    strokes = drawing.strokes
    assert len(strokes) == drawing.report["strokes"] == drawing.svg.count("<path")
    first = strokes[0]
    element = next(line for line in drawing.svg.splitlines() if line.startswith("<path"))
    attributes = dict(re.findall(r'(\S+)="([^"]*)"', element))
    start = [float(number) for number in re.findall(r"-?[\d.]+", attributes["d"])[:2]]
    assert first.points[0].tolist() == pytest.approx(start)
    assert first.width == pytest.approx(float(attributes["stroke-width"]))
    assert "#" + "".join(f"{round(255 * c):02x}" for c in first.color) == attributes["stroke"]
    assert first.opacity == pytest.approx(float(attributes.get("stroke-opacity", 1)), abs=0.001)


def test_strokes_are_a_sequence_with_columns(drawing: strokefit.Drawing) -> None:
    strokes = drawing.strokes
    n = len(strokes)
    assert strokes.starts.shape == (n + 1,) and strokes.starts[-1] == len(strokes.points)
    assert strokes.points.shape[1] == 2 and strokes.colors.shape == (n, 3)
    assert strokes.widths.shape == strokes.opacities.shape == strokes.layers.shape == (n,)
    assert [s.width for s in strokes] == strokes.widths.tolist()
    assert strokes[-1].opacity == strokes[n - 1].opacity == strokes[-2:][1].opacity
    assert (np.diff(strokes.layers) >= 0).all()
    assert strokes.layers.max() + 1 == len(drawing.report["stages"])
    with pytest.raises(IndexError):
        strokes[n]
    with pytest.raises(ValueError, match="read-only"):
        strokes[0].points[0] = 1


def test_renders_have_the_size_and_channels_asked_for(drawing: strokefit.Drawing) -> None:
    assert drawing.to_numpy().shape == (40, 56, 4)
    large = drawing.to_numpy(2.5, background="#ffffff")
    assert large.shape == (100, 140, 3) and large.dtype == np.uint8
    assert (strokefit.render(drawing.svg) == drawing.to_numpy()).all()
    assert (drawing.to_numpy()[:, :, 3] == 255).all()
    for scale in (0, -1, float("nan"), 1e9):
        with pytest.raises(ValueError, match="scale|size of 1 to"):
            drawing.to_numpy(scale)
    with pytest.raises(ValueError, match="'red' is not a background"):
        drawing.to_numpy(background="red")


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
    assert set(drawing.report) == set(strokefit.Report.__annotations__)


def test_a_drawing_is_refined(waves: np.ndarray, tmp_path: Path) -> None:
    rough = strokefit.fit(waves, strokes=10)
    fine = strokefit.refine(rough, waves, strokes=40)
    assert 10 < len(fine.strokes) <= 40
    assert fine.report["base"] == {"path": "the drawing", "strokes": len(rough.strokes), "elements": 0}
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
