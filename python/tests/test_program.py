"""The command line: `python -m strokefit`, and its bytes."""

from __future__ import annotations

import importlib.metadata
import json
import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, SAMPLES
from PIL import Image

import strokefit

VERSION = f"strokefit {importlib.metadata.version('strokefit')}\n".encode()
PYTHON = [sys.executable, "-m", "strokefit"]


def run(*args: object, **options: object) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run([*PYTHON, *map(str, args)], capture_output=True, timeout=300, **options)


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda path: path.name)
def test_bytes_are_those_of_the_command_line(sample: Path, program: list[str], tmp_path: Path) -> None:
    out, report = tmp_path / "a.svg", tmp_path / "a.json"
    options = ["--strokes", "300", "--preset", "draft", "--report", str(report)]
    subprocess.run([*program, "fit", str(sample), "-o", str(out), "-q", *options], check=True)
    drawing = strokefit.fit(sample, strokes=300, preset="draft")
    assert drawing.svg.encode() == out.read_bytes()
    told = json.loads(report.read_text())
    assert set(told) == set(drawing.report)
    for field in ("input", "strokes", "points", "stop", "seed", "fidelity", "soft", "agreement", "svg_gzip_bytes", "alpha"):
        assert told[field] == drawing.report[field]


@pytest.mark.parametrize(
    ("flags", "options"),
    [
        (["--psnr", "24", "--opaque", "--colors", "6"], {"psnr": 24, "opaque": True, "colors": 6}),
        (["--bytes", "9000", "--form", "smallest", "--precision", "1"], {"bytes": 9000, "form": "smallest", "precision": 1}),
        (["--quality", "18", "--background", "#ffffff", "--seed", "5"], {"quality": 18, "background": "#ffffff", "seed": 5}),
        (["--strokes", "60", "--progressive", "--group", "color"], {"strokes": 60, "progressive": True, "group": "color"}),
        (["--strokes", "60", "--no-polish", "--stages", "2"], {"strokes": 60, "polish": False, "stages": 2}),
        (["--strokes", "60", "--points", "2"], {"strokes": 60, "points": 2}),
        (["--strokes", "60", "--points", "4"], {"strokes": 60, "points": 4}),
        (["--strokes", "60", "--outline", "--width", "9cm"], {"strokes": 60, "form": "outlines", "width": "9cm"}),
        (["--strokes", "60", "--palette", "#000000,#ff8800"], {"strokes": 60, "palette": ["#000000", "#ff8800"]}),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else "",
)
def test_options_are_those_of_the_command_line(
    flags: list[str], options: dict[str, object], program: list[str], tmp_path: Path
) -> None:
    sample, out = ROOT / "samples/noto-gem.png", tmp_path / "a.svg"
    flags = ["-q", "--preset", "draft", *flags]
    subprocess.run([*program, "fit", str(sample), "-o", str(out), *flags], check=True)
    assert strokefit.fit(sample, preset="draft", **options).svg.encode() == out.read_bytes()


@pytest.mark.parametrize("freeze", [False, True])
def test_refining_gives_the_bytes_of_the_command_line(freeze: bool, program: list[str], tmp_path: Path) -> None:
    sample, own, out = ROOT / "samples/chelsea-cat.png", tmp_path / "own.svg", tmp_path / "out.svg"
    strokefit.fit(sample, strokes=40, preset="draft").save(own)
    for base in (ROOT / "tests/data/chelsea-traced.svg", own):
        flags = ["--strokes", "90", "--preset", "draft", "-q", *(["--freeze-base"] if freeze else [])]
        subprocess.run([*program, "refine", str(base), str(sample), "-o", str(out), *flags], check=True)
        drawing = strokefit.refine(base, sample, strokes=90, preset="draft", freeze_base=freeze)
        assert drawing.svg.encode() == out.read_bytes()


def test_judging_is_what_check_says_of_resvg(program: list[str], tmp_path: Path) -> None:
    svg, picture, report = ROOT / "samples/bicycle.svg", ROOT / "samples/bicycle.png", tmp_path / "a.json"
    command = [*program, "check", str(svg), str(picture), "--renderer", "resvg", "--report", str(report)]
    subprocess.run(command, check=True, capture_output=True)
    assert strokefit.judge(svg, picture) == json.loads(report.read_text())["renderers"][0]["fidelity"]


def test_rendering_is_what_render_writes(program: list[str], tmp_path: Path) -> None:
    svg, out = ROOT / "samples/bicycle.svg", tmp_path / "a.png"
    subprocess.run([*program, "render", str(svg), "-o", str(out), "--scale", "0.5"], check=True)
    expected = np.asarray(Image.open(out).convert("RGBA"))
    seen = expected[:, :, 3] > 0
    render = strokefit.render(svg, 0.5)
    assert (render[:, :, 3] == expected[:, :, 3]).all() and (render[seen] == expected[seen]).all()


def test_the_program_is_whole() -> None:
    assert run("--version").stdout == VERSION
    help = run("fit", "--help")
    assert help.returncode == 0 and b"strokefit fit photo.jpg -o photo.svg" in help.stdout
    misused = run("fit", "a.png")
    assert misused.returncode == 2 and misused.stderr.startswith(b"error: ")
    missing = run("fit", "no-such.png", "-o", "-")
    assert missing.returncode == 1 and b"no such file" in missing.stderr
    short = run("fit", ROOT / "samples/noto-gem.png", "-o", "-", "--strokes", 5, "--psnr", 90)
    assert short.returncode == 3 and short.stdout.startswith(b"<svg")


def test_the_command_is_installed() -> None:
    command = Path(sys.executable).parent / "strokefit"
    assert subprocess.check_output([command, "--version"]) == VERSION


def test_pipes_are_read_and_written() -> None:
    content = (ROOT / "samples/noto-gem.png").read_bytes()
    piped = run("fit", "-", "-o", "-", "--strokes", 20, "--preset", "draft", "-q", input=content)
    assert piped.stdout.decode() == strokefit.fit(content, strokes=20, preset="draft").svg


def test_benchmarks_are_another_program(tmp_path: Path) -> None:
    outcome = run("bench", "pareto", "a.png", env={"PATH": str(tmp_path)})
    assert outcome.returncode == 2 and b"cargo run --release -p rig -- pareto a.png" in outcome.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent otherwise")
def test_ctrl_c_ends_the_program_as_it_ends_others(noise: np.ndarray, tmp_path: Path) -> None:
    picture, out = tmp_path / "noise.png", tmp_path / "noise.svg"
    Image.fromarray(noise).save(picture)
    command = [*PYTHON, "fit", str(picture), "-o", str(out), "--quality", "60", "--preset", "best"]
    # What runs the tests in the background may ignore the signal, and a program would inherit that.
    heeds = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with subprocess.Popen(command, stderr=subprocess.PIPE, preexec_fn=heeds) as program:
        time.sleep(1.5)
        os.kill(program.pid, signal.SIGINT)
        try:
            _, words = program.communicate(timeout=30)
        finally:
            program.kill()
    assert program.returncode == -signal.SIGINT and b"as far as it had come" in words
    assert out.read_text().startswith("<svg")
