"""Two effects of which each hides the other: a spring that hardens, and a force that moves the place about which it does."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.verdict import judged
from hjcamp.diagnosis.levels import LEVEL
from hjcamp.diagnosis.selection.scored import Scored
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


def test_a_law_that_was_found_first_is_exchanged_beside_the_others(box: Measured) -> None:
    analysis = looked_for(box, "soft_stop", "cubic_spring", "constant_force")
    search, library = analysis.search, analysis.search.library
    candidate = analysis.base.fitted.candidate
    for name in ("constant_force", "soft_stop"):
        candidate = candidate.with_effect(name, library[name].defaults())
    wrong = search.fitted(candidate)
    found = search.exchanged(wrong, analysis.base)
    assert set(found.names) - set(analysis.base.names) == {"constant_force", "cubic_spring"}
    assert found.left_out < 0.5 * wrong.left_out
    assert found.fitted.candidate.effects["cubic_spring"]["stiffness"] == pytest.approx(HARDENING, rel=0.02)


def test_what_takes_little_of_the_rms_alone_is_found_beside_another(box: Measured, monkeypatch: pytest.MonkeyPatch) -> None:
    analysis = looked_for(box, "cubic_spring", "constant_force")
    search, base = analysis.search, analysis.base
    step = search.look(base)
    assert step.named[0].beyond(base) == ("cubic_spring",)
    force = next(one for one in step.named if one.beyond(base) == ("constant_force",))
    assert search.beside_another(step.named[0], base, step) is None  # the best is no other one
    matters = search.matters

    def not_alone(model: Scored, before: Scored, level: float = LEVEL) -> bool:
        return model.beyond(base) != ("cubic_spring",) and matters(model, before, level)

    monkeypatch.setattr(search, "matters", not_alone)
    both = search.beside_another(force, base, step)
    assert both is not None and set(both.beyond(base)) == {"cubic_spring", "constant_force"}
    # where nothing matters beside it, nothing is found, and no look is told
    told = len(search.steps)
    monkeypatch.setattr(search, "matters", lambda model, before, level=LEVEL: False)
    assert search.beside_another(force, base, step) is None and len(search.steps) == told


@pytest.mark.study
@pytest.mark.parametrize(
    "names", [("cubic_spring", "spring", "constant_force"), ("soft_stop", "cubic_spring", "constant_force")]
)
def test_what_hardens_is_named_beside_what_moves_its_middle(box: Measured, names: tuple[str, ...]) -> None:
    found = judged(looked_for(box, *names))
    assert found.word in ("effect", "one_of") and "cubic_spring" in found.confidence_set[0]
    assert found.model.fitted.candidate.effects["cubic_spring"]["stiffness"] == pytest.approx(HARDENING, rel=0.02)
