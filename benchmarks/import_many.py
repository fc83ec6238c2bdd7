"""Seconds and memory of an import of many files: python -m benchmarks.import_many --files 1000 --rows 100000 --folder DIR

The rows are those of an axis with noise, `t,x,u` in text. Each call of hjcamp is a process of its own; what it printed last is printed.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from hjcamp.commands.shared.plant_template import TEMPLATE

MAP = """plant: carriage
fields:
  time_s: {column: t, unit: s}
  position_m: {column: x, unit: mm}
  voltage_v: {column: u, unit: V}
"""
BLOCK = 100_000


def write_table(path: Path, rows: int, seed: int) -> None:
    """Write a recording of so many rows at 1 kHz."""
    generator = np.random.default_rng(seed)
    with path.open("w", encoding="ascii") as stream:
        stream.write("t,x,u\n")
        for first in range(0, rows, BLOCK):
            k = np.arange(first, min(first + BLOCK, rows))
            t = 1e-3 * k
            x = 50.0 * np.sin((1.0 + 1e-4 * seed) * t) + 0.01 * generator.standard_normal(len(k))
            u = 5.0 * np.sin((2.0 + 1e-4 * seed) * t)
            np.savetxt(stream, np.column_stack([t, x, u]), fmt=["%.3f", "%.4f", "%.4f"], delimiter=",")


def main() -> None:
    """Write the files, import them with one command, and print seconds and memory."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--files", type=int, default=1000)
    parser.add_argument("--rows", type=int, default=100_000)
    parser.add_argument("--resample-s", type=float)
    parser.add_argument("--folder", type=Path, required=True)
    asked = parser.parse_args()
    raw = asked.folder / "raw"
    raw.mkdir(parents=True)
    (asked.folder / "plants").mkdir()
    (asked.folder / "plants" / "carriage.py").write_text(TEMPLATE.format(title="Carriage"), encoding="utf-8")
    more = f"resample_s: {asked.resample_s}\n" if asked.resample_s else ""
    (asked.folder / "map.yaml").write_text(MAP + more, encoding="ascii")
    for number in range(asked.files):
        write_table(raw / f"test_{number:04d}.csv", asked.rows, number)
    size = sum(one.stat().st_size for one in raw.iterdir()) / 1e6
    call = [sys.executable, "-m", "hjcamp", "import", "raw", "--map", "map.yaml", "--into", "logs"]
    began, spent = time.monotonic(), os.times()
    done = subprocess.run(call, cwd=asked.folder, capture_output=True, text=True, check=False)
    seconds, after = time.monotonic() - began, os.times()
    cpu = after.children_user + after.children_system - spent.children_user - spent.children_system
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e3
    print("\n".join((done.stdout + (done.stderr if done.returncode else "")).splitlines()[-6:]))
    rows = f"{asked.files} files of {asked.rows} rows ({size:.0f} MB)"
    print(f"{rows}: code {done.returncode}, {seconds:.0f} s, {cpu:.0f} CPU s, at most {peak:.0f} MB")


if __name__ == "__main__":
    main()
