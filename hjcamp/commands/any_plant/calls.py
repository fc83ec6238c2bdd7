"""What compare, diagnose, add, calibrate and next do for tests of any plant that has no module of its own for it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, joined
from hjcamp.commands.any_plant.uncertainty import Further, uncertainty
from hjcamp.commands.shared.session import folder_for, keep_answer, progress_of, tell_of_views, write_answer
from hjcamp.errors import UsageError
from hjcamp.known_plants import DEFAULT
from hjcamp.storage import whole_file

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.analyses.diagnosing import Asked


def diagnose(data: Data, asked: Asked, json: Path | None) -> None:
    """Say which effect the model of a plant misses; the answer is that of ``hjcamp diagnose``."""
    from hjcamp.campaign.execution.console import make_console

    console = make_console()
    with progress_of(console) as report:
        from hjcamp.analyses.diagnosing import diagnose_plant
        from hjcamp.commands.any_plant.next_commands import next_commands
        from hjcamp.commands.any_plant.pages import write_diagnosis
        from hjcamp.commands.any_plant.printed_diagnosis import print_diagnosis
        from hjcamp.commands.any_plant.verdict_words import Words

        done = diagnose_plant(data, asked, report)
        write_answer(json, done.content)
        report("drawing", 0.99)
        words = Words(done.analysis, done.verdict, done.content)
        folder = folder_for("diagnose", data.paths, json)
        following = next_commands(words, joined(data.paths), asked.model, joined([folder]))
        if data.common and data.plant.name != data.plant_name:
            # its names are those of no model that the other commands read
            following = [f"hjcamp diagnose {joined(data.paths)}   # by the diagnosis of plant {data.plant_name} itself"]
        files = write_diagnosis(words, folder, following)
        keep_answer(folder, done.content)
    print_diagnosis(console, words)
    _tell_of_own(console, data)
    console.print(f"page    {files[-1]}", markup=False)
    for number, line in enumerate(following):
        console.print(f"{'        ' if number else 'next    '}{line}", markup=False)


def compare(data: Data, names: list[str], json: Path | None, into: Path | None, mcap: Path | None = None) -> None:
    """Predict measured tests of a plant with one or more models."""
    from hjcamp.campaign.execution.console import make_console

    console = make_console()
    with progress_of(console) as report:
        from hjcamp.analyses.comparing import compare_plant
        from hjcamp.commands.any_plant.comparison_words import print_comparison
        from hjcamp.commands.any_plant.explorer import modelled_tests
        from hjcamp.commands.any_plant.pages import write_comparison
        from hjcamp.diagnosis.results.comparison import answer
        from hjcamp.records.views.model_log import write_modelled

        found = compare_plant(data, names, report)
        write_answer(json, answer(found))
        report("drawing", 0.9)
        own = "" if names[-1] == "published" else f" --model {names[-1]}"
        following = f"hjcamp diagnose {joined(data.paths)}{own}"
        files = write_comparison(found, into or folder_for("compare", data.paths, json), [following])
        views = [] if mcap is None else write_modelled(mcap, modelled_tests(found))
    print_comparison(console, found)
    _tell_of_own(console, data)
    tell_of_views(console, views)
    console.print(f"page    {files[-1]}", markup=False)
    console.print(f"next    {following}", markup=False)


def add(there: list[Path], names_and_paths: list[str], name: str, model: str, json: Path | None) -> None:
    """Fit effects of a plant, save the model, and show the error on blocks that were not used; ``there`` are its logs."""
    from hjcamp.campaign.execution.console import make_console

    data = Data(there)
    console = make_console()
    with progress_of(console) as report:
        from hjcamp.analyses.adding import add as add_effects
        from hjcamp.analyses.adding import library_of_data
        from hjcamp.commands.any_plant.words import print_addition
        from hjcamp.commands.shared.effects_and_paths import split

        names, paths = split(names_and_paths, library_of_data(data), data.plant)
        done = add_effects(data, names, name, model, report)
        write_answer(json, done.content)
    print_addition(console, done.found, names, done.path)
    _tell_of_own(console, data)
    console.print(f"next    hjcamp compare {joined(paths)} --model {model} --model {name}", markup=False)


def _tell_of_own(console: Console, data: Data) -> None:
    """Say what is wrong with effects of the user's own at the plant of these tests."""
    from hjcamp.commands.shared.wrapped import print_wrapped
    from hjcamp.effects import faults_of_own

    print_wrapped(console, faults_of_own(data.measured.plant), 8, "own")


def calibrate(data: Data, name: str, only: list[str], conf: Path, replace: bool, json: Path | None) -> None:
    """Fit the base parameters of a plant to tests and save them as a model."""
    calibrate_further(data, name, only, json, Further())


def calibrate_further(data: Data, name: str, only: list[str], json: Path | None, asked: Further) -> None:
    """Calibrate, with what is ``asked`` for besides intervals by curvature."""
    if only:
        raise UsageError(f"--only {only[0]}: it chooses logs of {DEFAULT}; of plant {data.plant_name} name the logs themselves")
    from hjcamp.analyses.uncertainty import check_posterior
    from hjcamp.campaign.execution.console import make_console

    if asked.draws is not None:
        check_posterior(asked.draws)
    console = make_console()
    with progress_of(console) as report:
        from hjcamp.analyses.calibrating import fit_plant
        from hjcamp.analyses.untold import untold
        from hjcamp.commands.any_plant.words import end_words, print_calibration, still_words
        from hjcamp.diagnosis.results.channel_rows import end_rows, still_rows

        done = fit_plant(data, name, report)
        measured = done.analysis.measured
        head = {
            "schema": "hjcamp.calibration/1",
            "plant": measured.plant.name,
            "tests": len(measured.tests),
            "hardware": {},
        }
        notes = [*untold(done.analysis), *end_words(end_rows(done.analysis.windows.layout))]
        notes += still_words(still_rows(measured))
        found = uncertainty(done, name, asked, report)
        notes += found.notes
        rest: dict[str, Any] = {"notes": notes, "model": str(done.model), "rig": None, "page": None}
        write_answer(json, {**head, "calibration": done.rows, **rest, **found.content})
    print_calibration(console, done.analysis, done.rows)
    for note in notes:
        console.print(f"note    {note}", markup=False)
    console.print(f"model   {done.model}", markup=False)
    for kind, path in found.files.items():
        console.print(f"{kind:8}{path}", markup=False, soft_wrap=True)
    console.print(f"next    hjcamp compare {joined(data.paths)} --model published --model {name}", markup=False)


def propose(
    logs: list[Path], words: list[str], rivals: list[str], tests: int, asked: Asked, name: str | None, json: Path | None
) -> None:
    """Propose the tests of any plant that separate best what its diagnosis leaves."""
    import time

    from hjcamp.analyses.proposing import propose_for_plant
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.commands.any_plant import next_answer as said
    from hjcamp.commands.any_plant.next_campaign import written_campaign
    from hjcamp.report.pictures.next import draw_predictions

    began, data = time.perf_counter(), Data(logs)
    words = [word for word in words if Path(word) not in logs]
    named = [one for group in rivals for one in group.split(",") if one] + [one for one in words if "=" not in one]
    _check_words(data, words, rivals, named)
    console = make_console()
    with progress_of(console) as report:
        kept = next((path for path in _kept_answers(data, json) if path.is_file()), None)
        done = propose_for_plant(data, asked, named, tests, kept, report)
        report("drawing", 0.99)
        picture = campaign = None
        if done.proposal.tests:
            picture = folder_for("next", data.paths, json) / "predictions.png"
            png = draw_predictions(*said.drawn(done))
            with whole_file(picture) as stream:
                stream.write(png)
        if done.proposal.chosen:
            campaign = written_campaign(done, data, name)
        write_answer(json, said.answer(done, campaign, picture, time.perf_counter() - began))
    own = "" if asked.model == "published" else f" --model {asked.model}"
    after = [f"hjcamp run campaign={campaign.stem}"] if campaign else []
    after += [f"hjcamp diagnose {joined(data.paths)} NEW_LOGS{own}"] if done.proposal.chosen else []
    said.tell(console, done, picture, campaign, after or [f"hjcamp compare {joined(data.paths)}{own}"])


def _check_words(data: Data, words: list[str], rivals: list[str], named: list[str]) -> None:
    if rivals and not named:
        raise UsageError("--rivals names none; give effects: --rivals A,B")
    for one in words:
        if "=" in one:
            raise UsageError(
                f"{one}: only the menu of {DEFAULT} can be cut down; the tests of plant {data.plant_name} are made from its logs"
            )
        if not rivals:
            raise UsageError(f"{one}: there is no such file or folder")


def _kept_answers(data: Data, json: Path | None) -> list[Path]:
    """Return where a diagnosis of these logs may have kept its answer."""
    places = [folder_for("diagnose", data.paths, answer) for answer in (json, None)]
    return [folder / "answer.json" for folder in dict.fromkeys(places)]
