"""The command line: `python -m strokefit --help`."""

import signal
import sys

from . import _native


def main() -> int:
    """Runs the command line with the arguments of the process and returns the exit status."""
    # Python only notes Ctrl-C until its own code runs again; the command line answers it as a program does.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.main(["strokefit", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
