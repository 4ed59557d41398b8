"""Results: rows that are written once, to a folder that one batch at a time writes to.

    DST/part-000000.parquet            finished shards: path, svg, report, error
    DST/a/b.svg                        or, with `files`, drawings in the tree of the pictures
    DST/_strokefit/batch.json          the fingerprint: version and options
    DST/_strokefit/lock                held by the batch that runs
    DST/_strokefit/part-000001.jsonl   the journal of the shard under way; with `files`, of every shard

A row is appended to a journal as soon as it is there. A journal that is long enough becomes a shard in one step: a
file that is renamed. So whatever ends a batch, the next one finds every row that was written, and no row twice.
"""

from __future__ import annotations

import errno
import json
import os
import socket
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Optional

from . import parquet
from .draw import Row
from .seen import Seen

#: A shard ends after so many rows or so much text, bytes.
SHARD_ROWS = 1000
SHARD_BYTES = 256 << 20

_OWN = "_strokefit"

#: What is wrong with a name, not with the disk.
_BAD_NAME = {errno.ENAMETOOLONG, errno.EINVAL, errno.EILSEQ, errno.ENOTDIR, errno.EISDIR, errno.EEXIST}


class Results:
    """The rows of a folder."""

    def __init__(self, folder: Path, files: bool) -> None:
        self._folder, self._own, self._files = folder, folder / _OWN, files
        #: Paths of all rows that were there at first.
        self.done = Seen()
        #: Stems of all drawings that were there at first, with `files`.
        self.stems = Seen()
        #: That of the shard under way, once it has a row.
        self._journal: Optional[Journal] = None
        #: The number of that shard.
        self._number = 0
        for part in _parts(folder, files):
            self._number = int(part.stem[len("part-") :]) + 1
            self._take(part)

    def add(self, row: Row) -> Row:
        """Writes a row. Where its name is no name for a drawing, it is written, and returned, as an error."""
        if self._files and row.svg is not None:
            row = self._draw(row, row.svg)
        if self._journal is None:
            self._journal = Journal(self._own / f"part-{self._number:06}.jsonl")
        self._journal.append(_record(row, self._files))
        if self._journal.rows >= SHARD_ROWS or self._journal.bytes >= SHARD_BYTES:
            self.finish()
        return row

    def finish(self) -> None:
        """Makes a shard of the rows that are not in one yet."""
        if self._journal is None:
            return
        self.close()
        if not self._files:
            _write_part(self._own, self._folder / f"part-{self._number:06}.parquet", _records(self._journal.path))
            self._journal.path.unlink()
        self._journal = None
        self._number += 1

    def close(self) -> None:
        """Leaves the shard under way to the next batch."""
        if self._journal is not None:
            self._journal.close()

    def _draw(self, row: Row, svg: str) -> Row:
        target = self._folder / f"{row.stem}.svg"
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            _write(self._own / "drawing.tmp", target, svg.encode())
        except (OSError, ValueError) as error:
            if isinstance(error, OSError) and error.errno not in _BAD_NAME:
                raise
            return row._replace(svg=None, report=None, error=f"its drawing cannot have that name: {error}")
        return row

    def _take(self, part: Path) -> None:
        """Notes the rows of a part, and goes on with one that is not full."""
        if part.suffix == ".parquet":
            for path in parquet.paths(part):
                self.done.add(path)
            return
        for record in _records(part):
            self.done.add(record["path"])
            if self._files and record["error"] is None:
                self.stems.add(record["stem"])
        journal = Journal(part)
        if journal.rows < SHARD_ROWS and journal.bytes < SHARD_BYTES:
            self._journal, self._number = journal, self._number - 1
        elif not self._files:
            self._journal, self._number = journal, self._number - 1
            self.finish()
        else:
            journal.close()


class Journal:
    """Rows as lines of JSON, appended one by one. A line that was cut off is dropped."""

    def __init__(self, path: Path) -> None:
        self.path = path
        #: Rows and bytes in it.
        self.rows = self.bytes = 0
        # Without a buffer, what cannot be written is not tried again later.
        self._file = path.open("ab", buffering=0)
        with path.open("rb") as file:
            for line in file:
                if line.endswith(b"\n"):
                    self.rows += 1
                    self.bytes += len(line)
        self._file.truncate(self.bytes)

    def append(self, record: dict[str, Any]) -> None:
        line = _line(record)
        left = memoryview(line)
        while left:
            left = left[self._file.write(left) :]
        self.rows += 1
        self.bytes += len(line)

    def close(self) -> None:
        self._file.close()


@contextmanager
def opened(folder: str, fingerprint: dict[str, Any], retry: bool = False) -> Iterator[Results]:
    """The results in `folder`, which is made if need be, while no other batch writes to it.

    With `retry`, rows that are errors are dropped first.

    Raises:
        BlockingIOError: Another batch writes to it.
        ValueError: The results were made with other options or by another version.
    """
    place, files = Path(folder), bool(fingerprint["files"])
    if not files:
        parquet.schema()
    (place / _OWN).mkdir(parents=True, exist_ok=True)
    with _locked(place / _OWN / "lock", folder):
        _compare(place / _OWN / "batch.json", folder, fingerprint)
        if retry:
            _drop_errors(place, files)
        results = Results(place, files)
        try:
            yield results
        finally:
            results.close()


def peek(folder: str, fingerprint: dict[str, Any]) -> Seen:
    """The paths of all rows, where nothing is to be written."""
    if not (Path(folder) / _OWN / "batch.json").exists():
        return Seen()
    with opened(folder, fingerprint) as results:
        return results.done


@contextmanager
def _locked(path: Path, folder: str) -> Iterator[None]:
    with path.open("a+b") as file:
        try:
            _lock(file.fileno())
        except (BlockingIOError, PermissionError):
            busy = f"{folder} is being written to by {_owner(path)}: wait for that, or give another folder"
            raise BlockingIOError(busy) from None
        file.truncate(0)
        file.write(f"process {os.getpid()} on {socket.gethostname()}".encode())
        file.flush()
        yield


def _owner(lock: Path) -> str:
    """Who wrote its name into `lock`: a batch does so at once, but only after it has locked the file."""
    for _ in range(20):
        if name := lock.read_bytes().decode(errors="replace"):
            return name
        time.sleep(0.05)
    return "another process"


def _lock(file: int) -> None:
    """Until the file is closed or the process ends, however it does."""
    if os.name == "nt":
        import msvcrt

        os.lseek(file, 1 << 30, os.SEEK_SET)  # what is locked cannot be read
        msvcrt.locking(file, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
    else:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _compare(path: Path, folder: str, fingerprint: dict[str, Any]) -> None:
    """Keeps the fingerprint, or finds it as it is kept."""
    if not path.exists():
        text = json.dumps(fingerprint, indent=1, sort_keys=True)
        _write(path.with_suffix(".tmp"), path, text.encode())
        return
    kept = json.loads(path.read_bytes())
    differences = [
        f"{name}={kept.get(name)!r} there, {fingerprint.get(name)!r} now"
        for name in sorted({*kept, *fingerprint})
        if kept.get(name) != fingerprint.get(name)
    ]
    if differences:
        raise ValueError(f"{folder} has other results ({'; '.join(differences)}): give another folder, or the same options")


def _parts(folder: Path, files: bool) -> list[Path]:
    """Shards and journals in the order of their numbers."""
    shards = [] if files else list(folder.glob("part-*.parquet"))
    whole = {shard.stem for shard in shards}
    for journal in (folder / _OWN).glob("part-*.jsonl"):
        if journal.stem in whole:
            journal.unlink()  # the batch was ended after the journal had become a shard
        else:
            shards.append(journal)
    return sorted(shards, key=lambda part: part.stem)


def _drop_errors(folder: Path, files: bool) -> None:
    for part in _parts(folder, files):
        rows = parquet.rows if part.suffix == ".parquet" else _records
        if any(row["error"] is not None for row in rows(part)):
            _write_part(folder / _OWN, part, (row for row in rows(part) if row["error"] is None))


def _write_part(own: Path, part: Path, rows: Iterable[dict[str, Any]]) -> None:
    """Writes a shard or a journal in one step: it is whole on the disk before it has its name."""
    new = own / "part.tmp"
    if part.suffix == ".parquet":
        parquet.write(new, rows)
    else:
        with new.open("wb") as file:
            file.writelines(map(_line, rows))
    with new.open("rb+") as file:
        os.fsync(file.fileno())
    os.replace(new, part)


def _record(row: Row, files: bool) -> dict[str, Any]:
    record = {"path": row.path, "report": row.report, "error": row.error}
    return {**record, "stem": row.stem} if files else {**record, "svg": row.svg}


def _records(path: Path) -> Iterator[dict[str, Any]]:
    with path.open("rb") as file:
        for line in file:
            if line.endswith(b"\n"):
                yield json.loads(line)


def _line(record: dict[str, Any]) -> bytes:
    return json.dumps(record, separators=(",", ":")).encode() + b"\n"


def _write(new: Path, path: Path, content: bytes) -> None:
    new.write_bytes(content)
    os.replace(new, path)
