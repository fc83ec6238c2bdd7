"""What `hjcamp next` starts from: the words of the call, the rivals, the simulated bench and what is measured already."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hjcamp.analyses.effort import EFFORTS
from hjcamp.campaign.plan.campaign_file import RUN_KEYS
from hjcamp.configuration.composer import as_override, free
from hjcamp.configuration.overrides import key_of, parse_overrides
from hjcamp.errors import UsageError, unknown
from hjcamp.plants.pump_joint.analyses.evidence import evidence_of
from hjcamp.plants.pump_joint.diagnosis.design.campaign_file import allowed_by
from hjcamp.plants.pump_joint.diagnosis.design.menu import menu
from hjcamp.plants.pump_joint.diagnosis.design.propose import Proposal, propose
from hjcamp.plants.pump_joint.diagnosis.design.rivals import NOTHING, Rival, check_names, rivals_by_name, rivals_of
from hjcamp.plants.pump_joint.diagnosis.design.trials import RIG_PRESSURE, Bench
from hjcamp.plants.pump_joint.diagnosis.diagnose import Diagnosis
from hjcamp.workers.pool import Crew, available

Report = Callable[[str, float], None]
HARDWARE = ("pump", "amplifier", "tubing")
DIAGNOSED = 0.6


@dataclass(frozen=True)
class Words:
    """The words of the call: logs, what the user fixes of the configuration, the rivals that were named, and how many workers help."""

    paths: list[Path]
    fixed: dict[str, Any]
    rivals: list[str]
    workers: int | None = None


@dataclass(frozen=True)
class Work:
    """What is to be set apart and on what; ``found`` is the diagnosis of what is measured already."""

    words: Words
    rivals: list[Rival]
    bench: Bench
    fixed: Mapping[str, Any]
    found: Diagnosis | None

    def propose(self, tests: int, seed: int, report: Report) -> Proposal:
        """Return the proposal."""
        choices = allowed_by(menu(), self.words.fixed)
        if not choices:
            given = " ".join(f"{key}={value}" for key, value in self.words.fixed.items())
            raise UsageError(f"{given}: no test of the menu remains with that")
        begin = DIAGNOSED if self.found else 0.0
        crew = Crew(self.words.workers or available())
        try:
            return propose(
                self.rivals,
                self.bench,
                tests=tests,
                # Without a step nothing was fitted: the rivals are not what those tests say.
                measured=self.found.fitter if self.found and self.found.steps else None,
                choices=choices,
                seed=seed,
                crew=crew,
                report=lambda text, share: report(text, begin + (1.0 - begin) * share),
            )
        finally:
            crew.close()


def read_words(words: Sequence[str], rivals: Sequence[str], library: Mapping[str, Any]) -> Words:
    """Return the words of the call sorted: PATH, KEY=VALUE, and effects that follow ``--rivals A`` without a comma."""
    named = [name for group in rivals for name in group.split(",") if name]
    if rivals and not named:
        raise UsageError("--rivals names none; give effects: --rivals A,B")
    paths, overrides = [], []
    for word in words:
        if Path(word).exists():
            paths.append(Path(word))
        elif "=" in word:
            overrides.append(word)
        elif word in library or (named and "/" not in word and not word.endswith(".mcap")):
            named.append(word)
        else:
            paths.append(Path(word))
    parsed = parse_overrides([free(line) for line in overrides])
    for one in parsed:
        if key_of(one).split(".")[0] in RUN_KEYS:
            raise UsageError(f"'{one.input_line}' belongs to the run; give it to `hjcamp run`")
    return Words(paths, {key_of(one): one.value() for one in parsed}, check_names(named, library) if named else [])


def work_of(words: Words, library: Mapping[str, Any], effort: str, seed: int, report: Report) -> Work | Diagnosis:
    """Return the work to be done, or the diagnosis whose verdict leaves nothing to separate."""
    from hjcamp.plants.pump_joint.diagnosis.diagnose import diagnose as search

    if effort not in EFFORTS:
        raise unknown("effort", effort, EFFORTS)
    effects = tuple(library.values())
    if not words.paths:
        bench = Bench(effects, _lines(words.fixed))
        return Work(words, rivals_by_name(words.rivals or [NOTHING, *library], library, bench.values), bench, words.fixed, None)
    evidence = evidence_of(words.paths)
    crew = Crew(words.workers or available())
    try:
        found = search(
            evidence,
            effects,
            effort=effort,
            seed=seed,
            crew=crew,
            report=lambda text, share: report(text, DIAGNOSED * share),
        )
        rivals = rivals_of(found, library, words.rivals)
    finally:
        crew.close()
    return _work(found, rivals, words, effects) or found


def work_after(found: Diagnosis, words: Words, library: Mapping[str, Any]) -> Work | None:
    """Return the work to be done after a diagnosis that is at hand; None where its verdict leaves nothing to separate."""
    return _work(found, rivals_of(found, library, words.rivals), words, tuple(library.values()))


def _work(found: Diagnosis, rivals: list[Rival], words: Words, effects: tuple[Any, ...]) -> Work | None:
    if len(rivals) < 2:
        return None
    tests = found.fitter.views.evidence.tests
    metadata = tests[0].log.metadata
    fixed = {group: metadata[group] for group in HARDWARE if metadata.get(group)} | words.fixed
    highest = max(float(max(test.pressure1.max(), test.pressure2.max())) for test in tests) * 1e-6
    limit = None if "rig" in words.fixed else max(RIG_PRESSURE, highest)
    return Work(words, rivals, Bench(effects, _lines(fixed), found.scatter, limit), fixed, found)


def _lines(fixed: Mapping[str, Any]) -> list[str]:
    return [as_override(key, value) for key, value in fixed.items()]
