"""The rig in memory is the simulator of a run: the same indicators to rounding, untouched and with every factor moved."""

import copy

import numpy as np
import pytest

from hjcamp.plants.pump_joint.factors import FACTORS
from hjcamp.plants.pump_joint.simulation import run_test
from hjcamp.plants.pump_joint.tables import rig as rigs
from hjcamp.plants.pump_joint.tables.question import asked
from hjcamp.records.log import TestLog
from hjcamp.records.plan import seed_of
from hjcamp.report.runs.indicators import CHOICES, INDICATORS, indicators_of


@pytest.fixture
def condition(monkeypatch):
    # no effect behind gates: a small kernel
    monkeypatch.setattr(rigs, "load_effects", dict)
    rigs.gated.cache_clear()
    [question] = [one for one in asked(["5.4.1"]).conditions if one.name == "ramp_neg__ffwd_pid"]
    yield question
    rigs.gated.cache_clear()


def of_a_run(config, seed):
    columns, _ = run_test(config, seed)
    row = indicators_of(TestLog(columns, dict.fromkeys(CHOICES, "") | {"trajectory": "ramp_neg"}))
    return [row[name] for name in INDICATORS[:3]]


def test_the_rig_in_memory_is_the_simulator_of_a_run(condition):
    rig, seed = rigs.Rig.planned([condition], 1, 1), seed_of(1, condition.name, 1)
    assert rig.indicators({})[0, 0, :3].tolist() == pytest.approx(of_a_run(condition.config, seed), rel=1e-9)
    moved = dict.fromkeys(FACTORS, 1.1)
    config = copy.deepcopy(condition.config)
    config["model"]["factors"] = moved
    config["model"]["parameters"] = {"coulomb_negative": 2.5}
    found = rig.indicators({**moved, "coulomb_negative": 2.5})[0, 0, :3]
    assert found.tolist() == pytest.approx(of_a_run(config, seed), rel=1e-9)
    assert not np.allclose(found, rig.indicators({})[0, 0, :3], rtol=0.02)
