"""The engine for a cluster: a Ray task for each picture.

Tasks, not Ray Data: where a picture ends its process, Ray Data drops or repeats a block of rows, or fails, but every
input has to have its row. Here a task that is lost is known by its input, and tried again. Not actors, either: a fixed
number of them leaves cores idle where a cluster grows, and waits for ever where it shrinks.
"""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from typing import Any, Optional

from . import files
from .draw import Row, draw, failed
from .inputs import Input, read

#: An input that was lost so often is a row with an error. Nodes that are taken away are among the reasons, too.
MOST_TRIES = 5

#: How often the number of cores of the cluster is looked up, s.
_LOOK_S = 5.0


def rows(
    inputs: Iterable[Input], options: dict[str, Any], workers: Optional[int], address: Optional[str]
) -> Iterator[Row]:
    """Draws all inputs; rows come as they are done. `workers` tasks, or two per core, are under way at most."""
    with _session(address) as ray:
        tasks = Tasks(ray, options)
        most = Most(ray, workers)
        try:
            for one in inputs:
                held = _held(one)
                if isinstance(held, Row):
                    yield held
                    continue
                tasks.start(held)
                while len(tasks) >= most.now():
                    yield from tasks.done()
            while len(tasks):
                yield from tasks.done()
        finally:
            tasks.cancel()


class Tasks:
    """Inputs under way."""

    def __init__(self, ray: Any, options: dict[str, Any]) -> None:
        self._ray = ray
        self._options = options
        self._version = version("strokefit")
        # Tries are counted here: Ray's own would not end where a picture ends its process.
        self._task = ray.remote(num_cpus=1, max_retries=0)(_draw)
        self._running: dict[Any, tuple[Input, int]] = {}
        lost = ray.exceptions
        #: What says that a process or a node ended, or that a row went with it.
        self._losses = (
            lost.WorkerCrashedError,
            lost.NodeDiedError,
            lost.LocalRayletDiedError,
            lost.ObjectLostError,
            lost.OutOfMemoryError,
        )

    def __len__(self) -> int:
        return len(self._running)

    def start(self, one: Input, tries: int = 1) -> None:
        reference = self._task.remote(one, self._options, self._version)
        self._running[reference] = one, tries

    def done(self) -> Iterator[Row]:
        """Waits for one row at least; lost inputs start again."""
        references = list(self._running)
        self._ray.wait(references, num_returns=1)
        ready, _ = self._ray.wait(references, num_returns=len(references), timeout=0)
        for reference in ready:
            one, tries = self._running.pop(reference)
            try:
                yield self._ray.get(reference)
            except self._losses as loss:
                if tries < MOST_TRIES:
                    self.start(one, tries + 1)
                else:
                    yield failed(one, f"it was lost {tries} times, at last by {type(loss).__name__}")

    def cancel(self) -> None:
        for reference in self._running:
            self._ray.cancel(reference, force=True)


class Most:
    """How many tasks are under way at most: enough that no core waits for the next."""

    def __init__(self, ray: Any, workers: Optional[int]) -> None:
        self._ray = ray
        self._workers = workers
        self._looked_s = float("-inf")
        self._cores = 1

    def now(self) -> int:
        if self._workers:
            return self._workers
        if time.monotonic() - self._looked_s > _LOOK_S:
            self._looked_s = time.monotonic()
            self._cores = int(self._ray.cluster_resources().get("CPU", 1))
        return 2 * max(self._cores, 1)


def _draw(one: Input, options: dict[str, Any], expected: str) -> Row:
    """In a process of the cluster."""
    own = version("strokefit")
    if own != expected:
        raise RuntimeError(f"a node of the cluster has strokefit {own}, the batch {expected}: install the same on all")
    return draw(one, options)


def _held(one: Input) -> Input | Row:
    """With its content if it is a file here, where the batch was started; other nodes may not have it. URLs are read there."""
    if one.content is not None or (one.cell is None and files.is_url(one.location)):
        return one
    try:
        return one.holding(read(one))
    except Exception as error:
        return failed(one, f"{type(error).__name__}: {error}")


@contextmanager
def _session(address: Optional[str]) -> Iterator[Any]:
    """Ray, connected; the program's own session if it has one."""
    try:
        import ray
    except ImportError:
        raise ImportError("the engine ray needs Ray: pip install ray pyarrow") from None
    if ray.is_initialized():
        yield ray
        return
    # Without an address, Ray would look for the cluster that was last started here, and wait for one that has ended.
    address = address or os.environ.get("RAY_ADDRESS") or "local"
    quiet = {"include_dashboard": False} if address == "local" else {}
    ray.init(address=address, logging_level=logging.WARNING, log_to_driver=False, **quiet)
    try:
        yield ray
    finally:
        ray.shutdown()
