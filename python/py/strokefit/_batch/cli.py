"""The command line: `python -m strokefit.batch --help`."""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any, Optional

from . import batch, estimate_batch
from .progress import Progress, Summary

_EXAMPLES = """examples:
  python -m strokefit.batch photos -o out                          Parquet: path, svg, report, error
  python -m strokefit.batch photos -o out --files --preset draft   out/a/b.svg for photos/a/b.jpg
  python -m strokefit.batch 'crops/*.parquet' -o out --column image --strokes 300
  python -m strokefit.batch photos -o out --dry-run                how many, and how long
  python -m strokefit.batch s3://bucket/photos -o out --engine ray --address auto

A run that was ended goes on when the same command is given again. Exit status: 0 every input has its
drawing; 1 the run failed, or inputs did, which have their error as a row and are named; 2 usage; 130 Ctrl-C."""

#: Between two lines of progress, s: on a terminal, and in a log.
_EVERY_S = {True: 0.5, False: 60.0}


def main(args: Optional[list[str]] = None) -> int:
    """Runs the command line and returns the exit status."""
    given = vars(_parser().parse_args(args))
    quiet, dry_run = given.pop("quiet"), given.pop("dry_run")
    src, dst = given.pop("src"), given.pop("output")
    try:
        if dry_run:
            for name in ("engine", "address", "retry"):
                given.pop(name, None)
            print(estimate_batch(src, dst, **given))
            return 0
        with _Line(quiet) as line:
            summary = batch(src, dst, progress=line, **given)
        _tell_failed(summary)
        if not quiet:
            print(summary, file=sys.stderr)
        return 1 if summary.failed else 0
    except (TypeError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except (OSError, ImportError, RuntimeError) as error:
        print(f"error: {error}\nThe same command goes on where this one ended.", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("Stopped. The same command goes on.", file=sys.stderr)
        return 130


def _tell_failed(summary: Summary) -> None:
    """Names the inputs that failed, the first ones."""
    for path, error in summary.failures:
        print(f"error: {path}: {error}", file=sys.stderr)
    more = summary.failed - len(summary.failures)
    if more:
        print(f"error: {more:,} more inputs failed: their rows have the errors", file=sys.stderr)


class _Line:
    """Progress on standard error: one line that changes, or a line a minute where that is no terminal."""

    def __init__(self, quiet: bool) -> None:
        self._quiet = quiet
        self._terminal = sys.stderr.isatty()
        self._next_s = time.monotonic() + _EVERY_S[self._terminal]
        self._shown = False

    def __call__(self, progress: Progress) -> None:
        if self._quiet or time.monotonic() < self._next_s:
            return
        self._next_s = time.monotonic() + _EVERY_S[self._terminal]
        self._shown = True
        start, end = ("\r\x1b[K", "") if self._terminal else ("", "\n")
        print(f"{start}{progress}", end=end, file=sys.stderr, flush=True)

    def __enter__(self) -> _Line:
        return self

    def __exit__(self, *_: object) -> None:
        if self._shown and self._terminal:
            print("\r\x1b[K", end="", file=sys.stderr)


def _parser() -> argparse.ArgumentParser:
    # An option that is not given is not there, so that its default is that of the function.
    parser = argparse.ArgumentParser(
        prog="python -m strokefit.batch",
        description="Draw many pictures: each one once, whatever happens meanwhile.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        argument_default=argparse.SUPPRESS,
        allow_abbrev=False,
    )
    parser.add_argument("src", nargs="+", metavar="SRC", help="folder, 'glob', picture, Parquet file, or list of such files; path or URL")
    parser.add_argument("-o", "--output", metavar="DST", required=True, help="folder of the results")
    parser.add_argument("-q", "--quiet", action="store_true", default=False, help="print errors only")
    parser.add_argument("--dry-run", action="store_true", default=False, help="count inputs, and estimate CPU time from a sample of 20")
    _run_options(parser.add_argument_group("run"))
    _fit_options(parser.add_argument_group("fit, as `strokefit fit --help` explains"))
    return parser


def _run_options(group: Any) -> None:
    group.add_argument("--engine", choices=("local", "ray"), help="processes of this machine (default), or a cluster")
    group.add_argument("--address", metavar="A", help="address of the Ray cluster, such as auto or HEAD:6379")
    group.add_argument("--workers", type=int, metavar="N", help="pictures that are drawn at a time [one per core]")
    group.add_argument("--files", action="store_true", help="one SVG per picture, in folders as in SRC, instead of Parquet")
    group.add_argument("--column", metavar="NAME", help="column of Parquet files with the pictures")
    group.add_argument("--id", metavar="NAME", help="column of Parquet files with their names")
    group.add_argument("--limit", type=int, metavar="N", help="the first N inputs only")
    group.add_argument("--sample", type=float, metavar="SHARE", help="a share of the inputs only, such as 0.01")
    group.add_argument("--retry", action="store_true", help="draw anew what has an error")


def _fit_options(group: Any) -> None:
    for name in ("strokes", "bytes", "points", "stages", "colors", "precision", "seed"):
        group.add_argument(f"--{name}", type=int, metavar="N")
    for name, unit in (("psnr", "DB"), ("time", "SECONDS"), ("quality", "Q")):
        group.add_argument(f"--{name}", type=float, metavar=unit)
    for name, words in (("preset", "PRESET"), ("marks", "MARKS"), ("look", "LOOK"), ("paper", "PAPER"), ("blurs", "BLURS"), ("coverage", "EDGE"), ("background", "COLOR"), ("palette", "LIST|FILE"), ("pens", "WIDTHS"), ("form", "FORM"), ("group", "BY"), ("order", "ORDER"), ("width", "LENGTH")):
        group.add_argument(f"--{name}", metavar=words)
    for name in ("literal", "opaque", "progressive"):
        group.add_argument(f"--{name}", action="store_true")
    group.add_argument("--no-polish", dest="polish", action="store_false")
