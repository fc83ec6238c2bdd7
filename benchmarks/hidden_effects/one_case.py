"""Run one case of the hidden-effect benchmark: write its logs, diagnose them, keep truth and answer, delete the logs."""

from __future__ import annotations

import json
import math
import signal
import sys
import tempfile
import time
import traceback
from pathlib import Path
from typing import Any

from truth.pump_joint.case import write_case

from benchmarks.hidden_effects.cases import PLAN, HiddenCase
from benchmarks.hidden_effects.detectable import visibility

# Parts of an answer that no measure reads; the ledger is committed.
UNSCORED = ("where", "minimum_detectable", "worst", "floor", "rests_on")
DIGITS = 6


def alone() -> None:
    """Leave Ctrl-C to the process that hands out the cases; when it says so, end and take the logs away."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))


def run_case(case: HiddenCase, effort: str, tag: str, seen: dict[str, Any] | None) -> dict[str, Any]:
    """Return the result of one case as plain values; an error in the diagnosis is a result, too.

    ``seen`` is how visible its effects are, where that is known already.
    """
    line: dict[str, Any] = {"plan": PLAN, "tag": tag, "effort": effort, **case.row()}
    with tempfile.TemporaryDirectory(prefix="hidden_effects_") as temporary:
        folder = Path(temporary) / "logs"
        path = write_case(folder, case.effects, case.strength or "medium", case.seed, contact=case.contact, form="random")
        line["truth"] = json.loads(path.read_text(encoding="utf-8"))
        line["visibility"] = visibility(case) if seen is None else seen
        began = time.perf_counter()
        try:
            line |= diagnosed(folder, case.without, effort)
        except Exception as error:
            last = traceback.extract_tb(error.__traceback__)[-1]
            where = f"{Path(last.filename).name}:{last.lineno}"
            line["failure"] = f"{type(error).__name__}: {error} ({where})"
        line.setdefault("seconds", round(time.perf_counter() - began, 3))
    return cleaned(line)


def diagnosed(folder: Path, without: tuple[str, ...], effort: str) -> dict[str, Any]:
    """Return the answer of a diagnosis of the logs in ``folder``, its seconds, and what stands behind it."""
    from hjcamp.effects import load_effects
    from hjcamp.plants.pump_joint.analyses.evidence import evidence_of
    from hjcamp.plants.pump_joint.diagnosis.answer import answer
    from hjcamp.plants.pump_joint.diagnosis.diagnose import diagnose
    from hjcamp.workers.pool import Crew

    effects = tuple(effect for name, effect in load_effects([]).items() if name not in without)
    began, used = time.perf_counter(), time.process_time()
    evidence = evidence_of([folder])
    found = diagnose(evidence, effects, effort=effort, seed=1, crew=Crew(1))
    content = answer(found, effects, effort, 0.0)
    content["seconds"] = round(time.perf_counter() - began, 3)
    for name in UNSCORED:
        content.pop(name, None)
    spent = {"seconds": content["seconds"], "processor_seconds": round(time.process_time() - used, 3)}
    return {"answer": content, **spent, "behind": behind(found, effects)}


def behind(found: Any, effects: Any) -> dict[str, Any]:
    """Return the inner numbers of a diagnosis that explain its verdict; they help to read failures, not to score."""
    from hjcamp.plants.pump_joint.diagnosis.selection.step import counted_gain
    from hjcamp.plants.pump_joint.diagnosis.selection.verdict import law_of, named_by

    try:
        law = law_of(named_by(found.taken, effects))
        return {
            "reason": found.reason,
            "excess": found.null.excess(found.baseline.mean_square, found.final.mean_square, law).tolist(),
            "limit": found.null.limit().tolist(),
            "over": over(found.null, found.final.mean_square),
            "one_effect": with_one_effect(found, effects),
            "deviations": deviations(found, effects),
            "tests": len(found.features.evidence.tests),
            "needed": found.null.needed(),
            "base_candidate": dict(found.baseline.candidate.base),
            "final_candidate": dict(found.final.candidate.effects),
            "steps": [
                {
                    "p_value": step.p_value,
                    "weights": dict(step.weights),
                    "screened": dict(step.screening.gains),
                    "counted": counted_gain(step),
                    "gains": {name: step.screening.about.loss - fit.loss for name, fit in step.fits.items()},
                    "taken": step in found.taken,
                }
                for step in found.steps
            ],
        }
    except (AttributeError, TypeError, ValueError) as error:
        return {"reason": str(getattr(found, "reason", "")), "unavailable": str(error)}


def over(null: Any, mean_square: Any) -> list[float]:
    """Return the error (channels,) over what 95 % of twins leave, before any margin."""
    return list((null.over(mean_square) / null.highest()).tolist())


def deviations(found: Any, effects: Any) -> list[tuple[str, str, float, float, int]]:
    """Return (effect, name, value, the jackknife's standard deviation as a share of it, degrees of freedom) of each unknown."""
    from hjcamp.plants.pump_joint.diagnosis.fitting.heldout import Local
    from hjcamp.plants.pump_joint.diagnosis.screening.screening import unknowns_of

    local = Local(found.fitter, found.final, unknowns_of(found.final.candidate, effects))
    shares = local.deviation / [size or 1.0 for size in local.sizes.tolist()]
    values = {key: row[0] for key, row in local.intervals().items()}
    return [
        (one.effect, one.name, values[one.effect, one.name], float(share), local.freedom)
        for one, share in zip(local.unknowns, shares.tolist(), strict=True)
    ]


def with_one_effect(found: Any, effects: Any) -> dict[str, Any]:
    """Return what the model with the first effect found leaves and what it left without, what a second one gains, and what
    speaks against its law where that is exact."""
    from hjcamp.plants.pump_joint.diagnosis.selection.step import counted_gain
    from hjcamp.plants.pump_joint.diagnosis.selection.verdict import against

    if not found.taken:
        return {}
    later = len(found.steps) > 1
    null, fit = (found.nulls[1], found.steps[1].screening.about) if later else (found.null, found.final)
    best = found.steps[0].best
    drivers = next(effect.exact_in for effect in effects if effect.name == best)
    return {
        "effect": best,
        "before": over(null, found.steps[0].screening.about.mean_square),
        "after": over(null, fit.mean_square),
        "second": found.steps[1].best if later else "",
        "gain": max(counted_gain(found.steps[1]), 0.0) if later else 0.0,
        "against": against(found.fitter.views, found.features, fit, best, drivers[0]) if drivers else {},
    }


def cleaned(value: Any) -> Any:
    """Return plain values that JSON can hold, of six digits: numbers that are not finite become null."""
    if isinstance(value, dict):
        return {str(name): cleaned(one) for name, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [cleaned(one) for one in value]
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
    if hasattr(value, "item"):
        return cleaned(value.item())
    return value
