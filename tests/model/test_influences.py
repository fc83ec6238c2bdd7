"""Which parameters can reach an output, and that the generated functions hold only what they need."""

from __future__ import annotations

from hjcamp.effects import load_effects
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.source_text import live
from hjcamp.model.compile.structure import influences
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.residuals.reach import idle

PRESSURES = ("pressure1_reading", "pressure2_reading")


def test_driven_lines_depend_on_stiffness_and_not_on_friction() -> None:
    names = influences(Composition(PumpJoint, (), PumpJoint.cut("lines")), PRESSURES)
    assert {"line_stiffness", "pump_area", "joint_area"} <= names
    assert not {"static_positive", "coulomb_negative", "moving_mass"} & names


def test_the_force_balance_depends_on_friction_and_not_on_stiffness() -> None:
    names = influences(Composition(PumpJoint, (), PumpJoint.cut("inverse")), PumpJoint.balance)
    assert {"static_positive", "coulomb_negative", "moving_mass"} <= names
    assert not {"line_stiffness", "pump_gain"} & names


def test_an_effect_reaches_an_output_through_its_state() -> None:
    creep = load_effects()["tubing_creep"]
    names = influences(Composition(PumpJoint, (creep,), PumpJoint.cut("lines")), PRESSURES)
    assert {f"tubing_creep.{name}" for name in creep.parameters} <= names


def test_live_statements_are_those_that_reach_the_end() -> None:
    statements = ["a = x", "b = a + 1", "if b > 0: a = 2 * b", "c = 3", "d = c"]
    assert live(statements, "return a") == ["a = x", "b = a + 1", "if b > 0: a = 2 * b"]
    assert live(statements, "out[0] = d") == ["c = 3", "d = c"]


def test_friction_is_idle_where_the_slider_is_driven_and_a_leak_where_the_pressures_are() -> None:
    library = load_effects()
    leak, bristles, offset = library["leakage"], library["presliding"], library["pressure_offset"]
    assert idle((leak, bristles, offset), "lines", PRESSURES) == {"presliding"}
    assert idle((leak, bristles, offset), "inverse", PumpJoint.balance) == {"leakage", "pressure_offset"}
    assert idle((leak,), "lines", PRESSURES) == frozenset()
