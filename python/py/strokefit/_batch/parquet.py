"""Parquet files: pictures in a column, and drawings as rows. The only file that uses pyarrow's Parquet."""

from __future__ import annotations

import functools
import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Optional

from . import files

if TYPE_CHECKING:
    import pyarrow as pa
    from pyarrow.parquet import ParquetFile

#: Pictures are read so many at a time: few enough to hold, and many enough that the calls do not count.
_BATCH = 16

#: Text of drawings in one row group, bytes: a reader holds some of them.
_GROUP_BYTES = 16 << 20


class Cell(NamedTuple):
    """A picture in a Parquet file."""

    column: str
    group: int
    #: In the group.
    row: int
    #: In the file.
    number: int


def cells(location: str, column: Optional[str], id: Optional[str]) -> Iterator[tuple[Cell, Optional[str]]]:
    """All pictures of a file, with their names if column `id` has them. No picture is read."""
    with _open(location) as file:
        column = _column(location, file, column)
        if id is not None and id not in file.schema_arrow.names:
            raise ValueError(f"{location} has no column {id!r}: it has {', '.join(file.schema_arrow.names)}")
        number = 0
        for group in range(file.metadata.num_row_groups):
            for row, named in enumerate(_names(file, group, id)):
                yield Cell(column, group, row, number), named
                number += 1


def contents(location: str, wanted: Sequence[Cell]) -> Iterator[Optional[bytes]]:
    """The pictures of cells that are in one row group, in ascending order; `None` where there is none."""
    column, group = wanted[0].column, wanted[0].group
    with _open(location) as file:
        remaining = iter(wanted)
        cell: Optional[Cell] = next(remaining)
        start = 0
        for batch in file.iter_batches(_BATCH, row_groups=[group], columns=[column]):
            while cell is not None and cell.row < start + len(batch):
                yield _bytes(batch.column(0)[cell.row - start])
                cell = next(remaining, None)
            if cell is None:
                return
            start += len(batch)


def write(path: Path, rows: Iterable[dict[str, Any]]) -> None:
    """Writes drawings as a Parquet file, and does not hold them all."""
    import pyarrow.parquet as pq

    with pq.ParquetWriter(path, schema(), compression="zstd") as writer:
        for some in _groups(rows):
            writer.write_table(_table(some))


def paths(path: Path) -> Iterator[str]:
    """The paths in a file that `write` made."""
    with _open(str(path)) as file:
        for batch in file.iter_batches(columns=["path"]):
            yield from batch.column(0).to_pylist()


def rows(path: Path) -> Iterator[dict[str, Any]]:
    """The rows of a file that `write` made, as they were given."""
    with _open(str(path)) as file:
        for batch in file.iter_batches(_BATCH):
            for row in batch.to_pylist():
                yield {**row, "report": row["report"] and json.loads(row["report"])}


@functools.lru_cache(maxsize=1)
def schema() -> pa.Schema:
    """The columns of drawings."""
    try:
        import pyarrow as pa
    except ImportError:
        raise ImportError("Parquet needs pyarrow: pip install pyarrow, or give files=True (--files)") from None
    text = {"svg": pa.large_string(), "report": pa.string(), "error": pa.string()}
    return pa.schema([pa.field("path", pa.string(), nullable=False), *text.items()])


def _table(some: list[dict[str, Any]]) -> pa.Table:
    import pyarrow as pa

    texts = [{**row, "report": row["report"] and json.dumps(row["report"])} for row in some]
    return pa.Table.from_pylist(texts, schema=schema())


def _groups(rows: Iterable[dict[str, Any]]) -> Iterator[list[dict[str, Any]]]:
    some: list[dict[str, Any]] = []
    size = 0
    for row in rows:
        some.append(row)
        size += len(row["svg"] or "")
        if size >= _GROUP_BYTES:
            yield some
            some, size = [], 0
    if some:
        yield some


def _open(location: str) -> ParquetFile:
    schema()
    import pyarrow as pa
    import pyarrow.parquet as pq

    source = files.opened(location) if files.is_url(location) else location
    try:
        # Pages as they are needed, instead of whole row groups.
        return pq.ParquetFile(source, buffer_size=1 << 20, pre_buffer=False)
    except pa.ArrowInvalid as error:
        raise ValueError(f"{location}: not a Parquet file: {error}") from None


def _names(file: ParquetFile, group: int, id: Optional[str]) -> Iterator[Optional[str]]:
    if id is None:
        yield from (None for _ in range(file.metadata.row_group(group).num_rows))
        return
    for batch in file.iter_batches(row_groups=[group], columns=[id]):
        yield from (str(name) for name in batch.column(0).to_pylist())


def _column(location: str, file: ParquetFile, column: Optional[str]) -> str:
    """The column of pictures: bytes, or what Hugging Face's datasets make of pictures, a struct with `bytes`."""
    names: list[str] = [field.name for field in file.schema_arrow if _holds_bytes(field.type)]
    if column is not None and column in names:
        return column
    if column is None and len(names) == 1:
        return names[0]
    right = f"give one of {', '.join(names)} (--column)" if names else "it has none with bytes"
    wrong = "has no one column of pictures" if column is None else f"has no pictures in column {column!r}"
    raise ValueError(f"{location} {wrong}: {right}")


def _holds_bytes(type: pa.DataType) -> bool:
    import pyarrow.types as types

    if types.is_struct(type):
        return any(type.field(i).name == "bytes" and _holds_bytes(type.field(i).type) for i in range(type.num_fields))
    return bool(types.is_binary(type) or types.is_large_binary(type))


def _bytes(value: Any) -> Optional[bytes]:
    held = value.as_py()
    return held.get("bytes") if isinstance(held, dict) else held
