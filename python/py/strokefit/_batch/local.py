"""The engine for one machine: a process for each worker, so that a picture can end its process and nothing else.

A worker is started as `python -c`, gets an input, and answers with its row, until its standard input ends; so it
also ends when the batch is killed. It needs no `if __name__ == "__main__"` in the program that starts a batch.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import suppress
from queue import SimpleQueue
from typing import IO, Any, Optional, cast

from .draw import Row, draw, failed
from .inputs import Input

#: An input that ended so many processes is a row with an error.
MOST_TRIES = 3

#: The first word of a worker.
_READY = b"ready"


def rows(inputs: Iterable[Input], options: dict[str, Any], workers: Optional[int]) -> Iterator[Row]:
    """Draws all inputs; rows come as they are done. At most two inputs per worker are under way."""
    count = workers or cores()
    with Workers(count, options) as pool, ThreadPoolExecutor(count) as threads:
        running: set[Future[Row]] = set()
        try:
            for one in inputs:
                running.add(threads.submit(pool.draw, one))
                if len(running) >= 2 * count:
                    done, running = wait(running, return_when=FIRST_COMPLETED)
                    yield from (future.result() for future in done)
            while running:
                done, running = wait(running, return_when=FIRST_COMPLETED)
                yield from (future.result() for future in done)
        finally:
            for future in running:
                future.cancel()
            pool.close()


def cores() -> int:
    """Those that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Workers:
    """Processes that draw; a thread takes one for each input."""

    def __init__(self, count: int, options: dict[str, Any]) -> None:
        self._closed = False
        self._all = [Worker(options) for _ in range(count)]
        self._idle: SimpleQueue[Worker] = SimpleQueue()
        for worker in self._all:
            self._idle.put(worker)

    def draw(self, one: Input) -> Row:
        """The row of an input, from the next idle worker."""
        worker = self._idle.get()
        ends: list[str] = []
        try:
            while len(ends) < MOST_TRIES and not self._closed:
                row = worker.draw(one)
                if row is not None:
                    return row
                ends.append(worker.restart())
            return failed(one, f"its process ended {len(ends)} times, by {', '.join(ends)}")
        finally:
            self._idle.put(worker)

    def close(self) -> None:
        """Ends all processes; what they draw is lost."""
        self._closed = True
        for worker in self._all:
            worker.end()

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Worker:
    """A process that draws one input after the other."""

    def __init__(self, options: dict[str, Any]) -> None:
        self._options = options
        self._process = self._started()
        self._greeted = False

    def draw(self, one: Input) -> Optional[Row]:
        """`None` where the process ended."""
        pipe_in, pipe_out = cast("IO[bytes]", self._process.stdin), cast("IO[bytes]", self._process.stdout)
        try:
            if not self._greeted:
                self._greeted = bool(pipe_out.read(len(_READY)))
            if not self._greeted:
                raise RuntimeError("a worker of the batch does not start: its messages are above")
            _send(one, pipe_in)
            row: Row = pickle.load(pipe_out)
        except (EOFError, OSError, ValueError, pickle.UnpicklingError):
            return None
        return row

    def restart(self) -> str:
        """Starts another process in place of one that ended, and says how that did."""
        status = self._process.wait()
        self.end()
        self._process, self._greeted = self._started(), False
        return f"signal {-status}" if status < 0 else f"status {status}"

    def end(self) -> None:
        """Kills the process: it holds nothing that is not lost anyway."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(OSError):  # of what was still to be sent
                cast("IO[bytes]", pipe).close()

    def _started(self) -> subprocess.Popen[bytes]:
        code = "from strokefit._batch.local import serve; serve()"
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        command = [sys.executable, "-c", code]
        process = subprocess.Popen(command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        with suppress(OSError):  # it has ended, which is seen when it is to draw
            _send(self._options, cast("IO[bytes]", process.stdin))
        return process


def serve() -> None:
    """What a worker does: it reads options, then inputs, and writes their rows."""
    # Ctrl-C is sent to all processes of a terminal; the batch ends its workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # What anything else prints is not to be among the rows.
    rows = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    with suppress(EOFError, BrokenPipeError):  # the batch has ended
        options = pickle.load(sys.stdin.buffer)
        rows.write(_READY)
        rows.flush()
        while True:
            _send(draw(pickle.load(sys.stdin.buffer), options), rows)


def _send(what: object, pipe: IO[bytes]) -> None:
    pickle.dump(what, pipe)
    pipe.flush()
