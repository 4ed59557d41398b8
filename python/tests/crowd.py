"""Many small pictures, batches of them in processes of their own, and what they wrote."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
from PIL import Image

#: A fit of these takes some 20 ms.
OPTIONS = {"strokes": 12, "preset": "draft"}
FLAGS = ["--strokes", "12", "--preset", "draft"]


def pictures(folder: Path, count: int, size: int = 24) -> list[str]:
    """Pictures that all differ, in folders of 50; their paths."""
    y, x = np.mgrid[:size, :size]
    paths = []
    for i in range(count):
        path = folder / f"{i // 50}" / f"{i}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        planes = [128 + 120 * np.sin((x * (1 + i % 7) + y * c + i) / 9) for c in (1, 2, 3)]
        Image.fromarray(np.stack(planes, axis=2).astype(np.uint8)).save(path)
        paths.append(str(path))
    return paths


def batch(*args: object, **environment: str) -> subprocess.Popen[str]:
    """`python -m strokefit.batch`, started."""
    command = [sys.executable, "-m", "strokefit.batch", *map(str, args)]
    environment = {**os.environ, **environment}
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment, preexec_fn=HEEDING)


# What runs the tests in the background may ignore Ctrl-C, and a program would inherit that.
HEEDING = None if sys.platform == "win32" else partial(signal.signal, signal.SIGINT, signal.SIG_DFL)


def ended(process: subprocess.Popen[str], timeout_s: float = 240) -> tuple[int, str]:
    """Its exit status and what it said."""
    try:
        _, words = process.communicate(timeout=timeout_s)
    finally:
        process.kill()
    return process.returncode, words


def rows(folder: Path) -> dict[str, dict[str, object]]:
    """All rows of a finished batch by their paths; each path is there once."""
    found = [row for shard in sorted(folder.glob("part-*.parquet")) for row in pq.read_table(shard).to_pylist()]
    by_path = {row["path"]: row for row in found}
    assert len(by_path) == len(found)
    return by_path


def drawings(folder: Path) -> dict[str, object]:
    """The SVG of each path."""
    return {path: row["svg"] for path, row in rows(folder).items()}


def noted(folder: Path) -> int:
    """Rows that are written so far."""
    journals = folder.glob("_strokefit/part-*.jsonl")
    return sum(journal.read_bytes().count(b"\n") for journal in journals) + len(rows(folder))


def until(holds: Callable[[], bool], timeout_s: float = 60) -> None:
    end_s = time.monotonic() + timeout_s
    while not holds():
        assert time.monotonic() < end_s, "it took too long"
        time.sleep(0.02)


def children(process: int) -> list[int]:
    """Processes that a process has started, on Linux."""
    return [int(child) for task in Path(f"/proc/{process}/task").glob("*/children") for child in task.read_text().split()]


def report(row: dict[str, object]) -> dict[str, object]:
    told: dict[str, object] = json.loads(str(row["report"]))
    return told
