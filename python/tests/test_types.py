"""What a type checker knows of the package: `mypy` checks this file, and pytest runs it."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional

import numpy as np
from numpy.typing import NDArray
from PIL import Image

import strokefit

if TYPE_CHECKING:
    from typing_extensions import assert_type


def test_results_have_the_types_that_are_declared(tmp_path: Path) -> None:
    picture: NDArray[np.uint8] = np.full((16, 24, 3), 90, np.uint8)
    picture[4:8, 5:20] = 200
    drawing = strokefit.fit(picture, strokes=3, progress=print, cancel=strokefit.CancelToken())
    if TYPE_CHECKING:
        assert_type(drawing, strokefit.Drawing)
        assert_type(drawing.svg, str)
        assert_type(drawing.report["fidelity"]["psnr_db"], Optional[float])
        assert_type(drawing.report["stages"][0]["strokes"], int)
        assert_type(drawing.strokes[0], strokefit.Stroke)
        assert_type(drawing.strokes[:2], list[strokefit.Stroke])
        assert_type(drawing.strokes[0].color, tuple[float, float, float])
        assert_type(drawing.strokes[0].on_path, NDArray[np.bool_])
        assert_type(drawing.strokes[0].closed, bool)
        assert_type(drawing.strokes[0].flattened(), NDArray[np.float32])
        assert_type(drawing.strokes.widths, NDArray[np.float32])
        assert_type(drawing.to_numpy(2), NDArray[np.uint8])
        assert_type(strokefit.judge(drawing, picture), strokefit.Fidelity)
        assert_type(drawing.scene, strokefit.Scene)
        assert_type(drawing.scene.to_svg(), str)
        assert_type(drawing.scene.marks.starts, NDArray[np.int64])
        renderer = strokefit.Renderer(24, 16, softness=1.0)
        assert_type(renderer.render(drawing.scene.marks, drawing.scene.background), NDArray[Any])
        assert_type(renderer.backward(np.zeros((16, 24, 3), np.float32)), strokefit.Gradients)
    assert isinstance(drawing.strokes[0].width, float)
    assert isinstance(drawing.report["fidelity"]["ssim"], float)


def test_pictures_of_all_kinds_are_pictures(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    Image.new("RGB", (8, 8), (9, 9, 9)).save(path)
    content = path.read_bytes()
    pictures: list[strokefit.Picture] = [str(path), path, content, bytearray(content), io.BytesIO(content)]
    pictures += [Image.open(path), np.full((8, 8), 9, np.uint8), np.full((8, 8), 9 / 255)]
    assert len({strokefit.fit(picture) for picture in pictures}) == 1
