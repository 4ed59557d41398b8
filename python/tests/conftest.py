"""What the tests share: the sample pictures and the program that the package is compared with."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = sorted(p for p in (ROOT / "samples").iterdir() if p.suffix in (".png", ".jpg"))


@pytest.fixture
def program() -> list[str]:
    """The command line: the program itself where STROKEFIT_PROGRAM names it, else the package's."""
    named = os.environ.get("STROKEFIT_PROGRAM")
    return [named] if named else [sys.executable, "-m", "strokefit"]


@pytest.fixture
def waves() -> np.ndarray:
    """A smooth RGB picture, 40 × 56, uint8, that takes some strokes."""
    y, x = np.mgrid[:40, :56]
    channels = [np.sin(x / 5) * np.cos(y / 7), np.sin((x + y) / 9), np.cos(x / 11 - y / 6)]
    return (127 + 100 * np.stack(channels, axis=2)).astype(np.uint8)


@pytest.fixture
def noise() -> np.ndarray:
    """A picture whose fit takes many seconds."""
    return np.random.default_rng(0).integers(0, 256, (400, 400, 3), np.uint8)


@pytest.fixture
def bomb(tmp_path: Path) -> dict[str, str]:
    """An environment in which a process ends when it reads a picture named bomb.png."""
    folder = tmp_path / "bomb"
    folder.mkdir()
    (folder / "sitecustomize.py").write_text("""
import os
from strokefit._batch import draw

def read(one, read=draw.read):
    if one.location.endswith("bomb.png"):
        os.abort()
    return read(one)

draw.read = read
""")
    return {"PYTHONPATH": str(folder)}
