"""The loop of any plant at 1 kHz, with and without the live page: python benchmarks/speed/plant_timing.py [pairs] [seconds]

An axis with a PID on a driver that waits for the wall clock, as a sample clock would; the plant is simulated in the driver. Tests come
in pairs, one with the page and two browsers that read all events, in alternating order. *Own work* is all between two calls of the
driver: the change to its thread and back, scaling, limits, law, the row of the log. *Processor* is that of the whole process in a
cycle, with the simulated plant and the thread that writes the log.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from live_timing import BROWSERS, followed
from loop_timing import BUDGET_US

from hjcamp.backends.rig.any_plant.backend import compile_ahead, run_on
from hjcamp.backends.virtual_rig.clients import Stepped
from hjcamp.backends.virtual_rig.device import wiring_of_plant
from hjcamp.commands.shared.plant_template import TEMPLATE
from hjcamp.configuration.composer import Composer, free
from hjcamp.known_plants import find_plant
from hjcamp.rigs.fit import channels_of_plant

LINES = (
    "plant=axis", "controller=plain_pid", "controller.kp=2000", "controller.kd=40", "trajectory=sine", "trajectory.amplitude_m=0.05",
    "backend=rig", "rig=simulated",
)  # fmt: skip
CALLS: list[tuple[int, int]] = []
WRITES: list[tuple[int, int]] = []
PERIOD_NS = 1_000_000


class Paced(Stepped):
    """Waits for the wall clock before each read, and notes when the loop called and when it was answered."""

    lockstep = False

    def open(self) -> None:
        """Begin a test."""
        super().open()
        self._next = time.perf_counter_ns()

    def read(self) -> object:  # type: ignore[override]
        """Return the next sample once it is due."""
        called = time.perf_counter_ns()
        self._next = max(self._next + PERIOD_NS, called)
        while (left := self._next - time.perf_counter_ns()) > 0:
            time.sleep(left * 1e-9 if left > 100_000 else 0)
        found = super().read()
        CALLS.append((called, time.perf_counter_ns()))
        return found

    def write(self, values: object) -> None:  # type: ignore[override]
        """Set the outputs."""
        called = time.perf_counter_ns()
        super().write(values)  # type: ignore[arg-type]
        WRITES.append((called, time.perf_counter_ns()))


def one_test(config: dict, folder: Path, live: bool) -> tuple[np.ndarray, float]:
    """Make one test; return own work (ns) of each cycle, and the processor time of the process for one (ns)."""
    CALLS.clear()
    WRITES.clear()
    wiring = wiring_of_plant(find_plant("axis"))
    own = {"config": config, "wiring": wiring, "channels": channels_of_plant(wiring.plant), "name": "simulated"}
    rig = type("PacedAxis", (Paced,), own)()
    spent = time.process_time_ns()
    followed(lambda: run_on(rig, config, 1), config, folder, live, plant="axis", period_s="0.001")
    spent = time.process_time_ns() - spent
    n = min(len(CALLS) - 1, len(WRITES))
    reads, writes = np.array(CALLS[: n + 1]), np.array(WRITES[:n])
    return (writes[:, 0] - reads[:n, 1]) + (reads[1:, 0] - writes[:, 1]), spent / n


def main(pairs: int = 4, seconds: float = 5.0) -> None:
    """Make the tests and print the percentiles of both."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            Path("plants").mkdir()
            Path("plants/axis.py").write_text(TEMPLATE.format(title="Axis"), encoding="utf-8")
            config = Composer().compose([free(line) for line in (*LINES, f"trajectory.duration={seconds:g}")]).config
            compile_ahead(config)
            found: dict[bool, list[tuple[np.ndarray, float]]] = {False: [], True: []}
            for pair in range(pairs):
                for live in (False, True) if pair % 2 else (True, False):
                    found[live].append(one_test(config, Path(folder), live))
        finally:
            os.chdir(before)
    load = f", {os.getloadavg()[0]:.1f} programs at work on {os.cpu_count()} cores" if hasattr(os, "getloadavg") else ""
    print(f"{pairs} pairs of tests of an axis at 1 kHz, {BROWSERS} browsers on the page{load}")
    for live, tests in found.items():
        lengths = np.concatenate([own for own, _ in tests])
        median, high, worst = np.percentile(lengths, [50, 99.9, 100]) * 1e-3
        late = int((lengths > BUDGET_US * 1e3).sum())
        processor = np.mean([spent for _, spent in tests]) * 1e-3
        print(
            f"{'with page' if live else 'without':<10} {len(lengths)} cycles   own work median {median:6.1f} us   "
            f"99.9 % {high:7.1f} us   longest {worst:8.1f} us   late {late}   processor {processor:6.1f} us"
        )


if __name__ == "__main__":
    given = sys.argv[1:]
    main(int(given[0]) if given else 4, float(given[1]) if len(given) > 1 else 5.0)
