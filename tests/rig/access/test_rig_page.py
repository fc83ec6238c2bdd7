"""What docs/rig.md tells a newcomer to run comes to its end on the virtual rig."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from hjcamp import backends, cli
from hjcamp.backends.rig.fault import RigFault
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.faults import parse_fault

ROOT = Path(__file__).parents[3]


def test_the_first_command_of_the_page_comes_to_its_end(device: VirtualDevice, capsys: pytest.CaptureFixture[str]) -> None:
    page = (ROOT / "docs" / "rig.md").read_text(encoding="utf-8")
    line = re.search(r"```\nhjcamp (.*?)(?: +#.*)?\n", page)
    assert line
    words = shlex.split(line[1])
    assert "rig=virtual" in words
    code = cli.run([*words, "run_dir=run"])
    out, err = capsys.readouterr()
    assert code == 0, err
    assert "12 tests, 0 failed" in out
    manifest = json.loads(Path("run/manifest.json").read_text())
    assert {entry["state"] for entry in manifest["tests"].values()} == {"done"} and device.trips == []


@pytest.mark.study
def test_the_burst_line_of_the_example_is_reached(compose: Any, device: VirtualDevice) -> None:
    page = (ROOT / "docs" / "rig.md").read_text(encoding="utf-8")
    leak, fault = re.findall(r"hjcamp rig serve effects\.leakage\.conductance=(\S+) --fault (\S+)", page)[0]
    assert f"effects.leakage.conductance={leak}" in (ROOT / "conf" / "config.yaml").read_text(encoding="utf-8")
    device.hidden = {"leakage": {"conductance": float(leak)}}
    device.faults = [parse_fault(fault)]
    for seed in (1, 2):
        backends.run_test(compose(), seed)
    with pytest.raises(RigFault, match="the lines lose water"):
        backends.run_test(compose(), 3)
