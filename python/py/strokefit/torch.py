"""The renderer as a differentiable operation of PyTorch: `pip install 'strokefit[torch]'`.

>>> import torch
>>> from strokefit.torch import render
>>> points = torch.tensor([[[3.0, 4.0], [9.0, 4.0]]], requires_grad=True)  # one stroke of two points
>>> image = render(points, torch.tensor([2.0]), torch.zeros(1, 3), torch.ones(1), width=12, height=8)
>>> image.shape
torch.Size([8, 12, 3])
>>> image.sum().backward()
>>> points.grad.shape
torch.Size([1, 2, 2])
"""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable, Sequence
from typing import Any, Optional, TypeVar, Union, cast

import numpy as np

try:
    import torch
except ImportError as error:
    raise ImportError("strokefit.torch needs PyTorch: pip install 'strokefit[torch]'") from error

from . import _native
from ._marks import Marks, checked
from ._renderer import Reference, Renderer, _Renders

__all__ = ["render"]

Background = Union[torch.Tensor, Sequence[float], None]

#: Type, width, height, and the number of threads or ε.
_Kind = tuple[torch.dtype, int, int, Optional[float]]

#: Renderers that nobody uses at the moment, for the next calls of their kind: each of them starts threads.
_idle: list[tuple[_Kind, _Renders]] = []
#: Most of them.
_MOST_IDLE = 16
_lock = threading.Lock()

_told_of_devices = False

_Function = TypeVar("_Function", bound=Callable[..., Any])


def _uncompiled(function: _Function) -> _Function:
    """The function, for which `torch.compile` leaves its graph; PyTorch 1 has no compiler."""
    disable = getattr(getattr(torch, "compiler", None), "disable", None)
    return function if disable is None else cast(_Function, disable(function))


@_uncompiled
def render(
    points: torch.Tensor,
    widths: torch.Tensor,
    colors: torch.Tensor,
    opacities: torch.Tensor,
    *,
    width: int,
    height: int,
    background: Background = (1.0, 1.0, 1.0),
    starts: Optional[torch.Tensor] = None,
    on_path: Optional[torch.Tensor] = None,
    closed: Optional[torch.Tensor] = None,
    filled: Optional[torch.Tensor] = None,
    rings: Optional[torch.Tensor] = None,
    kinds: Optional[torch.Tensor] = None,
    softness: float = 1.2,
    coverage: str = "smoothstep",
    threads: Optional[int] = None,
    epsilon: Optional[float] = None,
) -> torch.Tensor:
    """The picture of n marks, … × height × width × 3; without a background … × 4, with alpha and premultiplied colours.

    Every tensor may have batch dimensions in front, which are broadcast: a batch of drawings is rendered in one call. The
    derivatives by points, widths, colours, opacities and background are exact; there are no second derivatives.

    Args:
        points: n × k × 2, px: strokes of k points each. With `starts`, m × 2, the points of all marks.
        widths: n, px.
        colors: n × 3, 0..1, sRGB-encoded.
        opacities: n, 0..1.
        width, height: Of the picture, px.
        background: A colour of 3, a picture of height × width × 3, or None.
        starts: int64, n + 1: mark i has the points from `starts[i]` to `starts[i + 1]`.
        on_path, closed, filled, rings, kinds: As in `strokefit.Marks`, without batch dimensions; `on_path` and `kinds` may have
            the shape n × k.
        softness, coverage, threads: As for `strokefit.Renderer`.
        epsilon: As for `strokefit.Reference`, in float64 alone.

    Tensors of float32 are rendered by `strokefit.Renderer`, those of float64 by the slow `strokefit.Reference`. The work is
    done on the CPU: tensors of other devices are copied there, and the picture is copied back. `torch.compile` leaves its
    graph for this call. PyTorch's own threads wait busily, in the way of the renderer's: call `torch.set_num_threads(1)`, or
    set `OMP_WAIT_POLICY=passive` before Python starts.

    Raises:
        TypeError: A tensor is no tensor, or of another type.
        ValueError: Shapes do not fit together, or what `strokefit.Renderer.render` refuses.
    """
    tensors = [points, widths, colors, opacities]
    _check_kinds(tensors)
    if background is not None:
        given = isinstance(background, torch.Tensor)
        tensors.append(background if given else torch.tensor(background, dtype=points.dtype))
        _check_kinds(tensors)
    if starts is None:
        tensors[0], places = _flat(points)
    else:
        places = _array(starts)
    on_path, kinds = (None if tensor is None else tensor.reshape(-1) for tensor in (on_path, kinds))
    meanings = [None if tensor is None else _array(tensor) for tensor in (on_path, closed, filled, rings, kinds)]
    is_exact = points.dtype == torch.float64
    if epsilon is not None and not is_exact:
        raise ValueError(f"epsilon={epsilon}: it is for float64 alone")
    kind = (points.dtype, width, height, epsilon if is_exact else threads)
    batch, tensors = _batched(tensors, height, width)
    edge = _native.Edge(coverage, softness)
    images: torch.Tensor = _Render.apply(kind, edge, (places, *meanings), bool(batch), *tensors)
    return images.reshape(*batch, *images.shape[1:]) if len(batch) > 1 else images


class _Render(torch.autograd.Function):
    """Tensors without a batch dimension or with one to pictures."""

    @staticmethod
    def forward(ctx: Any, kind: _Kind, edge: _native.Edge, meanings: Any, is_batch: bool, *tensors: Any) -> Any:
        # The tensors are kept for the check that nothing was changed in place meanwhile.
        ctx.save_for_backward(*tensors)
        arrays = [_array(tensor) for tensor in tensors]
        with _Borrowed(kind) as renderer:
            pictures = [_packed(renderer, each, meanings) for each in (zip(*arrays) if is_batch else [arrays])]
            images = [renderer._render(packed, behind, edge) for packed, behind in pictures]
        ctx.drawn = (kind, edge, is_batch, pictures)
        return _joined(images, is_batch, tensors[0])

    @staticmethod
    def backward(ctx: Any, d_images: Any) -> Any:
        needed = ctx.needs_input_grad[4:]
        return (None, None, None, None, *_Derivatives.apply(ctx.drawn, needed, d_images, *ctx.saved_tensors))


class _Derivatives(torch.autograd.Function):
    """The derivatives of a loss by its derivatives by the pictures. Their own derivatives are not known."""

    @staticmethod
    def forward(ctx: Any, drawn: Any, needed: Any, d_images: Any, *tensors: Any) -> Any:
        kind, edge, is_batch, pictures = drawn
        d_arrays = _array(d_images)
        with _Borrowed(kind) as renderer:
            pairs = zip(pictures, d_arrays if is_batch else [d_arrays])
            each = [renderer._backward(packed, behind, edge, d) for (packed, behind), d in pairs]
        columns = zip(*((*by_marks, by_background) for by_marks, by_background in each))
        return tuple(
            _joined(column, is_batch, tensor) if need else None
            for column, tensor, need in zip(columns, tensors, needed)
        )

    @staticmethod
    def backward(ctx: Any, *_: Any) -> Any:
        raise RuntimeError("strokefit.torch.render has no second derivatives: differentiate without create_graph=True")


class _Borrowed:
    """A renderer that is this thread's own meanwhile."""

    def __init__(self, kind: _Kind) -> None:
        self._kind = kind

    def __enter__(self) -> _Renders:
        with _lock:
            found = next((i for i, (kind, _) in enumerate(_idle) if kind == self._kind), None)
            self._renderer = _new(self._kind) if found is None else _idle.pop(found)[1]
        return self._renderer

    def __exit__(self, *_: object) -> None:
        with _lock:
            _idle.append((self._kind, self._renderer))
            del _idle[:-_MOST_IDLE]


def _new(kind: _Kind) -> _Renders:
    dtype, width, height, detail = kind
    if dtype == torch.float64:
        return Reference(width, height) if detail is None else Reference(width, height, epsilon=detail)
    return Renderer(width, height, threads=None if detail is None else int(detail))


def _packed(renderer: _Renders, arrays: Any, meanings: tuple[Any, ...]) -> tuple[Any, Any]:
    """The marks and the background of one drawing."""
    points, widths, colors, opacities, *background = arrays
    starts, *others = meanings
    marks = Marks(points, starts, widths, colors, opacities, *others)
    behind = renderer._behind(background[0]) if background else None
    return renderer._pack(checked(marks, renderer._dtype)), behind


def _check_kinds(tensors: Sequence[Any]) -> None:
    """Refuses what are not tensors of one type that is known, on one device."""
    names = ("points", "widths", "colors", "opacities", "background")
    for name, tensor in zip(names, tensors):
        if not isinstance(tensor, torch.Tensor):
            raise TypeError(f"{name} is a {type(tensor).__name__}: give a tensor")
        if tensor.dtype not in (torch.float32, torch.float64):
            raise TypeError(f"{name} is of {tensor.dtype}: give float32, or float64 for the reference")
        if tensor.dtype != tensors[0].dtype:
            raise TypeError(f"{name} is of {tensor.dtype} and points of {tensors[0].dtype}: give one type")
        if tensor.device != tensors[0].device and tensor.requires_grad:
            raise ValueError(f"{name} is on {tensor.device} and points on {tensors[0].device}: give one device")


def _flat(points: torch.Tensor) -> tuple[torch.Tensor, Any]:
    """Points n × k × 2 as n·k × 2, and where those of each mark begin."""
    if points.ndim < 3 or points.shape[-1] != 2 or points.shape[-2] == 0:
        shape = tuple(points.shape)
        raise ValueError(f"points has shape {shape}: give n × k × 2, or m × 2 and starts")
    n, k = points.shape[-3:-1]
    return points.flatten(-3, -2), np.arange(0, n * k + 1, k)


def _batched(tensors: list[torch.Tensor], height: int, width: int) -> tuple[Sequence[int], list[torch.Tensor]]:
    """The batch dimensions that the tensors have together, and the tensors with one for all of them; none if there is none."""
    own = [2, 1, 2, 1]
    if len(tensors) == 5:
        own.append(3 if tensors[4].shape[-3:] == (height, width, 3) else 1)
    for name, tensor, count in zip(("points", "widths", "colors", "opacities", "background"), tensors, own):
        if tensor.ndim < count:
            raise ValueError(f"{name} has shape {tuple(tensor.shape)}: give {count} dimensions, and those of a batch in front")
    fronts = [tensor.shape[: tensor.ndim - count] for tensor, count in zip(tensors, own)]
    if not any(fronts):
        return (), tensors
    try:
        batch = torch.broadcast_shapes(*fronts)
    except RuntimeError:
        shapes = ", ".join(str(tuple(front)) for front in fronts)
        raise ValueError(f"the batch dimensions {shapes} do not fit together") from None
    count = batch.numel()
    if count == 0:
        raise ValueError(f"the batch {tuple(batch)} is empty")
    expanded = [tensor.expand(*batch, *tensor.shape[tensor.ndim - n :]) for tensor, n in zip(tensors, own)]
    return batch, [tensor.reshape(count, *tensor.shape[len(batch) :]) for tensor in expanded]


def _array(tensor: torch.Tensor) -> Any:
    """The tensor as an array, which is the same memory if it is on the CPU and packed."""
    global _told_of_devices
    if tensor.device.type != "cpu" and not _told_of_devices:
        _told_of_devices = True
        warnings.warn(f"strokefit renders on the CPU: tensors on {tensor.device} are copied", stacklevel=2)
    return tensor.detach().cpu().contiguous().numpy()


def _joined(arrays: Sequence[Any], is_batch: bool, like: torch.Tensor) -> torch.Tensor:
    """The arrays of a batch, or the only one, as a tensor on the device of another."""
    return torch.from_numpy(np.stack(arrays) if is_batch else arrays[0]).to(like.device)
