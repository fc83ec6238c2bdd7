"""Print the error tables of docs/validation.md: the simulator against chapter 4 solved a second time by SciPy."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from quiet_loop import DEGREE, RADIUS, columns, cycloid, sine
from thesis_solution import LAG, Arm, Gains, Physics, Y, closed_loop, open_loop

from hjcamp.plants.pump_joint.controllers.pid import Pid

PRESSURES = (0.32e6, 0.14e6)
GAINS = (Gains(1.05, 70.0, 0.015), Gains(1.4, 90.0, 0.018))
EFFECTS: dict[str, dict[str, float]] = {
    "gravity_load": {"weight": 8.5e-3},
    "payload_inertia": {"payload": 8.5e-3},
    "leakage": {"leak": 2e-16, "leak_above": 3.9e-14},
    "entrained_air": {"air": 8.5e-9},
    "stribeck_friction": {"stribeck": 6e-3},
    # a quarter of its 5 ms is dead time: the rest is the time constant
    "encoder_lag": {"lag": 3.75e-3},
    "line_inertance": {"inertance": 4.2e7},
}


def open_loops() -> None:
    """Open-loop sines of 4 s: each effect alone, all of them, none."""
    print("| model | sine | largest error, deg | rms, deg | of the reference solution | events | reference events |")
    print("|---|---|---:|---:|---:|---:|---:|")
    for name, chosen in {"published": [], **{name: [name] for name in EFFECTS}, "all seven": list(EFFECTS)}.items():
        given: dict[str, float] = {}
        for effect in chosen:
            given |= EFFECTS[effect]
        for amplitude, frequency in ((120.0, 2.0), (60.0, 0.5)):
            reference = sine(amplitude, frequency, 4.0)
            angles, arm = [], None
            for tolerance in (1e-8, 1e-10):
                arm = Arm.at_rest(Physics(**given), *PRESSURES, method="DOP853", rtol=tolerance)
                states = open_loop(arm, 8.5 * reference[:, 0])
                angle = states[:, Y] / RADIUS
                angles.append(states[:, LAG] + (states[:, LAG] - angle) / 3 if "lag" in given else angle)
            assert arm is not None
            found = columns(reference, PRESSURES, effects=tuple(chosen))
            error = (found["arm_deg"] - angles[1]) / DEGREE
            own = np.abs(angles[1] - angles[0]).max() / DEGREE
            print(
                f"| {name} | {amplitude:g} deg, {frequency:g} Hz | {np.abs(error).max():.5f} | {np.sqrt(np.mean(error**2)):.5f} "
                f"| {own:.6f} | {found['events']:.0f} | {len(arm.events)} |",
                flush=True,
            )


def closed_loops() -> None:
    """PID with dither on cycloids of 2 s, with and without payload, with encoder counts and without."""
    print("\n| PID on | payload | counts | error in 1 s, deg | in 2 s, deg | last 0.5 s, peak to peak, ours | reference |")
    print("|---|---|---|---:|---:|---:|---:|")
    for payload in (False, True):
        for direction, name in ((1.0, "cycloid_pos"), (-1.0, "cycloid_neg")):
            for count in (0.0, 2 * np.pi / 1024):
                reference = cycloid(120.0 * direction)
                pressures = (0.36e6, 0.16e6) if direction > 0 else (0.21e6, 0.31e6)
                physics = Physics(payload=8.5e-3 if payload else 0.0)
                arm = Arm.at_rest(physics, *pressures, method="DOP853", rtol=1e-9)
                angle = closed_loop(arm, reference[:, 0], reference[:, 1], GAINS, count=count)
                angle = np.floor(angle / count + 0.5) * count if count else angle
                effects = ("payload_inertia",) if payload else ()
                control = {"first_direction": direction}
                found = columns(reference, pressures, Pid, control, effects, count=count, dither=1.2)["arm_deg"]
                error = np.abs(found - angle) / DEGREE
                spread = [np.ptp(values[-500:]) / DEGREE for values in (found, angle)]
                print(
                    f"| {name} | {'8.5 g' if payload else 'none'} | {'10 bit' if count else 'none'} | {error[:1000].max():.4f} "
                    f"| {error.max():.4f} | {spread[0]:.1f} | {spread[1]:.1f} |",
                    flush=True,
                )


if __name__ == "__main__":
    open_loops()
    closed_loops()
