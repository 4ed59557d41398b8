"""The areas of a drawing, one by one or as columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Optional

import numpy as np

from . import _native
from ._columns import Columns

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._native import _AreaColumns


class Area(NamedTuple):
    """Closed rings, filled in one colour where they wind around a point (SVG's nonzero rule).

    The points of a ring say its outline as those of a closed stroke say its centre line.
    """

    #: Points of each ring, n × 2, px. Read-only.
    rings: tuple[NDArray[np.float32], ...]
    #: Which of the n points of each ring are on it. Read-only.
    on_path: tuple[NDArray[np.bool_], ...]
    #: Red, green and blue, 0..1, sRGB-encoded.
    color: tuple[float, float, float]
    #: 0..1.
    opacity: float
    #: The kinds of the n points of each ring, as those of a `Stroke`. Read-only.
    kinds: Optional[tuple[NDArray[np.uint8], ...]] = None

    def flattened(self, tolerance: float = 0.1) -> list[NDArray[np.float32]]:
        """The rings as the corners of polygons at most `tolerance` px away from them, m × 2 each, px.

        Each ends where it starts.

        >>> import numpy as np, strokefit
        >>> points = np.array([[0, 0], [4, 0], [4, 4]], np.float32)
        >>> area = strokefit.Area((points,), (np.array([True, False, True]),), (0.0, 0.0, 0.0), 1.0)
        >>> area.flattened(0.5)[0].tolist()
        [[0.0, 0.0], [3.0, 1.0], [4.0, 4.0], [0.0, 0.0]]
        """
        kinds = [(~on_path).astype(np.uint8) for on_path in self.on_path] if self.kinds is None else self.kinds
        return [_native.flatten(points, own, True, tolerance) for points, own in zip(self.rings, kinds)]


class Areas(Columns[Area]):
    """The areas of a drawing, back to front.

    Each area is an `Area`. The columns hold all of them at once, as read-only arrays:

    >>> import numpy as np, strokefit
    >>> square = 'M8 4h32v16h-32z'
    >>> svg = f'''<svg xmlns="http://www.w3.org/2000/svg" width="48" height="24" viewBox="0 0 48 24">
    ... <rect width="48" height="24" fill="#ffffff"/>
    ... <g id="stage-1"><path d="{square}" fill="#204060"/></g></svg>'''
    >>> areas = strokefit.refine(svg, strokefit.render(svg, background="#ffffff"), strokes=1).areas
    >>> len(areas), len(areas[0].rings), areas.points.shape
    (1, 1, (4, 2))
    """

    _noun = "areas"

    #: Points of all rings, m × 2, px.
    points: NDArray[np.float32]
    #: Which of the m points are on their ring.
    on_path: NDArray[np.bool_]
    #: The kinds of the m points, as those of a `Stroke`.
    kinds: NDArray[np.uint8]
    #: Ring k has the points `points[ring_starts[k]:ring_starts[k + 1]]`.
    ring_starts: NDArray[np.int64]
    #: Area i has the rings `starts[i]` to `starts[i + 1]`, the last not included; n + 1 numbers.
    starts: NDArray[np.int64]
    #: n × 3, 0..1, sRGB-encoded.
    colors: NDArray[np.float32]
    #: n opacities, 0..1.
    opacities: NDArray[np.float32]
    #: The layer of each area, from 0.
    layers: NDArray[np.int64]
    #: The place of each area among all strokes and areas, from 0 at the back.
    order: NDArray[np.int64]

    def __init__(self, columns: _AreaColumns) -> None:
        self._freeze(columns)
        self.points, self.on_path, self.kinds, self.ring_starts, self.starts = columns[:5]
        self.colors, self.opacities, self.layers, self.order = columns[5:]

    def __len__(self) -> int:
        return len(self.opacities)

    def _item(self, i: int) -> Area:
        red, green, blue = self.colors[i].tolist()
        ends = self.ring_starts[self.starts[i] : self.starts[i + 1] + 1].tolist()
        own = [slice(start, end) for start, end in zip(ends, ends[1:])]
        kinds = tuple(self.kinds[ring] for ring in own)
        return Area(
            rings=tuple(self.points[ring] for ring in own),
            on_path=tuple(self.on_path[ring] for ring in own),
            color=(red, green, blue),
            opacity=float(self.opacities[i]),
            kinds=kinds if any((ring > 1).any() for ring in kinds) else None,
        )

    def __reduce__(self) -> tuple[type[Areas], tuple[_AreaColumns]]:
        rings = (self.points, self.on_path, self.kinds, self.ring_starts, self.starts)
        styles = (self.colors, self.opacities, self.layers, self.order)
        return Areas, ((*rings, *styles),)
