"""The number of a run that a sweeper makes small: read once, refused with a reason, the mean over tests of a formula."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from hjcamp.campaign.plan.objective import read_objectives
from hjcamp.campaign.plan.sweep_results import JobResult, SweepResult
from hjcamp.errors import HjcampError, UsageError
from hjcamp.report.runs.indicators import frame_of


def frame(*rows: tuple[str, float, float, float | None]):
    names = ("condition", "rmse1_deg", "e_max_deg", "sse_deg")
    return frame_of(dict(zip(names, row, strict=True)) for row in rows)


RUN = frame(("a", 1.0, 4.0, -0.5), ("a", 3.0, 9.0, 0.5), ("ramp", 2.0, 1.0, None))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("rmse1_deg", 2.0),
        ("rmse1_deg + 0.1*e_max_deg", 2.0 + 0.1 * 14.0 / 3.0),
        ("-rmse1_deg**2 / 2", -(1.0 + 9.0 + 4.0) / 6.0),
        ("max(rmse1_deg, sqrt(e_max_deg))", (2.0 + 3.0 + 2.0) / 3.0),
    ],
)
def test_the_value_is_the_mean_over_tests(text: str, value: float) -> None:
    [objective] = read_objectives(text)
    assert objective.of(RUN) == pytest.approx(value)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("rmse1_dg", "did you mean 'rmse1_deg'"),
        ("trajectory", "unknown indicator 'trajectory'"),
        ("3", "names no indicator"),
        (2.5, "names no indicator"),
        ("rmse1_deg +", "is no formula"),
        ("'rmse1_deg'", "is no number"),
        ("rmse1_deg > 2", "is no number"),
        ("rmse1_deg.real", "is no number"),
        ("print(rmse1_deg)", "is no number"),
        ("[rmse1_deg]", "is no number"),
        ("rmse1_deg" + " + 1" * 200, "at most 300 characters"),
        ("rmse1_deg/0", "no finite number, whatever"),
        ("rmse1_deg*(-1)**0.5", "no finite number, whatever"),
        ([], "names nothing"),
        (["rmse1_deg", "kp"], "unknown indicator 'kp'"),
    ],
)
def test_what_is_no_number_of_a_run_is_refused(given: object, said: str) -> None:
    with pytest.raises(UsageError, match="objective=") as error:
        read_objectives(given)
    assert said in str(error.value)


def test_an_indicator_that_some_tests_lack_is_said_with_their_conditions() -> None:
    with pytest.raises(HjcampError, match=r"1 test has no sse_deg \(ramp\)"):
        read_objectives("abs(sse_deg)")[0].of(RUN)


@pytest.mark.parametrize("text", ["1/(rmse1_deg-1)", "sqrt(-rmse1_deg)", "(-rmse1_deg)**0.5", "rmse1_deg*1e308*10"])
def test_no_finite_number_is_an_error(text: str) -> None:
    with pytest.raises(HjcampError, match="no finite number"):
        read_objectives(text)[0].of(RUN)


def test_the_best_jobs_are_those_that_no_other_beats() -> None:
    values = [(1.0, 9.0), (2.0, 2.0), (3.0, 3.0), (0.5, 1.0)]
    jobs = tuple(JobResult(Path(str(n)), {"kp": str(n)}, one) for n, one in enumerate(values))
    objectives = read_objectives(["rmse1_deg", "e_max_deg"])
    found = SweepResult(Path(), objectives, ("minimize", "maximize"), ("kp",), jobs)
    assert [one.path.name for one in found.best] == ["3", "0"]
    alone = SweepResult(
        Path(), objectives[:1], ("minimize",), ("kp",), tuple(JobResult(Path("0"), {}, (math.pi,)) for _ in "ab")
    )
    assert len(alone.best) == 2
    assert alone.next_command() == "hjcamp run seed=2"
