"""What swings by itself: lines are told from any smooth spectrum at their level, and from what swings as the inputs do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter
from slab import NOISE, PLANT, course

from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.periodic_disturbance import swing_of
from hjcamp.diagnosis.decision.verdict import NOTHING, OUTSIDE, decided
from hjcamp.diagnosis.residuals.spectral_lines import chances, own_to, refined, sine_in
from hjcamp.effects import load_effects
from hjcamp.records.log import TestLog

LEVEL = 0.05
RIGS = 200
HZ = 0.0137


def without_lines(generator: np.random.Generator, samples: int) -> dict[str, np.ndarray]:
    """Return series of smooth spectra, and some that come and go."""
    white = generator.standard_normal(samples)
    ringing = np.poly([0.97 * np.exp(0.3j), 0.97 * np.exp(-0.3j)]).real
    return {
        "white": white,
        "red": lfilter([1.0], [1.0, -0.99], white),
        "a walk": np.cumsum(white),
        "a resonance": lfilter([1.0], ringing, white),
        "steps": np.repeat(white, 50)[:samples],
        "long tails": generator.standard_t(3.0, samples),
        "one transient": np.exp(-np.arange(samples) / (0.05 * samples)) + 0.01 * white,
    }


def test_the_chance_of_a_line_holds_its_level_where_there_is_none() -> None:
    found: dict[str, list[bool]] = {}
    for seed in range(RIGS):
        for name, values in without_lines(np.random.default_rng(seed), 1500).items():
            chance = chances(values)[1]
            found.setdefault(name, []).append(bool(chance.min() * len(chance) <= LEVEL))
    # 95 % of such counts at the level are no more than this
    most = LEVEL + 1.64 * np.sqrt(LEVEL * (1.0 - LEVEL) / RIGS)
    shares = {name: float(np.mean(one)) for name, one in found.items()}
    assert max(shares.values()) <= most, shares


@pytest.mark.parametrize("cycles", [5.3, 41.0, 433.7])
def test_a_sine_in_red_noise_is_found_where_it_is(cycles: float) -> None:
    generator = np.random.default_rng(5)
    line = 3.0 * np.sin(2.0 * np.pi * cycles * np.arange(2000) / 2000.0 + 0.7)
    values = line + 0.03 * lfilter([1.0], [1.0, -0.9], generator.standard_normal(2000)) + 5.0
    frequency, chance = chances(values)
    assert chance.min() * len(chance) < 1e-5
    at = refined(values, float(frequency[np.argmin(chance)]))
    assert at * 2000.0 == pytest.approx(cycles, abs=0.1)
    assert sine_in(values, at) == pytest.approx(line, abs=0.2)


def test_multiples_of_what_is_given_swing_not_by_themselves() -> None:
    given = np.sign(np.sin(2.0 * np.pi * 20.0 * np.arange(4000) / 4000.0))
    frequency = np.array([20.0, 40.0, 60.3, 50.0, 31.0]) / 4000.0
    assert list(own_to(frequency, given, LEVEL)) == [False, False, False, True, True]
    assert own_to(frequency, np.random.default_rng(2).standard_normal(4000), LEVEL).all()


def slab_tests(
    folder: Path, monkeypatch: pytest.MonkeyPatch, swing: float, power: list[np.ndarray], loss_too: float = 0.0
) -> Measured:
    """Return tests of a heated block, exact, in which a power of ``swing`` W from outside swings, in another phase in each test."""
    monkeypatch.chdir(folder)
    (folder / "plants").mkdir()
    (folder / "plants" / "slab.py").write_text(PLANT)
    generator, logs = np.random.default_rng(8), []
    for number, own in enumerate(power):
        time, phase = np.arange(float(len(own))), 2.1 * number
        # C y' + G y = a sin(w t + phase): the steady answer, and what of it the start lacks
        pulse = swing / (2.5 + 200.0 * 2j * np.pi * HZ)
        steady = np.imag(pulse * np.exp(1j * (2.0 * np.pi * HZ * time + phase)))
        warmth = course(2.5, 20.0 - steady[0], own + loss_too * own**2) + steady + NOISE * generator.standard_normal(len(own))
        columns = {"time_s": time, "warmth_k": warmth, "power_w": own}
        logs.append(TestLog(columns, {"plant": "slab", "period_s": "1.0", "condition": str(number)}))
    return measured_tests(logs)


def stepping() -> list[np.ndarray]:
    generator = np.random.default_rng(8)
    return [np.repeat(generator.uniform(0.0, 80.0, 30), 100) for _ in range(2)]


def analysed(measured: Measured, width: int | None = None) -> Analysis:
    library = {name: one for name, one in load_effects(plant=measured.plant).items() if name in ("sensor_lag", "sensor_gain")}
    return calibrated(measured, library, width=width)


def test_a_power_that_swings_from_outside_is_outside_the_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    verdict = decided(analysed(slab_tests(tmp_path, monkeypatch, 12.0, stepping())))
    assert verdict.word == OUTSIDE and verdict.swing is not None
    assert verdict.swing.frequency == pytest.approx(HZ, rel=0.01)
    amplitude = 12.0 / abs(2.5 + 200.0 * 2j * np.pi * HZ)
    assert verdict.swing.rms == pytest.approx(amplitude / np.sqrt(2.0), rel=0.1)
    assert verdict.swing.left < 0.5


def test_nothing_swings_where_nothing_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    verdict = decided(analysed(slab_tests(tmp_path, monkeypatch, 0.0, stepping())))
    assert verdict.word == NOTHING and verdict.swing is None


def test_what_swings_as_the_input_does_is_not_from_outside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    time = np.arange(3000.0)
    power = [40.0 + 30.0 * np.sin(2.0 * np.pi * HZ * time + one) for one in (0.0, 1.0)]
    # each third sample holds for three: the input has the same line, and what is missing has it and its multiples
    measured = slab_tests(tmp_path, monkeypatch, 0.0, [one[::3].repeat(3) for one in power], loss_too=5e-3)
    assert swing_of(analysed(measured), LEVEL) is None
