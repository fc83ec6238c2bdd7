"""Make the two logs of docs/own_plant.md: a carriage whose cable pulls it back, solved without the program.

    python docs/own_plant/make_logs.py
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "diagnosis"))
from carriage import measured_log


def cable(x: float, v: float) -> float:
    """A cable pulls the carriage back to 20 mm, N."""
    return -140.0 * (x - 0.02)


for name, seed in (("train", 11), ("held_out", 12)):
    columns = measured_log(cable, seconds=16.0, seed=seed).columns
    with (Path(__file__).parent / f"{name}.csv").open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(["t_ms", "x_mm", "u_V"])
        for time, position, voltage in zip(columns["time_s"], columns["position_m"], columns["voltage_v"], strict=True):
            writer.writerow([f"{time * 1e3:.0f}", f"{position * 1e3:.3f}", f"{voltage:.4f}"])
