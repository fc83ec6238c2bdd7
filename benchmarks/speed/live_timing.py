"""What the live page costs the rig's loop: python benchmarks/speed/live_timing.py [pairs] [seconds]

The same test on the virtual rig with a hidden effect (a leak of both lines that the client's model does not know), paced to 1 kHz
by the wall clock, in pairs: once without the page, once with it and with two browsers that read all events. The order
within a pair changes. What is measured is what benchmarks/speed/loop_timing.py measures; "late" are cycles over 1 ms.
"""

from __future__ import annotations

import os
import sys
import tempfile
import threading
import urllib.request
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path

import numpy as np
from loop_timing import BUDGET_US, MOMENTS, WRITES, PacedTasks

from hjcamp import backends
from hjcamp.backends.recording import recording
from hjcamp.configuration.composer import Composer
from hjcamp.live.feed import current_feed
from hjcamp.live.process import LiveAsk, live_page
from hjcamp.plants.pump_joint.rig import connection as rig_connection
from hjcamp.plants.pump_joint.rig import nidaqmx
from hjcamp.records.write import LogWriter

HIDDEN = {"leakage": {"conductance": 3e-16}}
BROWSERS = 2


def read_events(address: str, counts: list[int]) -> None:
    """Read what a browser would, until the page ends."""
    with urllib.request.urlopen(f"{address}events", timeout=60) as answer:
        counts.append(sum(line.startswith(b'data: {"kind": "rows"') for line in answer))


def followed(run: Callable[[], object], config: dict, folder: Path, live: bool, **metadata: str) -> list[int]:
    """Make one test, recorded in ``folder``, with or without the page; return the events that each browser got."""
    said: list[str] = []
    counts: list[int] = []
    readers = []
    with live_page(LiveAsk(0, browser=False), said.append) if live else nullcontext():
        feed, look = current_feed(), None
        if feed is not None:
            address = said[0].split()[-1]
            readers = [threading.Thread(target=read_events, args=(address, counts)) for _ in range(BROWSERS)]
            for reader in readers:
                reader.start()
            feed.run("live_timing", folder, {"one": config}, {"one": 1}, {})
            look = feed.look("one/rep_01", "one")
        path = folder / "rep_01.mcap"
        with recording(path, lambda name, names: LogWriter(name, names, metadata, {}, replace=True), look=look):
            run()
        if feed is not None:
            feed.say("complete", "")
    for reader in readers:
        reader.join()
    return counts


def one_test(config: dict, folder: Path, live: bool) -> tuple[np.ndarray, np.ndarray, list[int]]:
    """Make one test; return own work and processor time of each cycle (ns), and the events that each browser got."""
    MOMENTS.clear()
    WRITES.clear()
    rig_connection.in_process_channel().device.hidden = HIDDEN
    counts = followed(lambda: backends.run_test(config, 1), config, folder, live)
    n = min(len(MOMENTS) - 1, len(WRITES))
    reads, writes = np.array(MOMENTS[: n + 1]), np.array(WRITES[:n])
    own = (writes[:, 0] - reads[:n, 2]) + (reads[1:, 0] - writes[:, 1])
    return own, (writes[:, 2] - reads[:n, 4]) + (reads[1:, 3] - writes[:, 3]), counts


def main(pairs: int = 4, seconds: float = 5.0) -> None:
    """Make the tests and print the percentiles of both."""
    nidaqmx.RigTasks = PacedTasks  # type: ignore[misc]
    lines = ["backend=nidaqmx", "trajectory=sine_0p5hz", "controller=ffwd_pid", "rig.return_speed_mm_per_s=null"]
    config = Composer().compose([*lines, f"trajectory.duration={seconds:g}", "rig.limits.missed_in_all=1000"]).config
    backends.run_test({**config, "backend": {"name": "simulation"}}, 1)  # compiles what both need
    found: dict[bool, list[tuple[np.ndarray, np.ndarray]]] = {False: [], True: []}
    seen: list[int] = []
    for pair in range(pairs):
        for live in (False, True) if pair % 2 else (True, False):
            with tempfile.TemporaryDirectory() as folder:
                own, processor, counts = one_test(config, Path(folder), live)
            found[live].append((own, processor))
            seen += counts
    load = f"{os.getloadavg()[0]:.1f} programs at work on {os.cpu_count()} cores" if hasattr(os, "getloadavg") else ""
    print(f"{pairs} pairs of tests at 1 kHz with {', '.join(HIDDEN)} hidden, {BROWSERS} browsers on the page, {load}")
    print(f"events that a browser got in a test: {sorted(seen)}")
    for live, tests in found.items():
        for name, place in (("own work", 0), ("  processor", 1)):
            lengths = np.concatenate([test[place] for test in tests])
            median, high, worst = np.percentile(lengths, [50, 99.9, 100]) * 1e-3
            late = int((lengths > BUDGET_US * 1e3).sum())
            print(
                f"{'with page' if live else 'without':<10} {name:<12} {len(lengths)} cycles   median {median:6.1f} us   "
                f"99.9 % {high:7.1f} us   longest {worst:8.1f} us   late {late}"
            )


if __name__ == "__main__":
    given = sys.argv[1:]
    main(int(given[0]) if given else 4, float(given[1]) if len(given) > 1 else 5.0)
