"""Every law of every plant composes and gives numbers, also where slots, states, inputs and parameters share names."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hjcamp.diagnosis.candidates.nonparametric_terms import unknowns_of, values_of
from hjcamp.effects import load_effects
from hjcamp.errors import UsageError
from hjcamp.known_plants import load_plants, plant_called
from hjcamp.model.compile.compose import MOST_GATED, Composition
from hjcamp.model.compile.function_sources import rates_source, terms_source
from hjcamp.model.compile.source_text import GATES
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.own_names import OF_EFFECTS, OF_LAWS
from hjcamp.model.declare.plant import ALWAYS, Plant
from hjcamp.model.language.amount_formula import MATHEMATICS, plain_functions
from hjcamp.model.language.effect_names import BUILTINS
from hjcamp.model.language.equation_units import MARKS, MODULES
from hjcamp.model.language.vocabulary import TAKEN, read_vocabulary

VESSEL = '''"""A vessel whose slots are called like its states and its input."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, signal, slot, store


class Vessel(Plant):
    """A vessel whose slots are called like its states and its input."""

    pressure = State("Pa", typical=1e5)
    heat = State("K", typical=10.0)
    flow = Input("m^3/s", typical=1e-4)
    capacity = Parameter("m^3/Pa", 1e-9, base=True)
    outlet = Parameter("m^3/s/Pa", 1e-10, base=True)
    leakage_conductance = Parameter("m^3/s/Pa", 1e-11, base=True)
    warming = Parameter("K/Pa/s", 1e-5, base=True)
    period = 0.01
    pressure_pa = Measured("gauge", of="pressure")

    @staticmethod
    def equations(state, parameter, drive, rate):
        valve = slot(parameter.outlet * state.pressure + parameter.leakage_conductance * state.pressure, "m^3/s")
        pressure = slot(limited(state.pressure, 0.0, 1e7), "Pa")
        flow = slot(drive.flow, "m^3/s")
        heat = signal(2.0 * state.heat, "K")
        rate.pressure = store(flow - valve, capacity=parameter.capacity)
        rate.heat = parameter.warming * pressure
        gauge = sensor(pressure)
'''


@pytest.fixture
def vessel(folder: Path) -> type[Plant]:
    (folder / "plants" / "vessel.py").write_text(VESSEL)
    return plant_called("vessel", "here")


def laws_of(plant: type[Plant]) -> dict[str, type[Effect]]:
    """Every named effect, every non-parametric term and every parameter over every state and input that fits a plant."""
    names = {*plant.states, *plant.inputs, *Composition(plant).vocabulary.signals, "time"}
    ranges = dict.fromkeys(names, (-1.0, 2.0))
    unknown = unknowns_of(plant, ranges) | values_of(plant, plant.parameters, ranges)
    return {**load_effects(plant=plant), **{name: one.effect for name, one in unknown.items()}}


def rates_at(composition: Composition) -> Callable[[dict[str, float]], np.ndarray]:
    """The rates at usual states over changed parameters by the composed source, as plain Python."""
    rates = plain_functions(f"{terms_source(composition)}\n{rates_source(composition)}")["rates"]
    z = np.array([0.5 * one.typical for one in composition.states.values()])
    inputs = composition.plant.inputs
    u = np.array([inputs[name].typical if name in inputs else 0.0 for name in composition.inputs])

    def call(changed: dict[str, float]) -> np.ndarray:
        p = np.array([changed.get(name, one.default) for name, one in composition.parameters.items()])
        found = np.full(len(z), np.nan)
        rates(-1, 0.1, 1.0, z, u, p, found)
        return found

    return call


def rates_behind_gates(plant: type[Plant]) -> Counter[tuple[float, ...]]:
    """The rates with each law alone, from one composition that has all of them behind gates; no name changes their order."""
    laws = tuple(laws_of(plant).values())
    assert len(laws) <= MOST_GATED
    rates = rates_at(composition := Composition(plant, laws, gated=True))
    found = [rates({f"gate.{law.name}": 1.0, GATES: float(1 << place)}).tolist() for place, law in enumerate(laws)]
    own = len(Composition(plant).states)
    assert len(composition.states) > own and np.isfinite([row[:own] for row in found]).all()
    # the states of the other laws have no rates
    return Counter((*row[:own], *sorted(one for one in row[own:] if np.isfinite(one))) for row in found)


def check_every_law(plant: type[Plant]) -> None:
    """Each law gives finite rates by itself and behind a gate, and the plant's own rates where its gate is shut."""
    base = rates_at(Composition(plant))({})
    for name, law in laws_of(plant).items():
        gated = rates_at(Composition(plant, (law,), gated=True))
        alone = rates_at(Composition(plant, (law,)))({})
        assert np.isfinite(alone).all(), name
        assert np.array_equal(gated({f"gate.{name}": 1.0, GATES: 1.0}), alone), name
        assert np.array_equal(gated({})[: len(base)], base), name


WORDS = sorted(
    TAKEN
    | OF_LAWS
    | OF_EFFECTS
    | {*BUILTINS, *MATHEMATICS, *MARKS, *MODULES, "state", "parameter", "rate", "limited", "d_x", "next_x", "start_x"}
)
KINDS_OF_NAMES = {"state": "heat", "parameter": "warming", "input": "volume", "slot": "valve"}


def renamed(folder: Path, number: int, names: dict[str, str]) -> type[Plant]:
    """The vessel with other names for what is declared and computed."""
    text = VESSEL.replace("flow = Input", "volume = Input").replace("drive.flow", "drive.volume")
    for kind in names:
        old = KINDS_OF_NAMES[kind]
        text = (
            re.sub(rf"\b{old}\b", f"_{kind}_", text)
            if kind != "state"
            else re.sub(rf"(?<=state\.|.rate\.){old}\b|\b{old}(?= = State)", f"_{kind}_", text)
        )
    for kind, name in names.items():
        text = text.replace(f"_{kind}_", name)
    (folder / "plants" / f"vessel{number}.py").write_text(text.replace("class Vessel", f"class Vessel{number}"))
    return plant_called(f"vessel{number}", "here")


def test_a_word_of_the_vocabulary_is_refused_with_a_free_one_or_works(folder: Path) -> None:
    allowed: dict[str, list[str]] = {}
    for k, (kind, place) in enumerate(itertools.product(KINDS_OF_NAMES, range(len(WORDS)))):
        try:
            read_vocabulary(renamed(folder, k, {kind: WORDS[place]}))
        except UsageError as error:
            assert f"'{WORDS[place]}'" in str(error) and "call this" in str(error), error
            if "such as" in str(error):
                free = str(error).rpartition("such as '")[2].rstrip("'")
                read_vocabulary(renamed(folder, 10000 + k, {kind: free}))
        else:
            allowed.setdefault(kind, []).append(WORDS[place])
    for kind, words in allowed.items():
        assert OF_LAWS.isdisjoint(words), kind
    # every allowed word in every role, four of them at once: no number hangs on a name
    expected = rates_behind_gates(renamed(folder, 19999, {"state": "warmth", "parameter": "pace_of_it", "slot": "tap"}))
    count = max(map(len, allowed.values()))
    for k in range(count):
        names = {kind: words[(k + 7 * shift) % len(words)] for shift, (kind, words) in enumerate(allowed.items())}
        if len(set(names.values())) == len(names):
            found = rates_behind_gates(renamed(folder, 20000 + k, names))
            # laws over a state and over an input of one name are one
            merged = not set(ALWAYS).isdisjoint(names.values())
            assert found == expected or (merged and found < expected), names


@pytest.mark.parametrize("name", sorted(load_plants([])))
def test_every_law_of_a_shipped_plant_gives_numbers(name: str) -> None:
    check_every_law(load_plants([])[name])


def test_every_law_gives_numbers_where_slots_are_called_like_states(vessel: type[Plant]) -> None:
    check_every_law(vessel)
