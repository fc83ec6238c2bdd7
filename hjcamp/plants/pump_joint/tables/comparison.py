"""Saved models compared with a table, simulated exactly as a run would simulate them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from hjcamp.configuration.composer import Composer
from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.simulation import run_test
from hjcamp.plants.pump_joint.tables.answer import cell_rows, error_of
from hjcamp.plants.pump_joint.tables.diagnosis import Judged
from hjcamp.plants.pump_joint.tables.question import Question
from hjcamp.plants.pump_joint.tables.rig import LOST
from hjcamp.records.log import TestLog
from hjcamp.records.plan import seed_of
from hjcamp.report.runs.indicators import CHOICES, INDICATORS, indicators_of


def compare(
    question: Question, names: Sequence[str], repetitions: int, seed: int, report: Callable[[str, float], None]
) -> dict[str, Any]:
    """Return the error of each saved model on the table's cells, with every cell; angles in degrees."""
    composer = Composer()
    models = {name: composer.model(name) for name in names}
    judged: dict[str, Judged] = {}
    for number, (name, model) in enumerate(models.items()):
        rows = []
        for place, condition in enumerate(question.conditions):
            report(f"simulating with model {name}", (number + place / len(question.conditions)) / len(models))
            config = {**condition.config, "model": model}
            trajectory = str(config["trajectory"]["name"])
            rows.append(
                [_indicators(config, seed_of(seed, condition.name, one), trajectory) for one in range(1, repetitions + 1)]
            )
        judged[name] = Judged(question.cells, question.cells.of(np.array(rows)))
    return {
        "schema": "hjcamp.table_comparison/1",
        "tables": list(question.tables),
        "models": {name: model.get("provenance") or {} for name, model in models.items()},
        "error": {name: error_of(one) for name, one in judged.items()},
        "error_held_out": {},
        "cells": cell_rows(judged),
    }


def _indicators(config: dict[str, Any], seed: int, trajectory: str) -> list[float]:
    try:
        columns, _ = run_test(config, seed)
    except HjcampError:
        return [LOST] * len(INDICATORS)
    row = indicators_of(TestLog(columns, dict.fromkeys(CHOICES, "") | {"trajectory": trajectory}))
    return [math.nan if row[name] is None else float(row[name]) for name in INDICATORS]
