"""What every effect must pass, ours and a user's; the cases are found by scanning the folder."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.effects import load_effects
from hjcamp.errors import UsageError
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter
from hjcamp.model.run.simulator import Simulator
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.effect_checks import CHECKS, EffectBench

CONTRACT = {
    "pump_backlash",
    "leakage",
    "cross_leakage",
    "entrained_air",
    "tubing_creep",
    "line_resistance",
    "line_inertance",
    "stribeck_friction",
    "presliding",
    "position_friction",
    "pressure_friction",
    "static_friction_ageing",
    "friction_drift",
    "gravity_load",
    "payload_inertia",
    "string_elasticity",
    "dither_relief",
    "encoder_eccentricity",
    "encoder_lag",
    "encoder_bias",
    "pressure_offset",
    "pressure_gain",
}
NAMES = sorted(load_effects([]))


def test_the_library_holds_the_names_of_the_contract() -> None:
    assert set(NAMES) == CONTRACT and len(NAMES) == len(CONTRACT)


@pytest.mark.parametrize("check", CHECKS)
@pytest.mark.parametrize("name", [*NAMES, "arm_spring"])
def test_effect(benches: dict[str, EffectBench], name: str, check: str) -> None:
    assert CHECKS[check](benches[name])


@pytest.mark.parametrize("name", [*NAMES, "arm_spring"])
def test_the_docstring_tells_equation_sign_and_source(library: dict[str, type[Effect]], name: str) -> None:
    effect = library[name]
    text = effect.__doc__ or ""
    assert effect.equation() and "Source: " in text and "Seen as: " in text
    assert all(parameter.text and parameter.unit for parameter in effect.parameters.values())
    assert any(parameter.off is not None for parameter in effect.parameters.values())
    # what each test begins with is no part of the law; a curve over an angle has a height, a length, a place and a form
    assert 1 <= sum(not parameter.each_test for parameter in effect.parameters.values()) <= 4


def test_with_all_gates_closed_the_model_is_the_published_one(simulator: Simulator) -> None:
    plain = Simulator(Composition(PumpJoint, (), PumpJoint.cut("pump")))
    for course in PumpJoint.courses().values():
        gated, published = (one.follow(one.vector({}), course).readings for one in (simulator, plain))
        # The gated kernel steps as a non-linear model: equal to the resolution that its steps promise.
        assert np.max(np.abs(gated - published) / [1e-4, 50.0, 50.0, 1e-9]) < 1.0


def test_all_effects_at_once_stay_finite(simulator: Simulator, library: dict[str, type[Effect]]) -> None:
    p = simulator.vector({f"gate.{name}": 1.0 for name in library})
    assert np.all(np.isfinite(simulator.follow(p, PumpJoint.courses()["sine"]).readings))


WRONG = {
    "absent when off": Parameter("m^3/(s*Pa)", 2e-15, (0.0, 1e-11), off=1e-15),
    "visible": Parameter("m^3/(s*Pa)", 1e-20, (0.0, 1e-11), off=0.0),
    "units": Parameter("m^3/s", 2e-15, (0.0, 1e-11), off=0.0),
    "finite within its bounds": Parameter("m^3/(s*Pa)", 2e-15, (-1e300, 1e300), off=0.0),
    "recovered from data": Parameter("m^3/(s*Pa)", 1e-26, (0.0, 1e-11), off=0.0),
}


@pytest.mark.parametrize("check", WRONG)
def test_each_check_can_fail(benches: dict[str, EffectBench], check: str) -> None:
    good = benches["cross_leakage"]

    class Wrong(Effect):
        subsystem = "lines"
        conductance = WRONG[check]

        @staticmethod
        def cross_flow(pressure1, pressure2, conductance):  # type: ignore[no-untyped-def]
            return conductance * (pressure1 - pressure2)

    Wrong.name = "cross_leakage"
    with pytest.raises(UsageError, match="cross_leakage"):
        CHECKS[check](EffectBench(Wrong, good.simulator, good.courses))


def test_a_gate_that_leaks_is_found(benches: dict[str, EffectBench]) -> None:
    class Leaking(EffectBench):
        def vector(self, gate, values):  # type: ignore[no-untyped-def]
            return super().vector(1.0, values)

    good = benches["cross_leakage"]
    with pytest.raises(UsageError, match="although it is switched off"):
        CHECKS["absent when switched off"](Leaking(good.effect, good.simulator, good.courses))
