"""`python -m benchmarks.any_plant`."""

import sys

from benchmarks.any_plant.running import main

if __name__ == "__main__":
    sys.exit(main())
