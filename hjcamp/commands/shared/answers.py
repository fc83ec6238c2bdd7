"""What the commands that show something answer to programs; the schemas are in docs/schemas/."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hjcamp.json_text import read_json

if TYPE_CHECKING:
    from pathlib import Path

    from hjcamp.campaign.runs.finding import FoundRun
    from hjcamp.model.declare.effect import Effect
    from hjcamp.model.declare.parameter import Parameter
    from hjcamp.model.declare.plant import Plant
    from hjcamp.records.recover import Verification


def run_answer(run: FoundRun) -> dict[str, Any]:
    """Return what ``hjcamp show`` answers: state, conditions, sessions, failures, and the metrics where there is a report."""
    tests = run.manifest["tests"]
    page = run.path / "report.html"
    return {
        "schema": "hjcamp.run/1",
        "run": str(run.path),
        "campaign": run.plan.campaign,
        "state": run.state,
        "tests": {"planned": len(run.plan.tests), "done": run.done},
        "axes": run.plan.axes,
        "conditions": [{"name": one.name, "choices": one.choices} for one in run.plan.conditions],
        "sessions": run.manifest["sessions"],
        "failed": [
            {"test": name, "message": one.get("message", "")} for name, one in tests.items() if one["state"] == "failed"
        ],
        "metrics": _metrics(run.path / "metrics.json"),
        "report": str(page) if page.is_file() else None,
    }


def effect_row(effect: type[Effect]) -> dict[str, Any]:
    """Return an effect: where it acts, what it is, its parameters."""
    return {
        "name": effect.name,
        "subsystem": effect.subsystem or None,
        "acts_on": effect.acts_on or None,
        "text": effect.sentence(),
        "slots": list(effect.terms),
        "states": [{"name": one.name, "unit": one.unit, "text": one.text} for one in effect.states.values()],
        "parameters": [parameter_row(one) for one in effect.parameters.values()],
    }


def parameter_row(parameter: Parameter) -> dict[str, Any]:
    """Return a parameter in SI units; a bound that is not there is null."""
    return {
        "name": parameter.name,
        "unit": parameter.unit,
        "default": parameter.default if math.isfinite(parameter.default) else None,
        "bounds": [bound if math.isfinite(bound) else None for bound in parameter.bounds],
        "prior": parameter.prior,
        "absent_at": parameter.off,
        "text": parameter.text,
    }


def plant_row(plant: type[Plant], effects: Sequence[str]) -> dict[str, Any]:
    """Return a plant in short: what it is, what is measured, and which effects fit."""
    measured = [channel.field for channel in plant.channels] or list(plant.measured)
    return {"name": plant.name, "text": plant.sentence(), "measured": measured, "effects": list(effects)}


def plant_answer(plant: type[Plant], effects: Sequence[str], unfit: Mapping[str, str]) -> dict[str, Any]:
    """Return what ``hjcamp plants NAME`` answers: states, inputs, parameters, equations, places, and the effects."""
    from hjcamp.model.language.vocabulary import read_vocabulary

    vocabulary = read_vocabulary(plant)
    return {
        "schema": "hjcamp.plant/1",
        **plant_row(plant, effects),
        "states": [{"name": one.name, "unit": one.unit, "text": one.text} for one in plant.states.values()],
        "inputs": [{"name": one.name, "unit": one.unit, "text": one.text} for one in plant.inputs.values()],
        "parameters": [parameter_row(one) | {"base": one.name in plant.base_parameters} for one in plant.parameters.values()],
        "equations": [
            {"mark": one.mark, "target": one.target, "expression": one.expression, "unit": one.unit or None}
            for one in vocabulary.statements
        ],
        "places": [{"kind": one.kind, "name": one.name, "names": dict(one.names)} for one in vocabulary.ports.values()],
        "unfit": [{"name": name, "reason": reason} for name, reason in unfit.items()],
    }


def log_rows(found: Sequence[Verification]) -> list[dict[str, Any]]:
    """Return what logs hold and what is wrong with them."""
    return [
        {
            "log": str(one.path), "whole": one.whole, "plant": one.plant, "period_s": one.period, "samples": one.samples,
            "duration_s": one.duration, "fields": list(one.fields), "metadata": one.metadata,
            "attachments": list(one.attachments), "problems": list(one.problems),
            "findings": [{"field": each.field, "text": each.text, "refused": each.refused} for each in one.findings],
        }
        for one in found
    ]  # fmt: skip


def _metrics(path: Path) -> dict[str, Any] | None:
    try:
        found = read_json(path)
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None
