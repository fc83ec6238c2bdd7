"""Check that an effect fits a plant: its slots, the names that it uses, their order, and what its methods call."""

from __future__ import annotations

import math

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.effect import Effect, Term
from hjcamp.model.declare.part import whole_code
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.amount_formula import MATHEMATICS
from hjcamp.model.language.term_checks import check_calls
from hjcamp.model.language.vocabulary import read_vocabulary

BUILTINS = ("abs", "min", "max", "float", "int")


def check_effect(effect: type[Effect], plant: type[Plant]) -> None:
    """Refuse an effect that does not fit the plant, or with a method that is no formula of numbers."""
    check_names(effect, plant)
    check_functions(effect)


def check_names(effect: type[Effect], plant: type[Plant]) -> None:
    """Refuse an effect whose slots, arguments or order do not fit the plant, with the nearest allowed name."""
    vocabulary = read_vocabulary(plant)
    where = f"effect {effect.name or effect.__name__}"
    if effect.acts_on:
        raise UsageError(f"{where}: acts on every {effect.acts_on}; bind it to a place of plant {plant.name} first")
    if plant.subsystems and effect.subsystem not in plant.subsystems:
        raise unknown("subsystem", effect.subsystem, plant.subsystems, where)
    everywhere = {*effect.states, *effect.parameters, *plant.states, *plant.parameters, *plant.inputs}
    everywhere |= {port.names["direction"] for port in vocabulary.ports.values() if "direction" in port.names}
    for slot, term in effect.terms.items():
        if slot not in (*vocabulary.slots, *vocabulary.changeable):
            raise unknown("slot", slot, [*vocabulary.slots, *vocabulary.changeable], where)
        # a parameter is changed before the first line
        before = {*vocabulary.known_before(slot), slot} if slot in vocabulary.slots else {slot}
        for argument in term.arguments:
            if argument in everywhere or argument in before:
                continue
            if argument in vocabulary.signals:
                what = "slot" if slot in vocabulary.slots else "parameter"
                raise UsageError(
                    f"{where}: term '{slot}' uses '{argument}', which is computed later than the {what} '{slot}'. "
                    f"Allowed there: {', '.join(sorted(before | everywhere))}"
                )
            raise unknown("name", argument, before | everywhere, f"{where}, term '{slot}'")
    for prefix, group in (("d_", effect.rates), ("next_", effect.updates), ("start_", effect.starts)):
        for own, term in group.items():
            for argument in term.arguments:
                allowed = everywhere | set(vocabulary.signals)
                if argument not in allowed:
                    raise unknown("name", argument, allowed, f"{where}, method '{prefix}{own}'")


def check_functions(effect: type[Effect]) -> None:
    """Refuse an effect with a method that calls what a kernel cannot, or that gives no number."""
    where = f"effect {effect.name or effect.__name__}"
    for term in (*effect.terms.values(), *effect.rates.values(), *effect.updates.values(), *effect.starts.values()):
        _check_globals(term, where)
    check_calls(effect, tuple(MATHEMATICS))  # type: ignore[arg-type]


def _check_globals(term: Term, where: str) -> None:
    for name in whole_code(term.function).co_names:
        if name not in MATHEMATICS and name not in BUILTINS:
            raise unknown(
                "argument, function or constant",
                name,
                [*term.arguments, *MATHEMATICS, *BUILTINS, "part"],
                f"{where}, method '{term.function.__name__}'",
            )


assert all(hasattr(math, name) for name in MATHEMATICS)
