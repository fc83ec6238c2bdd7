"""What `hjcamp rig check` asks and says: it compiles first, counts down, names each step, and asks when nothing is loaded."""

from __future__ import annotations

from typing import Any

import pytest
import typer

from hjcamp import cli
from hjcamp.commands.setup import rig as commands
from hjcamp.plants.pump_joint.rig.check import Finding, check_rig
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice

RELEASED_MPA = 0.01


def test_the_lines_are_released_while_somebody_thinks(device: VirtualDevice, compose: Any) -> None:
    findings: list[Finding] = []
    asked_after: list[str] = []

    def think(question: str) -> bool:
        asked_after.extend(one.name for one in findings)
        assert max(device.plant.seen[1:3]) * 1e-6 < 1.5 * compose()["procedure"]["release_mpa"]
        assert (device.volts["Dev1/ao1"], device.volts["Dev1/ao2"]) == (0.0, 0.0)
        return True

    assert check_rig(compose(), think, findings.append), findings
    assert asked_after == ["at rest", "preload", "pump", "arm", "release"]
    assert device.trips == []


def test_what_the_user_breaks_off(device: VirtualDevice, compose: Any) -> None:
    def gone(question: str) -> bool:
        raise EOFError("no terminal")

    with pytest.raises(EOFError, match="no terminal"):
        check_rig(compose(), gone, lambda finding: None)
    assert (device.volts["Dev1/ao1"], device.volts["Dev1/ao2"]) == (0.0, 0.0)


def test_each_step_is_announced_before_it_moves(
    device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    happened: list[str] = []
    compiled = commands.typer.confirm

    def confirm(question: str) -> bool:
        happened.append(f"asked with {device.samples} samples: {question}")
        return True

    assert compiled is typer.confirm
    monkeypatch.setattr(commands.typer, "confirm", confirm)
    monkeypatch.setattr(commands.time, "sleep", lambda seconds: happened.append(f"waited {seconds:g}"))
    assert cli.run(["rig", "check", "rig=virtual"]) == 0
    assert happened[0] == "asked with 0 samples: Is everybody clear of it?"
    assert happened[1:4] == ["waited 1"] * 3
    assert "Did it?" in happened[-1]
    lines = [line.split()[0] for line in capsys.readouterr().out.splitlines() if line.split()[0] in ("moves", "next", "ok")]
    assert lines == ["moves"] * 3 + ["next", "ok"] * 5 + ["ok"]


def test_who_is_not_clear_stops_it_before_anything_moves(
    device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(commands.typer, "confirm", lambda question: False)
    assert cli.run(["rig", "check", "rig=virtual"]) == 1
    assert "nothing was moved" in capsys.readouterr().err
    assert device.samples == 0
