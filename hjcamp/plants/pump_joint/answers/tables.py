"""diagnose, compare and add for tables of indicators: means and deviations alone, without logs."""

from __future__ import annotations

import shlex
import time
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.commands.shared.session import check_answer_file, keep_answer, progress_of, write_answer
from hjcamp.errors import UsageError, unknown
from hjcamp.plants.pump_joint.tables import question as questions
from hjcamp.plants.pump_joint.tables.answer import NAME, answer, read_answer
from hjcamp.plants.pump_joint.tables.answer import is_answer as is_answer
from hjcamp.plants.pump_joint.tables.cells import SIMULATED
from hjcamp.plants.pump_joint.tables.quantities import candidates
from hjcamp.plants.pump_joint.tables.question import asked
from hjcamp.plants.pump_joint.tables.search import EFFORTS
from hjcamp.storage import write_whole

if TYPE_CHECKING:
    from rich.console import Console

MOST_WORKERS = 4


def diagnose_tables(
    words: Sequence[str], held: str | None, json: Path | None, effort: str, seed: int, workers: int | None,
    only: str | None, without: str | None,
) -> None:  # fmt: skip
    """Say what the model misses, judged by tables alone; the folder of the answer keeps every finished fit."""
    from hjcamp.analyses.diagnosing import check_seed, considered
    from hjcamp.campaign.execution.console import make_console

    began = time.perf_counter()
    check_answer_file(json)
    check_seed(seed)
    console = make_console()
    with progress_of(console) as report:
        from hjcamp.plants.pump_joint.tables.diagnosis import diagnose
        from hjcamp.plants.pump_joint.tables.page import PICTURE, draw, page
        from hjcamp.workers.pool import Crew, available

        if effort not in EFFORTS:
            raise unknown("effort", effort, EFFORTS)
        question = questions.asked(words)
        others = questions.held_out(question, held.split(",") if held else None)
        library = list(considered(candidates(), only, without))
        folder = folder_of(question.tables, effort, seed, (only, without, held, *question.overrides))
        folder.mkdir(parents=True, exist_ok=True)
        crew = Crew(workers or min(available(), MOST_WORKERS))
        try:
            found = diagnose(question, others, library, effort, seed, crew, folder, report)
        finally:
            crew.close()
        command = shlex.join(
            [
                "hjcamp",
                "diagnose",
                "--tables",
                *words,
                *(["--held-out", held] if held else []),
                *(["--only", only] if only else []),
                *(["--without", without] if without else []),
            ]
        )
        content = answer(found, effort, seed, f"{command} --effort {effort} --seed {seed}", time.perf_counter() - began)
        write_answer(json, content)
        keep_answer(folder, content, NAME)
        if not content["lacking"]:
            draw(content, folder / PICTURE)
        write_whole(folder / "page.md", page(content))
    _print(console, content, folder)


def folder_of(tables: Sequence[str], effort: str, seed: int, others: Sequence[str | None] = ()) -> Path:
    """Return where the answer of a table and its finished fits are kept: another one for each of the other words of the call.

    So it is for files of one name in several folders, or ``add`` would save the model of the last that was diagnosed.
    """
    label = "_".join(Path(name).stem if name.endswith(".csv") else name for name in tables)
    folders = [str(parent) for name in tables if (parent := Path(name).parent) != Path()]
    mark = f"_{zlib.crc32(repr((*others, *folders)).encode()):08x}" if any((*others, *folders)) else ""
    return Path("runs") / f"tables_{label}_{effort}_{seed}{mark}"


def _print(console: Console, content: Mapping[str, Any], folder: Path) -> None:
    from hjcamp.analyses.data import free_model_name
    from hjcamp.commands.shared.wrapped import print_wrapped
    from hjcamp.plants.pump_joint.tables.page import best_of, few_told, verdict_told

    word, told = content["verdict"].upper(), verdict_told(content)
    console.print(word, style="bold", markup=False, highlight=False)
    print_wrapped(console, [one for one in (told, few_told(content)) if one], 8)
    if not content["lacking"]:
        print_errors(console, content)
        for number, step in enumerate(content["steps"], start=1):
            replicates, chance = len(step["gains_of_twins"]), f"{step['p_value']:.3g}"
            console.print(
                f"step {number}  {best_of(step)} gains {step['gain']:.1f}; chance {chance}, {replicates} null replicates",
                markup=False,
            )
    console.print(f"page    {folder / 'page.md'}", markup=False)
    if content["verdict"] in ("effect", "one_of", "outside_library", "nothing_missing"):
        console.print(f"next    hjcamp add {folder} --as {free_model_name('refitted')}", markup=False)


def print_errors(console: Console, content: Mapping[str, Any], fitted: str = "fitted") -> None:
    """Print loss and mean absolute log ratio of each model, table by table; ``fitted`` says what was done with the cells."""
    console.print("error   mean absolute log ratio of RMSE1, RMSE2 and largest error; cells within two sigma", markup=False)
    for key, used in (("error", fitted), ("error_held_out", "held out")):
        for name, one in content[key].items():
            ratios = [f"{table} {ratio:.2f}" for table, ratio in one["mean_abs_log_ratio"].items() if ratio is not None]
            near = f"{one['near']} of {one['cells']} near"
            console.print(f"  {used:<9} {name:<10} {'  '.join(ratios)}   {near}, loss {one['loss']:.0f}", markup=False)
    if fitted and not content["error_held_out"]:
        console.print("  no table is held out: nothing shows what the model predicts", markup=False)


def compare_tables(words: Sequence[str], names: Sequence[str], json: Path | None) -> None:
    """Simulate the conditions of tables with saved models, as ``hjcamp run`` would, and show the error of each."""
    from hjcamp.campaign.execution.console import make_console

    check_answer_file(json)
    console = make_console()
    with progress_of(console) as report:
        from hjcamp.plants.pump_joint.tables.comparison import compare

        content = compare(asked(words), names, SIMULATED, 1, report)
        write_answer(json, content)
    print_errors(console, content, "")
    for name, origin in content["models"].items():
        if own := [table for table in content["tables"] if table in (origin.get("tables") or ())]:
            told = f"  {name} was fitted to {', '.join(own)}: its error there is no prediction"
            console.print(told, markup=False, soft_wrap=True)


def add_table(path: Path, name: str, json: Path | None) -> None:
    """Save the model of a table's diagnosis under a name."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.campaign.files.provenance import git_label, utc_now
    from hjcamp.configuration.saved_model import check_new_name, rounded, write_content
    from hjcamp.plants.pump_joint.configuration import check_model

    check_answer_file(json)
    file, found = check_new_name(name), read_answer(path)
    if found["verdict"] == "cannot_tell":
        raise UsageError(f"{path}: its verdict is cannot_tell; there is no model to save")
    model = list(found["models"].values())[-1]
    settings = rounded(model["settings"])
    origin = {
        "command": found["command"], "git": git_label(), "made_at": utc_now(), "verdict": found["verdict"],
        "tables": found["tables"], "held_out": found["held_out"], "table_sha256": found["table_sha256"],
        "mean_abs_log_ratio": rounded({
            key: list(found[key].values())[-1]["mean_abs_log_ratio"] for key in ("error", "error_held_out") if found[key]
        }),
    }  # fmt: skip
    check_model({"name": name, **settings, "provenance": origin}, f"model '{name}'")
    tables = ", ".join(found["tables"])
    head = [
        f"Fitted to the means of tables {tables} by `{found['command']}`; SI units.",
        "Base parameters, effects, and factors of the loop.",
    ]
    content = write_content(file, settings, head, origin)
    write_answer(json, {"schema": "hjcamp.table_model/1", "file": str(file), **content})
    make_console().print(f"{file}  = {' + '.join(['published', 'calibration', *model['names']])}", markup=False)
    make_console().print(f"next    hjcamp run campaign=controllers model={name}", markup=False)
    measured = shlex.join(found["held_out"] or found["tables"])
    beside = f"hjcamp compare --tables {measured} --model published --model {name}"
    make_console().print(f"        {beside}", markup=False, soft_wrap=True)
