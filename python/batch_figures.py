"""Measures what docs/batch.md and its page of the notebook say: `python python/batch_figures.py [NAME…]`, from the root of a clone.

NAME is overhead, workers, again, memory or costs; all of them unless given. Leave the machine idle meanwhile. With Ray
installed, both engines are measured.
"""

from __future__ import annotations

import importlib.util
import itertools
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import strokefit
from PIL import Image

ENGINES = ["local", "ray"] if importlib.util.find_spec("ray") else ["local"]
SAMPLES = ["coffee-300.png", "chelsea-cat.png", "starry-night.jpg", "rocket-320.png"]

#: A fit of a crop of 64×64 px takes some 0.3 s of CPU.
FLAGS = ["--strokes", "70"]
OPTIONS = {"strokes": 70}


def crops(folder: Path, count: int, size: int = 64) -> Path:
    """Different crops of the samples, or of the samples enlarged."""
    folder.mkdir()
    whole = [Image.open(Path("samples") / name).convert("RGB") for name in SAMPLES]
    random = np.random.default_rng(5)
    for i, image in zip(range(count), itertools.cycle(whole)):
        scale = max(1.0, 1.5 * size / min(image.size))
        width, height = (round(side * scale) for side in image.size)
        x, y = random.integers(0, width - size), random.integers(0, height - size)
        image.resize((width, height)).crop((x, y, x + size, y + size)).save(folder / f"{i:06}.png")
    return folder


def run(*args: object) -> tuple[float, float, str]:
    """Wall time and the machine's CPU time of a batch, s, and its summary."""
    before, start = cpu_s(), time.perf_counter()
    command = [sys.executable, "-m", "strokefit.batch", *map(str, args)]
    done = subprocess.run(command, stderr=subprocess.PIPE, text=True, check=True)
    return time.perf_counter() - start, cpu_s() - before, done.stderr


def cpu_s() -> float:
    """Of all processes of the machine, since Ray's children are not told of to their parents."""
    user, nice, system = map(int, Path("/proc/stat").read_text().split()[1:4])
    return (user + nice + system) / os.sysconf("SC_CLK_TCK")


def fresh() -> Path:
    return Path(tempfile.mkdtemp())


def overhead() -> None:
    """CPU time against a loop, in turns, for a few pictures and for more: the first tells what starting takes."""
    few, more = 4, 60
    source = crops(fresh() / "in", more)
    for engine in ENGINES:
        for _ in range(3):
            loop_s, batch_s = zip(*(pair(engine, source, count) for count in (few, more)))
            own_s, ratio = loop_s[1] / more, (batch_s[1] - batch_s[0]) / (loop_s[1] - loop_s[0])
            print(f"{engine}: {own_s:.2f} CPU s a picture; a batch takes {batch_s[0] - loop_s[0]:.1f} to start, then {ratio:.3f} ×", flush=True)


def pair(engine: str, source: Path, count: int) -> tuple[float, float]:
    """CPU time of a loop and of a batch, s."""
    code = f"import sys, strokefit\nfor path in sys.argv[1:]: strokefit.fit(path, threads=1, **{OPTIONS})"
    before = cpu_s()
    subprocess.run([sys.executable, "-c", code, *sorted(source.iterdir())[:count]], check=True)
    loop_s = cpu_s() - before
    return loop_s, run(source, "-o", fresh(), "--limit", count, "--engine", engine, "--workers", 1, *FLAGS)[1]


def workers() -> None:
    """Wall time with one worker against two, in turns."""
    source = crops(fresh() / "in", 150)
    for engine in ENGINES:
        for _ in range(3):
            one_s, two_s = (run(source, "-o", fresh(), "--engine", engine, "--workers", n, *FLAGS)[0] for n in (1, 2))
            print(f"{engine}: one worker {one_s:.1f} s, two {two_s:.1f} s, {one_s / two_s:.2f} ×", flush=True)


def again() -> None:
    """A run that has nothing to do."""
    source, out = crops(fresh() / "in", 200, 16), fresh()
    for number in range(3):
        wall_s, _, words = run(source, "-o", out, "--strokes", 5)
        print(f"run {number + 1}: {wall_s:.2f} s: {words.splitlines()[:2]}", flush=True)


def memory() -> None:
    """Peak memory of the process that runs a batch, for ever more pictures of 2×2 px in one folder."""
    for count in (1_000, 10_000, 100_000):
        source = fresh() / "in"
        source.mkdir()
        for i, content in zip(range(count), tiny()):
            (source / f"{i:06}.png").write_bytes(content)
        code = "import resource, sys\nfrom strokefit._batch.cli import main\nmain()\nprint(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10)"
        command = [sys.executable, "-c", code, source, "-o", fresh(), "-q", "--preset", "draft", "--strokes", "2"]
        start = time.perf_counter()
        told = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
        print(f"{count} pictures: {told.strip()} MiB at most, {time.perf_counter() - start:.0f} s", flush=True)


def tiny() -> Iterator[bytes]:
    """BMP files that all differ."""
    for i in itertools.count():
        pixels = b"".join(bytes((i >> shift & 255, i & 255, 77)) * 2 + b"\0\0" for shift in (8, 16))
        header = b"BM" + (54 + len(pixels)).to_bytes(4, "little") + bytes(4) + (54).to_bytes(4, "little")
        fields = [(40, 4), (2, 4), (2, 4), (1, 2), (24, 2), (0, 4), (len(pixels), 4), (0, 4), (0, 4), (0, 4), (0, 4)]
        yield header + b"".join(value.to_bytes(size, "little") for value, size in fields) + pixels


def costs() -> None:
    """CPU time of a picture by size and preset; the default quality, on one thread."""
    for size in (64, 128, 256, 512):
        source = crops(fresh() / "in", 8 if size < 512 else 4, size)
        for preset in ("draft", "balanced", "best"):
            summary = strokefit.batch(source, fresh(), preset=preset)
            sizes, decibels = summary.svg_bytes_percentiles, summary.psnr_db_percentiles
            mean_s = summary.cpu_s / summary.drawn
            print(f"{size} px, {preset}: {mean_s:.2f} CPU s a picture, median {decibels[2]:.1f} dB, {sizes[2] / 1000:.0f} kB", flush=True)


def main() -> None:
    every = {"overhead": overhead, "workers": workers, "again": again, "memory": memory, "costs": costs}
    for name in sys.argv[1:] or every:
        every[name]()


if __name__ == "__main__":
    main()
