"""What the package takes from Rust."""

from collections.abc import Callable, Mapping, Sequence
from typing import Optional, TypeVar, Union, final

import numpy as np
from numpy.typing import NDArray

_Float = TypeVar("_Float", np.float32, np.float64)

_StrokeColumns = tuple[
    NDArray[np.float32],
    NDArray[np.bool_],
    NDArray[np.uint8],
    NDArray[np.int64],
    NDArray[np.bool_],
    NDArray[np.float32],
    NDArray[np.float32],
    NDArray[np.float32],
    NDArray[np.float32],
    NDArray[np.int64],
    NDArray[np.int64],
]

_AreaColumns = tuple[
    NDArray[np.float32],
    NDArray[np.bool_],
    NDArray[np.uint8],
    NDArray[np.int64],
    NDArray[np.int64],
    NDArray[np.float32],
    NDArray[np.float32],
    NDArray[np.int64],
    NDArray[np.int64],
]

_MarkArrays = tuple[
    NDArray[_Float],
    NDArray[np.int64],
    NDArray[_Float],
    NDArray[_Float],
    NDArray[_Float],
    Optional[NDArray[np.bool_]],
    Optional[NDArray[np.bool_]],
    Optional[NDArray[np.bool_]],
    Optional[NDArray[np.int64]],
    Optional[NDArray[np.uint8]],
]
_MarkGradients = tuple[NDArray[_Float], NDArray[_Float], NDArray[_Float], NDArray[_Float]]
_AllGradients = tuple[_MarkGradients[_Float], Optional[NDArray[_Float]]]
_Color = tuple[float, float, float]

__all__ = [
    "CancelToken",
    "Edge",
    "PackedMarks",
    "PackedMarks64",
    "Page",
    "Renderer",
    "draw",
    "flatten",
    "judge",
    "main",
    "read",
    "reference_backward",
    "reference_render",
    "reference_worth",
    "render",
    "write",
]

@final
class CancelToken:
    def __new__(cls) -> CancelToken: ...
    def cancel(self) -> None: ...
    @property
    def cancelled(self) -> bool: ...

@final
class Edge:
    def __new__(cls, coverage: str, softness: float) -> Edge: ...

@final
class PackedMarks:
    def __new__(cls, arrays: _MarkArrays[np.float32]) -> PackedMarks: ...

@final
class PackedMarks64:
    def __new__(cls, arrays: _MarkArrays[np.float64]) -> PackedMarks64: ...

@final
class Page:
    def __new__(cls, width: int, height: int, background: Optional[_Color]) -> Page: ...
    def on(self, background: Optional[_Color]) -> Page: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def background(self) -> Optional[_Color]: ...
    def ground(self, behind: _Color) -> Optional[NDArray[np.float32]]: ...

@final
class Renderer:
    def __new__(cls, width: int, height: int, threads: Optional[int]) -> Renderer: ...
    def render(
        self,
        marks: PackedMarks,
        edge: Edge,
        background: Union[_Color, NDArray[np.float32], None],
        out: NDArray[np.float32],
    ) -> None: ...
    def backward(
        self,
        marks: PackedMarks,
        edge: Edge,
        background: Union[_Color, NDArray[np.float32], None],
        d_canvas: NDArray[np.float32],
    ) -> _AllGradients[np.float32]: ...
    def worth(
        self,
        marks: PackedMarks,
        edge: Edge,
        background: Union[_Color, NDArray[np.float32]],
        error: NDArray[np.float32],
    ) -> NDArray[np.float32]: ...

def draw(
    picture: Union[str, bytes, NDArray[np.generic]],
    base: Optional[tuple[str, str, bool]],
    options: Mapping[str, object],
    progress: Optional[Callable[[float, int, float], object]],
    cancel: Optional[CancelToken],
) -> tuple[str, str, _StrokeColumns, _AreaColumns]: ...
def flatten(
    points: NDArray[np.float32], kinds: NDArray[np.uint8], closed: bool, tolerance: float
) -> NDArray[np.float32]: ...
def render(svg: str, scale: float, background: str) -> NDArray[np.uint8]: ...
def judge(svg: str, picture: Union[str, bytes, NDArray[np.generic]]) -> str: ...
def main(args: Sequence[str]) -> int: ...
def reference_render(
    setting: tuple[int, int, float],
    edge: Edge,
    marks: PackedMarks64,
    background: Union[_Color, NDArray[np.float64], None],
) -> NDArray[np.float64]: ...
def reference_backward(
    setting: tuple[int, int, float],
    edge: Edge,
    marks: PackedMarks64,
    background: Union[_Color, NDArray[np.float64], None],
    d_canvas: NDArray[np.float64],
) -> _AllGradients[np.float64]: ...
def reference_worth(
    setting: tuple[int, int, float],
    edge: Edge,
    marks: PackedMarks64,
    background: _Color,
    error: NDArray[np.float64],
) -> NDArray[np.float64]: ...
def read(text: str, name: str) -> tuple[Page, _MarkArrays[np.float32], NDArray[np.int64]]: ...
def write(
    page: Page, marks: PackedMarks, layers: Sequence[int], options: Mapping[str, object]
) -> str: ...
