"""The phases of a test of any plant: what is commanded before and after the law runs, sample by sample."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.model.declare.field import Phase, check_phases
from hjcamp.model.declare.plant import Plant

Array = NDArray[np.float64]
REST, CONTROL, AFTER = 2.0, 3.0, 4.0


@dataclass(frozen=True)
class Schedule:
    """When what happens in a test of n samples: the law runs from sample ``first`` to before ``last``.

    ``phases`` (n,) are the numbers that the log holds. ``driven`` (n, 2 inputs): where each commanded input goes outside the law, SI,
    and which part of the way from its last value it goes in this sample; the last sample of a phase goes all of it.
    """

    first: int
    last: int
    phases: Array
    driven: Array

    def along(self, asked: Array, place: int = 0) -> Array:
        """Return the commanded input at ``place`` over a whole test (n,), SI, where the law asks for ``asked`` (n,)."""
        found, last = asked.copy(), 0.0
        for k, (goal, part) in enumerate(self.driven[:, 2 * place : 2 * place + 2]):
            last = found[k] if self.first <= k < self.last else last + part * (goal - last)
            found[k] = last
        return found


def phases_of(config: Mapping[str, Any], plant: type[Plant]) -> tuple[tuple[Phase, ...], tuple[Phase, ...]]:
    """Return the phases before and after the motion as the plant declares them and ``procedure.phases`` changes them.

    Raises ``UsageError`` for a phase that the plant has not, and for one that cannot be.
    """
    changed: dict[str, Mapping[str, Any]] = config["procedure"].get("phases") or {}
    known = [one.name for one in (*plant.phases_before, *plant.phases_after)]
    for name, values in changed.items():
        if name not in known:
            raise unknown("phase", str(name), known, f"procedure.phases of plant {plant.name}")
        if not isinstance(values, Mapping):
            raise UsageError(f"procedure.phases.{name} is {shown(values)}; seconds and inputs with their values are needed")

    def with_changes(one: Phase) -> Phase:
        own = dict(changed.get(one.name, {}))
        seconds = own.pop("seconds", one.seconds)
        return replace(one, seconds=seconds, to={**one.to, **own})

    before, after = (tuple(with_changes(one) for one in listed) for listed in (plant.phases_before, plant.phases_after))
    check_phases(before, after, tuple(plant.given_inputs()), plant.period, f"procedure.phases of plant {plant.name}")
    return before, after


def schedule_of(config: Mapping[str, Any], plant: type[Plant], commanded: Sequence[str], motion: int) -> Schedule:
    """Return the schedule of a test whose motion has so many samples; inputs stay while it rests after phases, else they are 0."""
    before, after = phases_of(config, plant)
    rest, end = (round(float(config["procedure"][key]) * 1e-3 / plant.period) for key in ("rest_ms", "after_ms"))
    for one in (*before, *after):
        if lost := sorted(set(one.to) - set(commanded)):
            raise UsageError(
                f"plant {plant.name}, phase '{one.name}': the controller does not command {', '.join(lost)}; "
                f"it commands {', '.join(commanded) or 'nothing'}"
            )
    blocks = [(float(number), _driven(one, commanded, plant.period)) for number, one in enumerate(before)]
    blocks += [(REST, _stays(rest, commanded)), (CONTROL, _stays(motion, commanded))]
    blocks += [(AFTER, _driven(one, commanded, plant.period)) for one in after]
    blocks += [(AFTER, _stays(end, commanded) if after else _stays(end, commanded) + np.tile([0.0, 1.0], len(commanded)))]
    first = sum(len(rows) for number, rows in blocks if number < CONTROL)
    phases = np.concatenate([np.full(len(rows), number) for number, rows in blocks])
    return Schedule(first, first + motion, phases, np.vstack([rows for _, rows in blocks]))


def _stays(samples: int, commanded: Sequence[str]) -> Array:
    return np.zeros((samples, 2 * len(commanded)))


def _driven(one: Phase, commanded: Sequence[str], period: float) -> Array:
    rows = _stays(round(one.seconds / period), commanded)
    for place, name in enumerate(commanded):
        if name in one.to:
            rows[:, 2 * place] = one.to[name]
            rows[:, 2 * place + 1] = 1.0 / np.arange(len(rows), 0, -1)
    return rows
