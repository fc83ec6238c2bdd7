"""Propose the tests that best separate the explanations that remain, as a campaign that runs as it is."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from hjcamp.errors import UsageError

MOST_TESTS = 12
SETTLED = {
    "effect": "these tests already say what is missing",
    "nothing_missing": "nothing is missing in these tests, so there is nothing to tell apart",
    "outside_library": "no effect of the library explains these tests; write the effect before further tests",
}


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("next")(next_)


def next_(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[PATH...] [KEY=VALUE...]", help="Logs (none: before the first test), and what is fixed."
        ),
    ] = None,
    rivals: Annotated[list[str] | None, typer.Option(help="Effects to set apart: A,B. 'nothing' can be one.")] = None,
    tests: Annotated[int, typer.Option(help="How many tests to propose.")] = 3,
    name: Annotated[str | None, typer.Option("--as", help="Name of the campaign: campaigns/NAME.yaml.")] = None,
    json: Annotated[
        Path | None, typer.Option(help="Write the answer for programs to this file; - is standard output.")
    ] = None,
    effort: Annotated[str, typer.Option(help="Effort of the diagnosis: quick, standard or thorough.")] = "standard",
    seed: Annotated[int, typer.Option(help="Seed of everything that is simulated.")] = 1,
    model: Annotated[
        str, typer.Option(help="The model to start from, for logs of another plant than pump_joint.")
    ] = "published",
) -> None:
    """Propose the tests that best separate the explanations that remain, as a campaign that runs as it is."""
    from hjcamp.analyses.data import Data
    from hjcamp.analyses.diagnosing import Asked, check_seed
    from hjcamp.campaign.console import make_console
    from hjcamp.commands._any_plant import next_any
    from hjcamp.commands._session import check_answer_file, folder_for, progress_of, write_answer
    from hjcamp.plants.pump_joint.diagnosis.design.campaign_file import campaign_content, new_campaign, write_campaign

    began = time.perf_counter()
    check_answer_file(json)
    if not 1 <= tests <= MOST_TESTS:
        raise UsageError(f"--tests {tests}: give a number from 1 to {MOST_TESTS}")
    check_seed(seed)
    path = new_campaign(name)
    logs = [Path(word) for word in words or [] if "=" not in word and Path(word).exists()]
    if logs and not (data := Data(logs)).of_pump_joint:
        others = [word for word in words or [] if Path(word) not in logs]
        next_any(data, others, rivals or [], tests, Asked(model, effort, seed), name, json)
        return
    if model != "published":
        raise UsageError(f"--model {model}: tests of pump_joint are proposed from its published model")
    console = make_console()
    with progress_of(console) as report:
        from hjcamp.commands._next_answer import answer, comment_of, draw, names_of, tell
        from hjcamp.commands._next_work import Work, read_words, work_of
        from hjcamp.effects import load_effects
        from hjcamp.plants.pump_joint.diagnosis.design.propose import REPETITIONS

        library = load_effects()
        given = read_words(words or [], rivals or [], library)
        work = work_of(given, library, effort, seed, report)
        if not isinstance(work, Work):
            content = answer(None, work.verdict, None, None)
            content["seconds"] = round(time.perf_counter() - began, 3)
            write_answer(json, content)
            named = f": {', '.join(work.effects)}" if work.effects else ""
            console.print(f"NOTHING TO SEPARATE   {SETTLED[work.verdict]}{named}", markup=False)
            return
        proposal = work.propose(tests, seed, report)
        if not proposal.tests:
            content = answer(proposal, work.found.verdict if work.found else None, None, None)
            content["seconds"] = round(time.perf_counter() - began, 3)
            write_answer(json, content)
            console.print(f"NO TEST   nothing on the menu sets apart {names_of(proposal)} on this rig", markup=False)
            return
        report("drawing", 0.98)
        picture = folder_for("next", given.paths, json) / "predictions.png"
        draw(picture, proposal, work, seed)
        title = f"Tests that set apart {names_of(proposal)}"
        choices = [one.trial.choice for one in proposal.tests]
        new_campaign(path.stem)
        write_campaign(
            path, campaign_content(path.stem, title, work.fixed, choices, REPETITIONS), comment_of(proposal, given)
        )
    content = answer(proposal, work.found.verdict if work.found else None, path, picture)
    content["seconds"] = round(time.perf_counter() - began, 3)
    write_answer(json, content)
    tell(console, proposal, work, path, picture)
