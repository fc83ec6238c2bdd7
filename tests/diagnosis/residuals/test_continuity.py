"""States that nothing measures go on from window to window: by hand, and on two tanks of which only the lower one is seen."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from answer_schemas import check_answer
from asked import analysed
from gauge import BETWEEN, OUTFLOW, PLANT, PUMP, measured_log

from hjcamp.commands.any_plant.next_commands import next_commands
from hjcamp.commands.any_plant.verdict_words import Words
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.estimation.bounded_step import bounded_step
from hjcamp.diagnosis.estimation.gauss_newton import settled, whole_loss
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.diagnosis.residuals.continuity import Passage
from hjcamp.diagnosis.results.answer import answer
from hjcamp.effects import load_effects

UNSEEN, GOES_ON = np.array([True, False]), np.array([False, True, True])
# what the unseen and the measured state change of four readings of each window, and how they go on
READINGS = np.array(
    [
        [[30.0, 40.0], [20.0, 0.0], [10.0, 0.0], [0.0, 0.0]],
        [[30.0, 40.0], [20.0, 0.0], [10.0, 0.0], [0.0, 0.0]],
        [[0.0, 40.0], [25.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
    ]
)
ENDS = np.array([[[0.5, 0.0], [0.1, 1.0]]] * 3)


def passed(jump: float, readings: np.ndarray = READINGS) -> tuple[Passage, np.ndarray]:
    """Return the passage, and what is left of the errors of windows begun wrongly, their unseen state leaping before the third."""
    passage = Passage.of(readings, ENDS, UNSEEN, GOES_ON)
    true, begun = np.zeros((3, 2)), np.array([[0.2, -0.1], [-0.3, 0.2], [0.1, 0.4]])
    true[0] = 0.7, 0.3
    for w in (1, 2):
        true[w] = ENDS[w - 1] @ true[w - 1] + (0.0, 0.25)  # a measured state may begin anywhere
    true[2, 0] += jump
    left = np.einsum("wfs,ws->wf", readings, true - begun)
    return passage, passage.unexplained(left, begun, np.einsum("wst,wt->ws", ENDS, begun))


def test_a_state_that_goes_on_leaves_nothing() -> None:
    assert passed(0.0)[1] == pytest.approx(0.0, abs=1e-12)


def test_a_leap_is_left_over_what_the_noise_of_both_windows_makes_of_it() -> None:
    _, left = passed(0.1)
    assert left[:2] == pytest.approx(0.0, abs=1e-12)
    # the second window's readings (30, 20, 10, 0) tell the unseen state beside the first one's shift: (0, 20, 10, 0)
    before = 1.0 / (20.0**2 + 10.0**2)
    size = 25.0 / np.sqrt(1.0 + 25.0**2 * 0.5**2 * before)
    assert left[2] == pytest.approx([0.0, 0.1 * size, 0.0, 0.0])


def test_what_a_window_does_not_tell_is_as_the_window_before_left_it() -> None:
    blind = READINGS.copy()
    blind[1, :, 0] = 0.0
    passage, left = passed(0.0, blind)
    assert list(passage.open) == [False, True, False]
    assert left == pytest.approx(0.0, abs=1e-12)
    assert passed(0.1, blind)[1][2, 1] > 1.0


def test_where_all_is_measured_or_windows_stand_apart_nothing_goes_on() -> None:
    left = np.random.default_rng(1).normal(size=(3, 4))
    for unseen, goes_on in ((np.zeros(2, dtype=bool), GOES_ON), (UNSEEN, np.zeros(3, dtype=bool))):
        passage = Passage.of(READINGS, ENDS, unseen, goes_on)
        found = passage.unexplained(left, np.zeros((3, 2)), np.ones((3, 2)))
        assert np.einsum("wfs,wf->ws", READINGS, found) == pytest.approx(0.0, abs=1e-9)


def test_a_step_within_bounds_moves_the_others_as_is_best_beside_what_stands_there() -> None:
    curvature, downhill = np.array([[1.0, 0.9], [0.9, 1.0]]), np.array([1.0, 1.0])
    wide = np.full(2, 10.0)
    assert bounded_step(curvature, downhill, -wide, wide) == pytest.approx([1 / 1.9, 1 / 1.9])
    # cut afterwards the second would go by 1 / 1.9
    assert bounded_step(curvature, downhill, -wide, np.array([0.0, 10.0])) == pytest.approx([0.0, 1.0])
    assert bounded_step(1e-3 * curvature, downhill, -wide, wide) == pytest.approx([2.0, 2.0])  # no further
    assert bounded_step(np.full((2, 2), np.nan), downhill, -wide, wide) == pytest.approx([0.0, 0.0])


@pytest.fixture
def tanks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "tanks.py").write_text(PLANT)
    monkeypatch.chdir(tmp_path)


@pytest.mark.usefixtures("tanks")
def test_the_time_constants_of_a_tank_that_is_not_seen_are_told() -> None:
    analysis = calibrated(measured_tests([measured_log(samples=800)]), {}, unknowns=False)
    found = {one.name: one for one in intervals(analysis.base.fitted, analysis.search.blocks)}
    for name, true in (("k1", BETWEEN), ("k3", OUTFLOW), ("k4", PUMP)):
        # in windows of 96 s that stand apart k3 and k4 are known to some 20 % alone
        assert found[name].value == pytest.approx(true, rel=0.03)
        assert found[name].high - found[name].low < 0.12 * true


@pytest.mark.usefixtures("tanks")
def test_a_fit_goes_on_where_a_parameter_stands_at_its_bound() -> None:
    measured = measured_tests([measured_log(brim=7.0, samples=800)])
    # those that a diagnosis of such tests considers
    analysis = analysed(measured, ("flow_exponent_at_outflow", "overflow_at_upper", "spill_over"))
    begun = {"brim": 5.0, "spill": 0.1, "caught": 1.0}
    candidate = analysis.base.fitted.candidate.with_effect("spill_over", begun)
    free = analysis.search.free_of(candidate)
    found = settled(analysis.windows, candidate, free).candidate.effects["spill_over"]
    assert found["brim"] == pytest.approx(7.0, rel=0.05) and found["caught"] == pytest.approx(0.5, abs=0.05)


@pytest.mark.usefixtures("tanks")
@pytest.mark.parametrize("turns", [0, 1, 20])
def test_a_fit_ends_with_windows_that_begin_where_it_fits_best(turns: int) -> None:
    analysis = calibrated(measured_tests([measured_log(samples=800)]), {}, unknowns=False)
    windows, start = analysis.windows, analysis.base.fitted.candidate.with_base({"k4": 1.3 * PUMP})
    found = settled(windows, start, analysis.search.free_of(start), turns=turns)
    assert found.loss == whole_loss(windows.features(found.candidate), found.candidate, found.free)
    # nothing of it is owed to what another model's starts explain
    windows.renew(found.candidate)
    assert found.loss == pytest.approx(whole_loss(windows.features(found.candidate), found.candidate, found.free), rel=1e-6)


@pytest.mark.usefixtures("tanks")
@pytest.mark.study
def test_a_spill_is_named_beside_a_gauge_that_is_bent_and_the_bend_is_told() -> None:
    measured = measured_tests([measured_log(brim=7.0, bend=0.15)])
    names = ("spill_over", "overflow_at_upper", "sensor_offset", "flow_exponent_at_outflow")
    library = {name: one for name, one in load_effects(plant=measured.plant).items() if name in names}
    analysis = calibrated(measured, library)
    found = analysis, decided(analysis)
    content = json.loads(json.dumps(answer(*found, 0.0), allow_nan=False))
    check_answer(content)
    # an offset of the gauge takes part of the bend, and is needless beside a free law that takes all of it
    assert (content["verdict"], content["effects"]) == ("effect", ["spill_over"])
    assert content["unknowns"][0]["driver"] == "gauge_true" and content["law_left"] > 0.5
    words = Words(*found, content)
    said = " ".join(words.sentences())
    told = "missing as well: in addition to what was found, a reading at gauge that depends on its true value explains the last"
    assert told in said
    assert next_commands(words, "logs", "published")[1].startswith("hjcamp effects new MY_EFFECT --from diagnose")
