"""The loop of any plant: tests on the simulated rig are those of the simulator, units and signs are the driver's, faults end safe."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lab_of_rigs import MOTION, RIG, Made

from hjcamp import backends, cli
from hjcamp.backends.rig.any_plant.backend import run_on
from hjcamp.backends.rig.any_plant.bench import WAYS, fake_of, tried
from hjcamp.errors import RigStopped
from hjcamp.records.read import read_log
from hjcamp.rigs import find_rig
from hjcamp.rigs.rig import Channel, Rig

SOUND = (Channel("position_m", range=(-1.0, 1.0)), Channel("voltage", range=(-10.0, 10.0)))


def rig_with(*channels: Channel, **own: Any) -> type[Rig]:
    """Return a rig of the axis with some channels."""
    return type("Bench", (Rig,), {"plant": "axis1", "name": "bench", "channels": channels or SOUND, **own})


def test_the_simulated_rig_is_the_simulation_bit_for_bit(made: Made) -> None:
    there, _ = backends.run_test(made(), 3)
    here, notes = backends.run_test(made("backend=rig", "rig=simulated"), 3)
    assert list(here) == list(there) and np.ptp(here["position_m"]) > 4e-3
    for name, values in there.items():
        np.testing.assert_array_equal(here[name], values, name)
    assert notes["late_samples"] == "0" and notes["watchdog"] == "none"


def test_units_and_signs_are_the_drivers(made: Made) -> None:
    config = made("backend=rig", "rig=simulated")
    other = rig_with(
        Channel("voltage", unit="mv", range=(-1e4, 1e4), sign=-1),
        Channel("position_m", unit="mm", range=(-900.0, 900.0), sign=-1),
    )
    fake = fake_of(other, config, "sound")
    found, _ = run_on(fake, config, 3)
    there, _ = backends.run_test(made(), 3)
    for name in ("position_m", "voltage_v"):
        np.testing.assert_allclose(found[name], there[name], rtol=1e-6, atol=1e-9)
    # what the driver was told in the middle: millivolts, the other way
    assert fake.ever[100][0] == pytest.approx(-1e3 * there["voltage_v"][99], rel=1e-6)


def test_every_way_to_fail_ends_safe(made: Made) -> None:
    config = made("backend=rig", "rig=simulated")
    results = {way: (right, said) for way, right, said in tried(rig_with(), config)}
    assert list(results) == list(WAYS)
    assert all(right for right, _ in results.values()), {way: one for way, one in results.items() if not one[0]}


LIMITED = {
    "below": ({"limits": (0.001, 1.0)}, {}, {}, "position_m .* m is below 0.001 m"),
    "above": ({"limits": (-1.0, 0.002)}, {}, {}, "position_m 0.002.* m is above 0.002 m"),
    "lost": ({"range": (-1.0, 0.002)}, {}, {}, "position_m is lost: .* at an end of its range, -1 to 0.002"),
    "fast": ({"fastest": 0.01}, {}, {}, r"position_m changes by 0\.01.* m/s, limit 0.01"),
    "tracking": ({}, {}, {"tracking": 1e-4}, "tracking error .* m, limit 0.0001 m"),
    "clipped": ({}, {"range": (-0.5, 0.5)}, {}, "voltage is clipped: .* V asked, -0.5 to 0.5 there, limit clipped_s 0 s"),
}  # fmt: skip


@pytest.mark.parametrize("case", LIMITED)
def test_each_limit_makes_the_rig_safe(made: Made, case: str) -> None:
    position, voltage, own, said = LIMITED[case]
    config = made("backend=rig", "rig=simulated")
    rig = rig_with(Channel("position_m", **{"range": (-1.0, 1.0), **position}), Channel("voltage", **voltage), **own)
    fake = fake_of(rig, config, "sound")
    with pytest.raises(RigStopped, match=f"the rig was made safe: {said}"):
        run_on(fake, config, 3)
    assert fake.put == [0.0]


def test_an_output_may_be_clipped_for_as_long_as_the_rig_says(made: Made) -> None:
    config = made("backend=rig", "rig=simulated")
    rig = rig_with(SOUND[0], Channel("voltage", range=(-0.5, 0.5)), clipped_s=10.0)
    found, _ = run_on(fake_of(rig, config, "sound"), config, 3)
    assert np.abs(found["voltage_v"]).max() == 0.5


def test_a_rig_without_watchdog_and_interlock_does_not_move(lab: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (lab / "rigs" / "bench.py").write_text(RIG)
    assert cli.run(["run", *MOTION, "backend=rig", "rig=bench", "repetitions=1"]) == 2
    assert "rig 'bench' has no watchdog" in capfd.readouterr().err
    assert cli.run(["run", *MOTION, "backend=rig", "rig=bench", "rig.interlock=relay K1", "repetitions=1"]) != 0
    assert "run `hjcamp rig check plant=axis1 rig=bench` first" in capfd.readouterr().err


DRIVEN = RIG.replace("range=(-10.0, 10.0)", "range=(-10.0, 10.0), nudge=2.0").replace(
    "    def read(self):\n        return [0.0]\n    def write(self, values):\n        pass\n",
    """    interlock = "none"
    missed_at_once = missed_in_all = 10**6
    clipped_s = 9.0
    deadline_s = 5.0
    def open(self):
        self.v = self.x = self.u = 0.0
    def read(self):
        push = 35.0 * self.u
        self.v += 1e-3 * (push - 200.0 * self.v) / 95.0 if abs(push) > 20.0 else -self.v
        self.x += SIGN * 1e-3 * self.v
        return [self.x]
    def write(self, values):
        self.u = values[0]
""",
)


@pytest.mark.parametrize(
    ("sign", "code", "said"), [(1.0, 0, "has passed"), (-1.0, 1, "position_m goes the wrong way"), (0.0, 1, "does not follow")]
)
def test_the_check_sees_the_direction_of_each_reading(
    lab: Path, sign: float, code: int, said: str, capfd: pytest.CaptureFixture[str]
) -> None:
    file = lab / "rigs" / "bench.py"
    file.write_text(DRIVEN.replace("SIGN", str(sign)))
    run = ["run", *MOTION, "controller.kp=4000", "backend=rig", "rig=bench", "repetitions=1", "run_dir=runs/one"]
    assert cli.run(["rig", "check", "plant=axis1", "rig=bench", "--yes"]) == code
    assert said in capfd.readouterr().out
    if code:
        return
    assert cli.run(run) == 0, capfd.readouterr().err
    log = read_log(next((lab / "runs" / "one").rglob("*.mcap")))
    assert log.metadata["rig"] == "bench" and log.metadata["interlock"] == "none" and np.ptp(log.columns["position_m"]) > 1e-4
    capfd.readouterr()
    file.write_text(file.read_text() + "# another driver\n")
    assert cli.run([*run[:-1], "run_dir=runs/two"]) != 0
    assert "since the last check file was" in capfd.readouterr().err
    assert find_rig("bench").plant == "axis1"


def test_the_live_page_shows_the_limits_of_plant_and_rig(made: Made, lab: Path) -> None:
    from hjcamp.live.describe import describe

    told = RIG.replace("range=(-1.0, 1.0)", "range=(-900.0, 900.0), unit='mm', limits=(-300.0, 400.0), fastest=50.0")
    (lab / "rigs" / "bench.py").write_text(told.replace("    def read", "    tracking = 20.0\n    def read"))
    shown = {one["name"]: one for one in describe(made("backend=rig", "rig=bench"))["watches"]}
    assert (shown["position_m"]["low"], shown["position_m"]["high"], shown["position_m"]["unit"]) == (-300.0, 400.0, "mm")
    assert shown["position_m"]["terms"][0]["factor"] == pytest.approx(1e3)
    assert shown["position_m_rate"]["high"] == 50.0 and shown["tracking"]["high"] == 20.0
    assert shown["missed_in_all"]["high"] == 40.0
