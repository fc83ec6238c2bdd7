"""Every kind and every trajectory of the configuration: analytic reference, totals, bad input."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from hjcamp.errors import UsageError
from hjcamp.trajectories import Trajectory, build_trajectory, find_kinds

CONFIGURATION = Path(__file__).parents[2] / "conf" / "trajectory"
TOTALS = {
    "ramp_pos": 1.0,
    "ramp_neg": 1.0,
    "sine_0p5hz": 4.0,
    "sine_1hz": 2.0,
    "cycloid_pos": 2.0,
    "cycloid_neg": 2.0,
    "mixed": 6.0,
    "sine_2hz_open_loop": 2.0,
}
NAMES = sorted(path.stem for path in CONFIGURATION.glob("*.yaml"))


def configuration(name: str) -> dict[str, Any]:
    config = yaml.safe_load((CONFIGURATION / f"{name}.yaml").read_text(encoding="utf-8"))
    if config.get("duration") == "${.rise_time}":
        config["duration"] = config["rise_time"]
    return config


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_are_those_of_the_angle(name: str) -> None:
    trajectory = build_trajectory(configuration(name))
    step = 1e-5
    time = np.arange(0.0, trajectory.duration, 0.00137)[1:-1]
    angle_before, velocity_before, _ = trajectory.reference(time - step)
    angle_after, velocity_after, _ = trajectory.reference(time + step)
    _, velocity, acceleration = trajectory.reference(time)
    # Central differences are wrong only where a corner lies between the two points: leave those out.
    smooth = np.abs(velocity_after - velocity_before) < 1e3 * step
    assert smooth.mean() > 0.98
    assert np.allclose((angle_after - angle_before)[smooth] / (2 * step), velocity[smooth], atol=1e-4)
    numerical = (velocity_after - velocity_before)[smooth] / (2 * step)
    assert np.mean(np.isclose(numerical, acceleration[smooth], atol=0.01, rtol=1e-4)) > 0.98


@pytest.mark.parametrize("name", NAMES)
def test_starts_at_zero_and_holds_its_end(name: str) -> None:
    trajectory = build_trajectory(configuration(name))
    for values in trajectory.reference(np.array([-1.0, -1e-9])):
        assert not values.any()
    angle, velocity, acceleration = trajectory.reference(trajectory.duration + np.array([0.0, 0.5, 100.0]))
    assert np.ptp(angle) == 0.0
    assert not velocity.any()
    assert not acceleration.any()
    assert trajectory.reference(0.25)[0].shape == ()
    assert trajectory.reference(np.zeros((3, 2)))[1].shape == (3, 2)


@pytest.mark.parametrize(("name", "total"), TOTALS.items())
def test_totals(name: str, total: float) -> None:
    config = configuration(name)
    assert config["name"] == name
    assert build_trajectory(config).duration == pytest.approx(total, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "at", "angle_deg"),
    [
        ("ramp_pos", 0.5, 60.0),
        ("ramp_pos", 1.0, 120.0),
        ("ramp_neg", 1.0, -120.0),
        ("sine_0p5hz", 0.5, 30.0 * 2.0),
        ("sine_1hz", 0.75, -60.0),
        ("cycloid_pos", 0.25, 120.0 * (0.25 - 1.0 / (2.0 * math.pi))),
        ("cycloid_pos", 1.7, 120.0),
        ("cycloid_neg", 0.5, -60.0),
        ("mixed", 1.5, 120.0),
        ("mixed", 3.2, 0.0),
        ("mixed", 4.3, 60.0),
        ("mixed", 6.0, 0.0),
        ("sine_2hz_open_loop", 0.125, 120.0),
        ("triangle", 0.5, 60.0),
        ("triangle", 1.5, -60.0),
    ],
)
def test_printed_angles(name: str, at: float, angle_deg: float) -> None:
    assert np.degrees(build_trajectory(configuration(name)).reference(at)[0]) == pytest.approx(angle_deg, abs=1e-9)


def test_first_direction_and_end_of_motion() -> None:
    assert [build_trajectory(configuration(name)).first_direction for name in ("ramp_pos", "ramp_neg", "cycloid_neg")] == [
        1.0,
        -1.0,
        -1.0,
    ]
    down = build_trajectory({"kind": "segments", "segments": [{"rest": 1}, {"to_deg": -10, "in": 0.5}]})
    assert (down.first_direction, down.duration) == (-1.0, 1.5)
    assert build_trajectory({"kind": "hold", "angle_deg": -5.0, "duration": 1}).first_direction == -1.0
    assert build_trajectory(configuration("cycloid_pos")).end_of_motion == 1.0
    assert build_trajectory(configuration("mixed")).end_of_motion == pytest.approx(5.0)


def test_samples_on_a_corner_belong_to_the_part_after_it() -> None:
    trajectory = build_trajectory(configuration("mixed"))
    time = np.arange(6000) / 1000.0
    velocity = trajectory.reference(time)[1]
    resting = [(1.0, 2.0), (3.0, 3.5), (4.0, 4.5), (5.0, 6.0)]
    for start, end in resting:
        inside = (time > start - 1e-6) & (time < end - 1e-6)
        assert np.abs(velocity[inside]).max() < 1e-12
    assert np.abs(np.degrees(velocity)).max() == pytest.approx(240.0, rel=1e-6)


BAD = [
    ({}, "kind is missing"),
    ({"kind": "rampe", "duration": 1.0}, "did you mean 'ramp'"),
    ({"kind": "ramp", "amplitude": 1.0, "rise_time": 1.0, "duration": 1.0}, "did you mean 'amplitude_deg'"),
    ({"kind": "ramp", "rise_time": 1.0, "duration": 1.0}, "amplitude_deg is missing"),
    (
        {"kind": "ramp", "amplitude_deg": 1.0, "rise_time": 1.0, "duration": 0.0},
        "duration is 0.0; a number from 0.001 to 3600",
    ),
    ({"kind": "ramp", "amplitude_deg": 1.0, "rise_time": 1.0, "duration": 0.5}, "shorter"),
    ({"kind": "ramp", "amplitude_deg": math.nan, "rise_time": 1.0, "duration": 1.0}, "amplitude_deg is nan"),
    ({"kind": "ramp", "amplitude_deg": "ten", "rise_time": 1.0, "duration": 1.0}, "amplitude_deg is 'ten'"),
    ({"kind": "ramp", "amplitude_deg": True, "rise_time": 1.0, "duration": 1.0}, "amplitude_deg is true"),
    (
        {"kind": "sine", "amplitude_deg": 1.0, "frequency_hz": -1.0, "duration": 1.0},
        "frequency_hz is -1.0; a number from 0.0001",
    ),
    ({"kind": "sine", "amplitude_deg": 1.0, "frequency_hz": 1.0, "duration": math.inf}, "duration is inf"),
    ({"kind": "hold", "duration": 1e9}, "to 3600"),
    ({"kind": "segments", "segments": [{"rest": 3000.0}, {"rest": 3000.0}]}, "at most"),
    ({"kind": "segments", "segments": []}, "at least one"),
    ({"kind": "segments", "segments": "rest"}, "at least one"),
    ({"kind": "segments", "segments": [{"rest": 1.0}], "duration": 2.0}, "unknown trajectory parameter 'duration'"),
    ({"kind": "segments", "segments": [{"rest": 0.0}]}, "rest is 0.0; a number from"),
    ({"kind": "segments", "segments": [{"rest": 1.0, "in": 2.0}]}, "with other"),
    ({"kind": "segments", "segments": [{"to_deg": 1.0, "by_deg": 1.0, "in": 1.0}]}, "one of"),
    ({"kind": "segments", "segments": [{"to_deg": 1.0}]}, "needs 'in'"),
    ({"kind": "segments", "segments": [{"to_degree": 1.0, "in": 1.0}]}, "did you mean 'to_deg'"),
    ({"kind": "segments", "segments": [{"to_deg": 1.0, "in": 1.0, "law": "cycloidal"}]}, "did you mean 'cycloid'"),
    ({"kind": "segments", "segments": [3]}, "a move"),
]


@pytest.mark.parametrize(("config", "message"), BAD, ids=[message for _, message in BAD])
def test_bad_input_is_refused(config: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        build_trajectory(config)


USER_KIND = """
import numpy as np
from hjcamp.trajectories import Trajectory

class Parabola(Trajectory):
    '''Constant acceleration.'''
    acceleration_deg: float = 10.0

    def motion(self, time):
        a = np.radians(self.acceleration_deg)
        return a * time**2 / 2, a * time, np.full_like(time, a)
"""


def test_a_users_folder_adds_a_kind(tmp_path: Path) -> None:
    (tmp_path / "parabola.py").write_text(USER_KIND)
    folders = [tmp_path, tmp_path / "not_there"]
    assert set(find_kinds(folders)) - set(find_kinds()) == {"parabola"}
    trajectory = build_trajectory({"kind": "parabola", "duration": 2.0}, folders)
    assert isinstance(trajectory, Trajectory)
    assert np.degrees(trajectory.reference(2.0)[0]) == pytest.approx(20.0)
    with pytest.raises(UsageError, match="acceleration_deg is inf"):
        build_trajectory({"kind": "parabola", "duration": 2.0, "acceleration_deg": math.inf}, folders)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("broken", "def (", "line 1"),
        ("raises", "raise RuntimeError('no')", "RuntimeError: no"),
        ("nothing", "x = 1", "defines no trajectory"),
        ("ramp", USER_KIND, "already there"),
    ],
)
def test_a_users_bad_file_is_refused(tmp_path: Path, name: str, text: str, message: str) -> None:
    (tmp_path / f"{name}.py").write_text(text)
    with pytest.raises(UsageError, match=message):
        find_kinds([tmp_path])
