"""Which kinds of test distinguish effects, in words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hjcamp.model.declare.effect import Effect

# What kind of test tells laws over these drivers apart; the one with a space is no part of an argument.
TELLING = {
    "velocity": "the same moves at other speeds, equal speeds in both directions",
    "speed": "slow moves at several constant speeds",
    "position": "moves about other positions, and a hold at each",
    "travel": "moves about other positions",
    "time": "the same move at the beginning and at the end of a long test",
    "each condition": "the same tests once more, with what may act from outside recorded",
    "load": "the same moves with another mass or load",
    "level": "holds at several levels without inflow",
    "difference": "holds with several differences of the two levels, without inflow",
    "upstream": "emptying from several levels",
    "demand": "steps of several sizes, small ones among them, in both directions",
    "true": "holds at several values, with another instrument in parallel with the sensor",
}


def telling_tests(
    effects: Iterable[str], unknowns: Sequence[Mapping[str, Any]], library: Mapping[str, type[Effect]]
) -> list[str]:
    """Return in words which kinds of test tell effects, and the best unknown, apart: by what drives them."""
    drivers = {"each condition" if one["apart_s"] else one["driver"].rpartition("_")[2] for one in unknowns[:1]}
    for name in effects:
        if name not in library:
            continue
        own = library[name].parameters
        given = {argument for term in library[name].terms.values() for argument in term.arguments if argument not in own}
        drivers |= {driver for driver in TELLING if any(driver in argument for argument in given)}
    said = [TELLING[one] for one in TELLING if one in drivers]
    return [one for one in said if not any(other != one and other.startswith(one) for other in said)]
