"""The first pump on the virtual rig: every trajectory of the campaigns, none of them clipped or stopped."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hjcamp import backends
from hjcamp.plants.pump_joint.rig.reach import check_test
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice

PUMP1 = ("pump=pump1", "amplifier=low_gain")
FASTEST = ("sine_1hz", "cycloid_neg", "mixed")
OTHERS = ("ramp_pos", "ramp_neg", "sine_0p5hz", "cycloid_pos")
TRAJECTORIES = {
    "pid": ("pid", FASTEST),
    "pid, all": ("pid", (*OTHERS, *FASTEST)),
    "ffwd_pid": ("ffwd_pid", ("sine_1hz", "mixed")),  # its command jumps most
}


@pytest.mark.parametrize("case", ["pid", pytest.param("pid, all", marks=pytest.mark.study), "ffwd_pid"])
def test_every_trajectory_ends_and_is_followed(compose: Any, device: VirtualDevice, case: str) -> None:
    controller, trajectories = TRAJECTORIES[case]
    for trajectory in trajectories:
        config = compose(*PUMP1, f"trajectory={trajectory}", f"controller={controller}")
        check_test(config)
        columns, _ = backends.run_test(config, 1)
        moving = columns["phase"] == 3.0
        error = (columns["reference_deg"] - columns["arm_deg"])[moving]
        assert np.sqrt(np.mean(error**2)) < 8.0, trajectory
    assert columns["pump_deg"].max() > 2500.0  # beyond what the drive of pump2 reaches


@pytest.mark.parametrize(
    "lines",
    [
        pytest.param(
            (*PUMP1, "trajectory=sine_2hz_open_loop", "procedure.initial={pressure1_mpa: 0.32, pressure2_mpa: 0.14}"),
            marks=pytest.mark.study,
        ),
        pytest.param(
            (*PUMP1, "trajectory=hold", "trajectory.angle_deg=360", "trajectory.duration=0.6", "controller.scale=1.0"),
            marks=pytest.mark.study,
        ),
        ("joint=blocked", "trajectory=triangle", "trajectory.amplitude_deg=80", "controller.scale=1.0"),
    ],
    ids=["open loop", "step of the pump", "blocked joint"],
)
def test_an_open_loop_is_not_stopped_by_its_reference(compose: Any, device: VirtualDevice, lines: tuple[str, ...]) -> None:
    config = compose(*lines, "controller=open_loop", "procedure.adjustment.enabled=false")
    check_test(config)
    columns, _ = backends.run_test(config, 1)
    error = np.abs(columns["reference_deg"] - columns["arm_deg"])[columns["phase"] == 3.0]
    assert error.max() > config["rig"]["limits"]["tracking_deg"]
