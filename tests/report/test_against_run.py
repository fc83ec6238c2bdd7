"""A run beside another run: Welch's test against SciPy's, Holm's by hand, tables, page, exit code, bad baselines."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from report_samples import make_log, make_logs
from scipy.special import stdtr
from scipy.stats import ttest_ind

from hjcamp.commands.runs.diff import diff
from hjcamp.commands.runs.report import report
from hjcamp.errors import HjcampError, UsageError
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log
from hjcamp.report.build import build_report
from hjcamp.report.check import read_tolerances
from hjcamp.report.run_difference import run_difference
from hjcamp.report.runs.varied import indicators_frame
from hjcamp.report.tables.aggregation import by_condition
from hjcamp.report.tables.welch import Sample, holm, welch


def sample(values: Sequence[float]) -> Sample:
    return Sample(float(np.mean(values)), float(np.std(values, ddof=1)) if len(values) > 1 else None, len(values))


def test_welch_is_that_of_scipy_and_of_the_hand() -> None:
    random = np.random.default_rng(3)
    for n, m, scale in ((7, 7, 1.0), (3, 12, 5.0), (2, 2, 0.1), (40, 5, 2.0)):
        one, other = random.normal(1.0, 1.0, n), random.normal(1.5, scale, m)
        assert welch(sample(one), sample(other)) == pytest.approx(ttest_ind(one, other, equal_var=False).pvalue, rel=1e-9)
    # Equal numbers and deviations: t = difference / (s sqrt(2 / n)) with 2 (n - 1) degrees of freedom.
    assert welch(Sample(1.0, 0.5, 8), Sample(2.0, 0.5, 8)) == pytest.approx(2 * stdtr(14, -4.0))
    assert welch(Sample(1.0, None, 1), Sample(1.0, None, 1)) == 1.0 and welch(Sample(1.0, None, 1), Sample(2.0, 0.1, 7)) is None
    assert welch(Sample(1.0, 0.0, 3), Sample(1.1, 0.0, 3)) == 0.0 and welch(Sample(1.0, 1e-17, 3), Sample(1.1, 0.0, 3)) == 0.0


def test_holm_by_hand() -> None:
    # Sorted 0.005 0.01 0.03 0.04, times 4 3 2 1, never falling.
    assert holm([0.01, 0.04, None, 0.03, 0.005]) == pytest.approx([0.03, 0.06, None, 0.06, 0.02])
    assert holm([]) == [] and holm([None]) == [None] and holm([0.7, 0.9]) == [1.0, 1.0]


def kept(folder: Path, logs: Sequence[TestLog]) -> Path:
    for number, log in enumerate(logs):
        write_log(folder / "logs" / f"{number}.mcap", log)
    return folder


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The baseline, and a run in which one of four conditions is worse; its gain is another one."""
    folder = tmp_path_factory.mktemp("runs")
    changed = [
        make_log("ramp_pos", "pid", repetition, 2.5, ("controller.positive.kp=0.5",)) if name == ("ramp_pos", "pid") else log
        for repetition, name, log in (
            (int(log.metadata["repetition"]), (log.metadata["trajectory"], log.metadata["controller"]), log)
            for log in make_logs(4)
        )
    ]
    return kept(folder / "before", make_logs(4)), kept(folder / "after", [*changed, make_log("sine_0p5hz")])


def test_tables_page_and_comparison(runs: tuple[Path, Path], tmp_path: Path) -> None:
    before, after = runs
    made = build_report(after, against=str(before), output=tmp_path)
    assert made.baseline is not None and made.comparison.height == 4 * 3 + 2  # sse_deg is of cycloids alone
    worse = {row["indicator"]: row for row in made.comparison.iter_rows(named=True) if row["p_holm"] < 0.05}
    assert set(worse) == {"rmse1_deg", "rmse2_deg", "e_max_deg"} and {row["condition"] for row in worse.values()} == {
        "ramp_pos__pid"
    }
    values = np.array([2.6, 2.7, 2.8, 2.9])
    p = ttest_ind(values, values - 1.0, equal_var=False).pvalue
    assert worse["rmse1_deg"]["p"] == pytest.approx(p, rel=1e-6) and worse["rmse1_deg"]["difference"] == pytest.approx(1.0)
    assert worse["rmse1_deg"]["p_holm"] == pytest.approx(14 * p, rel=1e-6)
    notes = " ".join(made.conditions.notes)
    assert "ramp_pos__pid: controller.positive.kp is 0.5 instead of" in notes and "Without a baseline: sine_0p5hz__pid" in notes
    assert made.verdict.startswith("3 of 14 means differ")
    table = (tmp_path / "tables" / "table_5_4_1.csv").read_text()
    assert "rmse1_deg_baseline_mean" in table and "rmse1_deg_p" in table and "published" not in table
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "baseline</th>" in page and "3 of 14 means differ" in page and "2.75 ± 0.13 ▲" in page
    # The other way round the same means are better.
    assert "1.75 ± 0.13 ▼" in build_report(before, against=str(after), output=tmp_path).page.read_text(encoding="utf-8")


def test_exit_code_files_and_answer(runs: tuple[Path, Path], tmp_path: Path) -> None:
    before, after = runs
    loose = tmp_path / "loose.yaml"
    loose.write_text("rmse1_deg: {absolute: 1.1, p: 0.05}\n")
    report(after, against=str(before), check=str(loose), output=tmp_path)
    with pytest.raises(HjcampError, match=r"3 means are outside") as said:
        report(after, str(before), "default", tmp_path / "s.md", tmp_path / "j.xml", tmp_path, json=tmp_path / "a.json")
    assert "ramp_pos pid" not in str(said.value) and "ramp_pos__pid: rmse1_deg 2.7500, baseline 1.7500" in str(said.value)
    assert "3 of 14 means differ" in (tmp_path / "s.md").read_text() and 'failures="3"' in (tmp_path / "j.xml").read_text()
    answer = json.loads((tmp_path / "a.json").read_text())
    assert answer["schema"] == "hjcamp.report/1" and answer["against"] == str(before) and len(answer["violations"]) == 3
    report(before, str(before), "default", output=tmp_path)


def test_bad_baselines_are_one_message(runs: tuple[Path, Path], tmp_path: Path) -> None:
    before, _ = runs
    other = kept(tmp_path / "other", [make_log("sine_0p5hz", repetition=number) for number in (1, 2)])
    with pytest.raises(
        UsageError, match=r"have no condition in common: ramp_pos__pid, .* and 1 more here, sine_0p5hz__pid there"
    ):
        build_report(before, against=str(other), output=tmp_path)
    assert not (tmp_path / "report.html").exists()
    with pytest.raises(UsageError, match=r"unknown comparison 'publish'.*did you mean 'published'"):
        build_report(before, against="publish")
    doubled = kept(
        tmp_path / "doubled", [make_log("ramp_pos"), make_log("ramp_pos", overrides=("controller.positive.kp=0.5",))]
    )
    with pytest.raises(UsageError, match="names several conditions"):
        build_report(before, against=str(doubled), output=tmp_path)
    (tmp_path / "t.yaml").write_text("rmse1_deg: {published_std: 1}\n")
    with pytest.raises(UsageError, match=r"unknown tolerance 'published_std'.*baseline_std, p"):
        read_tolerances(tmp_path / "t.yaml", "baseline")
    (tmp_path / "empty").mkdir()
    with pytest.raises(UsageError, match="there are no logs"):
        build_report(before, against=str(tmp_path / "empty"), output=tmp_path)


def test_the_only_condition_of_each_is_compared(tmp_path: Path) -> None:
    one = kept(tmp_path / "one", [make_log("ramp_pos", "pid", number) for number in (1, 2, 3)])
    other = kept(tmp_path / "other", [make_log("ramp_pos", "ffwd_pid", number) for number in (1, 2, 3)])
    made = build_report(one, against=str(other), output=tmp_path)
    assert made.comparison["p_holm"].to_list() == [1.0, 1.0, 1.0] and made.baseline is not None
    assert any("controller is pid instead of ffwd_pid" in note for note in made.baseline.notes)


def test_two_runs_side_by_side(runs: tuple[Path, Path], capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    before, after = runs
    found = run_difference(after, before)
    assert found["alone"] == [["sine_0p5hz__pid"], []] and len(found["pairs"]) == 4 and found["origin"] == []
    (changed,) = found["configuration"]
    assert changed["parameter"] == "controller.positive.kp" and changed["values"][0] == 0.5
    assert changed["conditions"] == ["ramp_pos__pid"] and changed["absent_in"] == []
    assert sum(row["p_holm"] < 0.05 for row in found["results"]) == 3
    diff(after, before, json=tmp_path / "a.json")
    out = capsys.readouterr().out
    assert "controller.positive.kp" in out and "3 of 14 means differ" in out and "11 that do not are left out" in out
    assert json.loads((tmp_path / "a.json").read_text()) == found
    # Of one test against itself nothing differs; and no condition in common is told, not refused.
    diff(before, before)
    assert "nothing is set differently" in capsys.readouterr().out
    other = kept(tmp_path / "other", [make_log("sine_0p5hz"), make_log("cycloid_neg")])
    assert run_difference(before, other)["results"] == []
    diff(before, other)
    assert "no condition is in both" in capsys.readouterr().out


@pytest.mark.parametrize("names", [("ramp_pos__kp-0.7", "ramp_pos__kp=0.7"), ("ramp_pos__kp=0.7", "ramp_pos__kp-0.7")])
def test_a_value_named_in_an_earlier_way_is_the_same_condition(tmp_path: Path, names: tuple[str, str]) -> None:
    other = make_log("cycloid_pos")
    paths = [kept(tmp_path / str(place), [make_log("ramp_pos", condition=name), other]) for place, name in enumerate(names)]
    found = run_difference(*paths)
    assert found["pairs"] == [{"conditions": list(names)}, {"conditions": ["cycloid_pos__pid"] * 2}]


def test_what_all_tests_of_one_run_have_and_no_test_of_the_other(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    level = [make_log(name, overrides=("orientation=horizontal",)) for name in ("ramp_pos", "cycloid_pos")]
    upright = [make_log(name, overrides=("orientation=vertical",)) for name in ("cycloid_neg", "sine_0p5hz")]
    paths = kept(tmp_path / "a", level), kept(tmp_path / "b", upright)
    rows = {row["parameter"]: row for row in run_difference(*paths)["configuration"]}
    assert rows["orientation.name"]["values"] == ["horizontal", "vertical"]
    # what differs inside a run is no difference of the runs
    assert "trajectory.name" not in rows
    diff(*paths)
    (line,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("orientation.name")]
    assert line.split() == ["orientation.name", "horizontal", "vertical", "all"]


def test_an_effect_as_it_is_by_default_is_no_published_configuration() -> None:
    log = make_log("ramp_pos", "pid", overrides=("+effects.stribeck_friction={}",))
    (row,) = by_condition(indicators_frame([log])).iter_rows(named=True)
    assert (
        row["rmse1_deg_published_mean"] is None
        and "effects.stribeck_friction is {} instead of absent" in row["published_differs"]
    )
