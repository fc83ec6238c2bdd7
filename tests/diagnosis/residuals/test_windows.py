"""Residuals over windows do not depend on where a window begins, and vanish on the model's own motion."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from carriage import COULOMB, MASS, PERIOD, VISCOUS, measured_log

from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.calibration.prediction_windows import MOST_SAMPLES
from hjcamp.diagnosis.calibration.sufficiency import what_lacks
from hjcamp.diagnosis.calibration.window_length import width_of
from hjcamp.diagnosis.data import segments as layout_module
from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.data.tests import MOST_DELAY, measured_tests
from hjcamp.diagnosis.estimation.gauss_newton import Free
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate
from hjcamp.records.log import TestLog


@pytest.fixture
def analysis(axis: Path) -> Analysis:
    return calibrated(measured_tests([measured_log()]), {}, unknowns=False)


def test_a_window_forgives_its_start(analysis: Analysis) -> None:
    windows, model = analysis.windows, analysis.base.fitted.candidate
    before = windows.features(model)
    errors = windows.errors(model)
    generator = np.random.default_rng(2)
    moving = np.abs(windows.starts[:, 1]) > 0.05
    windows.starts[moving] += 1e-4 * windows.sizes * generator.normal(size=(int(moving.sum()), 2))
    assert np.abs(windows.errors(model) - errors).max() > 1e-5
    # what the wrong starts bring is a thousand times what stays of it
    assert np.abs(windows.features(model) - before)[moving].max() < 0.3


def test_base_parameters_are_found_where_an_independent_solution_has_them(analysis: Analysis) -> None:
    found = {one.name: one for one in intervals(analysis.base.fitted, analysis.search.blocks)}
    for name, true in (("mass", MASS), ("coulomb", COULOMB), ("viscous", VISCOUS)):
        assert found[name].value == pytest.approx(true, rel=0.01), name
        assert found[name].high - found[name].low < 0.1 * true, name
    assert found["delay.voltage"].value < 0.1 * PERIOD


def test_a_delayed_input_is_a_mean_of_two_samples(axis: Path) -> None:
    measured = measured_tests([measured_log(seconds=2.0)])
    layout = Layout(measured, 50)
    late = layout.delayed({"voltage": 1.25 * PERIOD})
    volts = measured.tests[0].inputs[: len(late), 0]
    assert np.allclose(late[2:, 0], 0.75 * volts[1:-1] + 0.25 * volts[:-2])
    assert layout.delayed({"voltage": 0.0}) is layout.inputs
    early = layout.delayed({"voltage": -0.5 * PERIOD})
    assert np.allclose(early[:-1, 0], 0.5 * volts[1:] + 0.5 * volts[:-1])


def test_an_input_that_runs_linearly_acts_by_its_mean_over_the_sample(axis: Path) -> None:
    file = axis / "plants" / "axis.py"
    file.write_text(file.read_text().replace('voltage = Input("V", ', 'voltage = Input("V", hold="linear", '))
    measured = measured_tests([measured_log(seconds=2.0)])
    assert measured.plant.inputs["voltage"].hold == "linear"
    layout = Layout(measured, 50)
    volts = measured.tests[0].inputs[: len(layout.inputs), 0]
    assert np.allclose(layout.inputs[:-1, 0], 0.5 * volts[1:] + 0.5 * volts[:-1])
    # half a sample later that mean is what was logged
    assert np.allclose(layout.delayed({"voltage": 0.5 * measured.period})[:, 0], volts)
    # tests of some windows alone are what was logged: the mean is taken once
    some = Layout(measured, 50, 0.5)
    assert set(some.condensed()[0].inputs[:, 0]) <= set(measured.tests[0].inputs[:, 0])


def test_tests_that_are_too_short_say_what_they_lack(axis: Path) -> None:
    measured = measured_tests([measured_log(seconds=0.6)])
    layout = Layout(measured, width_of(measured))
    assert any("windows" in one for one in what_lacks(measured, layout))
    # windows enough, all of repetitions of one course
    again = [measured_log(seconds=1.0, seed=1, noise=1e-6 * k) for k in range(12)]
    layout = Layout(found := measured_tests(again), 120)
    assert found.repeated and "repetitions share theirs" in what_lacks(found, layout)[0]


def test_a_free_parameter_stays_within_its_bounds() -> None:
    one = Free("", "mass", 10.0, 5.0, 20.0)
    model = Candidate({"mass": 10.0})
    assert one.into(model, 9.0).base["mass"] == 20.0 and one.into(model, -3.0).base["mass"] == 5.0
    log = Free("", "mass", 10.0, 5.0, 20.0, log=True)
    assert log.into(model, np.log(7.0)).base["mass"] == pytest.approx(7.0)


def test_of_a_long_log_runs_of_windows_are_looked_at_that_are_spread_over_it(
    axis: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    measured = measured_tests([measured_log()])
    whole, some = Layout(measured, 50), Layout(measured, 50, 0.3)
    seen = some.looked_at
    assert len(some.of_test) == some.counts[0] == np.count_nonzero(seen) == pytest.approx(0.3 * whole.counts[0], abs=4)
    for all_of, chosen in ((whole.readings, some.readings), (whole.inputs, some.inputs), (whole.time, some.time)):
        shape = (-1, 50, *all_of.shape[1:])
        assert np.array_equal(all_of.reshape(shape)[seen], chosen.reshape(shape))
    halves = [part.sum() for part in np.array_split(seen, 2)]
    assert seen[0] and max(halves) - min(halves) <= 1
    # most windows follow one another: what an effect remembers of the window before is there
    assert np.mean(some.goes_on) > 0.5
    again = Layout(replace(measured, tests=some.condensed()), 50)
    assert np.array_equal(again.readings, some.readings) and np.array_equal(again.begins, some.begins)
    monkeypatch.setitem(MOST_SAMPLES, "quick", len(whole.time) // 4)
    found = calibrated(measured, {}, unknowns=False, effort="quick")
    assert np.mean(found.windows.layout.looked_at) == pytest.approx(0.25, abs=0.05)
    assert found.base.fitted.candidate.base["mass"] == pytest.approx(MASS, rel=0.01)


def test_of_a_short_log_windows_are_shorter_before_it_is_refused(axis: Path) -> None:
    for samples, width in ((400, 16), (500, 20), (5000, 24)):
        measured = measured_tests([measured_log(seconds=samples * PERIOD)])
        assert measured.tests[0].samples == pytest.approx(samples - MOST_DELAY, abs=1)
        found = width_of(measured)
        assert found >= width if samples > 500 else found == width
        assert not what_lacks(measured, Layout(measured, found))


def test_each_of_several_short_tests_ends_with_a_rest_that_is_no_window(axis: Path) -> None:
    logs = [measured_log(seconds=(samples + MOST_DELAY) * PERIOD, seed=samples) for samples in (333, 222)]
    measured = measured_tests(logs)
    found = width_of(measured)
    assert not what_lacks(measured, Layout(measured, found)) and 333 // (555 // 24) + 222 // (555 // 24) < 24


def test_declared_values_may_be_far_off(axis: Path) -> None:
    far = Candidate({"mass": 15.0, "coulomb": 2.0, "viscous": 30.0, "delay.voltage": 0.0}, {})
    found = calibrated(measured_tests([measured_log()]), {}, far, unknowns=False).base.fitted.candidate.base
    for name, true in (("mass", MASS), ("coulomb", COULOMB), ("viscous", VISCOUS)):
        assert found[name] == pytest.approx(true, rel=0.02), name


def test_what_is_stiff_is_cut_short_but_not_what_bends_without_a_state(analysis: Analysis) -> None:
    windows, base = analysis.windows, analysis.base.fitted.candidate
    library = load_effects(plant=analysis.measured.plant)
    windows.kernels.add({name: library[name] for name in ("cubic_spring", "command_delay", "dead_band")})
    strong = base.with_effect("cubic_spring", {"stiffness": 1e7, "rest_position": 0.0})
    late = base.with_effect("command_delay", {"delay": 0.02, "dead_share": 0.0})
    kept = windows.usual_steps
    windows.usual_steps = 1e-3  # no model takes so few
    assert np.all(np.isfinite(windows.features(strong))) and not np.all(np.isfinite(windows.features(late)))
    # a lag makes a command cross a dead band within samples: that takes steps which both need
    assert np.all(np.isfinite(windows.features(late.with_effect("dead_band", {"width": 5.0}))))
    windows.usual_steps = kept


def test_windows_are_no_longer_than_a_start_can_be_followed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("plants").mkdir()
    Path("plants/falling.py").write_text(FALLING, encoding="utf-8")
    # x'' = 400 x + u, held by somebody's loop: a start is 20 times as large after 0.15 s
    time, x, v = np.arange(24000) * PERIOD, 1e-3, 0.0
    places, pushes = np.empty(24000), np.empty(24000)
    for k, wanted in enumerate(2e-3 * np.sin(0.5 * time) + 5e-4 * np.sin(2.1 * time)):
        places[k] = np.round(x / 1e-7) * 1e-7
        pushes[k] = -900.0 * (x - wanted) - 40.0 * v
        for _ in range(20):
            v += PERIOD / 20 * (400.0 * x + pushes[k])
            x += PERIOD / 20 * v
    columns = {"time_s": time, "place_m": places, "push_m_per_s2": pushes}
    measured = measured_tests([TestLog(columns, {"plant": "falling", "period_s": str(PERIOD), "condition": "held"})])
    found = calibrated(measured, {}, unknowns=False)
    assert found.windows.layout.width * PERIOD < 0.2 < width_of(measured) * PERIOD
    assert found.base.fitted.candidate.base["growth"] == pytest.approx(400.0, rel=0.01)


FALLING = '''
from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor


class Falling(Plant):
    r"""A body that falls away from where it is.

    .. math:: \\ddot x = k x + u
    """

    place = State("m", typical=2e-3)
    velocity = State("m/s", typical=0.01)
    push = Input("m/s^2", typical=1.0, text="what holds it")
    growth = Parameter("1/s^2", 250.0, (1.0, 2e3), base=True, text="square of the rate at which it falls away")
    place_m = Measured("eye", of="place")
    loop = "foreign"
    period = 0.002

    @staticmethod
    def equations(state, parameter, drive, rate):
        """Fall."""
        rate.place = state.velocity
        rate.velocity = parameter.growth * state.place + drive.push
        eye = sensor(state.place)
'''


def test_delayed_inputs_are_kept_few_of_long_logs(axis: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    measured = measured_tests([measured_log(seconds=2.0)])
    for limit, kept in ((10**9, 16), (1, 2)):
        monkeypatch.setattr(layout_module, "MOST_BYTES", limit)
        layout, most = Layout(measured, 50), 0
        for k in range(40):
            first = layout.delayed({"voltage": 1e-5 * k})
            assert layout.delayed({"voltage": 1e-5 * k}) is first
            most = max(most, len(layout._delayed))
        assert most == kept
        assert np.array_equal(layout.delayed({"voltage": 3e-5}), Layout(measured, 50).delayed({"voltage": 3e-5}))
