"""Every law of every plant composes and gives numbers, also where slots, states, inputs and parameters share names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hjcamp.diagnosis.candidates.nonparametric_terms import unknowns_of, values_of
from hjcamp.effects import load_effects
from hjcamp.known_plants import load_plants, plant_called
from hjcamp.model.compile.compose import Composition, term_functions
from hjcamp.model.compile.function_sources import rates_source
from hjcamp.model.compile.source_text import copied_function
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.amount_formula import plain_functions

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


def rates_of(composition: Composition, changed: dict[str, float]) -> np.ndarray:
    """The rates at usual states by the composed source, as plain Python."""
    source = "".join(copied_function(name, one) for name, one in term_functions(composition.effects).items())
    rates = plain_functions(source + rates_source(composition))["rates"]
    z = np.array([0.5 * one.typical for one in composition.states.values()])
    p = np.array([changed.get(name, one.default) for name, one in composition.parameters.items()])
    found, inputs = np.full(len(z), np.nan), composition.plant.inputs
    u = np.array([inputs[name].typical if name in inputs else 0.0 for name in composition.inputs])
    rates(-1, 0.1, 1.0, z, u, p, found)
    return found


def check_every_law(plant: type[Plant]) -> None:
    """Each law gives finite rates by itself and behind a gate, and the plant's own rates where its gate is shut."""
    base = rates_of(Composition(plant), {})
    for name, law in laws_of(plant).items():
        composition = Composition(plant, (law,), gated=True)
        opened = {f"gate.{name}": 1.0, "gates": 1.0}
        alone = rates_of(Composition(plant, (law,)), {})
        assert np.isfinite(alone).all(), name
        assert np.array_equal(rates_of(composition, opened), alone), name
        assert np.array_equal(rates_of(composition, {})[: len(base)], base), name


@pytest.mark.parametrize("name", sorted(load_plants([])))
def test_every_law_of_a_shipped_plant_gives_numbers(name: str) -> None:
    check_every_law(load_plants([])[name])


def test_every_law_gives_numbers_where_slots_are_called_like_states(vessel: type[Plant]) -> None:
    check_every_law(vessel)
