"""Where a test begins tells a constant error of the arm encoder, if the arm began at its own zero."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from test_hidden_effects_end_to_end import RIVALS
from truth.pump_joint.case import write_case

from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis.fitting.heldout import judged_error
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence, home_reading, prepare
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.views import CHANNELS, HOME, Views
from hjcamp.records.find import find_logs, read_logs
from hjcamp.records.log import TestLog


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[TestLog]:
    folder = tmp_path_factory.mktemp("home") / "biased"
    write_case(folder, ["encoder_bias"], "medium", 7)
    return read_logs(find_logs([folder]))


def test_only_a_test_that_begins_at_the_arms_zero_tells(logs: list[TestLog]) -> None:
    by_loop = {log.metadata["controller"]: log for log in logs}
    opened, closed = by_loop["open_loop"], by_loop["pid"]
    first = float(opened.columns["arm_deg"][0])
    assert home_reading(opened) == pytest.approx(math.radians(first))
    assert math.isnan(home_reading(closed))
    elsewhere = {**opened.columns, "reference_deg": opened.columns["reference_deg"] + 20.0}
    assert math.isnan(home_reading(replace(opened, columns=elsewhere)))
    silent = {name: values for name, values in opened.columns.items() if name != "reference_deg"}
    assert math.isnan(home_reading(replace(opened, columns=silent)))


def test_a_loop_closed_within_the_log_leaves_the_first_reading_as_it_was(logs: list[TestLog]) -> None:
    closed = next(log for log in logs if log.metadata["controller"] == "pid")
    rows = len(closed.columns["time_s"])
    before = {name: np.concatenate([np.full(200, values[0]), values]) for name, values in closed.columns.items()}
    before["phase"] = np.concatenate([np.full(200, 2.0), np.full(rows, 3.0)])
    before["arm_deg"][0] = 1.5
    assert home_reading(replace(closed, columns=before)) == pytest.approx(math.radians(1.5))


@pytest.mark.study
def test_the_bias_takes_up_what_the_first_readings_show(logs: list[TestLog]) -> None:
    evidence = prepare([log for log in logs if log.metadata["controller"] == "open_loop"][:4])
    bias = float(np.mean([test.home for test in evidence.tests]))
    assert abs(bias) > 2 * evidence.home_scatter / math.sqrt(4)
    everything = load_effects([])
    effects = tuple(everything[name] for name in RIVALS)
    views, features = Views(evidence, effects), Features(evidence)

    def error(candidate: Candidate) -> np.ndarray:
        seen = features.of(views.residuals(candidate))
        judged.append(judged_error(features, features.mean_square(seen), features.noise_floor(seen), [0, 1]))
        return features.mean_square(seen)[:, HOME]

    judged: list[float] = []
    without = error(Candidate({}))
    found = error(Candidate({}, {"encoder_bias": {"bias": bias}}))
    assert np.sqrt(without.mean()) >= abs(bias)
    assert found.mean() < 0.3 * without.mean()
    assert judged[1] < judged[0] - 0.3
    assert CHANNELS[HOME] == "home"


def test_arms_that_begin_anywhere_say_nothing(logs: list[TestLog]) -> None:
    evidence = prepare([log for log in logs if log.metadata["controller"] == "open_loop"][:4])
    assert np.all(np.isfinite(evidence.homes))
    left = [replace(test, home=math.radians(angle)) for test, angle in zip(evidence.tests, (-8, -20, -35, -11), strict=True)]
    assert np.all(np.isnan(Evidence(tuple(left)).homes))
    assert Evidence(tuple(left)).home_scatter == pytest.approx(0.5 * 2 * math.pi / 1024)


def test_one_test_alone_is_known_to_half_a_count(logs: list[TestLog]) -> None:
    evidence = prepare(logs[:1])
    assert Evidence(evidence.tests).home_scatter == pytest.approx(0.5 * 2 * math.pi / 1024)
