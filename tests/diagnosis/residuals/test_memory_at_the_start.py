"""A log that begins where a drive has not caught up with its command: what an effect remembers there is told by the test itself."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from flywheel import GAIN, INERTIA, LAG, NOISE, PERIOD, VISCOUS, behind_a_lag

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.diagnosis.residuals.free_run import whole_error
from hjcamp.effects import load_effects
from hjcamp.model.declare.base_values import DELAY


@pytest.fixture
def motor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Measured:
    """Two logs of a motor behind a lag, at rest where its voltage is on already."""
    monkeypatch.chdir(tmp_path)
    return behind_a_lag()


def test_a_drive_that_has_not_caught_up_leaves_no_more_than_noise(motor: Measured) -> None:
    library = load_effects(plant=motor.plant)
    # a lag of the reading would say the same of a linear machine
    analysis = calibrated(motor, {name: library[name] for name in ("command_delay", "dead_band")})
    found = decided(analysis)
    assert found.effects == ("command_delay",) and found.word == "effect"
    model = found.model
    [delay] = [one for one in intervals(model.fitted, analysis.search.blocks) if one.name == "delay"]
    assert delay.low < LAG < delay.high and delay.high - delay.low < 0.1 * LAG
    # the base has no delay of its own beside it, which would say the same
    assert (
        not any(one.name.startswith(DELAY) for one in model.fitted.free)
        and model.fitted.candidate.base[f"{DELAY}voltage"] == 0.0
    )
    assert any(one.name == f"{DELAY}voltage" for one in analysis.base.fitted.free)
    layout, windows = analysis.windows.layout, replace(analysis.windows)
    size = np.linalg.norm(model.fitted.features, axis=1)
    assert size[layout.fresh].max() < 2.0 * np.median(size) and layout.fresh.sum() == 2
    # with the true parameters what is remembered is known by hand
    true = model.fitted.candidate.with_base({"inertia": INERTIA, "viscous": VISCOUS, "delay.voltage": 0.0})
    true = true.with_effect("command_delay", {"delay": LAG, "dead_share": 0.0})
    windows.place = model.place
    windows.move_starts(true)
    [(state, known)] = windows.remembered.items()
    item = library["command_delay"].states[state.split(".")[1]]
    # at rest, where the command is on: its own start, which is as free, leaves it this uncertain
    assert np.abs(layout.inputs[:: layout.width, 0][layout.fresh]).min() > 1.0
    assert known[layout.fresh] * item.typical == pytest.approx(0.0, abs=0.4)
    whole = whole_error(windows, model.fitted.candidate)
    assert whole is not None and whole.rms[0] < 1.1 * NOISE


def test_windows_begin_with_what_effects_remember_and_go_on_from_there(motor: Measured) -> None:
    library = load_effects(plant=motor.plant)
    analysis = calibrated(motor, {name: library[name] for name in ("command_delay", "dead_band")})
    windows, base = analysis.windows, analysis.base.fitted.candidate
    candidate = base.with_effect("command_delay", {"delay": LAG, "dead_share": 0.0})
    plain = windows.readings(candidate)[0][:, 0]
    layout, item = windows.layout, library["command_delay"].states["followed"]
    # more by its usual size than the command with which it would begin
    windows.remembered = {"command_delay.followed": 1.0 + layout.inputs[:: layout.width, 0] / item.typical}
    change = windows.readings(candidate)[0][:, 0] - plain
    width, time = layout.width, PERIOD * np.arange(layout.width)
    rate = base.base["viscous"] / base.base["inertia"]
    # of a first-order lag before a first-order plant, by hand
    by_hand = GAIN / base.base["inertia"] * item.typical * (np.exp(-time / LAG) - np.exp(-rate * time)) / (rate - 1.0 / LAG)
    assert change[:width] == pytest.approx(by_hand, rel=1e-3, abs=1e-4)
    # the window behind it begins at its own start, and with what is left of it
    left = np.exp(-width * PERIOD / LAG)
    assert change[width : 2 * width] == pytest.approx(left * by_hand, rel=1e-3, abs=1e-4)
    assert layout.fresh[0] and not layout.fresh[1]
