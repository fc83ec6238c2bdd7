"""The tests that `hjcamp next` proposes as signals: what was chosen in simulation is what the files command."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml

from hjcamp import cli
from hjcamp.analyses.data import Data
from hjcamp.commands.any_plant import calls
from hjcamp.commands.any_plant.next_campaign import written_campaign
from hjcamp.diagnosis.design.menu import Wanted, menu
from hjcamp.model.declare.plant import Plant
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log

PERIOD, SAMPLES = 0.001, 1000


@pytest.fixture
def wanted(carriage: type[Plant], monkeypatch: pytest.MonkeyPatch) -> dict[str, Wanted]:
    """The menu of a measured carriage; `next` chooses two of it without the diagnosis, which other tests run."""
    time = np.arange(3 * SAMPLES) * PERIOD
    volts = 5.0 * np.sin(2.0 * np.pi * time)
    columns = {"time_s": time, "position_m": 0.01 * (1.0 - np.cos(2.0 * np.pi * time)), "voltage_v": volts}
    write_log("log.mcap", TestLog(columns, {"plant": "carriage", "period_s": str(PERIOD), "condition": "sine"}))
    measured = Data([Path("log.mcap")]).measured
    offered = {one.name: one for one in menu(measured, SAMPLES, by_motion=False)}
    chosen = ("voltage_steps", "voltage_at_75")

    def propose(logs: list[Path], words: Any, rivals: Any, tests: Any, asked: Any, name: str | None, json: Any) -> None:
        made = [SimpleNamespace(wanted=offered[one], repetitions=2, place=k) for k, one in enumerate(chosen)]
        drawn = SimpleNamespace(starts=np.zeros((2, 2)), layout=SimpleNamespace(of_test=np.array([0, 1])))
        effects = [SimpleNamespace(name="spring"), SimpleNamespace(name="nothing")]
        proposal = SimpleNamespace(tests=made, chosen=2, truths=[[drawn]], question=SimpleNamespace(rivals=effects))
        done = SimpleNamespace(proposal=proposal, analysis=SimpleNamespace(measured=measured))
        assert written_campaign(done, Data(logs), name) is not None  # type: ignore[arg-type]

    monkeypatch.setattr(calls, "propose", propose)
    return {name: offered[name] for name in chosen}


def test_the_signals_are_the_inputs_that_were_chosen(wanted: dict[str, Wanted], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["next", "log.mcap", "--as", "more", "--signals", "out"]) == 0, capsys.readouterr().err
    rules = yaml.safe_load(Path("out/map.yaml").read_text(encoding="utf-8"))
    names = {f"{name}_rep_{repetition:02d}.csv": name for name in wanted for repetition in (1, 2)}
    assert sorted(path.name for path in Path("out").glob("*.csv")) == sorted(names) == sorted(rules["files"])
    for file, name in names.items():
        table = np.genfromtxt(f"out/{file}", delimiter=",", names=True)
        assert table.dtype.names == ("time_s", "voltage_v") and len(table) == SAMPLES
        # a jump may take the sample at which it is
        assert np.mean(np.abs(table["voltage_v"] - wanted[name].inputs[:, 0]) > 1e-6) < 0.02
        assert rules["files"][file]["condition"] == name and rules["plant"] == "carriage"


def test_recordings_of_the_signals_come_back_by_the_map(wanted: dict[str, Wanted], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["next", "log.mcap", "--as", "more", "--signals", "out"]) == 0, capsys.readouterr().err
    for path in Path("out").glob("*.csv"):
        rows = path.read_text().splitlines()
        moved = [f"{row},{1e-4 * k % 0.05:.5f}" for k, row in enumerate(rows[1:])]
        path.write_text("\n".join([f"{rows[0]},position_m", *moved]) + "\n")
    assert cli.run(["import", "out", "--map", "out/map.yaml", "--into", "logs", "--json", "i.json"]) == 0, (
        capsys.readouterr().err
    )
    logs = json.loads(Path("i.json").read_text())["logs"]
    assert {one["metadata"]["condition"] for one in logs} == set(wanted)


def test_a_folder_that_has_such_files_is_refused(wanted: dict[str, Wanted], capsys: pytest.CaptureFixture[str]) -> None:
    Path("out").write_text("")
    assert cli.run(["next", "log.mcap", "--as", "more", "--signals", "out"]) == 2
    assert "--signals" in capsys.readouterr().err and not Path("campaigns/more.yaml").exists()
