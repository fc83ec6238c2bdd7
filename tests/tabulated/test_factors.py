"""Factors of the loop: against the same change made in the configuration, and against the roots of the pump's polynomial."""

import copy
from dataclasses import replace

import numpy as np
import pytest

from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.configuration import check_model
from hjcamp.plants.pump_joint.factors import changed_values
from hjcamp.plants.pump_joint.simulation import prepare


@pytest.fixture(scope="module")
def config():
    return Composer().compose(["trajectory=ramp_neg", "controller=pid"]).config


def with_factors(config, **factors):
    changed = copy.deepcopy(config)
    changed["model"]["factors"] = factors
    return changed


def test_no_factors_leave_every_number_of_a_test_as_it_is(config):
    plain, ones = prepare(config, 3), prepare(with_factors(config, controller_scale=1.0, pump_ratio=1.0), 3)
    assert np.array_equal(plain.p, ones.p)
    for name in ("control", "procedure", "reference"):
        assert np.array_equal(getattr(plain.test, name), getattr(ones.test, name))


@pytest.mark.parametrize(
    ("factor", "path", "value"),
    [
        ("controller_scale", ("controller", "scale"), 1.5),
        ("derivative_gain", ("controller", "negative", "kd"), 0.5),
        ("integral_gain", ("controller", "negative", "ki"), 2.0),
        ("head_start", ("procedure", "adjustment", "negative_mpa"), 0.5),
    ],
)
def test_a_factor_is_the_same_as_the_value_in_its_group(config, factor, path, value):
    other = copy.deepcopy(config)
    group = other
    for key in path[:-1]:
        group = group[key]
    group[path[-1]] *= value
    if path[-1] in ("kd", "ki"):
        other["controller"]["positive"][path[-1]] *= value
    by_factor, by_group = prepare(with_factors(config, **{factor: value}), 3), prepare(other, 3)
    assert np.allclose(by_factor.test.control, by_group.test.control, rtol=1e-14)
    assert np.allclose(by_factor.test.procedure, by_group.test.procedure, rtol=1e-14)
    assert not np.array_equal(by_factor.test.control, prepare(config, 3).test.control) or factor == "head_start"


def test_a_bumpless_change_of_gains_is_the_same_as_in_its_group(config):
    other = copy.deepcopy(config)
    other["controller"]["bumpless"] = 0.25
    by_factor, by_group = prepare(with_factors(config, bumpless=0.25), 3), prepare(other, 3)
    assert np.array_equal(by_factor.test.control, by_group.test.control)
    assert not np.array_equal(by_factor.test.control, prepare(config, 3).test.control)
    # what the group says already is not there twice: 0.25 + 0.2 (1 - 0.25)
    place = np.flatnonzero(by_group.test.control != prepare(config, 3).test.control)
    assert prepare(with_factors(other, bumpless=0.2), 3).test.control[place] == pytest.approx(0.4)


def test_pump_bandwidth_multiplies_every_pole_and_keeps_the_gain_at_rest():
    values = {name: one.default for name, one in PumpJoint.parameters.items()}
    faster = changed_values(values, {"pump_bandwidth": 2.0})

    def poles(of):
        return np.sort_complex(np.roots([1.0, of["pump_a2"], of["pump_a1"], of["pump_a0"]]))

    assert np.allclose(poles(faster), 2.0 * poles(values))
    assert faster["pump_gain"] / faster["pump_a0"] == pytest.approx(values["pump_gain"] / values["pump_a0"])


def test_the_preload_pistons_keep_their_area_when_the_pump_moves_less(config):
    plain, less = prepare(config, 3), prepare(with_factors(config, pump_ratio=0.8), 3)
    assert less.test.preload_area == plain.test.preload_area
    assert replace(less.test, delay=0.0).delay == 0.0 and less.test.delay == plain.test.delay


def test_a_model_with_an_unknown_or_impossible_factor_is_refused():
    model = {"name": "x", "parameters": {}, "effects": {}}
    with pytest.raises(UsageError, match="controller_scale"):
        check_model({**model, "factors": {"controller_scal": 1.0}}, "model")
    with pytest.raises(UsageError, match="pump_ratio"):
        check_model({**model, "factors": {"pump_ratio": 100.0}}, "model")
