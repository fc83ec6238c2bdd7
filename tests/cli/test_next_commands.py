"""What a run advises at its end can be run as it is printed, and succeeds."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import polars as pl
import pytest

from hjcamp import cli
from hjcamp.campaign.conclude import next_commands
from hjcamp.plants.pump_joint.published.values import measured_indicators
from hjcamp.report.tables.aggregation import against_published
from hjcamp.report.tables.declared import declared_tables

TWO_PUMPS = """name: two_pumps
vary:
  rig_of: {first: {pump: pump1, amplifier: low_gain, controller: open_loop}, second: {pump: pump2, controller: open_loop}}
  trajectory: [ramp_pos]
repetitions: 1
tables: []
"""


def advised(out: str) -> list[list[str]]:
    """Return the commands behind ``next``, as a shell would split them."""
    lines = out[out.index("  next ") :].replace("  next ", "       ", 1).splitlines()
    return [shlex.split(line) for line in lines if re.match(r" +hjcamp ", line)]


@pytest.mark.parametrize(
    ("call", "first"),
    [
        (["campaign=controllers", "trajectory=ramp_pos", "controller=pid"], "compare"),
        pytest.param(["campaign=pump_step"], "calibrate", marks=pytest.mark.study),
        (["campaign=two_pumps"], "compare"),
    ],
)
def test_what_is_advised_succeeds(empty_folder: Path, capfd: pytest.CaptureFixture[str], call: list[str], first: str) -> None:
    (empty_folder / "campaigns").mkdir()
    (empty_folder / "campaigns" / "two_pumps.yaml").write_text(TWO_PUMPS)
    assert cli.run(["run", *call, "repetitions=1", "run_dir=a run"]) == 0
    commands = advised(capfd.readouterr().out)
    # the tour is offered where refitted means stand next to those of the run, until it was begun
    assert [words[1] for words in commands] == (["tour", first] if call[0] == "campaign=controllers" else [first])
    for words in commands[-1:]:
        assert cli.run(words[1:]) == 0, capfd.readouterr().err
        capfd.readouterr()


def test_a_check_is_advised_only_where_it_passes(tmp_path: Path) -> None:
    plan: Any = SimpleNamespace(campaign="controllers", conditions=(SimpleNamespace(name="a", choices={}),))
    folder: Any = SimpleNamespace(path=tmp_path, plan=plan)
    comparison = against_published(measured_indicators(), declared_tables())
    passing: Any = SimpleNamespace(comparison=comparison, refitted=None)
    compare = f"hjcamp compare {tmp_path}"
    assert next_commands(folder, passing) == [compare, f"hjcamp report {tmp_path} --check default"]
    far = comparison.with_columns(pl.col("difference") + 10.0, pl.col("difference_in_std") + 100.0)
    for other in (far, comparison.clear()):
        report: Any = SimpleNamespace(comparison=other, refitted=None)
        assert next_commands(folder, report) == [compare]


def test_the_tour_is_advised_until_it_was_begun(empty_folder: Path) -> None:
    plan: Any = SimpleNamespace(campaign="controllers", conditions=(SimpleNamespace(name="a", choices={}),))
    folder: Any = SimpleNamespace(path=empty_folder, plan=plan)
    comparison = against_published(measured_indicators(), declared_tables()).clear()
    report: Any = SimpleNamespace(comparison=comparison, refitted=object())
    assert next_commands(folder, report)[0] == "hjcamp tour"
    (empty_folder / "tour").mkdir()
    assert "hjcamp tour" not in next_commands(folder, report)
