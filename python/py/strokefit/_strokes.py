"""The strokes of a drawing, one by one or as columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Optional

import numpy as np

from . import _native
from ._columns import Columns

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._native import _StrokeColumns


class Stroke(NamedTuple):
    """A path with round caps and joins, in one colour.

    Two points in a row that are on the path are joined by a line. A point off the path is the control point of a
    quadratic Bézier curve; between two such points in a row, the path goes through the middle, without a corner. `kinds`
    tells these from points of cubic curves and circular arcs.
    """

    #: Points of the centre line, n × 2, px; one point is a dot. Read-only.
    points: NDArray[np.float32]
    #: Which of the n points are on the path. Read-only.
    on_path: NDArray[np.bool_]
    #: Whether the last point is joined to the first.
    closed: bool
    #: In px; where the width varies, the largest.
    width: float
    #: Red, green and blue, 0..1, sRGB-encoded.
    color: tuple[float, float, float]
    #: 0..1.
    opacity: float
    #: 0 for each of the n points that is on the path, 1 for the control point of a quadratic Bézier curve, 2 for one of the two
    #: of a cubic one, 3 for a point that a circular arc goes through. If None, there is neither, and `on_path` says all. Read-only.
    kinds: Optional[NDArray[np.uint8]] = None
    #: Half the width at each of the n points, px, if it varies: linear between the points on the path, and at the others that of the
    #: curve beside them. If None, the stroke has one width. Read-only.
    radii: Optional[NDArray[np.float32]] = None

    def flattened(self, tolerance: float = 0.1) -> NDArray[np.float32]:
        """The centre line as the corners of a polyline at most `tolerance` px away from it, m × 2, px.

        That of a closed path ends where it starts; a dot is one point.

        >>> import numpy as np, strokefit
        >>> points = np.array([[0, 0], [4, 0], [4, 4]], np.float32)
        >>> bend = strokefit.Stroke(points, np.array([True, False, True]), False, 1.0, (0.0, 0.0, 0.0), 1.0)
        >>> bend.flattened(0.5).tolist()
        [[0.0, 0.0], [3.0, 1.0], [4.0, 4.0]]
        """
        kinds = (~self.on_path).astype(np.uint8) if self.kinds is None else self.kinds
        return _native.flatten(self.points, kinds, self.closed, tolerance)


class Strokes(Columns[Stroke]):
    """The strokes of a drawing, back to front.

    Each stroke is a `Stroke`. The columns hold all of them at once, as read-only arrays:

    >>> import numpy as np, strokefit
    >>> picture = np.full((24, 48), 255, np.uint8)
    >>> picture[10:14, 8:40] = 50
    >>> strokes = strokefit.fit(picture, strokes=4, marks="strokes").strokes
    >>> [len(strokes), len(strokes.widths)] == [strokes.colors.shape[0]] * 2
    True
    >>> strokes.points[strokes.starts[0]:strokes.starts[1]].shape == strokes[0].points.shape
    True
    """

    _noun = "strokes"

    #: Points of all strokes, m × 2, px.
    points: NDArray[np.float32]
    #: Which of the m points are on their path.
    on_path: NDArray[np.bool_]
    #: The kinds of the m points, as those of a `Stroke`.
    kinds: NDArray[np.uint8]
    #: Stroke i has the points `points[starts[i]:starts[i + 1]]`; n + 1 numbers.
    starts: NDArray[np.int64]
    #: Which of the n paths are closed.
    closed: NDArray[np.bool_]
    #: n widths, px; of strokes whose width varies the largest.
    widths: NDArray[np.float32]
    #: Half the width at each of the m points, px; the same at all points of a stroke of one width.
    radii: NDArray[np.float32]
    #: n × 3, 0..1, sRGB-encoded.
    colors: NDArray[np.float32]
    #: n opacities, 0..1.
    opacities: NDArray[np.float32]
    #: The layer of each stroke, from 0.
    layers: NDArray[np.int64]
    #: The place of each stroke among all strokes and areas, from 0 at the back.
    order: NDArray[np.int64]

    def __init__(self, columns: _StrokeColumns) -> None:
        self._freeze(columns)
        self.points, self.on_path, self.kinds, self.starts, self.closed = columns[:5]
        self.widths, self.radii, self.colors, self.opacities, self.layers, self.order = columns[5:]

    def __len__(self) -> int:
        return len(self.widths)

    def _item(self, i: int) -> Stroke:
        red, green, blue = self.colors[i].tolist()
        own = slice(self.starts[i], self.starts[i + 1])
        return Stroke(
            points=self.points[own],
            on_path=self.on_path[own],
            closed=bool(self.closed[i]),
            width=float(self.widths[i]),
            color=(red, green, blue),
            opacity=float(self.opacities[i]),
            kinds=self.kinds[own] if (self.kinds[own] > 1).any() else None,
            radii=self.radii[own] if (self.radii[own] != self.radii[own][0]).any() else None,
        )

    def __reduce__(self) -> tuple[type[Strokes], tuple[_StrokeColumns]]:
        paths = (self.points, self.on_path, self.kinds, self.starts, self.closed)
        styles = (self.widths, self.radii, self.colors, self.opacities, self.layers, self.order)
        return Strokes, ((*paths, *styles),)
