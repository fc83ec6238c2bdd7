"""`python -m benchmarks.levels`."""

import sys

from benchmarks.levels.running import main

if __name__ == "__main__":
    sys.exit(main())
