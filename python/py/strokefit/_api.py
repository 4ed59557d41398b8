"""The functions of the package."""

from __future__ import annotations

import difflib
import functools
import inspect
import json
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, TypeVar, Union, cast

from . import _native
from ._areas import Areas
from ._drawing import Drawing
from ._picture import Picture, native
from ._scene import Scene
from ._strokes import Strokes

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._report import Fidelity, Report

Svg = Union[str, "os.PathLike[str]", Drawing, Scene]
Palette = Union[str, "os.PathLike[str]", Iterable[str]]
Progress = Callable[[float, int, float], object]
_Function = TypeVar("_Function", bound=Callable[..., Any])


def nearest(name: str, known: Iterable[str]) -> str:
    """The known name that was probably meant, as the end of a message.

    >>> nearest("stroke", ["strokes", "psnr"]), nearest("colours", ["colors"]), nearest("zebra", ["psnr"])
    ("; did you mean 'strokes'?", "; did you mean 'colors'?", '')
    """
    near = difflib.get_close_matches(name, list(known), 1, 0.7)
    return f"; did you mean {near[0]!r}?" if near else ""


def _suggests(function: _Function) -> _Function:
    """The function, which names the option that was probably meant where there is none of a name."""
    known = inspect.signature(function).parameters

    @functools.wraps(function)
    def suggesting(*args: Any, **options: Any) -> Any:
        for name in options:
            if name not in known:
                raise TypeError(f"{function.__name__}() has no option {name!r}{nearest(name, known)}")
        return function(*args, **options)

    return cast(_Function, suggesting)


@_suggests
def fit(
    picture: Picture,
    *,
    strokes: Optional[int] = None,
    psnr: Optional[float] = None,
    bytes: Optional[int] = None,
    time: Optional[float] = None,
    quality: Optional[float] = None,
    preset: str = "balanced",
    marks: str = "auto",
    literal: bool = False,
    paper: str = "own",
    blurs: str = "filter",
    look: Optional[str] = None,
    opaque: bool = False,
    coverage: str = "smoothstep",
    points: Optional[int] = None,
    precision: int = 2,
    background: str = "auto",
    colors: Optional[int] = None,
    palette: Optional[Palette] = None,
    pens: Optional[str] = None,
    form: str = "plain",
    group: str = "stage",
    order: str = "fitted",
    width: Optional[str] = None,
    stages: Optional[int] = None,
    polish: bool = True,
    progressive: bool = False,
    seed: int = 0,
    threads: Optional[int] = None,
    progress: Optional[Progress] = None,
    cancel: Optional[_native.CancelToken] = None,
) -> Drawing:
    """Draws a picture with strokes and areas.

    Equal pictures and options give equal bytes, those of `strokefit fit`, for any number of threads.

    Args:
        picture: A path, bytes, a binary file, a PIL image, or an array of height × width, height × width × 1, 3
            (RGB) or 4 (RGBA), of uint8, uint16, or floats of 0..1.

    Budget; the first one reached stops:
        strokes: At most so many strokes.
        psnr: Stop when the file reaches so many dB: 25 is rough, 30 fair, 35 good.
        bytes: At most so many bytes of SVG.
        time: At most so many seconds, from the call to the verdict.

    Look:
        quality: 0 to 60; higher keeps more. A stroke is kept while every byte it costs removes at least the squared
            error that one pixel has at so many dB. 30 unless there is a budget of strokes, psnr or bytes.
        preset: `draft`, `balanced` or `best`: how much time to spend.
        marks: What the drawing is made of: `auto` (areas for what is filled, strokes for lines and for the rest), `strokes` or
            `areas`.
        literal: Draw noise, traces of JPEG and other damage of the picture as they are.
        paper: What becomes of the paper of a page that was scanned or photographed: it keeps its colour (`own`), or becomes `white`.
        blurs: What soft shadows are drawn with: a `filter`, or `steps` of opacity for programs that ignore filters.
        look: Which errors count: those that people see (`eye`), or all alike (`exact`), for a tenth of a dB more; `None` is
            `exact` with `psnr`, and `eye` without.
        opaque: Use opaque strokes only.
        coverage: Coverage function of soft edges: `smoothstep`, `sigmoid`, `tanh` or `atan[:K]`; `A>B` changes from A to B
            during the fit.
        points: Most points of a stroke, 2 to 65535; 2 draws line segments alone. As many as pay by default.
        precision: Decimals of coordinates and widths, 0 to 6.
        background: `auto` keeps transparency, `#rrggbb` or a name such as `white` flattens onto that colour, `none` draws no background.
        colors: At most so many colours, the background included.
        palette: Only these colours: `["#102030", …]`, `"#102030,…"`, or a file with one colour a line or a GIMP
            palette.
        pens: Only these widths of strokes: lengths such as `0.3mm,0.8mm` on a page of a `width`, or numbers in px.
        form: What one element holds: a stroke (`plain`), all strokes of one look that can be drawn together
            (`smallest`), a stroke whose colour and width are in classes of a style sheet (`css`), or the filled outline of
            a stroke (`outlines`).
        group: What one layer holds: `stage`, `color` or `object` (an area and what lies on it).
        order: In which order the strokes of a layer come: `fitted`, or `travel` with short ways between them.
        width: Width of the page, such as `120mm`; one px per pixel of the picture by default.
        stages: The number of stages, each a layer.
        polish: Whether all strokes are fitted jointly after the stages.
        progressive: Whether each layer is good without those above it.
        seed: Key of all random choices.

    How to run; this never changes the drawing:
        threads: Worker threads; one per core by default.
        progress: Called as `progress(done, strokes, psnr_db)` on this thread, with `done` from 0 to 1. What it
            raises ends the fit.
        cancel: Ends the fit from another thread; the drawing as far as it has come is returned.

    Raises:
        ValueError: An option or the picture is not as it has to be.
        TypeError: An argument is of a type that is not known.
        FileNotFoundError: There is no such file.
        MemoryError: The picture takes more memory than the system gives.
        KeyboardInterrupt: On Ctrl-C, within 0.2 s.

    >>> import numpy as np, strokefit
    >>> y, x = np.mgrid[:64, :64]
    >>> disc = np.where((x - 32) ** 2 + (y - 32) ** 2 < 400, 40, 240).astype(np.uint8)  # height × width
    >>> drawing = strokefit.fit(disc, psnr=30)
    >>> drawing.report["fidelity"]["psnr_db"] >= 30
    True
    >>> drawing == strokefit.fit(disc / 255, psnr=30)  # floats of 0..1
    True
    """
    return _drawing(None, **locals())


@_suggests
def refine(
    base: Svg,
    picture: Picture,
    *,
    freeze_base: bool = False,
    strokes: Optional[int] = None,
    psnr: Optional[float] = None,
    bytes: Optional[int] = None,
    time: Optional[float] = None,
    quality: Optional[float] = None,
    preset: str = "balanced",
    marks: str = "auto",
    literal: bool = False,
    paper: str = "own",
    blurs: str = "filter",
    look: Optional[str] = None,
    opaque: bool = False,
    coverage: str = "smoothstep",
    points: Optional[int] = None,
    precision: int = 2,
    colors: Optional[int] = None,
    palette: Optional[Palette] = None,
    pens: Optional[str] = None,
    form: str = "plain",
    group: str = "stage",
    order: str = "fitted",
    width: Optional[str] = None,
    stages: Optional[int] = None,
    polish: bool = True,
    progressive: bool = False,
    seed: int = 0,
    threads: Optional[int] = None,
    progress: Optional[Progress] = None,
    cancel: Optional[_native.CancelToken] = None,
) -> Drawing:
    """Adds strokes and areas to an SVG to bring it closer to a picture.

    Those of a drawing by strokefit are fitted further, together with new ones; any other SVG stays byte for byte,
    and strokes and areas are laid on it. Budgets count the whole file, and the background is that of the base.

    Args:
        base: A `Drawing`, a `Scene`, the text of an SVG (it contains `<`), or the path of one.
        picture: As for `fit`, in the proportions of the base.
        freeze_base: Whether the strokes of the base stay as they are.

    All other options are those of `fit`, and so are the exceptions.

    >>> import numpy as np, strokefit
    >>> y, x = np.mgrid[:48, :64]
    >>> waves = 0.5 + 0.4 * np.sin(x / 5) * np.cos(y / 7)  # height × width, 0..1
    >>> rough = strokefit.fit(waves, strokes=10)
    >>> fine = strokefit.refine(rough, waves, strokes=40)
    >>> fine.report["fidelity"]["psnr_db"] > rough.report["fidelity"]["psnr_db"]
    True
    """
    options = locals()
    text, name = _svg(options.pop("base"))
    return _drawing((text, name, options.pop("freeze_base")), **options)


def render(svg: Svg, scale: float = 1.0, background: str = "none") -> NDArray[np.uint8]:
    """An SVG as resvg renders it, 0..255, sRGB-encoded.

    Args:
        svg: A `Drawing`, a `Scene`, the text of an SVG (it contains `<`), or the path of one.
        scale: Pixels per unit of the SVG.
        background: `#rrggbb` gives height × width × 3 on that colour; `none` height × width × 4, with straight alpha.

    >>> import strokefit
    >>> red = '<svg xmlns="http://www.w3.org/2000/svg" width="4" height="2"><path d="M0 0h2v2h-2" fill="#f00"/></svg>'
    >>> strokefit.render(red).shape, strokefit.render(red, scale=3, background="#ffffff").shape
    ((2, 4, 4), (6, 12, 3))
    >>> strokefit.render(red)[0].tolist()
    [[255, 0, 0, 255], [255, 0, 0, 255], [0, 0, 0, 0], [0, 0, 0, 0]]
    """
    return _native.render(_svg(svg)[0], scale, background)


def judge(svg: Svg, picture: Picture) -> Fidelity:
    """How faithful an SVG is to a picture, as resvg renders it: what `strokefit check` says of resvg.

    Args:
        svg: A `Drawing`, a `Scene`, the text of an SVG (it contains `<`), or the path of one, in the picture's proportions.
        picture: As for `fit`.

    >>> import numpy as np, strokefit
    >>> white = np.ones((8, 8))
    >>> strokefit.judge('<svg xmlns="http://www.w3.org/2000/svg" width="8" height="8"/>', white)
    {'psnr_db': None, 'ssim': 1.0, 'mse': 0.0, 'l1': 0.0, 'ssimulacra2': 100.0}
    """
    return cast("Fidelity", json.loads(_native.judge(_svg(svg)[0], native(picture))))


def _drawing(
    base: Optional[tuple[str, str, bool]],
    picture: Picture,
    progress: Optional[Progress],
    cancel: Optional[_native.CancelToken],
    palette: Optional[Palette],
    **options: object,
) -> Drawing:
    options["palette"] = _palette(palette)
    svg, report, strokes, areas = _native.draw(native(picture), base, options, progress, cancel)
    return Drawing(svg, cast("Report", json.loads(report)), Strokes(strokes), Areas(areas))


def _svg(svg: Svg) -> tuple[str, str]:
    """The text and its name."""
    if isinstance(svg, Drawing):
        return svg.svg, "the drawing"
    if isinstance(svg, Scene):
        return svg.to_svg(), "the scene"
    if isinstance(svg, str) and "<" in svg:
        return svg, "the SVG"
    path = Path(svg)
    return path.read_bytes().decode(), str(path)


def _palette(palette: Optional[Palette]) -> Optional[str]:
    """The colours as text."""
    if palette is None:
        return None
    if isinstance(palette, str) and ("#" in palette or "," in palette):
        return palette
    if isinstance(palette, (str, os.PathLike)):
        return Path(palette).read_text(encoding="utf-8")
    return ",".join(palette)
