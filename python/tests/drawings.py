"""Random marks for the tests of the renderer."""

from __future__ import annotations

import numpy as np

import strokefit

WIDTH, HEIGHT = 96, 64


def strokes(seed: int, count: int = 120, width: int = WIDTH, height: int = HEIGHT) -> strokefit.Marks:
    """Dots, capsules, curves and loops, everywhere and a little beyond."""
    return _marks(seed, count, width, height, ["dot", "capsule", "curve", "loop"])


def areas(seed: int, count: int = 60, width: int = WIDTH, height: int = HEIGHT) -> strokefit.Marks:
    """Capsules, filled rings, and filled rings with a hole."""
    return _marks(seed, count, width, height, ["capsule", "ring", "hole"])


def capsules(seed: int, count: int, width: int, height: int) -> strokefit.Marks:
    """Thin opaque strokes, as those of the article's large demo."""
    random = np.random.default_rng(seed)
    start = random.uniform(0, (width, height), (count, 2))
    points = np.stack([start, start + random.normal(0, 4, (count, 2))], 1).reshape(-1, 2)
    return strokefit.Marks(
        points=points.astype(np.float32),
        starts=np.arange(0, 2 * count + 1, 2),
        widths=random.uniform(0.2, 0.4, count).astype(np.float32),
        colors=random.random((count, 3)).astype(np.float32),
        opacities=np.ones(count, np.float32),
    )


def double(marks: strokefit.Marks) -> strokefit.Marks:
    """The marks in float64, for the reference."""
    names = ("points", "widths", "colors", "opacities")
    return marks._replace(**{name: getattr(marks, name).astype(np.float64) for name in names})


def _marks(seed: int, count: int, width: int, height: int, kinds: list[str]) -> strokefit.Marks:
    random = np.random.default_rng(seed)
    points, on_path, starts, rings = [], [], [0], []
    kind_of = [kinds[i % len(kinds)] for i in range(count)]
    for kind in kind_of:
        own, on = _shape(kind, random)
        points.append(own + random.uniform(0, (width, height)))
        on_path.append(on)
        if kind == "hole":
            rings.append(starts[-1] + len(own) // 2)
        starts.append(starts[-1] + len(own))
    return strokefit.Marks(
        points=np.concatenate(points).astype(np.float32),
        starts=np.array(starts),
        widths=random.uniform(1, 6, count).astype(np.float32),
        colors=random.random((count, 3)).astype(np.float32),
        opacities=random.uniform(0.1, 1, count).astype(np.float32),
        on_path=np.concatenate(on_path),
        closed=np.array([kind == "loop" for kind in kind_of]),
        filled=np.array([kind in ("ring", "hole") for kind in kind_of]),
        rings=np.array(rings, np.int64),
    )


def _shape(kind: str, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    if kind == "dot":
        return np.zeros((1, 2)), np.ones(1, bool)
    if kind == "capsule":
        return random.normal(0, 8, (2, 2)), np.ones(2, bool)
    if kind == "curve":
        return np.cumsum(random.normal(0, 6, (4, 2)), 0), np.array([True, False, False, True])
    angles = np.arange(8) * np.pi / 4 + random.random()
    outline = np.stack([np.cos(angles), np.sin(angles)], 1) * random.uniform(6, 9, (8, 1))
    on = random.random(8) < 0.5
    if kind != "hole":
        return outline, on
    return np.concatenate([outline, 0.4 * outline[::-1]]), np.concatenate([on, np.ones(8, bool)])
