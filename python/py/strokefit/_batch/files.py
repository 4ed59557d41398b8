"""Files by path or URL. Paths go through the system; URLs through pyarrow, or fsspec where pyarrow does not know them."""

from __future__ import annotations

import enum
import functools
import os
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Optional
from urllib.parse import urlsplit

if TYPE_CHECKING:
    from pyarrow.fs import FileSystem


class Kind(enum.Enum):
    """What a path or URL leads to."""

    MISSING = enum.auto()
    FILE = enum.auto()
    FOLDER = enum.auto()


def is_url(path: str) -> bool:
    """Whether it has a scheme, such as `s3://`."""
    return re.match(r"[a-z][a-z0-9+.-]+://", path) is not None


def is_glob(path: str) -> bool:
    """Whether it has wildcards. In a URL, `?` begins a query."""
    return re.search(r"\*" if is_url(path) else r"[*?\[]", path) is not None


def kind(path: str) -> Kind:
    """What is there."""
    if not is_url(path):
        return Kind.FOLDER if os.path.isdir(path) else Kind.FILE if os.path.exists(path) else Kind.MISSING
    if is_glob(path):
        return Kind.MISSING
    from pyarrow.fs import FileType

    system, own = _filesystem(path)
    found = system.get_file_info([own])[0].type
    return {FileType.Directory: Kind.FOLDER, FileType.NotFound: Kind.MISSING}.get(found, Kind.FILE)


def absolute(path: str) -> str:
    """The path from the root; URLs are whole already."""
    return path if is_url(path) else os.path.abspath(path)


def name(path: str) -> str:
    """The last part."""
    return (urlsplit(path).path if is_url(path) else os.path.basename(path)).rsplit("/", 1)[-1]


def suffix(path: str) -> str:
    """That of the name, in lower case, with its dot."""
    return os.path.splitext(name(path))[1].lower()


def join(base: str, below: str) -> str:
    """The path of what lies `below` a folder, `/` between its parts."""
    return f"{base.rstrip('/')}/{below}" if is_url(base) else os.path.normpath(os.path.join(base, below))


def split_glob(pattern: str) -> tuple[str, str]:
    """The folder up to the first part with a wildcard, and the rest, which has `/` between its parts."""
    pattern = pattern if os.sep == "/" else pattern.replace(os.sep, "/")
    parts = pattern.split("/")
    first = next(i for i, part in enumerate(parts) if is_glob(part))
    return "/".join(parts[:first]) or ("/" if first else ""), "/".join(parts[first:])


def walk(folder: str, depth: Optional[int] = None, hidden: bool = False) -> Iterator[str]:
    """Paths of all files below `folder`, `/` between their parts, sorted in each folder.

    At most `depth` folders deep. Names that start with a dot are left out unless they are `hidden`, and links to
    folders are not followed.
    """
    yield from _walk(folder, "", depth, hidden)


def content(location: str) -> bytes:
    """All bytes of a file."""
    with opened(location) as file:
        data: bytes = file.read()
    return data


def lines(location: str) -> Iterator[str]:
    """The lines of a text file that are not empty."""
    with opened(location) as file:
        for line in file:
            text = line.rstrip(b"\r\n")
            if text.strip():
                yield text.decode("utf-8", "surrogateescape")


def opened(location: str) -> Any:
    """The file, to be read as bytes."""
    if not is_url(location):
        return open(location, "rb")
    system, own = _filesystem(location)
    return system.open_input_file(own)


def _walk(folder: str, below: str, depth: Optional[int], hidden: bool) -> Iterator[str]:
    entries = sorted(_entries(folder), reverse=True)
    while entries:
        entry = entries.pop()  # a folder of a million files is not held to its end
        if entry.startswith(".") and not hidden:
            continue
        if not entry.endswith("/"):
            yield below + entry
        elif depth is None or depth > 0:
            deeper = None if depth is None else depth - 1
            yield from _walk(join(folder, entry[:-1]), below + entry, deeper, hidden)


def _entries(folder: str) -> Iterator[str]:
    """Names in a folder; those of folders end in `/`."""
    if not is_url(folder):
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.is_dir(follow_symlinks=False):
                    yield entry.name + "/"
                elif not entry.is_dir():
                    yield entry.name
        return
    from pyarrow.fs import FileSelector, FileType

    system, own = _filesystem(folder)
    for info in system.get_file_info(FileSelector(own)):
        yield info.base_name + ("/" if info.type == FileType.Directory else "")


def _filesystem(url: str) -> tuple[FileSystem, str]:
    """What reads a URL, and the path that it has there."""
    parts = urlsplit(url)
    system, strip = _system_of(parts.scheme, parts.netloc)
    return system, strip(url)


@functools.lru_cache(maxsize=16)
def _system_of(scheme: str, host: str) -> tuple[FileSystem, Any]:
    """Made once for each host: finding the region of a bucket takes a request."""
    try:
        import pyarrow
        from pyarrow.fs import FileSystem, FSSpecHandler, PyFileSystem
    except ImportError:
        raise ImportError(f"{scheme}:// needs pyarrow: pip install pyarrow") from None
    try:
        system, _ = FileSystem.from_uri(f"{scheme}://{host}/")
        return system, _path_in_uri
    except pyarrow.ArrowInvalid:
        pass
    try:
        import fsspec

        other, _ = fsspec.core.url_to_fs(f"{scheme}://{host}/")
    except (ImportError, ValueError) as error:
        raise ImportError(f"{scheme}:// is not known here: {error}") from None
    return PyFileSystem(FSSpecHandler(other)), other._strip_protocol


def _path_in_uri(url: str) -> str:
    parts = urlsplit(url)
    return parts.path if parts.scheme == "file" else parts.netloc + parts.path
