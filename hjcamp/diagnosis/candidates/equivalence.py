"""When two laws are one: what drives them, and on what they act."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Sequence

import numpy as np

from hjcamp.diagnosis.candidates.nonparametric_terms import Unknown
from hjcamp.model.compile.source_text import names_in
from hjcamp.model.declare.effect import Effect, Term


def law_of(effect: type[Effect]) -> frozenset[tuple[str, frozenset[str]]] | None:
    """Return what an effect without memory makes of what: each slot with the names that drive it; none where it has states."""
    if effect.states or getattr(effect, "made_of", None) is None:
        return None
    own = set(effect.parameters)
    found = frozenset((slot, frozenset(set(term.arguments) - own - {slot})) for slot, term in effect.terms.items())
    return found if any(drivers for _, drivers in found) else None


def equivalent_laws(free: Unknown, named: type[Effect]) -> bool:
    """Whether a non-parametric term is a form of a named one: over what drives it, in the same slot or in what a store gains and loses.

    Dry friction, which nothing drives, is a form of every law of that friction; what remembers is a form of none elsewhere. What
    bends a value as it arrives, such as a limit, is a form of a non-parametric term of that value.
    """
    own, rubs = {*named.parameters, *named.terms}, kind_of(named) == "contact"
    drivers = [
        set(term.arguments) - own for term in named.terms.values() if rubs or named.states.keys().isdisjoint(term.arguments)
    ]
    dry = rubs and not (named.states or any(drivers))
    driven = dry or any(names_in(free.signal) <= one for one in drivers) or _bends(named) & _bends(free.effect)
    kinds = {kind_of(free.effect), kind_of(named)}
    return bool(driven) and (not set(free.effect.terms).isdisjoint(named.terms) or kinds == {"store", "path"})


def _bends(effect: type[Effect]) -> frozenset[str]:
    """Return the slots whose value a law without memory changes depending on that alone."""
    own = set(effect.parameters)
    return frozenset(slot for slot, term in effect.terms.items() if not effect.states and set(term.arguments) - own == {slot})


def is_of_its_own(effect: type[Effect], others: Iterable[type[Effect]]) -> bool:
    """Whether an effect is not the same as one before all others in its slot: where it acts behind them one bends what it takes."""
    return not effect.behind or any(effect.behind in _bends(one) for one in others)


def replaces(later: type[Effect], earlier: type[Effect]) -> bool:
    """Whether an effect that acts behind another one makes of each slot of that what it would without it."""
    return all(slot in later.terms and _replaced(later.terms[slot], slot) for slot in earlier.terms)


@functools.cache
def _replaced(term: Term, slot: str) -> bool:
    """Whether a term changes its slot to what does not depend on what arrives there, at points drawn at random."""
    if slot not in term.arguments:
        return False
    # of many sizes: what only limits what arrives replaces it on one side of its limit alone
    draws = 10.0 ** np.random.default_rng(20090403).uniform(-2, 3, (40, len(term.arguments) + 1))
    place = term.arguments.index(slot)
    try:
        return all(
            term.function(*one) == term.function(*one[:place], other, *one[place + 1 :]) for other, *one in draws.tolist()
        )
    except (ArithmeticError, ValueError):
        return False


def is_lag(effect: type[Effect]) -> bool:
    """Whether an effect makes a drive or a sensor late: it remembers what arrives there."""
    return bool(effect.states) and kind_of(effect) in ("actuator", "sensor")


def times_remembered(effect: type[Effect]) -> dict[str, tuple[float, float]]:
    """Return the bounds of the times for which an effect, no lag and no friction, remembers, by parameter, s.

    At an end of these it need not remember: of a relaxing spring a damper is left, or a spring, laws that are looked for by themselves.
    A lag of no time is none, and friction that changes for longer than a test lasts is friction that changes.
    """
    if not effect.states or is_lag(effect) or kind_of(effect) == "contact":
        return {}
    return {one.name: one.bounds for one in effect.parameters.values() if one.unit == "s"}


def memory_end(ci95: Sequence[float | None], bounds: tuple[float, float], shortest: float) -> str:
    """Return the end, "least" or "most", of what a time may be, or readings resolve, that its interval reaches; empty where none.

    An end of the interval that is none is not told.
    """
    least, most = ci95
    if least is None or least <= max(bounds[0], shortest):
        return "least"
    return "most" if most is None or most >= bounds[1] else ""


def kind_of(effect: type[Effect]) -> str:
    """Return the kind of place that a bound effect acts on; empty where it was written in the names of one plant."""
    made_of = getattr(effect, "made_of", None)
    return made_of[0].acts_on if made_of else ""
