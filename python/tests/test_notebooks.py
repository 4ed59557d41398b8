"""The notebooks of docs/notebooks run as they are, and their outputs are kept and small."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

NOTEBOOKS = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))
assert NOTEBOOKS
notebooks = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)

MOST_BYTES = 120_000


def code_cells(path: Path) -> list[dict[str, object]]:
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return [cell for cell in cells if cell["cell_type"] == "code"]


@notebooks
def test_the_notebook_runs(path: Path) -> None:
    for module in ("torch", "matplotlib"):
        pytest.importorskip(module, reason=f"{module} is not installed")
    code = "\n\n".join("".join(cell["source"]) for cell in code_cells(path))
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    outcome = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, env=environment, capture_output=True, text=True, timeout=900
    )
    print(outcome.stdout)
    assert outcome.returncode == 0, outcome.stderr


@notebooks
def test_its_outputs_are_kept_and_small(path: Path) -> None:
    outputs = [output for cell in code_cells(path) for output in cell["outputs"]]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    assert all(output["output_type"] in ("stream", "display_data") for output in outputs)
    assert path.stat().st_size <= MOST_BYTES
