"""Measures what docs/python.md says of time, threads and memory: `python python/figures.py [PROGRAM]`, from the root of a clone.

PROGRAM is the command line to compare with, `target/release/strokefit` unless given. Leave the machine idle meanwhile.
"""

from __future__ import annotations

import json
import os
import resource
import statistics
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import strokefit

SAMPLES = ["coffee-300.png", "chelsea-cat.png", "starry-night.jpg"]
PAIRS = 15


def command_line(program: str, sample: Path, threads: int) -> tuple[float, float]:
    """Wall and CPU time of a fit, s."""
    options = ["--preset", "draft", "--strokes", "1000", "--threads", str(threads), "-q", "--report", "-"]
    before = cpu_s(resource.RUSAGE_CHILDREN)
    told = subprocess.check_output([program, "fit", sample, "-o", os.devnull, *options])
    return float(json.loads(told)["wall_s"]), cpu_s(resource.RUSAGE_CHILDREN) - before


def package(sample: Path, threads: int) -> tuple[float, float]:
    before = cpu_s(resource.RUSAGE_SELF)
    drawing = strokefit.fit(sample, preset="draft", strokes=1000, threads=threads)
    return drawing.report["wall_s"], cpu_s(resource.RUSAGE_SELF) - before


def cpu_s(who: int) -> float:
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def times(program: str) -> None:
    """A fit, reading and verdict included, in turns with the program."""
    for threads in (1, 2):
        for name in SAMPLES:
            sample = Path("samples") / name
            pairs = [(package(sample, threads), command_line(program, sample, threads)) for _ in range(PAIRS)]
            for kind, index in (("wall", 0), ("CPU", 1)):
                ours = [our[index] for our, _ in pairs]
                theirs = [their[index] for _, their in pairs]
                median = statistics.median(a / b for a, b in zip(ours, theirs))
                print(
                    f"{name}, {threads} threads, {kind}: package {min(ours):.3f} s, program {min(theirs):.3f} s at best, "
                    f"ratio {min(ours) / min(theirs):.3f}; median of {PAIRS} ratios {median:.3f}",
                    flush=True,
                )


def scaling() -> None:
    """Two Python threads against one, each fit on one thread."""
    wide = strokefit.render(strokefit.fit("samples/coffee-300.png", preset="draft"), 2, "#ffffff")
    pictures = [wide[y : y + 64, x : x + 64] for y in range(0, 320, 40) for x in range(0, 500, 50)]

    def draw(picture: np.ndarray) -> str:
        return strokefit.fit(picture, preset="draft", strokes=60, threads=1).svg

    def wall_s(workers: int) -> float:
        start = time.perf_counter()
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(draw, pictures))
        return time.perf_counter() - start

    rounds = [(wall_s(1), wall_s(2)) for _ in range(7)]
    one, two = (min(column) for column in zip(*rounds))
    print(f"{len(pictures)} pictures: one thread {one:.2f} s, two {two:.2f} s at best, {one / two:.2f} × as fast")


def memory() -> None:
    """How much more memory judging takes at its peak for arrays of other sizes of sample: the array is not among it."""
    code = """
import sys, numpy as np, strokefit
def peak():
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmHWM"))
packed = sys.argv[2] == "packed"
picture = np.full((3000, 4000, 3), 1, sys.argv[1]) if packed else np.full((3, 4000, 3000), 1, sys.argv[1]).T
before = peak()
strokefit.judge('<svg xmlns="http://www.w3.org/2000/svg" width="4" height="3"/>', picture)
print(f"{sys.argv[1]:8} {sys.argv[2]:8} array {picture.nbytes / 2**20:.0f} MiB, then {(peak() - before) / 2**10:.0f} MiB more")
"""
    for dtype in ("uint8", "uint16", "float32", "float64"):
        for layout in ("packed", "strided"):
            subprocess.run([sys.executable, "-c", code, dtype, layout], check=True)


def main() -> None:
    program = sys.argv[1] if len(sys.argv) > 1 else "target/release/strokefit"
    times(program)
    scaling()
    memory()


if __name__ == "__main__":
    main()
