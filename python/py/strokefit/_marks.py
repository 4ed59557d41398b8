"""Marks as flat arrays, checked before they go to Rust."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Optional

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Marks(NamedTuple):
    """Strokes and areas as flat arrays: n marks of m points, back to front.

    Points, widths, colours and opacities are float32 (float64 for `Reference`). The other arrays say what the points mean;
    those that are None have the default that is told here.

    >>> import numpy as np, strokefit
    >>> line = strokefit.Marks(
    ...     points=np.array([[2, 4], [14, 4]], np.float32),
    ...     starts=np.array([0, 2]),
    ...     widths=np.array([3], np.float32),
    ...     colors=np.array([[1, 0, 0]], np.float32),
    ...     opacities=np.array([1], np.float32),
    ... )
    >>> strokefit.Renderer(16, 8).render(line)[4, 8].tolist()
    [1.0, 0.0, 0.0]
    """

    #: m × 2, px.
    points: NDArray[Any]
    #: int64, n + 1: mark i has the points `points[starts[i]:starts[i + 1]]`.
    starts: NDArray[np.int64]
    #: n, px. That of an area has no effect.
    widths: NDArray[Any]
    #: n × 3: red, green and blue, 0..1, sRGB-encoded. The renderer takes any finite number.
    colors: NDArray[Any]
    #: n, 0..1.
    opacities: NDArray[Any]
    #: bool, m: the points that are on their path; the others are control points. All, if None.
    on_path: Optional[NDArray[np.bool_]] = None
    #: bool, n: the strokes whose last point is joined to the first. None, if None.
    closed: Optional[NDArray[np.bool_]] = None
    #: bool, n: the marks that are areas. None, if None.
    filled: Optional[NDArray[np.bool_]] = None
    #: int64, in rising order: the points, after the first of an area, at which another of its rings begins. If None, each
    #: area has one ring.
    rings: Optional[NDArray[np.int64]] = None
    #: uint8, m: 0 for a point on its path, 1 for the control point of a quadratic Bézier curve, 2 for one of the two of a cubic
    #: one, 3 for a point between two on the path that a circular arc goes through. If None, as `on_path` says: 0 or 1.
    kinds: Optional[NDArray[np.uint8]] = None


class Gradients(NamedTuple):
    """Derivatives of a loss by all that was drawn, each in the shape of what it is the derivative by."""

    #: m × 2, by px.
    points: NDArray[Any]
    #: n, by px; 0 for areas.
    widths: NDArray[Any]
    #: n × 3.
    colors: NDArray[Any]
    #: n.
    opacities: NDArray[Any]
    #: 3, or height × width × 3 where the background is a picture; None where there is none.
    background: Optional[NDArray[Any]]


def checked(marks: Marks, dtype: type[np.floating[Any]]) -> Marks:
    """The marks, whose arrays have the shapes and the types that they need."""
    points, starts, widths, colors, opacities, on_path, closed, filled, rings, kinds = marks
    m, n = _rows("points", points), _rows("widths", widths)
    expect("points", points, (m, 2), dtype)
    expect("starts", starts, (n + 1,), np.int64)
    expect("widths", widths, (n,), dtype)
    expect("colors", colors, (n, 3), dtype)
    expect("opacities", opacities, (n,), dtype)
    for name, flags, count in (("on_path", on_path, m), ("closed", closed, n), ("filled", filled, n)):
        if flags is not None:
            expect(name, flags, (count,), np.bool_)
    if rings is not None:
        expect("rings", rings, (_rows("rings", rings),), np.int64)
    if kinds is not None:
        expect("kinds", kinds, (m,), np.uint8)
    return marks


def expect(name: str, array: Any, shape: tuple[int, ...], dtype: type[np.generic]) -> None:
    """Refuses what is not an array of this shape and type."""
    if not isinstance(array, np.ndarray):
        raise TypeError(f"{name} is a {type(array).__name__}: give a NumPy array of {dtype.__name__}")
    if array.dtype != dtype:
        raise TypeError(f"{name} is of {array.dtype}: give {dtype.__name__}, as by {name}.astype(np.{dtype.__name__})")
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}: give {shape}")


def _rows(name: str, array: Any) -> int:
    if not isinstance(array, np.ndarray) or array.ndim == 0:
        raise TypeError(f"{name} is a {type(array).__name__}: give a NumPy array")
    return len(array)
