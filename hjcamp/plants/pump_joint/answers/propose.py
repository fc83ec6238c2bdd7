"""`hjcamp next` for the joint: tests of its menu, before the first logs and after them."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from hjcamp.commands.shared.session import folder_for, progress_of, write_answer
from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from hjcamp.analyses.diagnosing import Asked

SETTLED = {
    "effect": "these tests already say what is missing",
    "nothing_missing": "nothing is missing in these tests, so there is nothing to distinguish",
    "outside_library": "no effect of the library explains these tests; write the effect before further tests",
}


def propose(
    logs: list[Path], words: list[str], rivals: list[str], tests: int, asked: Asked, name: str | None, json: Path | None
) -> None:
    """Propose tests, and write them as a campaign."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.campaign.plan.new_file import new_campaign, write_campaign
    from hjcamp.plants.pump_joint.diagnosis.design.campaign_file import campaign_content

    began = time.perf_counter()
    path = new_campaign(name)
    if asked.model != "published":
        raise UsageError(f"--model {asked.model}: tests of pump_joint are proposed from its published model")
    console = make_console()
    with progress_of(console) as report:
        from hjcamp.effects import load_effects
        from hjcamp.plants.pump_joint.answers.next_answer import answer, comment_of, draw, names_of, tell
        from hjcamp.plants.pump_joint.answers.next_work import Work, read_words, work_of
        from hjcamp.plants.pump_joint.diagnosis.design.propose import REPETITIONS

        library = load_effects()
        given = replace(read_words(words, rivals, library), workers=asked.workers)
        work = work_of(given, library, asked.effort, asked.seed, report)
        if not isinstance(work, Work):
            content = answer(None, work.verdict, None, None)
            content["seconds"] = round(time.perf_counter() - began, 3)
            write_answer(json, content)
            named = f": {', '.join(work.effects)}" if work.effects else ""
            console.print(f"NOTHING TO SEPARATE   {SETTLED[work.verdict]}{named}", markup=False)
            return
        proposal = work.propose(tests, asked.seed, report)
        if not proposal.tests:
            content = answer(proposal, work.found.verdict if work.found else None, None, None)
            content["seconds"] = round(time.perf_counter() - began, 3)
            write_answer(json, content)
            console.print(f"NO TEST   nothing on the menu sets apart {names_of(proposal)} on this rig", markup=False)
            return
        report("drawing", 0.98)
        picture = folder_for("next", given.paths, json) / "predictions.png"
        draw(picture, proposal, work, asked.seed)
        title = f"Tests that set apart {names_of(proposal)}"
        choices = [one.trial.choice for one in proposal.tests]
        new_campaign(path.stem)
        write_campaign(path, campaign_content(path.stem, title, work.fixed, choices, REPETITIONS), comment_of(proposal, given))
    content = answer(proposal, work.found.verdict if work.found else None, path, picture)
    content["seconds"] = round(time.perf_counter() - began, 3)
    write_answer(json, content)
    tell(console, proposal, work, path, picture)
