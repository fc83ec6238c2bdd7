"""What a model errs by over whole tests, against the closed form; windows that begin anew do not see it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from slab import NOISE, course

from hjcamp.commands.any_plant.comparison_words import whole_table
from hjcamp.commands.any_plant.words import DIVERGES, divergence_words
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.residuals.free_run import whole_error
from hjcamp.diagnosis.results.channel_rows import whole_rows
from hjcamp.diagnosis.results.comparison import compared
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.candidate import Candidate
from hjcamp.records.log import TestLog

SWING = '''"""A mass on a spring."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor


class Swing(Plant):
    """A mass on a spring, which hardly loses anything."""

    x = State("m", typical=1.0)
    v = State("m/s", typical=1.0)
    push = Input("m/s^2")
    pull = Parameter("1/s^2", 1.0, (0.1, 10.0), base=True)
    loss = Parameter("1/s", 1e-3)
    period = 0.1
    x_m = Measured("probe", of="x")

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.x = state.v
        rate.v = drive.push - parameter.pull * state.x - parameter.loss * state.v
        probe = sensor(state.x)
'''


def test_whole_tests_err_by_what_the_closed_form_does_from_the_best_start(slab: Measured) -> None:
    analysis = calibrated(slab, {}, unknowns=False)
    layout = analysis.windows.layout
    assert not layout.memory
    declared = Candidate({"loss": 2.0}, {})
    found = whole_error(analysis.windows, declared)
    assert found is not None
    squares, spreads = [], []
    for test in slab.tests:
        rows = slice(0, len(test.time) // layout.width * layout.width)
        power, warmth = test.inputs[rows, layout.names.index("power")], test.readings[rows, 0]
        # linear in its start: the best one by least squares
        driven, free = course(2.0, 0.0, power), course(2.0, 1.0, 0.0 * power)
        start = np.linalg.lstsq(free[:, None], warmth - driven, rcond=None)[0][0]
        squares.append((warmth - driven - start * free) ** 2)
        spreads.append((warmth - warmth.mean()) ** 2)
    least, spread = np.mean(np.concatenate(squares)), np.mean(np.concatenate(spreads))
    assert found.rms[0] == pytest.approx(np.sqrt(least), rel=1e-3)
    assert found.explained[0] == pytest.approx(1.0 - least / spread, abs=1e-4)
    # what is calibrated leaves the noise in whole tests, too
    fitted = whole_error(analysis.windows, analysis.base.fitted.candidate)
    assert fitted is not None and fitted.rms[0] == pytest.approx(NOISE, rel=0.1)
    assert found.rms[0] > 10.0 * fitted.rms[0]


def test_tests_that_a_loop_outside_the_equations_holds_are_not_simulated_whole(slab: Measured) -> None:
    analysis = calibrated(slab, {}, unknowns=False)
    plant = find_plant("slab")
    plant.loop = "foreign"
    assert whole_error(analysis.windows, analysis.base.fitted.candidate) is None


def test_what_does_not_forget_its_start_or_runs_away_is_not_simulated_whole(slab: Measured) -> None:
    windows = calibrated(slab, {}, unknowns=False).windows
    assert whole_error(windows, Candidate({"loss": 2.0}, {})) is not None
    # forgotten to 1/e after 200 s / loss: never within 3000 s, and growing
    for loss in (0.01, -5.0):
        assert whole_error(windows, Candidate({"loss": loss}, {})) is None


def swings(driven: bool) -> Measured:
    """A mass on a spring that is let go twice, and pushed by hardly anything, or by nothing."""
    Path("plants/swing.py").write_text(SWING)
    generator, time, logs = np.random.default_rng(4), np.arange(1500) * 0.1, []
    for number, size in enumerate((1.0, 0.6)):
        x = size * np.exp(-0.5e-3 * time) * np.cos(1.03 * time) + 1e-3 * generator.standard_normal(len(time))
        columns = {"time_s": time, "x_m": x, "push_m_per_s2": 1e-6 * (time > 70.0) * driven}
        logs.append(TestLog(columns, {"plant": "swing", "period_s": "0.1", "condition": str(number)}))
    return measured_tests(logs)


@pytest.mark.parametrize("driven", [False, True])
def test_what_nothing_drives_is_simulated_whole_though_it_does_not_forget_its_start(slab: Measured, driven: bool) -> None:
    windows = calibrated(swings(driven), {}, unknowns=False).windows
    assert not windows.layout.memory
    # 1 % in the frequency are two radians in so long
    right, wrong = (whole_error(windows, Candidate({"pull": pull}, {})) for pull in (1.03**2, 1.04**2))
    if driven:
        assert right is None and wrong is None
    else:
        assert right is not None and right.rms[0] == pytest.approx(1e-3, rel=0.1)
        assert wrong is not None and wrong.rms[0] > 0.1


def test_what_grows_over_whole_tests_beside_what_was_found_is_said() -> None:
    def row(before: float, after: float) -> dict[str, object]:
        return {"unit": "deg", "baseline": {"whole_rms": before}, "augmented": {"whole_rms": after}}

    [said] = divergence_words({"whole_tests": {"arm_angle": row(0.743, 2.42), "slip": row(1.0, 1.1)}, "runs_away": []})
    assert said.startswith("With what was found the error of whole tests grows: arm angle (0.743 -> 2.42 deg).")


def test_a_model_that_runs_away_beside_one_that_does_not_is_said_to(slab: Measured) -> None:
    analysis = calibrated(slab, {}, unknowns=False)
    fitted = analysis.base.fitted
    wild = replace(analysis.base, fitted=replace(fitted, candidate=Candidate({"loss": -5.0}, {})))
    found = whole_rows(analysis, wild)
    assert found == {"whole_tests": {}, "runs_away": ["augmented"]}
    assert divergence_words(found)[0].startswith("The model with what was found diverges")
    assert whole_rows(analysis, analysis.base)["runs_away"] == []
    # where nothing is simulated whole nothing runs away
    plant = find_plant("slab")
    plant.loop = "foreign"
    assert whole_rows(analysis, wild) == {"whole_tests": {}, "runs_away": []}


def test_a_comparison_says_which_model_runs_away(slab: Measured) -> None:
    models = {"wild": Candidate({"loss": -5.0}, {}), "published": Candidate({"loss": 2.0}, {})}
    table = whole_table(compared(slab, {}, models))
    assert table is not None and [row[0] for row in table[1]] == ["wild", "published", "published, calibrated here"]
    assert table[1][0][1:] == [DIVERGES, ""] and table[1][1][1].endswith(" K")
