"""The report of a fit: the fields of `strokefit fit --report`.

Times are in seconds. A field that does not apply, or is not known, is `None`.
"""

from __future__ import annotations

from typing import Optional, TypedDict


class Damage(TypedDict):
    """What a picture has been through, which its drawing leaves out."""

    #: True if its borders have stairs for want of antialiasing.
    stairs: bool
    #: Share of its pixels in which colours are mixed from those of a palette.
    dithering: float
    #: RMS of noise far from edges, levels of luma of 8 bits.
    noise: float
    #: RMS of noise beside edges, as compression leaves it, levels of luma of 8 bits.
    ringing: float
    #: True if colours were kept at half the resolution.
    halved_chroma: bool
    #: True if it is a page in uneven light, or of spotted paper.
    uneven_light: bool


class _Remarked(TypedDict, total=False):
    #: What it has been through, if the drawing leaves that out.
    damage: Damage
    #: What reading the picture has changed or left out, in words; left out if nothing.
    remarks: list[str]


class Input(_Remarked):
    """The picture."""

    #: As it was named; empty for bytes and arrays.
    path: str
    #: In px.
    width: int
    #: In px.
    height: int


class Dropped(TypedDict):
    """How many strokes were dropped, by reason, and how many points."""

    non_finite: int
    invisible: int
    off_page: int
    #: Points of strokes that stay; rounding made them superfluous.
    points: int


class StageEntry(TypedDict):
    """One layer of the drawing."""

    #: From 1.
    index: int
    strokes: int
    #: Iterations of the optimiser.
    iterations: int
    wall_s: float
    #: After the stage, at the resolution that it was fitted at.
    psnr_db: Optional[float]
    #: Of the finished drawing's layers up to this one.
    layer_psnr_db: Optional[float]


class _Detailed(TypedDict, total=False):
    #: Share of small things, such as letters, dots and thin lines, in and beside which errors are below a third of their
    #: contrast; left out if the picture has none.
    details_kept: float


class Fidelity(_Detailed):
    """A picture against another, over 8-bit RGB on white."""

    #: Peak signal-to-noise ratio; `None` for equal pictures.
    psnr_db: Optional[float]
    #: Structural similarity; 1 for equal pictures.
    ssim: float
    #: Mean squared error, 0..1.
    mse: float
    #: Mean absolute error, 0..1.
    l1: float
    #: SSIMULACRA2: 90 lossless to the eye, 70 high, 50 medium, 30 low quality.
    ssimulacra2: float


class Agreement(TypedDict):
    """Two renders of one drawing against each other."""

    #: `None` for equal renders.
    psnr_db: Optional[float]
    #: Largest difference of a channel of a pixel, 0..255.
    max_abs: int
    #: Largest difference of a channel's mean over 5×5 px, 0..255.
    patch_abs: int


class OnMattes(TypedDict):
    """PSNR of a transparent drawing on three colours, `None` for equal pictures; and SSIMULACRA2."""

    black_db: Optional[float]
    white_db: Optional[float]
    magenta_db: Optional[float]
    black_ssimulacra2: float
    white_ssimulacra2: float
    magenta_ssimulacra2: float


class OnFocus(TypedDict):
    """PSNR where a mask lets errors count, and elsewhere; `None` for equal pixels."""

    inside_db: Optional[float]
    outside_db: Optional[float]


class BaseEntry(TypedDict):
    """The SVG that a drawing goes on from."""

    path: str
    #: Strokes that were taken up.
    strokes: int
    #: Elements that stay as they are.
    elements: int


class LayerTravel(TypedDict):
    """How far a pen moves to draw a layer, in px of the picture."""

    strokes: int
    #: Length of all centre lines.
    drawn_px: float
    #: Between strokes, in the order that they were fitted in.
    before_px: float
    #: Between strokes, in the order of the file.
    after_px: float


class Travel(TypedDict):
    """How far a pen moves between the strokes of each layer, in px of the picture."""

    before_px: float
    after_px: float
    layers: list[LayerTravel]


class _Restricted(TypedDict, total=False):
    #: With `order="travel"` alone.
    travel: Travel
    #: How much worse the drawing is, dB, because colours have a layer each. With `group="color"` and few colours alone.
    stacking_db: float


class Report(_Restricted):
    """What a fit did."""

    #: Version of this layout.
    schema: int
    input: Input
    #: Strokes and areas.
    strokes: int
    #: Areas among them.
    areas: int
    #: Of all of them together.
    points: int
    #: Strokes and areas that were dropped.
    dropped: int
    dropped_for: Dropped
    stages: list[StageEntry]
    svg_bytes: int
    svg_gzip_bytes: int
    bytes_per_stroke: Optional[float]
    #: From the call to the verdict.
    wall_s: float
    #: Always `None`: Python's process does other things, too.
    cpu_s: Optional[float]
    #: Always `None`, likewise.
    peak_rss_bytes: Optional[int]
    predicted_rss_bytes: int
    #: `strokes`, `psnr`, `bytes`, `time`, `converged` or `interrupted`.
    stop: str
    seed: int
    #: The SVG as resvg renders it, against the picture.
    fidelity: Fidelity
    #: Our own soft render against the picture.
    soft: Fidelity
    #: The SVG as resvg renders it, against our own soft render.
    agreement: Agreement
    alpha: Optional[OnMattes]
    #: Always `None`: there is no mask in Python yet.
    focus: Optional[OnFocus]
    base: Optional[BaseEntry]
