"""What a CI job reads: Markdown, JUnit XML, metrics and parameters; bad calls are refused before any work."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import polars as pl
import pytest
import yaml
from report_samples import make_logs, make_plan, write_plan

from hjcamp.commands.runs.report import report
from hjcamp.errors import HjcampError, UsageError
from hjcamp.records.write import write_log
from hjcamp.report.build import build_report
from hjcamp.report.check import check, read_tolerances
from hjcamp.report.ci import junit_xml, summary_markdown


def test_one_case_for_each_published_mean(tmp_path: Path) -> None:
    made = build_report(tmp_path, logs=make_logs(2), against="published")
    limits = {"rmse1_deg": {"absolute": 0.1}}
    violations = check(made.comparison, limits)
    suite = ElementTree.fromstring(junit_xml("a \x00 <b>", made.comparison, violations, list(limits)))[0]
    cells = made.comparison.filter(made.comparison["indicator"] == "rmse1_deg")
    # The samples are off by 1.65 and 0.65 deg on average; what is printed says which of them pass.
    names = {row["condition"] for row in cells.iter_rows(named=True) if abs(row["mean"] - row["published_mean"]) > 0.1}
    outside, means = len(names), cells["condition"].n_unique()
    assert outside > 0 and int(suite.attrib["tests"]) == means and int(suite.attrib["failures"]) == outside
    assert len(suite.findall("testcase/failure")) == outside and suite.attrib["name"] == "a ? <b>"
    text = summary_markdown("run", "said", made.sheets, violations)
    assert text.startswith("# run") and f"**{outside} means are outside" in text and "| trajectory" in text
    (table,) = re.findall(r"## Outside the tolerances\n\n((?:\|.*\n)+)", text)
    assert len(table.splitlines()) == 2 + outside and table.startswith("| condition | indicator | mean | published |")


@pytest.mark.parametrize(
    "tables", [("table_5_5_1", "table_5_5_3"), ("table_5_5_1",), ("table_5_5_3", "table_5_5_2", "table_5_5_1")]
)
def test_a_mean_that_is_printed_in_several_tables_is_one_case(tables: tuple[str, ...]) -> None:
    cells = pl.DataFrame(
        [
            {"table": table, "condition": name, "indicator": indicator, "n": 7, "mean": 2.0, "std": 0.1,
             "published_mean": printed, "published_std": 0.1, "difference": 2.0 - printed, "difference_in_std": (2.0 - printed) / 0.1}
            for table in tables for name, printed in (("one", 1.0), ("other", 2.0)) for indicator in ("rmse1_deg", "e_max_deg")
        ]
    )  # fmt: skip
    limits = {"rmse1_deg": {"absolute": 0.1}, "e_max_deg": {"absolute": 5.0}}
    violations = check(cells, limits)
    assert [(one.condition, one.indicator) for one in violations] == [("one", "rmse1_deg")]
    suite = ElementTree.fromstring(junit_xml("hjcamp", cells, violations, list(limits)))[0]
    assert (suite.attrib["tests"], suite.attrib["failures"]) == ("4", "1")
    names = [case.attrib["name"] for case in suite.findall("testcase")]
    assert len(set(names)) == 4
    assert {one.attrib["value"] for one in suite.findall("testcase/properties/property")} == {", ".join(tables)}


def test_metrics_and_parameters_lie_in_the_run_folder(tmp_path: Path) -> None:
    run = tmp_path / "run"
    write_plan(run, make_plan(["ramp_pos__pid"]))
    build_report(run, logs=make_logs(2))
    metrics = json.loads((run / "metrics.json").read_text())
    assert metrics["ramp_pos__pid"]["n"] == 2 and metrics["ramp_pos__pid"]["rmse1_deg"]["mean"] == pytest.approx(1.65)
    assert "sse_deg" not in metrics["ramp_pos__pid"]
    assert list(yaml.safe_load((run / "params.yaml").read_text())["conditions"]) == ["ramp_pos__pid"]


def test_bad_places_are_refused_and_files_are_there_when_it_fails(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="--junit needs --check"):
        report(tmp_path, junit=tmp_path / "x.xml")
    with pytest.raises(UsageError, match=r"--summary .* this is a folder"):
        report(tmp_path, summary=tmp_path)
    for number, log in enumerate(make_logs(1)):
        write_log(tmp_path / "logs" / f"{number}.mcap", log)
    tight = tmp_path / "t.yaml"
    tight.write_text("rmse1_deg: {absolute: 0.0}\n")
    assert read_tolerances(tight)
    with pytest.raises(HjcampError, match="outside the tolerances"):
        report(tmp_path, check=str(tight), summary=tmp_path / "s.md", junit=tmp_path / "j.xml")
    assert "outside" in (tmp_path / "s.md").read_text() and ElementTree.parse(tmp_path / "j.xml")
