"""Turns raster pictures into editable SVGs made of strokes and areas.

>>> import numpy as np
>>> import strokefit
>>> picture = np.full((24, 48, 3), 255, np.uint8)  # height × width × RGB
>>> picture[10:14, 8:40] = 50  # a dark bar
>>> drawing = strokefit.fit(picture, strokes=4)
>>> drawing.svg[:4]
'<svg'
>>> drawing.report["input"]["width"], drawing.report["input"]["height"]
(48, 24)

`fit` draws a picture, `refine` goes on from an SVG, `render` and `judge` show and measure any SVG, and `batch` draws many
pictures. Lengths are in
px of the picture, with pixel centres at +0.5. The command line is `python -m strokefit`.
"""

from importlib.metadata import version as _version

from ._api import fit, judge, refine, render
from ._areas import Area, Areas
from ._batch import Estimate, Progress, Summary, batch, estimate_batch
from ._drawing import Drawing
from ._marks import Gradients, Marks
from ._native import CancelToken
from ._picture import Picture
from ._renderer import Reference, Renderer
from ._report import Agreement, Fidelity, Report
from ._scene import Scene
from ._strokes import Stroke, Strokes

#: Version of the package, and of the program in it.
__version__ = _version("strokefit")

__all__ = [
    "Agreement",
    "Area",
    "Areas",
    "CancelToken",
    "Drawing",
    "Estimate",
    "Fidelity",
    "Gradients",
    "Marks",
    "Picture",
    "Progress",
    "Reference",
    "Renderer",
    "Report",
    "Scene",
    "Stroke",
    "Strokes",
    "Summary",
    "__version__",
    "batch",
    "estimate_batch",
    "fit",
    "judge",
    "refine",
    "render",
]
