"""Add effects to a model: fit them, save the model, and show the error fall on tests that were not used."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.analyses.adding import add as add_effects
from hjcamp.analyses.data import Data, joined
from hjcamp.commands._session import AnswerFile
from hjcamp.errors import UsageError, counted, nearest, unknown
from hjcamp.known_plants import DEFAULT

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.plants.pump_joint.diagnosis.add import Addition

BAR = 30


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("add")(add)


def add(
    effects_and_paths: Annotated[
        list[str],
        typer.Argument(metavar="EFFECT... PATH...", help="Effects, then logs; or the folder of a table's diagnosis."),
    ],
    name: Annotated[str, typer.Option("--as", help="Name of the new model: conf/model/NAME.yaml.")],
    model: Annotated[str, typer.Option(help="The model to add to.")] = "published",
    json: AnswerFile = None,
) -> None:
    """Add effects to a model: fit them, save the model, and show the error fall on tests that were not used."""
    from hjcamp.campaign.console import make_console
    from hjcamp.commands._any_plant import add_any
    from hjcamp.commands._session import check_answer_file, progress_of, write_answer
    from hjcamp.commands._tables import add_table
    from hjcamp.configuration.saved_model import check_new_name
    from hjcamp.effects import load_effects
    from hjcamp.plants.pump_joint.diagnosis.add import Addition
    from hjcamp.storage import named_file
    from hjcamp.tabulated.answer import is_answer

    check_answer_file(json)
    named_file(name, "model", Path("conf") / "model")
    if len(effects_and_paths) == 1 and is_answer(Path(effects_and_paths[0])):
        add_table(Path(effects_and_paths[0]), name, json)
        return
    there = [Path(word) for word in effects_and_paths if Path(word).exists()]
    if there and not (data := Data(there)).of_pump_joint:
        add_any(data, effects_and_paths, name, model, json)
        return
    names, paths = split(effects_and_paths, load_effects())
    check_new_name(name)
    data = Data(paths)
    console = make_console()
    with progress_of(console) as report:
        added = add_effects(data, names, name, model, report)
        write_answer(json, added.content)
    found, path = added.found, added.path
    assert isinstance(found, Addition)
    _print(console, found, path, model, name, data.evidence.repeated)
    console.print(f"next    hjcamp compare {joined(paths)} --model {model} --model {name}", markup=False)
    console.print(f"        hjcamp run campaign=controllers controller.model={name}", markup=False)


def split(words: list[str], library: Any, plant: Any = DEFAULT) -> tuple[list[str], list[Path]]:
    """Return effects and paths; the first word that is no effect, nor nearly the name of one, begins the paths.

    An effect that does not fit the ``plant`` is refused with its reason.
    """
    from hjcamp.effects import library_of

    names: list[str] = []
    for index, word in enumerate(words):
        if word in library:
            names.append(word)
        elif names and (Path(word).exists() or "/" in word or nearest(word, library) is None):
            return names, [Path(one) for one in words[index:]]
        else:
            library_of(plant).find(word)
            raise unknown("effect", word, library)
    raise UsageError("no logs were named: after the effects give a run folder, a folder of logs, or log files")


def _print(console: Console, found: Addition, path: Path, model: str, name: str, repeated: bool) -> None:
    from hjcamp.commands._diagnose_words import parameters_told
    from hjcamp.commands._error_words import over, print_errors, print_wrapped

    parts = [f"{effect} ({parameters_told(rows)})" for effect, rows in found.effects.items()]
    console.print(f"{path}  = {model} + calibration + {' + '.join(parts)}", markup=False)
    if not repeated:
        console.print("  exploratory: no test was repeated, so there is no floor to compare with", style="yellow")
    count = len(found.fold.held_out)
    apart = not set(found.fold.held_out) & set(found.fold.train)
    console.print(
        f"error on {counted(count, 'test')} {'that were not used for the fit' if apart else '(all: there are no others)'}"
    )
    told = [(model, found.start), ("calibrated", found.before), (name, found.after)]
    print_errors(console, told, found.scale)
    bars = [(text, one.score) for text, one in told if math.isfinite(one.score)]
    bars += [("floor", 1.0)] if found.scale.repeated else []
    longest, width = max([value for _, value in bars], default=1.0), max([len(text) for text, _ in bars], default=0)
    console.print(f"  {over(found.scale)}", style="dim", markup=False)
    for text, value in bars:
        console.print(f"  {text:<{width}}  {'█' * max(1, round(BAR * value / longest))} {value:.2f}", markup=False)
    print_wrapped(console, [helps_told(found)], 2, "")


def helps_told(found: Addition) -> str:
    """Return whether the effects help, and by what that is judged."""
    names, (mean, error) = " and ".join(found.effects), found.fall
    count = len(found.before.each)
    if not math.isfinite(mean):
        return f"{names}: nothing tells whether it helps; a model runs away on the tests that were not used."
    unit = "floors" if found.scale.repeated else "of the measurement's spread"
    falls = f"{'falls' if mean > 0 else 'rises'} by {abs(mean):.2g} {unit}"
    if count < 2:
        return f"{names}: the error {falls} on one test, whose scatter nothing tells."
    judged = f"the error of the {counted(count, 'test')}, each on its own, {falls} on average"
    if found.helps:
        return f"{names} helps: {judged}, by more than the standard error of that ({error:.2g})."
    return (
        f"{names} DOES NOT HELP on these tests: {judged} (standard error {error:.2g}). "
        "The model was saved all the same; leave the effect out unless other tests show it."
    )
