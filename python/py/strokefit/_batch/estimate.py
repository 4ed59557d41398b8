"""What a batch would take, from a sample of its inputs."""

from __future__ import annotations

import heapq
import statistics
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple, Optional

from . import local
from .inputs import Input, filled
from .progress import duration
from .seen import Seen, digest

#: Inputs that are drawn for an estimate.
SAMPLED = 20


class Estimate(NamedTuple):
    """What a batch would take."""

    #: Inputs.
    inputs: int
    #: Those that have no row yet.
    missing: int
    #: Those that were drawn for this.
    sampled: int
    #: Those of the sample that failed.
    failed: int
    #: CPU time for all that are missing, s.
    cpu_s: float
    #: Twice the standard error of that, s.
    error_s: float
    #: Of all drawings that are missing.
    svg_bytes: float

    def __str__(self) -> str:
        return (
            f"{self.inputs:,} inputs, {self.missing:,} missing\n"
            f"about {duration(self.cpu_s)} of CPU (± {duration(self.error_s)}) and {self.svg_bytes / 1e6:.3g} MB of SVG,\n"
            f"from a sample of {self.sampled}, of which {self.failed} failed"
        )


def estimated(inputs: Iterable[Input], done: Seen, options: dict[str, Any], workers: Optional[int]) -> Estimate:
    """Counts all inputs, and draws some of those that are missing: the same ones every time."""
    found, missing = Seen(), 0

    def candidates() -> Iterator[Input]:
        nonlocal missing
        for one in inputs:
            if found.add(one.path) and one.path not in done:
                missing += 1
                yield one

    sample = heapq.nsmallest(SAMPLED, candidates(), key=lambda one: digest(one.path))
    rows = list(local.rows(filled(sample), options, workers)) if sample else []
    times = [(row.report and row.report["cpu_s"]) or 0.0 for row in rows] or [0.0]
    sizes = [row.report["svg_bytes"] if row.report else 0 for row in rows] or [0]
    deviation = statistics.stdev(times) if len(times) > 1 else 0.0
    return Estimate(
        inputs=len(found),
        missing=missing,
        sampled=len(rows),
        failed=sum(row.report is None for row in rows),
        cpu_s=statistics.fmean(times) * missing,
        error_s=2 * deviation / len(times) ** 0.5 * missing,
        svg_bytes=statistics.fmean(sizes) * missing,
    )
