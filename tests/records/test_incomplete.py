"""A channel or an optional input that some logs of a set lack: which logs count, said of each, for every command."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from wrong_logs import CARRIAGE, carriage_set

from hjcamp.analyses.data import sound_logs
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.records.log import TestLog
from hjcamp.records.recover import verify_logs
from hjcamp.records.sets.copies import counted_once
from hjcamp.records.sets.glance import Glance
from hjcamp.records.sets.incomplete import complete_logs, incomplete
from hjcamp.records.write import write_log
from hjcamp.report.build import build_report


@pytest.fixture
def carriages(empty_folder: Path) -> list[TestLog]:
    logs = carriage_set(empty_folder)
    # a wind that blows: its default is no good guess
    return [replace(log, columns={**log.columns, "wind_n": log.columns["wind_n"] + 0.3}) for log in logs]


def without(field: str, log: TestLog) -> TestLog:
    return replace(log, columns={name: values for name, values in log.columns.items() if name != field})


def lacking(field: str, places: tuple[int, ...], logs: list[TestLog]) -> list[TestLog]:
    return [without(field, log) if k in places else log for k, log in enumerate(logs)]


@pytest.mark.parametrize(
    ("field", "of", "places", "left_out", "sensors", "said"),
    [
        ("current_a", 9, (4,), (4,), 2, "while 8 logs of the set have it; an analysis leaves it out"),
        (
            "current_a",
            9,
            (1, 4),
            (1, 4),
            2,
            "and so in 1 more log, while 7 logs of the set have it; an analysis leaves them out",
        ),
        ("current_a", 9, (0, 1, 2, 3, 4), (), 1, "leaves this channel out of all, which keeps most readings"),
        ("current_a", 2, (1,), (1,), 2, "while 1 log of the set has it; an analysis leaves it out"),
        ("wind_n", 9, (4,), (4,), 2, "an analysis leaves it out: its default need not be what acted here"),
        ("wind_n", 2, (0,), (0,), 2, "an analysis leaves it out: its default need not be what acted here"),
        ("wind_n", 9, (0, 1, 2, 3, 4), (), 2, "it is taken as its default there, 0 SI"),
    ],
)
def test_a_log_that_lacks_what_most_have_is_left_out(
    carriages: list[TestLog], field: str, of: int, places: tuple[int, ...], left_out: tuple[int, ...], sensors: int, said: str
) -> None:
    logs = lacking(field, places, carriages[:of])
    sound = sound_logs(logs)
    assert sound.logs == [log for k, log in enumerate(logs) if k not in left_out]
    assert sound.doubtful.count("is missing here") == 1 and said in sound.doubtful
    for measured in (
        measured_tests(logs),
        measured_tests(sound.logs, sound.copies, sound.odd, sound.missing),
    ):
        assert len(measured.sensors) == sensors and len(measured.tests) == of - len(left_out)
        assert measured.missing == tuple((str(logs[k].path), field) for k in left_out)
    for log in logs:
        write_log(Path(log.path.name), log)
    told = {
        one.path.name: "".join(each.text for each in one.findings) for one in verify_logs([Path(log.path.name) for log in logs])
    }
    assert [said in told[log.path.name] for log in logs] == [k in places for k in range(of)]


def test_an_input_that_is_at_its_default_wherever_it_was_logged_leaves_none_out(empty_folder: Path) -> None:
    logs = lacking("wind_n", (4,), carriage_set(empty_folder))
    kept, (found,) = complete_logs(logs)
    assert kept == logs and not found.left_out and found.log is logs[4]


def test_a_log_of_few_channels_does_not_take_an_input_along(carriages: list[TestLog]) -> None:
    # each log lacks something else: what is left out for one counts no more for the other
    logs = lacking("wind_n", (0,), lacking("current_a", (1,), carriages))
    kept, found = complete_logs(logs)
    assert kept == logs[2:] and {(logs.index(one.log), one.field) for one in found if one.left_out} == {
        (0, "wind_n"),
        (1, "current_a"),
    }


FIELDS = ("position_m", "current_a")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(
    st.lists(
        st.tuples(st.sets(st.sampled_from(FIELDS), min_size=1), st.booleans(), st.integers(64, 3000)), min_size=1, max_size=9
    )
)
def test_what_is_kept_is_complete_and_most(empty_folder: Path, rows: list[tuple[set[str], bool, int]]) -> None:
    metadata = {"plant": "drive", "period_s": "0.002", "condition": "a"}
    (empty_folder / "plants").mkdir(exist_ok=True)
    (empty_folder / "plants" / "drive.py").write_text(CARRIAGE, encoding="utf-8")
    logs = [
        Glance(
            TestLog({}, metadata),
            frozenset(fields | ({"wind_n"} if wind else set())),
            samples,
            frozenset({"wind_n"} if wind else ()),
            {},
        )
        for fields, wind, samples in rows
    ]
    found = incomplete(logs)
    out = {id(one.log) for one in found if one.left_out}
    kept = [one for one in logs if id(one.log) not in out]
    assert kept
    shared = frozenset.intersection(*(one.fields for one in kept))
    # with half of the logs or more, a wind that blows is known in all that are kept
    assert "wind_n" in shared or 2 * sum("wind_n" in one.fields for one in kept) < len(kept)
    if not any("wind_n" in one.fields for one in logs):
        readings = len(shared) * sum(one.samples for one in kept)
        for names in ({"position_m"}, {"current_a"}, {*FIELDS}):
            assert readings >= len(names) * sum(one.samples for one in logs if one.fields >= names)
    assert not any(one.left_out for one in incomplete(kept))


@pytest.mark.parametrize("cut", [0, 700])
def test_a_report_says_what_is_missing_and_leaves_out_copies_of_other_conditions(carriages: list[TestLog], cut: int) -> None:
    columns = {
        name: values[cut:] if name != "time_s" else values[: len(values) - cut] for name, values in carriages[0].columns.items()
    }
    again = TestLog(columns, {**carriages[0].metadata, "condition": "push"}, path=Path("push_copied.mcap"))
    logs = [*lacking("current_a", (4,), carriages), again]
    for log in logs:
        write_log(Path("logs", log.path.name), log)
    found = build_report("logs", output=Path("page"))
    assert len(found.indicators) == len(carriages)
    page = found.page.read_text(encoding="utf-8")
    assert "1 log left out" in page and "push_copied.mcap is a copy of" in page and "is missing here" in page
    assert [one.path for one in counted_once(logs)[0]] == [log.path for log in carriages]
