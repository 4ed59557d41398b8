"""The renderer and its gradients, over NumPy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from . import _native
from ._marks import Gradients, Marks, checked, expect

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

#: What is behind all marks: a colour (red, green and blue, 0..1), a picture of height × width × 3, or nothing.
Background = Union["Sequence[float]", "NDArray[Any]", None]

_WHITE = (1.0, 1.0, 1.0)

#: Derivatives by points, widths, colours and opacities, and by the background.
_AllGradients = tuple[tuple[Any, Any, Any, Any], Any]


class _Renders:
    """What the renderer and the reference have in common."""

    _dtype: type[np.floating[Any]]

    def __init__(self, width: int, height: int, softness: float, coverage: str) -> None:
        for name, side in (("width", width), ("height", height)):
            if side < 1:
                raise ValueError(f"{name}={side}: give 1 px or more")
        self.width, self.height = int(width), int(height)
        self._edge = _native.Edge(coverage, softness)
        self._coverage, self._softness = coverage, softness
        self._last: Optional[tuple[Any, Any, _native.Edge]] = None

    @property
    def softness(self) -> float:
        """The width of the soft edge, px; it may be set between two renders, to anneal."""
        return self._softness

    @softness.setter
    def softness(self, softness: float) -> None:
        self._edge = _native.Edge(self._coverage, softness)
        self._softness = softness

    @property
    def coverage(self) -> str:
        """The function from signed distance to coverage."""
        return self._coverage

    def render(self, marks: Marks, background: Background = _WHITE) -> NDArray[Any]:
        """The picture of `marks`, height × width × 3; without a background × 4, with alpha and premultiplied colours.

        Args:
            marks: What to draw, back to front. Its arrays are read where they lie, and may be changed afterwards.
            background: A colour, a picture of height × width × 3 and the type of the marks, or None.

        Raises:
            TypeError: An array is no array, or has another type than float32.
            ValueError: A shape is wrong, a number is not finite, an opacity is not 0 to 1, or points make no path.

        `backward` and `worth` are of the last picture.
        """
        behind = self._behind(background)
        packed = self._pack(checked(marks, self._dtype))
        canvas = self._render(packed, behind, self._edge)
        self._last = (packed, behind, self._edge)
        return canvas

    def backward(self, d_canvas: NDArray[Any]) -> Gradients:
        """The derivatives of a loss by all that was drawn, from its derivatives by the last picture.

        Args:
            d_canvas: ∂L/∂canvas, in the shape and the type of the picture.

        Raises:
            RuntimeError: There is no picture yet.
            TypeError, ValueError: `d_canvas` has another type or shape, or holds NaN or infinity.
        """
        packed, behind, edge = self._drawn()
        channels = 4 if behind is None else 3
        expect("d_canvas", d_canvas, (self.height, self.width, channels), self._dtype)
        by_marks, by_background = self._backward(packed, behind, edge, d_canvas)
        return Gradients(*by_marks, by_background)

    def worth(self, d: NDArray[Any]) -> NDArray[Any]:
        """For each mark of the last picture, by how much the squared error would grow without it, exactly; n.

        Args:
            d: canvas − target, in the shape and the type of the picture. The squared error is the sum of its squares.

        Raises:
            RuntimeError: There is no picture yet.
            TypeError, ValueError: As for `backward`, and if the picture has no background.
        """
        packed, behind, edge = self._drawn()
        if behind is None:
            raise ValueError("a picture without a background has no worth: render on a background")
        expect("d", d, (self.height, self.width, 3), self._dtype)
        return self._worth(packed, behind, edge, d)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.width}×{self.height} px, {self._coverage}, {self._softness:g} px soft>"

    def _drawn(self) -> tuple[Any, Any, _native.Edge]:
        if self._last is None:
            raise RuntimeError("there is no picture yet: call render first")
        return self._last

    def _behind(self, background: Background) -> Any:
        """The background, checked, and copied if it is a picture: gradients are of the picture as it is now."""
        behind: Any
        if background is None:
            return None
        if isinstance(background, np.ndarray) and background.ndim == 3:
            expect("background", background, (self.height, self.width, 3), self._dtype)
            behind = background.copy()
        else:
            color = np.asarray(background, self._dtype)
            if color.shape != (3,):
                shape = (self.height, self.width, 3)
                raise ValueError(f"background has shape {color.shape}: give red, green and blue, or {shape}")
            behind = tuple(color.tolist())
        if not np.isfinite(behind).all():
            raise ValueError("background holds NaN or infinity: give finite numbers")
        return behind

    def _pack(self, marks: Marks) -> Any:
        raise NotImplementedError

    def _render(self, packed: Any, behind: Any, edge: _native.Edge) -> NDArray[Any]:
        raise NotImplementedError

    def _backward(self, packed: Any, behind: Any, edge: _native.Edge, d_canvas: NDArray[Any]) -> _AllGradients:
        raise NotImplementedError

    def _worth(self, packed: Any, behind: Any, edge: _native.Edge, d: NDArray[Any]) -> NDArray[Any]:
        raise NotImplementedError


class Renderer(_Renders):
    """Renders marks, and differentiates losses of the picture by all that was drawn.

    Args:
        width, height: Of the picture, px.
        softness: Width of the soft edge, px.
        coverage: `smoothstep`, `sigmoid`, `tanh`, `atan`, `atan:K` or `raw`, as for `fit`.
        threads: Worker threads, which the renderer starts for itself; one per core by default. They change no bit.

    Everything is float32. Memory is kept from call to call. The work is done without Python's lock, so that renderers in
    several threads work side by side; one renderer is for one thread at a time.

    >>> import numpy as np, strokefit
    >>> dot = strokefit.Marks(
    ...     points=np.array([[3, 4]], np.float32),
    ...     starts=np.array([0, 1]),
    ...     widths=np.array([4], np.float32),
    ...     colors=np.zeros((1, 3), np.float32),
    ...     opacities=np.ones(1, np.float32),
    ... )
    >>> renderer = strokefit.Renderer(8, 8)
    >>> target = np.ones((8, 8, 3), np.float32)
    >>> target[2:6, 4:8] = 0  # the dot has to go to the right
    >>> for step in range(100):
    ...     error = renderer.render(dot) - target
    ...     dot.points[:] -= 0.05 * renderer.backward(2 * error).points
    >>> dot.points.round(1).tolist()
    [[6.0, 4.0]]
    """

    _dtype: type[np.floating[Any]] = np.float32

    def __init__(
        self,
        width: int,
        height: int,
        *,
        softness: float = 1.2,
        coverage: str = "smoothstep",
        threads: Optional[int] = None,
    ) -> None:
        super().__init__(width, height, softness, coverage)
        self._native = _native.Renderer(self.width, self.height, threads)

    def _pack(self, marks: Marks) -> _native.PackedMarks:
        return _native.PackedMarks(marks)

    def _render(self, packed: Any, behind: Any, edge: _native.Edge) -> NDArray[Any]:
        canvas = np.empty((self.height, self.width, 4 if behind is None else 3), np.float32)
        self._native.render(packed, edge, behind, canvas)
        return canvas

    def _backward(self, packed: Any, behind: Any, edge: _native.Edge, d_canvas: NDArray[Any]) -> _AllGradients:
        return self._native.backward(packed, edge, behind, np.ascontiguousarray(d_canvas))

    def _worth(self, packed: Any, behind: Any, edge: _native.Edge, d: NDArray[Any]) -> NDArray[Any]:
        return self._native.worth(packed, edge, behind, np.ascontiguousarray(d))


class Reference(_Renders):
    """The renderer in naive float64, which `Renderer` is tested against: every mark at every pixel, on one thread.

    It is for tests and small experiments. One thing differs: coverage functions with a tail have all of it, where
    `Renderer` cuts it below 1/512.

    Args:
        width, height, softness, coverage: As for `Renderer`.
        epsilon: Added to the square of each distance, px²; by default what `Renderer` adds.

    All arrays are float64.
    """

    _dtype: type[np.floating[Any]] = np.float64

    def __init__(
        self,
        width: int,
        height: int,
        *,
        softness: float = 1.2,
        coverage: str = "smoothstep",
        epsilon: float = 1e-6,
    ) -> None:
        super().__init__(width, height, softness, coverage)
        if not 0 <= epsilon < float("inf"):
            raise ValueError(f"epsilon={epsilon}: give px² from 0")
        self._setting = (self.width, self.height, float(epsilon))

    def _pack(self, marks: Marks) -> _native.PackedMarks64:
        return _native.PackedMarks64(marks)

    def _render(self, packed: Any, behind: Any, edge: _native.Edge) -> NDArray[Any]:
        return _native.reference_render(self._setting, edge, packed, behind)

    def _backward(self, packed: Any, behind: Any, edge: _native.Edge, d_canvas: NDArray[Any]) -> _AllGradients:
        return _native.reference_backward(self._setting, edge, packed, behind, np.ascontiguousarray(d_canvas))

    def _worth(self, packed: Any, behind: Any, edge: _native.Edge, d: NDArray[Any]) -> NDArray[Any]:
        if not isinstance(behind, tuple):
            raise ValueError("the reference tells the worth on a background of one colour alone")
        return _native.reference_worth(self._setting, edge, packed, behind, np.ascontiguousarray(d))
