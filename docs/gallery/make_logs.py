"""Make the recordings of docs/gallery.md and of `hjcamp tour --plant`: a spindle, solved by small steps of its own, without hjcamp.

python docs/gallery/make_logs.py
"""

from __future__ import annotations

import csv
import math
import random
from collections.abc import Callable, Sequence
from pathlib import Path

HERE = Path(__file__).parent
TOUR = HERE.parents[1] / "hjcamp" / "plants" / "pump_joint" / "tour" / "spindle"
PERIOD, SMALL = 0.01, 50
FINE = 1000  # where nothing hides: what 50 steps a sample miss where the speed turns round would be seen
GAIN = 0.02  # N m / V
RPM = 60.0 / (2.0 * math.pi)
SPINDLE = {"inertia": 3.2e-4, "coulomb": 0.012, "viscous": 2.2e-4}
OTHER_SPINDLE = {"inertia": 4.6e-4, "coulomb": 0.019, "viscous": 3.4e-4}
Law = Callable[[float], float]


def nothing(speed: float) -> float:
    """No further torque."""
    return 0.0


def drag(speed: float) -> float:
    """Air brakes with the square of the speed, N m."""
    return -1.5e-6 * speed * abs(speed)


def rub(speed: float) -> float:
    """A seal rubs most at one speed, N m."""
    return -math.copysign(0.012 * math.exp(-(((abs(speed) - 220.0) / 70.0) ** 2)), speed) if speed else 0.0


def steps(seed: int, rows: int) -> list[float]:
    """Voltages that are held for 0.2 to 0.9 s."""
    drawn, volts = random.Random(seed), []
    while len(volts) < rows:
        volts += [drawn.uniform(-8.0, 12.0)] * drawn.randint(20, 90)
    return volts[:rows]


def pull(speed: float) -> float:
    """A belt pulls one way, N m."""
    return 0.002


def fluttering_pull(speed: float) -> float:
    """A belt pulls one way, harder at some speeds than at others, N m."""
    return 0.002 + 0.0006 * math.sin(speed / 60.0)


def turned_round(rows: int, volts: Sequence[float] = (8.0, -6.0, 5.0, -8.0, 7.0)) -> list[float]:
    """Long runs at a voltage each, and the direction turns in between."""
    return [volts[len(volts) * row // rows] for row in range(rows)]


def record(
    path: Path, volts: Sequence[float], seed: int, law: Law = nothing, *, noise: float = 0.3, small: int = SMALL,
    inertia: float, coulomb: float, viscous: float,
) -> None:  # fmt: skip
    """Write one recording: time (ms), speed (rpm) with noise (rpm), voltage (V)."""
    drawn, speed, h = random.Random(1000 + seed), 0.0, PERIOD / small
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(["t_ms", "n_rpm", "u_V"])
        for row, voltage in enumerate(volts):
            writer.writerow([round(1e3 * PERIOD * row), f"{speed * RPM + drawn.gauss(0.0, noise):.1f}", f"{voltage:.2f}"])
            torque = GAIN * float(f"{voltage:.2f}")
            for _ in range(small):
                push = torque + law(speed) - viscous * speed
                if speed == 0.0 and abs(push) <= coulomb:
                    continue
                after = speed + h * (push - math.copysign(coulomb, speed if speed else push)) / inertia
                speed = 0.0 if speed * after < 0.0 else after


def main() -> None:
    """Write every recording."""
    for name, seed in (("train_1", 1), ("train_2", 2), ("held_out", 3)):
        record(TOUR / f"{name}.csv", steps(seed, 1500), seed, drag, **SPINDLE)
    for name, law, spindle, seeds in (
        ("seal", rub, SPINDLE, (4, 5)),
        ("plain", nothing, SPINDLE, (6, 7)),
        ("other", nothing, OTHER_SPINDLE, (8,)),
    ):
        for number, seed in enumerate(seeds, start=1):
            record(
                HERE / f"{name}_{number}.csv", steps(seed, 1500), seed, law, small=FINE if name == "plain" else SMALL, **spindle
            )
    record(HERE / "short.csv", steps(9, 300), 9, drag, **SPINDLE)
    record(HERE / "turns.csv", turned_round(1500), 10, pull, noise=3.0, **SPINDLE)
    record(HERE / "belt_1.csv", turned_round(1500), 21, fluttering_pull, noise=1.0, **SPINDLE)
    record(HERE / "belt_2.csv", turned_round(1500, (-5.0, 7.0, -8.0, 6.0, -7.0)), 22, fluttering_pull, noise=1.0, **SPINDLE)


if __name__ == "__main__":
    main()
