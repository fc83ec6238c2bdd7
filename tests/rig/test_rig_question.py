"""The question of the check: the rig is held while somebody thinks."""

from __future__ import annotations

import time
from typing import Any

import pytest

from hjcamp.plants.pump_joint.rig.check import Finding, check_rig
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice


def test_the_check_holds_the_rig_while_somebody_thinks(device: VirtualDevice, compose: Any) -> None:
    def think(question: str) -> bool:
        device.run_by_itself(0.05)
        time.sleep(0.6)  # 30 samples
        device.run_by_itself(None)
        return True

    findings: list[Finding] = []
    assert check_rig(compose(), think, findings.append), findings
    assert device.trips == []
    device.close()


def test_what_the_user_breaks_off(device: VirtualDevice, compose: Any) -> None:
    def gone(question: str) -> bool:
        raise EOFError("no terminal")

    with pytest.raises(EOFError, match="no terminal"):
        check_rig(compose(), gone, lambda finding: None)
    assert (device.volts["Dev1/ao1"], device.volts["Dev1/ao2"]) == (0.0, 0.0)
