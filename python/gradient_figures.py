"""Measures one forward and one backward pass through NumPy, PyTorch and the article's program: `python
python/gradient_figures.py FOLDER`, from the root of a clone.

FOLDER has what `cargo bench -p rig --bench gradients -- FOLDER` saved: the strokes, and the times in Rust. Leave the machine
idle meanwhile. The article's program has a tensor for each stroke; its time is measured with few strokes, and extrapolated
in proportion, as is the memory that it takes.
"""

from __future__ import annotations

import json
import os
import resource
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import strokefit
import torch
from strokefit.torch import render

ROUNDS = 40
#: Strokes for which the article's program is measured.
FEW = 50


def times_ms(job: Callable[[], object], rounds: int = ROUNDS) -> list[float]:
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        job()
        times.append(1e3 * (time.perf_counter() - start))
    return times


class Case:
    """The strokes of one drawing, and the derivatives that its backward pass starts from."""

    def __init__(self, path: Path) -> None:
        saved = json.loads(path.read_text())
        self.width, self.height = saved["width"], saved["height"]
        strokes = np.array(saved["strokes"], np.float32)
        self.points, self.widths = strokes[:, :4].reshape(-1, 2, 2).copy(), 2 * strokes[:, 4]
        self.colors, self.opacities = strokes[:, 5:8].copy(), strokes[:, 8].copy()
        self.background = tuple(saved["background"])
        self.d_canvas = np.random.default_rng(0).normal(size=(self.height, self.width, 3)).astype(np.float32)
        self.rust_ms, self.fused_ms = map(float, path.with_suffix(".ms").read_text().split())

    def numpy(self) -> Callable[[], object]:
        count = len(self.widths)
        starts = np.arange(0, 2 * count + 1, 2)
        marks = strokefit.Marks(self.points.reshape(-1, 2), starts, self.widths, self.colors, self.opacities)
        renderer = strokefit.Renderer(self.width, self.height, softness=1.0)
        return lambda: (renderer.render(marks, self.background), renderer.backward(self.d_canvas))

    def tensors(self, count: int | None = None) -> list[torch.Tensor]:
        arrays = (self.points, self.widths, self.colors, self.opacities)
        tensors = [torch.from_numpy(array[:count].copy()).requires_grad_() for array in arrays]
        return [*tensors, torch.tensor(self.background, requires_grad=True)]

    def torch(self, with_loss: bool) -> Callable[[], object]:
        tensors, d_canvas = self.tensors(), torch.from_numpy(self.d_canvas)
        target = torch.full_like(d_canvas, 0.25)

        def job() -> object:
            *marks, background = tensors
            image = render(*marks, background=background, width=self.width, height=self.height, softness=1.0)
            if with_loss:
                return torch.autograd.grad((image - target).square().mean(), tensors)
            return torch.autograd.grad(image, tensors, d_canvas)

        return job

    def article(self, count: int, compiled: bool) -> Callable[[], object]:
        tensors, d_canvas = self.tensors(count), torch.from_numpy(self.d_canvas)
        function = torch.compile(article) if compiled else article

        def job() -> object:
            image = function(*tensors[:3], tensors[4], self.height, self.width)
            return torch.autograd.grad(image, [*tensors[:3], tensors[4]], d_canvas)

        return job


def article(points, widths, colors, background, rows: int, columns: int):  # type: ignore[no-untyped-def]
    """The article's renderer, as in docs/notebooks/article.ipynb."""
    y, x = torch.meshgrid(torch.arange(rows) + 0.5, torch.arange(columns) + 0.5, indexing="ij")
    pa = torch.stack([x, y], -1) - points[:, 0, None, None]
    ba = (points[:, 1] - points[:, 0])[:, None, None]
    h = ((pa * ba).sum(-1) / ((ba * ba).sum(-1) + 1e-3)).clamp(0, 1)
    distance = widths[:, None, None] / 2 - ((pa - ba * h[..., None]).square().sum(-1) + 1e-3).sqrt()
    t = ((distance + 0.5) / (1 + 1e-4)).clamp(0, 1)
    canvas = background.expand(rows, columns, 3)
    for m, color in zip((t * t * (3 - 2 * t))[..., None], colors):
        canvas = canvas * (1 - m) + color * m
    return canvas


def main(folder: Path) -> None:
    torch.set_num_threads(1)
    print("strokes, px         Rust  fused   NumPy  PyTorch  with a loss   over Rust   over fused")
    for path in sorted(folder.glob("*.json"), key=lambda path: path.stat().st_mtime):
        case = Case(path)
        jobs = [case.numpy(), case.torch(False), case.torch(True)]
        # In turns, so that other load slows all alike; each of them some times in a row, as in a descent.
        rounds = [[min(times_ms(job, 10)) for job in jobs] for _ in range(ROUNDS // 4)]
        array, tensor, loss = (min(column) for column in zip(*rounds))
        print(
            f"{path.stem:18} {case.rust_ms:6.3f} {case.fused_ms:6.3f} {array:7.3f}  {tensor:7.3f}  {loss:11.3f} "
            f" {tensor - case.rust_ms:+7.3f} ms {100 * (tensor / case.rust_ms - 1):+4.0f} %  {tensor / case.fused_ms:6.2f} ×",
            flush=True,
        )
    torch.set_num_threads(os.cpu_count() or 1)
    for name in ("500-256x256", "5000-550x220"):
        against_the_article(Case(folder / f"{name}.json"), name)


def against_the_article(case: Case, name: str) -> None:
    ours = min(times_ms(case.torch(False)))
    count = len(case.widths)
    for compiled in (False, True):
        if compiled and not hasattr(torch, "compile"):
            continue
        few = min(count, FEW)
        job = case.article(few, compiled)
        start = time.perf_counter()
        job()
        first_s = time.perf_counter() - start
        theirs = statistics.median(times_ms(job, 5)) * count / few
        print(
            f"{name}: the article's program, {'compiled' if compiled else 'eager'}, {theirs / 1e3:.1f} s from {few} strokes "
            f"(first call {first_s:.1f} s), {theirs / ours:.0f} × ours of {ours:.2f} ms; "
            f"peak of this process {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20:.1f} GiB",
            flush=True,
        )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
