"""Logs in viewers: opened by the libraries of Foxglove and Rerun where they are installed; their layouts loaded by them."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from answer_schemas import check_answer

from hjcamp.cli import run
from hjcamp.commands.shared.view import PROGRAMS, prepare_view
from hjcamp.errors import UsageError
from hjcamp.records.log import TestLog
from hjcamp.records.views.rerun_view import events_of
from hjcamp.records.write import write_log

SAMPLES = 60
TIME = (np.arange(SAMPLES) - 20) * 1e-3
PANELS = {
    "followed": ["reference_deg", "arm_deg"],
    "MPa": ["pressure1_mpa", "pressure2_mpa"],
    "deg": ["pump_deg"],
}


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a short log of the pump joint."""
    monkeypatch.chdir(tmp_path)
    columns = {name: np.sin(TIME + k) for k, name in enumerate(name for names in PANELS.values() for name in names)}
    columns |= {"time_s": TIME, "phase": np.where(TIME < 0, 2.0, 3.0)}
    write_log(tmp_path / "rep_01.mcap", TestLog(columns, {"condition": "ramp", "warning": "a line ran dry"}, {}))
    return tmp_path / "rep_01.mcap"


def test_phases_and_warnings_are_events(log: Path) -> None:
    columns = {"time_s": TIME, "phase": np.where(TIME < 0, 2.0, 3.0)}
    found = events_of(TestLog(columns, {"late_samples": "3"}, {}), {"2": "rest"})
    assert found == [(TIME[0], "rest"), (0.0, "phase 3"), (TIME[-1], "3 samples were missed")]


def test_a_layout_shows_every_channel_by_panel(log: Path) -> None:
    made = prepare_view([log], "plotjuggler", Path("view"))
    assert [str(path) for path in made.command[1:]] == [
        "--datafile",
        str(log),
        "--layout",
        "view/plotjuggler_layout.xml",
    ]
    areas = ElementTree.parse(made.files[0]).iter("DockArea")
    shown = {one.attrib["name"]: [curve.attrib["name"].rpartition("/")[2] for curve in one.iter("curve")] for one in areas}
    assert shown == PANELS


def test_the_log_opens_in_the_library_of_foxglove(log: Path) -> None:
    pytest.importorskip("mcap_protobuf")
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory

    with log.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        rows = [(channel.metadata, message) for _, channel, _, message in reader.iter_decoded_messages()]
    assert len(rows) == SAMPLES
    assert rows[0][0]["unit.pressure1_mpa"] == "MPa"
    assert [row.arm_deg for _, row in rows] == list(np.sin(TIME + 1))


def test_the_layout_is_one_of_foxglove(log: Path) -> None:
    layouts = pytest.importorskip("foxglove.layouts")
    made = prepare_view([log], "foxglove", Path("view"))
    content = json.loads(made.files[0].read_text(encoding="utf-8"))
    kinds = {
        "Plot": (layouts.PlotConfig, layouts.PlotSeries),
        "StateTransitions": (layouts.StateTransitionsConfig, layouts.StateTransitionsSeries),
    }
    shown: dict[str, list[str]] = {}
    for name, config in content["configById"].items():
        panel, series = kinds[name.partition("!")[0]]
        title = config.pop("foxglovePanelTitle")
        # Foxglove's own classes take no key that they do not know
        paths = [series(**_snake(one)) for one in config.pop("paths")]
        panel(**_snake(config), paths=paths)
        shown[title] = [one.value for one in paths]
    assert shown.pop("phase") == ["/test/sample.phase"]
    assert shown == {title: [f"/test/sample.{name}" for name in names] for title, names in PANELS.items()}


def _snake(given: dict[str, Any]) -> dict[str, Any]:
    return {re.sub(r"([A-Z])", lambda found: f"_{found[1].lower()}", name): value for name, value in given.items()}


def test_the_recording_opens_in_rerun_with_its_blueprint(log: Path) -> None:
    pytest.importorskip("rerun")
    (path,) = prepare_view([log], "rerun", Path("view")).files
    command = [sys.executable, "-m", "rerun", "rrd", "print", str(path)]
    answer = subprocess.run(command, capture_output=True, text=True, env={"HOME": str(log.parent)}, timeout=60, check=True)
    chunks = re.findall(r"with (\d+) rows .* - (/\S+) - data columns: \[(.*)\]", answer.stdout)
    curves = {place: int(rows) for rows, place, columns in chunks if columns == "Scalars:scalars"}
    expected = {f"/panel_{k}/{name}": SAMPLES for k, names in enumerate(PANELS.values()) for name in names}
    assert curves == expected
    assert sum(int(rows) for rows, place, columns in chunks if place == "/events" and "TextLog" in columns) == 3
    assert sum("ViewBlueprint:class_identifier" in columns for _, _, columns in chunks) == len(PANELS) + 1
    assert not list(path.parent.glob("*.part"))


def test_a_viewer_that_is_not_there(log: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    with pytest.raises(UsageError, match="did you mean 'foxglove'"):
        prepare_view([log], "foxglow", Path("view"))
    monkeypatch.setitem(PROGRAMS, "plotjuggler", ("no-such-plotjuggler",))
    assert run(["log", "view", str(log), "--with", "plotjuggler", "--json", "answer.json"]) == 0
    told = capsys.readouterr().out
    assert "plotjuggler is not installed here; where it is: no-such-plotjuggler --datafile" in told
    answer = json.loads(Path("answer.json").read_text())
    check_answer(answer)
    assert answer["installed"] is False
