"""The examples of docs/python.md and of the READMEs run as they are written."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

PAGES = ["docs/batch.md", "docs/gradients.md", "docs/python.md", "README.md", "python/README.md"]
HAS_TORCH = importlib.util.find_spec("torch") is not None


def examples() -> list[object]:
    found = []
    for page in PAGES:
        blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.M | re.S)
        assert blocks, f"{page} has no example"
        found += [example(block, f"{page}:{i}") for i, block in enumerate(blocks, 1)]
    return found


def example(code: str, name: str) -> object:
    """An example; one with PyTorch is for where that is installed."""
    if "import torch" not in code:
        return pytest.param(code, id=name)
    return pytest.param(code, id=f"{name}-torch", marks=pytest.mark.skipif(not HAS_TORCH, reason="PyTorch is not installed"))


@pytest.mark.parametrize("code", examples())
def test_the_example_runs(code: str, tmp_path: Path) -> None:
    for folder in ("samples", "tests"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    (tmp_path / "photo.jpg").symlink_to(ROOT / "samples/starry-night.jpg")
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    command = [sys.executable, "-W", "error::DeprecationWarning:__main__", "-c", code]
    outcome = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert outcome.returncode == 0, outcome.stderr
