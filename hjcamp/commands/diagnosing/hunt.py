"""Run a campaign, diagnose it, make the tests that separate what remains, until one verdict stands or the budget is spent."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.commands.shared.complete import complete_override
from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.commands.hunting.record import Hunt
    from hjcamp.commands.hunting.turns import Options
    from hjcamp.records.plan import Plan

MOST_TESTS = 12


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("hunt")(hunt)


def hunt(
    overrides: Annotated[
        list[str] | None, typer.Argument(autocompletion=complete_override, help="As of hjcamp run: campaign=NAME ...")
    ] = None,
    budget: Annotated[str, typer.Option(help="Time of the rig at work: 90s, 30min, 2h.")] = "",
    model: Annotated[str, typer.Option(help="The model to start from.")] = "published",
    level: Annotated[float, typer.Option(help="The p-value at which a name, or something outside the library, stands.")] = 0.05,
    within: Annotated[
        float, typer.Option(help="The error over the noise floor, at most, that a name leaves where it stands.")
    ] = 1.3,
    tests: Annotated[int, typer.Option(help="How many tests to add in a round.")] = 3,
    effort: Annotated[str, typer.Option(help="Effort of the diagnosis: quick, standard or thorough.")] = "standard",
    seed: Annotated[int, typer.Option(help="Seed of everything that is simulated for a diagnosis.")] = 1,
    only: Annotated[str | None, typer.Option(help="Effects to consider, with commas; all of them by default.")] = None,
    without: Annotated[str | None, typer.Option(help="Effects to leave out, with commas.")] = None,
    workers: Annotated[int | None, typer.Option(help="Workers of the diagnosis; the number of processors by default.")] = None,
    yes_between: Annotated[
        bool,
        typer.Option("--yes-between", help="On a rig: no question between the rounds, whose tests stay within its limits."),
    ] = False,
    live: Annotated[bool, typer.Option("--live", help="Open a page that follows the runs, on this computer alone.")] = False,
    json: AnswerFile = None,
) -> None:
    """Run a campaign, diagnose it, make the tests that separate what remains, until one verdict stands or the budget is spent.

    The same call goes on with a hunt that was interrupted; run_dir=DIR names its folder.
    """
    from hjcamp.analyses.diagnosing import Asked
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.campaign.plan.planning import composed_plan
    from hjcamp.commands.hunting.budget import seconds_of
    from hjcamp.commands.hunting.turns import Options
    from hjcamp.configuration.composer import Composer

    check_answer_file(json)
    if not budget:
        raise UsageError("--budget is missing: the time that the rig may be at work, such as --budget 30min")
    _check(tests, level, within)
    seconds = seconds_of(budget)
    asked = Asked(model, effort, seed, only, without, workers)
    asked.check()
    plan, config = composed_plan(overrides or [], Composer())
    options = Options(asked, level, within, tests, question(plan, yes_between))
    console = make_console()
    folder, found = hunted(plan, (config, list(overrides or [])), options, seconds, live, console)
    write_answer(json, {**found.as_json(), "folder": str(folder), "page": str(folder / "index.html")})
    tell(console, found, folder)


def _check(tests: int, level: float, within: float) -> None:
    if not 1 <= tests <= MOST_TESTS:
        raise UsageError(f"--tests {tests}: give a number from 1 to {MOST_TESTS}")
    if not 0.0 < level < 1.0:
        raise UsageError(f"--level {level:g}: give a number between 0 and 1")
    if not within >= 1.0:
        raise UsageError(f"--within {within:g}: give a number of 1 or more")


def hunted(
    plan: Plan, call: tuple[dict[str, Any], list[str]], options: Options, seconds: float, live: bool, console: Console
) -> tuple[Path, Hunt]:
    """Begin a hunt, or go on with it, to its end; return its folder and how it stands."""
    from hjcamp.campaign.files.lock import run_lock
    from hjcamp.commands.hunting.record import ENDED, Hunt, folder_of, save
    from hjcamp.commands.hunting.turns import Hunter, first_round
    from hjcamp.commands.shared.live import live as live_of
    from hjcamp.live.process import LiveAsk

    given = Path(str(call[0]["run_dir"])) if call[0].get("run_dir") else None
    settings = options.told()
    folder, found = folder_of(plan.campaign, plan.sha256, settings, given)
    if found is None:
        first = first_round(folder, plan, seconds)
        found = Hunt(plan.campaign, plant_name(plan), plan.sha256, settings, seconds, [first])
        save(folder, found)
    else:
        console.print(f"goes on in {folder}", style="dim", markup=False)
    if found.state != ENDED or (found.reason == "budget" and seconds > found.budget_s):
        found.budget_s = seconds
        with run_lock(folder), live_of(LiveAsk(0, True) if live else None):
            Hunter(folder, found, plan, call, options, console).go()
    return folder, found


def plant_name(plan: Plan) -> str:
    """Return the plant of a plan."""
    from hjcamp.known_plants import plant_of

    return plant_of(plan.conditions[0].config).name


def question(plan: Plan, yes_between: bool) -> Callable[[str], bool] | None:
    """Return what asks before a further round moves a real rig; None where nothing real moves, or nobody wants to be asked."""
    config = plan.conditions[0].config
    if not moves(config) or yes_between:
        return None
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise UsageError(
            f"rig '{config['rig']['name']}' moves in every round, and nobody can be asked here: "
            "--yes-between lets it make the tests that stay within its limits"
        )

    def ask(text: str) -> bool:
        print(f"The rig '{config['rig']['name']}' will move: {text}.")
        return typer.confirm("Is everybody clear of it?")

    return ask


def moves(config: Mapping[str, Any]) -> bool:
    """Return whether a test moves something real."""
    name = str(config["backend"]["name"])
    if name == "rig":
        from hjcamp.backends.rig.any_plant.session import rig_in

        return rig_in(config).real
    return name != "simulation" and str(config["rig"]["name"]) != "virtual"


def tell(console: Console, found: Hunt, folder: Path) -> None:
    """Say how the hunt ended, and what goes on from there."""
    from hjcamp.analyses.data import joined
    from hjcamp.commands.hunting.said import REASONS, not_ruled_out, said_verdict

    last = found.last or {}
    console.print(said_verdict(last).upper() if last else "NO VERDICT", style="bold", markup=False, highlight=False)
    more = "" if found.reason == "verdict" else f" {found.message}"
    console.print(f"        {REASONS.get(found.reason, '')}{more}", markup=False)
    console.print(f"not ruled out   {not_ruled_out(last)}", markup=False)
    since = found.rounds[-1].since
    runs = joined([folder / one.run for one in found.rounds[since:] if one.made])
    console.print(f"page    {folder / 'index.html'}", markup=False)
    own = "" if found.asked["model"] == "published" else f" --model {found.asked['model']}"
    effects = last.get("effects", [])
    verb = "add" if last.get("verdict") == "effect" else "diagnose"
    named = f"{' '.join(effects)} {runs}{own} --as with_{'_and_'.join(effects)}" if verb == "add" else f"{runs}{own}"
    console.print(f"next    hjcamp {verb} {named}", markup=False)
