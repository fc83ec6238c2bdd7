"""The example of the virtual rig in docs/rig.md does what the page says."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from hjcamp import backends
from hjcamp.backends.rig.fault import RigFault
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.faults import parse_fault

ROOT = Path(__file__).parents[2]


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
