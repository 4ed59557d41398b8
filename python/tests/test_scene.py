"""Scenes: from arrays, from an SVG, from a drawing, and back to the bytes of the command line."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from drawings import areas, strokes
from numpy.typing import NDArray

import strokefit

CAT = ROOT / "samples/chelsea-cat.png"
# Strokes and areas, without a gradient.
HOUSE = ROOT / "samples/filled/fluent-emoji-flat__house-with-garden.svg"


def house() -> NDArray[np.uint8]:
    return strokefit.render(HOUSE.read_text(), background="#ffffff")


@pytest.mark.parametrize(
    "options",
    [
        {"strokes": 60},
        {"strokes": 60, "form": "smallest"},
        {"strokes": 40, "group": "color", "colors": 4, "order": "travel"},
        {"strokes": 40, "width": "120mm", "precision": 3},
        {"strokes": 40, "background": "none"},
    ],
)
def test_a_drawing_becomes_arrays_and_the_same_bytes(options: dict[str, object]) -> None:
    drawing = strokefit.fit(house(), preset="draft", **options)
    names = ("form", "group", "order", "precision")
    written = {name: value for name, value in options.items() if name in names}
    scene = drawing.scene
    assert scene.to_svg(**written) == drawing.svg
    assert len(scene.marks.widths) == len(drawing.strokes) + len(drawing.areas)


def test_a_scene_has_the_strokes_and_areas_of_its_drawing() -> None:
    drawing = strokefit.fit(house(), strokes=20, preset="draft")
    scene, marks = drawing.scene, drawing.scene.marks
    assert len(drawing.strokes) and len(drawing.areas)
    placed = np.argsort(np.concatenate([drawing.strokes.order, drawing.areas.order]))
    for name in ("colors", "opacities"):
        both = np.concatenate([getattr(drawing.strokes, name), getattr(drawing.areas, name)])
        assert np.allclose(getattr(marks, name), both[placed], atol=1e-6)
    assert marks.filled.sum() == len(drawing.areas)
    assert len(marks.rings) == sum(len(area.rings) - 1 for area in drawing.areas)
    assert (scene.width, scene.height) == (drawing.report["input"]["width"], drawing.report["input"]["height"])


def test_a_circle_is_one_again_when_its_arrays_are_written() -> None:
    y, x = np.mgrid[:64, :128] + 0.5
    away = np.hypot(x - 30.3, y - 33.6) - 20.5
    picture = (255 - 200 * np.clip(0.5 - away, 0, 1)).astype(np.uint8)
    picture[16:48, 80:112] = 120
    drawing = strokefit.fit(picture)
    assert drawing.svg.count("<circle") == 1
    scene = drawing.scene
    assert scene.to_svg() == drawing.svg
    scene.marks.points[::3] += 1
    assert "<circle" not in scene.to_svg()


def test_gradients_that_arrays_do_not_have_are_told() -> None:
    drawing = strokefit.fit(ROOT / "samples/noto-gem.png", strokes=100, preset="draft")
    with pytest.warns(UserWarning, match="areas of the drawing have a gradient"):
        scene = drawing.scene
    assert len(scene.marks.widths) == len(drawing.strokes) + len(drawing.areas)


def test_the_command_line_writes_the_same(program: list[str], tmp_path: Path) -> None:
    path = tmp_path / "cat.svg"
    command = [*program, "fit", CAT, "-o", path, "--strokes", "50", "--preset", "draft", "-q"]
    subprocess.run(command, check=True)
    scene = strokefit.Scene.read(path)
    scene.save(tmp_path / "again.svg")
    assert (tmp_path / "again.svg").read_bytes() == path.read_bytes()
    assert strokefit.Scene.read(path.read_text()).to_svg() == path.read_text()


@pytest.mark.parametrize("draw", [strokes, areas])
def test_arrays_come_back_rounded(draw) -> None:
    marks = draw(0, 12, 40, 30)
    marks.points[:] = marks.points.round(2) + 40
    marks.widths[:] = 1.5
    layers = np.arange(12) // 5
    scene = strokefit.Scene(120, 110, marks, background=(0.2, 0.4, 0.6), layers=layers)
    read = strokefit.Scene.read(scene.to_svg())
    assert read.background == pytest.approx((0.2, 0.4, 0.6)) and (read.width, read.height) == (120, 110)
    assert np.array_equal(read.marks.starts, marks.starts) and np.array_equal(read.layers, layers)
    # A closed path may begin at another of its points.
    renderer = strokefit.Renderer(120, 110)
    assert np.abs(renderer.render(read.marks) - renderer.render(marks)).max() < 0.05
    assert np.allclose(read.marks.colors, marks.colors, atol=0.5 / 255 + 1e-6)
    assert np.array_equal(read.marks.filled, marks.filled) and np.array_equal(read.marks.rings, marks.rings)


def test_a_gradient_stays_and_is_the_renderers_background() -> None:
    ramp = np.broadcast_to(np.linspace(0.2, 0.9, 96)[None, :, None], (64, 96, 3)).copy()
    ramp[20:30, 30:60] = (1, 0, 0)
    drawing = strokefit.fit(ramp, preset="draft")
    assert "Gradient" in drawing.svg
    scene = drawing.scene
    assert scene.background.shape == (64, 96, 3)
    soft = strokefit.Renderer(96, 64).render(scene.marks, scene.background)
    assert np.abs(soft - ramp).mean() < 0.02
    assert scene.to_svg() == drawing.svg
    assert "Gradient" not in scene.with_background((1, 1, 1)).to_svg()


def test_fit_then_a_loss_of_ones_own_then_an_svg() -> None:
    picture = strokefit.render(strokefit.fit(CAT, strokes=80, preset="draft"), background="#ffffff")
    target = 1 - picture.astype(np.float32).mean(axis=2, keepdims=True) / 255  # a negative, of any hue
    scene = strokefit.fit(picture, strokes=40, preset="draft").scene
    renderer = strokefit.Renderer(scene.width, scene.height)

    def loss(canvas: np.ndarray) -> float:
        return float(((canvas.mean(axis=2, keepdims=True) - target) ** 2).sum())

    before = loss(renderer.render(scene.marks, scene.background))
    for _ in range(40):
        error = renderer.render(scene.marks, scene.background).mean(axis=2, keepdims=True) - target
        gradients = renderer.backward(np.repeat(2 / 3 * error, 3, axis=2).astype(np.float32))
        for name, step in (("points", 0.2), ("widths", 0.1), ("colors", 0.01)):
            getattr(scene.marks, name)[:] -= step * np.tanh(getattr(gradients, name))
        scene.marks.widths.clip(1, None, out=scene.marks.widths)
        scene.marks.colors.clip(0, 1, out=scene.marks.colors)
    after = loss(renderer.render(scene.marks, scene.background))
    assert after < 0.8 * before
    file = strokefit.render(scene, background="#ffffff") / 255
    assert loss(file.astype(np.float32)) == pytest.approx(after, rel=0.1)
    assert scene.judge(picture) == strokefit.judge(scene, picture) == strokefit.judge(scene.to_svg(), picture)
    refined = scene.refine(picture, strokes=60, preset="draft")
    assert refined.report["fidelity"]["psnr_db"] > scene.judge(picture)["psnr_db"]


def test_arrays_can_be_replaced() -> None:
    marks = strokes(0, 8, 40, 30)
    scene = strokefit.Scene(40, 30, marks, layers=np.array([0, 0, 1, 1, 1, 2, 2, 2]))
    wide = scene.with_marks(widths=2 * marks.widths)
    assert wide.marks.points is marks.points and np.array_equal(wide.layers, scene.layers)
    assert repr(wide) == "<Scene 40×30 px, 8 marks>"
    two = scene.with_marks(**strokes(1, 2, 40, 30)._asdict())
    assert two.layers.tolist() == [0, 0]


def test_what_is_no_scene_is_refused(tmp_path: Path) -> None:
    marks = strokes(0, 8)
    with pytest.raises(ValueError, match="width=0"):
        strokefit.Scene(0, 8, marks)
    with pytest.raises(ValueError, match=r"layers has shape \(3,\): give \(8,\)"):
        strokefit.Scene(8, 8, marks, layers=np.zeros(3, np.int64))
    with pytest.raises(ValueError, match="none smaller than that before it"):
        strokefit.Scene(8, 8, marks, layers=np.arange(8)[::-1].copy()).to_svg()
    with pytest.raises(ValueError, match="form"):
        strokefit.Scene(8, 8, marks).to_svg(form="small")
    with pytest.raises(ValueError, match="the SVG"):
        strokefit.Scene.read((ROOT / "tests/data/chelsea-traced.svg").read_text())
    with pytest.raises(FileNotFoundError):
        strokefit.Scene.read(tmp_path / "none.svg")
    marks.points[3, 1] = np.nan
    with pytest.raises(ValueError, match="points holds NaN"):
        strokefit.Scene(8, 8, marks).to_svg()
