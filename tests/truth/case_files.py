"""The files of a hidden case on a machine of this package: CSV logs, import map, the user's plant, the sealed answer."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml


@dataclass(frozen=True)
class MeasuredLog:
    """One log: name of its file, columns in the units that their names say, metadata, whether it is held out."""

    name: str
    columns: dict[str, np.ndarray]
    metadata: dict[str, str]
    held_out: bool = False


def write_case_files(
    folder: Path | str,
    plant: str,
    source: str,
    fields: Mapping[str, str | Mapping[str, Any]],
    logs: Sequence[MeasuredLog],
    answer: Mapping[str, Any],
) -> Path:
    """Write a case and return the path of its answer.

    `measured/*.csv` and `heldout/*.csv`, `import.yaml` (field: column, or what a map says of it) for both, the user's
    `plants/<plant>.py`, and
    `truth.json`, which whoever diagnoses must not read. In that folder: `hjcamp import measured/*.csv --map import.yaml
    --into logs`, then `hjcamp diagnose logs`.
    """
    folder = Path(folder)
    for name in ("measured", "heldout", "plants"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    (folder / "plants" / f"{plant}.py").write_text(source, encoding="utf-8")
    for log in logs:
        path = folder / ("heldout" if log.held_out else "measured") / f"{log.name}.csv"
        table = np.column_stack(list(log.columns.values()))
        np.savetxt(path, table, "%.9g", delimiter=",", header=",".join(log.columns), comments="")
    mapping = {
        "plant": plant,
        "fields": {field: {"column": column} if isinstance(column, str) else dict(column) for field, column in fields.items()},
        "files": {f"{log.name}.csv": dict(log.metadata) for log in logs},
    }
    (folder / "import.yaml").write_text(yaml.safe_dump(mapping, sort_keys=False), encoding="utf-8")
    path = folder / "truth.json"
    path.write_text(json.dumps(answer, indent=2) + "\n", encoding="utf-8")
    return path


def rough(value: float, random: np.random.Generator, spread: float = 0.4) -> float:
    """Return what a user would guess for a value: wrong by some `spread` (log), with one significant digit."""
    return float(f"{value * np.exp(random.normal(0, spread)):.1g}")
