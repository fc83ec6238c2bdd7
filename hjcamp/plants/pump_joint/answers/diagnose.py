"""`hjcamp diagnose` for tests of the joint."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, free_model_name, joined
from hjcamp.campaign.execution.console import can_move, make_console
from hjcamp.commands import command_files
from hjcamp.commands.shared.session import folder_for, keep_answer, progress_of, write_answer
from hjcamp.errors import counted

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.analyses.diagnosing import Asked
    from hjcamp.plants.pump_joint.answers.diagnose_words import Told
    from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence

STYLES = {"nothing_missing": "green", "effect": "bold"}
SHOWN = 6


def diagnose(data: Data, asked: Asked, json: Path | None) -> None:
    """Say what the model misses; print, write the answer, the pictures and the page."""
    from hjcamp.plants.pump_joint.analyses.diagnosing import diagnose_joint

    console = make_console()
    with progress_of(console) as report:
        from hjcamp.plants.pump_joint.answers.diagnose_page import write_pictures
        from hjcamp.plants.pump_joint.answers.diagnose_words import Told
        from hjcamp.plants.pump_joint.answers.evidence import gathered

        compiling = partial(tell_of_compiling, console, report)
        done = diagnose_joint(data, asked, report, compiling, partial(_say_what_is_lacking, console), gathered)
        told = Told(**vars(done))
        content = told.content
        write_answer(json, content)
        report("drawing", 0.99)
        folder = folder_for("diagnose", data.paths, json)
        following = next_command(content, data.paths, asked.model, folder)
        files = write_pictures(told, folder, [following])
        keep_answer(folder, content)
    _print(console, told)
    console.print(f"figures {len(files) - 1} in {files[-1].parent}", markup=False)
    console.print(f"page    {files[-1]}", markup=False)
    console.print(f"next    {following}", markup=False)


def _say_what_is_lacking(console: Console, evidence: Evidence) -> None:
    """Say before anything is computed what these tests lack: for a verdict, and for a floor."""
    from hjcamp.commands.shared.wrapped import print_wrapped
    from hjcamp.plants.pump_joint.diagnosis.selection.verdict import lacks
    from hjcamp.report.wording.repeatability import NO_NOISE_FLOOR

    lacking = [f"{one[:1].upper()}{one[1:]}." for one in lacks(evidence)]
    if lacking:
        lacking.insert(0, "These tests cannot tell which effect is missing, whatever is computed:")
    lines = [*lacking, *([] if evidence.repeated else [NO_NOISE_FLOOR])]
    if lines:
        print_wrapped(console, lines, 8, "lacking")


def tell_of_compiling(console: Console, report: Callable[[str, float], None], done: int, count: int) -> None:
    """Say how many kernels are to be compiled: in the progress line of a terminal, else in a line of its own at the start."""
    if can_move(console):
        report(f"compiling, once for these effects: {count - done} of {count} kernels left", 0.0)
    elif not done:
        console.print(f"  compiling {counted(count, 'kernel')}, once for these effects", markup=False)


def next_command(content: dict[str, Any], paths: list[Path], model: str = "published", folder: Path = Path("diagnose")) -> str:
    """Return the command that goes on from an answer; it can be pasted as it is."""
    verdict = content["verdict"]
    own = "" if model == "published" else f" --model {model}"
    if verdict == "effect":
        name = free_model_name(f"with_{'_and_'.join(content['effects'])}")
        return f"hjcamp add {' '.join(content['effects'])} {joined(paths)}{own} --as {name}"
    if verdict == "outside_library":
        driver = content["drivers"][0] if content["drivers"] else "unknown"
        begun = f" --from {joined([folder])}" if content.get("unknowns") else ""
        return f"hjcamp effects new {driver}_effect{begun}   # write its law, then: hjcamp diagnose {joined(paths)}{own}"
    if verdict == "nothing_missing" or "next" not in command_files():
        return f"hjcamp compare {joined(paths)}{own}"
    return f"hjcamp next {joined(paths)}"


def _print(console: Console, told: Told) -> None:
    from hjcamp.commands.shared.wrapped import print_wrapped
    from hjcamp.plants.pump_joint.answers.diagnose_words import APART, CALIBRATED, cut
    from hjcamp.plants.pump_joint.answers.error_words import print_errors

    found, content = told.found, told.content
    rows = told.calibration()
    still = len(content["calibration"]) - len(rows)
    console.print(f"calibrated first{'' if rows else '   nothing moved'}", markup=False)
    if rows:
        _table(console, CALIBRATED, rows, right=(1, 2, 3, 4))
        if still:
            console.print(f"  {still} more moved by less than 1 %", style="dim", markup=False)
    weighed = len({name for step in found.steps for name in step.fits})
    replicates = (
        f"{counted(len(found.null.gains), 'null replicate')} simulated with nothing missing"
        if not found.lacking
        else "no null replicates: no question for them"
    )
    count = f"screened {counted(len(told.library), 'effect')}, weighed {weighed}, {replicates}"
    console.print(f"{count}   {content['seconds']:.0f} s", markup=False)
    if found.exploratory:
        console.print("exploratory: no test was repeated, so the scatter of the rig is assumed", style="yellow")
    name, colon, rest = told.title.partition(":")
    style = STYLES.get(content["verdict"], "yellow")
    console.print(f"{name.upper()}{'  ' if colon else ''}{rest}", style=style, markup=False, highlight=False)
    print_wrapped(console, told.answer(), 8)
    _candidates(console, told)
    console.print("error   on tests that were not used for the fit")
    print_errors(console, told.errors(), told.judging.scale)
    print_wrapped(console, told.further_off(), 8)
    print_wrapped(console, told.worst(), 8, "worst")
    print_wrapped(console, told.where(), 8, "where")
    hidden, pairs = told.confounded(APART)
    if hidden:
        console.print(f"not visible in these tests   {cut(hidden, SHOWN)}", markup=False)
    if pairs:
        console.print(f"never apart in these tests   {cut([names for names, _ in pairs], SHOWN)}", markup=False)


def _candidates(console: Console, told: Told) -> None:
    from hjcamp.commands.shared.wrapped import print_wrapped
    from hjcamp.plants.pump_joint.answers.diagnose_words import CANDIDATES, LEFT

    if rows := told.candidates(SHOWN):
        _table(console, CANDIDATES, rows, right=(1, 2, 4, 5))
        print_wrapped(console, [LEFT], 8)


def _table(console: Console, headings: tuple[str, ...], rows: list[list[str]], right: tuple[int, ...]) -> None:
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False, header_style="dim")
    for index, heading in enumerate(headings):
        justify = "right" if index in right else "left"
        table.add_column(f"  {heading}" if index == 0 else heading, justify=justify, no_wrap=index < 3)  # type: ignore[arg-type]
    for row in rows:
        table.add_row(*(Text(f"  {cell}" if index == 0 else cell) for index, cell in enumerate(row)))
    console.print(table)
