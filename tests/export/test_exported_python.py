"""The exported Python file, alone with numpy, against the compiled simulator: sticking, slipping, memory, sensors, a free curve."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from hjcamp.diagnosis.candidates.nonparametric_laws import ForceOverPosition
from hjcamp.effects import library_of
from hjcamp.known_plants import find_plant
from hjcamp.model.checks.plant_bench import SAMPLES, TESTS, Bench
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.plant import Plant
from hjcamp.model.export.python_file import Exported, python_file
from hjcamp.model.language.library import library_for
from hjcamp.model.run.simulator import Simulator

Alone = Callable[[str, list[dict[str, Any]]], list[dict[str, np.ndarray]]]
CLOSE = 1e-6


def equals_the_simulator(exported: Exported, alone: Alone, share: float = 1.0) -> dict[str, np.ndarray]:
    """Check three tests under inputs that step between rests; return the states that the simulator gives."""
    made, plant = exported.composition, exported.composition.plant
    simulator = Simulator(made, free=True)
    given = Bench(plant).given(simulator, share=share)
    readings, states = simulator.run_free(simulator.vector(dict(exported.values)), given)
    parts = [slice(k * SAMPLES, (k + 1) * SAMPLES) for k in range(TESTS)]
    tests = [
        {
            "inputs": {name: given.inputs[rows, place].tolist() for place, name in enumerate(made.inputs)},
            "start": dict(zip(plant.states, start.tolist(), strict=True)),
        }
        for rows, start in zip(parts, given.starts, strict=True)
    ]
    found = alone(python_file(exported), tests)
    wanted = dict(zip([*made.states, *made.measured], [*states.T, *readings.T], strict=True))
    for name, values in wanted.items():
        for rows, one in zip(parts, found, strict=True):
            assert np.abs(one[name] - values[rows]).max() <= CLOSE * max(np.ptp(values), 1e-300), name
    return dict(zip(made.states, states.T, strict=True))


def test_an_axis_that_sticks_and_slips_is_simulated_alike_where_numpy_is_alone(
    carriage: type[Plant], simulate_alone: Alone
) -> None:
    states = equals_the_simulator(Exported(Composition(carriage), {"coulomb": 40.0, "gain": 35.0}), simulate_alone)
    rests = states["velocity"] == 0.0
    assert 0.05 < rests.mean() < 0.95 and np.abs(np.diff(rests)).sum() > 10


@pytest.mark.study
def test_a_hydraulic_plant_is_simulated_alike(simulate_alone: Alone) -> None:
    friction = {
        f"{kind}_{side}": size for kind, size in (("static", 0.6), ("coulomb", 0.4)) for side in ("positive", "negative")
    }
    states = equals_the_simulator(Exported(Composition(find_plant("pump_joint")), friction), simulate_alone, share=8.0)
    rests = states["slider_velocity"] == 0.0
    assert 0.01 < 1.0 - rests.mean() < 0.95 and np.abs(np.diff(rests)).sum() > 4


@pytest.mark.study
def test_effects_with_a_memory_at_a_sensor_and_a_free_curve_go_along(carriage: type[Plant], simulate_alone: Alone) -> None:
    library = library_of(carriage)
    names = [
        name for name in library.effects if name.startswith(("static_friction_ageing", "sensor_lag", "presliding", "backlash"))
    ]
    assert len(names) >= 3
    [curve] = library_for(carriage, {"free_curve": ForceOverPosition}).effects.values()
    effects = (*(library.effects[name] for name in names if not name.startswith("presliding")), curve)
    values = {f"{curve.name}.knot_{k}": 30.0 * np.sin(k) for k in range(12)}
    values |= {f"{curve.name}.knots_from": -0.2, f"{curve.name}.knots_to": 0.2}
    equals_the_simulator(Exported(Composition(carriage, effects), values), simulate_alone)


def test_a_delay_is_that_of_the_layout_and_a_linear_input_acts_by_its_mean(
    carriage: type[Plant], simulate_alone: Alone
) -> None:
    source = python_file(Exported(Composition(carriage), {"coulomb": 1.0}, {"voltage": 0.0014}))
    assert "DELAYS = {'voltage': 0.0014}" in source
    volts = np.random.default_rng(5).normal(0.0, 10.0, 50)
    late = np.array([0.6 * volts[max(k - 1, 0)] + 0.4 * volts[max(k - 2, 0)] for k in range(50)])
    plain = python_file(Exported(Composition(carriage), {"coulomb": 1.0}))
    [one] = simulate_alone(source, [{"inputs": {"voltage": volts.tolist()}, "start": {}}])
    [other] = simulate_alone(plain, [{"inputs": {"voltage": late.tolist()}, "start": {}}])
    assert np.abs(one["position"] - other["position"]).max() <= 1e-12 * np.ptp(other["position"])
    means = 0.5 * (volts + np.append(volts[1:], volts[-1]))
    linear = plain.replace("LINEAR = ()", "LINEAR = ('voltage',)")
    assert linear != plain
    [one] = simulate_alone(linear, [{"inputs": {"voltage": volts.tolist()}, "start": {}}])
    [other] = simulate_alone(plain, [{"inputs": {"voltage": means.tolist()}, "start": {}}])
    assert np.abs(one["position"] - other["position"]).max() <= 1e-12 * np.ptp(other["position"])
