"""A picture is the same picture in every form that Python has it in."""

from __future__ import annotations

import io
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import strokefit

FEW = {"strokes": 20, "preset": "draft"}


def svg(picture: object) -> str:
    return strokefit.fit(picture, **FEW).svg


def test_files_bytes_and_arrays_are_the_same(waves: np.ndarray, tmp_path: Path) -> None:
    path = tmp_path / "waves.png"
    Image.fromarray(waves).save(path)
    expected = svg(waves)
    assert "<path" in expected
    content = path.read_bytes()
    with path.open("rb") as file:
        assert svg(file) == expected
    for picture in (path, str(path), content, bytearray(content), memoryview(content), io.BytesIO(content)):
        assert svg(picture) == expected


def test_sample_types_are_the_same(waves: np.ndarray) -> None:
    expected = svg(waves)
    assert svg(waves.astype(np.uint16) * 257) == expected
    assert svg(waves / np.float32(255)) == expected
    assert svg(waves / 255) == expected


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32, np.float64])
def test_strides_are_the_same(waves: np.ndarray, dtype: type) -> None:
    most = np.iinfo(dtype).max if np.dtype(dtype).kind == "u" else 1
    picture = (waves * (most / 255)).astype(dtype)
    expected = svg(picture)
    padded = np.zeros((80, 70, 5), dtype)
    padded[::2, 3:59, 1:4] = picture
    planar = np.ascontiguousarray(picture.transpose(2, 0, 1))
    packed = np.zeros(picture.shape[:2], [("odd", "u1"), ("rgb", dtype, 3)])
    packed["rgb"] = picture
    for view in (
        padded[::2, 3:59, 1:4],
        planar.transpose(1, 2, 0),
        np.asfortranarray(picture),
        np.ascontiguousarray(picture[::-1, ::-1, ::-1])[::-1, ::-1, ::-1],
        packed["rgb"],
    ):
        assert not view.flags.c_contiguous
        assert svg(view) == expected
    locked = picture.copy()
    locked.flags.writeable = False
    assert svg(locked) == expected


def test_grey_has_one_plane_or_one_channel(waves: np.ndarray) -> None:
    grey = waves[:, :, 0]
    expected = svg(np.repeat(grey[:, :, None], 3, axis=2))
    assert svg(grey) == svg(grey[:, :, None]) == expected
    assert svg(np.broadcast_to(grey[:, :, None], waves.shape)) == expected


def test_alpha_is_kept(waves: np.ndarray) -> None:
    alpha = np.where(np.arange(56) < 28, 0, 255).astype(np.uint8)
    picture = np.dstack([waves, np.broadcast_to(alpha, waves.shape[:2])])
    drawing = strokefit.fit(picture, **FEW)
    render = drawing.to_numpy()
    assert render[:, :20, 3].max() < 30 < 220 < render[:, 36:, 3].min()
    assert drawing.report["alpha"] is not None


def test_pil_images_are_the_arrays_that_they_hold(waves: np.ndarray) -> None:
    image = Image.fromarray(waves)
    assert svg(image) == svg(waves)
    grey = image.convert("L")
    assert svg(grey) == svg(np.asarray(grey))
    assert svg(image.convert("RGBA")) == svg(waves)
    palette = image.convert("P", palette=Image.Palette.ADAPTIVE)
    assert svg(palette) == svg(np.asarray(palette.convert("RGB")))
    deep = Image.fromarray(np.asarray(grey).astype(np.uint16) * 257)
    assert deep.mode.startswith("I;16") and svg(deep) == svg(grey)
    assert svg(image.convert("1")) == svg(np.asarray(image.convert("1").convert("L")))
    with pytest.raises(ValueError, match="mode F has no scale"):
        svg(grey.convert("F"))


def test_objects_with_an_array_are_arrays(waves: np.ndarray) -> None:
    class Tensor:
        def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
            return waves

    assert svg(Tensor()) == svg(waves)


def test_arrays_are_not_copied() -> None:
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="700" height="500"/>'
    for picture in (np.ones((500, 700, 3)), np.ones((3, 500, 700), np.float32).transpose(1, 2, 0)):
        tracemalloc.start()
        strokefit.judge(page, picture)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        # NumPy's arrays are traced, and no other is made.
        assert peak < picture.nbytes / 20


@pytest.mark.parametrize(
    ("shape", "advice"),
    [
        ((4,), "height × width"),
        ((4, 4, 2), "1, 3 .RGB. or 4 .RGBA."),
        ((4, 4, 5), "1, 3 .RGB. or 4 .RGBA."),
        ((2, 4, 4, 3), "height × width"),
        ((3, 40, 50), "transpose"),
        ((0, 4, 3), "4×0"),
    ],
)
def test_other_shapes_are_refused_with_those_that_are_right(shape: tuple[int, ...], advice: str) -> None:
    with pytest.raises(ValueError, match=advice):
        strokefit.fit(np.zeros(shape, np.uint8))


@pytest.mark.parametrize("dtype", [np.int64, np.bool_, np.float16, np.complex64, ">u2"])
def test_other_types_are_refused_with_those_that_are_right(dtype: str) -> None:
    with pytest.raises(TypeError, match="uint8 .0 to 255."):
        strokefit.fit(np.zeros((4, 4, 3), dtype))


@pytest.mark.parametrize("value", [200.0, np.nan, -np.inf])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_floats_on_another_scale_are_refused_with_their_place(value: float, dtype: type) -> None:
    picture = np.zeros((4, 6, 3), dtype)
    picture[1, 5, 2] = value
    for view in (picture, picture.copy("F")):
        with pytest.raises(ValueError, match=r"\(5, 1\).*from 0 to 1"):
            strokefit.fit(view)


def test_what_is_no_picture_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="no-such.png: no such file"):
        strokefit.fit("no-such.png")
    with pytest.raises(IsADirectoryError, match="is a directory"):
        strokefit.fit(tmp_path)
    text = tmp_path / "text.png"
    text.write_text("hello")
    with pytest.raises(ValueError, match="text.png: not a picture"):
        strokefit.fit(text)
    with pytest.raises(ValueError, match="the picture: the file is empty"):
        strokefit.fit(b"")
    with text.open() as file, pytest.raises(TypeError, match="'rb'"):
        strokefit.fit(file)
    for nothing in (None, 5, [[1, 2], [3, 4]], {"a": 1}):
        with pytest.raises(TypeError, match="give a path, bytes"):
            strokefit.fit(nothing)
    with pytest.raises(TypeError, match="fsdecode"):
        strokefit.fit(BytesPath())


class BytesPath:
    """A path in bytes, as `os.scandir(b".")` gives them."""

    def __fspath__(self) -> bytes:
        return b"a.png"
