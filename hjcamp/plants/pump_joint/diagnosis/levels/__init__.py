"""What rigs with other contacts and laws gain and leave: the numbers that decide a verdict, each at a stated level.

Twins share the model's contact and laws, a rig does not: more than a twentieth of rigs with nothing missing gain more than 95 % of
their twins. So what is asked beyond twins comes from simulated rigs of another program with four laws of dry contact (`make levels`
makes the tables and docs/levels.md): 200 with nothing missing (`nulls.csv`), and some with one effect, in the library under one of
several laws or not in it (`effects.csv`). Gains go with the number of tests, as a contact that is off in form shows in each alike.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
TABLE = Path(__file__).with_name("nulls.csv")
EFFECTS = Path(__file__).with_name("effects.csv")
CHANNELS = ("arm", "difference", "line_sum", "line_difference", "sliding")
# An effect is named on one rig in forty with nothing missing, and one in forty is called outside the library: 5 % in all.
LEVEL = 0.025


def least_gain(tests: int) -> float:
    """Return what an effect must gain in so many tests: as much a test as `LEVEL` of the rigs with nothing missing."""
    return float(np.quantile(gains_a_test(), 1.0 - LEVEL)) * tests


def second_gain(tests: int) -> float:
    """Return what a second effect must gain where the first leaves what its law may: as `LEVEL` of the rigs with one effect."""
    return float(np.quantile(second_gains_a_test(), 1.0 - LEVEL)) * tests


def chance(gain: float, tests: int) -> float:
    """Return the share of rigs with nothing missing whose best effect gains as much a test."""
    known = gains_a_test()
    return float((1 + np.sum(known >= gain / tests)) / (1 + len(known)))


@cache
def margin() -> float:
    """Return the factor on the limit of the twins that `LEVEL` of the rigs with nothing missing exceed in some channel."""
    return float(np.quantile(_over(rows_of(TABLE)).max(axis=1), 1.0 - LEVEL))


@cache
def law() -> float:
    r"""Return the share of what a named effect explains by which its law may be off.

    .. math:: e_{after}^2 \le (m\,e_{twins})^2 + \lambda^2 (e_{before}^2 - e_{after}^2)

    with m of `margin`: the least share at which both errors together are least (Youden 1950), that rigs with an effect of the
    library are called outside it, and that rigs with another effect are not, where the law that was found is not exact.
    """
    known, outside = laws_off()
    asked = np.unique(np.concatenate([[0.0], known, outside]))
    asked = asked[np.isfinite(asked)]
    return float(asked[int(np.argmin([np.mean(known > one) + np.mean(outside <= one) for one in asked]))])


@cache
def laws_off() -> tuple[Array, Array]:
    """Return by which share the law found is off on rigs with an effect of the library, which was found, and on others (rigs,)."""
    rows = [row for row in rows_of(EFFECTS) if row["found"] and row["exact"] == "0"]
    known = [row for row in rows if row["known"] == "1" and row["found"] == row["effect"]]
    return off_of(known), off_of([row for row in rows if row["known"] == "0"])


@cache
def gains_a_test() -> Array:
    """Return the gain a test (rigs,) of the best effect on each rig with nothing missing."""
    return np.array([float(row["gain"]) / int(row["tests"]) for row in rows_of(TABLE)])


@cache
def second_gains_a_test() -> Array:
    """Return the gain a test (rigs,) of the best second effect on each rig with one effect of the library, which was found."""
    rows = [row for row in rows_of(EFFECTS) if row["known"] == "1" and row["found"] == row["effect"]]
    return np.array([float(row["second_gain"]) / int(row["tests"]) for row in rows])


def off_of(rows: Sequence[Mapping[str, str]]) -> Array:
    """Return by which share of what it explains the law found is off in the worst channel (rigs,), beyond the margin."""
    before, after, most = _over(rows, "before_"), _over(rows, "after_"), margin()
    excess, explained = np.maximum(after**2 - most**2, 0.0), np.maximum(before**2 - after**2, 0.0)
    off = np.sqrt(np.divide(excess, explained, out=np.full_like(excess, np.inf), where=explained > 0.0))
    return np.asarray(np.where(excess > 0.0, off, 0.0).max(axis=1))


def _over(rows: Sequence[Mapping[str, str]], when: str = "") -> Array:
    """Return what is left over what 95 % of the twins leave (rigs, channels)."""
    return np.array([[float(row[when + channel]) for channel in CHANNELS] for row in rows]).reshape(-1, len(CHANNELS))


@cache
def rows_of(table: Path) -> list[dict[str, str]]:
    """Return the rows of a table."""
    with table.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))
