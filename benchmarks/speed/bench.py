"""Speed, printed as one table of ratios measured in this run. Run it as `make bench`."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import lsoda
import numpy as np

from hjcamp.configuration.composer import Composer
from hjcamp.plants.pump_joint.simulation import log_columns, prepare
from hjcamp.records.log import TestLog
from hjcamp.records.read import read_log
from hjcamp.records.write import write_log

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from quiet_loop import DEGREE, columns, sine

SEVEN = (
    "gravity_load",
    "payload_inertia",
    "leakage",
    "entrained_air",
    "stribeck_friction",
    "encoder_lag",
    "line_inertance",
)
Row = tuple[str, str, str]


def best_of(count: int, work: Callable[[], Any]) -> float:
    """Return the shortest wall time of ``count`` calls, s."""
    times = []
    for _ in range(count):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def cpu_of(work: Callable[[], Any]) -> float:
    """Return the processor time that the processes took which ``work`` ran, s."""
    before = os.times()
    work()
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def compose(*choices: str) -> dict[str, Any]:
    """Return a resolved configuration."""
    return Composer().compose(list(choices)).config


def against_scipy() -> Iterator[Row]:
    """Open-loop sine of 4.6.2 over 4 s, published model: ours with its propagators, and LSODA with its events."""
    sampled = sine(120.0, 2.0, 4.0)
    ours = columns(sampled, lsoda.PRESSURES)["arm_deg"]
    held = lsoda.solve(4.0, 1e-9, held=True)
    error = np.abs(ours - held).max() / DEGREE
    procedure = {**compose()["procedure"], "initial": {"pressure1_mpa": 0.32, "pressure2_mpa": 0.14}}
    asked = compose("controller=open_loop", "trajectory=sine_2hz_open_loop", "trajectory.duration=4")

    def spent_on(given: dict[str, Any]) -> float:
        prepared = prepare(asked | {"procedure": given}, 1)
        prepared.simulator.run(prepared.start, prepared.p, prepared.test)
        return best_of(300, lambda: prepared.simulator.run(prepared.start, prepared.p, prepared.test))

    mine = spent_on(procedure)
    # Without rest and release it is the 4 s that LSODA solves.
    alone = spent_on(procedure | {"rest_ms": 0.0, "release_mpa": 1.0})
    converged = lsoda.solve(4.0, 1e-11)
    for tolerance in (1e-4, 1e-5, 1e-6, 1e-7):
        other_error = np.abs(lsoda.solve(4.0, tolerance) - converged).max() / DEGREE
        if other_error <= error:
            break
    other = best_of(3, lambda: lsoda.solve(4.0, tolerance))
    restarted = best_of(1, lambda: lsoda.solve(4.0, tolerance, held=True))
    yield (
        "published model, 4 s open loop",
        f"{mine * 1e3:.3f} ms, error {error:.5f} deg",
        "with propagators, rest and release",
    )
    note = f"{other * 1e3:.0f} ms, error {other_error:.5f} deg"
    yield f"SciPy LSODA with events, rtol {tolerance:g}", note, "smooth command: its best case"
    yield "ratio", f"{other / mine:.0f}", "at least 500, goal 1000"
    yield "ratio for these 4 s alone", f"{other / alone:.0f}", f"{alone * 1e3:.3f} ms, without rest and release"
    yield "ratio to LSODA with the held command", f"{restarted / mine:.0f}", "the problem that the rig poses"


def against_real_time() -> Iterator[Row]:
    """Closed loops: how much faster than the rig, and how many steps one sample takes."""
    cases = {
        "no effect, PID": ((), (), ""),
        "no effect, PID, payload": ((), ("payload=brass_8p5g",), "at least 5000, goal 10 000"),
        "7 effects, open loop": (SEVEN, (), "at least 6000, goal 10 000"),
        "7 effects, PID": (SEVEN, (), "at least 2000, goal 5000"),
        "7 effects, FFWD + PID, payload": (SEVEN, ("payload=brass_8p5g",), "at least 2000, goal 5000"),
    }
    for name, (effects, choices, aim) in cases.items():
        controller = {"PID": "pid", "FFWD + PID": "ffwd_pid", "open loop": "open_loop"}[name.split(", ")[1]]
        config = compose(f"controller={controller}", "trajectory=sine_0p5hz", *choices)
        given = {**(config["effects"] or {})}
        prepared = prepare(config | {"effects": {**{effect: {} for effect in effects}, **given}}, 1)
        found = prepared.simulator.run(prepared.start, prepared.p, prepared.test)
        spent = best_of(20, lambda prepared=prepared: prepared.simulator.run(prepared.start, prepared.p, prepared.test))
        samples = len(found["phase"])
        note = f"{samples * 1e-3 / spent:.0f} x real time ({found['steps'] / samples:.2f} steps a sample)"
        yield f"sine_0p5hz, {name}", note, aim


def of_the_command_line(folder: Path) -> Iterator[Row]:
    """The first answer, and a whole campaign."""
    root = str(Path(__file__).parents[2])
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, [root, os.environ.get("PYTHONPATH")]))}

    def call(*arguments: str, cache: str = "") -> Callable[[], Any]:
        command, own = [sys.executable, "-m", "hjcamp", *arguments], {"HJCAMP_CACHE": str(folder / cache)} if cache else {}
        return lambda: subprocess.run(command, cwd=folder, env=environment | own, check=True, capture_output=True)

    # what was composed is kept in the cache folder: the first of each pair finds an empty one
    plans = [call("plan", "campaign=robustness_vertical", cache=name) for name in ("a", "b", "c")]
    first, again = (min(cpu_of(plan) for plan in plans) for _ in range(2))
    yield "hjcamp plan, first and again", f"{first:.2f} and {again:.2f} s of processor time", "goal 0.5"
    call("--help")()
    yield "hjcamp --help", f"{best_of(5, call('--help')):.2f} s", "at most 0.18 s, goal 0.12"
    call("run", "campaign=controllers", "repetitions=1", f"run_dir={folder / 'warm'}")()
    spent = best_of(1, call("run", "campaign=controllers", f"run_dir={folder / 'timed'}"))
    yield "hjcamp run campaign=controllers", f"{spent:.1f} s", "98 tests, at most 5 s, goal 3.5"


def of_the_records(folder: Path) -> Iterator[Row]:
    """One log of a 4 s test."""
    prepared = prepare(compose("controller=pid", "trajectory=sine_0p5hz"), 1)
    found = log_columns(prepared.simulator.run(prepared.start, prepared.p, prepared.test))
    path = folder / "log.mcap"
    log = TestLog(found, {"campaign": "bench"}, {})
    spent = best_of(5, lambda: write_log(path, log))
    samples = len(found["time_s"])
    yield "write a log", f"{spent * 1e3:.0f} ms", f"{samples} samples, {path.stat().st_size / 1e3:.0f} kB"
    yield "read a log", f"{best_of(5, lambda: read_log(path)) * 1e3:.0f} ms", "with CRCs"


def main() -> None:
    """Print the table; the ratios are those of a machine that does nothing else, so the load is said first."""
    print(f"load of the machine {', '.join(f'{load:.1f}' for load in os.getloadavg())} on {os.cpu_count()} processors")
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for rows in (against_scipy(), against_real_time(), of_the_records(folder), of_the_command_line(folder)):
            for what, found, note in rows:
                print(f"{what:<44}  {found:<46}  {note}", flush=True)


if __name__ == "__main__":
    main()
