"""A finished drawing."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Union

from . import _native

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._areas import Areas
    from ._report import Report
    from ._scene import Scene
    from ._strokes import Strokes


class Drawing:
    """A drawing: its SVG, its strokes and areas, and how it came to be.

    Two drawings are equal if their SVGs are. A notebook shows a drawing as the last value of a cell.
    """

    __slots__ = ("areas", "report", "strokes", "svg")

    #: The file, as text.
    svg: str
    #: How faithful the file is and what the fit took: the fields of `--report`.
    report: Report
    #: The strokes, back to front. On an SVG by another program, only those that were laid on it.
    strokes: Strokes
    #: The areas, likewise. `strokes.order` and `areas.order` say which lies above which.
    areas: Areas

    def __init__(self, svg: str, report: Report, strokes: Strokes, areas: Areas) -> None:
        self.svg = svg
        self.report = report
        self.strokes = strokes
        self.areas = areas

    @property
    def scene(self) -> Scene:
        """The file as a scene, whose arrays can be changed: `Scene.read(drawing)`. Of the form `outlines` all are areas.

        Raises:
            ValueError: The drawing is laid on an SVG by another program.
        """
        from ._scene import Scene

        return Scene.read(self)

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the SVG to `path`: the same bytes on every platform."""
        Path(path).write_bytes(self.svg.encode())

    def to_numpy(self, scale: float = 1.0, background: str = "none") -> NDArray[np.uint8]:
        """The drawing as resvg renders it: see `strokefit.render`."""
        return _native.render(self.svg, scale, background)

    def _repr_svg_(self) -> str:
        return self.svg

    def __eq__(self, other: object) -> bool:
        return self.svg == other.svg if isinstance(other, Drawing) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.svg)

    def __repr__(self) -> str:
        size, psnr_db = self.report["input"], self.report["fidelity"]["psnr_db"]
        fidelity = "exact" if psnr_db is None else f"{psnr_db:.2f} dB"
        areas = f"{len(self.areas)} areas, " if self.areas else ""
        return (
            f"<Drawing {size['width']}×{size['height']} px, {areas}{len(self.strokes)} strokes, "
            f"{self.report['svg_bytes']} bytes, {fidelity}>"
        )
