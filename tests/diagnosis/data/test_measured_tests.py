"""What logs say before any model: noise, states, what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from carriage import COUNT, measured_log

from hjcamp.diagnosis.data.tests import MOST_DELAY, measured_tests
from hjcamp.diagnosis.residuals.initial_states import estimated, rate_of, slope
from hjcamp.effects import load_effects
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant


def test_a_slope_is_exact_for_a_parabola() -> None:
    time = np.arange(200) * 0.01
    values = 1.0 + 2.0 * time + 3.0 * time**2
    assert np.allclose(slope(values, 8, 0.01)[8:-8], (2.0 + 6.0 * time)[8:-8], atol=1e-9)
    assert np.allclose(slope(values, 8, 0.01, order=2)[8:-8], 6.0, atol=1e-6)


def test_rates_follow_from_the_equations(axis: Path) -> None:
    plant = find_plant("axis")
    assert rate_of(plant) == {"velocity": "position"}
    log = measured_log(seconds=4.0)
    states, error = estimated(measured_tests([log]))
    position = states[0][:, 0]
    assert np.array_equal(position, log.columns["position_m"][MOST_DELAY:])
    assert error[0] == pytest.approx(COUNT / np.sqrt(12.0), rel=1e-3)
    expected = np.gradient(log.columns["position_m"], 2e-3)[MOST_DELAY:]
    moving = np.abs(expected) > 0.02
    assert np.abs(states[0][moving, 1] - expected[moving]).max() < 0.02


def test_what_cannot_be_analysed_is_refused(axis: Path) -> None:
    log = measured_log(seconds=2.0)
    with pytest.raises(UsageError, match="no tests"):
        measured_tests([])
    with pytest.raises(UsageError, match=r"voltage_v.*is missing"):
        measured_tests([replace(log, columns={k: v for k, v in log.columns.items() if k != "voltage_v"})])
    with pytest.raises(UsageError, match="one sample each"):
        measured_tests([log, replace(log, metadata={**log.metadata, "period_s": "0.004"})])
    with pytest.raises(UsageError, match=r"with resample_s: 0\.002 in the map"):
        measured_tests([log, replace(log, metadata={**log.metadata, "period_s": "0.0020071"})])
    short = {name: values[:20] for name, values in log.columns.items()}
    with pytest.raises(UsageError, match=r"20 samples; at least 64 are needed$"):
        measured_tests([replace(log, columns=short)])
    with pytest.raises(UsageError, match=r"20 samples; at least 64 are needed in one of the 2 logs"):
        measured_tests(
            [replace(log, columns=short), replace(log, columns={name: values[:19] for name, values in short.items()})]
        )
    bad = log.columns["position_m"].copy()
    bad[7] = np.nan
    with pytest.raises(UsageError, match="sample 7"):
        measured_tests([replace(log, columns={**log.columns, "position_m": bad})])


def test_a_log_of_few_samples_is_left_out_and_named(axis: Path) -> None:
    log = measured_log(seconds=2.0)
    short = replace(log, path=Path("short.mcap"), columns={name: values[:63] for name, values in log.columns.items()})
    found = measured_tests([short, log])
    assert [one.log for one in found.tests] == [log]
    assert found.short == (("short.mcap", 63),)


def test_effects_have_their_times_in_samples_of_the_logs(axis: Path) -> None:
    log = measured_log(seconds=2.0)
    slow = replace(
        log,
        columns={**log.columns, "time_s": 1000.0 * log.columns["time_s"]},
        metadata={**log.metadata, "period_s": "2"},
    )
    quick, late = measured_tests([log]).plant, measured_tests([slow]).plant
    assert late.name == quick.name and late.period == 2.0 and late is measured_tests([slow]).plant
    delays = [load_effects(plant=plant)["command_delay"].parameters["delay"] for plant in (quick, late)]
    assert delays[1].bounds[1] == pytest.approx(1000.0 * delays[0].bounds[1])
