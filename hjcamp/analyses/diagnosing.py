"""What a model misses."""

from __future__ import annotations

import time
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, Report, silent
from hjcamp.diagnosis.levels import ALPHA, DELTA
from hjcamp.errors import UsageError, shown, unknown

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.decision.verdict import Verdict
    from hjcamp.model.declare.candidate import Candidate
    from hjcamp.model.declare.effect import Effect

MOST_WORKERS = 4
# A base that was calibrated to a poor minimum is begun anew so often.
MOST_BEGUN = 2


@dataclass(frozen=True)
class Asked:
    """How a model is searched for what it misses; ``only``, ``without`` and ``ask`` name effects, with commas.

    ``alpha`` is the level of the whole answer, ``delta`` the smallest share of the error above repeatability that matters.
    """

    model: str = "published"
    effort: str = "standard"
    seed: int = 1
    only: str | None = None
    without: str | None = None
    workers: int | None = None
    cluster: str | None = None
    ask: str | None = None
    alpha: float = ALPHA
    delta: float = DELTA

    def check(self) -> None:
        """Refuse an unknown effort, and a seed and a number of processes that a run would not take."""
        from hjcamp.analyses.effort import EFFORTS

        check_seed(self.seed)
        if self.effort not in EFFORTS:
            raise unknown("effort", self.effort, EFFORTS)
        check_workers(self.workers)
        for name, value, most in (("alpha", self.alpha, 0.5), ("delta", self.delta, 1.0)):
            if not 0.0 < value < most:
                raise UsageError(f"--{name} {value:g}: give a number between 0 and {most:g}")


@dataclass(frozen=True)
class PlantDiagnosed:
    """A diagnosis of any plant: the analysis, its verdict, the answer for programs."""

    analysis: Analysis
    verdict: Verdict
    content: dict[str, Any]


def check_seed(seed: int) -> None:
    """Refuse a seed that ``seed=`` of a run would not take."""
    if not 0 <= seed < 2**63:
        raise UsageError(f"--seed {shown(seed)}: give a whole number, 0 or more and below 2^63")


def check_workers(workers: int | None) -> None:
    """Refuse a number of processes that ``workers=`` of a run would not take."""
    from hjcamp.configuration.run_keys import MOST_PROCESSES

    if workers is not None and not 1 <= workers <= MOST_PROCESSES:
        raise UsageError(f"--workers {shown(workers)}: give a whole number from 1 to {MOST_PROCESSES}")


def diagnose_plant(data: Data, asked: Asked, report: Report = silent) -> PlantDiagnosed:
    """Return what the model of any plant misses (`hjcamp.diagnosis.decision.verdict`)."""
    from hjcamp.diagnosis.calibration.analysis import Known, calibrated
    from hjcamp.diagnosis.calibration.restarts import better_base
    from hjcamp.diagnosis.data.repeatability import not_above
    from hjcamp.diagnosis.decision.verdict import decided
    from hjcamp.diagnosis.results.answer import answer
    from hjcamp.diagnosis.results.candidate_rows import asked_candidates
    from hjcamp.workers.pool import available

    began = time.perf_counter()
    asked.check()
    measured = data.measured
    if asked.cluster is not None:
        raise UsageError(f"--cluster {asked.cluster}: {measured.plant.name} is diagnosed on this machine alone; give --workers")
    chosen, start, forms = chosen_and_start(data, asked)
    check_asked(asked.ask, chosen)
    report("compiling, once for this plant and its effects", 0.02)
    number = asked.workers or min(available(), MOST_WORKERS)
    wanted = own_and_asked(chosen, asked.ask)
    known = Known()
    at = partial(
        calibrated, measured, chosen, start, report, asked.seed, effort=asked.effort, workers=number, known=known, forms=forms,
        wanted=wanted,
    )  # fmt: skip
    analysis = at()
    verdict = decided(analysis, asked.alpha, asked.delta)
    for _ in range(MOST_BEGUN):
        better = better_base(analysis, verdict.shown, (*verdict.named, *verdict.terms))
        if better is None:
            break
        report("better optimum found for the base parameters; restarting", 0.05)
        known.base = better
        analysis = at()
        verdict = decided(analysis, asked.alpha, asked.delta)
    analysis = replace(analysis, noise_floor=not_above(analysis.noise_floor, verdict.shown.fitted.features))
    content = answer(analysis, verdict, 0.0)
    content["candidates"] = with_asked(content["candidates"], asked_candidates(analysis, verdict, wanted), wanted)
    content["made_from"] = made_from(data, asked)
    content["seconds"] = round(time.perf_counter() - began, 3)
    return PlantDiagnosed(analysis, verdict, content)


def chosen_and_start(data: Data, asked: Asked) -> tuple[dict[str, type[Effect]], Candidate, dict[str, type[Effect]]]:
    """Return the effects that are considered for the plant of these tests, the model to start from, and forms of contacts.

    ``--only`` says what may be named; the form of a contact belongs to the base unless ``--without`` takes it out.
    """
    from hjcamp.diagnosis.calibration.contact_compliance import forms_among
    from hjcamp.diagnosis.results.model_file import load_model
    from hjcamp.effects import load_effects

    plant = data.measured.plant
    library = load_effects(plant=plant)
    start = load_model(asked.model, plant, library)
    forms = forms_among(library if asked.without is None else considered(library, None, asked.without, start.effects))
    return considered(library, asked.only, asked.without, start.effects), start, forms


def made_from(data: Data, asked: Asked) -> dict[str, Any]:
    """Return what a diagnosis of any plant depends on: the logs by their content, the model, the effects considered."""
    from hjcamp.configuration.saved_model import log_hashes

    logs = sorted(log_hashes(log.path for log in data.logs).values())
    return {"logs_sha256": logs, "model": asked.model, "only": asked.only, "without": asked.without, "seed": asked.seed}


def considered(
    library: Mapping[str, Any], only: str | None, without: str | None, given: Collection[str] = ()
) -> dict[str, Any]:
    """Return the effects that are named by ``only`` and not by ``without``; those of the model that is ``given`` always."""
    chosen = set(library)
    for option, text in (("--only", only), ("--without", without)):
        if text is None:
            continue
        names = [name.strip() for name in text.split(",") if name.strip()]
        if not names:
            raise UsageError(f"{option} '{text}': give the names of effects, such as {next(iter(library))}")
        for name in names:
            if name not in library:
                raise unknown("effect", name, library, option)
        chosen = chosen & set(names) if option == "--only" else chosen - set(names)
    if not any(getattr(library[name], "claimed", True) for name in chosen):
        options = "".join(f"{option} {text} " for option, text in (("--only", only), ("--without", without)) if text)
        never = f"; {', '.join(sorted(chosen))} is never named, see hjcamp effects {min(chosen)}" if chosen else ""
        raise UsageError(f"{options}leaves no effect to look for{never}" if options else "there is no effect to look for")
    return {name: effect for name, effect in library.items() if name in chosen or name in given}


def check_asked(ask: str | None, library: Mapping[str, Any]) -> None:
    """Refuse an effect after ``--ask`` that is not among those considered."""
    for name in asked_names(ask):
        if name not in library:
            raise unknown("effect", name, library, "--ask")


def asked_names(ask: str | None) -> list[str]:
    """Return the names after ``--ask``; refuse an option without any."""
    names = [name.strip() for name in (ask or "").split(",") if name.strip()]
    if ask is not None and not names:
        raise UsageError(f"--ask '{ask}': give the names of effects")
    return names


def own_and_asked(library: Mapping[str, Any], ask: str | None) -> list[str]:
    """Return the effects that get a row among the candidates whatever they explain: the user's own, and those asked for."""
    from hjcamp.model.files.user_file import is_users

    own = [name for name, effect in library.items() if is_users(effect.__module__)]
    return list(dict.fromkeys([*asked_names(ask), *own]))


def with_asked(rows: list[dict[str, Any]], more: list[dict[str, Any]], wanted: Collection[str]) -> list[dict[str, Any]]:
    """Return the candidates with ``more`` behind them, those that are ``wanted`` marked: they are shown in any case."""
    return [{**row, "asked": True} if row["effect"] in wanted else row for row in (*rows, *more)]
