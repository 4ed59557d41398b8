"""Inputs: where pictures are, found one by one in folders, globs, lists and Parquet files.

An `Input` says where a picture is; it holds the picture itself only from `filled` to its drawing. So inputs stream: at
any time there are the names of one folder and the pictures that are being drawn.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import NamedTuple, Optional

from . import files, parquet

#: What a folder is searched for.
SUFFIXES = frozenset((".png", ".jpg", ".jpeg", ".webp", ".gif", ".bmp", ".tif", ".tiff"))


class Input(NamedTuple):
    """A picture to draw."""

    #: What it is known by, in the results too.
    path: str
    #: Its drawing's path below the output, without suffix.
    stem: str
    #: The file that it is, or that it is in: an absolute path or a URL.
    location: str
    #: Where it is in a Parquet file.
    cell: Optional[parquet.Cell] = None
    #: The picture file, once it is read.
    content: Optional[bytes] = None
    #: Why it is not to be drawn.
    refusal: Optional[str] = None

    def holding(self, content: Optional[bytes]) -> Input:
        return self._replace(content=content)


def find(sources: Iterable[str], column: Optional[str] = None, id: Optional[str] = None) -> Iterator[Input]:
    """All inputs of `sources`, in their order; a picture that is found twice comes twice.

    Args:
        sources: Folders, globs, pictures, Parquet files, lists of such files; paths or URLs.
        column: The column of Parquet files that holds pictures.
        id: The column of Parquet files that names them.
    """
    for source in sources:
        for location, stem in _places(source):
            if location.endswith(".parquet"):
                yield from _rows(location, stem, column, id)
            else:
                yield Input(shown(location), stem, files.absolute(location))


def check(sources: Iterable[str]) -> None:
    """Raises `FileNotFoundError` for a source that is not there."""
    for source in sources:
        if files.kind(source) is files.Kind.MISSING:
            base = files.split_glob(source)[0] or "." if files.is_glob(source) else source
            if files.kind(base) is files.Kind.MISSING:
                raise FileNotFoundError(f"{base}: no such file or folder")


def filled(inputs: Iterable[Input]) -> Iterator[Input]:
    """The same inputs; those in Parquet files with their content. Row groups without any are not read."""
    for (location, group), some in groupby(inputs, lambda i: (i.location, i.cell and i.cell.group)):
        if group is None:
            yield from some
            continue
        members = list(some)
        yield from map(Input.holding, members, _contents(location, [one.cell for one in members if one.cell]))


def _contents(location: str, cells: list[parquet.Cell]) -> Iterator[Optional[bytes]]:
    """Where a row group breaks off, the rest are read one by one, so that each tells its own error."""
    read = 0
    try:
        for content in parquet.contents(location, cells):
            read += 1
            yield content
    except (OSError, ValueError):
        yield from (None for _ in cells[read:])


def read(one: Input) -> bytes:
    """The picture file."""
    if one.refusal is not None:
        raise ValueError(one.refusal)
    if one.content is not None:
        return one.content
    if one.cell is None:
        return files.content(one.location)
    content = next(parquet.contents(one.location, [one.cell]))
    if content is None:
        raise ValueError("the row has no picture")
    return content


def shown(path: str) -> str:
    """The path as text that every file can hold: bytes of a name that are no UTF-8 become `\\xe9`."""
    return path.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")


def _places(source: str) -> Iterator[tuple[str, str]]:
    """Files of a source, with the paths of their drawings."""
    kind = files.kind(source)
    if kind is files.Kind.MISSING:
        yield from _matches(source)
    elif kind is files.Kind.FOLDER:
        for below in files.walk(source):
            if files.suffix(below) in SUFFIXES:
                yield files.join(source, below), stem(below)
    elif files.suffix(source) in SUFFIXES | {".parquet"}:
        yield source, stem(files.name(source))
    else:
        for line in files.lines(source):
            yield line, stem(line)


def _matches(pattern: str) -> Iterator[tuple[str, str]]:
    """Files that match a glob. `**` is any number of folders."""
    base, rest = files.split_glob(pattern)
    expression = re.compile(_expression(rest))
    depth = None if "**" in rest else rest.count("/")
    found = False
    for below in files.walk(base or ".", depth, hidden=rest.startswith(".") or "/." in rest):
        if expression.fullmatch(below):
            found = True
            yield files.join(base, below), stem(below)
    if not found:
        raise FileNotFoundError(f"{pattern}: no file matches")


def _expression(pattern: str) -> str:
    tokens = {"**/": "(?:.*/)?", "**": ".*", "*": "[^/]*", "?": "[^/]"}
    parts = re.split(r"(\*\*/|\*\*|\*|\?|\[!?\]?[^]]*\])", pattern)
    return "".join(tokens.get(part) or _literal(part) for part in parts)


def _literal(part: str) -> str:
    if len(part) > 2 and part.startswith("["):
        members = re.sub(r"([\\\[&~|^])", r"\\\1", part[1:-1].lstrip("!"))
        return f"[^/{members}]" if part[1] == "!" else f"[{members}]"
    return re.escape(part)


def _rows(location: str, name: str, column: Optional[str], id: Optional[str]) -> Iterator[Input]:
    for cell, named in parquet.cells(files.absolute(location), column, id):
        path = shown(location) + f"#{cell.number}" if named is None else named
        own = f"{name}/{cell.number}" if named is None else stem(named)
        yield Input(path, own, files.absolute(location), cell)


def stem(path: str) -> str:
    """A relative path for a drawing of `path`, without suffix, and below the folder that it is joined to.

    >>> stem("a/b.png"), stem("/data/../c.JPG"), stem("https://host/d.webp?size=2"), stem("row 5.1")
    ('a/b', 'data/c', 'host/d', 'row 5.1')
    """
    if files.is_url(path):
        path = re.split(r"[?#]", path.split("://", 1)[1])[0]
    path = path if os.sep == "/" else path.replace(os.sep, "/")
    parts = [part for part in re.sub(r"^[A-Za-z]:(?=/)", "", path).split("/") if part not in ("", ".", "..")]
    # By hand: pathlib keeps the parts of all paths that it has seen in one table.
    root, suffix = os.path.splitext("/".join(parts) or "picture")
    return root if suffix.lower() in SUFFIXES | {".parquet"} else root + suffix
