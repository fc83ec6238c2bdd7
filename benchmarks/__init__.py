"""Studies of speed, of fidelity and of how often a diagnosis is right: `python -m benchmarks.NAME` in the folder above."""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
# the truth plants, which share no code with the program
sys.path.insert(0, str(ROOT / "tests"))
