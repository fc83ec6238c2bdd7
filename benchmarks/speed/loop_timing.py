"""How much of the 1 ms budget a cycle of the rig's loop needs for itself: python benchmarks/speed/loop_timing.py [seconds]

Own work is everything between two calls of the vendor's API: scaling, limits, procedure and control law, the row of the
log; the thread that writes the log to the disk runs beside it. ``with client`` adds the vendor's client code and the
virtual device in this process. Reads are paced to 1 kHz by the wall clock, as a sample clock would. Own work is also
given in processor time, which other programs on this computer cannot lengthen.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from hjcamp import backends
from hjcamp.backends.recording import recording
from hjcamp.configuration.composer import Composer
from hjcamp.plants.pump_joint.rig import nidaqmx
from hjcamp.plants.pump_joint.rig.tasks import RigTasks
from hjcamp.records.write import LogWriter

BUDGET_US = 1000.0


class PacedTasks(RigTasks):
    """Waits for the wall clock before each read, and notes when the loop called and when it was answered."""

    def read(self) -> int:
        spent, called = time.thread_time_ns(), time.perf_counter_ns()
        self.next_ns = max(getattr(self, "next_ns", called) + 1_000_000, called)
        while (left := self.next_ns - time.perf_counter_ns()) > 0:
            time.sleep(left * 1e-9 if left > 100_000 else 0)
        start = time.perf_counter_ns()
        missed = super().read()
        MOMENTS.append((called, start, time.perf_counter_ns(), spent, time.thread_time_ns()))
        return missed

    def write(self, command: float, motor: float, dither: float, preload_speed: float) -> None:
        called, spent = time.perf_counter_ns(), time.thread_time_ns()
        super().write(command, motor, dither, preload_speed)
        WRITES.append((called, time.perf_counter_ns(), spent, time.thread_time_ns()))


MOMENTS: list[tuple[int, ...]] = []
WRITES: list[tuple[int, ...]] = []


def main(seconds: float = 10.0) -> None:
    """Run one test and print the percentiles."""
    nidaqmx.RigTasks = PacedTasks  # type: ignore[misc]
    lines = ["backend=nidaqmx", "trajectory=sine_0p5hz", "controller=ffwd_pid", "rig.return_speed_mm_per_s=null"]
    config = Composer().compose([*lines, f"trajectory.duration={seconds:g}", "rig.limits.missed_in_all=1000"]).config
    backends.run_test({**config, "backend": {"name": "simulation"}}, 1)  # compiles what both need
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rep_01.mcap"
        with recording(path, lambda name, names: LogWriter(name, names, {}, {}, replace=True)):
            backends.run_test(config, 1)
    n = min(len(MOMENTS) - 1, len(WRITES))
    reads, writes = np.array(MOMENTS[: n + 1]), np.array(WRITES[:n])
    own = (writes[:, 0] - reads[:n, 2]) + (reads[1:, 0] - writes[:, 1])
    processor = (writes[:, 2] - reads[:n, 4]) + (reads[1:, 3] - writes[:, 3])
    whole = own + (reads[:n, 2] - reads[:n, 1]) + (writes[:, 1] - writes[:, 0])
    load = f", {os.getloadavg()[0]:.1f} programs at work on {os.cpu_count()} cores" if hasattr(os, "getloadavg") else ""
    print(f"{n} cycles at 1 kHz, budget {BUDGET_US:g} us{load}")
    for name, lengths in (("own work", own), ("  processor", processor), ("with client", whole)):
        median, high, worst = np.percentile(lengths, [50, 99.9, 100]) * 1e-3
        late = int((lengths > BUDGET_US * 1e3).sum())
        print(f"{name:<12} median {median:6.1f} us   99.9 % {high:6.1f} us   longest {worst:7.1f} us   over budget {late}")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 10.0)
