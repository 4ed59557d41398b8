"""`python -m strokefit.batch` draws many pictures; in Python, `strokefit.batch` is the function that does."""

import sys
from types import ModuleType
from typing import Any

from ._batch import Summary, batch
from ._batch.cli import main


class _Callable(ModuleType):
    """`import strokefit.batch` puts this module in the place of the function, so it is one."""

    def __call__(self, *args: Any, **options: Any) -> Summary:
        return batch(*args, **options)


if __name__ == "__main__":
    sys.exit(main())
sys.modules[__name__].__class__ = _Callable
