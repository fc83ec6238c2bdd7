"""Two effects of which each hides the other: a spring that hardens, and a force that moves the place about which it does."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.effects import load_effects
from hjcamp.records.log import TestLog

MASS, DAMPING, STIFFNESS, HARDENING, FORCE, PERIOD = 5e-6, 2e-4, 1.0, 3.9, 6e-3, 1e-3
PLANT = '''"""A light mass on a spring, in volts."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, outside, sensor


class Box(Plant):
    """A resonance of about 70 Hz."""

    place = State("V", typical=0.1)
    rate_of = State("V/s", typical=40.0)
    drive = Input("V", typical=0.05)
    mass = Parameter("s**2", 6e-6, (1e-7, 1e-4), "log-uniform", base=True)
    damping = Parameter("s", 2.5e-4, (1e-6, 1e-2), "log-uniform", base=True)
    stiffness = Parameter("1", 1.1, (0.1, 10.0), "log-uniform", base=True)
    period = 1e-3
    out_v = Measured("probe", of="place")

    @staticmethod
    def equations(state, parameter, drive, rate):
        push = actuator(drive.drive)
        load = outside("V")
        spring = parameter.damping * state.rate_of + parameter.stiffness * state.place
        rate.place = state.rate_of
        rate.rate_of = body(push + load - spring, mass=parameter.mass, load=load, position=state.place)
        probe = sensor(state.place)
'''


@pytest.fixture
def box(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Measured:
    """The log of a spring that hardens under a constant force, solved by LSODA."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "box.py").write_text(PLANT, encoding="utf-8")
    generator, count = np.random.default_rng(5), 2600
    drive = np.repeat(generator.uniform(-0.1, 0.1, count // 4), 4)

    def rate(t: float, x: np.ndarray, u: float) -> list[float]:
        pull = STIFFNESS * x[0] + HARDENING * x[0] ** 3 + DAMPING * x[1]
        return [x[1], (u + FORCE - pull) / MASS]

    state, shown = np.zeros(2), np.empty(count)
    for k in range(count):
        shown[k] = state[0]
        state = solve_ivp(rate, (0.0, PERIOD), state, args=(drive[k],), method="LSODA", rtol=1e-8, atol=1e-10).y[:, -1]
    columns = {"time_s": PERIOD * np.arange(count), "drive_v": drive, "out_v": shown + 2e-4 * generator.standard_normal(count)}
    return measured_tests([TestLog(columns, {"plant": "box", "period_s": str(PERIOD), "condition": "steps"})])


def looked_for(measured: Measured, *names: str) -> Analysis:
    library = load_effects(plant=measured.plant)
    return calibrated(measured, {name: library[name] for name in names})


@pytest.mark.study
@pytest.mark.parametrize(
    "names", [("cubic_spring", "spring", "constant_force"), ("soft_stop", "cubic_spring", "constant_force")]
)
def test_what_hardens_is_named_beside_what_moves_its_middle(box: Measured, names: tuple[str, ...]) -> None:
    found = decided(looked_for(box, *names))
    assert found.word in ("effect", "one_of") and "cubic_spring" in found.confidence_set[0]
    assert found.model.fitted.candidate.effects["cubic_spring"]["stiffness"] == pytest.approx(HARDENING, rel=0.02)
