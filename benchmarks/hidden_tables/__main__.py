"""`python -m benchmarks.hidden_tables`."""

import sys

from benchmarks.hidden_tables.running import main

if __name__ == "__main__":
    sys.exit(main())
