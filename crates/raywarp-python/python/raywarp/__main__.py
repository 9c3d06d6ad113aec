"""`python -m raywarp`: the command line program."""

import sys

from raywarp._program import main

if __name__ == "__main__":
    sys.exit(main())
