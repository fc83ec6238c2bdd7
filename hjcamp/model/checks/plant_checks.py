"""What a plant must be before anything is done with it: its equations are whole, fit in units, finite and passive."""

from __future__ import annotations

import functools
import types
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from hjcamp.errors import UsageError, counted, unknown
from hjcamp.model.compile.reaction import with_reactions
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.statement import Statement
from hjcamp.model.files.cached import cached
from hjcamp.model.files.user_file import is_users
from hjcamp.model.language.amount import dimension
from hjcamp.model.language.amount_formula import plain_functions
from hjcamp.model.language.equation_units import Units
from hjcamp.model.language.field_unit import FIELD_UNITS, field_of, unit_of_field
from hjcamp.model.language.vocabulary import read_vocabulary

DRAWS = 200
PUSHED = 20
# Push and rates are sums of the same terms.
ROUNDING = 1e-6
SEVERAL = 5.0
# A clock that was taken for one in s: its unit's size.
CLOCKS = {"ms": 1e-3, "us": 1e-6}
NEARLY = 0.1


def check_equations(plant: type[Plant]) -> str:
    """Refuse a state without a rate, a name with two meanings, and a rate of what is no state."""
    where = f"plant {plant.name}"
    vocabulary = read_vocabulary(plant)
    rates = {line.target for line in vocabulary.statements if line.mark == "rate"}
    for state in plant.states:
        if state not in rates:
            raise UsageError(f"{where}: the state '{state}' has no rate; write rate.{state} = ... in its equations")
    # a line may have the name of a state: what effects then read and change under that name is the line
    declared = {**plant.parameters, **plant.inputs}
    for line in vocabulary.statements:
        if line.mark != "rate" and line.target in declared:
            raise UsageError(
                f"{where}, line {line.line}: '{line.target}' is declared above; give the line another name (an element that is called "
                "NAME writes lines such as NAME_demand or NAME_capacity of its own: name='...' calls it otherwise)"
            )
    for group in (plant.states, plant.parameters, plant.inputs):
        for name in group:
            if sum(name in other for other in (plant.states, plant.parameters, plant.inputs)) > 1:
                raise UsageError(f"{where}: '{name}' is declared twice, as a state, parameter or input")
    lines, places = counted(len(vocabulary.statements), "line"), counted(len(vocabulary.ports), "place")
    return f"{counted(len(plant.states), 'state')}, {lines}, {places}"


def check_units_of(plant: type[Plant]) -> str:
    """Refuse a line whose unit does not fit; the message names the line."""
    units = Units(plant)
    units.follow(read_vocabulary(plant).statements)
    return f"{counted(len(read_vocabulary(plant).signals), 'line')} with units"


def check_measured(plant: type[Plant]) -> str:
    """Refuse a plant of which nothing is measured, a sensor that is no line, and a field in another unit."""
    where = f"plant {plant.name}"
    vocabulary = read_vocabulary(plant)
    if plant.channels:
        return counted(len(plant.channels), "channel")
    if not plant.measured:
        raise UsageError(f'{where}: nothing is measured; write FIELD_UNIT = Measured("SENSOR", of="STATE")')
    units = Units(plant)
    units.follow(vocabulary.statements)
    for name, item in plant.measured.items():
        if item.sensor not in vocabulary.signals:
            shown = item.of or "STATE"
            raise UsageError(
                f"{unknown('sensor', item.sensor, vocabulary.signals, f'{where}, {name}')}. A sensor is a line of the equations, "
                f"{item.sensor} = sensor(state.{shown})"
            )
        if item.of and item.of not in plant.states:
            hint = f"{where}, {name}: leave of= out where the sensor shows no state"
            raise unknown("state", item.of, plant.states, hint)
        field = unit_of_field(name, f"{where}, Measured", plant.states[item.of].unit if item.of else "")
        dims = units.value(item.sensor, where).dims
        if dimension(field.si) != dims:
            ends = [f"_{suffix}" for suffix, unit in FIELD_UNITS.items() if dimension(unit.si) == dims]
            fits = f"; names of such fields end in {' or '.join(ends)}" if ends else ""
            raise UsageError(f"{where}: '{name}' says {field.shown}, but '{item.sensor}' is in {units.written(dims)}{fits}")
    for name, source in plant.rates_of_inputs().items():
        unit, of = plant.inputs[name].unit, plant.inputs[source].unit
        if dimension(unit) != dimension(f"({of})/s"):
            raise UsageError(f"{where}: the input '{name}' is in {unit or '1'}, but the rate of '{source}' is in {of or '1'}/s")
    for name, given in plant.given_inputs().items():
        field = unit_of_field(given.field or field_of(name, given.unit, where), f"{where}, Input {name}", given.unit)
        if dimension(field.si) != dimension(given.unit):
            raise UsageError(
                f"{where}: the field '{given.field}' says {field.shown}, but the input '{name}' is in {given.unit or '1'}"
            )
    return counted(len(plant.measured), "channel")


def check_finite(plant: type[Plant]) -> str:
    """Refuse a plant with a rate that is not finite at ordinary states; the message names the line."""
    vocabulary = read_vocabulary(plant)
    for place in usual_places(plant):
        bad = _first_not_finite(plant, vocabulary.statements, place)
        if bad is not None:
            line, problem = bad
            states = ", ".join(f"{name} = {place[f's_{name}']:.4g}" for name in plant.states)
            raise UsageError(
                f"plant {plant.name}, line {line.line}: '{line.target} = {line.expression}' {problem} at {states}; "
                "hold what is under a root or logarithm in its range, with max(x, 0.0), keep what divides from 0, "
                "or give the state its low=..."
            )
    return f"{DRAWS} places"


def check_passive(plant: type[Plant]) -> str:
    """Refuse a contact whose friction drives the motion that it should brake."""
    vocabulary = read_vocabulary(plant)
    contacts = [port for port in vocabulary.ports.values() if port.kind == "contact"]
    for place in usual_places(plant):
        values = evaluate(plant, vocabulary.statements, place)
        for port in contacts:
            velocity, friction = values[f"s_{port.names['velocity']}"], values[port.names["friction"]]
            if velocity * friction < 0.0:
                raise UsageError(
                    f"plant {plant.name}: the friction of '{port.name}' is {friction:.3g} at a velocity of {velocity:.3g}: "
                    "it drives the motion instead of braking it (signs of coulomb and viscous?)"
                )
    _check_reached(plant)
    return counted(len(contacts), "contact")


def _check_reached(plant: type[Plant]) -> None:
    """Refuse a contact without a push whose friction does not brake its own velocity, or not in proportion."""
    vocabulary = read_vocabulary(plant)
    for place in usual_places(plant)[:PUSHED] if not vocabulary.pushed else ():
        for one in vocabulary.contacts:
            size = evaluate(plant, vocabulary.statements, place)[one.limit] or 1.0
            rates = []
            for times in (0.0, 1.0, 2.0):
                lines = [
                    replace(line, expression=f"({line.expression}) + {times * size!r}") if line.target == one.friction else line
                    for line in vocabulary.statements
                ]
                rates.append(evaluate(plant, tuple(lines), place)[f"d_{one.velocity}"])
            gain, bend = rates[1] - rates[0], rates[2] - 2.0 * rates[1] + rates[0]
            where = f"plant {plant.name}: the friction of '{one.name}'"
            if abs(gain) <= ROUNDING * max(map(abs, rates)):
                raise UsageError(f"{where} does not reach rate.{one.velocity}: subtract it from the force there")
            if abs(bend) > ROUNDING * max(map(abs, rates)):
                raise UsageError(
                    f"{where} enters rate.{one.velocity} other than in proportion: what holds it cannot be found; "
                    "give each contact its push"
                )
            if gain > 0.0:
                raise UsageError(f"{where} speeds up '{one.velocity}': it is added to the force; subtract it")


def check_pushes(plant: type[Plant]) -> str:
    """Refuse a contact whose push is not what would hold it, by the rates of all contacts, whether the others rub or are held."""
    vocabulary = read_vocabulary(plant)
    contacts, unheld = vocabulary.contacts, vocabulary.unheld
    if not vocabulary.pushed or not unheld:
        return "found from the rates" if unheld else "no contacts"
    # what comes from outside, as an effect may bring it, must be in both
    loads = {port.names.get("force") for port in vocabulary.ports.values() if port.kind == "body"}
    acting = [replace(one, expression="1.0") if one.target in loads else one for one in vocabulary.statements]
    lines = [f"{'d_' * (one.mark == 'rate')}{one.target} = {one.expression}" for one in acting]
    found, told = compile("\n".join(with_reactions(lines, contacts, unheld)), "<plant>", "exec"), False
    for place in usual_places(plant)[:PUSHED]:
        for sides in product((0.0, 1.0, -1.0), repeat=len(contacts)):
            here = dict(place)
            for one, side in zip(contacts, sides, strict=True):
                here[f"u_{one.direction}"], here[f"s_{one.velocity}"] = side, side * abs(place[f"s_{one.velocity}"])
            scope = plain_functions("") | here
            try:
                given = evaluate(plant, tuple(acting), here)
                exec(found, scope)
                told = True
            except (ArithmeticError, ValueError):  # rates that say themselves what is held tell nothing
                continue
            for one, side in zip(contacts, sides, strict=True):
                wrong, size = abs(given[one.push] - scope[one.push]), max(abs(scope[one.push]), given[one.limit])
                if side == 0.0 and wrong > ROUNDING * size:
                    raise UsageError(
                        f"plant {plant.name}: the push of contact '{one.name}' is {given[one.push]:.3g} where "
                        f"{scope[one.push]:.3g} would hold it, by the rates (outside forces 1): leave push= out of every "
                        "contact, and it is found from them"
                    )
    return f"what holds {counted(len(contacts), 'contact')}" if told else "not told by rates that say themselves what is held"


CHECKS: dict[str, Callable[[type[Plant]], str]] = {
    "equations are whole": check_equations,
    "units": check_units_of,
    "something is measured": check_measured,
    "finite": check_finite,
    "friction brakes": check_passive,
}


def check_plant(plant: type[Plant]) -> None:
    """Refuse a plant that fails one of the checks that need no simulation."""
    for check in CHECKS.values():
        check(plant)


@cached
def check_users_plant(plant: type[Plant]) -> None:
    """Refuse a plant of a user's file as `check_plant` does, which is done once; those of the package are tested."""
    if is_users(plant.__module__):
        check_plant(plant)


def other_period(plant: type[Plant], period: float) -> str:
    """Return a note where logs are sampled several times faster or slower than the plant says; empty where they are not."""
    if 1.0 / SEVERAL <= period / plant.period <= SEVERAL:
        return ""
    times = period / plant.period
    declared = "period" in {name for one in plant.__mro__[: plant.__mro__.index(Plant)] for name in vars(one)}
    fits = [unit for unit, size in CLOCKS.items() if declared and abs(size * times - 1.0) < NEARLY]
    asked = f" (is the unit of time_s {fits[0]}?)" if fits else ""
    return (
        f"plant {plant.name}: the logs have one sample each {period:g} s, the plant says {plant.period:g} s{asked}: they are "
        f"analysed as they are; write 'period = {period:g}' in addition to its parameters, so that it is simulated the same"
    )


@functools.cache
def _code(expression: str) -> types.CodeType:
    return compile(expression, "<plant>", "eval")


def evaluate(plant: type[Plant], statements: tuple[Statement, ...], place: dict[str, float]) -> dict[str, Any]:
    """Return every name of the equations at one place, as plain Python computes them."""
    scope = plain_functions("") | place
    for line in statements:
        scope["d_" + line.target if line.mark == "rate" else line.target] = eval(_code(line.expression), scope)
    return scope


def _first_not_finite(
    plant: type[Plant], statements: tuple[Statement, ...], place: dict[str, float]
) -> tuple[Statement, str] | None:
    scope = plain_functions("") | place
    for line in statements:
        try:
            value = float(eval(_code(line.expression), scope))
        except (ArithmeticError, ValueError, TypeError) as problem:
            return line, f"cannot be computed ({problem})"
        if not np.isfinite(value):
            return line, f"is {value}"
        scope["d_" + line.target if line.mark == "rate" else line.target] = value
    return None


def usual_places(plant: type[Plant]) -> list[dict[str, float]]:
    """Return ordinary states, inputs and parameters by their names in the lines; contacts move as their velocity says."""
    generator = np.random.default_rng(20090404)
    vocabulary = read_vocabulary(plant)
    found = []
    for _ in range(DRAWS):
        place = {f"s_{name}": state.usual(generator) for name, state in plant.states.items()}
        place |= {f"u_{name}": given.usual(generator) for name, given in plant.inputs.items()}
        place |= {f"p_{name}": item.default for name, item in plant.parameters.items()}
        for port in vocabulary.ports.values():
            if port.kind == "contact":
                place[f"u_{port.names['direction']}"] = float(np.sign(place[f"s_{port.names['velocity']}"]))
        found.append(place)
    return found
