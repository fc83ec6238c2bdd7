"""The tests that separate what a diagnosis of the joint leaves, as configurations of the campaign that is at work."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, Report
from hjcamp.commands.hunting.chosen import Choose, Chosen, condition_name
from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from hjcamp.analyses.diagnosing import Asked
    from hjcamp.plants.pump_joint.analyses.diagnosing import Diagnosed

#: What a test of the menu says of a configuration; all else is the campaign's.
OF_A_TEST = ("trajectory", "controller", "payload", "orientation", "procedure")


def judged(data: Data, asked: Asked, report: Report) -> tuple[dict[str, Any], Choose]:
    """Return the diagnosis of tests of the joint, and what chooses the tests that follow it."""
    from hjcamp.plants.pump_joint.analyses.diagnosing import diagnose_joint

    done = diagnose_joint(data, asked, report)
    return done.content, partial(choose, done, data.paths, asked)


def choose(
    done: Diagnosed, paths: Sequence[Path], asked: Asked, configs: Sequence[Mapping[str, Any]], tests: int, number: int,
    report: Report,
) -> Chosen:  # fmt: skip
    """Return the tests of `hjcamp next` for the joint on the hardware of the campaign, with nothing mounted for them."""
    from hjcamp.configuration.composer import Composer
    from hjcamp.plants.pump_joint.answers.next_answer import answer, names_of
    from hjcamp.plants.pump_joint.answers.next_work import Words, work_after
    from hjcamp.plants.pump_joint.diagnosis.design.propose import REPETITIONS

    config, verdict = configs[0], str(done.content["verdict"])
    fixed = {group: config[group]["name"] for group in ("payload", "orientation")}
    on_a_rig = config["backend"]["name"] != "simulation"
    if on_a_rig:
        fixed["rig"] = config["rig"]["name"]
    work = work_after(done.found, Words(list(paths), fixed, [], asked.workers), dict(done.library))
    if work is None:
        return Chosen(answer(None, verdict, None, None), why="no rivals remain")
    try:
        proposal = work.propose(tests, asked.seed, report)
    except UsageError as problem:
        return Chosen(answer(None, verdict, None, None), why=str(problem))
    said = answer(proposal, verdict, None, None)
    hidden = tuple(one.name for one in proposal.rivals) if verdict == "nothing_missing" else ()
    if not proposal.tests:
        return Chosen(said, hidden=hidden, why=f"no test of the menu within the limits separates {names_of(proposal)}")
    found: dict[str, dict[str, Any]] = {}
    texts: dict[str, str] = {}
    composer = Composer()
    for one in proposal.tests:
        name = condition_name(one.trial.choice.name, number, found)
        made = {**config, **{group: one.trial.config[group] for group in OF_A_TEST}}
        made["controller_model"] = composer.model(str(made["controller"].get("model")))
        found[name], texts[name] = made, one.trial.choice.text
    return Chosen(said, found, texts, REPETITIONS, hidden)
