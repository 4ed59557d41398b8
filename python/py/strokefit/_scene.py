"""A drawing that can be changed: arrays on a page, from an SVG and back to one."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from . import _native
from ._marks import Marks, checked, expect

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from ._drawing import Drawing
    from ._picture import Picture
    from ._report import Fidelity


class Scene:
    """Marks on a page, as arrays, and the way back to a file.

    Args:
        width, height: Of the page, px.
        marks: What is drawn, back to front, as float32. The scene keeps these arrays and copies none.
        background: Red, green and blue, 0..1, or None for a transparent page.
        layers: int64, n: the layer of each mark, rising. All marks are in one, if None.

    Raises:
        TypeError, ValueError: As for `strokefit.Renderer.render`.

    >>> import numpy as np, strokefit
    >>> picture = np.full((24, 48), 255, np.uint8)
    >>> picture[10:14, 8:40] = 50
    >>> scene = strokefit.fit(picture, strokes=1).scene
    >>> scene.marks.widths[:] += 1
    >>> 'stroke-width' in scene.to_svg()
    True
    """

    __slots__ = ("_page", "layers", "marks")

    #: What is drawn, back to front.
    marks: Marks
    #: int64, n: the layer of each mark, from 0.
    layers: NDArray[np.int64]

    def __init__(
        self,
        width: int,
        height: int,
        marks: Marks,
        *,
        background: Optional[Sequence[float]] = (1.0, 1.0, 1.0),
        layers: Optional[NDArray[np.int64]] = None,
    ) -> None:
        for name, side in (("width", width), ("height", height)):
            if side < 1:
                raise ValueError(f"{name}={side}: give 1 px or more")
        color = None if background is None else _color(background)
        self._set(_native.Page(width, height, color), marks, layers)

    def _set(self, page: _native.Page, marks: Marks, layers: Optional[NDArray[np.int64]]) -> None:
        self._page = page
        self.marks = checked(marks, np.float32)
        self.layers = np.zeros(len(marks.widths), np.int64) if layers is None else layers
        expect("layers", self.layers, marks.widths.shape, np.int64)

    @classmethod
    def read(cls, svg: Union[str, os.PathLike[str], Drawing]) -> Scene:
        """The scene of an SVG by strokefit: of a `Drawing`, the text of a file (it contains `<`), or its path.

        Raises:
            ValueError: The SVG is not by strokefit, or has been laid on another one.
            FileNotFoundError: There is no such file.
        """
        from ._api import _svg

        page, marks, layers = _native.read(*_svg(svg))
        scene = cls.__new__(cls)
        scene._set(page, Marks(*marks), layers)
        return scene

    @property
    def width(self) -> int:
        """Px."""
        return self._page.size[0]

    @property
    def height(self) -> int:
        """Px."""
        return self._page.size[1]

    @property
    def background(self) -> Union[tuple[float, float, float], NDArray[np.float32], None]:
        """The background for a renderer: a colour, height × width × 3 where it is a gradient, or None."""
        ground = self._page.ground((1.0, 1.0, 1.0))
        return self._page.background if ground is None else ground

    def with_background(self, background: Optional[Sequence[float]]) -> Scene:
        """The scene, its marks shared, on another colour, or on none."""
        scene = Scene.__new__(Scene)
        scene._set(self._page.on(None if background is None else _color(background)), self.marks, self.layers)
        return scene

    def with_marks(self, layers: Optional[NDArray[np.int64]] = None, **arrays: Any) -> Scene:
        """The scene with other arrays of `Marks` in the place of its own, by name; what is not given is shared.

        With another number of marks, give `layers` too, or all of them are in one layer.
        """
        marks = self.marks._replace(**arrays)
        if layers is None and len(marks.widths) == len(self.layers):
            layers = self.layers
        scene = Scene.__new__(Scene)
        scene._set(self._page, marks, layers)
        return scene

    def to_svg(
        self,
        *,
        precision: int = 2,
        form: str = "plain",
        group: str = "stage",
        order: str = "fitted",
        width: Optional[str] = None,
    ) -> str:
        """The SVG as the command line writes it: rounded, colours clipped to 0..1, and without marks that nobody sees.

        The options are those of `strokefit.fit`. A scene that was read keeps the width of its page.
        """
        options = {"precision": precision, "form": form, "group": group, "order": order, "width": width}
        packed = _native.PackedMarks(checked(self.marks, np.float32))
        return _native.write(self._page, packed, self.layers.tolist(), options)

    def save(self, path: Union[str, os.PathLike[str]], **options: Any) -> None:
        """Writes `to_svg(**options)` to `path`."""
        Path(path).write_bytes(self.to_svg(**options).encode())

    def judge(self, picture: Picture) -> Fidelity:
        """How faithful the file is to a picture: `strokefit.judge`."""
        from ._api import judge

        return judge(self.to_svg(), picture)

    def refine(self, picture: Picture, **options: Any) -> Drawing:
        """The drawing that `strokefit.refine` makes of the file, with its options."""
        from ._api import refine

        return refine(self.to_svg(), picture, **options)

    def _repr_svg_(self) -> str:
        return self.to_svg()

    def __repr__(self) -> str:
        return f"<Scene {self.width}×{self.height} px, {len(self.marks.widths)} marks>"


def _color(color: Sequence[float]) -> tuple[float, float, float]:
    red, green, blue = (float(value) for value in color)
    return red, green, blue
