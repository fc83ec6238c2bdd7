"""Static stiffness: the formulas by hand, tests made of known springs, and the model's own arm under a force."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from plain_kernel import uncompiled
from quiet_loop import AREA1, AREA2, EXACT, RADIUS, STIFFNESS

from hjcamp.configuration.composer import Composer
from hjcamp.effects import chosen_effects, find_effect, load_effects
from hjcamp.errors import UsageError
from hjcamp.model.compile.compose import Composition
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.calibrate.static_stiffness import step_of, stiffness_charts, stiffness_of
from hjcamp.plants.pump_joint.controllers.open_loop import OpenLoop
from hjcamp.plants.pump_joint.loop import ClosedLoop, JointSimulator
from hjcamp.plants.pump_joint.procedure import Procedure
from hjcamp.plants.pump_joint.sizing.stiffness import arm_stiffness, line_compliances, locked_stiffness
from hjcamp.plants.pump_joint.studies.study_pictures import stiffness_pictures
from hjcamp.records.log import TestLog

GIVEN = {"strength": 9.0, "begin": 0.1, "end": 0.4}


@pytest.fixture(scope="module")
def config() -> dict[str, Any]:
    found = Composer().compose(["controller=open_loop", "trajectory=hold"]).config
    return {**found, "effects": {"force_step": GIVEN}}


def test_the_locked_joint_by_hand() -> None:
    # 2 K A2^2 with 12.566 mm2 and 0.0257 MPa/mm3; at the pinion of 4.766 mm 20 mNm turn the arm by 6.2 deg.
    k = locked_stiffness(STIFFNESS, STIFFNESS, AREA2)
    assert k == pytest.approx(8117.0, rel=1e-4)
    assert arm_stiffness(k, 4.766e-3) == pytest.approx(0.184, abs=5e-4)
    assert math.degrees(0.020 / arm_stiffness(k, 4.766e-3)) == pytest.approx(6.2, abs=0.05)
    # two unequal lines, and a string of 40 um/N behind them
    one, two = 1.5 * STIFFNESS * AREA2**2, 0.5 * STIFFNESS * AREA2**2
    soft = locked_stiffness(1.5 * STIFFNESS, 0.5 * STIFFNESS, AREA2, 4e-5)
    assert 1.0 / soft == pytest.approx(1.0 / (one + two) + 4e-5)
    # 1000 mm3 with a stiff wall and 0.5 % air at 0.2 MPa: 1000 (1/2150 + 1/1e6 + 0.005/0.2) mm3/MPa
    parts = line_compliances(1e-6, 2150e6, 1e12, 0.005, 0.2e6)
    assert [parts[name] * 1e15 for name in ("water", "wall", "air")] == pytest.approx([0.4651, 0.001, 25.0], rel=1e-3)


def made_log(config: dict[str, Any], force: float, first: float, second: float, held: float) -> TestLog:
    """Return a test of two springs (N/m at the sliders) and a dry friction that keeps ``held`` N of the force."""
    travel = math.copysign(max(0.0, abs(force) - held), force) / (first + second)
    time = np.arange(500) * 1e-3
    on = np.where((time >= 0.1) & (time < 0.4), travel, 0.0)
    columns = {
        "time_s": time,
        "phase": np.full(500, 3.0),
        "reference_deg": np.zeros(500),
        "arm_deg": np.degrees(on / RADIUS),
        "pressure1_mpa": 0.4 - first * on / AREA2 * 1e-6,
        "pressure2_mpa": 0.4 + second * on / AREA2 * 1e-6,
    }
    return TestLog(columns, {"condition": f"{force:g}"}, {})


def test_known_springs_are_read_back(config: dict[str, Any]) -> None:
    steps = []
    for force in (-8.0, 3.0, 9.0):
        own = {**config, "effects": {"force_step": {**GIVEN, "strength": force}}}
        steps.append(step_of(made_log(config, force, 6000.0, 3000.0, 5.0), own))
    found = stiffness_of(steps)
    assert found is not None and (found.tests, found.still) == (3, 1)
    assert found.value == pytest.approx(9000.0, rel=1e-9) and found.error < 1e-6
    assert found.lines == pytest.approx((6000.0, 3000.0), rel=1e-9)
    assert found.held == pytest.approx(5.0) and found.expected == pytest.approx(8117.0, rel=1e-4)
    assert sum(found.parts.values()) == pytest.approx(1.0)
    said, charts = stiffness_charts(steps)
    assert "9.00 ± 0.00 N/mm" in said and "line 1 bears 67%" in said and "1 of 3 tests" in said
    assert [chart.name for chart in charts] == ["stiffness", "left"]
    assert "in no two tests" in stiffness_charts(steps[1:2])[0]


def test_a_loop_that_brings_the_arm_back(config: dict[str, Any]) -> None:
    log = made_log(config, 9.0, 3000.0, 3000.0, 0.0)
    time, arm = log.columns["time_s"], log.columns["arm_deg"]
    back = np.where(time < 0.25, arm, 0.2)
    log = TestLog({**log.columns, "arm_deg": back}, log.metadata, {})
    own = {**config, "controller": {"name": "pid"}}
    step = step_of(log, own)
    assert step.returned == pytest.approx(0.15) and step.largest_deg == pytest.approx(arm.max())
    assert step_of(made_log(config, 9.0, 3000.0, 3000.0, 0.0), own).returned is None
    assert "loop with pid: largest angle" in stiffness_charts([step])[0]


@pytest.mark.parametrize(
    ("given", "said"), [({}, "needs strength, begin and end"), ({**GIVEN, "end": 3.0}, "is on from 0.1 to 3 s")]
)
def test_what_does_not_say_its_force_is_refused(config: dict[str, Any], given: dict[str, float], said: str) -> None:
    own = {**config, "effects": {"force_step": given} if given else {}}
    with pytest.raises(UsageError, match=said):
        step_of(made_log(config, 9.0, 3000.0, 3000.0, 0.0), own)


def test_a_report_without_its_picture_says_why(capsys: pytest.CaptureFixture[str]) -> None:
    log = TestLog({}, {"campaign": "stiffness", "condition": "x"}, {"config.yaml": b"effects: {}\n"})
    assert stiffness_pictures([log]) == {}
    assert "no picture of 'stiffness': x: effects.force_step needs strength" in capsys.readouterr().err


def test_the_arm_of_the_model_gives_way_as_by_hand() -> None:
    """Held below static friction; beyond, k x = F - Fc where it comes to rest without overshoot; k from pressures alone."""
    simulator = uncompiled(JointSimulator(Composition(PumpJoint, (find_effect("force_step"),)), controller=OpenLoop))
    # viscous friction of twice the critical damping: the arm creeps to where the forces balance
    mass, k = 0.0185, 2.0 * STIFFNESS * AREA2**2
    damping = 2.0 * 2.0 * math.sqrt(k * mass)
    for force, expected in ((7.0, 0.0), (9.0, (9.0 - 5.27) / k)):
        test = ClosedLoop(
            control=OpenLoop.vector({}), procedure=Procedure.vector({"first_phase": 2.0, "rest": 0.0, "control": 0.1}),
            reference=np.zeros((100, 4)), dither=np.zeros(100), delay=2e-3, preload_area=AREA1, counts=np.zeros(4),
            phases=np.zeros(4), noise=np.zeros((25100, 4)), scatter=np.ones(25100),
        )  # fmt: skip
        values = {**EXACT, "viscous_positive": damping, "force_step.strength": force, "force_step.begin": 0.02}
        found = simulator.run({"pressure1": 0.4e6, "pressure2": 0.4e6}, simulator.vector(values), test)
        on = found["phase"] == 3.0
        assert np.ptp(found["arm_deg"][on][:20]) == 0.0
        travel = found["arm_deg"][on][-1] * RADIUS
        assert travel == pytest.approx(expected, rel=2e-3, abs=1e-9)
        bears = (found["pressure2_mpa"][on][-1] - found["pressure1_mpa"][on][-1]) * AREA2
        assert bears == pytest.approx(k * travel, rel=1e-6, abs=1e-6)


def test_what_is_imposed_is_named_by_a_configuration_and_never_proposed() -> None:
    assert "force_step" not in load_effects([])
    effects, values = chosen_effects({"force_step": {"strength": -3.0}})
    assert effects[0].name == "force_step" and values["force_step"]["strength"] == -3.0
    assert effects[0].parameters["strength"].unit == "N"
    # other plants with a body have it too
    assert find_effect("force_step", "two_pumps").name == "force_step"
