"""A moment that repeats with each turn of a shaft is outside the library, with its curve over one turn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from flywheel import GAIN, INERTIA, PERIOD, PLANT, VISCOUS

from hjcamp.commands.any_plant.verdict_words import Words
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.candidates.nonparametric_terms import unknowns_of
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.results.answer import answer
from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant
from hjcamp.records.log import TestLog

SMALL, NOISE = 10, 2e-4
# the flywheel's motor without a lag, its angle measured
TURNED = {
    "class Motor": "class Shaft",
    "    speed = State": '    angle = State("rad", typical=5.0)\n    speed = State',
    'speed_rad_per_s = Measured("tacho", of="speed")': 'angle_rad = Measured("encoder", of="angle")',
    "        rate.speed": "        rate.angle = state.speed\n        rate.speed",
    "load=load)": "load=load, position=state.angle)",
    "tacho = sensor(state.speed)": "encoder = sensor(state.angle)",
}


def shaft(cogging: float) -> Measured:
    """Return a log; ``cogging`` (N m) is the size of what magnets do, seven times in a turn, in a form with a second harmonic."""
    generator = np.random.default_rng(5)
    volts = np.repeat(generator.uniform(-2.5, 2.5, 75), 40)
    angle = speed = 0.0
    shown = np.empty(len(volts))
    for k, volt in enumerate(volts):
        shown[k] = angle
        for _ in range(SMALL):
            magnets = cogging * (np.sin(7.0 * angle) + 0.3 * np.sin(14.0 * angle + 1.0))
            speed += PERIOD / SMALL * (GAIN * volt - VISCOUS * speed - magnets) / INERTIA
            angle += PERIOD / SMALL * speed
    shown += NOISE * generator.standard_normal(len(volts))
    columns = {"time_s": PERIOD * np.arange(len(volts)), "voltage_v": volts, "angle_rad": shown}
    return measured_tests([TestLog(columns, {"plant": "shaft", "period_s": str(PERIOD), "condition": "a"})])


@pytest.fixture
def plants(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    text = PLANT
    for old, new in TURNED.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    (tmp_path / "plants" / "shaft.py").write_text(text, encoding="utf-8")


@pytest.mark.usefixtures("plants")
def test_what_repeats_with_each_turn_is_outside_and_its_curve_is_of_one_turn() -> None:
    measured = shaft(8e-3)
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {name: library[name] for name in ("pendulum_weight", "sensor_gain", "sensor_lag")})
    verdict = decided(analysis)
    found = answer(analysis, verdict, 0.0)
    row = found["unknowns"][0]
    assert (found["verdict"], row["quantity"], row["driver"]) == ("outside_library", "force", "speed_position")
    assert row["left"] < 0.3
    x, y = np.array(row["curve"]["x"]), np.array(row["curve"]["y"])
    assert (x[0], x[-1]) == (0.0, pytest.approx(2.0 * np.pi))
    assert np.argmax(np.abs(np.fft.rfft(y[:-1] - y[:-1].mean()))) == 7
    assert np.ptp(y) == pytest.approx(2.0 * 8e-3, rel=0.3)
    words = Words(analysis, verdict, found)
    assert words.title == "OUTSIDE THE LIBRARY  depends on angle"
    assert "A force at speed that depends on angle" in " ".join(words.sentences())


@pytest.mark.usefixtures("plants")
@pytest.mark.parametrize(
    ("turns", "name"), [(1.9, "unknown_fine_force_over_position"), (2.1, "unknown_turning_force_over_position")]
)
def test_within_a_turn_or_over_the_whole_travel(turns: float, name: str) -> None:
    travel = turns * 2.0 * np.pi
    found = unknowns_of(find_plant("shaft"), {"angle": (1.0, 1.0 + travel), "load": (0.0, 1.0)})
    assert [one for one in found if "fine" in one or "turning" in one] == [name]
    known = found[name]
    assert known.high - known.low == pytest.approx(min(travel, 2.0 * np.pi) if "turning" in name else travel)
    assert known.over(known.high + 0.5) == pytest.approx(0.5 if "turning" in name else known.high + 0.5)
