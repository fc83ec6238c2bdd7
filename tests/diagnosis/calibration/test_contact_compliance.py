"""A contact that gives way by micrometres is how contacts are; where more is asked than that, it is an effect."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from carriage import COULOMB, GAIN, MASS, PERIOD, VISCOUS

from hjcamp.diagnosis.calibration import contact_compliance as contact_form
from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.results.calibration_rows import calibration
from hjcamp.effects import load_effects
from hjcamp.records.log import TestLog

SMALL = 40
COUNT, BEND = 1e-7, 4e-6


def carriage_log(friction: Callable[[float, float], float], seconds: float = 16.0) -> TestLog:
    """Return a log of a carriage solved by small steps; ``friction`` (N) is of its velocity and the step (s)."""
    time = np.arange(round(seconds / PERIOD)) * PERIOD
    wanted = 0.06 * np.sin(1.4 * time) + 0.03 * np.sin(3.7 * time + 1.0) - 0.03 * np.sin(1.0)
    x = v = 0.0
    h = PERIOD / SMALL
    places, volts = np.empty(len(time)), np.empty(len(time))
    for k in range(len(time)):
        places[k] = np.round(x / COUNT) * COUNT
        volts[k] = 160.0 * (wanted[k] - x) - 6.0 * v
        for _ in range(SMALL):
            v += h * (GAIN * volts[k] - VISCOUS * v - friction(v, h)) / MASS
            x += h * v
    columns = {"time_s": time, "position_m": places, "voltage_v": volts}
    return TestLog(columns, {"plant": "axis", "period_s": str(PERIOD), "condition": "swing"})


def creeping_log(creep: float) -> TestLog:
    """Return a log with the friction C tanh(v / creep) (m/s): it never sticks."""
    return carriage_log(lambda v, h: COULOMB * math.tanh(v / creep))


def bristled_log(bend: float) -> TestLog:
    """Return a log with Dahl's friction, with ``bend`` (m) to full slip."""
    z = 0.0

    def friction(v: float, h: float) -> float:
        nonlocal z
        z = (z + h * v) / (1.0 + h * abs(v) / bend)
        return COULOMB * z / bend

    return carriage_log(friction)


@pytest.fixture
def measured(axis: Path) -> Measured:
    return measured_tests([bristled_log(BEND)])


def analysed(measured: Measured) -> Analysis:
    library = load_effects(plant=measured.plant)
    return calibrated(measured, {name: library[name] for name in ("presliding", "spring")})


@pytest.mark.study
def test_the_form_of_a_contact_is_the_bases_where_it_is_small(measured: Measured) -> None:
    analysis = analysed(measured)
    found = decided(analysis)
    assert analysis.base.names == ("presliding",) and found.word == "nothing_missing" and found.effects == ()
    own = analysis.base.fitted.candidate
    # Dahl's law has another curve: its slope at full slip is a third of ours
    assert 1.0 < own.effects["presliding"]["compliance"] * COULOMB / BEND < 3.0
    assert own.base["mass"] == pytest.approx(MASS, rel=0.01) and own.base["coulomb"] == pytest.approx(COULOMB, rel=0.02)
    rows = calibration(analysis)
    assert rows["presliding compliance"]["unit"] == "m/N" and "zero.position_m" not in rows
    # where the carriage slides all the time the form is left out, and predicts as well
    windows, slides = analysis.windows, analysis.windows.slides
    assert slides is not None and 0.3 < np.mean(slides) < 1.0
    split = windows.features(own)
    windows.slides = None
    assert np.sum(split[slides] ** 2) == pytest.approx(np.sum(windows.features(own)[slides] ** 2), rel=0.1)
    assert np.allclose(split[slides], windows.features(own.without(["presliding"]))[slides], atol=1e-6)


@pytest.mark.study
def test_a_contact_that_creeps_is_no_discrepancy_either(axis: Path) -> None:
    measured = measured_tests([creeping_log(1e-3)])
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {name: library[name] for name in ("contact_creep", "presliding", "spring")})
    found = decided(analysis)
    assert analysis.base.names == ("contact_creep",) and found.word == "nothing_missing"
    own = analysis.base.fitted.candidate
    # a tanh has 95 % of its friction at 1.83 of its speed, and is nearly of sharpness 2
    creep = own.effects["contact_creep"]
    assert 1.3 < creep["creep_speed"] / 1e-3 < 2.4 and 1.2 < creep["sharpness"] < 2.8
    assert own.base["coulomb"] == pytest.approx(COULOMB, rel=0.02)


@pytest.mark.study
def test_what_is_larger_than_granted_is_an_effect(measured: Measured, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact_form, "GRANTED", 2e-5)
    analysis = analysed(measured)
    assert analysis.base.names == () and analysis.search.begins["presliding"]["compliance"] > 1e-7
    named = decided(analysis)
    assert (named.word, named.effects) == ("effect", ("presliding",))
