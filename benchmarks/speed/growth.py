"""How the time and memory of a fit's parts grow with the number of tests: python benchmarks/speed/growth.py [10 40 160 640]

Tests of the heater of `benchmarks.foreign_machines`, 300 samples each, each a condition of its own, all samples looked at. A kernel is
compiled before anything is measured; each row is a process of its own, in processor time.
"""

from __future__ import annotations

import multiprocessing
import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[2] / "tests")]

SAMPLES = 300
SIZES = (10, 40, 160, 640)


def measured(count: int, folder: Path) -> Any:
    """Return so many tests of a heater with nothing missing, whose plant is written into a folder."""
    from benchmarks.foreign_machines.heater import MACHINE, PERIOD
    from hjcamp.diagnosis.data.measured_test import MeasuredTest
    from hjcamp.diagnosis.data.tests import Measured, Sensor
    from hjcamp.known_plants import find_plant

    rig = {name: value if isinstance(value, float) else float(np.mean(value)) for name, value in MACHINE.rig.items()}
    (folder / "heater.py").write_text(MACHINE.source(rig, 1), encoding="utf-8")
    plant = find_plant("heater", folders=[folder])
    tests = []
    for k in range(count):
        columns = MACHINE.measure(rig, np.random.default_rng([1, k]), np.random.default_rng([2, k]), SAMPLES)
        given = {"power": columns["P_W"]}
        names = [name for name in plant.inputs if name not in ("time", "direction")]
        inputs = np.column_stack([given.get(name, np.full(SAMPLES, plant.inputs[name].default)) for name in names])
        readings = columns["rise_K"][:, None]
        tests.append(MeasuredTest(f"test_{k}", f"c{k}", columns["t_s"], inputs, readings, (), None))  # type: ignore[arg-type]
    return Measured(plant, PERIOD, (Sensor("rise_k", "K", 1.0),), (0,), tuple(tests))


def row(count: int) -> tuple[float, float, float]:
    """Return the seconds of a base fit and of one `left_out`, and the process' memory, MB."""
    from hjcamp.diagnosis.calibration.analysis import calibrated
    from hjcamp.diagnosis.validation.blocks import left_out

    with tempfile.TemporaryDirectory() as folder:
        tests = measured(count, Path(folder))
        begun = time.process_time()
        analysis = calibrated(tests, {}, unknowns=False, effort="thorough")
        fitted = time.process_time()
        left_out(analysis.windows, analysis.base.fitted, analysis.search.blocks)
        done = time.process_time()
    return fitted - begun, done - fitted, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main(sizes: tuple[int, ...]) -> None:
    """Print a row for each number of tests."""
    with multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as pool:
        pool.apply(row, (sizes[0],))
        print("| tests | samples | base fit, CPU s | left_out, CPU s | MB |\n|---|---|---|---|---|")
        for count in sizes:
            fit, left, memory = pool.apply(row, (count,))
            print(f"| {count} | {count * SAMPLES} | {fit:.2f} | {left:.3f} | {memory:.0f} |", flush=True)


if __name__ == "__main__":
    main(tuple(int(one) for one in sys.argv[1:]) or SIZES)
