"""Tests are simulated through where the plant remembers longer than a window and forgets within a block."""

from __future__ import annotations

import functools
import json
from dataclasses import replace
from pathlib import Path

import gauge
import numpy as np
import pytest
from asked import asked

from hjcamp import cli
from hjcamp.diagnosis.calibration import analysis
from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.residuals.continuity import Through
from hjcamp.diagnosis.results.answer import answer
from hjcamp.diagnosis.validation.blocks import blocks_of
from hjcamp.model.declare.candidate import Candidate
from hjcamp.records.write import write_log

NAMES = ("flow_exponent_at_outflow", "overflow_at_upper", "spill_over")


def logged(samples: int, brim: float = np.inf) -> Measured:
    return measured_tests([gauge.measured_log(brim=brim, seed=2, samples=samples)])


@functools.cache
def base_on(samples: int) -> Analysis:
    """Return the base calibrated on a log of so many samples; the plant's file has to be there."""
    return calibrated(logged(samples), {}, unknowns=False)


def test_what_the_start_of_a_test_explains_is_taken_out_of_all_its_windows() -> None:
    generator = np.random.default_rng(3)
    of_test = np.array([0, 0, 0, 1, 1])
    readings = generator.normal(size=(5, 4, 2)) * 100.0
    wrong = np.array([[1.0, -2.0], [0.5, 3.0]])
    left = np.einsum("wfs,ws->wf", readings, wrong[of_test])
    passage = Through.of(readings, of_test)
    starts = np.zeros((5, 2))
    np.testing.assert_allclose(passage.unexplained(left, starts, starts), 0.0, atol=1e-10)
    np.testing.assert_allclose(passage.begun(left, starts, starts)[0], wrong[of_test])
    # what lies across all that a start can do stays as it is
    across = generator.normal(size=(5, 4))
    for rows in (of_test == 0, of_test == 1):
        span = readings[rows].reshape(-1, 2)
        flat = across[rows].ravel()
        across[rows] = (flat - span @ np.linalg.lstsq(span, flat, rcond=None)[0]).reshape(-1, 4)
    np.testing.assert_allclose(passage.unexplained(left + across, starts, starts), across, atol=1e-10)


def test_short_tests_are_simulated_through_and_long_ones_in_windows(tanks: Path) -> None:
    layout = base_on(800).windows.layout
    assert layout.memory > layout.width
    # one test: one start
    assert layout.begun.sum() == 1 and not layout.goes_on.any()
    # no block is shorter than what the plant remembers
    sizes = np.bincount(blocks_of(layout)) * layout.width
    assert sizes.min() >= layout.memory - layout.width and len(sizes) >= 8
    assert base_on(4000).windows.layout.memory == 0
    assert base_on(300).windows.layout.memory == 0


def test_readings_of_a_test_that_is_simulated_through_leap_nowhere(tanks: Path) -> None:
    windows, base = base_on(800).windows, base_on(800).base.fitted.candidate
    through = windows.readings(base)[0][:, 0]
    cut = replace(windows, layout=replace(windows.layout, memory=0), starts=windows.starts * 1.02)
    leaps = np.abs(np.diff(through))[windows.layout.width - 1 :: windows.layout.width]
    others = np.abs(np.diff(cut.readings(base)[0][:, 0]))[windows.layout.width - 1 :: windows.layout.width]
    assert leaps.max() < 0.5 * others.max()


@pytest.mark.study
def test_a_spill_in_few_places_of_a_short_log_is_named(tanks: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    measured = logged(800, brim=7.0)

    def said() -> tuple[str, list[str]]:
        found = answer(*asked(measured, NAMES), 0.0)
        return found["verdict"], found["effects"]

    # the other one limits the same tank at the same brim
    word, names = said()
    assert word in ("effect", "one_of") and names[0] == "spill_over"
    monkeypatch.setattr(analysis, "simulated_through", lambda windows, base, free: windows)
    assert said() == ("cannot_tell", [])


def test_one_set_of_logs_is_looked_at_in_one_way_whatever_is_asked(tanks: Path) -> None:
    fast = Candidate({"k1": 0.5, "k3": 0.5, "k4": 0.4}, {})
    assert calibrated(base_on(800).measured, {}, fast, unknowns=False).windows.layout == base_on(800).windows.layout


def test_next_plans_with_tests_that_are_simulated_through(tanks: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("logs").mkdir()
    write_log(Path("logs/a.mcap"), gauge.measured_log(brim=7.0, seed=2, samples=800))
    only = ["--only", ",".join(NAMES), "--effort", "quick"]
    assert cli.run(["diagnose", "logs", *only]) == 0, capsys.readouterr().err
    said = capsys.readouterr().out
    assert "each test simulated through from its own start: the plant remembers" in said and ", tests simulated through" in said
    answer_of = json.loads(Path("diagnose/answer.json").read_text())
    assert answer_of["simulated_through"] and answer_of["verdict"] in ("effect", "one_of")
    assert answer_of["effects"][0] == "spill_over"
    assert cli.run(["next", "logs", "--rivals", "spill_over,overflow_at_upper"]) == 0, capsys.readouterr().err
    said = " ".join(capsys.readouterr().out.split())
    assert "To distinguish: spill_over" in said and "standard deviations" in said
    assert cli.run(["compare", "logs"]) == 0
    assert "each test simulated through" in capsys.readouterr().out
    assert "Predictions begin with each test, where each fits best" in Path("compare/index.html").read_text()
