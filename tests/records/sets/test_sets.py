"""Logs looked at as a set: copies, one unlike its repetitions, columns that some lack, two tests in one log."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import wrong_logs as wrong
from wrong_logs import Wrong, carriage_mistakes, carriage_set, joint_mistakes, joint_set, said

from hjcamp.errors import UsageError
from hjcamp.records.log import TestLog
from hjcamp.records.sets.copies import counted_once
from hjcamp.records.sets.look import look_at, refuse_odd
from hjcamp.records.write import write_log
from hjcamp.report.build import build_report

Change = Callable[[list[TestLog]], list[TestLog]]


@pytest.fixture(scope="module")
def joint() -> list[TestLog]:
    return [log for log in joint_set() if log.metadata["condition"] in ("triangle_slow", "ramp_hold")]


@pytest.fixture
def carriages(empty_folder: Path) -> list[TestLog]:
    return carriage_set(empty_folder)


def named(mistakes: list[Wrong], name: str) -> Change:
    return next(one.make for one in mistakes if one.name == name)


def of_wrong(logs: list[TestLog], make: Change) -> list[str]:
    """Return what is said of the logs that a mistake changes."""
    changed = make(logs)
    return said(changed, {one.path for one in changed if one.path and not any(one is log for log in logs)})


COPIES = [one.name for one in carriage_mistakes() if one.name.startswith("copied")]


@pytest.mark.parametrize("name", COPIES)
def test_a_copy_counts_once(joint: list[TestLog], carriages: list[TestLog], name: str) -> None:
    for logs, mistakes, original in (
        (joint, joint_mistakes(), "triangle_slow_r2"),
        (carriages, carriage_mistakes(), "swing_r2"),
    ):
        made = named(mistakes, name)(logs)
        kept, copies = counted_once(made)
        assert kept == logs and [str(one.original.path) for one in copies] == [f"{original}.mcap"]
        assert any(
            f"_copied.mcap: warning: is a copy of {original}.mcap" in line for line in of_wrong(logs, named(mistakes, name))
        )
        # whatever the order
        assert [str(one.original.path) for one in counted_once(made[::-1])[1]] == [f"{original}.mcap"]


@pytest.mark.parametrize("older", ["copied.mcap", "swing_r1.mcap"])
def test_of_two_copies_the_older_file_is_the_original(carriages: list[TestLog], older: str) -> None:
    for age, name in enumerate(sorted(["copied.mcap", "swing_r1.mcap"], key=older.__ne__)):
        Path(name).touch()
        os.utime(name, (1e9 + age, 1e9 + age))
    logs = [carriages[0], replace(carriages[0], path=Path("copied.mcap"))]
    for both in (logs, logs[::-1]):
        (kept,), (copy,) = counted_once(both)
        assert str(kept.path) == older and str(copy.original.path) == older


def test_a_loop_that_hunts_may_look_like_another_condition(carriages: list[TestLog]) -> None:
    # what drives the plant is fed back: two repetitions in phase by chance, and one as the tests of another condition are
    def swinging(log: TestLog, phase: float) -> TestLog:
        time = log.columns["time_s"]
        swing = np.sin(7.0 * time + phase) + 1e-3 * np.random.default_rng([*str(log.path).encode()]).standard_normal(len(time))
        columns = {"position_m": 0.1 * swing, "voltage_v": -5.0 * swing, "current_a": -2.5 * swing}
        return replace(log, columns={**log.columns, **columns})

    phases = (0.0, 0.002, 2.0, 2.0, 2.003, 1.998)
    logs = [*(swinging(log, phase) for log, phase in zip(carriages[:6], phases, strict=True)), *carriages[6:]]
    assert [one.line for one in look_at(logs) if one.finding.refused] == []


def test_sound_repetitions_are_none_of_this(joint: list[TestLog], carriages: list[TestLog]) -> None:
    assert look_at(joint) == [] and look_at(carriages) == [] and look_at(carriages[::-1]) == []


def test_a_simulation_without_scatter_is_no_copy_and_counts_once(carriages: list[TestLog]) -> None:
    made = [
        replace(carriages[0], metadata={**carriages[0].metadata, "backend": "simulation", "seed": str(k)}) for k in range(3)
    ]
    kept, copies = counted_once(made)
    assert len(kept) == 1 and all("without scatter every repetition of a simulation is the same" in one.text for one in copies)


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("sign of position_m", "'position_m' differs from all its 2 repetitions, and agrees with them with the other sign"),
        ("sign of the voltage", "'voltage_v' differs from all its 2 repetitions, and agrees with them with the other sign"),
        ("position in mm", "agrees with them with mm read as m"),
        ("backwards in time", "agrees with them backwards in time"),
        ("a test of another condition under this name", "agrees with the tests of condition 'swing': its condition is wrong"),
        ("two tests one after the other", "holds the test of its 2 repetitions twice"),
        ("every second row lost, the clock going on", "every second row lost"),
    ],
)
def test_a_mistake_that_explains_a_log_is_refused(carriages: list[TestLog], name: str, told: str) -> None:
    made = named(carriage_mistakes(), name)(carriages)
    with pytest.raises(UsageError, match="mend it, or leave it out") as refused:
        refuse_odd(made)
    assert told in str(refused.value) and str(refused.value).startswith("swing_r2.mcap: ")


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("current_a times 2", "agrees with them times 0.5"),
        ("zero of position_m moved by its travel", "m added"),
        ("begun a fifth of a test late", "begun 1.2 s later"),
        ("position_m dead from half way", "find out why, or leave it out"),
        ("current missing", "'current_a' is missing here, while 8 logs of the set have it; an analysis leaves it out"),
        ("wind missing", "'wind_n' is missing here, while 8 logs of the set have it; it is taken as its default there, 0 SI"),
    ],
)
def test_what_no_single_mistake_explains_is_named(carriages: list[TestLog], name: str, told: str) -> None:
    lines = of_wrong(carriages, named(carriage_mistakes(), name))
    assert any(told in line and "swing_r2.mcap: warning: " in line for line in lines), lines


@pytest.mark.parametrize(
    ("name", "told"), [("sign of arm_deg", "with the other sign"), ("pressures exchanged", "with 'pressure1_mpa' and")]
)
def test_of_two_repetitions_the_one_against_the_others_is_named(joint: list[TestLog], name: str, told: str) -> None:
    pairs = [joint[k] for k in (0, 1, 3, 4)]
    (found,) = [one for one in look_at(named(joint_mistakes(), name)(pairs)) if one.odd]
    assert found.finding.refused and told in found.finding.text and str(found.log.path) == "triangle_slow_r2.mcap"


@pytest.mark.parametrize("name", ["a hole in the command phase", "two tests in one log", "phases 3, 4, 3, 4, ..."])
def test_a_command_phase_is_one_stretch(joint: list[TestLog], name: str) -> None:
    log = named(joint_mistakes(), name)(joint)[1]
    with pytest.raises(
        UsageError, match=r"triangle_slow_r2.mcap: the command phase \(phase 3\) comes in \d+ stretches \(0 to "
    ):
        _ = log.command_phase
    assert any("error: the command phase" in line for line in said([log], {Path("triangle_slow_r2.mcap")}))


def test_tests_that_do_not_repeat_accuse_none(carriages: list[TestLog]) -> None:
    # three swings of random phase, as of a loop that hunts
    hunting = []
    for k, log in enumerate(carriages[:3]):
        time = log.columns["time_s"]
        noise = 1e-4 * np.random.default_rng(k).standard_normal(len(time))
        hunting.append(replace(log, columns={**log.columns, "position_m": 0.1 * np.sin(7.0 * time + 2.3 * k) + noise}))
    assert [one.line for one in look_at([*hunting, *carriages[3:]]) if one.odd] == []


def test_the_mistakes_are_as_many_as_asked() -> None:
    assert len(joint_mistakes()) >= 30 and len(carriage_mistakes()) >= 39 and wrong.JOINT


def test_a_report_counts_a_copy_once_and_names_a_log_unlike_its_repetitions(joint: list[TestLog], tmp_path: Path) -> None:
    made = named(joint_mistakes(), "copied without the first row")(joint[:3])
    made = wrong.changed(wrong.scaled("arm_deg", -1.0), at=2)(made)
    for log in made:
        write_log(tmp_path / "logs" / f"{log.path}", log)
    found = build_report(tmp_path / "logs", output=tmp_path / "page")
    assert len(found.indicators) == 3 and found.by_condition["n"].to_list() == [3]
    page = found.page.read_text(encoding="utf-8")
    assert "1 log left out" in page and "is a copy of" in page and "agrees with them with the other sign" in page
