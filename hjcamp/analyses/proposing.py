"""Which tests of a plant to make next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, Report, silent
from hjcamp.analyses.diagnosing import Asked, PlantDiagnosed, chosen_and_start, diagnose_plant, made_from
from hjcamp.json_text import read_json

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.design.proposal import Makeable, Proposal
    from hjcamp.diagnosis.selection.scored import Scored

DIAGNOSED = 0.6


@dataclass(frozen=True)
class PlantProposed:
    """What is proposed: the analysis of the tests so far, the answer of their diagnosis, and the proposal.

    ``reused`` is the file of a diagnosis that was made before, None where it was made now.
    """

    analysis: Analysis
    diagnosis: Mapping[str, Any]
    proposal: Proposal
    reused: Path | None


def propose_for_plant(
    data: Data,
    asked: Asked,
    rivals: Sequence[str] = (),
    tests: int = 3,
    kept: Path | None = None,
    report: Report = silent,
) -> PlantProposed:
    """Return the tests that separate best what a diagnosis of any plant leaves (`hjcamp.diagnosis.next`).

    ``kept`` may be the answer of a diagnosis: where it was made from the same logs and model, the search is not made again.
    """
    from hjcamp.diagnosis.calibration.analysis import calibrated
    from hjcamp.diagnosis.design.rivals import NONE, check_names

    before = _kept(kept, made_from(data, asked))
    if before is not None:
        made = before["made_from"]
        considered = replace(asked, only=made.get("only"), without=made.get("without"))
        chosen, start, forms = chosen_and_start(data, considered)
        before = before if all(name in chosen or name == NONE for name in rivals) else None
    if before is None:
        chosen, start, forms = chosen_and_start(data, asked)
    check_names(chosen, rivals)
    if before is None and not rivals:
        done = diagnose_plant(data, asked, lambda text, share: report(text, DIAGNOSED * share))
        return propose_after(done, rivals, tests, asked.seed, report)
    report("compiling, once for this plant and its effects", 0.02)
    # tests that were simulated through are so again
    width = before["window_samples"] if before and not before.get("simulated_through") else None
    analysis = calibrated(data.measured, chosen, start, report, asked.seed, width=width, forms=forms)
    content = before or {"verdict": None, "effects": [], "candidates": [], "confidence_set": [], "unknowns": []}
    return _proposed(analysis, content, [], rivals, tests, asked.seed, kept if before else None, report)


def propose_after(
    done: PlantDiagnosed,
    rivals: Sequence[str] = (),
    tests: int = 3,
    seed: int = 1,
    report: Report = silent,
    makeable: Makeable | None = None,
) -> PlantProposed:
    """Return the proposal after a diagnosis (`PlantDiagnosed`) that is at hand, of tests that are ``makeable``."""
    from hjcamp.diagnosis.design.rivals import check_names

    check_names(done.analysis.search.library, rivals)
    verdict = done.verdict
    known = [verdict.model, *([verdict.term] if verdict.term else []), *verdict.rivals, *verdict.named, *verdict.terms]
    return _proposed(done.analysis, done.content, known, rivals, tests, seed, None, report, makeable)


def _proposed(
    analysis: Analysis, content: Mapping[str, Any], known: Sequence[Scored], rivals: Sequence[str], tests: int, seed: int,
    reused: Path | None, report: Report, makeable: Makeable | None = None,
) -> PlantProposed:  # fmt: skip
    from hjcamp.diagnosis.design.proposal import propose
    from hjcamp.diagnosis.design.rivals import question_of

    report("fitting the rivals", DIAGNOSED)
    question = question_of(analysis, content, known, rivals, seed)
    rest = 1.0 - DIAGNOSED
    own = {} if makeable is None else {"makeable": makeable}
    proposal = propose(analysis, question, tests, lambda text, share: report(text, DIAGNOSED + rest * share), **own)
    return PlantProposed(analysis, content, proposal, reused)


def _kept(path: Path | None, wanted: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return the answer in a file where it is of the same logs and model; what cannot be read is not there."""
    try:
        content = read_json(path) if path is not None else None
    except (OSError, ValueError):
        return None
    if not isinstance(content, dict) or not wanted["logs_sha256"]:
        return None
    made = content.get("made_from")
    same = isinstance(made, dict) and all(made.get(key) == wanted[key] for key in ("logs_sha256", "model"))
    return content if same and content.get("schema") == "hjcamp.diagnosis/2" and "window_samples" in content else None
