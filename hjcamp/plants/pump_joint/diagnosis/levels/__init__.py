"""What rigs with nothing missing gain and leave: the numbers that decide a verdict, each at a stated level.

Twins share the model's contact, a rig does not: more than a twentieth of rigs with nothing missing gain more than 95 % of their
twins. So what is asked beyond twins comes from 200 simulated rigs of another program with four laws of dry contact and nothing
missing (`nulls.csv`; `make levels` makes it and docs/levels.md). Gains go with the number of tests, as a contact that is off in
form shows in each test alike.
"""

from __future__ import annotations

import csv
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

TABLE = Path(__file__).with_name("nulls.csv")
CHANNELS = ("arm", "difference", "line_sum", "line_difference", "sliding")
# An effect is named on one rig in forty with nothing missing, and one in forty is called outside the library: 5 % in all.
LEVEL = 0.025


def least_gain(tests: int) -> float:
    """Return what an effect must gain in so many tests: as much a test as `LEVEL` of the rigs with nothing missing."""
    return float(np.quantile(gains_a_test(), 1.0 - LEVEL)) * tests


def chance(gain: float, tests: int) -> float:
    """Return the share of rigs with nothing missing whose best effect gains as much a test."""
    known = gains_a_test()
    return float((1 + np.sum(known >= gain / tests)) / (1 + len(known)))


@cache
def margin() -> float:
    """Return the factor on the limit of the twins that `LEVEL` of the rigs with nothing missing exceed in some channel."""
    over = np.array([[float(row[channel]) for channel in CHANNELS] for row in _rows()])
    return float(np.quantile(over.max(axis=1), 1.0 - LEVEL))


@cache
def gains_a_test() -> NDArray[np.float64]:
    """Return the gain a test (rigs,) of the best effect on each rig with nothing missing."""
    return np.array([float(row["gain"]) / int(row["tests"]) for row in _rows()])


@cache
def _rows() -> tuple[dict[str, str], ...]:
    with TABLE.open(encoding="utf-8", newline="") as file:
        return tuple(csv.DictReader(file))
