"""What rigs with other contacts and laws gain and leave: the numbers that decide a verdict, each at a stated level.

Twins share the model's contact and laws, a rig does not: more than a twentieth of rigs with nothing missing gain more than 95 % of
their twins. So what is asked beyond twins comes from simulated rigs of another program with four laws of dry contact (`make levels`
makes the tables and docs/levels.md): 200 with nothing missing (`nulls.csv`), and some with one effect, in the library under one of
several laws or not in it (`effects.csv`). Gains go with the number of tests, as a contact that is off in form shows in each alike.
Some effects take up such a form and others cannot, so that a gain counts by what that effect gains on these rigs on average.
"""

from __future__ import annotations

import csv
import math
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
# An effect is not named where more of the twins of its own tests gain as much.
CERTAIN = 0.05
GAIN = "gain_"
NOISE = 0.5


def least_gain(effect: str, tests: int) -> float:
    r"""Return what an effect must gain in so many tests: as many times what is usual for it as `LEVEL` of rigs with nothing missing.

    .. math:: g_e \ge q\,u_e(n), \quad P\bigl(g_b \ge q\,u_b(n)\bigr) = `LEVEL`

    with b the best effect of such a rig, where less than `CERTAIN` of the rig's own twins gain as much, which is asked as well: the
    largest of statistics that are studentised (Westfall & Young 1993, Resampling-Based Multiple Testing, section 2.3).
    """
    return times_asked() * usual_gain(effect, tests)


@cache
def times_asked() -> float:
    """Return how many times what is usual for it an effect is asked."""
    return float(np.quantile(best_gains(), 1.0 - LEVEL))


def second_gain(tests: int) -> float:
    """Return what a second effect must gain where the first leaves what its law may: as `LEVEL` of the rigs with one effect.

    A test, of any effect: what a law leaves that is off in form is not what a contact leaves.
    """
    return float(np.quantile(second_gains(), 1.0 - LEVEL)) * tests


def chance(effect: str, gain: float, tests: int) -> float:
    """Return the share of rigs with nothing missing whose best effect gains as many times what is usual for it."""
    known = best_gains()
    return float((1 + np.sum(known >= gain / usual_gain(effect, tests))) / (1 + len(known)))


def usual_gain(effect: str, tests: int) -> float:
    """Return what an effect promises to gain in so many tests where nothing is missing; one not in the table, as much as any.

    No less than noise alone gives one free amplitude in all tests, half a unit (Wilks 1938, doi:10.1214/aoms/1177732360).
    """
    known = promises_a_test()
    return max(known.get(effect, max(known.values())) * tests, NOISE)


@cache
def promises_a_test() -> dict[str, float]:
    """Return the gain a test that is promised of each effect, on average of the rigs with nothing missing."""
    rows = rows_of(TABLE)
    tests = np.array([int(row["tests"]) for row in rows])
    names = [name.removeprefix(GAIN) for name in rows[0] if name.startswith(GAIN)]
    return {name: float(np.mean([float(row[f"{GAIN}{name}"]) for row in rows] / tests)) for name in names}


@cache
def margin() -> float:
    """Return the factor on the limit of the twins that `LEVEL` of the rigs with nothing missing exceed in some channel."""
    return float(np.quantile(_over(rows_of(TABLE)).max(axis=1), 1.0 - LEVEL))


@cache
def law() -> float:
    r"""Return the share of what a named effect explains by which its law may be off.

    .. math:: e_{after}^2 \le (m\,e_{twins})^2 + \lambda^2 (e_{before}^2 - e_{after}^2)

    with m of `margin`: the share that parts rigs with an effect of the library, which was found, from rigs with another one, where
    the law that was found is not exact.
    """
    return parted(*laws_off())


@cache
def exact(kind: str) -> float:
    """Return how much may speak against a law that is exact, in one of the ways of `verdict.AGAINST`.

    Parts the rigs with an effect of such a law from those with another effect for which it was taken.
    """
    return parted(*spoken_against(kind))


def spoken_against(kind: str) -> tuple[Array, Array]:
    """Return how much speaks against an exact law on rigs with its effect, and on others of which it was found (rigs,)."""
    rows = [row for row in rows_of(EFFECTS) if row["exact"] == "1" and row[kind]]
    known = [float(row[kind]) for row in rows if row["found"] == row["effect"]]
    return np.array(known), np.array([float(row[kind]) for row in rows if row["known"] == "0"])


def parted(known: Array, others: Array) -> float:
    """Return where the share of the known above and that of the others up to it are least together (Youden 1950).

    The middle, where both are least on a stretch between two rigs; 0 at least, and infinite where there are none to part.
    """
    if not len(known) or not len(others):
        return math.inf
    asked = np.unique(np.maximum(np.concatenate([[0.0], known, others]), 0.0))
    asked = asked[np.isfinite(asked)]
    both = np.array([np.mean(known > one) + np.mean(others <= one) for one in asked])
    first = last = int(np.argmin(both))
    while last + 1 < len(asked) and both[last + 1] == both[first]:
        last += 1
    return float(0.5 * (asked[first] + asked[min(last + 1, len(asked) - 1)]))


@cache
def laws_off() -> tuple[Array, Array]:
    """Return by which share the law found is off on rigs with an effect of the library, which was found, and on others (rigs,)."""
    rows = [row for row in rows_of(EFFECTS) if row["found"] and row["exact"] == "0"]
    known = [row for row in rows if row["known"] == "1" and row["found"] == row["effect"]]
    return off_of(known), off_of([row for row in rows if row["known"] == "0"])


@cache
def best_gains() -> Array:
    """Return how many times its usual gain the best effect of each rig with nothing missing gains (rigs,), as far as it counts."""
    return times_usual(rows_of(TABLE))


@cache
def second_gains() -> Array:
    """Return the gain a test (rigs,) of the best second effect on each rig with one effect of the library, which was found."""
    rows = [row for row in rows_of(EFFECTS) if row["known"] == "1" and row["found"] == row["effect"]]
    return np.array([float(row["second_gain"]) / int(row["tests"]) for row in rows])


def times_usual(rows: Sequence[Mapping[str, str]]) -> Array:
    """Return how many times its usual gain the best effect of each rig gains (rigs,), 0 where its own twins often gain as much."""
    times = [float(row["gain"]) / usual_gain(row["best"], int(row["tests"])) for row in rows]
    return np.where([float(row["twins_p"]) < CERTAIN for row in rows], times, 0.0)


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
