"""Options mean what they mean on the command line, and wrong ones are refused with what would be right."""

from __future__ import annotations

import importlib.metadata
import re
from pathlib import Path

import numpy as np
import pytest

import strokefit


def test_budgets_are_kept(waves: np.ndarray) -> None:
    assert 0 < strokefit.fit(waves, strokes=12).report["strokes"] <= 12
    assert strokefit.fit(waves, psnr=26).report["fidelity"]["psnr_db"] >= 26
    assert len(strokefit.fit(waves, bytes=2000).svg) <= 2000
    # A picture of which no machine draws all within the time: small ones reach their cap of strokes first.
    noise = np.random.default_rng(1).integers(0, 256, (400, 400, 3), np.uint8)
    limited = strokefit.fit(noise, time=0.3, quality=60)
    assert limited.report["stop"] == "time" and limited.report["wall_s"] < 3


def test_looks_are_kept(waves: np.ndarray) -> None:
    few = {"strokes": 25, "preset": "draft"}
    opaque = strokefit.fit(waves, opaque=True, **few)
    assert (opaque.strokes.opacities == 1).all()
    black_white = strokefit.fit(waves, palette=["#000000", "#FFFFFF"], **few)
    assert set(black_white.strokes.colors.ravel().tolist()) <= {0.0, 1.0}
    assert strokefit.fit(waves, palette="#000000,#ffffff", **few) == black_white
    capsules = strokefit.fit(waves, points=2, **few)
    assert np.diff(capsules.strokes.starts).max() == 2 and capsules.strokes.on_path.all()
    assert not capsules.strokes.closed.any()
    assert np.diff(strokefit.fit(waves, **few).strokes.starts).max() > 2
    four = strokefit.fit(waves, colors=4, **few)
    assert len(np.unique(four.strokes.colors, axis=0)) <= 4
    assert strokefit.fit(waves, background="#102030", **few).svg.count('fill="#102030"') == 1
    assert 'width="120mm"' in strokefit.fit(waves, width="120mm", **few).svg
    assert 'id="color-1"' in strokefit.fit(waves, group="color", **few).svg
    assert "stroke-width" not in strokefit.fit(waves, form="outlines", **few).svg
    assert 'class="' in strokefit.fit(waves, form="css", **few).svg
    assert set(re.findall('stroke-width="(.*?)"', strokefit.fit(waves, pens="2,3.5", **few).svg)) <= {"2", "3.5"}
    travel = strokefit.fit(waves, order="travel", **few).report["travel"]
    assert travel["after_px"] < travel["before_px"]
    assert not re.search(r"\.\d\d", strokefit.fit(waves, precision=1, opaque=True, **few).svg)
    assert len(strokefit.fit(waves, stages=1, **few).report["stages"]) == 1
    assert strokefit.fit(waves, polish=False, **few) != strokefit.fit(waves, **few)
    assert strokefit.fit(waves, seed=2**64 - 1, **few) != strokefit.fit(waves, **few)
    assert strokefit.fit(waves, progressive=True, **few) != strokefit.fit(waves, **few)


def test_marks_are_kept(waves: np.ndarray) -> None:
    lines = strokefit.fit(waves, strokes=12, preset="draft", marks="strokes")
    assert len(lines.strokes) > 0 and len(lines.areas) == 0
    filled = strokefit.fit(waves, strokes=12, preset="draft", marks="areas")
    assert len(filled.strokes) == 0
    with pytest.raises(ValueError, match="'dots' is not a kind of marks"):
        strokefit.fit(waves, marks="dots")


def test_threads_change_nothing(waves: np.ndarray) -> None:
    assert strokefit.fit(waves, strokes=40, threads=1) == strokefit.fit(waves, strokes=40, threads=3)


def test_a_palette_may_be_a_file(waves: np.ndarray, tmp_path: Path) -> None:
    colors = tmp_path / "two.gpl"
    colors.write_text("GIMP Palette\n#\n0 0 0 black\n255 255 255 white\n")
    options = {"strokes": 15, "preset": "draft"}
    expected = strokefit.fit(waves, palette=["#000000", "#ffffff"], **options)
    assert strokefit.fit(waves, palette=colors, **options) == expected
    assert strokefit.fit(waves, palette=str(colors), **options) == expected
    with pytest.raises(FileNotFoundError):
        strokefit.fit(waves, palette="no-such.gpl")


def test_numpy_numbers_are_numbers(waves: np.ndarray) -> None:
    plain = strokefit.fit(waves, strokes=9, preset="draft", quality=20, seed=3)
    other = strokefit.fit(waves, strokes=np.int64(9), preset="draft", quality=np.float32(20), seed=np.uint8(3))
    assert plain == other


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("strokes", 0, "strokes is 0: give a whole number from 1 to 900000"),
        ("strokes", -3, "strokes is -3: give a whole number of 0 or more"),
        ("strokes", 10**30, "give a smaller number"),
        ("psnr", 0, "psnr is 0: give decibels from above 0 to 100"),
        ("psnr", float("nan"), "psnr is NaN: give a finite number"),
        ("bytes", 0, "bytes is 0: give 1 or more"),
        ("time", 0, "time is 0: give seconds above 0"),
        ("time", -1, "time is -1: give seconds above 0"),
        ("quality", 99, "quality is 99: give a number from 0 to 60"),
        ("preset", "fast", "preset is \"fast\": 'fast' is not a preset: give draft, balanced or best"),
        ("precision", 7, "precision is 7: give a whole number from 0 to 6"),
        ("background", "whitish", "'whitish' is not a background: give auto, none"),
        ("colors", 0, "colors is 0: give a whole number from 1 to 4096"),
        ("palette", ["rot"], "'rot' is not a colour"),
        ("form", "tiny", "'tiny' is not a form: give plain, smallest, css, powerstroke or outlines"),
        ("group", "hue", "'hue' is not a grouping"),
        ("order", "random", "'random' is not an order: give fitted or travel"),
        ("pens", "0", "'0' is not a width of a pen"),
        ("pens", "0.3mm", "the pen 0.3mm needs a page of known width"),
        ("width", "12", "'12' is not a length"),
        ("seed", -1, "seed is -1: give a whole number of 0 or more"),
        ("threads", 0, "threads is 0: give a whole number from 1 to 1024"),
        ("stages", 0, "stages is 0: give"),
        ("points", 1, "points is 1: give a whole number from 2 to 65535"),
        ("points", 70_000, "points is 70000: give a whole number from 2 to 65535"),
        ("points", -2, "points is -2: give a whole number of 0 or more"),
    ],
)
def test_values_out_of_range_are_refused(waves: np.ndarray, option: str, value: object, words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        strokefit.fit(waves, **{option: value})


@pytest.mark.parametrize("option", ["strokes", "psnr", "time", "preset", "opaque", "points", "seed", "threads", "polish"])
def test_other_types_are_refused_by_name(waves: np.ndarray, option: str) -> None:
    with pytest.raises(TypeError, match=option):
        strokefit.fit(waves, **{option: object()})


def test_names_that_are_no_option_bring_the_nearest(waves: np.ndarray) -> None:
    with pytest.raises(TypeError, match=r"fit\(\) has no option 'stroke'; did you mean 'strokes'\?"):
        strokefit.fit(waves, stroke=9)
    with pytest.raises(TypeError, match=r"refine\(\) has no option 'colours'; did you mean 'colors'\?"):
        strokefit.refine("<svg/>", waves, colours=9)
    with pytest.raises(TypeError, match=r"'preset_' is no option of a batch; did you mean 'preset'\?"):
        strokefit.batch(".", "out", preset_="draft")


def test_the_version_is_that_of_the_package() -> None:
    assert strokefit.__version__ == importlib.metadata.version("strokefit")


def test_colors_and_a_palette_exclude_each_other(waves: np.ndarray) -> None:
    with pytest.raises(ValueError, match="give one of them"):
        strokefit.fit(waves, colors=3, palette=["#000000"])
