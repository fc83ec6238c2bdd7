"""`python -m benchmarks.next_value`."""

import sys

from benchmarks.next_value.running import main

if __name__ == "__main__":
    sys.exit(main())
