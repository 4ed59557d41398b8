"""How far a batch is, and what it did."""

from __future__ import annotations

import math
import time
from collections import Counter
from typing import NamedTuple, Optional

from .draw import Row

#: Percentiles of a summary.
PERCENTS = (5, 25, 50, 75, 95, 100)

#: Failures that are named.
_NAMED = 10

#: What a drawing that equals its picture counts as: no budget asks for more.
_EQUAL_DB = 100.0


class Percentiles:
    """Percentiles of positive numbers to 0.1 %, in memory that does not grow with how many there are.

    >>> numbers = Percentiles()
    >>> for number in range(1, 1001):
    ...     numbers.add(number)
    >>> [round(number, -1) for number in numbers.of((5, 50, 100))]
    [50.0, 500.0, 1000.0]
    """

    #: Ratio of neighbouring bins.
    _STEP = math.log(1.002)

    def __init__(self) -> None:
        self._bins: Counter[int] = Counter()

    def add(self, number: float) -> None:
        self._bins[round(math.log(max(number, 1e-6)) / self._STEP)] += 1

    def of(self, percents: tuple[int, ...] = PERCENTS) -> list[float]:
        """Empty if there are no numbers."""
        total = sum(self._bins.values())
        return [self._reached(math.ceil(total * percent / 100)) for percent in percents] if total else []

    def _reached(self, rank: int) -> float:
        """The number that so many are not above."""
        below = 0
        for number, count in sorted(self._bins.items()):
            below += count
            if below >= rank:
                break
        return math.exp(number * self._STEP)


class Progress(NamedTuple):
    """How far a batch is."""

    #: Inputs that have a row, once inputs are counted; those of this run before that.
    done: int
    #: Of this run.
    failed: int
    #: Inputs, once they are counted.
    total: Optional[int]
    #: Rows per second, in this run.
    rate: float

    @property
    def left_s(self) -> Optional[float]:
        """Expected time to the end, s."""
        return None if self.total is None or not self.rate else max(self.total - self.done, 0) / self.rate

    def __str__(self) -> str:
        total = "" if self.total is None else f" of {self.total:,}"
        left = "" if self.left_s is None else f", {duration(self.left_s)} left"
        return f"{self.done:,}{total} done, {self.failed:,} failed, {self.rate:.2f}/s{left}"


class Summary(NamedTuple):
    """What a batch did."""

    #: Inputs with a drawing.
    drawn: int
    #: Inputs with an error.
    failed: int
    #: Inputs that had a row before.
    before: int
    #: Inputs that were found more than once.
    repeated: int
    #: s.
    wall_s: float
    #: Of the fits, s.
    cpu_s: float
    #: 5, 25, 50, 75, 95 and 100 % of the drawings of this run: CPU time of the fit.
    cpu_s_percentiles: list[float]
    #: Fidelity.
    psnr_db_percentiles: list[float]
    #: Size of the SVG.
    svg_bytes_percentiles: list[float]
    #: The first ten of the inputs with an error: path and error.
    failures: list[tuple[str, str]]

    def __str__(self) -> str:
        lines = [f"{self.drawn:,} drawn, {self.failed:,} failed in {duration(self.wall_s)}, {duration(self.cpu_s)} of CPU"]
        if self.before:
            lines.append(f"{self.before:,} were done before")
        if self.repeated:
            lines.append(f"{self.repeated:,} inputs were given more than once, and were drawn once")
        if self.drawn:
            lines += ["percentile" + "".join(f"{percent:>10}" for percent in PERCENTS)]
            for name, numbers in (
                ("CPU s", [f"{number:.3g}" for number in self.cpu_s_percentiles]),
                ("dB", [f"{number:.1f}" for number in self.psnr_db_percentiles]),
                ("bytes", [f"{number:.0f}" for number in self.svg_bytes_percentiles]),
            ):
                lines.append(f"{name:10}" + "".join(f"{number:>10}" for number in numbers))
        return "\n".join(lines)


class Tally:
    """Counts rows."""

    def __init__(self) -> None:
        self._start_s = time.monotonic()
        self._drawn = self._failed = 0
        self._cpu_s = 0.0
        self._failures: list[tuple[str, str]] = []
        self._times, self._fidelities, self._sizes = Percentiles(), Percentiles(), Percentiles()

    def add(self, row: Row) -> None:
        if row.report is None:
            self._failed += 1
            if len(self._failures) < _NAMED:
                self._failures.append((row.path, row.error or ""))
            return
        self._drawn += 1
        cpu_s, psnr_db = row.report["cpu_s"] or 0.0, row.report["fidelity"]["psnr_db"]
        self._cpu_s += cpu_s
        self._times.add(cpu_s)
        self._fidelities.add(_EQUAL_DB if psnr_db is None else psnr_db)
        self._sizes.add(row.report["svg_bytes"])

    def progress(self, count: Optional[tuple[int, int]]) -> Progress:
        """`count`: inputs, and those without a row at first."""
        rows, elapsed_s = self._drawn + self._failed, time.monotonic() - self._start_s
        total, before = (count[0], count[0] - count[1]) if count else (None, 0)
        return Progress(before + rows, self._failed, total, rows / max(elapsed_s, 1e-3))

    def summary(self, before: int, repeated: int) -> Summary:
        return Summary(
            drawn=self._drawn,
            failed=self._failed,
            before=before,
            repeated=repeated,
            wall_s=time.monotonic() - self._start_s,
            cpu_s=self._cpu_s,
            cpu_s_percentiles=self._times.of(),
            psnr_db_percentiles=self._fidelities.of(),
            svg_bytes_percentiles=self._sizes.of(),
            failures=self._failures,
        )


def duration(seconds: float) -> str:
    """In the unit that suits it.

    >>> duration(0.5), duration(90), duration(7200), duration(3e6)
    ('0.5 s', '90 s', '120 min', '833.3 h')
    """
    if seconds < 120:
        return f"{seconds:.1f} s" if seconds < 10 else f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 3 * 3600 else f"{seconds / 3600:.1f} h"
