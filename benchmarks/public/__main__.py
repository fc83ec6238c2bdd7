"""Our numbers next to the published ones: make public DATA=FOLDER, or python -m benchmarks.public FOLDER

FOLDER holds the files of the published sets as they were downloaded (`sets.py` says which; others are left out). Of each set the
plant that comes along is fitted to its training records by `hjcamp import` and `calibrate`, written as Python by `model export`, and
simulated freely over each test record, from a start that is fitted to the samples which the benchmark gives for that. The table is
printed and written to FOLDER/results.md; nothing else is kept, and nothing is fetched.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import yaml
from scipy.optimize import least_squares

from benchmarks.public.sets import SETS, Array, PublicSet, Table

HERE = Path(__file__).parent
MODEL = "public_fit"
# Samples from which a start is fitted where a benchmark gives none: it is part of the record that counts.
OWN_WINDOW = 50
HEAD = "| set | what | published by | published | here | unit |\n|---|---|---|---|---|---|"


def find(folder: Path, one: PublicSet) -> list[Path]:
    """Return the files of a set anywhere in a folder, in the order of the set; empty where one is not there."""
    found = []
    for names in one.files:
        paths = [path for name in names for path in sorted(folder.rglob(name))]
        if not paths:
            return []
        found.append(paths[0])
    return found


def call(work: Path, *words: str) -> None:
    """Run hjcamp in a folder; raises RuntimeError with what it says where it fails."""
    done = subprocess.run([sys.executable, "-m", "hjcamp", *words], cwd=work, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"hjcamp {' '.join(words)}: {done.stderr.strip().splitlines()[-1:]}")


def fitted(one: PublicSet, train: dict[str, Table], work: Path) -> tuple[ModuleType, dict[str, Any]]:
    """Return the exported model that was fitted to the training records, and the rows of its parameters."""
    (work / "plants").mkdir(parents=True)
    shutil.copy(HERE / "plants" / f"{one.plant}.py", work / "plants")
    fields = {name: name for name in next(iter(train.values()))}
    mapping = {"plant": one.plant, "fields": fields, "metadata": {"condition": "{file}"}}
    (work / "map.yaml").write_text(yaml.safe_dump(mapping), encoding="utf-8")
    for name, table in train.items():
        np.savetxt(
            work / f"{name}.csv", np.column_stack(list(table.values())), "%.12g", ",", header=",".join(table), comments=""
        )
    call(work, "import", *(f"{name}.csv" for name in train), "--map", "map.yaml", "--into", "logs")
    call(work, "calibrate", "logs", "--as", MODEL, "--json", "calibration.json")
    call(work, "model", "export", MODEL, "--as", "python", "--into", "model.py")
    spec = importlib.util.spec_from_file_location(f"public_{one.plant}", work / "model.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module, json.loads((work / "calibration.json").read_text())["calibration"]


def free_error(model: ModuleType, one: PublicSet, table: Table) -> float:
    """Return the rms of the free simulation of a test record, in the set's unit, from a start that is fitted to its first samples."""
    from hjcamp.known_plants import find_plant

    plant = find_plant(one.plant, folders=[HERE / "plants"])
    [reading] = [name for name in table if name in plant.measured]
    line = plant.measured[reading].sensor
    [given] = [name for name in table if name not in (reading, "time_s")]
    source = next(iter(plant.given_inputs()))
    names = list(plant.states)
    seen = plant.measured[reading].of
    window = one.window or OWN_WINDOW

    def simulated(start: Array, rows: int) -> Array:
        readings, _ = model.simulate({source: table[given][:rows]}, dict(zip(names, start.tolist(), strict=True)))
        return np.asarray(readings[line], float)

    first = np.array([table[reading][0] if name == seen else plant.states[name].typical * 0.5 for name in names])
    sizes = np.array([plant.states[name].typical for name in names])
    low = np.array([-np.inf if plant.states[name].low is None else plant.states[name].low for name in names])
    begun = least_squares(
        lambda start: simulated(start, window) - table[reading][:window],
        np.maximum(first, low + 1e-9),
        x_scale=sizes,
        bounds=(low, np.inf),
    )
    whole = simulated(begun.x, len(table[reading]))
    return one.scale * float(np.sqrt(np.mean((whole - table[reading])[one.window :] ** 2)))


def rows_of(name: str, one: PublicSet, paths: list[Path], work: Path) -> Iterator[str]:
    """Yield the rows of the table of one set."""
    train, test = one.read(paths)
    model, parameters = fitted(one, train, work)
    known = [what for _, what, _ in one.published]
    ours: dict[str, str] = {}
    units: dict[str, str] = {}
    for what in dict.fromkeys(known):
        if what in parameters:
            row = parameters[what]
            low, high = row["ci95"]
            ours[what], units[what] = f"{row['value']:.4g} ({low:.4g} to {high:.4g})", row["unit"]
    for what in test if one.unit else ():
        ours[what], units[what] = f"{free_error(model, one, test[what]):.4g}", f"{one.unit}, rms of the free simulation"
    for who, what, number in one.published:
        yield f"| {name} | {what} | {who} | {number:g} | {ours[what]} | {units[what]} |"
    for what, number in ours.items():
        if what not in known:
            yield f"| {name} | {what} | - | - | {number} | {units[what]} |"


def main() -> int:
    """Write the table of all sets whose files are there; return 1 where one of them failed, 2 where there is none."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    lines, notes, faults = [HEAD], [], []
    for name, one in SETS.items():
        paths = find(folder, one)
        if not paths:
            print(f"{name}: not there ({', '.join(' or '.join(names) for names in one.files)})", file=sys.stderr)
            continue
        try:
            with tempfile.TemporaryDirectory() as work:
                lines += rows_of(name, one, paths, Path(work))
        except (RuntimeError, KeyError, ValueError, OSError) as error:
            faults.append(f"{name}: {error}")
            continue
        notes.append(f"* {name}: {one.source}. {one.note}".rstrip())
    for fault in faults:
        print(fault, file=sys.stderr)
    if len(lines) == 1:
        print(f"{folder}: no whole set of files", file=sys.stderr)
        return 1 if faults else 2
    text = "\n".join([*lines, "", *notes]) + "\n"
    (folder / "results.md").write_text(text, encoding="utf-8")
    print(text)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
