"""The report of a run folder: files, page, figures, terminal."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import polars as pl
import pytest
from report_samples import as_planned, make_log, make_logs, make_plan, write_plan
from rich.console import Console

from hjcamp.errors import HjcampError, UsageError
from hjcamp.records.log import TestLog
from hjcamp.records.plan import Plan
from hjcamp.records.write import write_log
from hjcamp.report.build import build_report
from hjcamp.report.pictures.conditions import draw_condition
from hjcamp.report.runs.indicators import COLUMNS, FURTHER, IDENTITY
from hjcamp.report.runs.spread import gather
from hjcamp.report.tables.terminal import summary_table


def make_run(folder: Path, logs: Sequence[TestLog], plan: Plan | None = None) -> Path:
    for log in logs if plan is None else [as_planned(log, plan) for log in logs]:
        path = folder / "logs" / log.metadata["condition"] / f"rep_{int(log.metadata['repetition']):02d}.mcap"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_log(path, log)
    if plan is not None:
        write_plan(folder, plan)
    return folder


class Outline(HTMLParser):
    """Check that tags close and collect what would be fetched."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.fetched: list[str] = []
        self.identifiers: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.fetched += [str(values[name]) for name in ("src", "href") if values.get(name, "#")[:1] != "#"]  # type: ignore[index]
        self.identifiers += [str(values["id"])] if "id" in values else []
        if tag not in ("meta", "br", "path", "use", "rect"):
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        return

    def handle_endtag(self, tag: str) -> None:
        if tag not in ("path", "use", "rect"):
            assert self.open.pop() == tag


def test_the_files_of_a_run_folder(tmp_path: Path) -> None:
    report = build_report(make_run(tmp_path / "run", make_logs(2)), against="published")
    made = sorted(path.relative_to(tmp_path / "run").as_posix() for path in (tmp_path / "run").rglob("*.*"))
    tables = ["table_5_4_1", "table_5_4_2", "table_5_5_3", "table_6_3_1"]
    expected = [f"tables/{name}.{end}" for name in tables for end in ("csv", "md", "parquet", "tex")]
    expected += ["metrics.json", "report.html", "tables/indicators.csv", "tables/indicators.parquet"]
    assert sorted(expected) == [name for name in made if not name.endswith(".mcap")]
    assert list(report.tables) == tables
    indicators = pl.read_parquet(tmp_path / "run" / "tables" / "indicators.parquet")
    assert tuple(indicators.columns) == (*COLUMNS, *IDENTITY, *FURTHER)
    assert indicators.height == 8
    frame = pl.read_csv(tmp_path / "run" / "tables" / "table_5_4_1.csv")
    assert frame["rmse1_deg_mean"].to_list() == pytest.approx([1.65, 0.65, 1.65, 0.65])
    assert not [name for name in frame.columns if "decimals" in name]


def test_the_page_is_self_contained_and_well_formed(tmp_path: Path) -> None:
    logs = [*make_logs(2), make_log("ramp_pos", condition="<script>alert(1)</script> & more")]
    run = tmp_path / "run"
    write_plan(run, make_plan(["ramp_pos__pid"], campaign="a <b> & c", description="$title ${style}"))
    (run / "config.yaml").write_text("overrides: ['x=$(rm)', 'repetitions=2']\n")
    page = build_report(run, logs=logs).page.read_text(encoding="utf-8")
    outline = Outline()
    outline.feed(page)
    assert outline.open == []
    assert outline.fetched == []
    assert len(outline.identifiers) == len(set(outline.identifiers))
    assert "<script>alert" not in page and "default-src 'none'" in page
    assert "a &lt;b&gt; &amp; c" in page
    assert "$title ${style}" in page
    assert "&#39;x=$(rm)&#39; repetitions=2" in page
    assert "prefers-color-scheme: dark" in page
    # five conditions, the same five small, and the picture of them all
    assert page.count("<svg ") == 11 and page.index("every condition: mean") < page.index('id="explorer"') < page.index(
        "<details>"
    )
    assert not re.search(r"url\((?!#)", page)


def test_the_plan_decides_tables_and_order(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = ["ramp_pos__ffwd_pid", "ramp_pos__pid", "cycloid_pos__pid"]
    run = make_run(tmp_path, make_logs(2), make_plan(names, tables=["table_5_4_2"]))
    report = build_report(run)
    assert list(report.tables) == ["table_5_4_2"]
    assert report.indicators["condition"].unique(maintain_order=True).to_list() == names
    said = capsys.readouterr().err
    assert said.count("is left out: no test of the plan") == 2 and "cycloid_pos__ffwd_pid/rep_01.mcap" in said
    write_plan(run, make_plan(names, tables=["table_5"]))
    with pytest.raises(UsageError, match="unknown table 'table_5'"):
        build_report(run)


def test_no_logs_and_unknown_comparisons_are_refused(tmp_path: Path) -> None:
    (tmp_path / "logs").mkdir()
    with pytest.raises(UsageError, match="no logs"):
        build_report(tmp_path)
    with pytest.raises(UsageError, match="did you mean 'published'"):
        build_report(tmp_path, against="publish")
    (tmp_path / "one.mcap").write_bytes(b"")
    with pytest.raises(UsageError, match="--output DIR"):
        build_report(tmp_path / "one.mcap")
    assert not (tmp_path / "report.html").exists()


def test_a_failed_write_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    logs = make_logs(1)
    page = build_report(tmp_path, logs=logs).page
    before = page.read_bytes()

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(HjcampError, match="No space left"):
        build_report(tmp_path, logs=logs[:1])
    assert page.read_bytes() == before
    assert not list(tmp_path.rglob("*.part"))


def test_the_same_logs_give_the_same_page(tmp_path: Path) -> None:
    first = build_report(tmp_path, logs=make_logs(2)).page.read_bytes()
    assert build_report(tmp_path, logs=make_logs(2)).page.read_bytes() == first


def test_the_spread_keeps_peaks_and_stays_small() -> None:
    logs = [make_log("sine_0p5hz", repetition=number) for number in (1, 2, 3)]
    peak = int(np.flatnonzero(logs[1].columns["time_s"] == 1.234)[0])
    logs[1].columns["arm_deg"][peak] -= 30.0
    condition = gather("a", logs)
    assert condition.tests == 3
    assert len(condition.time) <= 400
    error = condition.signals["error_deg"]
    assert error.highest.max() == pytest.approx(31.2)
    assert error.mean.max() < 3.0
    assert error.lowest.min() == pytest.approx(1.1)
    assert "pid_deg" not in condition.signals


def test_repetitions_of_different_length_are_cut_to_the_shortest() -> None:
    short = make_log("cycloid_pos", repetition=2)
    short = TestLog({name: values[:-700] for name, values in short.columns.items()}, short.metadata)
    condition = gather("a", [make_log("cycloid_pos"), short])
    assert condition.time[-1] == pytest.approx(1.3, abs=0.01)


@pytest.mark.parametrize("columns", [("time_s", "arm_deg"), ("time_s", "arm_deg", "pressure1_mpa", "pump_deg")])
def test_a_figure_shows_what_is_there(columns: tuple[str, ...]) -> None:
    log = make_log("ramp_pos")
    sparse = TestLog({name: log.columns[name] for name in columns})
    svg = draw_condition(gather("sparse", [sparse]))
    assert ElementTree.fromstring(svg).tag.endswith("svg")
    assert "Arm angle (deg)" in svg
    assert "Error" not in svg
    assert len(svg) < 60_000


def test_logs_without_command_phase_or_names_still_make_a_report(tmp_path: Path) -> None:
    log = make_log("ramp_pos")
    resting = {name: values[:300] for name, values in log.columns.items()}
    report = build_report(tmp_path, logs=[TestLog(resting), TestLog(log.columns)], against="published")
    assert report.indicators["rmse1_deg"].null_count() == 1
    assert report.tables == {}
    page = report.page.read_text(encoding="utf-8")
    assert "unnamed" in page
    assert "Arm angle (deg)" in page
    assert gather("resting", [TestLog(resting)]).signals == {}
    assert "<svg" in draw_condition(gather("resting", [TestLog(resting)]))


def test_the_terminal_table(tmp_path: Path) -> None:
    report = build_report(tmp_path, logs=make_logs(3))
    console = Console(file=io.StringIO(), width=160)
    console.print(summary_table(report.indicators))
    assert isinstance(console.file, io.StringIO)
    text = console.file.getvalue()
    assert re.search(r"ramp_pos +pid +3 +1\.70 ± 0\.10 +1\.7 ± 0\.17", text)
    assert "▼" in text
    assert "payload" not in text
