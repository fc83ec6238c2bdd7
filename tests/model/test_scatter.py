"""What a seed draws for a test: the first rows are the same however many are drawn."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.configuration.composer import Composer
from hjcamp.model.declare.scatter import Scatter, draw
from hjcamp.plants.pump_joint import simulation
from hjcamp.plants.pump_joint.loop import NotEndedError
from hjcamp.plants.pump_joint.simulation import run_test

NOISE = np.array([0.0, 700.0, 700.0, 0.0])


@pytest.mark.parametrize("rows", [0, 1, 500, 3000])
def test_fewer_rows_are_the_first_of_all(rows: int) -> None:
    whole, part = draw(3, 3000, NOISE, Scatter()), draw(3, 3000, NOISE, Scatter(), rows=rows)
    assert len(part.friction) == len(part.noise) == rows
    assert np.array_equal(part.friction, whole.friction[:rows])
    assert np.array_equal(part.noise, whole.noise[:rows])
    assert np.array_equal(part.pressures, whole.pressures) and np.array_equal(part.phases, whole.phases)


def test_a_test_that_lasts_longer_than_usual_draws_all(monkeypatch: pytest.MonkeyPatch) -> None:
    config = dict(Composer().compose(["trajectory=ramp_pos", "controller=pid"]).config)
    usual = run_test(config, 7)[0]
    tried = []
    run = simulation.JointSimulator.run

    def noted(self, *given):  # type: ignore[no-untyped-def]
        try:
            return run(self, *given)
        except NotEndedError:
            tried.append(len(given[2].noise))
            raise

    monkeypatch.setattr(simulation.JointSimulator, "run", noted)
    monkeypatch.setattr(simulation, "USUAL_PHASES_S", 0.05)
    again = run_test(config, 7)[0]
    assert len(tried) == 1 and tried[0] < len(usual["time_s"])
    assert all(np.array_equal(again[name], values) for name, values in usual.items())
