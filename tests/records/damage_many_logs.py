"""Damages many logs and reads, verifies and recovers each: python tests/records/damage_many_logs.py [files]"""

from __future__ import annotations

import resource
import sys
import tempfile
from pathlib import Path

from test_damaged_logs import try_damaged

LONGEST_SECONDS, MEMORY_MIB = 2.0, 1024


def main(files: int = 10_000, seed: int = 1) -> int:
    """Print what became of the files; 1 where one took too long or too much memory."""
    with tempfile.TemporaryDirectory() as folder:
        outcomes, longest = try_damaged(Path(folder), files, seed)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{files} damaged logs: {dict(outcomes)}, longest {longest:.2f} s, memory at most {memory:.0f} MiB")
    return int(longest > LONGEST_SECONDS or memory > MEMORY_MIB)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
