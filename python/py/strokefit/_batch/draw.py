"""One picture: from the input to its row, whatever is wrong with it."""

from __future__ import annotations

import inspect
import time
from typing import Any, NamedTuple, Optional

import numpy as np

from .._api import _palette, fit, nearest
from .._report import Report
from .inputs import Input, read

#: What a batch decides itself.
_OWN = {"picture", "threads", "progress", "cancel"}


class Row(NamedTuple):
    """What became of an input: a drawing with its report, or an error."""

    path: str
    #: See `Input`.
    stem: str
    svg: Optional[str]
    #: That of `fit`, with the CPU time.
    report: Optional[Report]
    error: Optional[str]


def draw(one: Input, options: dict[str, Any]) -> Row:
    """Draws on one thread. `options` are those of `fit`."""
    start_s = time.process_time()
    try:
        drawing = fit(read(one), threads=1, **options)
    except Exception as error:
        return failed(one, f"{type(error).__name__}: {error}")
    report = drawing.report
    report["input"]["path"] = one.path
    # The process draws one picture at a time.
    report["cpu_s"] = time.process_time() - start_s
    return Row(one.path, one.stem, drawing.svg, report, None)


def failed(one: Input, error: str) -> Row:
    """The row of a picture without a drawing."""
    return Row(one.path, one.stem, None, None, " ".join(error.split()))


def whole(options: dict[str, Any]) -> dict[str, Any]:
    """All options of `fit` with their values, as plain numbers and text, so that any machine draws the same.

    Raises `TypeError` or `ValueError` where `fit` would.
    """
    known = {name: option.default for name, option in inspect.signature(fit).parameters.items() if name not in _OWN}
    for name in options:
        if name not in known:
            such = nearest(name, known) or f": give those of fit, such as {', '.join(list(known)[:5])}"
            raise TypeError(f"{name!r} is no option of a batch{such}")
    values = {**known, **options, "palette": _palette(options.get("palette"))}
    values = {name: value.item() if isinstance(value, np.generic) else value for name, value in values.items()}
    fit(np.zeros((4, 4), np.uint8), threads=1, **values)
    return values
