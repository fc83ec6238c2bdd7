"""`python -m benchmarks.hunting`."""

import sys

from benchmarks.hunting.running import main

if __name__ == "__main__":
    sys.exit(main())
