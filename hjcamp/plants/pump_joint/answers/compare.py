"""`hjcamp compare` for tests of the joint."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hjcamp.analyses.data import Data, joined
from hjcamp.commands.shared.session import folder_for, progress_of, tell_of_views, write_answer
from hjcamp.errors import counted

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.plants.pump_joint.diagnosis.compare import Compared, Comparison

BAR = 30


def compare(data: Data, names: list[str], json: Path | None, into: Path | None, mcap: Path | None = None) -> None:
    """Replay measured tests with models; print, write the answer, the pictures and the page."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.plants.pump_joint.analyses.comparing import compare_joint
    from hjcamp.plants.pump_joint.analyses.evidence import evidence_in

    console = make_console()
    with progress_of(console) as report:
        from hjcamp.plants.pump_joint.answers.compare_explorer import tests_of
        from hjcamp.plants.pump_joint.answers.compare_page import write_pictures
        from hjcamp.plants.pump_joint.diagnosis.compare import answer
        from hjcamp.records.views.model_log import write_modelled

        found = compare_joint(data, names, report)
        write_answer(json, answer(found.models, len(evidence_in(data).tests)))
        report("drawing", 0.8)
        files = write_pictures(found, into or folder_for("compare", data.paths, json), next_commands(found, data.paths))
        views = [] if mcap is None else write_modelled(mcap, tests_of(found))
    _print(console, found, files)
    tell_of_views(console, views)
    for number, command in enumerate(next_commands(found, data.paths)):
        console.print(f"{'        ' if number else 'next    '} {command}", markup=False)


def next_commands(found: Comparison, paths: list[Path]) -> list[str]:
    """Return the commands that go on: use a model that is good, else say what it misses."""
    from hjcamp.report.wording.repeatability import NEAR

    last = found.models[-1]
    name, good = last.replay.name, last.score <= NEAR and last.replay.evidence.repeated
    own = "" if name == "published" else f" --model {name}"
    commands = [] if good and own else [f"hjcamp diagnose {joined(paths)}{own}"]
    if own and (good or len(found.models) > 1):
        commands.append(f"hjcamp run campaign=controllers controller.model={name}")
    return commands


def _print(console: Console, found: Comparison, files: list[Path]) -> None:
    from hjcamp.plants.pump_joint.answers.compare_page import NOT_CALIBRATED, calibrated_in_words, places_in_words

    models, last, calibrated = found.models, found.models[-1], found.calibrated
    evidence = last.replay.evidence
    count = f"{counted(len(evidence.tests), 'test')}, {counted(len(evidence.conditions), 'condition')}"
    console.print(f"{count}, replay driven by the measured pump")
    if not evidence.repeated:
        console.print("  exploratory: no test was repeated, so repeatability is unknown", style="yellow")
    for one in models:
        console.print(one.replay.name, style="bold", markup=False, highlight=False)
        _table(console, one)
    if len(models) > 1 or calibrated:
        _bars(console, [*models, calibrated] if calibrated else models)
    if calibrated:
        console.print(f"where    {last.replay.name} as it stands ({NOT_CALIBRATED})", markup=False)
        _say(console, places_in_words(last))
        console.print("         after calibrating its base parameters on these tests", markup=False)
        _say(console, calibrated_in_words(found))
    else:
        console.print(f"where    {last.replay.name}", markup=False)
        _say(console, places_in_words(last))
    if last.horizon.born:
        early, late = (1e3 * one for one in last.horizon.born)
        console.print(f"         error against horizon: grows within the first {early:.0f} to {late:.0f} ms of prediction")
    console.print(f"figures  {'  '.join(str(file) for file in files[:-1])}", markup=False)
    console.print(f"page     {files[-1]}", markup=False)


def _say(console: Console, lines: list[str]) -> None:
    from hjcamp.commands.shared.wrapped import print_wrapped

    print_wrapped(console, lines, 11)


def _table(console: Console, one: Compared) -> None:
    from rich.table import Table

    from hjcamp.plants.pump_joint.answers.compare_page import HEADINGS, error_cells

    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("               ", no_wrap=True)
    for heading in HEADINGS[2:]:
        table.add_column(heading, justify="right")
    for name in one.errors:
        first, *rest = error_cells(one, name)
        table.add_row(f"  {first}", *rest)
    console.print(table)


def _bars(console: Console, models: list[Compared]) -> None:
    from hjcamp.plants.pump_joint.answers.error_words import OVER_NOISE_FLOOR, OVER_SPREAD

    longest = max(one.score for one in models)
    width = max(len(one.replay.name) for one in models)
    repeated = models[0].replay.evidence.repeated
    console.print(OVER_NOISE_FLOOR if repeated else OVER_SPREAD)
    for one in models:
        bar = "█" * max(1, round(BAR * one.score / longest))
        console.print(f"  {one.replay.name:<{width}}  {bar} {one.score:.2f}", markup=False)
    if repeated:
        console.print(f"  {'floor':<{width}}  {'█' * max(1, round(BAR / longest))} 1.00", markup=False)
