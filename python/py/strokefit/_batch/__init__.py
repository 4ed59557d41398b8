"""Batches: many pictures, each of which gets its row.

    inputs    where pictures are              files, parquet   what reads them
    draw      an input → its row              seen             a set of millions of paths
    local     inputs → rows, on one machine   cluster          the same by Ray
    results   rows → files, once each         progress         how far, how fast, how good
    estimate  what a batch would take         cli              python -m strokefit.batch
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable, Iterator
from importlib.metadata import version
from itertools import chain, islice
from typing import Any, Optional, Union

from . import cluster, local, results
from .draw import Row, whole
from .estimate import Estimate, estimated
from .inputs import Input, check, filled, find
from .progress import Progress, Summary, Tally
from .seen import Seen, digest

__all__ = ["Estimate", "Progress", "Summary", "batch", "estimate_batch"]

Sources = Union[str, "os.PathLike[str]", Iterable[Union[str, "os.PathLike[str]"]]]


def batch(
    src: Sources,
    dst: Union[str, os.PathLike[str]],
    *,
    engine: str = "local",
    address: Optional[str] = None,
    workers: Optional[int] = None,
    files: bool = False,
    column: Optional[str] = None,
    id: Optional[str] = None,
    limit: Optional[int] = None,
    sample: Optional[float] = None,
    retry: bool = False,
    progress: Optional[Callable[[Progress], object]] = None,
    **options: Any,
) -> Summary:
    """Draws many pictures: each one once, whatever happens meanwhile.

    A picture that cannot be read is a row with an error. A batch that was ended, by whatever it was, goes on where it was
    when it is called again. Drawings have the bytes of `fit(…, threads=1)` on every engine.

    Args:
        src: A folder, a glob (`**` is any number of folders), a picture, a Parquet file, a text file with one of
            these files a line, or several of them; paths or URLs.
        dst: The folder of the results. Only one batch writes to it at a time.
        engine: `local`, processes of this machine, or `ray`, tasks of a cluster.
        address: That of a cluster, as `ray.init` takes it, or the variable RAY_ADDRESS; otherwise Ray is started here.
        workers: How many pictures are drawn at a time; one per core by default.
        files: Whether to write one SVG for each picture, in folders as in `src`. Otherwise Parquet files are written, with
            the columns path, svg, report (JSON) and error.
        column: The column of Parquet files with the pictures; it need not be named if there is only one.
        id: The column of Parquet files that names the pictures; `FILE.parquet#NUMBER` otherwise.
        limit: At most so many inputs, the first ones.
        sample: A share of the inputs, above 0 and up to 1: the same ones every time.
        retry: Whether to draw anew what has an error.
        progress: Called as `progress(Progress)` after each row. What it raises ends the batch.
        options: Those of `fit`, except `threads`, `progress` and `cancel`. With `time`, drawings depend on the machine.

    Raises:
        ValueError: An option is not as it has to be, or `dst` has results of other options.
        FileNotFoundError: There is no such source.
        BlockingIOError: Another batch writes to `dst`.
        OSError: The results cannot be written; the disk may be full.

    >>> import tempfile, numpy as np, strokefit
    >>> from pathlib import Path
    >>> folder = Path(tempfile.mkdtemp())
    >>> for i in range(3):
    ...     _ = (folder / f"{i}.bmp").write_bytes(b"no picture")
    >>> summary = strokefit.batch(folder, folder / "out", files=True, strokes=50)
    >>> summary.drawn, summary.failed
    (0, 3)
    >>> strokefit.batch(folder, folder / "out", files=True, strokes=50).before
    3
    """
    chosen = _Choice(src, column, id, limit, sample)
    options = whole(options)
    draw = _engine(engine, options, workers, address)
    with results.opened(os.fspath(dst), _fingerprint(files, options), retry) as rows:
        count, tally = _Count(chosen, rows.done), Tally()
        missing = _Missing(chosen, rows, files)
        for row in draw(filled(missing)):
            tally.add(rows.add(row))
            if progress is not None:
                progress(tally.progress(count.told))
        rows.finish()
        return tally.summary(missing.before, missing.repeated)


def estimate_batch(
    src: Sources,
    dst: Union[str, os.PathLike[str]],
    *,
    workers: Optional[int] = None,
    files: bool = False,
    column: Optional[str] = None,
    id: Optional[str] = None,
    limit: Optional[int] = None,
    sample: Optional[float] = None,
    **options: Any,
) -> Estimate:
    """What `batch` would take: counts the inputs, and draws 20 of those that are missing, on this machine.

    Nothing is written. The arguments are those of `batch`.
    """
    chosen = _Choice(src, column, id, limit, sample)
    options = whole(options)
    done = results.peek(os.fspath(dst), _fingerprint(files, options))
    return estimated(chosen, done, options, workers)


class _Choice:
    """Inputs that were asked for, each time it is iterated."""

    def __init__(
        self, src: Sources, column: Optional[str], id: Optional[str], limit: Optional[int], sample: Optional[float]
    ) -> None:
        several = [src] if isinstance(src, (str, os.PathLike)) else src
        self._sources = [os.fspath(source) for source in several]
        self._column, self._id, self._limit, self._sample = column, id, limit, sample
        if limit is not None and limit < 1:
            raise ValueError(f"limit={limit}: give a whole number of 1 or more")
        if sample is not None and not 0 < sample <= 1:
            raise ValueError(f"sample={sample}: give a share above 0 and up to 1, such as 0.01")
        check(self._sources)

    def __iter__(self) -> Iterator[Input]:
        found: Iterable[Input] = find(self._sources, self._column, self._id)
        if self._sample is not None:
            most = int(self._sample * 2**64)
            found = (one for one in found if int.from_bytes(digest(one.path)[:8], "big") < most)
        return islice(found, self._limit)


class _Missing:
    """Inputs that have no row, each once."""

    def __init__(self, chosen: _Choice, rows: results.Results, files: bool) -> None:
        self._chosen, self._rows, self._files = chosen, rows, files
        #: Inputs that have one.
        self.before = 0
        #: Inputs that were found again.
        self.repeated = 0

    def __iter__(self) -> Iterator[Input]:
        found = Seen()
        for one in self._chosen:
            if not found.add(one.path):
                self.repeated += 1
            elif one.path in self._rows.done:
                self.before += 1
            elif self._files and not self._rows.stems.add(one.stem):
                # Not by who is first to be drawn, which another run would not repeat.
                yield one._replace(refusal=f"{one.stem}.svg is another picture's drawing: rename one of the two, or write Parquet")
            else:
                yield one


class _Count:
    """Counts inputs on a thread of its own, so that drawing need not wait for that."""

    def __init__(self, chosen: _Choice, done: Seen) -> None:
        #: Inputs, and those that are missing, once they are counted.
        self.told: Optional[tuple[int, int]] = None
        threading.Thread(target=self._count, args=(chosen, done), daemon=True).start()

    def _count(self, chosen: _Choice, done: Seen) -> None:
        total = missing = 0
        try:
            for one in chosen:
                total += 1
                missing += one.path not in done
        except (OSError, ValueError):
            return  # the batch meets it, too
        self.told = total, missing


def _engine(
    name: str, options: dict[str, Any], workers: Optional[int], address: Optional[str]
) -> Callable[[Iterable[Input]], Iterator[Row]]:
    """What makes rows of inputs; nothing is started where there are no inputs."""
    if workers is not None and workers < 1:
        raise ValueError(f"workers={workers}: give a whole number of 1 or more")
    if name not in ("local", "ray"):
        raise ValueError(f"engine={name!r}: give local or ray")
    if address is not None and name == "local":
        raise ValueError(f"address={address!r} is that of a cluster: give engine='ray', too")

    def rows(inputs: Iterable[Input]) -> Iterator[Row]:
        remaining = iter(inputs)
        for first in remaining:
            all = chain([first], remaining)
            if name == "ray":
                yield from cluster.rows(all, options, workers, address)
            else:
                yield from local.rows(all, options, workers)

    return rows


def _fingerprint(files: bool, options: dict[str, Any]) -> dict[str, Any]:
    return {"strokefit": version("strokefit"), "files": files, **options}
