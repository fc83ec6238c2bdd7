"""Check the units of an effect: every function is called with amounts that carry their dimension."""

from __future__ import annotations

import random
from collections.abc import Mapping
from contextlib import nullcontext
from typing import Any

from hjcamp.errors import UsageError
from hjcamp.model.declare.effect import Effect, Term
from hjcamp.model.declare.plant import Plant
from hjcamp.model.files.time_limit import time_limit
from hjcamp.model.files.user_file import is_users
from hjcamp.model.language import term_checks
from hjcamp.model.language.amount import Amount, dimension
from hjcamp.model.language.amount_formula import with_amounts
from hjcamp.model.language.effect_names import check_effect
from hjcamp.model.language.vocabulary import read_vocabulary

DRAWS = 12


def check_units(effect: type[Effect], plant: type[Plant]) -> None:
    """Refuse an effect whose functions do not give the unit of their slot or state, or that mixes units on the way.

    A number in a sum or comparison takes the unit of the other side; in a product it is a pure number, except
    9.81 (m/s^2) and 101325 (Pa).
    """
    check_effect(effect, plant)
    where = f"effect {effect.name or effect.__name__}"
    units, theirs = _units(effect, plant, where), is_users(effect.__module__)
    slots = read_vocabulary(plant).slots
    expected = [
        (name, function, slots[name].unit, "the slot is in")
        if name in slots
        else (name, function, plant.parameters[name].unit, "the parameter is in")
        for name, function in effect.terms.items()
    ]
    groups = (("d_", effect.rates, "/s"), ("next_", effect.updates, ""), ("start_", effect.starts, ""))
    for prefix, group, suffix in groups:
        for state, function in group.items():
            unit = effect.states[state].unit
            whole = f"({unit}){suffix}" if unit != "1" else f"1{suffix}"
            expected.append((f"{prefix}{state}", function, whole, "it must be in"))
    for name, function, unit, said in expected:
        # A user's loop may go on for ever at amounts although it ends at numbers.
        limit = time_limit(term_checks.LOOKING_S, f"{where}, method '{name}'") if theirs else nullcontext()
        with limit:
            _check_function(function, unit, units, f"{where}, method '{name}'", said)


def _units(effect: type[Effect], plant: type[Plant], where: str) -> dict[str, str]:
    units = {name: line.unit for name, line in read_vocabulary(plant).signals.items()}
    groups: tuple[Mapping[str, Any], ...] = (plant.inputs, plant.parameters, plant.states)
    for group in groups:
        units.update({name: item.unit for name, item in group.items() if name not in units})
    units |= {port.names["direction"]: "1" for port in read_vocabulary(plant).ports.values() if "direction" in port.names}
    own: dict[str, Any] = {**effect.parameters, **effect.states}
    for name, item in own.items():
        try:
            dimension(item.unit)
        except UsageError as problem:
            raise UsageError(f"{where}: '{name}': {problem}") from None
        units[name] = item.unit
    return units


def _check_function(term: Term, unit: str, units: dict[str, str], where: str, said: str) -> None:
    names = term.arguments
    callable_ = with_amounts(term.function)
    generator = random.Random(1)
    for _ in range(DRAWS):
        given = [Amount(generator.uniform(0.1, 2.0) * generator.choice((-1, 1)), dimension(units[name])) for name in names]
        try:
            result = Amount.of(callable_(*given))
        except UsageError as problem:
            raise UsageError(f"{where}: {problem}") from None
        except (ArithmeticError, ValueError):
            continue
        # A bare 0.0 fits every slot.
        if result.dims != dimension(unit) and not (result.literal and result.value == 0.0):
            raise UsageError(f"{where} gives {result.dims}, but {said} {unit} = {dimension(unit)}")
