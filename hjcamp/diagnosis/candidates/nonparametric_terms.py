"""The unknowns that a plant can have, at each of its places, over the range that the tests visit."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.candidates import nonparametric_laws as unknown_laws
from hjcamp.diagnosis.candidates.nonparametric_laws import APART, ENDS, amplitudes_of_law, gain_over, over_time_of_each
from hjcamp.errors import UsageError
from hjcamp.model.compile.source_text import names_in
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.port import Port
from hjcamp.model.language.amount_formula import plain_functions
from hjcamp.model.language.binding import bind
from hjcamp.model.language.vocabulary import read_vocabulary

Array = NDArray[np.float64]
LOOKED_AT = 400
# The slot whose gain may change at a place of a kind, and what it is so many times of.
TIMES = {"actuator": ("command", "demand"), "path": ("flow", "flow"), "store": ("capacity", "capacity")}
# The slots of a contact in which its friction is.
RUBS = ("static", "coulomb", "viscous")
# What is a share of its slot's own value.
SHARES = ("gain", "capacity", "stiffness", "value")
# What repeats along a travel is looked for over the whole of it, of an angle that goes round more often within a turn.
FINE = (unknown_laws.FineForceOverPosition, unknown_laws.TurningForceOverPosition)
TURN, MOST_TURNS = 2.0 * np.pi, 2.0
# What is a law of its slot's value as that arrives.
BENT = ("command", "reading")


def times_of(port: Port) -> tuple[str, str]:
    """Return the plant's names of the slot whose gain may change at a place, and of what it is so many times of."""
    slot, times = (name if name in port.names else "stiffness" for name in TIMES[port.kind])
    return port.names[slot], port.names[times]


@dataclass(frozen=True)
class Unknown:
    """An unknown at one place: its effect, the plant's name of what drives it, or one less another, and its range in the tests, SI.

    ``levels`` are the values of what drives it where it has no more of them than the law has knots: between these nothing is told.
    One that ``turns`` repeats from end to end. Over time it may have a course of its own in each condition, all of them on one axis,
    so far ``apart``, s.
    """

    effect: type[Effect]
    place: str
    quantity: str
    driver: str
    signal: str
    low: float
    high: float
    usual: float
    levels: tuple[float, ...] = ()
    turns: bool = False
    apart: float = 0.0

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """The names of its parameters that are fitted."""
        return amplitudes_of_law(self.effect)

    @property
    def ends(self) -> dict[str, float]:
        """The values of its parameters that are not fitted: from where to where its knots stand."""
        return dict(zip(ENDS, (self.low, self.high), strict=True)) | ({APART: self.apart} if self.apart else {})

    def amount(self, value: Any) -> Any:
        """Return what an amplitude stands for: itself, or the share by which a positive law changes its slot."""
        return value + np.hypot(1.0, value) - 1.0 if getattr(self.effect, "positive", False) else value

    def over(self, value: float) -> float:
        """Return what drives it, SI, where it has knots: within its turn where it repeats."""
        return self.low + (value - self.low) % (self.high - self.low) if self.turns else value

    @property
    def driven_by(self) -> str:
        """What drives it, as answers call it: of its place, or of the whole plant."""
        return self.driver if self.driver == "time" or self.quantity in ("gain", "value") else f"{self.place}_{self.driver}"

    @property
    def what(self) -> str:
        """What it gives a law, in words."""
        said = f"change of {self.place}" if self.quantity == "value" else f"{self.quantity} at {self.place}"
        return said.replace("_", " ")


def unknowns_of(
    plant: type[Plant], ranges: Mapping[str, tuple[float, float]], courses: Mapping[str, Array] | None = None
) -> dict[str, Unknown]:
    """Return every unknown that fits the plant, by name; those whose driver hardly moves in the tests are left out.

    ``courses`` say which drivers have few values.
    """
    return _bound(plant, unknown_laws.LAWS, ranges, courses or {}) | _gains(plant, ranges)


def possible_laws(plant: type[Plant]) -> dict[str, type[Effect]]:
    """Return every law that `unknowns_of` and `values_of` a plant may give, by name, wherever tests go.

    A kernel that has them serves all tests of the plant.
    """
    vocabulary = read_vocabulary(plant)
    levels = [port.names["level"] for port in vocabulary.ports.values() if "level" in port.names]
    driven = {*vocabulary.signals, *plant.states, *plant.inputs, "time", *(f"{a} - {b}" for a in levels for b in levels)}
    # what repeats has one law within few turns, and another one beyond
    found = [unknowns_of(plant, dict.fromkeys(driven, (-reach, reach))) for reach in (1.0, TURN * MOST_TURNS)]
    found.append(values_of(plant, plant.base_parameters, dict.fromkeys(driven, (-1.0, 1.0))))
    return {name: one.effect for each in found for name, one in each.items()}


def _bound(
    plant: type[Plant], laws: Iterable[type[Effect]], ranges: Mapping[str, tuple[float, float]], courses: Mapping[str, Array]
) -> dict[str, Unknown]:
    """Return the unknowns that laws are at the places of a plant, by name."""
    found = {}
    for law in laws:
        words = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", law.__name__).lower()
        law.name = f"unknown_{words}"
        quantity, driver = words.removeprefix("fine_").removeprefix("turning_").removesuffix("_of_each").split("_over_")
        try:
            bound = bind(law, plant)
        except UsageError:
            continue
        for effect in bound:
            port = _port(plant, law, effect)
            signal = next(
                (name for term in effect.terms.values() for name in term.arguments if _drives(term, name, driver)),
                port.names.get(driver, driver),
            )
            course = courses.get(signal, np.zeros(0))
            if law.acts_on == "partition":
                one, beyond = (port.names[level] for level in ("level", "level_beyond"))
                signal, course = f"{one} - {beyond}", _difference(courses, one, beyond)
                ranges = {**ranges, **ranges_of({signal: course})}
            low, high = ranges.get(signal, (0.0, 0.0))
            if law in FINE:
                turns = effect.parameters[ENDS[0]].unit == "rad" and high - low > MOST_TURNS * TURN
                if (law is not unknown_laws.FineForceOverPosition) != turns:
                    continue
                low, high, course = (0.0, TURN, np.zeros(0)) if turns else (low, high, course)
            if high - low > 1e-9 * max(abs(low), abs(high)):
                usual = ranges.get(port.size_of(getattr(law, "sized", next(iter(law.terms)))), (0.0, 1.0))
                size = max(abs(usual[0]), abs(usual[1])) or 1.0
                levels = _levels(course, low, high, len(amplitudes_of_law(effect)))
                found[effect.name] = Unknown(
                    effect, port.name, quantity, driver, signal, low, high, size, levels, law is FINE[1]
                )
    return found


def _gains(plant: type[Plant], ranges: Mapping[str, tuple[float, float]]) -> dict[str, Unknown]:
    """Return the unknowns of drives whose gain depends on a state or on time, of paths that clog, and of stores that soften."""
    found = {}
    states = {name: item.unit for name, item in plant.states.items()}
    for port in read_vocabulary(plant).ports.values():
        if port.kind not in TIMES:
            continue
        slot, times = times_of(port)
        own = {port.names["level"]: states[port.names["level"]]} if port.kind == "store" else {"time": "s"}
        for driver, unit in {**(states if port.kind == "actuator" else {}), **own}.items():
            low, high = ranges.get(driver, (0.0, 0.0))
            if high - low > 1e-9 * max(abs(low), abs(high)):
                subsystem = next(iter(plant.subsystems), "gain")
                law = gain_over(plant.name, slot, times, driver, unit, positive=port.kind == "store", subsystem=subsystem)
                of_store = ("capacity" if "capacity" in port.names else "stiffness", "level")
                what, of = of_store if port.kind == "store" else ("gain", driver)
                found[law.name] = Unknown(law, port.name, what, of, driver, low, high, 1.0)
    return found


def courses_of_each(
    plant: type[Plant], conditions: int, knots: int, longest: float, ranges: Mapping[str, tuple[float, float]]
) -> dict[str, Unknown]:
    """Return the unknowns of bodies and stores over time with a course of its own in each condition, of so many ``knots``, by name.

    ``longest`` is how long the longest test lasts, s.
    """
    apart = longest * knots / (knots - 1)
    axis = {**ranges, "time": (0.0, apart * conditions - longest / (knots - 1))}
    found = _bound(plant, over_time_of_each(conditions * knots), axis, {})
    return {name: replace(one, apart=apart) for name, one in found.items()}


def values_of(plant: type[Plant], parameters: Iterable[str], ranges: Mapping[str, tuple[float, float]]) -> dict[str, Unknown]:
    """Return the unknowns of parameters that are no constants: each over every state and input, and over time, by name.

    What a contact rubs with has laws of its own over where and how fast it is, and over time.
    """
    vocabulary, found = read_vocabulary(plant), {}
    drivers = {name: item.unit for group in (plant.states, plant.inputs) for name, item in group.items()} | {"time": "s"}
    lines = {one.target: one.expression for one in vocabulary.statements}
    subsystem = next(iter(plant.subsystems), "parameter")
    for name in parameters:
        if name not in vocabulary.changeable:
            continue
        contacts = [
            port
            for port in vocabulary.ports.values()
            if port.kind == "contact"
            and f"p_{name}" in names_in(" ".join(lines.get(port.names.get(slot, ""), "") for slot in RUBS))
        ]
        known = {port.names.get(local, "") for port in contacts for local in ("velocity", "travel", "load")}
        known |= {"time"} if contacts else set()
        for driver, unit in drivers.items():
            low, high = ranges.get(driver, (0.0, 0.0))
            if driver not in known and high - low > 1e-9 * max(abs(low), abs(high)):
                positive = plant.parameters[name].bounds[0] >= 0.0
                law = gain_over(plant.name, name, name, driver, unit, positive=positive, of="value", subsystem=subsystem)
                found[law.name] = Unknown(law, name, "value", driver, driver, low, high, 1.0)
    return found


def _levels(course: Array, low: float, high: float, most: int) -> tuple[float, ...]:
    """Return the values of a course within its range where it has few, at least two and no more than ``most``."""
    finite = np.clip(course[np.isfinite(course)], low, high)
    size = float(np.abs(finite).max(initial=0.0)) or 1.0
    found = np.unique(np.round(finite / size, 9)) * size
    return tuple(float(one) for one in found) if 2 <= len(found) <= most else ()


def _difference(courses: Mapping[str, Array], one: str, other: str) -> Array:
    """Return by how much one course is above another one, which were seen at the same places."""
    both = [courses.get(name, np.zeros(0)) for name in (one, other)]
    return both[0] - both[1] if len(both[0]) == len(both[1]) else np.zeros(0)


def _drives(term: Any, name: str, driver: str) -> bool:
    return bool(dict(term.names).get(driver, driver) == name)


def _port(plant: type[Plant], law: type[Effect], effect: type[Effect]) -> Port:
    """Return the place on which a bound law acts."""
    ports = [port for port in read_vocabulary(plant).ports.values() if port.kind == law.acts_on]
    return next(port for port in ports if {port.names.get(slot) for slot in law.terms} <= set(effect.terms))


def courses_of(plant: type[Plant], values: Mapping[str, float], states: Array, inputs: Array, time: Array) -> dict[str, Array]:
    """Return every signal and state at some hundred places along ``states`` (n, states), SI."""
    vocabulary = read_vocabulary(plant)
    # lines may read a rate that is given above them
    lines = [
        (f"d_{one.target}" if one.mark == "rate" else one.target, compile(one.expression, "<plant>", "eval"))
        for one in vocabulary.statements
    ]
    rates = {f"d_{one.target}" for one in vocabulary.statements if one.mark == "rate"}
    regimes = {
        f"u_{port.names['direction']}": port.names.get("velocity", "")
        for port in vocabulary.ports.values()
        if "direction" in port.names
    }
    names = [name for name in plant.inputs if name not in ("time", "direction")]
    rows = np.unique(np.linspace(0, len(states) - 1, LOOKED_AT).astype(int))
    seen: dict[str, list[float]] = {}
    for row in rows:
        scope: dict[str, Any] = plain_functions("") | {
            f"p_{name}": values.get(name, item.default) for name, item in plant.parameters.items()
        }
        own = {name: float(states[row, k]) for k, name in enumerate(plant.states)}
        scope |= {f"s_{name}": value for name, value in own.items()}
        scope |= {f"u_{name}": float(inputs[row, k]) for k, name in enumerate(names)}
        scope |= {name: float(np.sign(own.get(velocity, 1.0))) for name, velocity in regimes.items()}
        scope |= {"u_time": float(time[row])}
        scope.setdefault("u_direction", 1.0)
        with suppress(ArithmeticError, ValueError):
            for name, code in lines:
                scope[name] = eval(code, scope)
                if name not in rates:
                    seen.setdefault(name, []).append(float(scope[name]))
        for name, value in own.items():
            seen.setdefault(name, []).append(value)
    return {name: np.array(values) for name, values in seen.items()}


def ranges_of(courses: Mapping[str, Array], time: Array | None = None) -> dict[str, tuple[float, float]]:
    """Return the range (1st to 99th percentile) of every course, SI, and that of the time where it is given."""
    found = {}
    for name, all_of in courses.items():
        finite = all_of[np.isfinite(all_of)]
        if len(finite):
            found[name] = (float(np.percentile(finite, 1.0)), float(np.percentile(finite, 99.0)))
    if time is not None:
        found["time"] = (float(time.min()), float(time.max()))
    return found
