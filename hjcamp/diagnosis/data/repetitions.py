"""Which tests of one condition are repetitions: those that follow one course."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.measured_test import MeasuredTest
from hjcamp.diagnosis.levels import DELTA

Array = NDArray[np.float64]
# A course is compared by means over so many samples: a controller's answer to noise is none of it.
BLOCK = 24
# Samples over which a start is taken: noise falls, and little moves in them.
FIRST = 4


def apart_by_course(tests: Sequence[MeasuredTest]) -> tuple[MeasuredTest, ...]:
    """Return the tests; those of a condition that follow another course than its first get a condition of their own.

    Tests follow one course where their inputs differ by less than a tenth of what they do, or their readings where a loop makes
    the inputs. Where no input changes, the start makes the course: they begin within a tenth of what their readings do.
    """
    groups: dict[str, list[list[int]]] = {}
    for place, test in enumerate(tests):
        known = groups.setdefault(test.condition, [])
        group = next((one for one in known if _similar(tests[one[0]], test)), None)
        if group is None:
            known.append(group := [])
        group.append(place)
    found = list(tests)
    for condition, known in groups.items():
        names = [tests[group[0]].name for group in known]
        for k, group in enumerate(known if len(known) > 1 else ()):
            own = names[k] if names.count(names[k]) == 1 else str(k + 1)
            name = f"{condition} ({own})" if condition else own
            for place in group:
                found[place] = replace(tests[place], condition=name)
    return tuple(found)


def _similar(first: MeasuredTest, second: MeasuredTest) -> bool:
    if _shared(first.readings, second.readings):
        return True
    driven = np.any(np.ptp(first.inputs, axis=0) > 0.0) or np.any(np.ptp(second.inputs, axis=0) > 0.0)
    return _shared(first.inputs, second.inputs) and (bool(driven) or _same_start(first.readings, second.readings))


def _same_start(one: Array, other: Array) -> bool:
    """Whether columns (n, m) begin within a tenth of what they do, each of its own rms."""
    both = np.concatenate([one, other])
    apart = one[:FIRST].mean(axis=0) - other[:FIRST].mean(axis=0)
    return bool(np.all(apart**2 <= DELTA**2 * np.mean((both - both.mean(axis=0)) ** 2, axis=0)))


def _shared(one: Array, other: Array) -> bool:
    """Whether columns (n, m) differ by less than what matters, over the time that both have, each against its own rms."""
    count = min(len(one), len(other)) // BLOCK
    a, b = (columns[: count * BLOCK].reshape(count, BLOCK, -1).mean(axis=1) for columns in (one, other))
    both = np.concatenate([a, b])
    return bool(np.all(np.mean((a - b) ** 2, axis=0) <= DELTA**2 * np.mean((both - both.mean(axis=0)) ** 2, axis=0)))
