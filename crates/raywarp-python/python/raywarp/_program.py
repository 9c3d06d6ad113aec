"""The command line program, as the script `raywarp` starts it."""

import signal
import sys

from raywarp import _raywarp


def main() -> int:
    """Does what the words of the command line ask; returns what the shell is told."""
    # Python would only note Ctrl-C, and raise an exception once the program is over.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _raywarp.run(["raywarp", *sys.argv[1:]])
