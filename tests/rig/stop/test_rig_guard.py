"""A rig without a watchdog says so, and hardware without one does not move before somebody said what stops it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from hjcamp import backends, cli
from hjcamp.backends.rig import guard as rig_guard
from hjcamp.backends.rig.guard import is_real, notices, require_guard
from hjcamp.configuration.check import check_configuration
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.rig import connection as rig_connection
from hjcamp.plants.pump_joint.rig import nidaqmx
from hjcamp.plants.pump_joint.rig.connection import Connection
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice

REAL = ["backend=nidaqmx", "rig=example_pcie"]
NO_WATCHDOG = "rig 'example_pcie' has no watchdog"


@pytest.mark.parametrize("rig", ["example_pcie", "example_pxie"])
def test_plan_check_and_run_say_it(rig: str, device: VirtualDevice, capsys: pytest.CaptureFixture[str]) -> None:
    lines = ["backend=nidaqmx", f"rig={rig}"]
    assert cli.run(["plan", *lines]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert f"rig '{rig}' has no watchdog" in told
    assert "refused until rig.interlock says" in told
    for command in (["run", *lines, "run_dir=one"], ["rig", "check", f"rig={rig}", "--yes"]):
        assert cli.run(command) == 2
        refused = capsys.readouterr().err
        assert f"rig '{rig}' has no watchdog" in refused and "rig.interlock=" in refused
    assert not Path("one").exists()


@pytest.mark.parametrize(
    ("word", "said"),
    [("'relay K1 in the enable line'", "Its interlock: relay K1 in the enable line"), ("none", "nothing else stops")],
)
def test_the_word_is_repeated_and_then_only_the_driver_is_missing(
    word: str, said: str, device: VirtualDevice, capsys: pytest.CaptureFixture[str]
) -> None:
    given = [*REAL, f"rig.interlock={word}"]
    assert cli.run(["plan", *given]) == 0
    assert said in " ".join(capsys.readouterr().out.split())
    assert cli.run(["rig", "check", *given[1:], "--yes"]) == 1
    out, err = capsys.readouterr()
    assert said in out and "driver is not installed" in err
    assert cli.run(["run", *given, "rig.check_required=false", "run_dir=one"]) == 1
    out, err = capsys.readouterr()
    assert said in " ".join(out.split()) and "driver is not installed" in err
    assert cli.run(["resume", "one"]) == 1
    assert said in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("word", ["no", "off", "''", "true", "3", "[a]"])
def test_what_names_nothing(word: str, compose: Any) -> None:
    with pytest.raises(UsageError, match=r"rig\.interlock is .*(name what stops the drives|a text or null is needed)"):
        check_configuration(compose("rig=example_pcie", f"rig.interlock={word}"))


def test_which_rigs_are_real(compose: Any) -> None:
    assert is_real(compose("rig=example_pcie"))
    assert is_real(compose("rig.connection={kind:address,address:'lab:1'}", "+rig.connection.virtual=false"))
    assert not is_real(compose("rig.connection={kind:address,address:'lab:1'}"))
    assert not is_real(compose())
    assert notices(compose()) == []
    assert "nothing can be hurt" in notices(compose("rig.watchdog.enabled=false"))[0]
    require_guard(compose("rig.watchdog.enabled=false"))
    require_guard(compose("rig=example_pcie", "rig.watchdog.enabled=true"))


def test_the_backend_itself_moves_nothing_and_the_log_names_the_guard(
    compose: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = compose("rig.watchdog.enabled=false")
    config["rig"]["connection"] = {"kind": "in_process"}
    monkeypatch.setattr(rig_guard, "is_real", lambda config: True)
    closed: list[str] = []
    real = rig_connection.connect

    def connect(config: Any, seed: Any) -> Connection:
        found = real(config, seed)
        return Connection(found.options, lambda: closed.append("closed"))

    monkeypatch.setattr(nidaqmx, "connect", connect)
    with pytest.raises(UsageError, match="so nothing moves"):
        backends.run_test(config, 1)
    assert (device.samples, device.written, closed) == (0, [], ["closed"])
    config["rig"]["interlock"] = "relay K1"
    _, notes = backends.run_test(config, 1)
    assert (notes["watchdog"], notes["interlock"]) == ("none", "relay K1")
    assert backends.run_test(compose(), 1)[1]["watchdog"] == "5 ms"
