"""`hjcamp add` for tests of the joint."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from hjcamp.analyses.data import Data, joined
from hjcamp.commands.shared.session import progress_of, write_answer
from hjcamp.errors import counted

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.plants.pump_joint.diagnosis.add import Addition

BAR = 30


def add(there: list[Path], effects_and_paths: list[str], name: str, model: str, json: Path | None) -> None:
    """Fit effects, save the model, and show the error on tests that were not used."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.commands.shared.effects_and_paths import split
    from hjcamp.configuration.saved_model import check_new_name
    from hjcamp.effects import load_effects
    from hjcamp.plants.pump_joint.analyses.adding import add as add_effects
    from hjcamp.plants.pump_joint.analyses.evidence import evidence_in

    names, paths = split(effects_and_paths, load_effects())
    check_new_name(name)
    data = Data(paths)
    console = make_console()
    with progress_of(console) as report:
        added = add_effects(data, names, name, model, report)
        write_answer(json, added.content)
    found, path = added.found, added.path
    _print(console, found, path, model, name, evidence_in(data).repeated)
    console.print(f"next    hjcamp compare {joined(paths)} --model {model} --model {name}", markup=False)
    console.print(f"        hjcamp run campaign=controllers controller.model={name}", markup=False)


def _print(console: Console, found: Addition, path: Path, model: str, name: str, repeated: bool) -> None:
    from hjcamp.commands.shared.wrapped import print_wrapped
    from hjcamp.plants.pump_joint.answers.diagnose_words import parameters_told
    from hjcamp.plants.pump_joint.answers.error_words import over, print_errors

    parts = [f"{effect} ({parameters_told(rows)})" for effect, rows in found.effects.items()]
    console.print(f"{path}  = {model} + calibration + {' + '.join(parts)}", markup=False)
    if not repeated:
        console.print("  exploratory: no test was repeated, so repeatability is unknown", style="yellow")
    count = len(found.fold.held_out)
    apart = not set(found.fold.held_out) & set(found.fold.train)
    console.print(
        f"error on {counted(count, 'test')} {'that were not used for the fit' if apart else '(all: there are no others)'}"
    )
    told = [(model, found.start), ("calibrated", found.before), (name, found.after)]
    print_errors(console, told, found.scale)
    bars = [(text, one.score) for text, one in told if math.isfinite(one.score)]
    bars += [("noise floor", 1.0)] if found.scale.repeated else []
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
        return f"{names}: unknown whether it helps; a model diverges on the held-out tests."
    what = "normalised error" if found.scale.repeated else "error over the spread of the measurement"
    falls = f"{what} {'falls' if mean > 0 else 'rises'} by {abs(mean):.2g}"
    if count < 2:
        return f"{names}: {falls} on one test, whose scatter is unknown."
    judged = f"{falls} ± {error:.2g} ({counted(count, 'test')}, mean and its standard error)"
    if found.helps:
        return f"{names} helps: {judged}."
    return (
        f"{names} DOES NOT HELP on these tests: {judged}. "
        "The model was saved all the same; leave the effect out unless other tests show it."
    )
