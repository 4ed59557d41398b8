"""`python -m strokefit.batch` draws many pictures; in Python, `strokefit.batch` is the function that does."""

import sys

from ._batch import batch
from ._batch.cli import main

if __name__ == "__main__":
    sys.exit(main())

# `import strokefit.batch` would put this module in the place of the function.
sys.modules[__name__] = batch  # type: ignore[assignment]
