"""The short way for a whole sample on which only the linear part acts: the same bits as the long one."""

from pathlib import Path

import numpy as np
import pytest
from plain_kernel import uncompiled
from plant_texts import SLAB
from quiet_loop import columns, simulator, sine

from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant
from hjcamp.model.compile import kernel
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.course import Given
from hjcamp.model.run.simulator import Simulator
from hjcamp.plants.pump_joint.loop import JointSimulator

PRESSURES = (0.32e6, 0.14e6)


def test_whole_samples_are_moved_as_in_steps(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    reference = sine(120.0, 2.0, 0.4)
    # a low speed limit: the limiter acts in some samples and not in others
    for values in ({}, {"pump_speed_limit": 0.02}):
        short = columns(reference, PRESSURES, values=values)
        assert "GLIDES = True" in simulator().source
        with monkeypatch.context() as patch:
            patch.setattr(kernel, "limits_kept", lambda composition: False)
            long = JointSimulator(simulator().composition, controller=simulator().controller)
            assert "GLIDES = False" in long.source
            patch.setattr("quiet_loop.simulator", lambda *_, long=long: long)
            steps = columns(reference, PRESSURES, values=values)
        for name, value in short.items():
            assert np.array_equal(value, steps[name]), name
        assert short["events"] > 0


PLANT = SLAB.replace('"J/K", 200.0)', '"J/K", 200.0, (1.0, 1e4), "log-uniform", base=True)')


def test_the_state_of_an_effect_behind_a_gate_is_moved_as_well(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("plants").mkdir()
    Path("plants/block.py").write_text(PLANT, encoding="utf-8")
    plant, lag, count = find_plant("block"), 28.0, 200
    library = load_effects(plant=plant)
    effects = tuple(library[name] for name in ("sensor_lag", "sensor_gain"))
    model = uncompiled(Simulator(Composition(plant, effects, gated=True), free=True))
    assert "GLIDES = True" in model.source
    values = {"gate.sensor_lag": 1.0, "sensor_lag.lag": lag, "sensor_lag.dead_share": 0.0}
    marks = np.zeros(count, dtype=np.int64)
    marks[0] = 1
    inputs = np.tile(model.inputs(), (count, 1))
    inputs[:, list(model.composition.inputs).index("power")] = 60.0
    time = np.arange(count) * 1.0
    found = model.run_to_ends(model.vector(values), Given(1.0, marks, time, inputs, np.array([[0.0]]))).readings[:, 0]
    # two lags, one behind the other, of 100 s and 28 s
    slow = 200.0 / 2.0
    true = 30.0 * (1.0 - (slow * np.exp(-time / slow) - lag * np.exp(-time / lag)) / (slow - lag))
    assert np.allclose(found, true, atol=1e-9)
