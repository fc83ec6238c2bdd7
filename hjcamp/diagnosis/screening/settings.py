"""The settings of an effect's shapes at which it is looked at."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping

import numpy as np

from hjcamp.diagnosis.candidates.visited_range import Range
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter

# Values tried of each shape, between bounds or within this factor of the usual value; all of them for two shapes at most.
SHAPES = 4
FACTOR = 8.0
MOST_SHAPES = 2


def amplitudes_of(effect: type[Effect]) -> tuple[str, ...]:
    """Return the parameters at whose ``off`` value the effect is absent, the first and all that are no shape next to it.

    All that are no shape where it declares none.
    """
    found = [name for name, item in effect.parameters.items() if item.off is not None]
    kept = [name for name in found if name == found[0] or not effect.parameters[name].shape]
    return tuple(kept or [name for name, item in effect.parameters.items() if not item.shape][:1])


def shape_grid(effect: type[Effect], visited: Mapping[str, Range]) -> Iterator[dict[str, float]]:
    """Yield settings of the effect's shapes: its usual values, and a grid over what the tests visit, or about them."""
    shapes = [item for item in effect.parameters.values() if item.shape][:MOST_SHAPES]
    yield {}
    for values in itertools.product(*(_tried(item, visited) for item in shapes)) if shapes else ():
        yield {item.name: value for item, value in zip(shapes, values, strict=True)}


def neighbours_of(
    effect: type[Effect], setting: Mapping[str, float], share: float, visited: Mapping[str, Range]
) -> Iterator[dict[str, float]]:
    """Yield settings with one shape moved to either side by a share of the range that is tried of it."""
    for item in effect.parameters.values():
        if not item.shape:
            continue
        now, (low, high) = setting[item.name], item.bounds
        for sign in (1.0, -1.0):
            if item.cyclic:
                moved = (now + sign * share * math.tau + math.pi) % math.tau - math.pi
            elif _is_log(item):
                moved = now * FACTOR ** (2.0 * sign * share)
            else:
                moved = now + sign * share * (max(_tried(item, visited)) - min(_tried(item, visited)))
            if low <= moved <= high:
                yield {**setting, item.name: moved}


def _is_log(item: Parameter) -> bool:
    low, high = item.bounds
    return not item.placed and (item.prior != "uniform" or (low > 0.0 and high / low > 30.0))


def _tried(item: Parameter, visited: Mapping[str, Range]) -> list[float]:
    low, high = item.bounds
    if item.cyclic:
        return [0.0, math.pi / 2.0, -math.pi / 2.0, 0.999 * math.pi]
    if item.name in visited:
        first, last = visited[item.name]
        if _is_log(item):
            bottom, top = (last - first) / FACTOR, max(abs(first), abs(last), last - first)
        else:
            bottom, top = first, last
    elif _is_log(item):
        bottom, top = item.default / FACTOR, item.default * FACTOR
    else:
        reach = FACTOR / 2.0 * abs(item.default) if item.default else high
        bottom, top = item.default - reach, item.default + reach
    bottom, top = (min(max(one, low), high) for one in (bottom, top))
    if _is_log(item):
        return [float(x) for x in np.geomspace(bottom, top, SHAPES)]
    return [float(x) for x in np.linspace(bottom, top, SHAPES + 2)[1:-1]]


def far_off(item: Parameter) -> bool:
    """Whether an effect is absent at the far end of a parameter (a limit): it is nowhere in proportion to it."""
    return abs(item.off or 0.0) > abs(item.default)


def reach_of(item: Parameter) -> float:
    if item.placed:
        return 0.5 * (item.bounds[1] - item.bounds[0])
    finite = [abs(one) for one in item.bounds if math.isfinite(one) and one != 0.0]
    return min(finite) if finite else 1.0
