"""The answer of a table's diagnosis for programs: the keys of ``hjcamp.table_diagnosis/1``; read again by ``hjcamp add``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError
from hjcamp.json_text import read_json
from hjcamp.plants.pump_joint.tables.diagnosis import Diagnosis, Judged
from hjcamp.plants.pump_joint.tables.fit import Fit
from hjcamp.plants.pump_joint.tables.quantities import model_of, quantities_of
from hjcamp.plants.pump_joint.tables.search import Step, penalised

SCHEMA = "hjcamp.table_diagnosis/1"
NAME = "diagnosis.json"


def answer(found: Diagnosis, effort: str, seed: int, command: str, seconds: float) -> dict[str, Any]:
    """Return the answer as plain values; angles in degrees, parameters in SI."""
    return {
        "schema": SCHEMA,
        "command": command,
        "tables": list(found.question.tables),
        "held_out": list(found.held_out.tables) if found.held_out else [],
        "verdict": found.verdict,
        "effects": list(found.effects),
        "p_value": found.p_value,
        "p_left": found.p_left,
        "lacking": list(found.lacking),
        "models": {name: _model(one) for name, one in found.models.items()},
        "error": {name: error_of(one) for name, one in found.fitted.items()},
        "error_held_out": {name: error_of(one) for name, one in found.predicted.items()},
        "steps": [_step(one) for one in found.steps],
        "cells": cell_rows(found.fitted),
        "cells_held_out": cell_rows(found.predicted),
        "table_sha256": found.question.sha256,
        "effort": effort,
        "seed": seed,
        "seconds": round(seconds, 3),
    }


def _model(model: Fit) -> dict[str, Any]:
    if not model.places:
        return {"names": [], "quantities": {}, "settings": model_of({})}
    rows = {}
    for one in quantities_of(model.names):
        place = model.places[one.name]
        rows[one.name] = {
            "published": one.parameter.default,
            "value": one.back(place),
            "unit": one.parameter.unit,
            "sigma_from_published": one.surprise(place) if math.isfinite(one.spread) else None,
            "at_bound": one.back(place) in one.parameter.bounds,
        }
    return {"names": list(model.names), "quantities": rows, "settings": model_of(model.settings)}


def error_of(judged: Judged) -> dict[str, Any]:
    """Return loss, cells within two sigma, and the mean absolute log ratio of each table."""
    tables = {table: _finite(judged.log_ratio(table)) for table in dict.fromkeys(judged.cells.tables)}
    return {"loss": judged.loss, "near": judged.near, "cells": len(judged.cells), "mean_abs_log_ratio": tables}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _step(step: Step) -> dict[str, Any]:
    rivals = sorted(step.rivals, key=lambda one: penalised(one, step.control))
    promised = [
        {"name": one.name, "loss": one.loss, "gain": step.predicted + step.promised[0].loss - one.loss} for one in step.promised
    ]
    return {
        "before": list(step.before.names),
        "control_loss": step.control.loss,
        "gain": step.gain,
        "p_value": step.p_value,
        "gains_of_twins": list(step.replicates),
        "predicted": promised,
        "form": step.form,
        "candidates": [
            {"name": one.names[-1], "loss": one.loss, "gain": step.control.loss - penalised(one, step.control)}
            for one in rivals
        ],
    }


def cell_rows(models: Mapping[str, Judged]) -> list[dict[str, Any]]:
    """Return one row for each cell: what it is, and what each model makes of it."""
    if not models:
        return []
    cells = next(iter(models.values())).cells
    errors = {name: one.errors for name, one in models.items()}
    rows = []
    for place in range(len(cells)):
        table, condition, indicator = cells.label(place)
        rows.append(
            {
                "table": table,
                "condition": condition,
                "choices": dict(cells.conditions[cells.rows[place]]),
                "indicator": indicator,
                "measured": float(cells.means[place]),
                "sigma": float(cells.sigma[place]),
                "simulated": {name: float(one.simulated[place]) for name, one in models.items()},
                "error_in_sigma": {name: float(one[place]) for name, one in errors.items()},
            }
        )
    return rows


def read_answer(path: Path) -> dict[str, Any]:
    """Return the answer in ``path`` or in the folder of a diagnosis; ``UsageError`` for what is none."""
    file = path / NAME if path.is_dir() else path
    try:
        found = read_json(file)
    except (OSError, ValueError) as error:
        raise UsageError(f"{file}: no diagnosis of a table can be read from it ({error})") from error
    if not isinstance(found, dict) or found.get("schema") != SCHEMA:
        raise UsageError(f"{file}: no diagnosis of a table; `hjcamp diagnose --tables ...` writes one ({SCHEMA})")
    return found


def is_answer(path: Path) -> bool:
    """Return whether ``path`` is the folder or the file of a table's diagnosis."""
    return (path / NAME).is_file() if path.is_dir() else path.suffix == ".json" and path.is_file()
