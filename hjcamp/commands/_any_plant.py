"""compare, diagnose, add and calibrate for tests of any plant but the pump joint."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from hjcamp.prediction.measured import Measured


def is_of_another_plant(paths: Sequence[Path]) -> bool:
    """Return whether the first log at ``paths`` is of another plant than the pump joint."""
    from hjcamp.plants import DEFAULT
    from hjcamp.records.find import find_logs
    from hjcamp.records.of_plant import PLANT_KEY
    from hjcamp.records.read import read_log

    return (read_log(find_logs(list(paths))[0]).metadata.get(PLANT_KEY) or DEFAULT) != DEFAULT


def measured_at(paths: Sequence[Path]) -> Measured:
    """Return the tests at ``paths``; refuse what cannot be, and say on stderr what is doubtful."""
    from hjcamp.prediction.measured import measured_tests
    from hjcamp.records.find import read_logs
    from hjcamp.records.plausible import refuse_implausible

    logs = read_logs(list(paths))
    for log in logs:
        for one in refuse_implausible(log, str(log.path)):
            print(f"{log.path}: {one.line}", file=sys.stderr)
    return measured_tests(logs)


def diagnose_any(
    paths: list[Path],
    model: str,
    json: Path | None,
    seed: int,
    only: str | None,
    without: str | None,
    ask: str | None = None,
) -> None:
    """Say which effect the model of a plant misses; the answer is that of ``hjcamp diagnose``."""
    from hjcamp.campaign.console import make_console
    from hjcamp.commands._session import folder_for, joined, keep_answer, progress_of, write_answer

    began = time.perf_counter()
    console = make_console()
    with progress_of(console) as report:
        from hjcamp.commands._plant_pages import write_diagnosis
        from hjcamp.commands._plant_words import Words, print_diagnosis
        from hjcamp.commands.diagnose import check_asked, considered, own_and_asked, with_asked
        from hjcamp.effects import load_effects
        from hjcamp.prediction.analysis import SHORTEST, calibrated
        from hjcamp.prediction.answer import answer, asked_candidates
        from hjcamp.prediction.floor import not_above
        from hjcamp.prediction.model_file import load_model
        from hjcamp.prediction.verdict import agreed

        measured = measured_at(paths)
        library = load_effects(plant=measured.plant)
        start = load_model(model, measured.plant, library)
        chosen = considered(library, only, without, start.effects)
        check_asked(ask, chosen)
        report("compiling, once for this plant and its effects", 0.02)
        analysis = calibrated(measured, chosen, start, report, seed)
        half = max(analysis.windows.layout.width // 2, SHORTEST)
        verdict = agreed(analysis, lambda: calibrated(measured, chosen, start, report, seed, width=half))
        analysis = replace(analysis, floor=not_above(analysis.floor, verdict.model.fitted.features))
        content = answer(analysis, verdict, time.perf_counter() - began)
        wanted = own_and_asked(chosen, ask)
        content["candidates"] = with_asked(content["candidates"], asked_candidates(analysis, verdict, wanted), wanted)
        write_answer(json, content)
        report("drawing", 0.99)
        words = Words(analysis, verdict, content)
        folder = folder_for("diagnose", paths, json)
        files = write_diagnosis(words, folder)
        keep_answer(folder, content)
    print_diagnosis(console, words)
    console.print(f"page    {files[-1]}", markup=False)
    for number, line in enumerate(words.next_commands(joined(paths), model, joined([folder]))):
        console.print(f"{'        ' if number else 'next    '}{line}", markup=False)


def compare_any(
    paths: list[Path], names: list[str], json: Path | None, into: Path | None, mcap: Path | None = None
) -> None:
    """Predict measured tests of a plant with one or more models."""
    from hjcamp.campaign.console import make_console
    from hjcamp.commands._session import folder_for, joined, progress_of, write_answer
    from hjcamp.commands.compare import tell_of_views

    console = make_console()
    with progress_of(console) as report:
        from hjcamp.commands._plant_pages import modelled_tests, write_comparison
        from hjcamp.commands._plant_words import print_comparison
        from hjcamp.effects import load_effects
        from hjcamp.prediction.comparison import answer, compared
        from hjcamp.prediction.model_file import load_model
        from hjcamp.records.model_log import write_modelled

        measured = measured_at(paths)
        library = load_effects(plant=measured.plant)
        models = {name: load_model(name, measured.plant, library) for name in names}
        report("compiling, once for these models", 0.05)
        found = compared(measured, library, models, report)
        write_answer(json, answer(found))
        report("drawing", 0.9)
        files = write_comparison(found, into or folder_for("compare", paths, json))
        views = [] if mcap is None else write_modelled(mcap, modelled_tests(found))
    print_comparison(console, found)
    tell_of_views(console, views)
    console.print(f"page    {files[-1]}", markup=False)
    own = "" if names[-1] == "published" else f" --model {names[-1]}"
    console.print(f"next    hjcamp diagnose {joined(paths)}{own}", markup=False)


def add_any(names_and_paths: list[str], name: str, model: str, json: Path | None) -> None:
    """Fit effects of a plant, save the model, and show the error on chapters that were not used."""
    from hjcamp.campaign.console import make_console
    from hjcamp.commands._session import joined, progress_of, write_answer

    console = make_console()
    with progress_of(console) as report:
        from hjcamp.commands._plant_words import print_addition
        from hjcamp.commands.add import split
        from hjcamp.effects import load_effects
        from hjcamp.prediction.addition import added, answer, provenance
        from hjcamp.prediction.model_file import check_new, load_model, write_model

        measured = measured_at(log_paths(names_and_paths))
        library = load_effects(plant=measured.plant)
        names, paths = split(names_and_paths, library)
        path = check_new(name)
        start = load_model(model, measured.plant, library)
        for one in names:
            if one in start.effects:
                raise UsageError(f"effect {one}: model '{model}' has it already")
        if len(set(names)) < len(names):
            raise UsageError(f"hjcamp add {' '.join(names)}: each effect once")
        report("compiling, once for these effects", 0.05)
        found = added(measured, library, start, names, report)
        content = answer(found, name, str(path))
        command = f"hjcamp add {' '.join(names)} {joined(paths)} --model {model} --as {name}"
        comment = [
            f"{model} with {', '.join(names)}, fitted to {len(measured.tests)} tests of plant {measured.plant.name}"
        ]
        write_model(path, measured.plant, found.model.fitted.candidate, comment, provenance(found, command))
        write_answer(json, content)
    print_addition(console, found, names, path)
    console.print(f"next    hjcamp compare {joined(paths)} --model {model} --model {name}", markup=False)


def calibrate_any(paths: list[Path], name: str) -> None:
    """Fit the base parameters of a plant to tests and save them as a model."""
    from hjcamp.campaign.console import make_console
    from hjcamp.commands._session import joined, progress_of

    console = make_console()
    with progress_of(console) as report:
        from hjcamp.commands._plant_words import print_calibration
        from hjcamp.prediction.analysis import calibrated
        from hjcamp.prediction.answer import calibration
        from hjcamp.prediction.model_file import check_new, hashes_of, write_model

        path = check_new(name)
        measured = measured_at(paths)
        report("compiling, once for this plant", 0.05)
        analysis = calibrated(measured, {}, report=report, unknowns=False)
        command = f"hjcamp calibrate {joined(paths)} --as {name}"
        comment = [f"base parameters of plant {measured.plant.name}, fitted to {len(measured.tests)} tests"]
        write_model(
            path, measured.plant, analysis.base.fitted.candidate, comment,
            {"command": command, "logs_sha256": hashes_of(measured)},
        )  # fmt: skip
        rows = calibration(analysis)
    print_calibration(console, analysis, rows)
    console.print(f"model   {path}", markup=False)
    console.print(f"next    hjcamp compare {joined(paths)} --model published --model {name}", markup=False)


def log_paths(words: Sequence[str]) -> list[Path]:
    """Return those of effects and paths that are there as files or folders."""
    found = [Path(word) for word in words if Path(word).exists()]
    if not found:
        raise UsageError("no logs were named: after the effects give a run folder, a folder of logs, or log files")
    return found


def next_any(paths: list[Path]) -> None:
    """Refuse to propose tests from a menu that a plant does not have; say where the kinds of test that tell are found."""
    from hjcamp.records.find import find_logs
    from hjcamp.records.of_plant import PLANT_KEY
    from hjcamp.records.read import read_log

    name = read_log(find_logs(paths)[0]).metadata.get(PLANT_KEY)
    raise UsageError(
        f"plant {name} has no menu of tests, so none can be proposed by name; hjcamp diagnose says in words which kinds of "
        "test would tell its candidates apart"
    )
