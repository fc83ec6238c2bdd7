"""The PID for any plant: what it commands, that it holds what it controls, its limit, and where it does not fit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hjcamp.backends import run_test
from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer, free
from hjcamp.controllers.plain_pid import PlainPid
from hjcamp.errors import UsageError

AXIS = (
    "plant=axis",
    "controller=plain_pid",
    "trajectory=cycloid",
    "trajectory.amplitude_m=0.1",
    "parameters.coulomb=12",
)
TANKS = (
    "plant=tanks", "controller=plain_pid", "trajectory=hold", "trajectory.angle_v=2", "trajectory.duration=40",
    "parameters.k1=1", "parameters.k3=1", "parameters.k4=0.5",
)  # fmt: skip
QUIET = ("plant.scatter=0", "plant.noise=0", "procedure.rest_ms=0", "procedure.after_ms=0")


def columns_of(*lines: str) -> dict[str, Any]:
    """Return the log of one simulated test."""
    config = Composer().compose([free(line) for line in lines]).config
    check_configuration(config)
    return run_test(config, 1)[0]


def test_the_command_is_that_of_the_law(folder: Path) -> None:
    gains = (
        "controller.kp=200",
        "controller.ki=300",
        "controller.kd=30",
        "controller.derivative_samples=4",
        "controller.offset=0.5",
    )
    found = columns_of(*AXIS, *QUIET, *gains)
    error = found["reference_position_m"] - found["position_m"]
    before = np.concatenate([np.full(4, error[0]), error[:-4]])
    wanted = 0.5 + 200.0 * error + 300.0 * np.cumsum(error) * 1e-3 + 30.0 * (error - before) / 4e-3
    assert np.allclose(found["voltage_v"], wanted, atol=1e-9)
    assert np.ptp(wanted) > 1.0


def test_a_carriage_follows_in_metres(folder: Path) -> None:
    found = columns_of(*AXIS, *QUIET, "controller.kp=400", "controller.ki=400", "controller.kd=30")
    error = found["reference_position_m"] - found["position_m"]
    assert np.max(np.abs(error)) < 0.02 and found["position_m"][-1] > 0.08


def test_a_level_is_held_within_the_limit_of_its_pump(folder: Path) -> None:
    found = columns_of(*TANKS, *QUIET, "controller.kp=2", "controller.ki=0.5", "controller.limit=4")
    level, pump = found["level_v"], found["pump_v"]
    assert np.max(np.abs(pump)) == 4.0 and np.max(level) < 2.05
    # at rest k4 u = k3 sqrt(level)
    assert level[-1] == pytest.approx(2.0, abs=1e-3) and pump[-1] == pytest.approx(2.0**0.5 / 0.5, abs=1e-3)


def test_the_integral_waits_at_the_limit_and_only_there() -> None:
    class Given:
        def __init__(self, **values: Any) -> None:
            self.__dict__.update(values)

    parameter = Given(**{name: one.default for name, one in PlainPid.parameters.items()} | {"ki": 1.0, "limit": 2.0})
    memory = Given(begun=0.0, integral=0.0, errors=np.zeros(100))
    outputs = [
        PlainPid.step(Given(reference=error, measured=0.0, period=1.0, index=index), parameter, memory)
        for index, error in enumerate((1.0, 1.0, 1.0, -1.0))
    ]
    # 1 + 1, then 1 + 2 is beyond 2 and not kept; the way back begins at once: -1 + 0
    assert outputs == [2.0, 2.0, 2.0, -1.0] and memory.integral == 0.0


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (("plant=valve_joint",), "controller plain_pid does not fit plant valve_joint"),
        (("plant=two_pumps",), "controller plain_pid does not fit plant two_pumps"),
        ((), "controller plain_pid does not fit plant pump_joint: it gives output"),
        (("plant=axis", "controller.input=volt"), "unknown input 'volt'"),
        (("plant=axis", "controller.kq=1"), "kq"),
    ],
)
def test_where_it_does_not_fit(folder: Path, lines: tuple[str, ...], words: str) -> None:
    with pytest.raises(UsageError) as refused:
        columns_of(*lines, "controller=plain_pid", "trajectory=hold")
    assert words in str(refused.value)


def test_a_plant_with_several_inputs_says_which(folder: Path) -> None:
    file = folder / "plants" / "axis.py"
    text = file.read_text()
    more = text.replace("    gain = Parameter", '    brake = Input("V")\n    gain = Parameter', 1).replace(
        "drive.voltage)", "(drive.voltage - drive.brake))", 1
    )
    assert more.count("brake") == 2
    file.write_text(more)
    with pytest.raises(UsageError, match="it commands one input, the plant has 2"):
        columns_of(*AXIS, *QUIET)
    found = columns_of(*AXIS, *QUIET, "controller.kp=-400", "controller.kd=-30", "controller.input=brake")
    assert found["position_m"][-1] > 0.08 and not np.any(found["voltage_v"])
