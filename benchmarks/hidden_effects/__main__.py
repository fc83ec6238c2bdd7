"""`python -m benchmarks.hidden_effects`."""

import sys

from benchmarks.hidden_effects.running import main

if __name__ == "__main__":
    sys.exit(main())
