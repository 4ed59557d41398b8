"""What the package takes from Rust."""

from collections.abc import Callable, Mapping, Sequence
from typing import Optional, Union, final

import numpy as np
from numpy.typing import NDArray

_StrokeColumns = tuple[
    NDArray[np.float32],
    NDArray[np.bool_],
    NDArray[np.int64],
    NDArray[np.bool_],
    NDArray[np.float32],
    NDArray[np.float32],
    NDArray[np.float32],
    NDArray[np.int64],
    NDArray[np.int64],
]

_AreaColumns = tuple[
    NDArray[np.float32],
    NDArray[np.bool_],
    NDArray[np.int64],
    NDArray[np.int64],
    NDArray[np.float32],
    NDArray[np.float32],
    NDArray[np.int64],
    NDArray[np.int64],
]

__all__ = ["CancelToken", "draw", "flatten", "judge", "main", "render"]

@final
class CancelToken:
    def __new__(cls) -> CancelToken: ...
    def cancel(self) -> None: ...
    @property
    def cancelled(self) -> bool: ...

def draw(
    picture: Union[str, bytes, NDArray[np.generic]],
    base: Optional[tuple[str, str, bool]],
    options: Mapping[str, object],
    progress: Optional[Callable[[float, int, float], object]],
    cancel: Optional[CancelToken],
) -> tuple[str, str, _StrokeColumns, _AreaColumns]: ...
def flatten(
    points: NDArray[np.float32], on_path: NDArray[np.bool_], closed: bool, tolerance: float
) -> NDArray[np.float32]: ...
def render(svg: str, scale: float, background: str) -> NDArray[np.uint8]: ...
def judge(svg: str, picture: Union[str, bytes, NDArray[np.generic]]) -> str: ...
def main(args: Sequence[str]) -> int: ...
