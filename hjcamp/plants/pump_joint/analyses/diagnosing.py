"""What the model of the joint misses."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, Report, silent
from hjcamp.analyses.diagnosing import MOST_WORKERS, Asked, check_asked, considered, own_and_asked, with_asked
from hjcamp.plants.pump_joint.analyses.evidence import evidence_in
from hjcamp.report.wording.repeatability import NEAR

if TYPE_CHECKING:
    from hjcamp.model.declare.effect import Effect
    from hjcamp.plants.pump_joint.diagnosis.answer import Judging
    from hjcamp.plants.pump_joint.diagnosis.diagnose import Diagnosis
    from hjcamp.plants.pump_joint.diagnosis.localisation.unexplained import Unexplained
    from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
    from hjcamp.plants.pump_joint.diagnosis.scale import Judged


@dataclass(frozen=True)
class Diagnosed:
    """A diagnosis of the joint with all that its words need: the answer for programs, the library, what was started
    from.
    """

    found: Diagnosis
    content: dict[str, Any]
    library: Mapping[str, type[Effect]]
    model: str
    start: Judged | None
    judging: Judging
    unexplained: Unexplained | None
    shown: Any = None


def diagnose_joint(
    data: Data,
    asked: Asked,
    report: Report = silent,
    compiling: Callable[[int, int], None] = lambda done, count: None,
    lacking: Callable[[Evidence], None] = lambda evidence: None,
    gather: Callable[[Diagnosis, dict[str, Any], Mapping[str, type[Effect]]], Any] = lambda found, content, library: None,
) -> Diagnosed:
    """Return what the model of the joint misses (`hjcamp.plants.pump_joint.diagnosis.diagnose`).

    ``compiling`` hears how many kernels of how many are there, ``lacking`` the evidence before anything is computed; what
    ``gather`` makes of the diagnosis, while its processes are there, is kept as ``shown``.
    """
    from hjcamp.effects import load_effects
    from hjcamp.plants.pump_joint.diagnosis.answer import Judging, answer, asked_candidates
    from hjcamp.plants.pump_joint.diagnosis.diagnose import diagnose
    from hjcamp.plants.pump_joint.diagnosis.models.saved import saved_model
    from hjcamp.plants.pump_joint.studies.warm import missing, ready_to_diagnose, side_by_side
    from hjcamp.workers.pool import Crew, available

    began = time.perf_counter()
    asked.check()
    start = saved_model(asked.model)
    library = considered(load_effects(), asked.only, asked.without, start.effects)
    check_asked(asked.ask, library)
    effects = tuple(library.values())
    number = asked.workers or min(available(), MOST_WORKERS)
    crew = Crew(number, asked.cluster, partial(ready_to_diagnose, tuple(library)))
    try:
        evidence = evidence_in(data)
        lacking(evidence)  # before anything is compiled: who gave the wrong logs hears it at once
        if work := missing(effects):
            compiling(0, len(work))
            for count, _ in enumerate(side_by_side(work, number), start=1):
                compiling(count, len(work))
        begin = start if start.base or start.effects else None
        found = diagnose(evidence, effects, effort=asked.effort, seed=asked.seed, start=begin, crew=crew, report=report)
        judging = Judging(found, effects, asked.effort)
        content = answer(found, effects, asked.effort, 0.0, report, judging)
        wanted, rows = own_and_asked(library, asked.ask), content["candidates"]
        more = asked_candidates(judging, wanted, [row["effect"] for row in rows])
        content["candidates"] = with_asked(rows, more, wanted)
        before = judging.of_start(start)
        shown = gather(found, content, library)
    finally:
        crew.close()
    curve, content["unknowns"] = _unknowns(found, content)
    content["seconds"] = round(time.perf_counter() - began, 3)
    return Diagnosed(found, content, library, asked.model, before, judging, curve, shown)


def _unknowns(found: Diagnosis, content: Mapping[str, Any]) -> tuple[Unexplained | None, list[dict[str, Any]]]:
    """Return the residual over its likeliest driver, and a row for each driver, the first with the curve."""
    from hjcamp.plants.pump_joint.diagnosis.localisation.drivers import rank_drivers
    from hjcamp.plants.pump_joint.diagnosis.localisation.unexplained import CHANNELS, unexplained

    if not content["drivers"]:
        return None, []
    fit = found.final if looks_at_final(found, content["error"]["augmented"]) else found.baseline
    told = {
        driver: (channel, share) for driver, channel, share in reversed(rank_drivers(found.features, fit, found.noise_floor))
    }
    first, *others = content["drivers"]
    curve = unexplained(found.features, fit, first, *told[first])
    rows = [
        {"driver": name, "quantity": CHANNELS[told[name][0]][1], "port": told[name][0], "gain": float(told[name][1])}
        for name in others
        if name in told
    ]
    return curve, [curve.row(), *rows]


def looks_at_final(found: Diagnosis, error: float | None) -> bool:
    """Return whether the best model leaves enough to be looked at; else an effect fits whose law does not hold."""
    return found.final is not found.baseline and (error is None or error > NEAR)
