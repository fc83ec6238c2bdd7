"""Inputs that act a fraction of a sample late, or run on between samples, against exact solutions of a fast oscillator."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm

from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.data.segments import Layout, halves
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.records.log import TestLog

MASS, DAMPING, STIFFNESS, PERIOD, NOISE = 5.26e-6, 2.2e-4, 0.97, 1.6e-3, 5e-5
PLANT = '''"""A light mass on a spring, in volts; nine samples see one period of it."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, outside, sensor


class Light(Plant):
    """A resonance of 68 Hz."""

    place = State("V", typical=0.1)
    rate_of = State("V/s", typical=40.0)
    drive = Input("V", typical=0.05, hold="HOLD")
    mass = Parameter("s**2", 5e-6, (1e-7, 1e-4), "log-uniform", base=True)
    damping = Parameter("s", 2e-4, (1e-6, 1e-2), "log-uniform", base=True)
    stiffness = Parameter("1", 1.0, (0.1, 10.0), "log-uniform", base=True)
    period = 1.6e-3
    out_v = Measured("probe", of="place")

    @staticmethod
    def equations(state, parameter, drive, rate):
        push = actuator(drive.drive)
        spring = parameter.damping * state.rate_of + parameter.stiffness * state.place
        rate.place = state.rate_of
        rate.rate_of = body(push - spring, mass=parameter.mass, position=state.place)
        probe = sensor(state.place)
'''
RATES = np.array([[0.0, 1.0], [-STIFFNESS / MASS, -DAMPING / MASS]])


def logged(late: float, hold: str) -> Measured:
    """The log of an oscillator, solved exactly, whose input acts ``late`` by so many samples, or runs on linearly."""
    generator, count = np.random.default_rng(4), 2600
    drive = np.round(np.repeat(generator.uniform(-0.1, 0.1, count // 4), 4), 4)
    if hold == "linear":
        drive = np.convolve(drive, np.full(5, 0.2), mode="same")
    # (place, rate, input, its slope)
    whole = np.zeros((4, 4))
    whole[:2, :2], whole[1, 2], whole[2, 3] = RATES, 1.0 / MASS, 1.0
    state, shown = np.zeros(2), np.empty(count)
    for k in range(count):
        shown[k] = state[0]
        following = drive[min(k + 1, count - 1)]
        slope = (following - drive[k]) / PERIOD if hold == "linear" else 0.0
        before, now = (drive[k - 1] if k else drive[0], drive[k]) if late > 0.0 else (drive[k], following)
        first = late % 1.0
        for share, given in ((first, before), (1.0 - first, now if late else drive[k])):
            state = (expm(whole * share * PERIOD) @ np.append(state, [given, slope]))[:2]
    columns = {"time_s": PERIOD * np.arange(count), "drive_v": drive, "out_v": shown + NOISE * generator.standard_normal(count)}
    return measured_tests([TestLog(columns, {"plant": "light", "period_s": str(PERIOD), "condition": "steps"})])


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    return tmp_path


def looked_at(folder: Path, late: float, hold: str) -> Analysis:
    (folder / "plants" / "light.py").write_text(PLANT.replace("HOLD", hold), encoding="utf-8")
    return calibrated(logged(late, hold), {}, unknowns=False)


@pytest.mark.parametrize(
    ("late", "hold"), [(0.0, "previous"), (0.5, "previous"), (-0.5, "previous"), (0.25, "previous"), (0.0, "linear")]
)
def test_a_base_that_is_complete_leaves_noise_and_has_its_true_values(folder: Path, late: float, hold: str) -> None:
    analysis = looked_at(folder, late, hold)
    base = analysis.base.fitted.candidate.base
    assert base["mass"] == pytest.approx(MASS, rel=2e-3)
    assert base["stiffness"] == pytest.approx(STIFFNESS, rel=2e-3)
    assert base.get("delay.drive", 0.0) == pytest.approx(late * PERIOD, abs=0.01 * PERIOD)
    assert np.sqrt(np.mean(analysis.base.features**2)) < 1.2
    # whole samples need no parts
    assert (analysis.windows.layout.fine == 1) == (late == 0.0 and hold == "previous")


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize("length", [1.0, 0.5])
def test_two_halves_have_the_mean_and_the_first_moment(held: bool, length: float) -> None:
    generator = np.random.default_rng(3)
    begins = generator.normal(size=12)
    ends = begins if held else np.append(begins[1:], begins[-1])
    first = 0.45 - 2.0 + np.arange(30) * length  # from before the first sample to behind the last

    def course(t: float) -> float:
        if t < 0.0 or t >= 12.0:
            return float(begins[0] if t < 0.0 else ends[-1])
        k = int(t)
        return float(begins[k] + (t - k) * (ends[k] - begins[k]))

    # another test before it and behind it
    other, within = generator.normal(size=5), (np.full(30, 5), np.full(30, 16))
    given = (np.concatenate([other, one, other]) for one in (begins, ends))
    mean, apart = halves(*given, first + 5.0, length, within)
    exact = 0
    for start, m, d in zip(first, mean, apart, strict=True):
        edges = [start, *(k for k in (np.floor(start) + 1.0,) if start < k < start + length), start + length]
        pieces = list(pairwise(edges))
        assert m * length == pytest.approx(sum(quad(course, *one)[0] for one in pieces), abs=1e-9)
        middle = start + 0.5 * length
        moment = sum(quad(lambda t, c=middle: (t - c) * course(t), *one)[0] for one in pieces)
        values = [course(t) for low, high in pieces for t in (low + 1e-12, high - 1e-12)]
        assert min(values) - 1e-9 <= min(m - d, m + d) and max(m - d, m + d) <= max(values) + 1e-9
        if abs(d) * length**2 / 4.0 == pytest.approx(abs(moment), abs=1e-9):
            exact += 1
            assert d * length**2 / 4.0 == pytest.approx(moment, abs=1e-9)
        else:  # held within what is given, the moment in part
            assert 0.0 < d * length**2 / 4.0 / moment < 1.0
    assert exact >= 15


def test_parts_have_the_mean_of_the_sample(folder: Path) -> None:
    (folder / "plants" / "light.py").write_text(PLANT.replace("HOLD", "previous"), encoding="utf-8")
    plain = Layout(logged(0.0, "previous"), 24)
    for delay in (0.0, 0.3 * PERIOD, 1.6 * PERIOD, -0.4 * PERIOD):
        whole = plain.delayed({"drive": delay})
        fine = replace(plain, fine=4).delayed({"drive": delay})
        assert fine.shape == (4 * len(whole), whole.shape[1])
        np.testing.assert_allclose(fine.reshape(-1, 4, whole.shape[1]).mean(axis=1), whole, atol=1e-12)
