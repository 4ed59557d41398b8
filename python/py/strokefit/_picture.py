"""Pictures in the forms that Python has them in."""

from __future__ import annotations

import os
import sys
from typing import IO, TYPE_CHECKING, Any, Protocol, Union

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from PIL.Image import Image


class _HasArray(Protocol):
    def __array__(self) -> NDArray[Any]: ...


#: A path, the bytes of a picture file or a binary file object; a PIL image; or an array of height × width,
#: height × width × 1, 3 (RGB) or 4 (RGBA), sRGB-encoded: uint8, uint16, or floats of 0..1. Alpha is straight.
Picture = Union[
    str, "os.PathLike[str]", bytes, bytearray, memoryview, IO[bytes], "Image", "NDArray[Any]", "_HasArray"
]

_RIGHT = "give height × width, or height × width × 1, 3 (RGB) or 4 (RGBA)"
_TYPES = "give uint8 (0 to 255), uint16 (0 to 65535), or float32 or float64 (0 to 1)"


def native(picture: Picture) -> Union[str, bytes, NDArray[Any]]:
    """The picture as a path, bytes, or an array of height × width × channels. Arrays are not copied."""
    if isinstance(picture, (str, os.PathLike)):
        path = os.fspath(picture)
        if not isinstance(path, str):
            raise TypeError(f"{path!r} is a path in bytes: give it as str, with os.fsdecode")
        return path
    if isinstance(picture, (bytes, bytearray, memoryview)):
        return bytes(picture)
    if isinstance(picture, np.ndarray):
        return _array(picture)
    if _is_pil(picture):
        return _array(_of_pil(picture))
    if hasattr(picture, "read"):
        return _content(picture)
    if hasattr(picture, "__array__"):
        return _array(np.asarray(picture))
    raise TypeError(
        f"a picture cannot be a {type(picture).__name__}: "
        "give a path, bytes, a binary file, a PIL image or an array"
    )


def _array(array: NDArray[Any]) -> NDArray[Any]:
    if array.dtype not in (np.uint8, np.uint16, np.float32, np.float64):
        raise TypeError(f"a picture cannot be an array of {array.dtype}: {_TYPES}")
    shape = array.shape
    if array.ndim == 2:
        array = array[:, :, np.newaxis]
    if array.ndim != 3 or array.shape[2] not in (1, 3, 4):
        first = array.ndim == 3 and shape[0] in (1, 3, 4)
        advice = "; channels come last: array.transpose(1, 2, 0)" if first else ""
        raise ValueError(f"an array of shape {shape} is no picture: {_RIGHT}{advice}")
    # Fields of packed records may lie at odd addresses, which the processor's loads do not.
    return array if array.flags.aligned else array.copy()


def _is_pil(picture: object) -> bool:
    # Whoever has such an image has imported PIL.
    pil = sys.modules.get("PIL.Image")
    return pil is not None and isinstance(picture, pil.Image)


def _of_pil(image: Any) -> NDArray[Any]:
    mode = image.mode
    if mode in ("L", "RGB", "RGBA"):
        return np.asarray(image)
    if mode.startswith("I;16"):
        return np.asarray(image).astype(np.uint16, copy=False)
    if mode in ("I", "F"):
        raise ValueError(f"a PIL image of mode {mode} has no scale: convert it, as with .convert('L')")
    alpha = mode in ("LA", "La", "PA", "RGBa") or "transparency" in image.info
    return np.asarray(image.convert("RGBA" if alpha else "RGB"))


def _content(file: Any) -> bytes:
    content = file.read()
    if isinstance(content, str):
        raise TypeError("the file is open as text: open it with mode 'rb'")
    return bytes(content)
